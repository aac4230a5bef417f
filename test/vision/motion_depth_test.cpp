// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/motion_depth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>

#include "fixtures/refusal.h"
#include "radar_dot/vision/motion_segmentation.h"

namespace radar_dot {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr double kInterval = 1.0 / 12.0;  // s
const CameraIntrinsics kCamera{200.0, 200.0, 79.5, 59.5, 160, 120};

/// A wall across the street and one along it, 4 m to the left, seen by a camera that drives straight ahead
/// and turns: the depth of a pixel is known in closed form at every place.
class Street {
 public:
  /// @param speed  m/s  @param yaw_rate  rad/s, to the right
  Street(double speed, double yaw_rate) : speed_(speed), yaw_rate_(yaw_rate) {}

  /// From the camera frame of an image to that of the first one.
  Eigen::Isometry3d pose(int image) const {
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() =
        Eigen::AngleAxisd(yaw_rate_ * image * kInterval, Eigen::Vector3d::UnitY()).toRotationMatrix();
    pose.translation().z() = speed_ * image * kInterval;
    return pose;
  }
  Eigen::Isometry3d motion(int image) const { return pose(image).inverse() * pose(image - 1); }

  cv::Mat depth(int image) const {
    const Eigen::Isometry3d from = pose(image);
    cv::Mat depth(kCamera.height, kCamera.width, CV_32FC1);
    for (int v = 0; v < depth.rows; ++v) {
      for (int u = 0; u < depth.cols; ++u) {
        const Eigen::Vector3d ray = from.linear() * kCamera.rayOf(u, v);
        const double across = (kWall - from.translation().z()) / ray.z();
        const double along = -kSide / std::min(ray.x(), -1e-9);
        depth.at<float>(v, u) = static_cast<float>(std::min(across, along));
      }
    }
    return depth;
  }

  /// An image whose flow back is exact, and whose prior is wrong by a factor.
  MotionDepthInput input(int image, double factor, double prior_std) const {
    MotionDepthInput input;
    input.camera = kCamera;
    input.time = image * kInterval;
    input.prior_depth = factor * depth(image);
    input.prior_std = cv::Mat(input.prior_depth.size(), CV_32FC1, cv::Scalar(prior_std));
    if (image == 0) return input;
    MotionDepthInput::Step step;
    step.previous_time = (image - 1) * kInterval;
    step.T_current_from_previous = motion(image);
    step.flow_back = expectedFlow(kCamera, step.T_current_from_previous.inverse(), depth(image));
    step.fb_error = cv::Mat(input.prior_depth.size(), CV_32FC1, cv::Scalar(0.0));
    input.step = step;
    return input;
  }

