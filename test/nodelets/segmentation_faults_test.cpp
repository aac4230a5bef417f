// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// DynamicSegmentation with flow, depth and velocity whose mask is known, and with every wrong input we know.
#include <gtest/gtest.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <opencv2/imgproc.hpp>

#include "live_graph.h"
#include "vision_world.h"

namespace radar_dot::test {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using sensor_msgs::Image;

constexpr const char* kVerdict = "segmentation: segmentation";

/// Messages of one image; faults change them, or send none by clearing `send...`.
struct Frame {
  Flow flow, flow_back;
  Image depth, depth_std;
  sensor_msgs::CameraInfo camera;
  geometry_msgs::TwistWithCovarianceStamped twist;
  bool send_depth = true, send_depth_std = true, send_twist = true, send_camera = true;
};
using Fault = std::function<void(Frame&)>;

/// Publishes the world at 10 Hz from a thread.
class LiveWorld {
 public:
  explicit LiveWorld(ros::NodeHandle& handle)
      : flow_(handle.advertise<Flow>("flow", 10)),
        flow_back_(handle.advertise<Flow>("flow/backward", 10)),
        depth_(handle.advertise<Image>("depth", 10)),
        depth_std_(handle.advertise<Image>("depth/uncertainty", 10)),
        camera_(handle.advertise<sensor_msgs::CameraInfo>("camera_info", 10)),
        twist_(handle.advertise<geometry_msgs::TwistWithCovarianceStamped>("ego/twist", 10)) {
    broadcaster_.sendTransform(VisionWorld::mount());
  }
  void set(const Fault& fault) {
    const std::lock_guard<std::mutex> lock(mutex_);
    fault_ = fault;
  }
  void setBackward(bool backward) { backward_ = backward; }
  void shiftTime(double seconds) { offset_ = seconds; }

 private:
  void publish() {
    // Of now, less than the tolerance behind: a clock that is not ours must not matter.
    const ros::Time stamp = ros::Time::now() + ros::Duration(offset_);
    Frame frame;
    frame.depth = VisionWorld::depth(stamp);
    frame.depth_std =
        imageOf(stamp, "32FC1",
                cv::Mat(VisionWorld::kGridHeight, VisionWorld::kGridWidth, CV_32FC1, cv::Scalar(0.05)));
    frame.camera = VisionWorld::cameraInfo(stamp);
    frame.twist = VisionWorld::twist(stamp);
    if (!before_.isZero()) {
      frame.flow_back = VisionWorld::flow(stamp, before_);
      frame.flow = backward_ ? frame.flow_back : VisionWorld::flow(before_, stamp);
    }
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (fault_) fault_(frame);
    }
    if (frame.send_camera) camera_.publish(frame.camera);
    if (frame.send_twist) twist_.publish(frame.twist);
    if (frame.send_depth_std) depth_std_.publish(frame.depth_std);
    if (frame.send_depth) depth_.publish(frame.depth);
    if (!before_.isZero()) {
      flow_back_.publish(frame.flow_back);
      flow_.publish(frame.flow);
    }
    before_ = stamp;
  }

  ros::Publisher flow_, flow_back_, depth_, depth_std_, camera_, twist_;
  tf2_ros::StaticTransformBroadcaster broadcaster_;
  std::mutex mutex_;
  Fault fault_;
  std::atomic<bool> backward_{false};
  std::atomic<double> offset_{0.0};
  ros::Time before_;  // stamp of the previous image
  Ticker ticker_{1.0 / VisionWorld::kPeriod, [this] { publish(); }};
};

class SegmentationFaults : public testing::Test {
 protected:
  static void SetUpTestSuite() { graph_ = std::make_unique<Graph>(); }
  static void TearDownTestSuite() { graph_.reset(); }
  void SetUp() override {
    world_.set({});
    world_.setBackward(false);
    ASSERT_TRUE(masks_.grows());
  }

