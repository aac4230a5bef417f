// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/common/pose_buffer.h"

#include <algorithm>
#include <cmath>

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

bool YawIntegrator::add(double time, double yaw_rate) {
  const bool restarted = !started_ || time - time_ > max_gap_;
  yaw_ = restarted ? 0.0 : yaw_ + 0.5 * (yaw_rate_ + yaw_rate) * (time - time_);
  started_ = true;
  time_ = time;
  yaw_rate_ = yaw_rate;
  return restarted;
}

void YawIntegrator::reset() {
  started_ = false;
  yaw_ = 0.0;
}

Eigen::Quaterniond headingOf(const Eigen::Quaterniond& rotation) {
  const Eigen::Vector3d forward = rotation * Eigen::Vector3d::UnitX();
  return Eigen::Quaterniond(
      Eigen::AngleAxisd(std::atan2(forward.y(), forward.x()), Eigen::Vector3d::UnitZ()));
}

}  // namespace radar_dot
