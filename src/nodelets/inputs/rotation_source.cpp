// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/rotation_source.h"

#include <sensor_msgs/Imu.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <stdexcept>
#include <utility>

#include "nodelets/inputs/stamp_guard.h"
#include "radar_dot/common/base_motion.h"

namespace radar_dot {
namespace {

constexpr std::uint32_t kQueueSize = 200;

constexpr double kMaxRateAge = 0.1;    // s between the stamp that is asked for and a rate that stands for it
constexpr double kRateMemory = 2.0;    // s of rates that are kept
constexpr double kRateInterval = 0.1;  // s between two rotations that make a rate
// rad/s, 1 sigma: of a rate from two rotations, with what it changes since; of a gyro beside the noise that
// it states (many state none), its bias.
constexpr double kDifferenceStd = 0.02, kGyroStd = 0.005;
// Beyond any vehicle, in whatever unit; sums would overflow.
constexpr double kFastest = 1e4;          // rad/s
constexpr double kStrongest = 1e4;        // m/s^2
constexpr double kFarthest = 1e8;         // m
constexpr double kLargestVariance = 1e4;  // (rad/s)^2

/// What both sources of messages have in common: nothing that arrives may end the process, and a
/// wrong stamp costs no more than its own message.
template <typename Message>
class MessageSource : public RotationSource {
 public:
  MessageSource(const ros::NodeHandle& handle, const std::string& topic, Callbacks callbacks)
      : callbacks_(std::move(callbacks)), handle_(handle), topic_(handle_.resolveName(topic)) {}
  void start() override {
    subscriber_ = handle_.subscribe<Message>(
        topic_, kQueueSize, [this](const boost::shared_ptr<const Message>& message) {
          try {
            if (clock_.wentBack(ros::Time::now())) reset();
            callbacks_.arrival();
            use(*message);
          } catch (const std::exception& error) {
            callbacks_.warn(describe() + ": a message is left out: " + error.what());
          }
        });
  }
  std::optional<StampedPose> at(const ros::Time& stamp) override { return buffer_.at(stamp.toSec()); }
  std::optional<double> latest() const override { return buffer_.latest(); }
  void reset() override {
    buffer_.clear();
    stamps_.reset();
  }

 protected:
  virtual void use(const Message& message) = 0;
  /// @return true where time starts again. @throws std::invalid_argument for a stamp that cannot be used.
  bool restartsAt(const ros::Time& stamp) {
    const std::string defect = stampDefect(stamp, ros::Time::now());
    if (!defect.empty()) throw std::invalid_argument(defect);
    const StampGuard::Verdict verdict = stamps_.check(stamp);
    if (verdict == StampGuard::Verdict::kStale) {
      throw std::invalid_argument("stamp not newer than the previous one's");
    }
    return verdict == StampGuard::Verdict::kRestart;
  }
  const std::string& topic() const { return topic_; }

  Callbacks callbacks_;
  PoseBuffer buffer_;

 private:
  ros::NodeHandle handle_;
  std::string topic_;
  StampGuard stamps_;
  ClockWatch clock_;
  ros::Subscriber subscriber_;
};

/// Orientation and position from a nav_msgs/Odometry of the base frame.
class OdometrySource : public MessageSource<nav_msgs::Odometry> {
 public:
  OdometrySource(const ros::NodeHandle& handle, const std::string& base_frame, Callbacks callbacks)
      : MessageSource(handle, "rotation/odom", std::move(callbacks)), base_frame_(base_frame) {}
  bool isAbsolute() const override { return true; }
  bool hasPosition() const override { return true; }
  std::string frame() const override { return frame_; }
  std::string describe() const override { return "odometry on '" + topic() + "'"; }

 private:
  void use(const nav_msgs::Odometry& odometry) override {
    const StampedPose sample = poseOf(odometry);
    if (restartsAt(odometry.header.stamp)) buffer_.clear();
    if (const std::string child = withoutSlash(odometry.child_frame_id);
        !child.empty() && child != base_frame_) {
      callbacks_.warn(describe() + ": its child frame is '" + odometry.child_frame_id + "', not '" +
                      base_frame_ + "'; its rotation is taken as that of '" + base_frame_ + "'");
    }
    frame_ = withoutSlash(odometry.header.frame_id);
    buffer_.add(sample);
    callbacks_.sample();
  }

