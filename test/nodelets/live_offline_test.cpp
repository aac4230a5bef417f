// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// What runs live and what evaluates offline give the same velocities and masks. The messages of a bag go
// through nodelets in this process one by one, each answer awaited, so that no time of computation matters.
#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <gtest/gtest.h>
#include <nodelet/loader.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/PointCloud2.h>
#include <tf2_msgs/TFMessage.h>

#include <boost/make_shared.hpp>
#include <cmath>
#include <filesystem>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "evaluation/scene_depths.h"
#include "evaluation/scene_motion.h"
#include "evaluation/segmentation_images.h"
#include "fixtures/files.h"
#include "live_graph.h"
#include "nodelets/inputs/extrinsics.h"
#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "radar_dot/radar/sweep_estimator.h"
#include "simulated_bag.h"
#include "vision_world.h"

namespace radar_dot::test {
namespace {

namespace fs = std::filesystem;
using sensor_msgs::Image;
using sensor_msgs::PointCloud2;

constexpr double kPatience = 30.0;  // s; machines are slow at times
constexpr const char* kRadars[] = {"back_left", "back_right", "front", "front_left", "front_right"};

/// Everything that a mask can be made of.
evaluation::SegmentationEvaluationOptions offlineOptions(const fs::path& masks) {
  evaluation::SegmentationEvaluationOptions options;
  options.rotation = evaluation::RotationSource::kRadar;
  options.depth.depth.backend = "ground_truth";
  options.depth.working_width = options.optical_flow.flow.working_width = 0;
  options.optical_flow.flow.forward_backward = true;
  options.segmentation.motion.score = MotionScore::kUncertainty;
  options.segmentation.motion.radar.static_gain = 0.5;
  options.segmentation.refine = options.segmentation.look_back = true;
  options.segmentation.memory = 0.4;
  options.mask_directory = masks.string();
  return options;
}

/// The same of the nodelets.
void setParameters(const ros::NodeHandle& handle) {
  for (const std::string radar : kRadars)
    handle.setParam("/ego_velocity/radars/" + radar + "/topic", "/radar_" + radar);
  handle.setParam("/optical_flow/working_width", 0);
  handle.setParam("/optical_flow/forward_backward", true);
  handle.setParam("/dynamic_segmentation/score", "uncertainty");
  handle.setParam("/dynamic_segmentation/static_gain", 0.5);
  handle.setParam("/dynamic_segmentation/refine", true);
  handle.setParam("/dynamic_segmentation/look_back", true);
  handle.setParam("/dynamic_segmentation/memory", 0.4);
}

/// A sweep of the scene as it is estimated offline, and the clouds that EgoVelocity sends of it.
struct ExpectedSweep {
  double complete = 0.0;  // s
  StampedTwist twist;
  std::size_t clouds = 0;
};

std::vector<ExpectedSweep> offlineSweeps(const dataset::Tables& tables, const EgoVelocityConfig& config) {
  const evaluation::RadarScene radar = evaluation::loadRadarScene(tables, 0, {}, config);
  SweepEstimator estimator(config);
  std::vector<ExpectedSweep> expected;
  for (evaluation::SceneSweep& sweep : evaluation::assembleSweeps(radar, config.sweep)) {
    const SweepEstimate estimate = estimator.estimate(sweep.scans, sweep.time);
    if (!estimate.single.valid() || !estimate.filtered) continue;
    const EgoVelocityResult filtered = filteredResult(estimate.filtered->state, estimate.single);
    expected.push_back({sweep.complete,
                        {sweep.time, filtered.linear, filtered.angular, filtered.covariance},
                        sweep.scans.size()});
  }
  return expected;
}

class LiveDrive {
 public:
  /// @param images  stamps and depths of the images, s and m
  LiveDrive(ros::NodeHandle& handle, const std::map<double, cv::Mat>& depths,
            const std::vector<ExpectedSweep>& sweeps)
      : depths_(depths),
        sweeps_(sweeps),
        twists(handle, "ego/twist"),
        masks(handle, "dynamic/mask"),
        static_(handle, "radar/static"),
        dynamic_(handle, "radar/dynamic"),
        image_(handle.advertise<Image>("image", 10)),
        depth_(handle.advertise<Image>("depth", 10)),
        camera_(handle.advertise<sensor_msgs::CameraInfo>("camera_info", 10)),
        tf_(handle.advertise<tf2_msgs::TFMessage>("/tf_static", 10, true)),
        extrinsics_("base_link", handle),
        loader_(false) {
    for (const std::string radar : kRadars)
      radars_["/radar_" + radar] = handle.advertise<PointCloud2>("/radar_" + radar, 100);
    for (const auto& [name, type] : {std::pair("/ego_velocity", "radar_dot/EgoVelocity"),
                                     std::pair("/optical_flow", "radar_dot/OpticalFlow"),
                                     std::pair("/dynamic_segmentation", "radar_dot/DynamicSegmentation")})
      EXPECT_TRUE(loader_.load(name, type, {}, {})) << name;
  }

