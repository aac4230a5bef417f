// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "radar_dot/config/sections.h"
#include "radar_dot/radar/ego_velocity.h"
#include "radar_dot/radar/odometry.h"
#include "radar_dot/vision/camera_intrinsics.h"

namespace radar_dot::evaluation {

/// A mask, and its camera.
struct StampedMask {
  double time = 0.0;  ///< s, of its image
  cv::Mat mask;       ///< CV_8UC1 on the grid of `camera`, not 0 = moves
  CameraIntrinsics camera;
  Eigen::Isometry3d T_camera_from_base = Eigen::Isometry3d::Identity();
};

/// Which returns of a scan lie in a mask taken before it. They are brought to the base frame at the time of
/// the mask as points of a static world, with a constant velocity.
/// @param velocity  the one estimated last
/// @return one value per return: 1 = in the mask, 0 = not
std::vector<std::uint8_t> returnsInMask(const RadarScan& scan, const StampedMask& mask,
                                        const StampedTwist& velocity, const MaskFootprint& footprint = {});

/// The mask's half of the loop between mask and velocity: tells the estimator which returns move.
class MaskFeedback {
 public:
  /// @param config  its mask_max_age and footprint
  explicit MaskFeedback(const EgoVelocityConfig& config)
      : max_age_(config.mask_max_age), footprint_(config.footprint) {}

  /// Sets known_dynamic of the scans that have a mask: at or before their time and not older than the limit,
  /// with a velocity not older than a second, beyond which it says little about the motion since. The flags
  /// belong to this object until its next call.
  /// @param mask_before  the newest mask at or before a time (s), or null; used before the next one is asked
  ///                     for
  void mark(std::vector<RadarScan>& scans, const std::function<const StampedMask*(double)>& mask_before,
            const StampedTwist& velocity);

 private:
  double max_age_;  // s, of a mask at the time of a scan
  MaskFootprint footprint_;
  std::vector<std::vector<std::uint8_t>> flags_;
};

}  // namespace radar_dot::evaluation
