// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/simulation/lidar_sensor.h"

#include <algorithm>
#include <cmath>

#include "radar_dot/common/random_stream.h"

namespace radar_dot::simulation {
namespace {

constexpr double kTwoPi = 6.283185307179586;

/// Fraction of the light that comes straight back, at normal incidence.
double reflectivityOf(Material material, const Color& color) {
  switch (material) {
    case Material::kWindowPane:
    case Material::kShopWindow:
    case Material::kCarGlass: return 0.03;
    case Material::kChrome: return 0.15;
    case Material::kSign:
    case Material::kNumberPlate:
    case Material::kTailLamp: return 1.0;
    case Material::kFoliage: return 0.5;  // bright in the near infrared
    case Material::kGrass: return 0.4;
    case Material::kCarPaint: return 0.10 + 0.5 * static_cast<double>(color.mean());
    default: return 0.06 + 0.8 * static_cast<double>(color.mean());
  }
}

}  // namespace

std::vector<LidarReturn> simulateLidarSweep(const Snapshot& snapshot, const SensorMount& mount,
                                            const Trajectory& ego, const LidarModel& model,
                                            std::uint64_t seed, std::uint64_t stream) {
  // The faintest echo that is still found, as reflectivity over squared range.
  const double threshold = 1.0 / (model.max_range * model.max_range);
  const Eigen::Isometry3d T_map_from_sensor =
      ego.at(snapshot.time()).T_map_from_body * mount.T_base_from_sensor;
  const Eigen::Vector3f origin = T_map_from_sensor.translation().cast<float>();
  RandomStream random(seed, stream);
  std::vector<LidarReturn> returns;
  returns.reserve(static_cast<std::size_t>(model.azimuth_steps * model.beams));
  for (int step = 0; step < model.azimuth_steps; ++step) {
    // It spins clockwise, seen from above.
    const double azimuth = -kTwoPi * step / model.azimuth_steps;
    for (int ring = 0; ring < model.beams; ++ring) {
      const double elevation = model.top_elevation - (model.beams - 1 - ring) * model.beam_step;
      const Eigen::Vector3d direction(std::cos(elevation) * std::cos(azimuth),
                                      std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const Eigen::Vector3f ray = (T_map_from_sensor.linear() * direction).cast<float>();
      const Hit hit = snapshot.trace(origin, ray, static_cast<float>(model.min_range),
                                     static_cast<float>(1.5 * model.max_range));
      if (!hit) continue;
      const double cosine = std::abs(static_cast<double>(ray.dot(hit.normal)));
      const double echo =
          reflectivityOf(snapshot.surfaceOf(hit).material, snapshot.colorOf(hit)) * (0.15 + 0.85 * cosine);
      const double range = hit.distance;
      if (echo * random.uniform(0.7, 1.3) < threshold * range * range) continue;
      const double measured =
          model.quantum * std::round((range + random.normal(0.0, model.range_noise)) / model.quantum);
      returns.push_back({(measured * direction).cast<float>(),
                         static_cast<float>(std::round(std::clamp(255.0 * 0.35 * echo, 0.0, 255.0))), ring,
                         snapshot.objects()[hit.object].actor});
    }
  }
  return returns;
}

}  // namespace radar_dot::simulation
