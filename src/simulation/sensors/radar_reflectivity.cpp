// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensors/radar_reflectivity.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "radar_dot/common/random_stream.h"

namespace radar_dot::simulation {
namespace {

constexpr double kOpaque = -1.0;

/// dBsm at 60 degrees off the normal and 40 m range.
double materialStrength(Material material) {
  switch (material) {
    case Material::kAsphalt:
    case Material::kLanePaint: return -17.0;
    case Material::kPavement: return -13.0;
    case Material::kGrass: return -11.0;
    case Material::kSoil: return -12.0;
    case Material::kKerb: return -3.0;
    case Material::kConcrete:
    case Material::kBrick: return 0.0;
    case Material::kPlaster: return -1.0;
    case Material::kRoof: return -2.0;
    case Material::kWindowPane:
    case Material::kShopWindow: return 1.0;
    case Material::kWood: return -4.0;
    case Material::kFoliage: return -5.0;
    case Material::kBark: return -1.0;
    case Material::kCarPaint: return 5.0;
    case Material::kCarGlass: return -3.0;
    case Material::kPlastic: return -4.0;
    case Material::kTyre: return -5.0;
    case Material::kRim: return 4.0;
    case Material::kChrome: return 7.0;
    case Material::kHeadLamp: return 5.0;
    case Material::kTailLamp: return 3.0;
    case Material::kNumberPlate: return 7.0;
    case Material::kPaintedMetal: return 5.0;
    case Material::kSign: return 9.0;
    case Material::kStreetLamp: return 4.0;
    case Material::kSkin: return -5.0;
    case Material::kHair: return -9.0;
    case Material::kCloth: return -5.0;
    case Material::kLeather: return -6.0;
  }
  return 0.0;
}

/// Standard normal number that belongs to a place.
double normalOfPlace(std::uint64_t object, const Eigen::Vector3d& point, double spot) {
  std::uint64_t place = mixBits(object);
  for (int axis = 0; axis < 3; ++axis)
    place = mixBits(place ^ static_cast<std::uint64_t>(
                                static_cast<std::int64_t>(std::floor(point[axis] / spot)) + 0x100000));
  return RandomStream(place).normal();
}

}  // namespace

double radarTransmissionLoss(Material material) {
  switch (material) {
    case Material::kFoliage: return 2.0;
    case Material::kCarGlass: return 6.0;
    case Material::kWindowPane:
    case Material::kShopWindow: return 9.0;
    case Material::kPlastic: return 5.0;
    default: return kOpaque;
  }
}

double radarCrossSection(const Snapshot& snapshot, const Hit& hit, const Eigen::Vector3f& direction,
                         const Eigen::Vector3d& point, const RadarModel& model) {
  const PlacedObject& object = snapshot.objects()[hit.object];
  const Eigen::Vector3d local = object.T_map_from_object.inverse() * point;
  const double cosine = std::abs(static_cast<double>(hit.normal.dot(direction)));
  double strength = model.rcs_offset + materialStrength(snapshot.surfaceOf(hit).material);
  strength += model.incidence_span * (cosine - 0.5);
  if (cosine > model.specular_cosine) strength += model.specular_gain;
  const double range = std::max(1.0, static_cast<double>(hit.distance));
  strength += model.growth_with_range * std::log10(range / 40.0);
  strength += model.near_growth * std::log10(std::min(1.0, range / model.near_range));
  return strength + model.surface_deviation * normalOfPlace(hit.object, local, model.surface_spot);
}

}  // namespace radar_dot::simulation
