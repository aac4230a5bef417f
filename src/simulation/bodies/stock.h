// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "simulation/bodies/make_models.h"

namespace radar_dot::simulation {

/// Models made once and used over and over in a world.
struct Stock {
  using Models = std::vector<std::shared_ptr<const Model>>;
  using Meshes = std::vector<std::shared_ptr<const Mesh>>;
  struct House {
    std::shared_ptr<const Mesh> mesh;
    Facade facade;
  };

  explicit Stock(RandomStream random);

  Models cars, vans, trucks, buses, pedestrians, cyclists, bicycles;
  std::vector<House> houses;
  std::vector<House> towers;  ///< seen from far
  Meshes trees, bushes, signs;
  Meshes boundaries;  ///< 2 m of hedge, fence or wall along x from 0, closing a garden
  std::shared_ptr<const Mesh> street_lamp, traffic_light, bollard, bin, bench, railing;

  static constexpr double kBoundaryLength = 2.0;  ///< m
  static constexpr double kRailingLength = 3.0;   ///< m
  static constexpr double kLampHeight = 7.5;      ///< m
  static constexpr double kLampReach = 1.8;       ///< m
};

template <typename T>
const T& pick(const std::vector<T>& choices, RandomStream& random) {
  return choices[static_cast<std::size_t>(random.index(static_cast<int>(choices.size())))];
}

}  // namespace radar_dot::simulation