  /// Runs a fault until `name` reports it; the nodelet must then get over it.
  void expectReported(const Fault& fault, const std::string& name, const std::string& words,
                      int level = DiagnosticStatus::ERROR) {
    world_.set(fault);
    EXPECT_TRUE(diagnostics_.says(name, level, words));
    world_.set({});
    EXPECT_TRUE(masks_.grows()) << "after " << words;
    EXPECT_TRUE(diagnostics_.says(name, DiagnosticStatus::OK, ""));
  }
  static bool choose(const std::vector<Setting>& settings) {
    return !reconfigure("segmentation", settings).empty();
  }

  static double maskIou(const Image& message) {
    const cv::Mat mask = matOf(message, CV_8UC1);
    if (mask.size() != cv::Size(VisionWorld::kWidth, VisionWorld::kHeight)) return 0.0;
    cv::Mat truth = cv::Mat::zeros(VisionWorld::kGridHeight, VisionWorld::kGridWidth, CV_8UC1);
    truth(VisionWorld::patch()).setTo(255);
    cv::resize(truth, truth, mask.size(), 0.0, 0.0, cv::INTER_NEAREST);
    return static_cast<double>(cv::countNonZero(mask & truth)) / cv::countNonZero(mask | truth);
  }
  /// Largest residual outside of the patch, px of the grid.
  static double largestStaticResidual(const Image& message) {
    cv::Mat residual = matOf(message, CV_32FC1);
    residual(VisionWorld::patch()).setTo(0.0F);
    double largest = 0.0;
    cv::minMaxLoc(residual, nullptr, &largest);
    return largest;
  }
  /// Checks the latest mask and residual of the given direction.
  void expectExact(bool backward) {
    world_.setBackward(backward);
    ASSERT_TRUE(masks_.grows(6));  // none of the other direction is under way any more
    EXPECT_GT(maskIou(*masks_.latest()), 0.9);
    // Signs, lever arm and yaw: a wrong one would leave pixels of residual.
    EXPECT_LT(largestStaticResidual(*residuals_.latest()), 0.02);
  }

  /// For all tests: connecting takes longer than most of them.
  struct Graph {
    ros::NodeHandle handle;
    Recorder<Image> masks{handle, "dynamic/mask"}, valids{handle, "dynamic/valid"},
        residuals{handle, "dynamic/residual"}, unaided{handle, "unaided/mask"};
    Diagnostics diagnostics{handle};
    LiveWorld world{handle};
  };
  static inline std::unique_ptr<Graph> graph_;
  ros::NodeHandle& handle_ = graph_->handle;
  Recorder<Image>&masks_ = graph_->masks, &valids_ = graph_->valids, &residuals_ = graph_->residuals,
  &unaided_ = graph_->unaided;
  Diagnostics& diagnostics_ = graph_->diagnostics;
  LiveWorld& world_ = graph_->world;
};

TEST_F(SegmentationFaults, MaskAtThePreviousImageIsExact) { expectExact(false); }

TEST_F(SegmentationFaults, MaskAtTheCurrentImageIsExact) { expectExact(true); }

TEST_F(SegmentationFaults, TheScoreByUncertaintyFindsTheSame) {
  ASSERT_TRUE(choose({{"score", "uncertainty"}, {"flow_std", 1.0}}));
  expectExact(false);
  expectExact(true);
  ASSERT_TRUE(choose({{"score", "paper"}}));
}

