// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>

#include "simulation/bodies/make_models.h"
#include "simulation/bodies/shapes.h"
#include "simulation/bodies/vehicle_body.h"
#include "simulation/bodies/vehicle_parts.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector3f;

struct LargeLoop {
  float inset;  ///< m, all round
  float lean;   ///< m that the front is drawn back
  float z;
  float scale;
};

Outline largeOutline(float length, float width, const LargeLoop& loop, const std::vector<float>& side_x) {
  Outline outline;
  outline.front_x = 0.5F * length - loop.inset - loop.lean;
  outline.rear_x = -0.5F * length + loop.inset;
  outline.half_width = 0.5F * width - loop.inset;
  outline.front_corner = 0.25F;
  outline.front_corner_width = 0.3F;
  outline.front_bulge = 0.1F;
  outline.rear_corner = 0.12F;
  outline.rear_corner_width = 0.14F;
  outline.rear_bulge = 0.0F;
  outline.side_x = side_x;
  return outline;
}

/// Loops squeezed between the wheel arches and `squeeze_top` (m), with a crowned roof.
void addLoops(Shell& shell, const std::array<LargeLoop, 12>& loops, float length, float width,
              const std::vector<float>& side_x, const WheelArches& arches, float squeeze_top) {
  constexpr float kCrown = 0.04F;  // m
  const float floor = loops.front().z;
  for (const LargeLoop& loop : loops) {
    const Outline outline = largeOutline(length, width, loop, side_x);
    const float crown = loop.z > squeeze_top ? kCrown : 0.0F;
    const auto height = [&](const Vector3f& point) {
      return arches.lift(point.x(), loop.z, floor, squeeze_top) +
             crown * crownShare(point, outline, loop.scale);
    };
    shell.add(outline, height, loop.scale);
  }
}

void addLamp(MeshBuilder& builder, const Vector3f& centre, const Vector3f& half_size) {
  for (const float side : {1.0F, -1.0F}) {
    const Vector3f middle(centre.x(), side * centre.y(), centre.z());
    builder.box(middle - half_size, middle + half_size);
  }
}

constexpr float kBusLength = 11.94F;
constexpr float kBusWidth = 2.53F;
constexpr float kBusFrontAxle = 3.2F;
constexpr float kBusRearAxle = -2.7F;
constexpr float kBusWheel = 0.48F;
constexpr std::array<float, 3> kBusDoors = {4.45F, 0.55F, -4.6F};  // x of the middles, right side
constexpr float kBusDoorHalf = 0.62F;
enum BusRow { kFloorMiddle, kFloorEdge, kSill, kSkirt, kBelt, kGlassLow, kGlassHigh, kCornice, kRoofEdge };

WheelArches busArches() { return {{kBusFrontAxle, kBusRearAxle}, kBusWheel, kBusWheel * 1.12F}; }

struct BusPlan {
  std::vector<float> side_x;
  std::vector<float> posts;  ///< x of the pillars between the windows
};

BusPlan busPlan() {
  BusPlan plan;
  std::vector<float> extra;
  for (float x = 5.15F; x > -5.7F; x -= 1.3F) plan.posts.push_back(x);
  for (const float post : plan.posts) {
    extra.push_back(post + 0.035F);
    extra.push_back(post - 0.035F);
  }
  for (const float door : kBusDoors)
    for (const float edge :
         {-kBusDoorHalf, -kBusDoorHalf + 0.05F, -0.02F, 0.02F, kBusDoorHalf - 0.05F, kBusDoorHalf})
      extra.push_back(door + edge);
  plan.side_x = busArches().stations(5.6F, -5.75F, 1.4F, extra);
  return plan;
}

bool near(const std::vector<float>& values, float x, float reach) {
  return std::any_of(values.begin(), values.end(), [&](float value) { return std::abs(value - x) < reach; });
}

struct BusPaints {
  explicit BusPaints(MeshBuilder& builder)
      : paint(builder.use(fromPalette(Material::kCarPaint, 0))),
        second(builder.use(fromPalette(Material::kCarPaint, 3))),
        dark(builder.use(plain(Material::kPlastic, 0.01F))),
        trim(builder.use(plain(Material::kPlastic, 0.03F))),
        glass(builder.use(plain(Material::kCarGlass, 0.025F, 0.03F, 0.03F))),
        sign(builder.use(plain(Material::kPlastic, 0.9F, 0.5F, 0.05F))) {}
  std::uint32_t paint, second, dark, trim, glass, sign;
};