  /// Feeds the messages in the order of their times.
  void play(const rosbag::Bag& bag) {
    rosbag::View view(bag);
    for (const rosbag::MessageInstance& message : view) {
      ros::Time::setNow(message.getTime());
      if (const auto transforms = message.instantiate<tf2_msgs::TFMessage>()) {
        if (message.getTopic() == "/tf_static") start(*transforms);
      } else if (const auto cloud = message.instantiate<PointCloud2>()) {
        const auto radar = radars_.find(message.getTopic());
        if (radar == radars_.end()) continue;
        awaitSweeps(std::nextafter(cloud->header.stamp.toSec(), 0.0));  // queues are short
        radar->second.publish(cloud);
      } else if (const auto camera = message.instantiate<sensor_msgs::CameraInfo>()) {
        if (message.getTopic() == "/cam_front/camera_info") camera_.publish(camera);
      } else if (const auto image = message.instantiate<sensor_msgs::CompressedImage>()) {
        if (message.getTopic() == "/cam_front/image/compressed") feed(*image);
      }
    }
    awaitSweeps(1e12);
  }

  const std::map<double, cv::Mat>& depths_;
  const std::vector<ExpectedSweep>& sweeps_;
  Recorder<geometry_msgs::TwistWithCovarianceStamped> twists;
  Recorder<Image> masks;

 private:
  /// Mounts, and everybody listens.
  void start(const tf2_msgs::TFMessage& transforms) {
    tf_.publish(transforms);
    EXPECT_TRUE(waitUntil(
        [&] {
          std::string missing;
          for (const std::string radar : kRadars)
            if (!extrinsics_.lookup("radar_" + radar, missing)) return false;
          for (const auto& [topic, publisher] : radars_)
            if (publisher.getNumSubscribers() == 0) return false;
          return image_.getNumSubscribers() > 0 && depth_.getNumSubscribers() > 0 &&
                 camera_.getNumSubscribers() > 0 && extrinsics_.lookup("cam_front", missing).has_value();
        },
        kPatience));
  }
  /// All that EgoVelocity makes of the scans until `time` has reached the others.
  void awaitSweeps(double time) {
    std::size_t clouds = 0;
    for (const ExpectedSweep& sweep : sweeps_)
      if (sweep.complete <= time) clouds += sweep.clouds;
    EXPECT_TRUE(waitUntil([&] { return dynamic_.count() >= clouds; }, kPatience))
        << dynamic_.count() << " of " << clouds << " clouds";
  }
  void feed(const sensor_msgs::CompressedImage& compressed) {
    const ros::Time stamp = compressed.header.stamp;
    awaitSweeps(stamp.toSec());
    auto depth = boost::make_shared<Image>(imageOf(stamp, "32FC1", depths_.at(stamp.toSec())));
    depth->header.frame_id = compressed.header.frame_id;
    depth_.publish(depth);
    auto image =
        boost::make_shared<Image>(imageOf(stamp, "bgr8", cv::imdecode(compressed.data, cv::IMREAD_COLOR)));
    image->header.frame_id = compressed.header.frame_id;
    image_.publish(image);
    EXPECT_TRUE(waitUntil([&] { return masks.count() == images_; }, kPatience))
        << "no mask of pair " << images_;
    ++images_;
  }

