// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/common/pose_buffer.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "radar_dot/common/base_motion.h"

namespace radar_dot {

StampedPose interpolate(const StampedPose& from, const StampedPose& to, double time) {
  const double share = (time - from.time) / (to.time - from.time);
  StampedPose result;
  result.time = time;
  result.position = (1.0 - share) * from.position + share * to.position;
  if (share >= 0.0 && share <= 1.0) {
    result.rotation = from.rotation.slerp(share, to.rotation);
  } else {
    const Eigen::AngleAxisd turn(from.rotation.conjugate() * to.rotation);
    result.rotation = from.rotation * Eigen::AngleAxisd(share * turn.angle(), turn.axis());
  }
  return result;
}

void PoseBuffer::add(const StampedPose& sample) {
  if (!samples_.empty() && sample.time <= samples_.back().time) return;
  samples_.push_back(sample);
  while (samples_.size() > capacity_ || sample.time - samples_.front().time > duration_) samples_.pop_front();
}

std::optional<StampedPose> PoseBuffer::at(double time) const {
  const auto after = std::lower_bound(samples_.begin(), samples_.end(), time,
                                      [](const StampedPose& sample, double t) { return sample.time < t; });
  if (after == samples_.end()) return std::nullopt;
  if (after->time == time) return *after;
  if (after == samples_.begin()) return std::nullopt;
  const StampedPose& before = *std::prev(after);
  if (after->time - before.time > max_gap_) return std::nullopt;
  return interpolate(before, *after, time);
}

std::optional<double> PoseBuffer::latest() const {
  if (samples_.empty()) return std::nullopt;
  return samples_.back().time;
}

bool AttitudeIntegrator::add(double time, const Eigen::Vector3d& rate, const Eigen::Vector3d& force) {
  const bool restarted = !started_ || time - time_ > max_gap_;
  if (restarted) {
    reset();
  } else {
    const double dt = time - time_;
    const Eigen::Quaterniond before = attitude_;
    Eigen::Vector3d turn = dt * (0.5 * (rate_ + rate) - bias_);
    if (!is_level_) turn.head<2>().setZero();
    attitude_ = (before * rotationOf(turn)).normalized();
    by_force_ += 0.5 * dt * (before * force_ + attitude_ * force);
  }
  if (!is_level_ && std::abs(force.norm() - kGravity) < kTolerance) {
    attitude_ = Eigen::Quaterniond::FromTwoVectors(attitude_ * force, Eigen::Vector3d::UnitZ()) * attitude_;
    is_level_ = true;
  }
  started_ = true;
  time_ = time;
  rate_ = rate;
  force_ = force;
  StampedPose now;
  now.time = time;
  now.rotation = attitude_;
  now.position = by_force_;
  track_.add(now);
  return restarted;
}

void AttitudeIntegrator::level(double time, const Eigen::Vector3d& velocity) {
  const std::optional<StampedPose> pose = track_.at(time);
  if (!pose || (levelled_ && time - levelled_->time < kInterval)) return;
  const Velocities now{time, pose->position, pose->rotation * velocity};
  const std::optional<Velocities> before = std::exchange(levelled_, now);
  if (!before) return;
  const double dt = now.time - before->time;
  const Eigen::Vector3d up = (now.by_force - before->by_force - (now.own - before->own)) / dt;
  if (std::abs(up.norm() - kGravity) > kTolerance) return;
  const Eigen::Vector3d error = up.normalized().cross(Eigen::Vector3d::UnitZ());
  // At first the mean of all, so that a start under way is soon forgotten.
  const double mean = 1.0 / ++levellings_, slow = std::min(1.0, dt / kTimeConstant);
  if (mean < slow)  // critically damped
    bias_ -= 0.25 * slow / kTimeConstant * (attitude_.conjugate() * error);
  attitude_ = (rotationOf(std::max(mean, slow) * error) * attitude_).normalized();
  is_level_ = true;
}

void AttitudeIntegrator::reset() { *this = AttitudeIntegrator(max_gap_); }

Eigen::Quaterniond headingOf(const Eigen::Quaterniond& rotation) {
  const Eigen::Vector3d forward = rotation * Eigen::Vector3d::UnitX();
  return Eigen::Quaterniond(
      Eigen::AngleAxisd(std::atan2(forward.y(), forward.x()), Eigen::Vector3d::UnitZ()));
}

}  // namespace radar_dot
