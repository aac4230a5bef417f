// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// Decoding, flow, depth and overlay with images, clouds and depth whose results are known, and wrong ones.
#include <gtest/gtest.h>
#include <rosgraph_msgs/Log.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "live_camera.h"
#include "live_graph.h"
#include "radar_dot/common/quantile.h"
#include "vision_world.h"

namespace radar_dot::test {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using sensor_msgs::Image;

constexpr double kShift = LiveCamera::kShift;
// The return 12 m ahead of the base was seen 0.1 s before; the camera sits 1.7 m ahead of the base.
constexpr double kExpectedDepth = LiveCamera::kReturnAhead - VisionWorld::kSpeed * 0.1 - 1.7;  // m
using Frame = LiveCamera::Frame;
using Fault = LiveCamera::Fault;

class ImageInputs : public testing::Test {
 protected:
  void expectReported(const Fault& fault, const std::string& name, const std::string& words) {
    camera_.set(fault);
    EXPECT_TRUE(diagnostics_.says(name, DiagnosticStatus::WARN, words));
    camera_.set({});
    EXPECT_TRUE(diagnostics_.says(name, DiagnosticStatus::OK, ""));
  }
  /// Median horizontal flow in px of the image from one image to the next, whichever images a pair is of. The
  /// pairs over which the texture starts again show as outliers that the median over messages leaves out.
  static double medianFlow(const Recorder<Flow>& flows, const Recorder<Image>& images) {
    std::map<ros::Time, int> numbers;
    for (const auto& image : images.messages())
      numbers.emplace(image->header.stamp, static_cast<int>(numbers.size()));
    std::vector<double> medians;
    for (const auto& flow : flows.messages()) {
      const auto first = numbers.find(flow->header.stamp), second = numbers.find(flow->second_stamp);
      if (first == numbers.end() || second == numbers.end()) continue;
      const cv::Mat field = matOf(flow->flow, CV_32FC2);
      std::vector<double> values;
      for (int row = 20; row < field.rows - 20; ++row)
        for (int column = 40; column < field.cols - 40; ++column)
          values.push_back(static_cast<double>(field.at<cv::Vec2f>(row, column)[0]));
      medians.push_back(quantileOf(values) * flow->image_width / field.cols /
                        (second->second - first->second));
    }
    return quantileOf(medians);
  }
  static float depthAt(const Image& message, int row, int column) {
    return matOf(message, CV_32FC1).at<float>(row, column);
  }