std::uint32_t busSurface(const BusPlan& plan, const BusPaints& paints, int row, const Column& column) {
  if (row < kSill) return paints.dark;
  const bool side = column.zone == Zone::kSide;
  const int stations = static_cast<int>(plan.side_x.size());
  const float x = side && column.index > 0 && column.index < stations
                      ? 0.5F * (plan.side_x[static_cast<std::size_t>(column.index - 1)] +
                                plan.side_x[static_cast<std::size_t>(column.index)])
                      : 100.0F;
  if (side && !column.left && row < kCornice)
    for (const float door : kBusDoors)
      if (std::abs(x - door) < kBusDoorHalf)
        return std::abs(x - door) < 0.021F || std::abs(x - door) > kBusDoorHalf - 0.05F || row == kSill
                   ? paints.trim
                   : paints.glass;
  if (column.zone == Zone::kFront || (column.zone == Zone::kFrontCorner && column.index < 2)) {
    if (row == kBelt || row == kGlassLow) return paints.glass;
    if (row == kGlassHigh) return column.zone == Zone::kFront && column.index < 4 ? paints.sign : paints.trim;
  }
  if (row == kGlassLow && side) {
    if (x > 50.0F || near(plan.posts, x, 0.034F)) return paints.trim;
    return paints.glass;
  }
  if (row == kGlassLow && column.zone == Zone::kRear && column.index < 4) return paints.glass;
  if (row == kGlassLow && column.zone != Zone::kRear) return paints.trim;
  if (row == kSkirt && (!side || busArches().lowest(x) <= 0.0F)) return paints.second;
  return paints.paint;
}

Mesh busBody() {
  MeshBuilder builder;
  const BusPaints paints(builder);
  const BusPlan plan = busPlan();
  const WheelArches arches = busArches();
  constexpr std::array<LargeLoop, 12> kLoops = {{{0.1F, 0.0F, 0.32F, 0.0F},
                                                 {0.1F, 0.0F, 0.32F, 1.0F},
                                                 {0.0F, 0.0F, 0.34F, 1.0F},
                                                 {0.0F, 0.0F, 0.62F, 1.0F},
                                                 {0.0F, 0.0F, 1.02F, 1.0F},
                                                 {0.0F, 0.02F, 1.28F, 1.0F},
                                                 {0.02F, 0.12F, 2.45F, 1.0F},
                                                 {0.03F, 0.18F, 2.72F, 1.0F},
                                                 {0.06F, 0.24F, 2.95F, 1.0F},
                                                 {0.18F, 0.32F, 3.06F, 1.0F},
                                                 {0.18F, 0.32F, 3.06F, 0.6F},
                                                 {0.18F, 0.32F, 3.06F, 0.0F}}};
  Shell shell(static_cast<int>(plan.side_x.size()));
  addLoops(shell, kLoops, kBusLength, kBusWidth, plan.side_x, arches, 1.28F);
  shell.build(builder, [&](int row, const Column& column) { return busSurface(plan, paints, row, column); });
  builder.use(plain(Material::kPlastic, 0.01F));
  for (const float axle : {kBusFrontAxle, kBusRearAxle})
    builder.box({axle - 0.52F, -0.85F, 0.34F}, {axle + 0.52F, 0.85F, 1.0F});
  builder.use(plain(Material::kHeadLamp, 0.28F, 0.3F, 0.31F));
  addLamp(builder, {5.86F, 0.85F, 0.72F}, {0.08F, 0.16F, 0.09F});
  builder.use(plain(Material::kTailLamp, 0.35F, 0.01F, 0.01F));
  addLamp(builder, {-5.95F, 1.02F, 0.95F}, {0.035F, 0.08F, 0.25F});
  addNumberPlate(builder, {0.5F * kBusLength + 0.012F, 0, 0.48F}, true);
  addNumberPlate(builder, {-0.5F * kBusLength - 0.012F, 0, 0.75F}, false);
  addMirrors(builder, {5.62F, 1.15F, 2.0F}, {0.14F, 0.2F, 0.42F});
  return std::move(builder).build();
}

constexpr float kTruckWidth = 2.46F;
constexpr float kCabLength = 1.95F;
constexpr float kTruckWheel = 0.46F;

