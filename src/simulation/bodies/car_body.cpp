// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/bodies/car_body.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "simulation/bodies/shapes.h"
#include "simulation/bodies/vehicle_body.h"
#include "simulation/bodies/vehicle_parts.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector3f;

constexpr float kPlateRoom = 0.03F;  // m at either end: plates stand out of the skin
constexpr float kRoofEdge = 0.07F;   // m, of the gutter below the middle of the roof
constexpr float kSeamWidth = 0.012F;

float mix(float from, float to, float share) { return from + share * (to - from); }

/// Surfaces of a car by number in the mesh.
struct Paints {
  explicit Paints(MeshBuilder& builder)
      : paint(builder.use(fromPalette(Material::kCarPaint, 0))),
        trim(builder.use(plain(Material::kPlastic, 0.025F))),
        dark(builder.use(plain(Material::kPlastic, 0.008F))),
        glass(builder.use(plain(Material::kCarGlass, 0.02F, 0.025F, 0.025F))),
        head_lamp(builder.use(plain(Material::kHeadLamp, 0.28F, 0.3F, 0.31F))),
        tail_lamp(builder.use(plain(Material::kTailLamp, 0.35F, 0.01F, 0.01F))) {}

  std::uint32_t paint, trim, dark, glass, head_lamp, tail_lamp;
};

/// Fronts and rears of the doors, m.
std::vector<float> doorSeams(const CarShape& shape) {
  const float front = std::min(shape.cowl_x - 0.05F, shape.front_axle_x - shape.wheel_radius - 0.12F);
  std::vector<float> seams = {front, front - 1.12F};
  if (shape.rear_doors) seams.push_back(std::max(front - 2.0F, shape.rear_axle_x + 0.05F));
  return seams;
}

/// One loop of the lower body: how far it is drawn in, and how high it lies.
struct LowerLoop {
  float side, front, rear;  ///< m inwards
  float share;              ///< of the way from the sill to the shoulder; > 1: on the deck
  float scale;              ///< across the vehicle
};

constexpr std::array<LowerLoop, 14> kLowerLoops = {{{0.12F, 0.25F, 0.22F, 0.00F, 0.0F},
                                                    {0.10F, 0.22F, 0.20F, 0.00F, 1.0F},
                                                    {0.03F, 0.06F, 0.06F, 0.03F, 1.0F},
                                                    {0.01F, 0.01F, 0.01F, 0.13F, 1.0F},
                                                    {0.00F, 0.00F, 0.00F, 0.36F, 1.0F},
                                                    {0.00F, 0.01F, 0.00F, 0.56F, 1.0F},
                                                    {0.01F, 0.045F, 0.015F, 0.735F, 1.0F},
                                                    {0.01F, 0.05F, 0.02F, 0.78F, 1.0F},
                                                    {0.03F, 0.14F, 0.05F, 1.00F, 1.0F},
                                                    {0.06F, 0.22F, 0.08F, 1.10F, 1.0F},
                                                    {0.12F, 0.32F, 0.12F, 1.20F, 1.0F},
                                                    {0.12F, 0.32F, 0.12F, 1.20F, 0.75F},
                                                    {0.12F, 0.32F, 0.12F, 1.20F, 0.4F},
                                                    {0.12F, 0.32F, 0.12F, 1.20F, 0.0F}}};
constexpr float kShoulder = 0.055F;  // m, of the shoulder below the deck
constexpr float kCrown = 0.035F;     // m, of the middle of deck and roof above their edges

WheelArches archesOf(const CarShape& shape) {
  return {{shape.front_axle_x, shape.rear_axle_x}, shape.wheel_radius, shape.wheel_radius * 1.14F};
}

Shell lowerShell(const CarShape& shape, const std::vector<float>& side_x) {
  const WheelArches arches = archesOf(shape);
  Shell shell(static_cast<int>(side_x.size()));
  for (const LowerLoop& loop : kLowerLoops) {
    Outline outline;
    outline.front_x = 0.5F * shape.length - kPlateRoom - loop.front;
    outline.rear_x = -0.5F * shape.length + kPlateRoom + loop.rear;
    outline.half_width = 0.5F * shape.width - loop.side;
    outline.front_corner = 0.42F;
    outline.front_corner_width = 0.34F;
    outline.front_bulge = 0.08F;
    outline.rear_corner = 0.2F;
    outline.rear_corner_width = 0.24F;
    outline.rear_bulge = 0.05F;
    outline.side_x = side_x;
    const auto height = [&](const Vector3f& point) {
      const float top = shape.deck(point.x()) - kShoulder;
      const float low = std::max(shape.clearance, arches.lowest(point.x()));
      if (loop.share <= 1.0F) return mix(low, top, loop.share);
      return top + kShoulder * std::min(5.0F * (loop.share - 1.0F), 1.0F) +
             kCrown * crownShare(point, outline, loop.scale);
    };
    shell.add(outline, height, loop.scale);
  }
  return shell;
}

