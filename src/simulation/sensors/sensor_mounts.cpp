// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/simulation/sensor_mounts.h"

namespace radar_dot::simulation {
namespace {

Eigen::Isometry3d pose(double x, double y, double z, double qw, double qx, double qy, double qz) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << x, y, z;
  T.linear() = Eigen::Quaterniond(qw, qx, qy, qz).normalized().toRotationMatrix();
  return T;
}

Eigen::Matrix3d intrinsics(double focal, double cx, double cy) {
  return (Eigen::Matrix3d() << focal, 0.0, cx, 0.0, focal, cy, 0.0, 0.0, 1.0).finished();
}

CameraMount camera(const char* channel, const Eigen::Isometry3d& T_base_from_sensor,
                   const Eigen::Matrix3d& matrix) {
  CameraMount mount;
  mount.channel = channel;
  mount.T_base_from_sensor = T_base_from_sensor;
  mount.camera_matrix = matrix;
  return mount;
}

}  // namespace

// Positions, directions and focal lengths of the nuScenes car, rounded.
const std::vector<CameraMount>& cameraMounts() {
  static const std::vector<CameraMount> mounts = {
      camera("CAM_FRONT", pose(1.701, 0.016, 1.511, 0.4998, -0.5030, 0.4998, -0.4974),
             intrinsics(1266.4, 816.3, 491.5)),
      camera("CAM_FRONT_LEFT", pose(1.524, 0.495, 1.509, 0.6757, -0.6736, 0.2121, -0.2112),
             intrinsics(1272.6, 826.6, 479.8)),
      camera("CAM_FRONT_RIGHT", pose(1.551, -0.493, 1.496, 0.2060, -0.2027, 0.6825, -0.6714),
             intrinsics(1260.8, 808.0, 495.3)),
      camera("CAM_BACK", pose(0.028, 0.003, 1.579, 0.5038, -0.4974, -0.4942, 0.5045),
             intrinsics(809.2, 829.2, 481.8)),
      camera("CAM_BACK_LEFT", pose(1.036, 0.485, 1.591, 0.6924, -0.7032, -0.1165, 0.1120),
             intrinsics(1256.7, 792.1, 492.8)),
      camera("CAM_BACK_RIGHT", pose(1.015, -0.481, 1.562, 0.1228, -0.1324, -0.7005, 0.6905),
             intrinsics(1259.5, 807.3, 501.2)),
  };
  return mounts;
}

const std::vector<SensorMount>& radarMounts() {
  static const std::vector<SensorMount> mounts = {
      {"RADAR_FRONT", pose(3.412, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0017)},
      {"RADAR_FRONT_LEFT", pose(2.422, 0.8, 0.78, 0.7172, 0.0, 0.0, 0.6969)},
      {"RADAR_FRONT_RIGHT", pose(2.422, -0.8, 0.77, 0.7010, 0.0, 0.0, -0.7131)},
      {"RADAR_BACK_LEFT", pose(-0.562, 0.628, 0.53, 0.0488, 0.0, 0.0, 0.9988)},
      {"RADAR_BACK_RIGHT", pose(-0.562, -0.618, 0.53, 0.0339, 0.0, 0.0, -0.9994)},
  };
  return mounts;
}

const SensorMount& lidarMount() {
  static const SensorMount mount = {"LIDAR_TOP", pose(0.944, 0.0, 1.840, 0.7078, -0.0065, 0.0106, -0.7063)};
  return mount;
}

}  // namespace radar_dot::simulation
