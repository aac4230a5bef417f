// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <string>
#include <vector>

namespace radar_dot::simulation {

/// A sensor on the vehicle.
struct SensorMount {
  std::string channel;
  Eigen::Isometry3d T_base_from_sensor = Eigen::Isometry3d::Identity();
};

struct CameraMount : SensorMount {
  Eigen::Matrix3d camera_matrix = Eigen::Matrix3d::Identity();  ///< px, for 1600x900
};

// The nuScenes car.
const std::vector<CameraMount>& cameraMounts();  ///< CAM_FRONT first
const std::vector<SensorMount>& radarMounts();   ///< RADAR_FRONT first
const SensorMount& lidarMount();
inline constexpr int kFullWidth = 1600;  ///< px
inline constexpr int kFullHeight = 900;

}  // namespace radar_dot::simulation
