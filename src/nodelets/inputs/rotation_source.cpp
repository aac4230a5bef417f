// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/rotation_source.h"

#include <sensor_msgs/Imu.h>

#include <cmath>
#include <stdexcept>
#include <utility>

#include "nodelets/inputs/stamp_guard.h"

namespace radar_dot {
namespace {

constexpr std::uint32_t kQueueSize = 200;

/// What both sources of messages have in common: nothing that arrives may end the process, and a
/// wrong stamp costs no more than its own message.
class GuardedCallback {
 public:
  /// Runs `body`; whatever it throws becomes a warning.
  template <typename Body>
  void handle(const RotationSource::Callbacks& callbacks, const std::string& source, const Body& body) const {
    try {
      callbacks.arrival();
      body();
    } catch (const std::exception& error) {
      callbacks.warn(source + ": a message is left out: " + error.what());
    }
  }
  /// @throws std::invalid_argument for a stamp that cannot be used.
  StampGuard::Verdict check(const ros::Time& stamp) {
    const std::string defect = stampDefect(stamp, ros::Time::now());
    if (!defect.empty()) throw std::invalid_argument(defect);
    const StampGuard::Verdict verdict = stamps_.check(stamp);
    if (verdict == StampGuard::Verdict::kStale) {
      throw std::invalid_argument("stamp not newer than the previous one's");
    }
    return verdict;
  }
  void reset() { stamps_.reset(); }

 private:
  StampGuard stamps_;
};

/// Orientation and position from a nav_msgs/Odometry of the base frame.
class OdometrySource : public RotationSource {
 public:
  OdometrySource(ros::NodeHandle& handle, const std::string& base_frame, Callbacks callbacks)
      : base_frame_(base_frame), callbacks_(std::move(callbacks)) {
    subscriber_ = handle.subscribe<nav_msgs::Odometry>(
        "rotation/odom", kQueueSize, [this](const nav_msgs::OdometryConstPtr& odometry) {
          gate_.handle(callbacks_, describe(), [&] { onOdometry(*odometry); });
        });
  }
  std::optional<PoseSample> at(const ros::Time& stamp) override { return buffer_.at(stamp.toSec()); }
  std::optional<double> latest() const override { return buffer_.latest(); }
  void reset() override {
    buffer_.clear();
    gate_.reset();
  }
  bool isAbsolute() const override { return true; }
  bool hasPosition() const override { return true; }
  std::string frame() const override { return frame_; }
  std::string describe() const override { return "odometry on '" + subscriber_.getTopic() + "'"; }

 private:
  void onOdometry(const nav_msgs::Odometry& odometry) {
    const PoseSample sample = poseOf(odometry);
    if (gate_.check(odometry.header.stamp) == StampGuard::Verdict::kRestart) buffer_.clear();
    if (!odometry.child_frame_id.empty() && odometry.child_frame_id != base_frame_) {
      callbacks_.warn(describe() + ": its child frame is '" + odometry.child_frame_id + "', not '" +
                      base_frame_ + "'; its rotation is taken as that of '" + base_frame_ + "'");
    }
    frame_ = odometry.header.frame_id;
    buffer_.add(sample);
    callbacks_.sample();
  }

  std::string base_frame_;
  std::string frame_;
  Callbacks callbacks_;
  GuardedCallback gate_;
  PoseBuffer buffer_;
  ros::Subscriber subscriber_;
};

/// Heading from the yaw rate of an IMU. Its orientation is not used: that of many IMUs is none.
class ImuSource : public RotationSource {
 public:
  ImuSource(ros::NodeHandle& handle, Extrinsics& extrinsics, Callbacks callbacks)
      : extrinsics_(extrinsics), callbacks_(std::move(callbacks)) {
    subscriber_ = handle.subscribe<sensor_msgs::Imu>(
        "rotation/imu", kQueueSize, [this](const sensor_msgs::ImuConstPtr& imu) {
          gate_.handle(callbacks_, describe(), [&] { onImu(*imu); });
        });
  }
  std::optional<PoseSample> at(const ros::Time& stamp) override { return buffer_.at(stamp.toSec()); }
  std::optional<double> latest() const override { return buffer_.latest(); }
  void reset() override {
    buffer_.clear();
    heading_.reset();
    gate_.reset();
  }
  bool isAbsolute() const override { return false; }
  bool hasPosition() const override { return false; }
  std::string frame() const override { return {}; }
  std::string describe() const override { return "IMU on '" + subscriber_.getTopic() + "'"; }

