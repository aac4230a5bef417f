// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/rendering/shader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "simulation/bodies/appearance.h"
#include "simulation/bodies/noise.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector3f;

constexpr float kLampReach = 30.0F;      // m
constexpr float kHeadLampReach = 45.0F;  // m
constexpr float kCell = 10.0F;           // m
constexpr float kFaintMirror = 0.065F;   // fraction of the light
constexpr std::size_t kMostLamps = 24;   // that are looked at from a point
constexpr float kSurfaceOffset = 2e-3F;  // m, keeps rays off the surface they start from

float schlick(float at_normal_incidence, float cosine) {
  const float grazing = 1.0F - std::clamp(cosine, 0.0F, 1.0F);
  const float squared = grazing * grazing;
  return at_normal_incidence + (1.0F - at_normal_incidence) * squared * squared * grazing;
}

void addHeadLamps(const Eigen::Isometry3d& T_map_from_body, double front, double half_width,
                  std::vector<Lamp>& lamps) {
  for (const double side : {-1.0, 1.0}) {
    Lamp lamp;
    lamp.position = (T_map_from_body * Eigen::Vector3d(front, side * half_width, 0.65)).cast<float>();
    lamp.direction =
        (T_map_from_body.linear() * Eigen::Vector3d(1.0, -0.02, -0.035)).cast<float>().normalized();
    lamp.intensity = Color(6.0F, 5.8F, 5.2F);
    lamp.cone_cosine = 0.93F;
    lamps.push_back(lamp);
  }
}

float reachOf(const Lamp& lamp) { return lamp.cone_cosine > 0.8F ? kHeadLampReach : kLampReach; }

/// Light of a lamp on a surface if nothing is in between.
Color unhiddenLight(const Lamp& lamp, const Vector3f& to_lamp, const Vector3f& normal) {
  const float distance = to_lamp.norm();
  const float reach = reachOf(lamp);
  if (distance >= reach || distance < 0.02F) return Color::Zero();
  const Vector3f direction = to_lamp / distance;
  const float facing = normal.dot(direction);
  if (facing <= 0.0F) return Color::Zero();
  const float cone = smoothStep(lamp.cone_cosine, lamp.cone_cosine + 0.6F * (1.0F - lamp.cone_cosine),
                                -direction.dot(lamp.direction));
  const float fade = 1.0F - smoothStep(0.6F * reach, reach, distance);
  return lamp.intensity * (facing * cone * fade / (distance * distance));
}

}  // namespace

std::vector<Lamp> shiningLamps(const World& world, const Eigen::Isometry3d& T_map_from_base, double time_s) {
  if (!world.lighting.night) return {};
  std::vector<Lamp> lamps = world.lighting.lamps;
  addHeadLamps(T_map_from_base, 3.35, 0.62, lamps);
  for (const Actor& actor : world.actors) {
    const Model& model = *actor.model;
    const bool is_motor_vehicle = model.category.rfind("vehicle.", 0) == 0 && model.size.y() > 1.2;
    if (actor.parked || !is_motor_vehicle) continue;
    addHeadLamps(actor.trajectory->at(time_s).T_map_from_body, 0.5 * model.size.x() + 0.02,
                 0.38 * model.size.y(), lamps);
  }
  return lamps;
}

Shader::Shader(const Snapshot& snapshot, const Lighting& lighting, std::vector<Lamp> lamps)
    : snapshot_(snapshot), lighting_(lighting), lamps_(std::move(lamps)) {
  for (const PlacedObject& object : snapshot.objects())
    T_object_from_map_.push_back(object.T_map_from_object.inverse().cast<float>());
  const float height = std::max(0.0F, lighting.to_sun.z());
  ground_glow_ = 0.15F * (lighting.sun * height + 0.6F * lighting.zenith + 0.4F * lighting.horizon);
  sortLamps();
}