// Of the patch, half is seen in every second flow only, or not at all.
TEST_F(SegmentationFaults, ThePastTellsWhatTheFlowDoesNot) {
  const auto usePast = [](bool look_back, double memory) {
    // What is believed alone starts no region where one must exceed a multiple of the threshold.
    return choose({{"score", look_back || memory > 0.0 ? "uncertainty" : "paper"},
                   {"look_back", look_back},
                   {"flow_std", 1.0},
                   {"memory", memory},
                   {"hysteresis_ratio", 1.0}});
  };
  // The right half: from there the flow back leads into the patch of the previous image.
  cv::Rect hidden = VisionWorld::patch();
  hidden.width /= 2;
  hidden.x += hidden.width;
  const auto hide = [hidden](Frame& frame) {
    cv::Mat flow(VisionWorld::kGridHeight, VisionWorld::kGridWidth, CV_32FC2, frame.flow.flow.data.data());
    flow(hidden).setTo(cv::Scalar::all(std::numeric_limits<double>::quiet_NaN()));
  };
  const auto ious = [&](std::size_t count) {
    std::vector<double> values;
    const std::size_t before = masks_.count() + 3;
    EXPECT_TRUE(waitUntil([&] { return masks_.count() >= before + count; }));
    const auto messages = masks_.messages();
    for (std::size_t i = before; i < messages.size(); ++i) values.push_back(maskIou(*messages[i]));
    return values;
  };
  world_.set(hide);
  for (const double iou : ious(3)) EXPECT_LT(iou, 0.6);
  ASSERT_TRUE(usePast(true, 0.0));
  for (const double iou : ious(3)) EXPECT_GT(iou, 0.85);

  ASSERT_TRUE(usePast(false, 0.5));
  auto every_second = std::make_shared<bool>(false);
  world_.set([hide, every_second](Frame& frame) {
    *every_second = !*every_second;
    if (*every_second) hide(frame);
  });
  for (const double iou : ious(4)) EXPECT_GT(iou, 0.85);
  ASSERT_TRUE(usePast(false, 0.0));
  double worst = 1.0;
  for (const double iou : ious(4)) worst = std::min(worst, iou);
  EXPECT_LT(worst, 0.6);
  world_.set({});
}

// The motion was right before; the image must not spoil it.
TEST_F(SegmentationFaults, TheRefinedMotionIsPublished) {
  ASSERT_TRUE(choose({{"refine", true}}));
  const Recorder<geometry_msgs::TwistWithCovarianceStamped> twists(handle_, "ego/twist_refined");
  for (const bool backward : {false, true}) {
    expectExact(backward);
    ASSERT_TRUE(twists.grows(2));
    const geometry_msgs::TwistWithCovarianceStamped& twist = *twists.latest();
    EXPECT_EQ(twist.header.frame_id, "base_link");
    EXPECT_NEAR(twist.twist.twist.linear.x, VisionWorld::kSpeed, 0.2);
    EXPECT_NEAR(twist.twist.twist.linear.y, 0.0, 0.1);
    EXPECT_NEAR(twist.twist.twist.angular.z, VisionWorld::kYawRate, 0.02);
    EXPECT_NEAR(twist.twist.twist.angular.y, 0.0, 0.02);
    EXPECT_GT(twist.twist.covariance[0], 0.0);
    EXPECT_LT(twist.twist.covariance[0], 0.02);  // the radar's 0.1 m/s and better
  }
  ASSERT_TRUE(choose({{"refine", false}}));
}

// By 40 of its standard deviations.
TEST_F(SegmentationFaults, AYawRateThatTheImageContradictsIsNamed) {
  ASSERT_TRUE(choose({{"refine", true}}));
  world_.set([](Frame& frame) { frame.twist.twist.twist.angular.z = VisionWorld::kYawRate + 0.25; });
  EXPECT_TRUE(
      diagnostics_.says(kVerdict, DiagnosticStatus::WARN, "turns by 0.35 rad/s, the image by 0.10 (over"));
  EXPECT_GT(maskIou(*masks_.latest()), 0.9);
  world_.set({});
  EXPECT_TRUE(diagnostics_.says(kVerdict, DiagnosticStatus::OK, ""));
  ASSERT_TRUE(choose({{"refine", false}}));
}

