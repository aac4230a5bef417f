// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "radar_dot/simulation/ray_tracing.h"
#include "radar_dot/simulation/sensor_mounts.h"
#include "radar_dot/simulation/trajectory.h"
#include "radar_dot/simulation/world.h"

namespace radar_dot::simulation {

/// A pinhole camera in its place. Camera frame: x right, y down, z ahead. Whole pixel coordinates are
/// the centres of pixels.
struct PinholeCamera {
  Eigen::Isometry3d T_map_from_camera = Eigen::Isometry3d::Identity();
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Identity();  ///< px
  int width = 0, height = 0;                             ///< px

  /// Ray through a pixel, camera frame, z = 1.
  Eigen::Vector3d rayOf(double u, double v) const {
    return {(u - matrix(0, 2)) / matrix(0, 0), (v - matrix(1, 2)) / matrix(1, 1), 1.0};
  }
  /// Pixel of a point given in the camera frame, whose z must be positive.
  Eigen::Vector2d project(const Eigen::Vector3d& point) const {
    return {matrix(0, 0) * point.x() / point.z() + matrix(0, 2),
            matrix(1, 1) * point.y() / point.z() + matrix(1, 2)};
  }
};

/// The camera matrix for images of another size than the mount's 1600x900. Whole coordinates are
/// centres of pixels, so the borders of the image stay where they are.
Eigen::Matrix3d scaledCameraMatrix(const CameraMount& mount, int width, int height);

/// The camera of a vehicle at a time.
PinholeCamera cameraAt(const CameraMount& mount, const Trajectory& ego, double time_s, int width, int height);

/// What every pixel's centre sees, row by row.
struct VisibleSurfaces {
  int width = 0, height = 0;
  std::vector<Hit> hits;

  const Hit& at(int u, int v) const {
    return hits[static_cast<std::size_t>(v) * static_cast<std::size_t>(width) + static_cast<std::size_t>(u)];
  }
};
VisibleSurfaces traceSurfaces(const Snapshot& snapshot, const PinholeCamera& camera);

/// Light that reaches the camera: CV_32FC3 linear RGB radiance. Sun with shadows, sky with ambient
/// occlusion, reflections in glass, paint and metal, lamps at night, haze; edges are smoothed with
/// up to three samples per pixel.
cv::Mat renderRadiance(const World& world, const Snapshot& snapshot, const PinholeCamera& camera,
                       const VisibleSurfaces& surfaces, const Eigen::Isometry3d& T_map_from_base);

/// How a camera turns radiance into an image.
struct ImageSensorParams {
  double lens_blur = 0.45;        ///< px, sigma
  double vignetting = 0.18;       ///< fraction of the light lost in the corners
  double full_well = 9000.0;      ///< electrons of a white pixel by day
  double night_full_well = 1500;  ///< the same at night's gain
  double read_noise = 5.0;        ///< electrons
  int jpeg_quality = 90;
};

/// Radiance to an 8-bit BGR picture as the camera would write it: lens, exposure, noise, tone curve.
/// Same seed and stream: same noise.
cv::Mat takePicture(const cv::Mat& radiance, const Lighting& lighting, const ImageSensorParams& params,
                    std::uint64_t seed, std::uint64_t stream);

}  // namespace radar_dot::simulation
