// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/odometry.h"

#include <cmath>

#include "radar_dot/common/base_motion.h"

namespace radar_dot {

void VelocityIntegrator::reset(const Eigen::Isometry3d& T_odom_from_base) {
  state_ = State{};
  state_.T_odom_from_base = T_odom_from_base;
  started_ = false;
}

bool VelocityIntegrator::add(const StampedTwist& twist,
                             const std::optional<Eigen::Quaterniond>& R_odom_from_base) {
  if (!std::isfinite(twist.time) || !twist.linear.allFinite() || !twist.angular.allFinite() ||
      !twist.covariance.allFinite())
    return false;
  if (R_odom_from_base && !R_odom_from_base->coeffs().allFinite()) return false;
  if (started_ && !(twist.time > state_.time)) return false;
  if (!started_) {
    if (R_odom_from_base) state_.T_odom_from_base.linear() = R_odom_from_base->toRotationMatrix();
    started_ = true;
  } else {
    const double dt = twist.time - state_.time;
    const Eigen::Quaterniond start(state_.T_odom_from_base.linear());
    const Eigen::Vector3d turn = 0.5 * (previous_.angular + twist.angular) * dt;
    const Eigen::Quaterniond end =
        (R_odom_from_base ? *R_odom_from_base : start * rotationOf(turn)).normalized();
    const Eigen::Quaterniond middle = start.slerp(0.5, end);
    const Eigen::Vector3d step = 0.5 * (previous_.linear + twist.linear) * dt;
    const Eigen::Vector3d move = middle * step;

    // First-order propagation: position = sum of R v dt; an error of heading turns all later steps.
    const Eigen::Matrix3d R = middle.toRotationMatrix();
    Eigen::Matrix<double, 6, 6> transition = Eigen::Matrix<double, 6, 6>::Identity();
    transition.block<3, 3>(0, 3) << 0.0, move.z(), -move.y(), -move.z(), 0.0, move.x(), move.y(), -move.x(),
        0.0;
    Eigen::Matrix<double, 6, 6> input = Eigen::Matrix<double, 6, 6>::Zero();
    input.block<3, 3>(0, 0) = R * dt;
    if (!R_odom_from_base) input.block<3, 3>(3, 3) = R * dt;
    const Eigen::Matrix<double, 6, 6> covariance = (transition * state_.covariance * transition.transpose() +
                                                    input * twist.covariance * input.transpose())
                                                       .eval();
    if (!covariance.allFinite() || !move.allFinite()) return false;

    state_.covariance = covariance;
    state_.T_odom_from_base.translation() += move;
    state_.T_odom_from_base.linear() = end.toRotationMatrix();
    state_.distance += step.norm();
  }
  state_.time = twist.time;
  previous_ = twist;
  return true;
}

void AccelerationTracker::add(double time, const Eigen::Vector3d& linear) {
  if (!history_.empty() && time <= history_.back().time) history_.clear();
  history_.push_back({time, linear});
  while (time - history_.front().time > window_) history_.pop_front();
}

Eigen::Vector3d AccelerationTracker::acceleration(double time) const {
  if (history_.size() < 3 || std::abs(time - history_.back().time) > window_ ||
      history_.back().time - history_.front().time < 0.25 * window_) {
    return Eigen::Vector3d::Zero();
  }
  double mean_time = 0.0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Sample& sample : history_) {
    mean_time += sample.time - history_.front().time;
    mean += sample.linear;
  }
  const double count = static_cast<double>(history_.size());
  mean_time /= count;
  mean /= count;
  double spread = 0.0;
  Eigen::Vector3d slope = Eigen::Vector3d::Zero();
  for (const Sample& sample : history_) {
    const double offset = sample.time - history_.front().time - mean_time;
    spread += offset * offset;
    slope += offset * (sample.linear - mean);
  }
  const Eigen::Vector3d acceleration = slope / spread;
  return acceleration.norm() <= kMaxAcceleration ? acceleration : Eigen::Vector3d::Zero();
}

}  // namespace radar_dot