  ros::NodeHandle handle_;
  Diagnostics diagnostics_{handle_};
  LiveCamera camera_{handle_};
};

TEST_F(ImageInputs, FlowRunsForwardOnRawImages) {
  const Recorder<Image> images(handle_, "image");
  ASSERT_TRUE(images.grows());
  const Recorder<Flow> flows(handle_, "raw_flow/flow");
  ASSERT_TRUE(flows.grows(9));
  EXPECT_NEAR(medianFlow(flows, images), kShift, 0.5);
  const Flow& flow = *flows.latest();
  EXPECT_EQ(flow.flow.width, 160U);
  EXPECT_EQ(flow.image_width, 320U);
  EXPECT_LT(flow.header.stamp, flow.second_stamp);
}

TEST_F(ImageInputs, FlowRunsBackwardOnCompressedImagesFartherApart) {
  const Recorder<Image> images(handle_, "image");
  ASSERT_TRUE(images.grows());
  const Recorder<Flow> flows(handle_, "backward_flow/flow");
  ASSERT_TRUE(flows.grows(9));
  EXPECT_NEAR(medianFlow(flows, images), kShift, 0.5);
  const Flow& flow = *flows.latest();
  EXPECT_EQ(flow.flow.width, 320U);
  EXPECT_EQ(flow.valid.encoding, "mono8");
  EXPECT_GT(flow.header.stamp, flow.second_stamp);
  EXPECT_TRUE(waitUntil([&] {
    return std::abs((flows.latest()->header.stamp - flows.latest()->second_stamp).toSec() - 0.2) < 0.05;
  }));
}

TEST_F(ImageInputs, ATopicWithoutImagesIsNamedOnce) {
  const Recorder<rosgraph_msgs::Log> log(handle_, "/rosout");
  const Recorder<Flow> flows(handle_, "lost/flow");
  const Recorder<Image> images(handle_, "lost/image");
  const auto complaints = [&log] {
    std::vector<std::string> lines;
    for (const rosgraph_msgs::LogConstPtr& line : log.messages())
      if (line->msg.find("nothing on '/lost/image") != std::string::npos) lines.push_back(line->msg);
    return lines;
  };
  ASSERT_TRUE(waitUntil([&] { return !complaints().empty(); }));
  EXPECT_NE(complaints().front().find("image/compressed"), std::string::npos) << "the images at hand";
  EXPECT_FALSE(waitUntil([&] { return complaints().size() > 1; }, 4.0)) << complaints().back();
}

TEST_F(ImageInputs, FlowThatStartsFromTheExpectedOneWaitsForIt) {
  const Recorder<Flow> flows(handle_, "expected_flow/flow");
  ASSERT_TRUE(flows.grows());
  // Without depth it goes on without an initial flow, and says so.
  expectReported([](Frame& frame) { frame.depth.header.stamp += ros::Duration(0.001); },
                 "expected_flow: flow", "without an initial flow");
}

TEST_F(ImageInputs, WrongImagesAreRefused) {
  const Recorder<Flow> raw(handle_, "raw_flow/flow");
  const Recorder<Flow> compressed(handle_, "backward_flow/flow");
  ASSERT_TRUE(raw.grows());
  expectReported([](Frame& frame) { frame.image.encoding = "purple8"; }, "raw_flow: input image", "purple8");
  expectReported([](Frame& frame) { frame.image.data.resize(10); }, "raw_flow: input image", "image");
  expectReported([](Frame& frame) { frame.image.width = frame.image.height = 0; }, "raw_flow: input image",
                 "empty");
  expectReported(
      [](Frame& frame) { frame.compressed.data.resize(frame.compressed.data.size() > 30 ? 30 : 0); },
      "backward_flow: input image", "decoded");
  EXPECT_TRUE(raw.grows());
  EXPECT_TRUE(compressed.grows());
}

TEST_F(ImageInputs, JpegsThatEndEarlyAreRefused) {
  const Recorder<Flow> compressed(handle_, "backward_flow/flow");
  ASSERT_TRUE(compressed.grows());
  expectReported(
      [](Frame& frame) {
        std::vector<std::uint8_t>& bytes = frame.compressed.data;
        cv::imencode(".jpg", matOf(frame.image, CV_8UC1), bytes);
        bytes.resize(bytes.size() / 2);
      },
      "backward_flow: input image", "Premature end");
  EXPECT_TRUE(compressed.grows());
}

/// Every other image is the one before again.
class Repeating {
 public:
  void operator()(Frame& frame) {
    is_repeated_ = !is_repeated_;
    if (is_repeated_) {
      frame.image.data = before_.image.data;
      frame.compressed.data = before_.compressed.data;
    } else {
      before_ = frame;
    }
  }