  Recorder<PointCloud2> static_, dynamic_;
  ros::Publisher image_, depth_, camera_, tf_;
  std::map<std::string, ros::Publisher> radars_;
  Extrinsics extrinsics_;
  nodelet::Loader loader_;
  std::size_t images_ = 0;
};

TEST(LiveAndOffline, TwistsAndMasksAreTheSame) {
  const TemporaryFolder folder;
  // Keyframes alone, so that live and offline have the same pairs.
  const fs::path file =
      simulatedBag(folder.path(), "scene-0004",
                   "--scenarios oncoming --duration 3 --frames keyframes --width 320 --height 180");
  ASSERT_TRUE(fs::exists(file));
  const dataset::Tables tables = dataset::Tables::load(folder.path() / "drive", {"v1.0-sim", {}});
  const evaluation::SegmentationEvaluationOptions options = offlineOptions(folder.path() / "masks");
  fs::create_directories(options.mask_directory);
  const evaluation::SegmentationReport report = evaluation::evaluateSegmentation(tables, 0, {}, options);
  EXPECT_EQ(report.without_motion, 0U);
  const std::vector<ExpectedSweep> sweeps = offlineSweeps(tables, options.ego_velocity);
  std::map<double, cv::Mat> depths;
  std::map<double, fs::path> offline;  // masks
  for (const dataset::Index row : tables.readingsOf(0, "CAM_FRONT")) {
    const dataset::SampleData& reading = tables.sample_data[evaluation::at(row)];
    const std::string name = evaluation::pngNameOf(tables, row);
    const double time = evaluation::secondsOf(reading);
    depths[time] = evaluation::readDepth(folder.path() / "drive/ground_truth/depth" / name);
    offline[time] = fs::path(options.mask_directory) / name;
  }

  ros::NodeHandle handle;
  setParameters(handle);
  rosbag::Bag bag(file.string());
  LiveDrive live(handle, depths, sweeps);
  live.play(bag);

  const auto twists = live.twists.messages();
  ASSERT_EQ(twists.size(), sweeps.size());
  for (std::size_t i = 0; i < twists.size(); ++i) {
    const geometry_msgs::Twist& twist = twists[i]->twist.twist;
    const StampedTwist& expected = sweeps[i].twist;
    EXPECT_EQ(twists[i]->header.stamp.toSec(), expected.time);
    EXPECT_NEAR(twist.linear.x, expected.linear.x(), 1e-9) << i;
    EXPECT_NEAR(twist.linear.y, expected.linear.y(), 1e-9) << i;
    EXPECT_NEAR(twist.angular.z, expected.angular.z(), 1e-9) << i;
  }
  const auto masks = live.masks.messages();
  ASSERT_EQ(masks.size(), report.frames);
  int moving = 0;
  for (const auto& mask : masks) {
    const cv::Mat seen = matOf(*mask, CV_8UC1);
    const cv::Mat expected =
        cv::imread(offline.at(mask->header.stamp.toSec()).string(), cv::IMREAD_UNCHANGED);
    ASSERT_EQ(seen.size(), expected.size());
    EXPECT_EQ(cv::countNonZero(seen != expected), 0) << mask->header.stamp;
    moving += cv::countNonZero(seen);
  }
  EXPECT_GT(moving, 100) << "empty masks would agree as well";
}

}  // namespace
}  // namespace radar_dot::test
