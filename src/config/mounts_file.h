// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "radar_dot/common/fields.h"

namespace radar_dot {

/// How a frame lies in its parent: x, y, z in m, then roll, pitch, yaw in rad about fixed axes.
struct Mount {
  std::string parent, child;
  double x = 0.0, y = 0.0, z = 0.0, roll = 0.0, pitch = 0.0, yaw = 0.0;

  Mount() = default;
  Mount(std::string parent_frame, std::string child_frame, const Eigen::Isometry3d& T_parent_from_child);
  Eigen::Isometry3d isometry() const;  ///< T_parent_from_child
  void describe(FieldList& fields);
};

/// A YAML list of mounts, as for process_bag --tf: "- {parent: base_link, child: radar, x: 3.5, yaw: 0.01}".
/// @throws ConfigFileError
std::vector<Mount> readMounts(const std::string& path);
/// @throws std::runtime_error naming the file
void writeMounts(const std::string& path, const std::vector<Mount>& mounts);

}  // namespace radar_dot