// The wall is said to be twice as far as it is; the flow tells. Nothing else needs the flow back.
TEST_F(SegmentationFaults, DepthFromMotionIsPublished) {
  world_.set([](Frame& frame) {
    frame.depth = imageOf(frame.depth.header.stamp, "32FC1", 2.0 * matOf(frame.depth, CV_32FC1));
    frame.flow_back.fb_error =
        imageOf(frame.flow_back.header.stamp, "32FC1",
                cv::Mat(VisionWorld::kGridHeight, VisionWorld::kGridWidth, CV_32FC1, cv::Scalar(0.1)));
  });
  const Recorder<Image> depths(handle_, "depth/motion"), stds(handle_, "depth/motion/uncertainty");
  // Aside of where the camera drives to, so that there is parallax.
  const cv::Point pixel(5, 45);
  ASSERT_TRUE(waitUntil([&] {
    return depths.count() > 0 && std::abs(matOf(*depths.latest(), CV_32FC1).at<float>(pixel) -
                                          VisionWorld::kDepth) < 0.25 * VisionWorld::kDepth;
  }));
  const Image depth = *depths.latest();
  EXPECT_EQ(depth.header.frame_id, VisionWorld::kCameraFrame);
  EXPECT_TRUE(waitUntil([&] {
    for (const auto& std : stds.messages())
      if (std->header.stamp == depth.header.stamp) return matOf(*std, CV_32FC1).at<float>(pixel) < 0.4F;
    return false;
  }));
}

// The score with the uncertainty that comes with the depth.
class DepthUncertainty : public SegmentationFaults {
 protected:
  void SetUp() override {
    SegmentationFaults::SetUp();
    ASSERT_TRUE(choose({{"score", "uncertainty"}, {"use_depth_uncertainty", true}, {"flow_std", 1.0}}));
    ASSERT_TRUE(masks_.grows(6));
  }
  void TearDown() override {
    world_.set({});
    EXPECT_TRUE(choose({{"score", "paper"}, {"use_depth_uncertainty", false}}));
  }
  /// A pixel on the patch that moves.
  static float scoreOf(const Image& message) {
    return matOf(message, CV_32FC1).at<float>(VisionWorld::patch().y + 10, VisionWorld::patch().x + 20);
  }
  double latestScore() {
    EXPECT_TRUE(scores_.grows(6));
    return static_cast<double>(scoreOf(*scores_.latest()));
  }
  Recorder<Image> scores_{handle_, "dynamic/score"};
};

TEST_F(DepthUncertainty, LowersTheScoreWhereDepthIsUncertain) {
  EXPECT_GT(maskIou(*masks_.latest()), 0.9);
  const double sure = latestScore();
  world_.set([](Frame& frame) {
    cv::Mat stds = matOf(frame.depth_std, CV_32FC1).clone();
    stds.setTo(30.0F);
    frame.depth_std = imageOf(frame.depth_std.header.stamp, "32FC1", stds);
  });
  const double unsure = latestScore();
  EXPECT_LT(unsure, 0.9 * sure);
  ASSERT_TRUE(choose({{"use_depth_uncertainty", false}}));  // it is not looked at any more
  EXPECT_GT(latestScore(), unsure / 0.9);
}

TEST_F(DepthUncertainty, WhatIsWrongIsRefused) {
  expectReported([](Frame& frame) { frame.depth_std.encoding = "16UC1"; }, kVerdict, "depth uncertainty");
  expectReported(
      [](Frame& frame) {
        frame.depth_std = imageOf(frame.depth_std.header.stamp, "32FC1", cv::Mat::ones(90, 90, CV_32FC1));
      },
      kVerdict, "/depth/uncertainty");
}

// Without it the parameter holds, masks go on at once, and the diagnostic says so.
TEST_F(DepthUncertainty, MasksDoNotWaitForIt) {
  expectReported([](Frame& frame) { frame.send_depth_std = false; }, kVerdict, "/depth/uncertainty",
                 DiagnosticStatus::WARN);
  // Another stamp than that of the first image is another image's.
  expectReported([](Frame& frame) { frame.depth_std.header.stamp += ros::Duration(0.001); }, kVerdict,
                 "/depth/uncertainty", DiagnosticStatus::WARN);
  world_.set([](Frame& frame) { frame.send_depth_std = false; });
  ASSERT_TRUE(masks_.grows(6));
  EXPECT_GT(maskIou(*masks_.latest()), 0.9);
}