/// Cab of a lorry with its front at x = `front_x`, in the body frame.
void addCab(MeshBuilder& builder, float front_x, float axle_x) {
  enum Row { kFloor, kUnder, kBumper, kLower, kGrille, kBeltLine, kWindow, kBrow, kRoof };
  constexpr std::array<LargeLoop, 12> kLoops = {{{0.1F, 0.0F, 0.45F, 0.0F},
                                                 {0.1F, 0.0F, 0.45F, 1.0F},
                                                 {0.0F, 0.0F, 0.48F, 1.0F},
                                                 {0.0F, 0.0F, 0.78F, 1.0F},
                                                 {0.02F, 0.02F, 1.0F, 1.0F},
                                                 {0.03F, 0.04F, 1.45F, 1.0F},
                                                 {0.04F, 0.06F, 1.6F, 1.0F},
                                                 {0.08F, 0.26F, 2.38F, 1.0F},
                                                 {0.11F, 0.34F, 2.55F, 1.0F},
                                                 {0.2F, 0.42F, 2.64F, 1.0F},
                                                 {0.2F, 0.42F, 2.64F, 0.6F},
                                                 {0.2F, 0.42F, 2.64F, 0.0F}}};
  MeshBuilder cab;
  const std::uint32_t paint = cab.use(fromPalette(Material::kCarPaint, 0));
  const std::uint32_t dark = cab.use(plain(Material::kPlastic, 0.012F));
  const std::uint32_t glass = cab.use(plain(Material::kCarGlass, 0.02F, 0.025F, 0.025F));
  const std::uint32_t lamp = cab.use(plain(Material::kHeadLamp, 0.28F, 0.3F, 0.31F));
  const float middle = front_x - 0.5F * kCabLength;
  const float axle = axle_x - middle;
  const WheelArches arches{{axle}, kTruckWheel, kTruckWheel * 1.13F};
  const std::vector<float> side_x = arches.stations(0.5F * kCabLength - 0.32F, -0.5F * kCabLength + 0.2F,
                                                    0.4F, {0.55F, 0.538F, -0.35F, -0.362F});
  Shell shell(static_cast<int>(side_x.size()));
  addLoops(shell, kLoops, kCabLength, kTruckWidth - 0.06F, side_x, arches, 1.45F);
  const auto surface = [&](int row, const Column& column) {
    const bool front = column.zone == Zone::kFront;
    if (row == kBumper && front && column.index >= 3) return lamp;
    if (row <= kBumper) return dark;
    if (row == kGrille && front && column.index < 4) return dark;
    if (row == kWindow && (front || (column.zone == Zone::kFrontCorner && column.index < 2))) return glass;
    if (row == kBeltLine && front) return dark;
    if (column.zone != Zone::kSide || column.index < 1 || column.index >= static_cast<int>(side_x.size()))
      return paint;
    const float ahead = side_x[static_cast<std::size_t>(column.index - 1)];
    const float behind = side_x[static_cast<std::size_t>(column.index)];
    if (row == kWindow && ahead < 0.54F && behind > -0.36F) return glass;
    if (row > kBumper && row < kBrow &&
        (std::abs(ahead - 0.55F) < 0.002F || std::abs(ahead + 0.35F) < 0.002F))
      return dark;
    return paint;
  };
  shell.build(cab, surface);
  builder.add(std::move(cab).build(), translation(Vector3f(middle, 0, 0)));
  addMirrors(builder, {front_x - 0.45F, 0.5F * kTruckWidth - 0.12F, 1.75F}, {0.12F, 0.2F, 0.5F});
  addNumberPlate(builder, {front_x, 0, 0.6F}, true);
}

