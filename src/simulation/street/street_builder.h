// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "radar_dot/simulation/world.h"
#include "simulation/bodies/stock.h"
#include "simulation/street/ground_batch.h"
#include "simulation/street/street_plan.h"

namespace radar_dot::simulation {

// Colours that several kinds of ground share.
inline const Surface kAsphaltSurface = {Material::kAsphalt, Color(0.115F, 0.115F, 0.12F)};
inline const Surface kPaintSurface = {Material::kLanePaint, Color(0.72F, 0.72F, 0.70F)};
inline const Surface kPavementSurface = {Material::kPavement, Color(0.40F, 0.38F, 0.36F)};
inline const Surface kKerbSurface = {Material::kKerb, Color(0.47F, 0.46F, 0.44F)};
inline const Surface kGutterSurface = {Material::kConcrete, Color(0.31F, 0.30F, 0.29F)};
inline const Surface kGrassSurface = {Material::kGrass, Color(0.12F, 0.19F, 0.06F)};

inline constexpr double kPaintHeight = 0.004;  ///< m
inline constexpr double kPatchHeight = 0.002;  ///< m
inline constexpr double kPlotHeight = 0.10;    ///< m

// The parts of a world of streets, each added to `world`.
void buildRoad(const Street& street, World& world);  ///< road, kerbs, pavements, plots
/// Repairs, trenches, sealed cracks and covers of a road along x between y = -reach and reach.
void layWear(GroundBatch& ground, const Street::Gap& stretch, double reach, RandomStream& random);
/// Repairs, trenches, sealed cracks, covers and drains of the road, and patches of the pavements.
void buildWear(const Street& street, RandomStream random, World& world);
void buildMarkings(const Street& street, World& world);  ///< lane paint
void buildJunction(const StreetPlan& plan, const Junction& junction, const Stock& stock, RandomStream random,
                   World& world);
void buildHouses(const Street& street, const Stock& stock, RandomStream random, World& world);
void buildFurniture(const Street& street, const Stock& stock, RandomStream random, World& world);
void parkCars(const Street& street, const Stock& stock, RandomStream random, World& world);
/// Grass far around, towers and trees that close the horizon around a rectangle with its middle in the
/// origin of the area's frame and these half sides (m).
void buildSurroundings(const Eigen::Isometry3d& T_map_from_area, const Eigen::Vector2d& half,
                       const Stock& stock, RandomStream random, World& world);
/// Everything above.
void buildStreets(const StreetPlan& plan, const Stock& stock, std::uint64_t seed, World& world);

/// A row of houses and gardens. Frame of the row: x along it, the fronts look to +y, z = 0 on the ground.
/// @param garden m between the row and the pavement.
void buildHouseRow(const Eigen::Isometry3d& T_map_from_row, double length, double garden, const Stock& stock,
                   RandomStream& random, World& world);

/// Bars of a pedestrian crossing over a road from y0 to y1, middle at x.
void paintZebra(GroundBatch& ground, double x, double y0, double y1);

/// Arrow on the road from x on, along +x or -x.
void paintArrow(GroundBatch& ground, double x, double y, double direction);

/// Pose with a yaw angle (rad).
Eigen::Isometry3d poseAt(double x, double y, double z, double yaw);

}  // namespace radar_dot::simulation