 private:
  static constexpr double kWall = 30.0, kSide = 4.0;  // m
  double speed_, yaw_rate_;
};

MotionDepthParams exactFlow() {
  MotionDepthParams params;
  params.flow_std = 0.05;
  params.refine = false;
  return params;
}

/// Share of the pixels whose depth is known within `tolerance` of the true one.
double shareWithin(const cv::Mat& depth, const cv::Mat& truth, double tolerance) {
  int within = 0;
  for (int v = 0; v < truth.rows; ++v) {
    for (int u = 0; u < truth.cols; ++u) {
      const auto ratio = static_cast<double>(depth.at<float>(v, u) / truth.at<float>(v, u));
      if (std::abs(ratio - 1.0) <= tolerance) ++within;
    }
  }
  return within / static_cast<double>(truth.total());
}

bool same(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0.0; }

std::uint8_t originAt(const MotionDepthResult& result, int u, int v) {
  return result.origin.at<std::uint8_t>(v, u);
}

constexpr auto kFromPrior = static_cast<std::uint8_t>(DepthOrigin::kPrior);
constexpr auto kFromMotion = static_cast<std::uint8_t>(DepthOrigin::kMotion);
constexpr auto kIsRefused = static_cast<std::uint8_t>(DepthOrigin::kRefused);

TEST(MotionDepth, TheFirstImageShowsThePrior) {
  const Street street(10.0, 0.0);
  MotionDepthInput input = street.input(0, 1.5, 0.35);
  input.prior_depth.at<float>(3, 4) = kNaN;
  const MotionDepthResult result = MotionDepth(exactFlow()).update(input);
  EXPECT_FALSE(result.followed);
  EXPECT_TRUE(std::isnan(result.depth.at<float>(3, 4)));
  EXPECT_FLOAT_EQ(result.depth.at<float>(60, 100), 45.0F);
  EXPECT_FLOAT_EQ(result.relative_std.at<float>(60, 100), 0.35F);
  EXPECT_EQ(cv::countNonZero(result.origin), 0);
}

// A start that is 50 % too far, or a third too near: after five images all but what is at the focus of
// expansion is within 5 %, in turns as well.
TEST(MotionDepth, AWrongStartIsCorrectedWithinFiveImages) {
  for (const double factor : {1.5, 0.667}) {
    for (const double yaw_rate : {0.0, 0.3}) {
      const Street street(10.0, yaw_rate);
      MotionDepth filter(exactFlow());
      MotionDepthResult result = filter.update(street.input(0, factor, 0.35));
      EXPECT_EQ(shareWithin(result.depth, street.depth(0), 0.1), 0.0);
      for (int image = 1; image <= 5; ++image) result = filter.update(street.input(image, factor, 0.35));
      EXPECT_TRUE(result.measured);
      EXPECT_GT(shareWithin(result.depth, street.depth(5), 0.05), 0.95) << factor << " " << yaw_rate;
      for (int image = 6; image <= 12; ++image) result = filter.update(street.input(image, factor, 0.35));
      EXPECT_GT(shareWithin(result.depth, street.depth(12), 0.02), 0.95) << factor << " " << yaw_rate;
    }
  }
}

// Sure of a prior that is wrong by ten sigmas.
TEST(MotionDepth, ASureButWrongStartDoesNotPersist) {
  const Street street(10.0, 0.0);
  MotionDepth filter(exactFlow());
  MotionDepthResult result;
  for (int image = 0; image <= 5; ++image) result = filter.update(street.input(image, 1.5, 0.05));
  EXPECT_GT(shareWithin(result.depth, street.depth(5), 0.1), 0.85);
}

TEST(MotionDepth, UncertaintyFallsWithTheParallax) {
  const Street street(10.0, 0.0);
  MotionDepth filter(exactFlow());
  MotionDepthResult result;
  for (int image = 0; image <= 8; ++image) result = filter.update(street.input(image, 1.2, 0.5));
  EXPECT_LT(result.relative_std.at<float>(60, 5), 0.06F);   // the wall beside
  EXPECT_GT(result.relative_std.at<float>(60, 80), 0.45F);  // straight ahead
  EXPECT_EQ(originAt(result, 5, 60), kFromMotion);
}

TEST(MotionDepth, StandingChangesNothing) {
  const Street driving(10.0, 0.0);
  MotionDepth filter(exactFlow());
  MotionDepthResult before;
  for (int image = 0; image <= 6; ++image) before = filter.update(driving.input(image, 1.5, 0.35));
  MotionDepthResult result;
  for (int image = 7; image < 30; ++image) {
    MotionDepthInput input = driving.input(6, 1.5, 0.35);
    input.time = image * kInterval;
    input.step->previous_time = (image - 1) * kInterval;
    input.step->T_current_from_previous.setIdentity();
    input.step->flow_back.setTo(cv::Scalar(0.2, -0.1));  // noise
    result = filter.update(input);
    EXPECT_TRUE(result.followed);
    EXPECT_FALSE(result.measured);
  }
  EXPECT_TRUE(same(result.depth, before.depth));
  EXPECT_TRUE(same(result.relative_std, before.relative_std));
}

TEST(MotionDepth, StandingFromTheStartShowsThePrior) {
  const Street standing(0.0, 0.0);
  MotionDepth filter(exactFlow());
  MotionDepthResult result;
  for (int image = 0; image <= 6; ++image) result = filter.update(standing.input(image, 1.5, 0.35));
  EXPECT_EQ(shareWithin(result.depth, standing.input(6, 1.5, 0.35).prior_depth, 1e-6), 1.0);
}

// A gap, images too far apart, another grid, no flow, or a clear(): the prior alone.
TEST(MotionDepth, ACutDropsTheState) {
  const Street street(10.0, 0.0);
  const auto after = [&](auto change) {
    MotionDepth filter(exactFlow());
    for (int image = 0; image <= 6; ++image) filter.update(street.input(image, 1.5, 0.35));
    MotionDepthInput input = street.input(7, 1.5, 0.35);
    change(input, filter);
    const MotionDepthResult result = filter.update(input);
    const bool is_prior = shareWithin(result.depth, input.prior_depth, 1e-6) == 1.0;
    EXPECT_EQ(is_prior, !result.followed);
    return is_prior;
  };
  EXPECT_FALSE(after([](MotionDepthInput&, MotionDepth&) {}));
  EXPECT_TRUE(after([](MotionDepthInput& input, MotionDepth&) { input.step->previous_time -= kInterval; }));
  EXPECT_TRUE(after([](MotionDepthInput& input, MotionDepth&) { input.time += 0.3; }));
  EXPECT_TRUE(after([](MotionDepthInput& input, MotionDepth&) { input.step.reset(); }));
  EXPECT_TRUE(after([](MotionDepthInput&, MotionDepth& filter) { filter.clear(); }));
  EXPECT_TRUE(after([](MotionDepthInput& input, MotionDepth&) {
    input.camera = input.camera.scaledTo(80, 60);
    for (cv::Mat* image :
         {&input.prior_depth, &input.prior_std, &input.step->flow_back, &input.step->fb_error})
      *image = (*image)(cv::Rect(0, 0, 80, 60)).clone();
  }));
}

// Flow that does not close measures nothing.
TEST(MotionDepth, WithoutTextureThePriorStays) {
  const Street street(10.0, 0.0);
  MotionDepth filter(exactFlow());
  const cv::Rect sky(20, 10, 30, 20);
  MotionDepthResult result;
  MotionDepthInput input;
  for (int image = 0; image <= 6; ++image) {
    input = street.input(image, 1.5, 0.35);
    if (input.step) {
      input.step->fb_error(sky).setTo(20.0);
      input.step->fb_error(sky + cv::Point(0, 50)).setTo(kNaN);
    }
    result = filter.update(input);
  }
  for (const cv::Rect& part : {sky, sky + cv::Point(0, 50)}) {
    EXPECT_EQ(shareWithin(result.depth(part), input.prior_depth(part), 1e-6), 1.0);
    EXPECT_EQ(cv::countNonZero(result.origin(part)), 0);
  }
}

// What moves across the epipolar lines is no static point, and keeps what it had.
TEST(MotionDepth, AMoverIsRefused) {
  const Street street(10.0, 0.0);
  MotionDepth filter(exactFlow());
  for (int image = 0; image <= 4; ++image) filter.update(street.input(image, 1.2, 0.35));
  MotionDepthInput input = street.input(5, 1.2, 0.35);
  input.step->flow_back.at<cv::Vec2f>(60, 10)[1] += 2.0F;  // the focus of expansion is in this row
  const MotionDepthResult result = filter.update(input);
  EXPECT_EQ(originAt(result, 10, 60), kIsRefused);
  EXPECT_EQ(originAt(result, 10, 62), kFromMotion);
}

// Pitch that nothing but the image tells: without the refinement depths below the horizon are far off.
TEST(MotionDepth, TheImageTellsThePitch) {
  const Street street(10.0, 0.0);
  const auto errorWith = [&](bool refine) {
    MotionDepthParams params = exactFlow();
    params.refine = refine;
    params.refinement.stride = 6;
    MotionDepth filter(params);
    MotionDepthResult result;
    Eigen::Isometry3d pitch = Eigen::Isometry3d::Identity();
    for (int image = 0; image <= 8; ++image) {
      MotionDepthInput input = street.input(image, 1.1, 0.2);
      pitch.linear() =
          Eigen::AngleAxisd(image % 2 == 0 ? 0.01 : -0.01, Eigen::Vector3d::UnitX()).toRotationMatrix();
      if (input.step) {
        input.step->T_current_from_previous = pitch * input.step->T_current_from_previous;
        input.step->motion_covariance.diagonal() << 1e-4, 1e-8, 1e-8, 1e-6, 1e-6, 1e-6;
      }
      result = filter.update(input);
    }
    return 1.0 - shareWithin(result.depth, street.depth(8), 0.05);
  };
  EXPECT_LT(errorWith(true), 0.1);
  EXPECT_GT(errorWith(false), 0.3);
}

TEST(MotionDepth, RefusesOtherImages) {
  const Street street(10.0, 0.0);
  MotionDepth filter;
  MotionDepthInput input = street.input(1, 1.0, 0.3);
  input.step->flow_back = input.step->fb_error;
  test::expectRefusal<std::invalid_argument>([&] { filter.update(input); }, {"flow_back", "CV_32FC2"});
  input = street.input(1, 1.0, 0.3);
  input.prior_std = cv::Mat();
  test::expectRefusal<std::invalid_argument>([&] { filter.update(input); }, {"prior_std"});
  MotionDepthParams params;
  params.flow_std = 0.0;
  test::expectRefusal<InvalidParameter>([&] { MotionDepth other(params); }, {"motion_flow_std"});
}

}  // namespace
}  // namespace radar_dot