  std::string base_frame_;
  std::string frame_;
};

/// Attitude from the angular velocity of an IMU, levelled by gravity where it measures that. Its orientation
/// is not used: that of many IMUs is none.
class ImuSource : public MessageSource<sensor_msgs::Imu> {
 public:
  ImuSource(const ros::NodeHandle& handle, Extrinsics& extrinsics, Callbacks callbacks)
      : MessageSource(handle, "rotation/imu", std::move(callbacks)), extrinsics_(extrinsics) {}
  void reset() override {
    MessageSource::reset();
    attitude_.reset();
    rates_.clear();
  }
  std::optional<AngularVelocity> rateAt(const ros::Time& stamp) override {
    const double time = stamp.toSec();
    for (auto rate = rates_.rbegin(); rate != rates_.rend() && time - rate->first <= kMaxRateAge; ++rate)
      if (rate->first <= time) return rate->second;
    return std::nullopt;
  }
  void addVelocity(const StampedTwist& twist) override {
    const std::optional<AngularVelocity> angular = rateAt(ros::Time(twist.time));
    if (twist.observes(0) && angular)
      attitude_.level(twist.time, twist.linear + angular->rate.cross(position_));
  }
  bool isAbsolute() const override { return false; }
  bool hasPosition() const override { return false; }
  std::string frame() const override { return {}; }
  std::string describe() const override {
    const bool is_flat = latest() && !attitude_.isLevel();
    return "IMU on '" + topic() + "'" + (is_flat ? " (heading alone: its acceleration lacks gravity)" : "");
  }

 private:
  void use(const sensor_msgs::Imu& imu) override {
    const Eigen::Vector3d rate(imu.angular_velocity.x, imu.angular_velocity.y, imu.angular_velocity.z);
    // -1 in the first place of a covariance is how sensor_msgs/Imu says "not measured".
    if (!(rate.norm() < kFastest) || imu.angular_velocity_covariance[0] == -1.0) {
      throw std::invalid_argument("it has no angular velocity");
    }
    std::string error;
    const std::optional<Eigen::Isometry3d> mount = extrinsics_.lookup(imu.header.frame_id, error);
    if (!mount) throw std::invalid_argument(error);
    if (restartsAt(imu.header.stamp)) {
      attitude_.reset();
      rates_.clear();
    }
    const double time = imu.header.stamp.toSec();
    const Eigen::Matrix3d& R = mount->linear();
    position_ = mount->translation();
    addRate(time, {R * rate, R * covarianceOf(imu.angular_velocity_covariance) * R.transpose()});
    if (attitude_.add(time, R * rate, R * forceOf(imu))) {
      buffer_.clear();
      callbacks_.restarted();
    }
    StampedPose sample;
    sample.time = time;
    sample.rotation = attitude_.attitude();
    buffer_.add(sample);
    callbacks_.sample();
  }

  /// What the accelerometer measures; zero where there is none.
  static Eigen::Vector3d forceOf(const sensor_msgs::Imu& imu) {
    const Eigen::Vector3d force(imu.linear_acceleration.x, imu.linear_acceleration.y,
                                imu.linear_acceleration.z);
    const bool is_measured = imu.linear_acceleration_covariance[0] != -1.0 && force.norm() < kStrongest;
    return is_measured ? force : Eigen::Vector3d::Zero();
  }
  static Eigen::Matrix3d covarianceOf(const boost::array<double, 9>& values) {
    const Eigen::Matrix3d stated =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(values.data());
    const Eigen::Matrix3d bias = kGyroStd * kGyroStd * Eigen::Matrix3d::Identity();
    const bool is_sound = stated.allFinite() && stated.diagonal().minCoeff() >= 0.0 &&
                          stated.cwiseAbs().maxCoeff() < kLargestVariance;
    return is_sound ? stated + bias : bias;
  }
  void addRate(double time, const AngularVelocity& rate) {
    rates_.emplace_back(time, rate);
    while (time - rates_.front().first > kRateMemory) rates_.pop_front();
  }

