// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <memory>
#include <string>
#include <vector>

#include "radar_dot/simulation/mesh.h"
#include "radar_dot/simulation/trajectory.h"

namespace radar_dot::simulation {

/// How a part moves in its parent: about the y axis of its joint frame.
enum class JointKind {
  kFixed,
  kWheel,         ///< rolls: angle = distance / radius
  kSteeredWheel,  ///< rolls, and turns about z by the steering angle
  kSwing,         ///< swings with the gait: angle = offset + amplitude sin(2 pi distance / stride + phase)
  kBend,          ///< like kSwing, but only to one side: amplitude max(0, sin(...))
  kCrank,         ///< turns with the distance: angle = 2 pi distance / stride + phase (pedals)
};

struct Part {
  std::shared_ptr<const Mesh> mesh;  ///< in the joint's frame
  int parent = -1;                   ///< number of an earlier part; -1 = the body
  Eigen::Isometry3d T_parent_from_joint = Eigen::Isometry3d::Identity();
  JointKind joint = JointKind::kFixed;
  double radius = 0.3;     ///< m, of a wheel
  double stride = 1.4;     ///< m, distance of a whole cycle
  double amplitude = 0.0;  ///< rad
  double phase = 0.0;      ///< rad
  double offset = 0.0;     ///< rad
};

/// A thing of rigid parts. Body frame: origin on the ground under the middle of the box, x ahead,
/// y left, z up.
struct Model {
  std::string category;  ///< nuScenes category, e.g. "vehicle.car"; empty: not annotated
  Eigen::Vector3d size = Eigen::Vector3d::Ones();  ///< m: length (x), width (y), height (z) of its box
  double rear_axle_x = 0.0;                        ///< m; what follows a path. 0 for walkers
  std::vector<Part> parts;

  /// Pose of every part in the body frame.
  std::vector<Eigen::Isometry3d> T_body_from_parts(const BodyState& state) const;
};

}  // namespace radar_dot::simulation
