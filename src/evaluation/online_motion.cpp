// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "online_motion.h"

#include <cstddef>
#include <utility>

#include "radar_dot/radar/odometry.h"

namespace radar_dot::evaluation {
namespace {

constexpr double kMaxVelocityAge = 0.5;  // s

}  // namespace

OnlineMotion::OnlineMotion(std::vector<EstimatedVelocity> velocities) : velocities_(std::move(velocities)) {
  VelocityIntegrator integrator;
  integrator.reset();
  for (const EstimatedVelocity& velocity : velocities_) {
    integrator.add(velocity);
    poses_.push_back(integrator.state().T_odom_from_base);
  }
}

std::optional<EstimatedVelocity> OnlineMotion::velocityAt(double time) const {
  const EstimatedVelocity* latest = latestAt(velocities_, time);
  if (latest == nullptr || time - latest->time > kMaxVelocityAge) return std::nullopt;
  return latest->broughtTo(time);
}

Eigen::Isometry3d OnlineMotion::poseAt(double time) const {
  const EstimatedVelocity* latest = latestAt(velocities_, time);
  if (latest == nullptr) return Eigen::Isometry3d::Identity();
  const Eigen::Isometry3d& pose = poses_[static_cast<std::size_t>(latest - velocities_.data())];
  const double dt = time - latest->time;
  const EstimatedVelocity middle = latest->broughtTo(latest->time + 0.5 * dt);
  const double turn = dt * middle.angular.z();
  const Eigen::AngleAxisd half(0.5 * turn, Eigen::Vector3d::UnitZ());
  Eigen::Isometry3d step = Eigen::Isometry3d::Identity();
  step.translation() = half * (dt * middle.linear);
  step.linear() = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  return pose * step;
}

}  // namespace radar_dot::evaluation