  Extrinsics& extrinsics_;
  AttitudeIntegrator attitude_;
  Eigen::Vector3d position_ = Eigen::Vector3d::Zero();    // of the IMU in the base frame, m
  std::deque<std::pair<double, AngularVelocity>> rates_;  // by time, s
};

/// Pose of the base frame in a fixed frame of TF.
class TfSource : public RotationSource {
 public:
  TfSource(std::string fixed_frame, Extrinsics& extrinsics)
      : fixed_frame_(std::move(fixed_frame)), extrinsics_(extrinsics) {}

  std::optional<StampedPose> at(const ros::Time& stamp) override {
    try {
      const Eigen::Isometry3d pose = isometryOf(
          extrinsics_.buffer().lookupTransform(fixed_frame_, extrinsics_.baseFrame(), stamp).transform);
      if (!(pose.translation().norm() < kFarthest)) return std::nullopt;
      latest_ = std::max(latest_.value_or(0.0), stamp.toSec());
      return StampedPose(stamp.toSec(), pose);
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

std::optional<StampedTwist> RotationSource::motionAt(const ros::Time& stamp) {
  const double time = stamp.toSec();
  for (const double end : {time, time - 0.5 * kMaxRateAge, time - kMaxRateAge}) {
    if (end <= kRateInterval) break;
    const std::optional<StampedPose> from = at(ros::Time(end - kRateInterval)), to = at(ros::Time(end));
    if (from && to) return baseVelocity(from->isometry().inverse() * to->isometry(), kRateInterval);
  }
  return std::nullopt;
}

std::optional<AngularVelocity> RotationSource::rateAt(const ros::Time& stamp) {
  const std::optional<StampedTwist> motion = motionAt(stamp);
  if (!motion) return std::nullopt;
  return AngularVelocity{motion->angular, kDifferenceStd * kDifferenceStd * Eigen::Matrix3d::Identity()};
}

void RotationSource::compareRate(double time, double yaw_rate, double variance) {
  if (const std::optional<AngularVelocity> rate = rateAt(ros::Time(time)))
    rates_.add(time, yaw_rate, std::sqrt(variance + rate->covariance(2, 2)), rate->rate.z());
}

void RotationSource::compareSpeed(double time, double forward) {
  if (!hasPosition()) return;
  if (const std::optional<StampedTwist> motion = motionAt(ros::Time(time)))
    speeds_.add(time, forward, motion->linear.x());
}

void RotationSource::compare(const StampedTwist& twist) {
  expireComparisons(twist.time);
  if (twist.observes(5)) compareRate(twist.time, twist.angular.z(), std::max(0.0, twist.covariance(5, 5)));
  if (twist.observes(0)) compareSpeed(twist.time, twist.linear.x());
}

void RotationSource::expireComparisons(double time) {
  rates_.expire(time);
  speeds_.expire(time);
}

std::string RotationSource::contradiction(const std::string& radars, const std::string& rates) const {
  const std::string of_speed = speeds_.warning(radars, describe(), rates);
  const std::string of_rate =
      rates_.warning(radars, describe(),
                     "one of the two is wrong: the unit, the mount or the offset of that "
                     "source, or the mounts or the range rates of the radars");
  return of_speed + (of_speed.empty() || of_rate.empty() ? "" : "; ") + of_rate;
}

StampedPose poseOf(const nav_msgs::Odometry& odometry) {
  const geometry_msgs::Quaternion& q = odometry.pose.pose.orientation;
  const geometry_msgs::Point& p = odometry.pose.pose.position;
  StampedPose sample;
  sample.time = odometry.header.stamp.toSec();
  sample.rotation = Eigen::Quaterniond(q.w, q.x, q.y, q.z);
  sample.position = {p.x, p.y, p.z};
  const double norm = sample.rotation.norm();
  if (!(std::abs(norm - 1.0) < 0.1) || !(sample.position.norm() < kFarthest)) {
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
      const std::string fixed = withoutSlash(params.fixed_frame);
      const bool is_own =
          fixed.empty() || fixed == withoutSlash(params.odom_frame) || fixed == extrinsics.baseFrame();
      require(!is_own, fieldsOf(params), {&params.source, &params.fixed_frame, &params.odom_frame},
              "it needs a world-fixed frame of TF other than that of our own odometry");
      return std::make_unique<TfSource>(fixed, extrinsics);
    }
  }
  return nullptr;
}

}  // namespace radar_dot
