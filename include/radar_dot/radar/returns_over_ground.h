// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "radar_dot/radar/ego_velocity.h"

namespace radar_dot {

/// A return and how fast its reflector moves over ground along the line of sight. Planar, as the radars are.
struct ReturnOverGround {
  double time = 0.0;                                     ///< s, of its scan
  std::size_t radar = 0;                                 ///< RadarScan::radar of its scan
  std::size_t index = 0;                                 ///< in the returns of its scan
  Eigen::Vector2d position = Eigen::Vector2d::Zero();    ///< m, base frame at `time`
  Eigen::Vector2d sensor = Eigen::Vector2d::Zero();      ///< m, of the radar, base frame
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();  ///< m^2, of `position`
  double velocity = 0.0;                                 ///< m/s, positive = recedes
  double variance = 0.0;                                 ///< (m/s)^2, of `velocity`
  ReturnLabel label = ReturnLabel::kStatic;

  /// Unit vector from the radar to the return; zero where both coincide.
  Eigen::Vector2d bearing() const { return (position - sensor).normalized(); }
};

/// Parameters of returnsOverGround: noise of one return, 1 sigma, and the labels.
struct OverGroundParams {
  double range_std = 0.25;
  RadarNoise noise;
  /// More sensitive than what the ego velocity needs: a tracker sorts out what does not move on.
  SegmentationParams segmentation = [] {
    SegmentationParams sensitive;
    sensitive.isolated_threshold = 1.0;
    sensitive.supported_threshold = 0.5;
    return sensitive;
  }();

  void describe(FieldList& fields) {
    fields.group("Returns");
    fields.add("range_std", range_std, "1 sigma of the range of a return", "m", {0.0, 10.0});
    noise.describe(fields);
    fields.add(
        "isolated_speed", segmentation.isolated_threshold,
        "Speed over ground that makes a lone return dynamic; those on radar/dynamic are dynamic anyway",
        "m/s", {0.001, 100.0});
    fields.add("supported_speed", segmentation.supported_threshold,
               "Speed over ground that makes a return dynamic when a neighbour moves with it", "m/s",
               {0.001, 100.0});
    segmentation.describeNeighbours(fields);
  }
};

/// The returns of one scan over ground. With the velocity v and the turn rate w of the base frame, the mount
/// t and the unit bearing u, a return of Doppler velocity d moves along its line of sight with
///     e = d + u.(v + w x t),      var e = doppler_std^2 + (azimuth_std |(v + w x t) across u|)^2,
/// and it lies at t + r u within range_std along u and r azimuth_std across. The bearing of the velocity is
/// turned by RadarScan::bearing_rotation, the position is not. Labels follow from e by SegmentationParams;
/// returns in RadarScan::known_dynamic are dynamic. Returns that are not finite are left out.
/// @param linear   m/s, base frame, of the base origin at the time of the scan
/// @param angular  rad/s, base frame
std::vector<ReturnOverGround> returnsOverGround(const RadarScan& scan, const Eigen::Vector3d& linear,
                                                const Eigen::Vector3d& angular,
                                                const OverGroundParams& params = {});

}  // namespace radar_dot
