// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/simulation/model.h"

#include <algorithm>
#include <cmath>

namespace radar_dot::simulation {
namespace {

constexpr double kTwoPi = 6.283185307179586;

Eigen::Isometry3d jointMotion(const Part& part, const BodyState& state) {
  const double cycle = kTwoPi * state.distance / part.stride + part.phase;
  double angle = part.offset;
  double steering = 0.0;
  switch (part.joint) {
    case JointKind::kFixed: break;
    case JointKind::kSteeredWheel: steering = state.steering_angle; [[fallthrough]];
    case JointKind::kWheel: angle += state.distance / part.radius; break;
    case JointKind::kSwing: angle += part.amplitude * std::sin(cycle); break;
    case JointKind::kBend: angle += part.amplitude * std::max(0.0, std::sin(cycle)); break;
    case JointKind::kCrank: angle += cycle; break;
  }
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  motion.linear() = (Eigen::AngleAxisd(steering, Eigen::Vector3d::UnitZ()) *
                     Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()))
                        .toRotationMatrix();
  return motion;
}

}  // namespace

std::vector<Eigen::Isometry3d> Model::T_body_from_parts(const BodyState& state) const {
  std::vector<Eigen::Isometry3d> poses;
  poses.reserve(parts.size());
  for (const Part& part : parts) {
    const Eigen::Isometry3d T_body_from_parent =
        part.parent < 0 ? Eigen::Isometry3d::Identity() : poses[static_cast<std::size_t>(part.parent)];
    poses.push_back(T_body_from_parent * part.T_parent_from_joint * jointMotion(part, state));
  }
  return poses;
}

}  // namespace radar_dot::simulation
