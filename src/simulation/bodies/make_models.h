// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>

#include "radar_dot/common/random_stream.h"
#include "radar_dot/simulation/mesh.h"
#include "radar_dot/simulation/model.h"

namespace radar_dot::simulation {

// Road users. Palette slot 0 is the body's paint or the coat, slot 1 the trousers, slot 2 skin, slot 3
// hair, bag or a second paint. Models of a kind differ with `random`; make a handful and share them.
std::shared_ptr<const Model> makeCar(RandomStream& random);  ///< hatchback, saloon, estate or SUV
std::shared_ptr<const Model> makeVan(RandomStream& random);
std::shared_ptr<const Model> makeTruck(RandomStream& random);
std::shared_ptr<const Model> makeBus(RandomStream& random);
std::shared_ptr<const Model> makePedestrian(RandomStream& random);
std::shared_ptr<const Model> makeCyclist(RandomStream& random);
std::shared_ptr<const Model> makeParkedBicycle(RandomStream& random);

/// A plausible palette for a model of this category.
Palette randomPalette(const Model& model, RandomStream& random);

// Street furniture and plants. Origin on the ground; all static.
std::shared_ptr<const Mesh> makeTree(RandomStream& random);
std::shared_ptr<const Mesh> makeBush(RandomStream& random);
/// Arm and lamp reach `reach` m in the x direction; the lamp head hangs at (reach, 0, height).
std::shared_ptr<const Mesh> makeStreetLamp(double height, double reach);
/// Lamps face -x.
std::shared_ptr<const Mesh> makeTrafficLight();
/// Face looks to -x.
std::shared_ptr<const Mesh> makeTrafficSign(RandomStream& random);
std::shared_ptr<const Mesh> makeBollard();
std::shared_ptr<const Mesh> makeBin();
std::shared_ptr<const Mesh> makeBench();
/// Railing along x, from 0 to length.
std::shared_ptr<const Mesh> makeRailing(double length);

struct Facade {
  double width = 14.0;  ///< m, along x from 0
  double depth = 10.0;  ///< m, along y from 0 (the street front) to -depth
  int storeys = 4;
  bool shop = false;  ///< ground floor of shop windows
};
/// A house with windows set into its walls, sills, door, cornice and roof; brick, plaster or concrete.
std::shared_ptr<const Mesh> makeBuilding(const Facade& facade, RandomStream& random);

}  // namespace radar_dot::simulation
