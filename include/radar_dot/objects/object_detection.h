// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <vector>

#include "radar_dot/radar/returns_over_ground.h"

namespace radar_dot {

/// A box of whole pixels; empty where nothing was seen in an image.
struct ImageBox {
  int x = 0, y = 0;           ///< px, first column and row
  int width = 0, height = 0;  ///< px
  bool empty() const noexcept { return width <= 0 || height <= 0; }
};

/// What an image tells of the velocity of an object: row.v = value, within the given variance. `row` need not
/// be a unit vector; v is over ground, m/s, axes of the base frame.
struct VelocityConstraint {
  Eigen::Vector2d row = Eigen::Vector2d::Zero();
  double value = 0.0;
  double variance = 0.0;
};

/// A connected region of a mask of moving pixels.
struct MaskRegion {
  ImageBox box;
  std::size_t pixel_count = 0;
  Eigen::Vector2d position = Eigen::Vector2d::Zero();    ///< m, base frame: median pixel at the median depth
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< m^2
  /// px, median flow residual over the interval of the pair of images, and what follows from it. NaN and
  /// an infinite variance where no flow is known.
  Eigen::Vector2d flow_residual = Eigen::Vector2d::Zero();
  VelocityConstraint lateral;
};

/// Something that moves, at one time.
struct ObjectDetection {
  double time = 0.0;                                              ///< s
  Eigen::Vector2d position = Eigen::Vector2d::Zero();             ///< m, base frame
  Eigen::Matrix2d position_covariance = Eigen::Matrix2d::Zero();  ///< m^2
  Eigen::Vector2d velocity = Eigen::Vector2d::Zero();             ///< m/s over ground, axes of the base frame
  /// (m/s)^2. Directions that nothing tells of carry DetectionParams::unobserved_std^2; the velocity along
  /// them is zero.
  Eigen::Matrix2d velocity_covariance = Eigen::Matrix2d::Zero();
  std::size_t return_count = 0;
  std::size_t pixel_count = 0;
  ImageBox box;
  /// False for a return whose own velocity does not say that it moves: it may carry on a track, but not
  /// start one.
  bool moving = true;
};

/// Parameters of detectObjects.
struct DetectionParams {
  double max_distance = 4.0;
  double max_velocity_difference = 1.0;
  double extent_std = 0.5;            // more returns do not average it out
  double shared_velocity_std = 0.12;  // rounding, moving parts, the ego velocity
  double unobserved_std = 100.0;
  double weak_threshold = 0.5;
  double region_gate = 3.0;

  void describe(FieldList& fields) {
    fields.group("Detection");
    fields.add("max_distance", max_distance, "Largest distance between neighbouring returns of one object",
               "m", {0.01, 100.0});
    fields.add("max_velocity_difference", max_velocity_difference,
               "Largest difference between their velocities along the lines of sight", "m/s", {0.01, 100.0});
    fields.add("extent_std", extent_std, "1 sigma of where on an object its returns lie", "m", {0.0, 100.0});
    fields.add("shared_velocity_std", shared_velocity_std,
               "1 sigma of the velocity error shared by the returns of one radar on one object", "m/s",
               {0.0, 100.0});
    fields.add("unobserved_std", unobserved_std,
               "1 sigma of the components of a velocity that nothing measures", "m/s", {0.01, 1e6});
    fields.add("weak_threshold", weak_threshold,
               "Static returns at least this fast may continue a track; inf: none", "m/s", {0.0});
    fields.add("region_gate", region_gate,
               "Region of the mask and returns are one object within this Mahalanobis distance", "sigma",
               {0.1, 100.0});
  }
};

/// Groups dynamic returns, and the regions of a mask of the same time, into objects. Returns are neighbours
/// when they are close in space and velocity; an object is what is connected by neighbours. The velocity
/// solves, by least squares weighted with the variances,
///     u_k.v = e_k   for each radar k: mean bearing and median velocity of its returns,
///     a.v = b       for a region (see MaskRegion::lateral),
///     v = 0         within unobserved_std.
/// One radar thus tells the velocity along one line; two that see the object under different bearings, or a
/// radar and an image, tell both components.
/// @param returns  of one scan, or of several brought to one time; static ones see weak_threshold
/// @param regions  of a mask; empty without images. One without returns is a detection by itself.
/// @throws std::invalid_argument see validate
std::vector<ObjectDetection> detectObjects(double time, const std::vector<ReturnOverGround>& returns,
                                           const std::vector<MaskRegion>& regions = {},
                                           const DetectionParams& params = {});

}  // namespace radar_dot
