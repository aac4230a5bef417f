// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <deque>
#include <optional>

namespace radar_dot {

/// Pose of the base frame in a fixed frame; the position is zero where the source knows the rotation only.
struct StampedPose {
  StampedPose() = default;
  StampedPose(double seconds, const Eigen::Isometry3d& T_fixed_from_base)
      : time(seconds), rotation(T_fixed_from_base.linear()), position(T_fixed_from_base.translation()) {}
  Eigen::Isometry3d isometry() const { return Eigen::Translation3d(position) * rotation; }

  double time = 0.0;  ///< s
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< m
};

/// Linear in position, spherical linear in rotation; beyond the two poses at the same velocities.
StampedPose interpolate(const StampedPose& from, const StampedPose& to, double time);

/// The latest poses of a source, interpolated to any time they enclose.
class PoseBuffer {
 public:
  /// @param duration  s of samples that are kept   @param capacity  samples that are kept
  /// @param max_gap   s between two samples; across a longer gap nothing is interpolated
  explicit PoseBuffer(double duration = 5.0, std::size_t capacity = 10000, double max_gap = 0.5)
      : duration_(duration), capacity_(capacity), max_gap_(max_gap) {}

  /// Later than all before; else it is left out.
  void add(const StampedPose& sample);
  /// Interpolated; none outside the samples.
  std::optional<StampedPose> at(double time) const;
  /// Time of the latest sample, s.
  std::optional<double> latest() const;
  void clear() { samples_.clear(); }

 private:
  double duration_;
  std::size_t capacity_;
  double max_gap_;
  std::deque<StampedPose> samples_;
};

/// Attitude of a vehicle from the gyro and the accelerometer of an IMU, in a frame whose z axis points up and
/// in which it starts with its x axis ahead.
///
/// The angular velocity is integrated by the trapezoidal rule: of the yaw alone, until gravity is seen.
/// Gravity levels the result, slowly, and with it the bias of the gyro is learned: over every kInterval the
/// accelerometer's force, less the change of the vehicle's own velocity, points up. Without that change a car
/// that gets to the speed v would seem to have climbed by v^2 / g, however slow the filter.
class AttitudeIntegrator {
 public:
  static constexpr double kTimeConstant = 5.0;  ///< s, of the levelling
  static constexpr double kInterval = 0.5;      ///< s, at least, between two velocities that level
  static constexpr double kGravity = 9.81;      ///< m/s^2
  static constexpr double kTolerance = 0.5;     ///< m/s^2; a force that differs from gravity by more is none

  /// @param max_gap  s; across a longer gap nothing is integrated and the attitude restarts
  explicit AttitudeIntegrator(double max_gap = 0.5) : max_gap_(max_gap) {}

  /// Adds what was measured at `time` (s), which must lie after the previous one, in the base frame.
  /// @param rate   rad/s   @param force  m/s^2, up at rest; zero: not measured
  /// @return true when the attitude restarted: earlier headings do not compare with its own.
  bool add(double time, const Eigen::Vector3d& rate, const Eigen::Vector3d& force);
  /// Levels. @param velocity  m/s, base frame, of the IMU, at a time among those added; else nothing is done
  void level(double time, const Eigen::Vector3d& velocity);

  const Eigen::Quaterniond& attitude() const noexcept { return attitude_; }
  /// False: gravity was not seen, roll and pitch are zero.
  bool isLevel() const noexcept { return is_level_; }
  void reset();

 private:
  struct Velocities {
    double time;                    // s
    Eigen::Vector3d by_force, own;  // m/s, level frame; own: of the vehicle
  };

  double max_gap_;
  bool started_ = false, is_level_ = false;
  double time_ = 0.0;
  Eigen::Vector3d rate_ = Eigen::Vector3d::Zero(), force_ = Eigen::Vector3d::Zero();  // at time_
  Eigen::Vector3d by_force_ = Eigen::Vector3d::Zero();  // m/s, integral of the force, level frame
  Eigen::Vector3d bias_ = Eigen::Vector3d::Zero();      // rad/s, of the rate
  Eigen::Quaterniond attitude_ = Eigen::Quaterniond::Identity();
  PoseBuffer track_;                    // position: by_force_
  std::optional<Velocities> levelled_;  // at the latest velocity
  int levellings_ = 0;
};

/// The heading of a rotation as a rotation about z.
Eigen::Quaterniond headingOf(const Eigen::Quaterniond& rotation);

}  // namespace radar_dot
