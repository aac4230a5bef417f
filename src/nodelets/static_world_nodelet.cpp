// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/static_world_nodelet.h"

#include <algorithm>
#include <cmath>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>
#include <utility>

#include "nodelets/common/read_parameters.h"
#include "nodelets/inputs/cloud_points.h"
#include "nodelets/messages/cloud_conversion.h"
#include "radar_dot/vision/static_world.h"

namespace radar_dot {
namespace {

constexpr std::uint32_t kQueue = 30;     // what comes while others are worked on
constexpr std::size_t kMaxWaiting = 60;  // of each input: two seconds at 30 Hz; raw images are large
constexpr std::size_t kDistances = 4;    // images, depths and clouds are not at the same masks
constexpr double kSlack = 1.0;           // s of masks beyond those that may be used

double apartOf(const sensor_msgs::Image& mask, const ros::Time& stamp) {
  return std::abs(mask.header.stamp.toSec() - stamp.toSec());
}

}  // namespace

void StaticWorldNodelet::setUp() {
  describe("static world", config_.stream);
  motion_ = std::make_unique<EgoMotion>(
      *extrinsics_, [] {}, [](const std::string&) {});
  images_ = depths_ = clouds_ = Queue(kMaxWaiting);
  transport_ = std::make_unique<image_transport::ImageTransport>(getNodeHandle());
  mask_publisher_ = transport_->advertise("static/mask", 3);
  image_publisher_ = transport_->advertise("image/static", 3);
  depth_publisher_ = getNodeHandle().advertise<sensor_msgs::Image>("depth/static", 3);
  points_publisher_ = getNodeHandle().advertise<sensor_msgs::PointCloud2>("points/static", 3);
  listenToInputs();
}

void StaticWorldNodelet::listenToInputs() {
  const auto with_points = [this] { return pointsWanted(); };
  mask_input_ = &listen<sensor_msgs::Image>(
      "dynamic/mask", kQueue,
      [this](const sensor_msgs::ImageConstPtr& mask) {
        if (decodedImageOf(mask).pixels.type() != CV_8UC1)
          throw std::invalid_argument("its encoding is '" + mask->encoding + "', not mono8");
        masks_.add(mask);
        processQueues();
      },
      {true, {}, [this] { masks_.clear(); }});
  camera_input_ = &listenToCamera(camera_, {true, with_points, {}});
  listenToTwists(*motion_, {false, with_points, [this] { motion_->forget(); }});
  image_input_ =
      &listenToImages(kQueue,
                      [this](LazyImage picture) {
                        const auto shared = std::make_shared<LazyImage>(std::move(picture));
                        add(images_, shared->header().stamp, [this, shared] { publishImage(*shared); });
                      },
                      {true, [this] { return imagesWanted(); }, [this] { images_.clear(); }});
  depth_input_ = &listen<sensor_msgs::Image>(
      "depth/input", kQueue,
      [this](const sensor_msgs::ImageConstPtr& depth) {
        add(depths_, depth->header.stamp, [this, depth] { publishDepth(*depth); });
      },
      {true, [this] { return depthsWanted(); }, [this] { depths_.clear(); }});
  points_input_ = &listen<sensor_msgs::PointCloud2>("points", kQueue,
                                                    [this](const sensor_msgs::PointCloud2ConstPtr& cloud) {
                                                      add(clouds_, cloud->header.stamp,
                                                          [this, cloud] { publishPoints(cloud); });
                                                    },
                                                    {true, with_points, [this] { clouds_.clear(); }});
}

void StaticWorldNodelet::apply(const StaticWorldConfig& config) {
  masks_.setSpan(config.mask_max_age + kSlack);
  config_ = config;
}

void StaticWorldNodelet::clearHistory() {
  for (Queue* queue : {&images_, &depths_, &clouds_}) queue->clear();
  masks_.clear();
  distances_.clear();
  motion_->forget();
}

void StaticWorldNodelet::add(Queue& queue, const ros::Time& stamp, std::function<void()> publish) {
  queue.add({stamp, std::move(publish)}, Moment::now());
  processQueues();
}

void StaticWorldNodelet::processQueues() {
  processQueue(images_, *image_input_);
  processQueue(depths_, *depth_input_);
  processQueue(clouds_, *points_input_);
}

void StaticWorldNodelet::processQueue(Queue& queue, InputMonitor& input) {
  const auto lackOf = [this](const Task& task, double) -> Queue::Lack {
    const bool reached = masks_.find(task.stamp) != nullptr || masks_.isPast(task.stamp);
    return {reached ? "" : "a mask"};
  };
  while (const std::optional<Queue::Taken> taken = queue.take(config_.mask_wait, Moment::now(), lackOf))
    guard(input, [&] { taken->item.publish(); });
}

sensor_msgs::ImageConstPtr StaticWorldNodelet::maskOf(const std_msgs::Header& header, const cv::Size& size) {
  sensor_msgs::ImageConstPtr mask = maskAt(header.stamp, size);
  if (mask && withoutSlash(mask->header.frame_id) != withoutSlash(header.frame_id)) {
    ++of_another_frame_since_report_;
    frames_ = "masks are in frame '" + mask->header.frame_id + "', what is masked in '" + header.frame_id +
              "': it must be registered to the camera of the masks";
    warn("frame", frames_);
  }
  return mask;
}

sensor_msgs::ImageConstPtr StaticWorldNodelet::maskAt(const ros::Time& stamp, const cv::Size& size) {
  sensor_msgs::ImageConstPtr mask = masks_.nearest(stamp);
  const std::string topic = "'" + mask_input_->topic() + "'";
  std::string lack;
  if (!mask) {
    lack = "nothing on " + topic;
  } else if (apartOf(*mask, stamp) > config_.mask_max_age) {
    lack = "no mask on " + topic + " within " + nameOf(config_, config_.mask_max_age);
  } else if (const cv::Size grid(static_cast<int>(mask->width), static_cast<int>(mask->height));
             !isGridOf(grid, size)) {
    lack = "the mask on " + topic + " of " + sizeText(grid) + " px does not have the shape of " +
           sizeText(size) + " px";
  }
  if (!lack.empty()) {
    ++without_mask_;
    ++without_mask_since_report_;
    lack_ = lack;
    warn("mask", "everything is kept: " + lack);
    return {};
  }
  const double apart = apartOf(*mask, stamp);
  if (apart > 0.0) ++by_another_since_report_;
  apart_since_report_ = std::max(apart_since_report_, apart);
  return mask;
}

cv::Mat StaticWorldNodelet::keepOf(const sensor_msgs::ImageConstPtr& mask, const ros::Time& stamp,
                                   const cv::Size& size) {
  if (!mask) return {size, CV_8UC1, cv::Scalar(255)};
  auto known = std::find_if(distances_.begin(), distances_.end(), [&](const Distance& distance) {
    return distance.mask == mask && distance.pixels.size() == size;
  });
  if (known == distances_.end()) {
    distances_.push_front({mask, distanceToMoving(decodedImageOf(mask).pixels, size)});
    if (distances_.size() > kDistances) distances_.pop_back();
    known = distances_.begin();
  }
  return known->pixels > config_.dilation + config_.dilation_rate * apartOf(*mask, stamp);
}

void StaticWorldNodelet::publishImage(LazyImage& picture) {
  const std_msgs::Header& header = picture.header();
  const cv::Size size = picture.size();
  const cv::Mat keep = keepOf(maskOf(header, size), header.stamp, size);
  if (mask_publisher_.getNumSubscribers() > 0) mask_publisher_.publish(imageMessage(header, "mono8", keep));
  if (image_publisher_.getNumSubscribers() > 0) {
    const cv::Mat& image = picture.pixels();
    image_publisher_.publish(
        imageMessage(header, image.channels() == 1 ? "mono8" : "bgr8", filled(image, keep)));
  }
  notePublished(header.stamp);
}

void StaticWorldNodelet::publishDepth(const sensor_msgs::Image& depth) {
  const ros::Time& stamp = depth.header.stamp;
  const cv::Size size = imageSizeOf(depth, "depth");
  depth_publisher_.publish(keptDepth(depth, keepOf(maskOf(depth.header, size), stamp, size)));
  notePublished(stamp);
}

void StaticWorldNodelet::publishPoints(const sensor_msgs::PointCloud2ConstPtr& cloud) {
  if (!camera_) throw std::invalid_argument("nothing on '" + camera_input_->topic() + "' yet");
  const CameraIntrinsics camera = cameraOf(*camera_);
  const sensor_msgs::ImageConstPtr mask = maskAt(cloud->header.stamp, {camera.width, camera.height});
  points_publisher_.publish(mask ? withoutMoving(cloud, mask, camera) : cloud);
  notePublished(cloud->header.stamp);
}

sensor_msgs::PointCloud2ConstPtr StaticWorldNodelet::withoutMoving(
    const sensor_msgs::PointCloud2ConstPtr& cloud, const sensor_msgs::ImageConstPtr& mask,
    const CameraIntrinsics& camera) {
  const std_msgs::Header &seen = mask->header, &scanned = cloud->header;
  std::string missing;
  const std::optional<Eigen::Isometry3d> camera_mount = extrinsics_->lookupCamera(seen.frame_id, missing);
  const std::optional<Eigen::Isometry3d> cloud_mount = extrinsics_->lookup(scanned.frame_id, missing);
  if (!camera_mount || !cloud_mount) throw std::invalid_argument(missing);
  Eigen::Isometry3d T_camera_from_cloud = camera_mount->inverse();
  if (seen.stamp != scanned.stamp) {
    const IntervalMotion motion = motion_->between(seen.stamp, scanned.stamp, kScanTwistHold, false);
    if (motion.T_begin_from_end) T_camera_from_cloud = T_camera_from_cloud * *motion.T_begin_from_end;
    if (!motion.T_begin_from_end) ++without_motion_since_report_;
  }
  T_camera_from_cloud = T_camera_from_cloud * *cloud_mount;
  const cv::Mat keep = keepOf(mask, scanned.stamp, {camera.width, camera.height});
  return keptCloud(*cloud, keptPoints(positionsOf(*cloud), keep, camera, T_camera_from_cloud));
}

void StaticWorldNodelet::notePublished(const ros::Time& stamp) {
  ++published_;
  ++published_since_report_;
  latency_ = since(stamp);
  noteOutput();
}

void StaticWorldNodelet::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  if (without_mask_since_report_ > 0) {
    status.summaryf(DiagnosticStatus::WARN, "%zu of %zu without a mask, everything is kept: %s",
                    without_mask_since_report_, published_since_report_, lack_.c_str());
  } else if (of_another_frame_since_report_ > 0) {
    status.summary(DiagnosticStatus::WARN, frames_);
  } else if (withoutOutput() > silentAfter()) {
    status.summaryf(DiagnosticStatus::ERROR, "no output for %.1f s", withoutOutput());
  } else {
    status.summaryf(DiagnosticStatus::OK, "%zu since the last report, %zu of them by a mask of another time",
                    published_since_report_, by_another_since_report_);
  }
  status.addf("published", "%zu", published_);
  status.addf("without a mask", "%zu", without_mask_);
  status.addf("largest time to the mask (s)", "%.3f", apart_since_report_);
  status.addf("clouds without the motion to their mask", "%zu", without_motion_since_report_);
  status.addf("latency (ms)", "%.1f", 1e3 * latency_);
  status.addf("waiting", "%zu", images_.size() + depths_.size() + clouds_.size());
  apart_since_report_ = 0.0;
  published_since_report_ = by_another_since_report_ = without_mask_since_report_ = 0;
  without_motion_since_report_ = of_another_frame_since_report_ = 0;
}

}  // namespace radar_dot

PLUGINLIB_EXPORT_CLASS(radar_dot::StaticWorldNodelet, nodelet::Nodelet)