std::uint32_t lowerSurface(const CarShape& shape, const Paints& paints, const std::vector<float>& side_x,
                           const std::vector<float>& seams, int row, const Column& column) {
  const bool front = column.zone == Zone::kFront;
  const bool rear = column.zone == Zone::kRear;
  if (row < 2) return paints.dark;
  if (row == 2) return paints.trim;
  if (front && row == 3 && column.index < 4) return paints.dark;
  if (front && row == 5 && column.index < 4) return paints.dark;
  if (row == 7 && ((front && column.index >= 4) || (column.zone == Zone::kFrontCorner && column.index < 2)))
    return paints.head_lamp;
  if (row == 6 && ((front && column.index >= 4) || (column.zone == Zone::kFrontCorner && column.index < 2)))
    return paints.dark;
  if (rear && row == 3) return paints.trim;
  if ((row == 7 || (shape.upright_tail_lamps && row == 8)) &&
      ((rear && column.index >= 3) || (column.zone == Zone::kRearCorner && column.index < 3)))
    return paints.tail_lamp;
  if (column.zone != Zone::kSide || row > 8) return paints.paint;
  if (column.index < 1 || column.index >= static_cast<int>(side_x.size())) return paints.paint;
  const float ahead = side_x[static_cast<std::size_t>(column.index - 1)];
  const float behind = side_x[static_cast<std::size_t>(column.index)];
  if (shape.dark_trim && row == 3) return paints.trim;
  for (const float seam : seams)
    if (std::abs(seam - ahead) < 0.002F && std::abs(ahead - behind) < 2.0F * kSeamWidth) return paints.dark;
  return paints.paint;
}

/// Shares of the straight side of the cabin where its windows begin and end.
constexpr std::array<float, 8> kCabinStations = {0.03F, 0.2F, 0.40F, 0.455F, 0.63F, 0.80F, 0.835F, 0.96F};
constexpr int kDoorPost = 3;

/// The cabin seen from above at a fraction of the way from the belt line to the gutter.
Outline cabinOutline(const CarShape& shape, float share, float inset) {
  constexpr float kCorner = 0.14F;
  const float swell = 0.10F * share * (1.0F - share);
  Outline outline;
  outline.front_x = mix(shape.cowl_x, shape.roof_front_x, share) + swell - inset;
  outline.rear_x = mix(shape.rear_base_x, shape.roof_rear_x, share) - swell + inset;
  outline.half_width = 0.5F * shape.width - 0.065F - share * shape.tumblehome + swell * 0.5F - inset;
  outline.front_corner = kCorner;
  outline.front_corner_width = 0.16F;
  outline.front_bulge = 0.16F;
  outline.rear_corner = kCorner;
  outline.rear_corner_width = 0.14F;
  outline.rear_bulge = 0.05F;
  const float base_front = shape.cowl_x - kCorner;
  const float base_rear = shape.rear_base_x + kCorner;
  const float roof_front = shape.roof_front_x - kCorner;
  const float roof_rear = shape.roof_rear_x + kCorner;
  // The post between the doors stands upright; the others lean with the ends of the cabin.
  const float post = kCabinStations[kDoorPost];
  const float post_x = mix(base_front, base_rear, post);
  const float post_on_roof =
      std::clamp((post_x - 0.03F - roof_front) / (roof_rear - roof_front), 0.2F, 0.55F);
  for (const float station : kCabinStations) {
    const float on_roof = station < post ? station / post * post_on_roof
                                         : mix(post_on_roof, 1.0F, (station - post) / (1.0F - post));
    outline.side_x.push_back(
        mix(mix(base_front, base_rear, station), mix(roof_front, roof_rear, on_roof), share));
  }
  return outline;
}

Shell cabinShell(const CarShape& shape) {
  struct Loop {
    float share, scale, inset;
  };
  const std::array<Loop, 12> loops = {{{-0.10F, 1.0F, 0.0F},
                                       {0.00F, 1.0F, 0.0F},
                                       {0.06F, 1.0F, 0.0F},
                                       {0.5F * shape.glass_top, 1.0F, 0.0F},
                                       {shape.glass_top, 1.0F, 0.0F},
                                       {0.5F + 0.5F * shape.glass_top, 1.0F, 0.0F},
                                       {1.00F, 1.0F, 0.0F},
                                       {1.04F, 1.0F, 0.04F},
                                       {1.06F, 1.0F, 0.10F},
                                       {1.06F, 0.75F, 0.10F},
                                       {1.06F, 0.4F, 0.10F},
                                       {1.06F, 0.0F, 0.10F}}};
  const float roof_edge = shape.height - kRoofEdge;
  Shell shell(static_cast<int>(kCabinStations.size()));
  for (const Loop& loop : loops) {
    const float share = std::min(loop.share, 1.0F);
    const Outline outline = cabinOutline(shape, share, loop.inset);
    const auto height = [&](const Vector3f& point) {
      const float back =
          std::clamp((shape.roof_front_x - point.x()) / (shape.roof_front_x - shape.roof_rear_x), 0.0F, 1.0F);
      const float along =
          std::clamp((shape.cowl_x - point.x()) / (shape.cowl_x - shape.rear_base_x), 0.0F, 1.0F);
      const float belt = mix(shape.cowl_z, shape.tail_z, along);
      const float roof = roof_edge - shape.roof_drop * back * back +
                         (kRoofEdge - kCrown) * std::max(loop.share - 1.0F, 0.0F) / 0.06F +
                         kCrown * crownShare(point, outline, loop.scale);
      return mix(belt - 0.01F, roof, share);
    };
    shell.add(outline, height, loop.scale);
  }
  return shell;
}

