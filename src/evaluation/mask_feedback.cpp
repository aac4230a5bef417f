// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "mask_feedback.h"

#include <cmath>
#include <cstddef>

#include "radar_dot/vision/mask_footprint.h"
#include "radar_dot/vision/rigid_motion.h"
#include "radar_scene.h"

namespace radar_dot::evaluation {
namespace {

constexpr double kMaxVelocityAge = 1.0;  // s

}  // namespace

std::vector<std::uint8_t> returnsInMask(const RadarScan& scan, const StampedMask& mask,
                                        const StampedTwist& velocity, const MaskFootprint& footprint) {
  const Eigen::Isometry3d T_mask_from_scan =
      baseMotion(velocity.linear, velocity.angular, scan.time - mask.time) * scan.T_base_from_sensor;
  std::vector<Eigen::Vector3f> points;
  points.reserve(scan.returns->size());
  for (const DopplerReturn& seen : *scan.returns) points.push_back(positionOf(seen, T_mask_from_scan));
  return pointsInMask(points, mask.mask, mask.camera, mask.T_camera_from_base, footprint);
}

void MaskFeedback::mark(std::vector<RadarScan>& scans,
                        const std::function<const StampedMask*(double)>& mask_before,
                        const StampedTwist& velocity) {
  flags_.assign(scans.size(), {});
  for (std::size_t i = 0; i < scans.size(); ++i) {
    RadarScan& scan = scans[i];
    if (std::abs(scan.time - velocity.time) > kMaxVelocityAge) continue;
    const StampedMask* mask = mask_before(scan.time);
    if (mask == nullptr || scan.time < mask->time || scan.time - mask->time > max_age_) continue;
    flags_[i] = returnsInMask(scan, *mask, velocity, footprint_);
    scan.known_dynamic = &flags_[i];
  }
}

}  // namespace radar_dot::evaluation