void Shader::sortLamps() {
  if (lamps_.empty()) return;
  Eigen::Array2f low = Eigen::Array2f::Constant(std::numeric_limits<float>::max());
  Eigen::Array2f high = -low;
  for (const Lamp& lamp : lamps_) {
    low = low.min(lamp.position.head<2>().array() - reachOf(lamp));
    high = high.max(lamp.position.head<2>().array() + reachOf(lamp));
  }
  grid_x_ = low.x();
  grid_y_ = low.y();
  grid_columns_ = static_cast<int>((high.x() - low.x()) / kCell) + 1;
  grid_rows_ = static_cast<int>((high.y() - low.y()) / kCell) + 1;
  grid_.resize(static_cast<std::size_t>(grid_columns_) * static_cast<std::size_t>(grid_rows_));
  for (int row = 0; row < grid_rows_; ++row) {
    for (int column = 0; column < grid_columns_; ++column) {
      const Eigen::Vector2f centre(grid_x_ + (static_cast<float>(column) + 0.5F) * kCell,
                                   grid_y_ + (static_cast<float>(row) + 0.5F) * kCell);
      for (std::size_t i = 0; i < lamps_.size(); ++i)
        if ((lamps_[i].position.head<2>() - centre).norm() < reachOf(lamps_[i]) + 0.71F * kCell)
          grid_[static_cast<std::size_t>(row * grid_columns_ + column)].push_back(static_cast<int>(i));
    }
  }
}

Color Shader::sky(const Vector3f& direction) const {
  const float height = std::clamp(direction.z(), 0.0F, 1.0F);
  Color color = lighting_.horizon + (lighting_.zenith - lighting_.horizon) * std::sqrt(height);
  const float towards_sun = std::max(0.0F, direction.dot(lighting_.to_sun));
  const float squared = towards_sun * towards_sun;
  const float glow = squared * squared * squared * squared;
  color += lighting_.sun * (0.05F * glow + 0.12F * glow * glow * glow * glow);
  return color;
}

Color Shader::lampLight(const Vector3f& point, const Vector3f& normal) const {
  const int column = static_cast<int>(std::floor((point.x() - grid_x_) / kCell));
  const int row = static_cast<int>(std::floor((point.y() - grid_y_) / kCell));
  if (column < 0 || row < 0 || column >= grid_columns_ || row >= grid_rows_) return Color::Zero();
  const std::vector<int>& near = grid_[static_cast<std::size_t>(row * grid_columns_ + column)];
  std::array<Color, kMostLamps> lights;
  std::array<Vector3f, kMostLamps> rays;
  std::size_t count = 0;
  Color sum = Color::Zero();
  for (const int number : near) {
    if (count == kMostLamps) break;
    const Lamp& lamp = lamps_[static_cast<std::size_t>(number)];
    const Vector3f to_lamp = lamp.position - point;
    lights[count] = unhiddenLight(lamp, to_lamp, normal);
    if (lights[count].maxCoeff() < 1e-4F) continue;
    sum += lights[count];
    rays[count++] = to_lamp;
  }
  // What adds little may shine through walls: the difference is invisible.
  const float faint = 0.06F * sum.maxCoeff();
  for (std::size_t i = 0; i < count; ++i) {
    if (lights[i].maxCoeff() < faint) continue;
    const float distance = rays[i].norm();
    // A lamp's own housing must not hide it.
    if (snapshot_.blocked(point + kSurfaceOffset * normal, rays[i] / distance, 0.0F, distance - 0.25F))
      sum -= lights[i];
  }
  return sum.max(0.0F);
}

bool Shader::canSeeSun(const Vector3f& point, const Hit& hit, Vector3f& start) const {
  if (lighting_.sun.maxCoeff() < 1e-4F) return false;
  const bool from_front = hit.normal.dot(lighting_.to_sun) > 0.0F;
  if (!from_front && snapshot_.surfaceOf(hit).material != Material::kFoliage) return false;
  start = point + (from_front ? kSurfaceOffset : -kSurfaceOffset) * hit.normal;
  return true;
}

/// Of a mirror too faint to show what it reflects: sky above a street's houses, or the ground.
Color Shader::vagueReflection(const Vector3f& direction) const {
  const float above = smoothStep(0.0F, 0.8F, direction.z());
  return ground_glow_ + (sky(direction) - ground_glow_) * above;
}