/// Box, chassis, guards and lamps behind the cab.
void addLoad(MeshBuilder& builder, float front_x, float rear_x, float height, float axle_x) {
  const float half = 0.5F * kTruckWidth;
  builder.use(fromPalette(Material::kCarPaint, 3));
  builder.box({rear_x + 0.04F, -half, 1.05F}, {front_x, half, height});
  builder.use(plain(Material::kChrome, 0.45F));
  for (const float y : {-half, half})
    for (const float z : {1.08F, height - 0.02F}) {
      builder.box({rear_x + 0.03F, y - 0.015F, z - 0.05F}, {front_x + 0.01F, y + 0.015F, z + 0.02F});
    }
  for (const float y : {-half + 0.06F, -0.02F, half - 0.1F})
    builder.box({rear_x + 0.015F, y, 1.1F}, {rear_x + 0.045F, y + 0.04F, height - 0.06F});
  builder.use(plain(Material::kPlastic, 0.02F));
  builder.box({rear_x + 0.2F, -0.45F, 0.62F}, {front_x + 0.6F, 0.45F, 0.95F});
  builder.box({rear_x + 0.05F, -half + 0.1F, 0.95F}, {front_x, half - 0.1F, 1.06F});
  builder.box({axle_x - 0.06F, -half + 0.2F, kTruckWheel - 0.06F},
              {axle_x + 0.06F, half - 0.2F, kTruckWheel + 0.06F});
  builder.box({rear_x + 0.06F, -half + 0.08F, 0.48F}, {rear_x + 0.16F, half - 0.08F, 0.6F});
  builder.box({rear_x + 0.1F, -0.5F, 0.55F}, {rear_x + 0.2F, -0.42F, 0.95F});
  builder.box({rear_x + 0.1F, 0.42F, 0.55F}, {rear_x + 0.2F, 0.5F, 0.95F});
  for (const float y : {-half + 0.06F, half - 0.1F}) {  // side guards, tank
    builder.box({axle_x + 0.7F, y, 0.45F}, {front_x - 0.35F, y + 0.04F, 0.57F});
    builder.box({axle_x + 0.7F, y, 0.7F}, {front_x - 0.35F, y + 0.04F, 0.82F});
    for (const float x : {axle_x + 0.75F, front_x - 0.45F})
      builder.box({x, y, 0.45F}, {x + 0.06F, y + 0.04F, 1.0F});
    builder.box({axle_x - 0.62F, std::min(y, 0.75F), 0.98F},
                {axle_x + 0.62F, std::min(y, 0.75F) + 0.3F, 1.01F});
  }
  builder.use(plain(Material::kTailLamp, 0.4F, 0.01F, 0.01F));
  addLamp(builder, {rear_x + 0.05F, half - 0.3F, 0.7F}, {0.03F, 0.2F, 0.06F});
  addNumberPlate(builder, {rear_x + 0.05F, 0, 0.72F}, false);
}

}  // namespace

std::shared_ptr<const Model> makeBus(RandomStream&) {
  Model model;
  model.category = "vehicle.bus.rigid";
  model.size = Eigen::Vector3d(12.0, 2.55, 3.1);
  model.rear_axle_x = static_cast<double>(kBusRearAxle);
  model.parts.push_back(fixedPart(std::make_shared<const Mesh>(busBody())));
  const WheelShape wheel{kBusWheel, 0.28F, 0.29F, 8, 0.35F};
  for (const double side : {1.0, -1.0}) {
    addWheel(model, wheel, static_cast<double>(kBusFrontAxle), side * 1.1, true);
    addWheel(model, wheel, static_cast<double>(kBusRearAxle), side * 1.1, false);
  }
  return std::make_shared<const Model>(std::move(model));
}

std::shared_ptr<const Model> makeTruck(RandomStream& random) {
  const float length = uniform(random, 7.0F, 8.2F);
  const float height = uniform(random, 3.1F, 3.5F);
  const float front_x = 0.5F * length - 0.02F;
  const float front_axle = front_x - 1.15F;
  const float rear_axle = -0.5F * length + uniform(random, 1.75F, 2.0F);
  Model model;
  model.category = "vehicle.truck";
  model.size = Eigen::Vector3f(length, kTruckWidth, height).cast<double>();
  model.rear_axle_x = static_cast<double>(rear_axle);
  MeshBuilder builder;
  addLoad(builder, front_x - kCabLength - 0.12F, -0.5F * length, height, rear_axle);
  addCab(builder, front_x, front_axle);
  model.parts.push_back(fixedPart(share(std::move(builder))));
  const WheelShape front{kTruckWheel, 0.26F, 0.28F, 8, 0.4F};
  const WheelShape rear{kTruckWheel, 0.5F, 0.27F, 8, 0.4F};
  for (const double side : {1.0, -1.0}) {
    addWheel(model, front, static_cast<double>(front_axle), side * 1.04, true);
    addWheel(model, rear, static_cast<double>(rear_axle), side * 0.93, false);
  }
  return std::make_shared<const Model>(std::move(model));
}

}  // namespace radar_dot::simulation
