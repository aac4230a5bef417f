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

/// Heading from the yaw rate of a gyro, by the trapezoidal rule; starts at zero.
class YawIntegrator {
 public:
  /// @param max_gap  s; across a longer gap nothing is integrated and the heading restarts
  explicit YawIntegrator(double max_gap = 0.5) : max_gap_(max_gap) {}

  /// Adds a yaw rate (rad/s) measured at `time` (s), which must lie after the previous one.
  /// @return true when the heading restarted: earlier headings do not compare with it.
  bool add(double time, double yaw_rate);
  double yaw() const noexcept { return yaw_; }  ///< rad
  void reset();

 private:
  double max_gap_;
  bool started_ = false;
  double time_ = 0.0, yaw_rate_ = 0.0, yaw_ = 0.0;
};

/// The heading of a rotation as a rotation about z.
Eigen::Quaterniond headingOf(const Eigen::Quaterniond& rotation);

}  // namespace radar_dot