 private:
  bool is_repeated_ = true;
  Frame before_;
};

TEST_F(ImageInputs, PairsReachAcrossImagesThatRepeat) {
  const Recorder<Image> images(handle_, "image");
  const Recorder<Flow> before(handle_, "raw_flow/flow"), expected(handle_, "expected_flow/flow");
  ASSERT_TRUE(before.grows() && expected.grows());
  camera_.set(Repeating());
  EXPECT_TRUE(diagnostics_.says("raw_flow: flow", DiagnosticStatus::WARN, "repeat the previous one"));
  EXPECT_TRUE(diagnostics_.says("expected_flow: flow", DiagnosticStatus::WARN, "repeat the previous one"));
  const Recorder<Flow> flows(handle_, "raw_flow/flow");
  ASSERT_TRUE(flows.grows(9));
  for (const auto& flow : flows.messages())
    EXPECT_NEAR((flow->second_stamp - flow->header.stamp).toSec(), 0.2, 0.05);
  EXPECT_NEAR(medianFlow(flows, images), kShift, 0.5);
  camera_.set({});
  EXPECT_TRUE(diagnostics_.says("raw_flow: flow", DiagnosticStatus::OK, ""));
}

// A simulated camera has no noise.
TEST_F(ImageInputs, ImagesOfAVehicleThatStandsMayBeTheSame) {
  camera_.set([](Frame& frame) {
    frame.image = VisionWorld::image(frame.image.header.stamp, 0.0);
    frame.twist.twist.twist = {};
  });
  const Recorder<Image> images(handle_, "image");
  ASSERT_TRUE(images.grows(9));
  const Recorder<Flow> flows(handle_, "expected_flow/flow");
  ASSERT_TRUE(flows.grows(3));
  EXPECT_TRUE(waitUntil([&] { return cv::norm(matOf(flows.latest()->flow, CV_32FC2), cv::NORM_INF) < 0.1; }));
}

TEST_F(ImageInputs, ImagesMayChangeTheirSize) {
  const Recorder<Flow> raw(handle_, "raw_flow/flow");
  ASSERT_TRUE(raw.grows());
  camera_.set([](Frame& frame) {
    cv::Mat larger;
    cv::resize(matOf(frame.image, CV_8UC1), larger, {640, 360});
    frame.image = imageOf(frame.image.header.stamp, "mono8", larger);
  });
  EXPECT_TRUE(waitUntil([&] { return raw.latest()->image_width == 640U; }));
  camera_.set({});
  EXPECT_TRUE(waitUntil([&] { return raw.latest()->image_width == 320U; }));
}

TEST_F(ImageInputs, DecodedImagesAreTheOriginals) {
  const Recorder<Image> decoded(handle_, "decode/image");
  const Recorder<Image> original(handle_, "image");
  boost::shared_ptr<const Image> image, sent;
  ASSERT_TRUE(waitUntil([&] {
    for (const auto& candidate : original.messages())
      for (const auto& made : decoded.messages())
        if (candidate->header.stamp == made->header.stamp) image = made, sent = candidate;
    return image != nullptr;
  }));
  EXPECT_EQ(image->encoding, "bgr8");
  cv::Mat colour;
  cv::cvtColor(matOf(*sent, CV_8UC1), colour, cv::COLOR_GRAY2BGR);
  EXPECT_EQ(cv::norm(colour, matOf(*image, CV_8UC3), cv::NORM_INF), 0.0);
}

// Where the machine is busy a cloud may come after its image: an older one takes its place in that depth.
TEST_F(ImageInputs, RadarDepthFollowsTheVehicle) {
  const Recorder<Image> depths(handle_, "ground_depth/depth");
  ASSERT_TRUE(depths.grows());
  ASSERT_EQ(depths.latest()->encoding, "32FC1");
  ASSERT_EQ(depths.latest()->width, 160U);
  boost::shared_ptr<const Image> latest;
  EXPECT_TRUE(waitUntil([&] {
    latest = depths.latest();
    return std::abs(depthAt(*latest, 50, 80) - kExpectedDepth) < 0.1;  // just below the horizon
  }));
  const Image& depth = *latest;
  // The ground 0.15 m below the lower border of the image's middle column: z f / (v - c) = height.
  const double ground = 1.5 * 100.0 / (89.0 - 44.5);
  EXPECT_NEAR(depthAt(depth, 89, 20), ground, 0.1);
  EXPECT_TRUE(std::isnan(depthAt(depth, 5, 5)));  // the sky
}

TEST_F(ImageInputs, LidarDepthFollowsTheVehicle) {
  const Recorder<Image> depths(handle_, "lidar_depth/depth");
  ASSERT_TRUE(depths.grows());
  EXPECT_TRUE(waitUntil([&] {
    double largest = 0.0;
    cv::Mat depth = matOf(*depths.latest(), CV_32FC1);
    cv::patchNaNs(depth, 0.0);
    cv::minMaxLoc(depth, nullptr, &largest);
    return std::abs(largest - kExpectedDepth) < 0.1;
  }));
}

TEST_F(ImageInputs, SomebodyElsesDepthIsCleaned) {
  const Recorder<Image> depths(handle_, "topic_depth/depth");
  ASSERT_TRUE(depths.grows());
  EXPECT_FLOAT_EQ(depthAt(*depths.latest(), 40, 40), 7.5F);
  EXPECT_EQ(depths.latest()->width, 160U);
  camera_.set([](Frame& frame) {
    frame.depth = imageOf(frame.depth.header.stamp, "32FC1",
                          cv::Mat(180, 320, CV_32FC1, cv::Scalar(std::numeric_limits<double>::infinity())));
  });
  EXPECT_TRUE(waitUntil([&] { return std::isnan(depthAt(*depths.latest(), 40, 40)); }));
  expectReported([](Frame& frame) { frame.depth.encoding = "bgr8"; }, "topic_depth: input depth/input",
                 "bgr8");
}

// With the stamp and the grid of the depth, and known where that is.
TEST_F(ImageInputs, DepthSaysHowUncertainItIs) {
  // Waits for a pair whose uncertainty is as it should be; all pairs must fit.
  const auto expect = [this](const std::string& name, const std::function<bool(const cv::Mat&)>& is_right) {
    const Recorder<Image> depths(handle_, name + "/depth");
    const Recorder<Image> stds(handle_, name + "/uncertainty");
    EXPECT_TRUE(waitUntil([&] {
      for (const auto& depth : depths.messages()) {
        for (const auto& std : stds.messages()) {
          if (std->header.stamp != depth->header.stamp) continue;
          EXPECT_EQ(std->encoding, "32FC1") << name;
          EXPECT_EQ(std->header.frame_id, depth->header.frame_id) << name;
          const cv::Mat known = matOf(*depth, CV_32FC1), declared = matOf(*std, CV_32FC1);
          EXPECT_EQ(known.size(), declared.size()) << name;
          EXPECT_EQ(cv::countNonZero((known == known) != (declared == declared)), 0) << name;
          if (is_right(declared)) return true;
        }
      }
      return false;
    })) << name;
  };
  expect("topic_depth", [](const cv::Mat& stds) { return stds.at<float>(40, 40) == 0.125F; });
  expect("ground_depth", [](const cv::Mat& stds) {
    const float ground = stds.at<float>(89, 20);  // that is not flat
    return stds.at<float>(50, 80) == 0.25F /* the column of the return */ && ground > 0.1F && ground < 0.15F;
  });
  expect("lidar_depth", [](const cv::Mat& stds) {
    double smallest = 0.0;
    cv::minMaxLoc(stds, &smallest);  // leaves NaN out
    return static_cast<float>(smallest) == 0.03125F;
  });
}

// Nobody looks at the depth itself.
TEST_F(ImageInputs, UncertaintyAloneIsReasonEnough) {
  const Recorder<Image> stds(handle_, "misspelt_depth/uncertainty");
  EXPECT_TRUE(stds.grows());
}

TEST_F(ImageInputs, AMisspeltBackendIsReplaced) {
  EXPECT_TRUE(diagnostics_.says("misspelt_depth: depth", DiagnosticStatus::ERROR, "lydar"));
  const Recorder<Image> depths(handle_, "misspelt_depth/depth");
  EXPECT_TRUE(depths.grows());
}

TEST_F(ImageInputs, BackendsAreExchangedLive) {
  const Recorder<Image> depths(handle_, "topic_depth/depth");
  ASSERT_TRUE(depths.grows());
  EXPECT_EQ(reconfigure("topic_depth", {{"depth_backend", "radar_ground"}}).at("depth_backend"),
            "radar_ground");
  EXPECT_TRUE(waitUntil([&] { return std::abs(depthAt(*depths.latest(), 40, 40) - 7.5F) > 0.5F; }));
  EXPECT_EQ(reconfigure("topic_depth", {{"depth_backend", "topic"}}).at("depth_backend"), "topic");
  EXPECT_TRUE(reconfigure("topic_depth", {{"depth_backend", "motion"}}).empty()) << "flow waits for depth";
  EXPECT_TRUE(waitUntil([&] { return std::abs(depthAt(*depths.latest(), 40, 40) - 7.5F) < 1e-3F; }));
}

TEST_F(ImageInputs, PicturesAreDrawnWhileTheyHaveSubscribers) {
  EXPECT_TRUE(diagnostics_.says("overlay: overlay", DiagnosticStatus::OK, "idle: no subscribers"));
  const Recorder<Image> masks(handle_, "overlay/mask");
  const Recorder<Image> panels(handle_, "overlay/six_panel");
  ASSERT_TRUE(masks.grows());
  ASSERT_TRUE(panels.grows());
  EXPECT_EQ(masks.latest()->width, 320U);
  EXPECT_EQ(panels.latest()->encoding, "bgr8");
  EXPECT_EQ(panels.latest()->width, 3U * 640U);
  reconfigure("overlay", {{"panel_width", 160}});
  EXPECT_TRUE(
      waitUntil([&] { return masks.latest()->width == 160U && panels.latest()->width == 3U * 160U; }));
  // A part that does not come is missing in the picture, not the picture.
  camera_.set([](Frame& frame) { frame.depth.header.stamp += ros::Duration(0.001); });
  EXPECT_TRUE(diagnostics_.says("overlay: overlay", DiagnosticStatus::WARN, "/topic_depth/depth"));
  EXPECT_TRUE(panels.grows());
}

/// What moves: rows 60 to 119, columns 120 to 199.
const cv::Rect kMoving(120, 60, 80, 60);

Image movingMask(const ros::Time& stamp) {
  cv::Mat mask = cv::Mat::zeros(180, 320, CV_8UC1);
  mask(kMoving).setTo(255);
  return imageOf(stamp, "mono8", mask);
}

/// What is kept: all but the moving pixels, and those up to `dilation` px from them.
cv::Mat expectedKeep(double dilation) {
  cv::Mat keep(180, 320, CV_8UC1);
  for (int row = 0; row < keep.rows; ++row) {
    for (int column = 0; column < keep.cols; ++column) {
      const int down = std::max({60 - row, row - 119, 0}), right = std::max({120 - column, column - 199, 0});
      keep.at<std::uint8_t>(row, column) = std::hypot(down, right) <= dilation ? 0 : 255;
    }
  }
  return keep;
}

bool same(const cv::Mat& a, const cv::Mat& b) { return cv::norm(a, b, cv::NORM_INF) == 0.0; }

/// The images since the first output, each with the output of its stamp; those that are still waited for are
/// left out. One that is missing is a failure.
std::vector<std::pair<boost::shared_ptr<const Image>, boost::shared_ptr<const Image>>> outputsOf(
    const Recorder<Image>& images, const Recorder<Image>& outputs) {
  const auto made = outputs.messages();
  std::vector<std::pair<boost::shared_ptr<const Image>, boost::shared_ptr<const Image>>> pairs;
  if (made.empty()) return pairs;
  for (const auto& image : images.messages()) {
    const ros::Time& stamp = image->header.stamp;
    if (stamp < made.front()->header.stamp || stamp > made.back()->header.stamp) continue;
    const auto output = std::find_if(made.begin(), made.end(),
                                     [&](const auto& candidate) { return candidate->header.stamp == stamp; });
    if (output == made.end()) {
      ADD_FAILURE() << "nothing for the image at " << stamp;
    } else {
      EXPECT_EQ((*output)->header.frame_id, image->header.frame_id);
      pairs.emplace_back(image, *output);
    }
  }
  return pairs;
}

TEST_F(ImageInputs, EveryImageHasAMaskOfWhatIsKept) {
  EXPECT_TRUE(diagnostics_.says("static_world: static world", DiagnosticStatus::OK, "idle: no subscribers"));
  camera_.set([](Frame& frame) { frame.mask = movingMask(frame.image.header.stamp); });
  const Recorder<Image> images(handle_, "image");
  const Recorder<Image> masks(handle_, "static/mask");
  ASSERT_TRUE(masks.grows(12));
  EXPECT_EQ(diagnostics_.latest("static_world: input depth/input").message, "not subscribed (unused)");
  EXPECT_EQ(diagnostics_.latest("static_world: input points").message, "not subscribed (unused)");
  std::size_t dilated = 0;
  for (const auto& [image, mask] : outputsOf(images, masks)) {
    EXPECT_EQ(mask->encoding, "mono8");
    if (same(matOf(*mask, CV_8UC1), expectedKeep(3.0))) ++dilated;
  }
  EXPECT_GE(dilated, 9U) << "the mask may not be there with the first ones";
  EXPECT_TRUE(
      diagnostics_.says("static_world: static world", DiagnosticStatus::OK, " 0 of them by a mask of"));
}

// A mask of 0.1 s before or after is dilated by 5 px more; farther ones than 0.25 s are not used.
TEST_F(ImageInputs, AnImageWithoutAMaskHasTheNearestOneOrKeepsAll) {
  static std::atomic<int> count{0};
  static std::atomic<bool> none{false};
  camera_.set([](Frame& frame) {
    frame.mask = movingMask(frame.image.header.stamp);
    if (none || ++count % 2 == 0) frame.mask.header.stamp = ros::Time();  // is refused
  });
  const Recorder<Image> images(handle_, "image");
  const Recorder<Image> masks(handle_, "static/mask");
  ASSERT_TRUE(masks.grows(16));
  std::size_t own = 0, other = 0;
  for (const auto& [image, mask] : outputsOf(images, masks)) {
    const int moving = 180 * 320 - cv::countNonZero(matOf(*mask, CV_8UC1));
    const auto movingWithin = [](double dilation) {
      return 180 * 320 - cv::countNonZero(expectedKeep(dilation));
    };
    if (moving == movingWithin(3.0)) ++own;
    // The images are 0.1 s apart, more or less.
    if (moving > movingWithin(6.0) && moving < movingWithin(12.0)) ++other;
  }
  EXPECT_GE(own, 5U);
  EXPECT_GE(other, 5U);
  none = true;
  EXPECT_TRUE(diagnostics_.says("static_world: static world", DiagnosticStatus::WARN,
                                "everything is kept: no mask on '/test/mask' within mask_max_age"));
  ASSERT_TRUE(masks.grows(5));
  EXPECT_EQ(cv::countNonZero(matOf(*masks.latest(), CV_8UC1)), 180 * 320);
  EXPECT_FALSE(outputsOf(images, masks).empty()) << "and no image was left out";
}

TEST_F(ImageInputs, DepthHasHolesWhereSomethingMoves) {
  camera_.set([](Frame& frame) { frame.mask = movingMask(frame.image.header.stamp); });
  const Recorder<Image> depths(handle_, "depth/static");
  ASSERT_TRUE(depths.grows(5));
  EXPECT_EQ(depths.latest()->encoding, "16UC1");
  cv::Mat expected(180, 320, CV_16UC1, cv::Scalar(7500));
  expected.setTo(0, expectedKeep(3.0) == 0);
  EXPECT_TRUE(same(matOf(*depths.latest(), CV_16UC1), expected));
  expectReported([](Frame& frame) { frame.depth.encoding = "bgr8"; }, "static_world: input depth/input",
                 "bgr8");
  // Of the same shape, and nothing in it.
  expectReported(
      [](Frame& frame) {
        frame.depth.width *= 100;
        frame.depth.height *= 100;
        frame.depth.data.clear();
        frame.depth.step = 0;
      },
      "static_world: input depth/input", "its step of 0 bytes is shorter than a row of 32000 px");
  expectReported([](Frame& frame) { frame.depth.header.frame_id = "another"; }, "static_world: static world",
                 "what is masked in 'another'");
  expectReported(
      [](Frame& frame) {
        frame.mask = imageOf(frame.mask.header.stamp, "mono8", cv::Mat::zeros(90, 90, CV_8UC1));
      },
      "static_world: static world", "90 x 90 px does not have the shape of 320 x 180 px");
  expectReported(
      [](Frame& frame) {
        frame.mask = imageOf(frame.mask.header.stamp, "bgr8", cv::Mat::zeros(180, 320, CV_8UC3));
      },
      "static_world: input dynamic/mask", "not mono8");
}

TEST_F(ImageInputs, ImagesWithoutWhatMovesAreTheOriginalsElsewhere) {
  camera_.set([](Frame& frame) {
    frame.mask = movingMask(frame.image.header.stamp);
    frame.image = imageOf(frame.image.header.stamp, "mono8", cv::Mat(180, 320, CV_8UC1, cv::Scalar(90)));
    cv::Mat(180, 320, CV_8UC1, frame.image.data.data())(kMoving).setTo(200);
  });
  const Recorder<Image> images(handle_, "image/static");
  ASSERT_TRUE(images.grows(5));
  EXPECT_TRUE(waitUntil(
      [&] { return same(matOf(*images.latest(), CV_8UC1), cv::Mat(180, 320, CV_8UC1, cv::Scalar(90))); }));
  EXPECT_EQ(images.latest()->encoding, "mono8");
}

// The cloud was scanned 0.06 s before the image of the nearest mask: 0.48 m farther back, and turned by 0.006
// rad. At the time of the image the points 12 m ahead are 9.82 m before the camera; the one 2.2 m to the
// right is 48 px to the right of the middle then, 2 px beyond what moves with its 6 px of dilation. Unmoved
// it would be within.
TEST_F(ImageInputs, PointsOnWhatMovesAreLeftOut) {
  constexpr float kAhead = LiveCamera::kReturnAhead;
  const std::vector<Eigen::Vector3f> points = {{kAhead, 0.F, 1.5F},   {kAhead, 3.F, 1.5F},
                                               {-kAhead, 0.F, 1.5F},  {kAhead, 0.1F, 1.4F},
                                               {kAhead, -2.2F, 1.5F}, {kAhead, -2.F, 1.5F}};
  ros::Publisher clouds = handle_.advertise<sensor_msgs::PointCloud2>("test/points", 10);
  static std::atomic<int> count{0};
  camera_.set([clouds, points](Frame& frame) {
    const ros::Time stamp = frame.image.header.stamp;
    frame.mask = movingMask(stamp);
    if (++count % 2 == 0) {
      clouds.publish(cloudOf(stamp - ros::Duration(0.06), "base_link", points));
    } else {
      frame.mask.header.stamp = ros::Time();  // is refused
    }
  });
  const Recorder<sensor_msgs::PointCloud2> kept(handle_, "points/static");
  ASSERT_TRUE(kept.grows(5));
  EXPECT_TRUE(waitUntil([&] { return kept.latest()->width == 3U; }));
  const sensor_msgs::PointCloud2 expected =
      cloudOf(kept.latest()->header.stamp, "base_link", {points[1], points[2], points[4]});
  EXPECT_EQ(kept.latest()->data, expected.data);
  EXPECT_EQ(kept.latest()->header.frame_id, "base_link");
  EXPECT_EQ(kept.latest()->fields, expected.fields);
  expectReported(
      [clouds, points](Frame& frame) {
        frame.mask = movingMask(frame.image.header.stamp);
        clouds.publish(cloudOf(frame.image.header.stamp, "no_such_frame", points));
      },
      "static_world: input points", "no_such_frame");
}

}  // namespace
}  // namespace radar_dot::test
