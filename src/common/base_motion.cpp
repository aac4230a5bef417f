// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/common/base_motion.h"

#include <Eigen/LU>
#include <cmath>
#include <stdexcept>

namespace radar_dot {
namespace {

Eigen::Matrix3d skew(const Eigen::Vector3d& w) {
  Eigen::Matrix3d matrix;
  matrix << 0.0, -w.z(), w.y(), w.z(), 0.0, -w.x(), -w.y(), w.x(), 0.0;
  return matrix;
}

/// Integral of exp(s [w]) over s = 0..1: turns the chord of a constant velocity along its arc.
Eigen::Matrix3d meanRotation(const Eigen::Vector3d& w) {
  const double angle = w.norm();
  const Eigen::Matrix3d k = skew(w);
  if (angle < 1e-4) return Eigen::Matrix3d::Identity() + 0.5 * k + k * k / 6.0;
  const double square = angle * angle;
  return Eigen::Matrix3d::Identity() + (1.0 - std::cos(angle)) / square * k +
         (angle - std::sin(angle)) / (square * angle) * k * k;
}

}  // namespace

Eigen::Quaterniond rotationOf(const Eigen::Vector3d& rotation_vector) {
  const double angle = rotation_vector.norm();
  if (angle < 1e-12) return Eigen::Quaterniond::Identity();
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, rotation_vector / angle));
}

Eigen::Isometry3d baseMotionWithRotation(const Eigen::Vector3d& linear,
                                         const Eigen::Matrix3d& R_previous_from_current, double dt) {
  const Eigen::AngleAxisd rotation(R_previous_from_current);
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = R_previous_from_current;
  motion.translation() = meanRotation(rotation.angle() * rotation.axis()) * linear * dt;
  return motion;
}

Eigen::Isometry3d baseMotion(const Eigen::Vector3d& linear, const Eigen::Vector3d& angular, double dt) {
  const Eigen::Vector3d w = angular * dt;
  const double angle = w.norm();
  const Eigen::Matrix3d rotation =
      angle > 0.0 ? Eigen::AngleAxisd(angle, w / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
  return baseMotionWithRotation(linear, rotation, dt);
}

StampedTwist baseVelocity(const Eigen::Isometry3d& base_previous_from_current, double dt) {
  if (dt == 0.0) throw std::invalid_argument("a motion in no time has no velocity");
  const Eigen::AngleAxisd rotation(base_previous_from_current.linear());
  const Eigen::Vector3d w = rotation.angle() * rotation.axis();
  return {0.0, meanRotation(w).inverse() * base_previous_from_current.translation() / dt, w / dt};
}

}  // namespace radar_dot
