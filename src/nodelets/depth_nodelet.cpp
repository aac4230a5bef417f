// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/depth_nodelet.h"

#include <limits>
#include <pluginlib/class_list_macros.hpp>
#include <set>
#include <stdexcept>
#include <utility>

#include "nodelets/common/process_clock.h"
#include "nodelets/common/read_parameters.h"
#include "vision/resize_nearest.h"

namespace radar_dot {
namespace {

constexpr float kNearest = 1e-3F;  // m; as of a denormal number, 1 / depth would overflow

std::unique_ptr<DepthEstimator> estimatorOf(const DepthParams& params) {
  const auto& network = params.network;
  if (params.backend == kMotionBackend)
    throw InvalidParameter(
        {"depth_backend"},
        "depth_backend motion needs flow, which waits for depth: the segmentation publishes "
        "this depth as depth/motion");
  return made(params, {&params.backend, &network.model, &network.device, &network.threads},
              makeDepthEstimator);
}

/// What is no depth becomes NaN. @return fraction of known pixels
double clean(cv::Mat& depth, double max_depth) {
  std::size_t known = 0;
  for (int row = 0; row < depth.rows; ++row) {
    auto* values = depth.ptr<float>(row);
    for (int column = 0; column < depth.cols; ++column) {
      const bool is_known = values[column] >= kNearest && values[column] <= static_cast<float>(max_depth);
      if (is_known) {
        ++known;
      } else {
        values[column] = std::numeric_limits<float>::quiet_NaN();
      }
    }
  }
  return static_cast<double>(known) / static_cast<double>(depth.total());
}

}  // namespace

void DepthNodelet::setUp() {
  describe("depth", config_.stream);
  ros::NodeHandle& handle = getNodeHandle();
  const auto warn_of_sensor = [this](const std::string& text) { warn("sensor", text); };
  motion_ = std::make_unique<EgoMotion>(
      *extrinsics_, [] {}, [this](const std::string& text) { warn("rotation", text); });
  radar_clouds_ = std::make_unique<RecentClouds>(*extrinsics_, *motion_, warn_of_sensor);
  lidar_clouds_ = std::make_unique<RecentClouds>(*extrinsics_, *motion_, warn_of_sensor);

  const auto external = [this] { return config_.isExternal(); };
  const auto estimated = [this] { return !config_.isExternal(); };
  listenToImages(3, [this](LazyImage picture) { onImage(std::move(picture)); }, {true, estimated, {}});
  camera_input_ = &listenToCamera(camera_, {true, estimated, {}}, [this] {
    if (early_) onImage(*std::exchange(early_, std::nullopt));
  });
  listen<sensor_msgs::Image>("depth/input", 2,
                             [this](const sensor_msgs::ImageConstPtr& message) { onDepth(message); },
                             {true, external, {}});
  lidar_input_ = &listenToClouds(
      "lidar", *lidar_clouds_, {true, [this] { return needs().lidar; }, [this] { lidar_clouds_->clear(); }});
  listenToTwists(*motion_, {false, estimated, [this] { motion_->forget(); }});
  listenToRadars(config_.radar_topics, nameOf(config_, config_.radar_topics), false);
  listenToRadars(config_.network_radar_topics, nameOf(config_, config_.network_radar_topics), true);
  publisher_ = handle.advertise<sensor_msgs::Image>("depth", 3);
  uncertainty_publisher_ = handle.advertise<sensor_msgs::Image>("depth/uncertainty", 3);
}

void DepthNodelet::listenToRadars(const std::vector<std::string>& topics, const char* parameter,
                                  bool trained_only) {
  const auto wanted = [this, trained_only] {
    return needs().radar && needs().trained_radars_only == trained_only;
  };
  std::set<std::string> known;
  for (const std::string& topic : topics) {
    if (!isTopic(topic, parameter)) continue;
    if (!known.insert(getNodeHandle().resolveName(topic)).second) {
      reportProblem(std::string(parameter) + " has '" + topic + "' twice; once is enough");
    } else {
      listenToClouds(topic, *radar_clouds_, {false, wanted, [this] { radar_clouds_->clear(); }});
    }
  }
}

void DepthNodelet::apply(const DepthConfig& config) {
  // A network takes seconds to load, and may fail to: then nothing has changed.
  if (config.isExternal()) {
    estimator_.reset();
  } else if (!estimator_ || !sameFields(config_.depth, config.depth)) {
    estimator_ = estimatorOf(config.depth);
  }
  if (config_.depth.backend != config.depth.backend) noteOutput();  // it has its time for the first one
  config_ = config;
}

void DepthNodelet::clearHistory() {
  early_.reset();
  radar_clouds_->clear();
  lidar_clouds_->clear();
  motion_->forget();
}

void DepthNodelet::onImage(LazyImage picture) {
  const ros::WallTime start = ProcessClock::now();
  const std_msgs::Header header = picture.header();
  if (!estimator_) throw std::invalid_argument("no depth: " + server_->error());
  if (!camera_) {
    // That of the first image may come right after it.
    const bool may_come = !early_;
    early_ = std::move(picture);
    if (may_come) return;
    throw std::invalid_argument("nothing on '" + camera_input_->topic() + "' yet");
  }
  const CameraIntrinsics camera = cameraOf(*camera_);
  DepthInput input;
  std::string missing;
  const std::optional<Eigen::Isometry3d> T_base_from_camera =
      extrinsics_->lookupCamera(header.frame_id, missing);
  if (!T_base_from_camera) throw std::invalid_argument(missing);
  const cv::Size grid = workingGrid({camera.width, camera.height}, config_.working_width);
  input.camera = camera.scaledTo(grid.width, grid.height);
  input.T_base_from_camera = *T_base_from_camera;
  if (needs().image) input.image = picture.pixels();
  if (needs().lidar) {
    input.lidar_points = lidar_clouds_->positionsAt(header.stamp, config_.lidar_max_age);
    if (input.lidar_points.empty()) {
      throw std::invalid_argument("no sweep on '" + lidar_input_->topic() + "' within " +
                                  std::to_string(config_.lidar_max_age) + " s of it (" +
                                  nameOf(config_, config_.lidar_max_age) + ")");
    }
  }
  if (needs().radar) {
    input.radar_points =
        radar_clouds_->positionsAt(header.stamp, config_.radar_max_age, &config_.depth.radar_ground.ground);
  }
  points_ = input.lidar_points.size() + input.radar_points.size();
  cv::Mat depth = estimator_->estimate(input);
  known_share_ = clean(depth, config_.depth.max_depth);
  const cv::Mat relative_std = wantsUncertainty() ? estimator_->relativeStd(input, depth) : cv::Mat();
  computation_time_ = (ProcessClock::now() - start).toSec();
  publish(header, depth, relative_std);
}

void DepthNodelet::onDepth(const sensor_msgs::ImageConstPtr& message) {
  const ros::WallTime start = ProcessClock::now();
  const cv::Mat given = radar_dot::depthOf(*message);
  const cv::Size grid = workingGrid(given.size(), config_.working_width);
  cv::Mat depth = resizeNearest(given, grid);
  if (depth.data == given.data) depth = given.clone();
  known_share_ = clean(depth, config_.depth.max_depth);
  computation_time_ = (ProcessClock::now() - start).toSec();
  publish(message->header, depth,
          wantsUncertainty() ? constantStd(depth, config_.depth.relative_std) : cv::Mat());
}

void DepthNodelet::publish(const std_msgs::Header& header, const cv::Mat& depth,
                           const cv::Mat& relative_std) {
  // First, so that it is there where the depth is.
  if (!relative_std.empty()) uncertainty_publisher_.publish(imageMessage(header, "32FC1", relative_std));
  publisher_.publish(imageMessage(header, "32FC1", depth));
  ++computed_;
  noteOutput();
}

void DepthNodelet::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  if (withoutOutput() > silentAfter()) {
    status.summaryf(DiagnosticStatus::ERROR, "no depth for %.1f s", withoutOutput());
  } else if (computed_ > 0 && known_share_ == 0.0) {
    status.summary(DiagnosticStatus::WARN, "no pixel of the latest depth is known");
  } else {
    status.summary(DiagnosticStatus::OK, "backend " + config_.depth.backend);
  }
  status.addf("computation time (ms)", "%.1f", 1e3 * computation_time_);
  status.addf("known share", "%.2f", known_share_);
  status.addf("points used", "%zu", points_);
  status.addf("depths", "%zu", computed_);
}

}  // namespace radar_dot

PLUGINLIB_EXPORT_CLASS(radar_dot::DepthNodelet, nodelet::Nodelet)