Color Shader::reflection(const Vector3f& point, const Vector3f& direction, float pixel_angle) const {
  const Hit seen = snapshot_.trace(point, direction);
  if (!seen) return sky(direction);
  return surface(point, direction, seen, 3.0F * pixel_angle, 0.7F, Sun::kUnknown, Mirrors::kNone).radiance;
}

SurfaceLight Shader::surface(const Vector3f& origin, const Vector3f& direction, const Hit& hit,
                             float pixel_angle, float openness, Sun sun, Mirrors mirrors) const {
  const Vector3f point = origin + hit.distance * direction;
  const Vector3f normal = snapshot_.shadingNormal(hit);
  const Surface& surface = snapshot_.surfaceOf(hit);
  const Eigen::Isometry3f& T_object_from_map = T_object_from_map_[hit.object];

  SurfacePoint where;
  const bool ground = isGround(surface.material);
  where.position = ground ? point : Vector3f(T_object_from_map * point);
  where.normal = ground ? hit.normal : Vector3f(T_object_from_map.linear() * hit.normal);
  where.footprint.across = pixel_angle * hit.distance;
  where.footprint.along = where.footprint.across / std::max(0.03F, std::abs(direction.dot(hit.normal)));
  const PlacedObject& object = snapshot_.objects()[hit.object];
  // Parts of one body share its pattern.
  const std::uint32_t owner =
      object.actor >= 0 ? 0x10000U + static_cast<std::uint32_t>(object.actor) : hit.object;
  where.object_seed = hashBits(static_cast<std::int32_t>(owner), 1, 977);
  where.patch_seed = hashBits(static_cast<std::int32_t>(hit.triangle / 2), 2, where.object_seed);
  where.night = lighting_.night;
  const Appearance look = appearanceOf(surface.material, snapshot_.colorOf(hit), where);

  // What falls on it: sun, sky and ground, lamps.
  const float up = 0.5F * (1.0F + normal.z());
  const Color sky_light = 0.55F * lighting_.zenith + 0.45F * lighting_.horizon;
  Color light = openness * (up * sky_light + (1.0F - up) * ground_glow_);
  const float sun_cosine = normal.dot(lighting_.to_sun);
  const bool from_front = sun_cosine > 0.0F && hit.normal.dot(lighting_.to_sun) > 0.0F;
  bool in_sun = false;
  Vector3f start;
  if (sun != Sun::kHidden && canSeeSun(point, hit, start)) {
    in_sun = sun == Sun::kShines || !snapshot_.blocked(start, lighting_.to_sun, 0.0F, kShadowReach);
    if (in_sun) light += lighting_.sun * (from_front ? sun_cosine : look.translucency * std::abs(sun_cosine));
  }
  if (!lamps_.empty()) light += lampLight(point, normal);
  Color radiance = look.albedo * light + look.emission;

  if (in_sun && from_front && look.highlight > 0.0F) {
    const Vector3f halfway = (lighting_.to_sun - direction).normalized();
    const float shine = std::pow(std::max(0.0F, normal.dot(halfway)), look.highlight_exponent);
    radiance += lighting_.sun * (look.highlight * shine);
  }
  if (look.mirror > 0.0F && mirrors != Mirrors::kNone) {
    const float cosine = std::abs(direction.dot(normal));
    const float share = schlick(look.mirror, cosine);
    Vector3f mirrored = direction - 2.0F * direction.dot(normal) * normal;
    mirrored.z() += look.bump * valueNoise(3.0F * where.position.x() + where.position.y(),
                                           3.0F * where.position.z(), where.object_seed);
    mirrored.normalize();
    const Color reflected = mirrors == Mirrors::kVague || share < kFaintMirror
                                ? vagueReflection(mirrored)
                                : reflection(point + kSurfaceOffset * hit.normal, mirrored, pixel_angle);
    radiance = radiance * (1.0F - share) + reflected * share;
  }
  const float haze = std::exp(-hit.distance / lighting_.visibility);
  return {radiance * haze + lighting_.horizon * (1.0F - haze), in_sun};
}

}  // namespace radar_dot::simulation