std::uint32_t cabinSurface(const CarShape& shape, const Paints& paints, int row, const Column& column) {
  const bool window_row = row >= 2 && row < 4;
  if (column.zone == Zone::kFront || (column.zone == Zone::kFrontCorner && column.index < 2)) {
    if (row < 2) return paints.dark;  // wipers' gap
    return row < 4 || (row == 4 && shape.glass_top > 0.8F) ? paints.glass : paints.paint;
  }
  if (column.zone == Zone::kSide) {
    const bool post = column.index == 3 || column.index == 6;
    const bool window = column.index == 1 || column.index == 2 ||
                        ((column.index == 4 || column.index == 5) && shape.rear_side_windows) ||
                        (column.index == 7 && shape.quarter_windows);
    if (window_row && window) return paints.glass;
    if (window_row && post && shape.rear_side_windows) return paints.trim;
    if (row == 1 && window) return paints.trim;
    return paints.paint;
  }
  if (column.zone == Zone::kRear && column.index < 4 && window_row) return paints.glass;
  if (shape.upright_tail_lamps && row < 3 && column.zone == Zone::kRearCorner && column.index < 3)
    return paints.tail_lamp;
  return paints.paint;
}

/// Handles, plates, exhaust, mirrors, and what blocks the view through the wheel arches.
void addDetails(MeshBuilder& builder, const CarShape& shape, const std::vector<float>& seams) {
  const float side = 0.5F * shape.width;
  builder.use(plain(Material::kPlastic, 0.01F));
  for (const float axle : {shape.front_axle_x, shape.rear_axle_x})
    builder.box({axle - 0.34F, -side + 0.3F, shape.clearance},
                {axle + 0.34F, side - 0.3F, shape.wheel_radius * 1.9F});
  builder.use(plain(Material::kPlastic, 0.05F));
  for (std::size_t i = 1; i < seams.size(); ++i)
    for (const float hand : {1.0F, -1.0F}) {
      const float z = shape.deck(seams[i]) - 0.13F;
      const Vector3f middle(seams[i] + 0.17F, hand * (side - 0.012F), z);
      builder.box(middle - Vector3f(0.09F, 0.018F, 0.013F), middle + Vector3f(0.09F, 0.018F, 0.013F));
    }
  const float bumper_z = mix(shape.clearance, shape.nose_z, 0.42F);
  addNumberPlate(builder, {0.5F * shape.length - 0.022F, 0, bumper_z}, true);
  const float plate_z =
      mix(shape.clearance, shape.deck(-0.5F * shape.length), shape.rear_doors ? 0.62F : 0.4F);
  addNumberPlate(builder, {-0.5F * shape.length + 0.022F, 0, plate_z}, false);
  addMirrors(builder, {shape.cowl_x - 0.42F, side - 0.09F, shape.cowl_z + 0.02F},
             {0.11F, 0.16F, shape.height > 2.0F ? 0.28F : 0.13F});
}

}  // namespace

float CarShape::deck(float x) const {
  const float nose = 0.5F * length - 0.1F;
  if (x >= cowl_x) {
    const float back = std::clamp((nose - x) / (nose - cowl_x), 0.0F, 1.0F);
    return nose_z + (cowl_z - nose_z) * std::pow(back, 0.75F);
  }
  const float along = std::clamp((cowl_x - x) / (cowl_x - rear_base_x), 0.0F, 1.0F);
  return mix(cowl_z, tail_z, along) - 0.03F * std::clamp((rear_base_x - x) / 0.5F, 0.0F, 1.0F);
}

Mesh buildCarBody(const CarShape& shape) {
  MeshBuilder builder;
  const Paints paints(builder);
  const std::vector<float> seams = doorSeams(shape);
  std::vector<float> extra;
  for (const float seam : seams) {
    extra.push_back(seam);
    extra.push_back(seam - kSeamWidth);
  }
  const std::vector<float> side_x =
      archesOf(shape).stations(0.5F * shape.length - 0.5F, -0.5F * shape.length + 0.3F, 0.5F, extra);
  lowerShell(shape, side_x).build(builder, [&](int row, const Column& column) {
    return lowerSurface(shape, paints, side_x, seams, row, column);
  });
  cabinShell(shape).build(
      builder, [&](int row, const Column& column) { return cabinSurface(shape, paints, row, column); });
  addDetails(builder, shape, seams);
  return std::move(builder).build();
}

}  // namespace radar_dot::simulation