 private:
  void onImu(const sensor_msgs::Imu& imu) {
    const Eigen::Vector3d rate(imu.angular_velocity.x, imu.angular_velocity.y, imu.angular_velocity.z);
    // -1 in the first place of a covariance is how sensor_msgs/Imu says "not measured".
    if (!rate.allFinite() || imu.angular_velocity_covariance[0] == -1.0) {
      throw std::invalid_argument("it has no angular velocity");
    }
    std::string error;
    const std::optional<Eigen::Isometry3d> mount = extrinsics_.lookup(imu.header.frame_id, error);
    if (!mount) throw std::invalid_argument(error);
    if (gate_.check(imu.header.stamp) == StampGuard::Verdict::kRestart) heading_.reset();
    const double time = imu.header.stamp.toSec();
    if (heading_.add(time, (mount->linear() * rate).z())) {
      buffer_.clear();
      callbacks_.restarted();
    }
    PoseSample sample;
    sample.time = time;
    sample.rotation = Eigen::AngleAxisd(heading_.yaw(), Eigen::Vector3d::UnitZ());
    buffer_.add(sample);
    callbacks_.sample();
  }

  Extrinsics& extrinsics_;
  Callbacks callbacks_;
  GuardedCallback gate_;
  PoseBuffer buffer_;
  YawIntegrator heading_;
  ros::Subscriber subscriber_;
};

/// Pose of the base frame in a fixed frame of TF.
class TfSource : public RotationSource {
 public:
  TfSource(std::string fixed_frame, Extrinsics& extrinsics)
      : fixed_frame_(std::move(fixed_frame)), extrinsics_(extrinsics) {}

  std::optional<PoseSample> at(const ros::Time& stamp) override {
    try {
      const Eigen::Isometry3d pose = isometryOf(
          extrinsics_.buffer().lookupTransform(fixed_frame_, extrinsics_.baseFrame(), stamp).transform);
      latest_ = stamp.toSec();
      return PoseSample{stamp.toSec(), Eigen::Quaterniond(pose.linear()), pose.translation()};
    } catch (const std::exception&) {
      return std::nullopt;
    }
  }
  std::optional<double> latest() const override { return latest_; }
  void reset() override { latest_.reset(); }
  bool isAbsolute() const override { return true; }
  bool hasPosition() const override { return true; }
  std::string frame() const override { return fixed_frame_; }
  std::string describe() const override {
    return "TF from '" + extrinsics_.baseFrame() + "' to '" + fixed_frame_ + "'";
  }

 private:
  std::string fixed_frame_;
  Extrinsics& extrinsics_;
  std::optional<double> latest_;
};

}  // namespace

PoseSample poseOf(const nav_msgs::Odometry& odometry) {
  const geometry_msgs::Quaternion& q = odometry.pose.pose.orientation;
  const geometry_msgs::Point& p = odometry.pose.pose.position;
  PoseSample sample;
  sample.time = odometry.header.stamp.toSec();
  sample.rotation = Eigen::Quaterniond(q.w, q.x, q.y, q.z);
  sample.position = {p.x, p.y, p.z};
  const double norm = sample.rotation.norm();
  if (!(std::abs(norm - 1.0) < 0.1) || !sample.position.allFinite()) {
    throw std::invalid_argument("it has no unit quaternion or no finite position");
  }
  sample.rotation.normalize();
  return sample;
}

std::unique_ptr<RotationSource> makeRotationSource(const RotationParams& params, ros::NodeHandle& handle,
                                                   Extrinsics& extrinsics,
                                                   RotationSource::Callbacks callbacks) {
  switch (params.source) {
    case RotationSourceKind::kRadar: break;
    case RotationSourceKind::kOdometry:
      return std::make_unique<OdometrySource>(handle, extrinsics.baseFrame(), std::move(callbacks));
    case RotationSourceKind::kImu:
      return std::make_unique<ImuSource>(handle, extrinsics, std::move(callbacks));
    case RotationSourceKind::kTf: {
      const bool is_own = params.fixed_frame.empty() || params.fixed_frame == params.odom_frame;
      require(!is_own, fieldsOf(params), {&params.source, &params.fixed_frame, &params.odom_frame},
              "it needs a world-fixed frame of TF other than that of our own odometry");
      return std::make_unique<TfSource>(params.fixed_frame, extrinsics);
    }
  }
  return nullptr;
}

}  // namespace radar_dot
