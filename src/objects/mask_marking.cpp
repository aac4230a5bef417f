// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/objects/mask_marking.h"

#include <vector>

namespace radar_dot {

std::string markReturns(RadarScan& scan, const StampedMask& mask, double max_age,
                        const MaskFootprint& footprint, const TwistHistory& velocities) {
  const double age = scan.time - mask.time;
  if (age < 0.0) return "the latest mask is " + std::to_string(-age) + " s younger than the scan";
  if (age > max_age)
    return "the latest mask is " + std::to_string(age) + " s older than the scan (mask_max_age)";
  const IntervalMotion motion = velocities.between(mask.time, scan.time, max_age);
  if (!motion.T_begin_from_end) return motion.missing;
  const Eigen::Isometry3d T_mask_from_sensor = *motion.T_begin_from_end * scan.T_base_from_sensor;
  std::vector<Eigen::Vector3f> points;
  points.reserve(scan.returns.size());
  for (const DopplerReturn& seen : scan.returns) points.push_back(positionOf(seen, T_mask_from_sensor));
  scan.known_dynamic = pointsInMask(points, mask, footprint);
  return {};
}

}  // namespace radar_dot
