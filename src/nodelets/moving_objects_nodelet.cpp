// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/moving_objects_nodelet.h"

#include <algorithm>
#include <optional>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>

#include "nodelets/common/process_clock.h"
#include "nodelets/common/read_parameters.h"
#include "radar_dot/objects/object_detection.h"

namespace radar_dot {
namespace {

constexpr double kMaxSilence = 0.15;   // s of scans without a message
constexpr double kStartTimeout = 1.0;  // s, until odometry and velocity are there at the start
constexpr std::uint32_t kOdometryQueue = 20;
constexpr std::uint32_t kCloudQueue = 50;
constexpr std::uint32_t kImageQueue = 5;

}  // namespace

void MovingObjectsNodelet::setUp() {
  describe("objects", config_.stream);
  motion_ = std::make_unique<EgoMotion>(
      *extrinsics_, [] {}, [](const std::string&) {}, true);
  objects_publisher_ = getNodeHandle().advertise<MovingObjects>("dynamic/objects", 10);
  markers_publisher_ = getNodeHandle().advertise<visualization_msgs::MarkerArray>("dynamic/markers", 10);
  covariances_publisher_ = getNodeHandle().advertise<derived_object_msgs::ObjectWithCovarianceArray>(
      "dynamic/objects_with_covariance", 10);
  obstacles_publisher_ =
      getNodeHandle().advertise<costmap_converter::ObstacleArrayMsg>("dynamic/obstacles", 10);
  const auto listenToLabel = [this](const std::string& topic, ReturnLabel label) {
    return &listen<sensor_msgs::PointCloud2>(
        topic, kCloudQueue,
        [this, label](const sensor_msgs::PointCloud2ConstPtr& cloud) { onCloud(*cloud, label); }, {},
        Stamps::kUnordered);
  };
  twist_input_ = &listenToTwists(*motion_);
  odometry_input_ = &listen<nav_msgs::Odometry>(
      "odom", kOdometryQueue, [this](const nav_msgs::OdometryConstPtr& odometry) { onOdometry(*odometry); });
  static_input_ = listenToLabel("radar/static", ReturnLabel::kStatic);
  dynamic_input_ = listenToLabel("radar/dynamic", ReturnLabel::kDynamic);
  listenToMasks();
}

void MovingObjectsNodelet::listenToMasks() {
  const InputOptions options = {true, [this] { return config_.use_mask; }, [this] { masks_.clear(); }};
  const auto listenToImages = [this, options](
                                  const std::string& topic,
                                  const std::function<void(const sensor_msgs::ImageConstPtr&)>& add) {
    return &listen<sensor_msgs::Image>(
        topic, kImageQueue,
        [this, add](const sensor_msgs::ImageConstPtr& image) {
          add(image);
          processMasks();
        },
        options);
  };
  camera_input_ = &listenToCamera(camera_, options);
  listenToImages("depth", [this](const sensor_msgs::ImageConstPtr& image) { masks_.addDepth(image); });
  listenToImages("dynamic/expected_flow",
                 [this](const sensor_msgs::ImageConstPtr& image) { masks_.addExpectedFlow(image); });
  listen<Flow>(
      "flow", kImageQueue,
      [this](const FlowConstPtr& flow) {
        masks_.addFlow(flow);
        processMasks();
      },
      options);
  mask_input_ = listenToImages("dynamic/mask", [this](const sensor_msgs::ImageConstPtr& image) {
    masks_.addMask(image, Moment::now());
  });
}

bool MovingObjectsNodelet::hasAudience() const {
  return objects_publisher_.getNumSubscribers() + markers_publisher_.getNumSubscribers() +
             covariances_publisher_.getNumSubscribers() + obstacles_publisher_.getNumSubscribers() >
         0;
}

void MovingObjectsNodelet::apply(const MovingObjectsConfig& config) {
  tracker_.configure(config.tracker);
  config_ = config;
}

void MovingObjectsNodelet::clearHistory() {
  scans_.clear();
  masks_.clear();
  motion_->forget();
  poses_.clear();
  tracker_.reset();
  newest_ = published_ = ros::Time();
  first_scan_ = ros::WallTime();
  objects_ = 0;
  deleteMarkers();
}

void MovingObjectsNodelet::deleteMarkers() {
  std_msgs::Header header;
  header.frame_id = inBaseFrame() ? extrinsics_->baseFrame() : odom_frame_;
  if (!header.frame_id.empty()) markers_publisher_.publish(markers_.deleteAll(header));
}

void MovingObjectsNodelet::drop(const std::string& reason) {
  // The first scans come before odometry and velocity.
  if ((ProcessClock::now() - first_scan_).toSec() < kStartTimeout) return;
  ++dropped_;
  ++dropped_since_report_;
  drop_reason_ = reason;
  warn("dropped", reason);
}

void MovingObjectsNodelet::onCloud(const sensor_msgs::PointCloud2& cloud, ReturnLabel label) {
  scans_.add(cloud, label, Moment::now());
  if (first_scan_.isZero()) first_scan_ = ProcessClock::now();
  processQueue();
}

void MovingObjectsNodelet::onOdometry(const nav_msgs::Odometry& odometry) {
  if (withoutSlash(odometry.child_frame_id) != extrinsics_->baseFrame()) {
    throw std::invalid_argument("child_frame_id: it is '" + odometry.child_frame_id +
                                "', not the base frame '" + extrinsics_->baseFrame() + "'");
  }
  const StampedPose pose = poseOf(odometry);
  const std::string frame = withoutSlash(odometry.header.frame_id);
  if (frame != odom_frame_) {
    if (!odom_frame_.empty()) {
      warn("odometry",
           "the frame of '" + odometry_input_->topic() + "' is '" + frame + "' now: all objects restart");
      deleteMarkers();
    }
    poses_.clear();
    tracker_.reset();
    odom_frame_ = frame;
  }
  poses_.add(pose);
}

std::optional<Eigen::Isometry3d> MovingObjectsNodelet::poseAt(const ros::Time& time, std::string& missing) {
  if (const std::optional<StampedPose> between = poses_.at(time.toSec())) return between->isometry();
  const std::optional<double> latest = poses_.latest();
  if (!latest || time.toSec() < *latest) {
    missing = "no pose on '" + odometry_input_->topic() + "' at the stamp";
    return std::nullopt;
  }
  if (time.toSec() - *latest > config_.max_pose_age) {
    missing = "the latest pose on '" + odometry_input_->topic() + "' is older than " +
              nameOf(config_, config_.max_pose_age);
    return std::nullopt;
  }
  const IntervalMotion motion =
      motion_->between(ros::Time(*latest), time, config_.max_pose_age, /*may_wait=*/false);
  if (!motion.T_begin_from_end) {
    missing = "no motion from '" + twist_input_->topic() + "': " + motion.missing;
    return std::nullopt;
  }
  return poses_.at(*latest)->isometry() * *motion.T_begin_from_end;
}

void MovingObjectsNodelet::processQueue() {
  const ros::WallTime start = ProcessClock::now();
  const std::vector<LabelledScan> ready = scans_.take(config_.pairing_timeout, Moment::now());
  for (const LabelledScan& scan : ready) {
    std::string reason;
    try {
      if (!useScan(scan, reason)) {
        drop("the scan of '" + scan.frame + "' is left out: " + reason);
        continue;
      }
    } catch (const std::exception& error) {
      drop("the scan of '" + scan.frame + "' is left out: " + error.what());
      continue;
    }
    ++scans_since_report_;
    noteOutput();
    newest_ = std::max(newest_, scan.stamp);
    if (scan.complete()) continue;
    ++incomplete_since_report_;
    warn("half", "nothing on '" + (scan.still ? dynamic_input_ : static_input_)->topic() +
                     "' with frame and stamp of the cloud on '" +
                     (scan.still ? static_input_ : dynamic_input_)->topic() + "'; used alone");
  }
  if (!ready.empty()) computation_time_ = (ProcessClock::now() - start).toSec();
  // One message for the scans of a sweep, once all are in; a scan that lacks a cloud must not hold up all
  // others.
  const double ahead = newest_.toSec() - published_.toSec();
  if (ahead > 0.0 && (scans_.empty() || ahead > kMaxSilence)) publish(newest_);
}

bool MovingObjectsNodelet::useScan(const LabelledScan& scan, std::string& reason) {
  const std::optional<Eigen::Isometry3d> mount = extrinsics_->lookup(scan.frame, reason);
  if (!mount) return false;
  const std::optional<StampedTwist> velocity = motion_->velocityAt(scan.stamp, config_.max_pose_age, reason);
  if (!velocity) {
    reason = "no velocity from '" + twist_input_->topic() + "': " + reason;
    return false;
  }
  const std::optional<Eigen::Isometry3d> pose = poseAt(scan.stamp, reason);
  if (!pose) return false;
  const double time = scan.stamp.toSec();
  const std::vector<ReturnOverGround> returns = returnsOf(scan, *mount, *velocity, config_.returns);
  if (tracker_.update(time, scan.radar, detectObjects(time, returns, {}, config_.detection), *pose))
    return true;
  reason = std::string("it is older than the newest scan by more than ") +
           nameOf(config_, config_.tracker.max_lag);
  return false;
}

void MovingObjectsNodelet::processMasks() {
  std::string missing;
  while (const std::optional<MaskMessages> messages =
             masks_.take(config_.mask_timeout, Moment::now(), missing)) {
    std::string reason;
    try {
      if (useMask(*messages, reason)) {
        ++masks_since_report_;
        continue;
      }
    } catch (const std::exception& error) {
      reason = error.what();
    }
    drop("a mask on '" + mask_input_->topic() + "' is left out: " + reason);
  }
  if (!missing.empty()) drop("a mask on '" + mask_input_->topic() + "' is left out: " + missing);
}

bool MovingObjectsNodelet::useMask(const MaskMessages& messages, std::string& reason) {
  const std_msgs::Header& header = messages.mask->header;
  if (!camera_) {
    reason = "nothing on '" + camera_input_->topic() + "' yet";
    return false;
  }
  const std::optional<Eigen::Isometry3d> T_base_from_camera =
      extrinsics_->lookupCamera(header.frame_id, reason);
  if (!T_base_from_camera) return false;
  const std::optional<Eigen::Isometry3d> pose = poseAt(header.stamp, reason);
  if (!pose) return false;
  const double time = header.stamp.toSec();
  std::vector<ObjectDetection> detections = detectObjects(
      time, {}, regionsOf(messages, *camera_, *T_base_from_camera, config_.regions), config_.detection);
  // Masks have more false regions than scans have false returns.
  for (ObjectDetection& detection : detections) detection.moving = config_.mask_starts_tracks;
  if (tracker_.update(time, std::nullopt, detections, *pose)) return true;
  reason = std::string("it is older than the newest scan by more than ") +
           nameOf(config_, config_.tracker.max_lag);
  return false;
}

void MovingObjectsNodelet::publish(const ros::Time& stamp) {
  published_ = stamp;
  std::string missing;
  const std::optional<Eigen::Isometry3d> pose = poseAt(stamp, missing);
  if (!pose) return;  // it was there for the scan
  const MovingObjects message = objectsAt(stamp, *pose, config_.frame);
  objects_ = message.objects.size();
  latency_ = since(stamp);
  objects_publisher_.publish(message);
  if (markers_publisher_.getNumSubscribers() > 0)
    markers_publisher_.publish(markers_.update(message, config_.marker_lifetime));
  if (covariances_publisher_.getNumSubscribers() > 0)
    covariances_publisher_.publish(objectsWithCovariance(message));
  if (obstacles_publisher_.getNumSubscribers() > 0)
    obstacles_publisher_.publish(obstaclesOf(objectsAt(stamp, *pose, ObjectFrame::kOdom)));
}

MovingObjects MovingObjectsNodelet::objectsAt(const ros::Time& stamp, const Eigen::Isometry3d& pose,
                                              ObjectFrame frame) const {
  FrameOfObjects place;
  if (frame == ObjectFrame::kBase) {
    place.T_frame_from_odom = planarPose(pose).inverse();
  } else {
    place.height = pose.translation().z();
  }
  MovingObjects message;
  message.header.stamp = stamp;
  message.header.frame_id = frame == ObjectFrame::kBase ? extrinsics_->baseFrame() : odom_frame_;
  for (const ObjectTrack& track : tracker_.moving(stamp.toSec()))
    message.objects.push_back(objectMessage(track, stamp, place, config_.image_max_age));
  std::sort(message.objects.begin(), message.objects.end(),
            [](const MovingObject& a, const MovingObject& b) { return a.id < b.id; });
  return message;
}

void MovingObjectsNodelet::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  if (dropped_since_report_ > 0) {
    status.summaryf(scans_since_report_ > 0 ? DiagnosticStatus::WARN : DiagnosticStatus::ERROR,
                    "%zu scans or masks left out: %s", dropped_since_report_, drop_reason_.c_str());
  } else if (scans_since_report_ == 0 && withoutOutput() > silentAfter()) {
    status.summary(DiagnosticStatus::ERROR, "no scan since the last report");
  } else {
    status.summaryf(DiagnosticStatus::OK, "%zu objects, %zu scans since the last report", objects_,
                    scans_since_report_);
  }
  if (incomplete_since_report_ > 0)
    status.mergeSummaryf(DiagnosticStatus::WARN, "%zu scans with one of their two clouds",
                         incomplete_since_report_);
  status.addf("objects", "%zu", objects_);
  status.addf("tracks", "%zu", tracker_.all().size());
  status.addf("masks since the last report", "%zu", masks_since_report_);
  status.addf("computation time (ms)", "%.2f", 1e3 * computation_time_);
  status.addf("latency (ms)", "%.1f", 1e3 * latency_);
  status.addf("left out", "%zu", dropped_);
  status.add("last left out", drop_reason_);
  scans_since_report_ = masks_since_report_ = dropped_since_report_ = incomplete_since_report_ = 0;
}

}  // namespace radar_dot

PLUGINLIB_EXPORT_CLASS(radar_dot::MovingObjectsNodelet, nodelet::Nodelet)
