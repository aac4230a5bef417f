// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/pose_track.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace radar_dot::evaluation {
namespace {

constexpr double kExtrapolationBase = 0.25;  // s, so that the jitter of single poses does not matter
constexpr double kMinDistance = 10.0;        // m, below which a fraction of the distance means nothing

double yawOf(const Eigen::Isometry3d& T) { return std::atan2(T.linear()(1, 0), T.linear()(0, 0)); }

}  // namespace

PoseTrack::PoseTrack(std::vector<StampedPose> poses) : poses_(std::move(poses)) {
  if (poses_.size() < 2) throw std::invalid_argument("a pose track needs at least two poses");
  for (std::size_t i = 1; i < poses_.size(); ++i) {
    if (!(poses_[i].time > poses_[i - 1].time)) {
      throw std::invalid_argument("the times of a pose track must increase (pose " + std::to_string(i) + ")");
    }
  }
}

Eigen::Isometry3d PoseTrack::at(double time) const {
  const auto notBefore = [](auto first, auto last, double when) {
    return std::lower_bound(first, last, when,
                            [](const StampedPose& pose, double t) { return pose.time < t; });
  };
  const auto last = std::prev(poses_.end());
  auto to = notBefore(poses_.begin(), poses_.end(), time);
  auto from = to == poses_.begin() ? to : std::prev(to);
  if (to == poses_.begin()) {
    to = notBefore(std::next(to), last, begin() + kExtrapolationBase);
  } else if (to == poses_.end()) {
    to = last;
    from = std::min(notBefore(poses_.begin(), last, end() - kExtrapolationBase), std::prev(last));
  }
  return interpolate(*from, *to, time).isometry();
}

Eigen::Vector3d PoseTrack::meanVelocity(double t0, double t1) const {
  const Eigen::Vector3d displacement = at(t1).translation() - at(t0).translation();
  return at(0.5 * (t0 + t1)).linear().transpose() * displacement / (t1 - t0);
}

double PoseTrack::meanYawRate(double t0, double t1) const {
  const Eigen::Isometry3d T_start_from_end = at(t0).inverse() * at(t1);
  return yawOf(T_start_from_end) / (t1 - t0);
}

double TrajectoryError::rootMeanSquare() const {
  return count == 0 ? std::numeric_limits<double>::quiet_NaN()
                    : std::sqrt(squared_error / static_cast<double>(count));
}

double TrajectoryError::driftPercent() const {
  return distance < kMinDistance ? std::numeric_limits<double>::quiet_NaN() : 100.0 * end_error / distance;
}

void TrajectoryError::describe(Figures& figures) {
  figures.figure("ate_rmse", rootMeanSquare());
  figures.figure("drift_percent", driftPercent());
  figures.figure("distance", distance);
  figures.part(squared_error);
  figures.part(count);
  figures.part(end_error);
  figures.part(distance);
}

TrajectoryError compareTrajectory(const std::vector<StampedPose>& estimate, const PoseTrack& truth) {
  TrajectoryError result;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    const Eigen::Vector3d actual = truth.at(estimate[i].time).translation();
    const double error = (estimate[i].position - actual).norm();
    result.squared_error += error * error;
    ++result.count;
    result.end_error = error;
    // The path through the times of the estimate: the sum over every pose would add up their jitter.
    if (i > 0) result.distance += (actual - truth.at(estimate[i - 1].time).translation()).norm();
  }
  return result;
}

}  // namespace radar_dot::evaluation
