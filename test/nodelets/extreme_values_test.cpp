// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// Numbers at the edge of their type, in every field of every message that comes from others: they are
// refused, left out or harmless, and what comes of them is finite.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <opencv2/core.hpp>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "nodelets/float_cloud.h"
#include "nodelets/inputs/labelled_scans.h"
#include "nodelets/inputs/rotation_source.h"
#include "nodelets/messages/cloud_conversion.h"
#include "nodelets/messages/ego_messages.h"
#include "nodelets/messages/image_messages.h"
#include "nodelets/messages/refined_twist.h"
#include "radar_dot/common/twist_history.h"
#include "radar_dot/objects/object_tracker.h"
#include "radar_dot/radar/odometry.h"
#include "radar_dot/radar/sweep_estimator.h"
#include "radar_dot/vision/rigid_motion.h"

namespace radar_dot {
namespace {

template <typename Number>
std::vector<Number> extremes() {
  using Limits = std::numeric_limits<Number>;
  return {Limits::quiet_NaN(),  Limits::infinity(), -Limits::infinity(),      Limits::max(), Limits::lowest(),
          Limits::denorm_min(), Limits::min(),      std::sqrt(Limits::max()), Number(-1),    Number(0)};
}

/// Gives `use` the message with each of the extremes in each of the fields.
template <typename Number, typename Message, typename Fields>
void forEachExtreme(const Message& good, const Fields& fields_of, const std::function<void(Message&)>& use) {
  Message probe = good;
  const std::size_t count = fields_of(probe).size();
  ASSERT_GT(count, 0U);
  for (std::size_t field = 0; field < count; ++field) {
    for (const Number value : extremes<Number>()) {
      SCOPED_TRACE(testing::Message() << "field " << field << ": " << value);
      Message message = good;
      *fields_of(message)[field] = value;
      use(message);
    }
  }
}

/// @return false: refused, which is as good
bool accepts(const std::function<void()>& body) {
  try {
    body();
    return true;
  } catch (const std::invalid_argument&) {
    return false;
  }
}

template <typename Array>
void append(std::vector<double*>& fields, Array& array) {
  for (double& value : array) fields.push_back(&value);
}

// --- Radars

constexpr double kSpeed = 8.0;
const std::vector<std::string> kPolarFields = {"x", "y", "z", "doppler", "rcs", "snr"};
const std::vector<std::string> kVectorFields = {"x", "y", "z", "vx", "vy", "vz"};

/// 60 returns that a vehicle sees which drives ahead, in the frame of its front radar.
std::vector<float> returnsOf(bool vectors) {
  std::vector<float> values;
  for (int i = 0; i < 60; ++i) {
    const double azimuth = -1.0 + i / 30.0, range = 10.0 + i % 7;
    const double x = range * std::cos(azimuth), y = range * std::sin(azimuth),
                 rate = -kSpeed * std::cos(azimuth);
    const std::vector<double> point = vectors ? std::vector<double>{x, y, 0.5, -kSpeed, 0.0, 0.0}
                                              : std::vector<double>{x, y, 0.5, rate, 5.0, 20.0};
    for (const double value : point) values.push_back(static_cast<float>(value));
  }
  return values;
}

void expectFinite(const EgoVelocityResult& result) {
  EXPECT_TRUE(result.linear.allFinite() && result.angular.allFinite());
  EXPECT_TRUE(result.covariance.allFinite()) << result.covariance;
  EXPECT_GE(result.covariance.diagonal().minCoeff(), 0.0);
}

/// One scan of a cloud, as it is read. @param returns  those of the scan, which refers to them
std::vector<RadarScan> scansOf(const std::vector<std::string>& names, const std::vector<float>& values,
                               double time, std::vector<DopplerReturn>& returns) {
  const sensor_msgs::PointCloud2 cloud = test::floatCloud(names, values);
  std::vector<PointField> fields;
  DopplerExtractor().extract(viewOf(cloud, fields), returns);
  std::vector<RadarScan> scans(1);
  scans[0].returns = returns;
  scans[0].time = time;
  return scans;
}

/// One sweep with broken numbers between good ones.
void expectVelocity(const std::vector<std::string>& names, const std::vector<float>& good,
                    const std::vector<float>& broken) {
  SweepEstimator estimator;
  VelocityIntegrator integrator;
  for (int sweep = 0; sweep < 3; ++sweep) {
    std::vector<DopplerReturn> returns;
    std::vector<RadarScan> scans = scansOf(names, sweep == 1 ? broken : good, 0.1 * sweep, returns);
    scans[0].T_base_from_sensor.translation().x() = 3.5;
    const SweepEstimate estimate = estimator.estimate(scans, scans[0].time);
    expectFinite(estimate.single);
    const std::optional<EgoVelocityResult> output = estimate.output();
    if (!output) continue;
    expectFinite(*output);
    EXPECT_NEAR(output->linear.x(), kSpeed, 0.3);
    integrator.add({scans[0].time, output->linear, output->angular, output->covariance});
  }
  EXPECT_TRUE(integrator.state().T_odom_from_base.matrix().allFinite());
  EXPECT_TRUE(integrator.state().covariance.allFinite());
  EXPECT_NEAR(integrator.state().T_odom_from_base.translation().x(), 0.2 * kSpeed, 0.1);
}

TEST(ExtremeValues, OfReturnsLeaveTheVelocityAsItIs) {
  for (const bool vectors : {false, true}) {
    const std::vector<std::string>& names = vectors ? kVectorFields : kPolarFields;
    const std::vector<float> good = returnsOf(vectors);
    for (std::size_t field = 0; field < names.size(); ++field) {
      for (const float value : extremes<float>()) {
        SCOPED_TRACE(testing::Message() << names[field] << ": " << value);
        std::vector<float> one = good;
        one[7 * names.size() + field] = value;
        expectVelocity(names, good, one);
      }
    }
  }
}

// A field that is broken in all returns of a sweep may cost its estimate, and no more.
TEST(ExtremeValues, OfAllReturnsMakeNothingThatIsNotFinite) {
  const std::vector<float> good = returnsOf(false);
  for (std::size_t field = 0; field < kPolarFields.size(); ++field) {
    for (const float value : extremes<float>()) {
      SCOPED_TRACE(testing::Message() << kPolarFields[field] << ": " << value);
      std::vector<float> broken = good;
      for (std::size_t i = field; i < broken.size(); i += kPolarFields.size()) broken[i] = value;
      SweepEstimator estimator;
      for (int sweep = 0; sweep < 3; ++sweep) {
        std::vector<DopplerReturn> returns;
        auto scans = scansOf(kPolarFields, sweep == 1 ? broken : good, 0.1 * sweep, returns);
        const SweepEstimate estimate = estimator.estimate(scans, scans[0].time);
        expectFinite(estimate.single);
        if (const std::optional<EgoVelocityResult> output = estimate.output()) expectFinite(*output);
      }
    }
  }
}

TEST(ExtremeValues, OfLabelledReturnsMakeNoObjectThatIsNotFinite) {
  const std::vector<std::string> names = {"x", "y", "z", "residual"};
  const std::vector<float> good = {20.F, 1.F, 0.5F, 5.F, 20.2F, 1.1F, 0.5F, 5.F, 20.F, 1.2F, 0.4F, 5.1F};
  for (std::size_t field = 0; field < names.size(); ++field) {
    for (const float value : extremes<float>()) {
      SCOPED_TRACE(testing::Message() << names[field] << ": " << value);
      LabelledScans scans;
      ObjectTracker tracker;
      for (int i = 0; i < 12; ++i) {
        std::vector<float> values = good;
        if (i % 3 == 1) values[field] = value;
        for (std::size_t k = 0; k < values.size(); k += names.size())
          values[k] += 0.5F * static_cast<float>(i);
        sensor_msgs::PointCloud2 cloud = test::floatCloud(names, values);
        cloud.header.frame_id = "radar";
        cloud.header.stamp = ros::Time(10.0 + 0.1 * i);
        scans.add(cloud, ReturnLabel::kDynamic, {});
        for (const LabelledScan& scan : scans.take(0.0, {})) {
          const double time = scan.stamp.toSec();
          tracker.update(time, scan.radar,
                         detectObjects(time, returnsOf(scan, Eigen::Isometry3d::Identity(), {}, {})),
                         Eigen::Isometry3d::Identity());
        }
      }
      const std::vector<ObjectTrack> tracks = tracker.moving(11.1);
      EXPECT_FALSE(tracks.empty());
      for (const ObjectTrack& track : tracks) {
        EXPECT_TRUE(track.state.allFinite() && track.covariance.allFinite());
        EXPECT_LT(track.state.norm(), 1e3);
      }
    }
  }
}

// --- Velocities and poses

std::vector<double*> numbersOf(geometry_msgs::TwistWithCovarianceStamped& message) {
  geometry_msgs::Twist& twist = message.twist.twist;
  std::vector<double*> fields = {&twist.linear.x,  &twist.linear.y,  &twist.linear.z,
                                 &twist.angular.x, &twist.angular.y, &twist.angular.z};
  append(fields, message.twist.covariance);
  return fields;
}

TEST(ExtremeValues, OfTwistsAreRefusedOrHarmless) {
  geometry_msgs::TwistWithCovarianceStamped good;
  good.header.frame_id = "/base_link";
  good.header.stamp = ros::Time(100.0);
  good.twist.twist.linear.x = kSpeed;
  for (std::size_t i = 0; i < 6; ++i) good.twist.covariance[7 * i] = 0.01;
  ASSERT_EQ(twistDefect(good, "base_link"), "");
  std::size_t refused = 0;
  forEachExtreme<double, geometry_msgs::TwistWithCovarianceStamped>(
      good, numbersOf, [&](geometry_msgs::TwistWithCovarianceStamped& broken) {
        VelocityIntegrator integrator;
        TwistHistory history;
        for (int i = 0; i < 20; ++i) {
          geometry_msgs::TwistWithCovarianceStamped& message = i == 10 ? broken : good;
          message.header.stamp = ros::Time(100.0 + 0.1 * i);
          const std::string defect = twistDefect(message, "base_link");
          refused += !defect.empty();
          if (!defect.empty()) continue;
          integrator.add(twistOf(message));
          history.add(twistOf(message));
          const MotionUncertainty uncertainty = motionUncertainty({}, history.latest()->covariance, false);
          EXPECT_TRUE(std::isfinite(uncertainty.yaw_rate_std + uncertainty.forward_velocity_std));
        }
        EXPECT_TRUE(integrator.state().T_odom_from_base.matrix().allFinite());
        EXPECT_TRUE(integrator.state().covariance.allFinite());
        EXPECT_GE(integrator.state().covariance.diagonal().minCoeff(), 0.0);
        EXPECT_NEAR(integrator.state().T_odom_from_base.translation().x(), 1.9 * kSpeed, 2.0);
        EXPECT_NEAR(integrator.state().time, 101.9, 1e-6);
        EXPECT_TRUE(history.between(100.0, 101.0, 0.1).T_begin_from_end->matrix().allFinite());
      });
  EXPECT_GT(refused, 0U);
}

TEST(ExtremeValues, OfPosesAreRefusedOrHarmless) {
  nav_msgs::Odometry good;
  good.header.stamp = ros::Time(100.0);
  good.pose.pose.orientation.w = 1.0;
  const auto numbers = [](nav_msgs::Odometry& message) {
    geometry_msgs::Pose& pose = message.pose.pose;
    std::vector<double*> fields = {&pose.position.x,    &pose.position.y,    &pose.position.z,
                                   &pose.orientation.x, &pose.orientation.y, &pose.orientation.z,
                                   &pose.orientation.w};
    append(fields, message.pose.covariance);
    append(fields, message.twist.covariance);
    return fields;
  };
  forEachExtreme<double, nav_msgs::Odometry>(good, numbers, [](nav_msgs::Odometry& broken) {
    StampedPose pose;
    if (!accepts([&] { pose = poseOf(broken); })) return;
    EXPECT_TRUE(pose.isometry().matrix().allFinite());
    EXPECT_LT(pose.position.norm(), 1e9);
    EXPECT_NEAR(pose.rotation.norm(), 1.0, 1e-9);
  });
}

// --- Cameras and images

sensor_msgs::CameraInfo cameraInfo() {
  sensor_msgs::CameraInfo info;
  info.width = 160;
  info.height = 90;
  info.D = {0.1, 0.0, 0.0, 0.0, 0.0};
  info.K = {100.0, 0.0, 79.5, 0.0, 100.0, 44.5, 0.0, 0.0, 1.0};
  info.P = {100.0, 0.0, 79.5, 0.0, 0.0, 100.0, 44.5, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

void expectSane(const sensor_msgs::CameraInfo& info) {
  CameraIntrinsics camera;
  distortionDoubt(info);
  if (!accepts([&] { camera = cameraOf(info); })) return;
  EXPECT_TRUE(camera.width > 0 && camera.height > 0 && camera.width <= 160 && camera.height <= 90);
  const CameraIntrinsics scaled = camera.scaledTo(40, 30);
  EXPECT_TRUE(camera.matrix().allFinite() && scaled.rayOf(1.0, 1.0).allFinite());
  EXPECT_LT(camera.rayOf(159.0, 0.0).norm(), 1e5);
}

TEST(ExtremeValues, OfCamerasAreRefusedOrHarmless) {
  for (const bool has_projection : {true, false}) {
    sensor_msgs::CameraInfo good = cameraInfo();
    if (!has_projection) good.P.fill(0.0);
    const auto numbers = [](sensor_msgs::CameraInfo& info) {
      std::vector<double*> fields;
      append(fields, info.D);
      append(fields, info.K);
      append(fields, info.R);
      append(fields, info.P);
      return fields;
    };
    forEachExtreme<double, sensor_msgs::CameraInfo>(good, numbers, expectSane);
    const auto sizes = [](sensor_msgs::CameraInfo& info) {
      return std::vector<std::uint32_t*>{&info.width,        &info.height,      &info.binning_x,
                                         &info.binning_y,    &info.roi.width,   &info.roi.height,
                                         &info.roi.x_offset, &info.roi.y_offset};
    };
    for (std::size_t field = 0; field < 8; ++field) {
      for (const std::uint32_t value : {0U, 1U, 159U, 0x7FFFFFFFU, 0x80000000U, 0xFFFFFFFFU}) {
        sensor_msgs::CameraInfo info = good;
        info.roi.width = 80;
        info.roi.height = 45;
        *sizes(info)[field] = value;
        if (field >= 2) expectSane(info);
        CameraIntrinsics camera;
        if (accepts([&] { camera = cameraOf(info); })) {
          EXPECT_TRUE(camera.matrix().allFinite());
        }
      }
    }
  }
}

/// Ahead at 1 m per image, towards a wall; everything is on.
MaskPair pairOf() {
  MaskPair pair;
  pair.second_time = 0.1;
  pair.camera = cameraOf(cameraInfo());
  pair.depth = cv::Mat(90, 160, CV_32FC1, cv::Scalar(20.0));
  pair.next_depth = cv::Mat(90, 160, CV_32FC1, cv::Scalar(19.0));
  pair.depth_std = cv::Mat(90, 160, CV_32FC1, cv::Scalar(0.05));
  pair.T_base_from_camera.linear() << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  pair.T_first_from_second.translation().x() = 1.0;
  pair.flow.flow = expectedFlow(
      pair.camera, staticPointMotion(pair.T_base_from_camera, pair.T_first_from_second), pair.depth);
  pair.flow.fb_error = cv::Mat::zeros(90, 160, CV_32FC1);
  pair.flow.grey = cv::Mat(90, 160, CV_8UC1);
  cv::theRNG().state = 1;
  cv::randu(pair.flow.grey, 0, 255);  // texture everywhere
  pair.flow.second_grey = pair.flow.grey;
  return pair;
}

void expectMask(const MaskPair& broken, MotionScore score, const cv::Rect& patch) {
  MaskPipelineParams params;
  params.motion.score = score;
  params.refine = true;
  params.use_depth_uncertainty = true;
  params.look_back = true;
  params.memory = 1.0;
  MaskPipeline pipeline(params);
  MaskPair pair = broken;
  for (int i = 0; i < 2; ++i) {
    if (i == 1) pair = pairOf();
    pair.first_time = 0.1 * i;
    pair.second_time = 0.1 * (i + 1);
    pipeline.addBackward(pair.second_time, pair.first_time, pair.flow);
    const MaskOutcome outcome = pipeline.process(pair);
    const StampedTwist refined = refinedVelocity(pair, outcome.input);
    EXPECT_TRUE(refined.covariance.allFinite());
    EXPECT_NEAR(refined.linear.x(), 10.0, 0.5);
    EXPECT_LT(refined.angular.norm(), 0.05);
    EXPECT_TRUE(std::isfinite(outcome.result.threshold) && std::isfinite(outcome.result.median));
    cv::Mat elsewhere = outcome.result.mask.clone();
    elsewhere(cv::Rect(patch.x - 12, patch.y - 12, patch.width + 24, patch.height + 24)).setTo(0);
    EXPECT_EQ(cv::countNonZero(elsewhere), 0) << "image " << i;
  }
}

TEST(ExtremeValues, OfPixelsStayWhereTheyAre) {
  const cv::Rect patch(60, 30, 12, 8);
  const std::vector<std::pair<std::string, std::function<void(MaskPair&, double)>>> images = {
      {"flow x", [&](MaskPair& pair, double value) { pair.flow.flow(patch).setTo(cv::Scalar(value, 0.0)); }},
      {"flow y", [&](MaskPair& pair, double value) { pair.flow.flow(patch).setTo(cv::Scalar(0.0, value)); }},
      {"fb_error", [&](MaskPair& pair, double value) { pair.flow.fb_error(patch).setTo(value); }},
      {"depth", [&](MaskPair& pair, double value) { pair.depth(patch).setTo(value); }},
      {"depth of the second image",
       [&](MaskPair& pair, double value) { pair.next_depth(patch).setTo(value); }},
      {"uncertainty", [&](MaskPair& pair, double value) { pair.depth_std(patch).setTo(value); }},
  };
  for (const MotionScore score : {MotionScore::kPaper, MotionScore::kUncertainty}) {
    for (const auto& [name, spoil] : images) {
      for (const float value : extremes<float>()) {
        SCOPED_TRACE(testing::Message() << name << ": " << value);
        MaskPair pair = pairOf();
        spoil(pair, static_cast<double>(value));
        expectMask(pair, score, patch);
      }
    }
  }
}

// Of a region of the mask, in a part of it and in all of it.
TEST(ExtremeValues, OfRegionsMakeNoObjectThatIsNotFinite) {
  const cv::Rect region(70, 30, 20, 20);
  const CameraIntrinsics camera = cameraOf(cameraInfo());
  const Eigen::Isometry3d mount = pairOf().T_base_from_camera;
  const auto track = [&](const cv::Mat& depth, const cv::Mat& residual) {
    cv::Mat mask = cv::Mat::zeros(90, 160, CV_8UC1);
    mask(region).setTo(255);
    ObjectTracker tracker;
    for (int i = 0; i < 10; ++i) {
      tracker.update(0.1 * i, std::nullopt,
                     detectObjects(0.1 * i, {}, regionsOfMask(mask, depth, residual, 0.1, camera, mount)),
                     Eigen::Isometry3d::Identity());
    }
    for (const ObjectTrack& each : tracker.all())
      EXPECT_TRUE(each.state.allFinite() && each.covariance.allFinite());
    return tracker.all().size();
  };
  const cv::Mat depth(90, 160, CV_32FC1, cv::Scalar(20.0)), residual(90, 160, CV_32FC2, cv::Scalar(3.0, 0.0));
  ASSERT_EQ(track(depth, residual), 1U);
  for (const cv::Rect& part : {cv::Rect(70, 30, 5, 5), region}) {
    for (const float value : extremes<float>()) {
      SCOPED_TRACE(value);
      cv::Mat broken = depth.clone();
      broken(part).setTo(static_cast<double>(value));
      track(broken, residual);
      broken = residual.clone();
      broken(part).setTo(cv::Scalar(static_cast<double>(value), 0.0));
      track(depth, broken);
    }
  }
}

}  // namespace
}  // namespace radar_dot
