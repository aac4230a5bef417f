// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/bodies/car_body.h"
#include "simulation/bodies/make_models.h"
#include "simulation/bodies/shapes.h"
#include "simulation/bodies/vehicle_parts.h"

namespace radar_dot::simulation {
namespace {

/// Axles, and where the cabin begins, for a body whose length, width and height are known.
void placeAxles(CarShape& shape, float front_overhang, float wheelbase) {
  shape.front_axle_x = 0.5F * shape.length - front_overhang;
  shape.rear_axle_x = shape.front_axle_x - wheelbase;
}

CarShape hatchback(RandomStream& random) {
  CarShape shape;
  shape.length = uniform(random, 3.9F, 4.35F);
  shape.width = uniform(random, 1.72F, 1.82F);
  shape.height = uniform(random, 1.44F, 1.53F);
  placeAxles(shape, 0.84F, 0.61F * shape.length);
  shape.cowl_x = 0.5F * shape.length - uniform(random, 0.98F, 1.1F);
  shape.roof_front_x = shape.cowl_x - uniform(random, 0.66F, 0.8F);
  shape.rear_base_x = -0.5F * shape.length + 0.15F;
  shape.roof_rear_x = -0.5F * shape.length + uniform(random, 0.42F, 0.62F);
  shape.cowl_z = uniform(random, 0.95F, 1.0F);
  shape.tail_z = shape.cowl_z + 0.03F;
  shape.quarter_windows = random.chance(0.4);
  return shape;
}

CarShape saloon(RandomStream& random) {
  CarShape shape;
  shape.length = uniform(random, 4.5F, 4.9F);
  shape.width = uniform(random, 1.8F, 1.88F);
  shape.height = uniform(random, 1.42F, 1.48F);
  placeAxles(shape, 0.87F, 0.595F * shape.length);
  shape.cowl_x = 0.5F * shape.length - uniform(random, 1.2F, 1.35F);
  shape.roof_front_x = shape.cowl_x - uniform(random, 0.72F, 0.85F);
  shape.rear_base_x = -0.5F * shape.length + uniform(random, 0.55F, 0.68F);
  shape.roof_rear_x = shape.rear_base_x + uniform(random, 0.6F, 0.75F);
  shape.cowl_z = uniform(random, 0.94F, 0.97F);
  shape.tail_z = shape.cowl_z + 0.05F;
  shape.roof_drop = 0.08F;
  return shape;
}

CarShape estate(RandomStream& random) {
  CarShape shape = saloon(random);
  shape.height += 0.04F;
  shape.rear_base_x = -0.5F * shape.length + 0.16F;
  shape.roof_rear_x = -0.5F * shape.length + uniform(random, 0.4F, 0.5F);
  shape.roof_drop = 0.05F;
  shape.quarter_windows = true;
  shape.upright_tail_lamps = true;
  return shape;
}

CarShape sportUtility(RandomStream& random) {
  CarShape shape;
  shape.length = uniform(random, 4.3F, 4.75F);
  shape.width = uniform(random, 1.82F, 1.9F);
  shape.height = uniform(random, 1.62F, 1.75F);
  shape.clearance = 0.23F;
  shape.wheel_radius = 0.355F;
  placeAxles(shape, 0.9F, 0.6F * shape.length);
  shape.nose_z = uniform(random, 0.92F, 0.98F);
  shape.cowl_z = uniform(random, 1.1F, 1.16F);
  shape.tail_z = shape.cowl_z + 0.04F;
  shape.cowl_x = 0.5F * shape.length - uniform(random, 1.15F, 1.25F);
  shape.roof_front_x = shape.cowl_x - uniform(random, 0.6F, 0.7F);
  shape.rear_base_x = -0.5F * shape.length + 0.16F;
  shape.roof_rear_x = -0.5F * shape.length + uniform(random, 0.38F, 0.5F);
  shape.quarter_windows = true;
  shape.upright_tail_lamps = random.chance(0.5);
  shape.dark_trim = true;
  return shape;
}

std::shared_ptr<const Model> makeModel(const CarShape& shape, WheelShape wheel) {
  Model model;
  model.category = "vehicle.car";
  model.size = Eigen::Vector3f(shape.length, shape.width, shape.height).cast<double>();
  model.rear_axle_x = static_cast<double>(shape.rear_axle_x);
  model.parts.push_back(fixedPart(std::make_shared<const Mesh>(buildCarBody(shape))));
  wheel.radius = shape.wheel_radius;
  wheel.rim_radius = 0.68F * shape.wheel_radius;
  const double track = 0.5 * static_cast<double>(shape.width - wheel.width) - 0.02;
  for (const double side : {1.0, -1.0}) {
    addWheel(model, wheel, static_cast<double>(shape.front_axle_x), side * track, true);
    addWheel(model, wheel, static_cast<double>(shape.rear_axle_x), side * track, false);
  }
  return std::make_shared<const Model>(std::move(model));
}

}  // namespace

std::shared_ptr<const Model> makeCar(RandomStream& random) {
  const double kind = random.uniform();
  const CarShape shape = kind < 0.35   ? hatchback(random)
                         : kind < 0.58 ? saloon(random)
                         : kind < 0.75 ? estate(random)
                                       : sportUtility(random);
  WheelShape wheel;
  wheel.width = uniform(random, 0.195F, 0.225F);
  wheel.spokes = 5 + random.index(4);
  wheel.rim_grey = random.chance(0.2) ? 0.06F : uniform(random, 0.28F, 0.42F);
  return makeModel(shape, wheel);
}

std::shared_ptr<const Model> makeVan(RandomStream& random) {
  CarShape shape;
  shape.length = uniform(random, 5.2F, 5.95F);
  shape.width = uniform(random, 1.95F, 2.05F);
  shape.height = uniform(random, 2.3F, 2.6F);
  shape.clearance = 0.24F;
  shape.wheel_radius = 0.35F;
  placeAxles(shape, 0.95F, 0.6F * shape.length);
  shape.nose_z = 1.04F;
  shape.cowl_z = 1.32F;
  shape.tail_z = 1.3F;
  shape.glass_top = 0.72F;
  shape.cowl_x = 0.5F * shape.length - uniform(random, 0.75F, 0.95F);
  shape.roof_front_x = shape.cowl_x - uniform(random, 0.8F, 0.95F);
  shape.rear_base_x = -0.5F * shape.length + 0.1F;
  shape.roof_rear_x = -0.5F * shape.length + 0.18F;
  shape.roof_drop = 0.02F;
  shape.tumblehome = 0.11F;
  shape.rear_doors = false;
  shape.rear_side_windows = random.chance(0.25);
  shape.upright_tail_lamps = true;
  shape.dark_trim = random.chance(0.5);
  WheelShape wheel;
  wheel.width = 0.225F;
  wheel.spokes = 8;
  wheel.rim_grey = 0.25F;
  return makeModel(shape, wheel);
}

}  // namespace radar_dot::simulation