TEST_F(SegmentationFaults, StampAndSizeAreThoseOfTheFirstImage) {
  Recorder<Flow> flows(handle_, "flow");
  ASSERT_TRUE(masks_.grows(6));
  const Image mask = *masks_.latest();
  EXPECT_EQ(mask.encoding, "mono8");
  EXPECT_EQ(mask.header.frame_id, VisionWorld::kCameraFrame);
  bool found = false;
  for (const auto& flow : flows.messages()) found = found || flow->header.stamp == mask.header.stamp;
  EXPECT_TRUE(found);
}

TEST_F(SegmentationFaults, WrongFlowIsRefused) {
  expectReported([](Frame& frame) { frame.flow.flow.encoding = "32FC1"; }, kVerdict, "32FC1");
  expectReported([](Frame& frame) { frame.flow.image_width = 640; }, kVerdict, "camera_info");
  expectReported([](Frame& frame) { frame.flow.flow.data.resize(100); }, kVerdict, "flow");
  expectReported([](Frame& frame) { frame.flow.second_stamp = frame.flow.header.stamp; },
                 "segmentation: input flow", "second_stamp");
  expectReported([](Frame& frame) { frame.flow.header.frame_id = "nowhere"; }, kVerdict, "nowhere");
  expectReported([](Frame& frame) { frame.flow.header.frame_id.clear(); }, "segmentation: input flow",
                 "frame_id");
  expectReported([](Frame& frame) { frame.flow.header.stamp = ros::Time(); }, "segmentation: input flow",
                 "stamp");
}

TEST_F(SegmentationFaults, WrongDepthIsRefused) {
  expectReported([](Frame& frame) { frame.depth.encoding = "rgb8"; }, kVerdict, "rgb8");
  expectReported(
      [](Frame& frame) {
        frame.depth = imageOf(frame.depth.header.stamp, "32FC1", cv::Mat::ones(90, 90, CV_32FC1));
      },
      kVerdict, "shape");
}

TEST_F(SegmentationFaults, WrongCameraIsRefused) {
  expectReported([](Frame& frame) { frame.camera.P[0] = frame.camera.K[0] = 0.0; }, kVerdict, "camera_info");
  // As of a driver that takes half of the pixels, but does not say so.
  expectReported([](Frame& frame) { frame.camera.binning_x = frame.camera.binning_y = 2; }, kVerdict,
                 "160 x 90 px (with its roi and binning)");
}

TEST_F(SegmentationFaults, ACameraOfTheWholeSensorIsCroppedAndBinned) {
  world_.set([](Frame& frame) {
    sensor_msgs::CameraInfo& camera = frame.camera;
    camera.width = 2 * VisionWorld::kWidth + 60;
    camera.height = 2 * VisionWorld::kHeight + 40;
    camera.binning_x = camera.binning_y = 2;
    camera.roi.x_offset = 60;
    camera.roi.y_offset = 40;
    camera.roi.width = 2 * VisionWorld::kWidth;
    camera.roi.height = 2 * VisionWorld::kHeight;
    camera.K = {400.0, 0.0, 379.5, 0.0, 400.0, 219.5, 0.0, 0.0, 1.0};  // of pixels of half the size
    camera.P.fill(0.0);
  });
  ASSERT_TRUE(masks_.grows(6));
  EXPECT_GT(maskIou(*masks_.latest()), 0.9);
  EXPECT_LT(largestStaticResidual(*residuals_.latest()), 0.02);
}

TEST_F(SegmentationFaults, ACameraThatSeemsUnrectifiedIsNamed) {
  expectReported(
      [](Frame& frame) {
        frame.camera.D = {-0.3, 0.1, 0.0, 0.0, 0.0};
      },
      "segmentation: input camera_info", "a P that is K", DiagnosticStatus::WARN);
}

TEST_F(SegmentationFaults, AnImageFrameThatIsNoOpticalOneIsRefused) {
  tf2_ros::StaticTransformBroadcaster broadcaster;
  geometry_msgs::TransformStamped body = VisionWorld::mount();
  body.child_frame_id = "camera_body";  // x ahead, z up
  body.transform.rotation = geometry_msgs::Quaternion();
  body.transform.rotation.w = 1.0;
  broadcaster.sendTransform(body);
  expectReported([](Frame& frame) { frame.flow.header.frame_id = "camera_body"; }, kVerdict,
                 "the z axis of 'camera_body' looks up");
  body.child_frame_id = "beyond";
  body.transform.translation.x = 1e300;
  broadcaster.sendTransform(body);
  expectReported([](Frame& frame) { frame.flow.header.frame_id = "beyond"; }, kVerdict,
                 "is no mount on a vehicle");
}

TEST_F(SegmentationFaults, UnknownDepthGivesAnEmptyMask) {
  for (const float value :
       {0.0F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    const auto fault = [value](Frame& frame) {
      frame.depth =
          imageOf(frame.depth.header.stamp, "32FC1",
                  cv::Mat(VisionWorld::kGridHeight, VisionWorld::kGridWidth, CV_32FC1, cv::Scalar(value)));
    };
    world_.set(fault);
    EXPECT_TRUE(waitUntil(
        [&] { return valids_.count() > 0 && cv::countNonZero(matOf(*valids_.latest(), CV_8UC1)) == 0; }));
    EXPECT_EQ(cv::countNonZero(matOf(*masks_.latest(), CV_8UC1)), 0);
    expectReported(fault, kVerdict, "no pixel has both depth and flow", DiagnosticStatus::WARN);
  }
}

TEST_F(SegmentationFaults, SilentInputsAreNamed) {
  expectReported([](Frame& frame) { frame.send_depth = false; }, kVerdict, "/depth");
  expectReported([](Frame& frame) { frame.send_depth = false; }, "segmentation: input depth", "silent");
  expectReported([](Frame& frame) { frame.send_twist = false; }, kVerdict, "/ego/twist");
}

TEST_F(SegmentationFaults, FlowAloneTellsWhereTheSecondDepthIsLost) {
  // Every other depth is lost: pairs that begin with one that came still get a mask.
  auto count = std::make_shared<int>(0);
  world_.set([count](Frame& frame) { frame.send_depth = ++*count % 2 == 0; });
  EXPECT_TRUE(diagnostics_.says(kVerdict, DiagnosticStatus::WARN, "without the depth of the second image"));
  ASSERT_TRUE(masks_.grows());
  EXPECT_GT(maskIou(*masks_.latest()), 0.9);
  world_.set({});
}

TEST_F(SegmentationFaults, YawRatesThatAreNotObservedGiveNoMask) {
  expectReported([](Frame& frame) { frame.twist.twist.covariance[35] = 1e6; }, kVerdict,
                 "do not observe the yaw rate");
}

TEST_F(SegmentationFaults, CameraInfoMayHaveAnyStampAndComeOnce) {
  world_.set([](Frame& frame) { frame.camera.header.stamp = ros::Time(); });
  EXPECT_TRUE(masks_.grows());
  EXPECT_TRUE(diagnostics_.renews("segmentation: input camera_info"));
  EXPECT_EQ(diagnostics_.latest("segmentation: input camera_info").level, DiagnosticStatus::OK);
  world_.set([](Frame& frame) { frame.send_camera = false; });
  EXPECT_TRUE(masks_.grows(10));  // longer than silent_after
  EXPECT_TRUE(diagnostics_.renews("segmentation: input camera_info"));
  EXPECT_EQ(diagnostics_.latest("segmentation: input camera_info").level, DiagnosticStatus::OK);
  world_.set({});
}

// Differences of such stamps are no ros::Duration.
TEST_F(SegmentationFaults, FlowToTheEndOfTimeIsRefused) {
  expectReported([](Frame& frame) { frame.flow.second_stamp = ros::Time(4'294'967'000U, 0); }, kVerdict,
                 "no motion of the vehicle");
}

TEST_F(SegmentationFaults, WrongTwistIsRefused) {
  expectReported([](Frame& frame) { frame.twist.header.frame_id = "radar"; }, "segmentation: input ego/twist",
                 "base_link");
  expectReported(
      [](Frame& frame) { frame.twist.twist.twist.linear.x = std::numeric_limits<double>::quiet_NaN(); },
      "segmentation: input ego/twist", "finite");
}

TEST_F(SegmentationFaults, TimeMayGoBack) {
  world_.shiftTime(-100.0);
  ASSERT_TRUE(masks_.grows());
  ASSERT_TRUE(
      waitUntil([&] { return ros::Time::now().toSec() - masks_.latest()->header.stamp.toSec() > 50.0; }));
  EXPECT_GT(maskIou(*masks_.latest()), 0.9);
  world_.shiftTime(0.0);
  EXPECT_TRUE(masks_.grows());
}

// Returns that stand still where the patch moves: a gain for them lowers its score.
TEST_F(SegmentationFaults, StaticReturnsLowerTheScore) {
  const auto isEmpty = [this] { return cv::countNonZero(matOf(*masks_.latest(), CV_8UC1)) == 0; };
  ros::Publisher publisher = handle_.advertise<sensor_msgs::PointCloud2>("radar/static", 10);
  const cv::Rect patch = VisionWorld::patch();
  const CameraIntrinsics camera =
      VisionWorld::camera().scaledTo(VisionWorld::kGridWidth, VisionWorld::kGridHeight);
  // One above the other, as a footprint is not high.
  std::vector<Eigen::Vector3f> points;
  for (int row = patch.y; row <= patch.y + patch.height; ++row) {
    const Eigen::Vector3d ray = camera.rayOf(patch.x + 0.5 * patch.width, row);
    points.emplace_back((VisionWorld::kDepth * ray).cast<float>());
  }
  world_.set([&](Frame& frame) {
    publisher.publish(cloudOf(frame.depth.header.stamp, VisionWorld::kCameraFrame, points));
  });
  EXPECT_FALSE(isEmpty());
  EXPECT_EQ(publisher.getNumSubscribers(), 0U) << "without a gain they are of no use";
  ASSERT_TRUE(choose({{"static_gain", 100.0}, {"radar_radius", 20.0}}));
  EXPECT_TRUE(waitUntil(isEmpty));
  EXPECT_EQ(publisher.getNumSubscribers(), 1U);
  ASSERT_TRUE(choose({{"static_gain", 0.0}, {"radar_radius", 1.0}}));
  EXPECT_TRUE(waitUntil([&] { return !isEmpty(); }));
  EXPECT_EQ(publisher.getNumSubscribers(), 0U);
  world_.set({});
}

TEST_F(SegmentationFaults, WithoutItsRotationTheTwistHasToDo) {
  ASSERT_TRUE(unaided_.grows());
  EXPECT_GT(maskIou(*unaided_.latest()), 0.9);
  EXPECT_TRUE(diagnostics_.says("unaided: segmentation", DiagnosticStatus::ERROR, "rotation"));
}

TEST_F(SegmentationFaults, BadParametersAreReplacedAndReconfigured) {
  // k was not a number at start: the default is in use, and the diagnostic says so.
  EXPECT_TRUE(
      diagnostics_.says("unaided: segmentation", DiagnosticStatus::ERROR, "k is nan, must be between"));
  EXPECT_EQ(reconfigure("segmentation", {{"k", 6.0}}).at("k"), "6");
  EXPECT_TRUE(masks_.grows());
}

}  // namespace
}  // namespace radar_dot::test
