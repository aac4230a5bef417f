// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "simulation/street/street_builder.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector2d;

constexpr double kLineWidth = 0.12;  // m

void layCrossSection(GroundBatch& ground, const Street& street, const Street::Gap& stretch) {
  const double half = street.profile.halfRoad();
  const double low = stretch.low, high = stretch.high;
  ground.use(kAsphaltSurface);
  ground.strip(low, high, kGutterWidth - half, half - kGutterWidth, 0.0);
  for (const double side : {-1.0, 1.0}) {
    const auto strip = [&](const Surface& surface, double inner, double outer, double z) {
      ground.use(surface);
      ground.strip(low, high, std::min(side * inner, side * outer), std::max(side * inner, side * outer), z);
    };
    strip(kGutterSurface, half - kGutterWidth, half, 0.0);
    strip(kKerbSurface, half, half + kKerbWidth, kKerbHeight);
    strip(kPavementSurface, half + kKerbWidth, half + kPavementWidth, kKerbHeight);
    ground.use(kKerbSurface);
    const int stones = std::max(1, static_cast<int>((high - low) / 10.0));
    for (int i = 0; i < stones; ++i)
      ground.wall({low + (high - low) * i / stones, side * half},
                  {low + (high - low) * (i + 1) / stones, side * half}, -0.05, kKerbHeight);
  }
}

void layPlots(GroundBatch& ground, const Street& street) {
  std::vector<Street::Gap> gaps = street.junctions;
  if (!street.priority) {  // begins behind the plots of the street that it crosses
    for (Street::Gap& gap : gaps) {
      gap.low -= kPlotDepth;
      gap.high += kPlotDepth;
    }
  }
  const double inner = street.profile.halfRoad() + kPavementWidth;
  ground.use(kGrassSurface);
  for (const auto& [low, high] : Street::free(-30.0, street.length + 30.0, gaps)) {
    ground.strip(low, high, inner, inner + kPlotDepth, kPlotHeight);
    ground.strip(low, high, -inner - kPlotDepth, -inner, kPlotHeight);
  }
}

/// The street meets a pavement across its end.
void closeEnd(GroundBatch& ground, const Street& street, double x, double outward) {
  const double half = street.profile.halfRoad();
  const double outer = half + kPavementWidth;
  const auto across = [&](const Surface& surface, double from, double to) {
    ground.use(surface);
    const double low = x + outward * from;
    const double high = x + outward * to;
    ground.rectangle(std::min(low, high), std::max(low, high), -outer, outer, kKerbHeight);
  };
  across(kKerbSurface, 0.0, kKerbWidth);
  across(kPavementSurface, kKerbWidth, 7.5);
  ground.use(kGrassSurface);
  ground.rectangle(std::min(x + 7.5 * outward, x + 30.0 * outward),
                   std::max(x + 7.5 * outward, x + 30.0 * outward), -outer, outer, kPlotHeight);
  ground.use(kKerbSurface);
  ground.wall({x, -half}, {x, half}, -0.05, kKerbHeight);
}

void dash(GroundBatch& ground, const Street::Gap& stretch, double y, double width, double mark, double gap) {
  for (double x = stretch.low + 0.5 * gap; x + mark < stretch.high; x += mark + gap)
    ground.rectangle(x, x + mark, y - 0.5 * width, y + 0.5 * width, kPaintHeight);
}

void line(GroundBatch& ground, const Street::Gap& stretch, double y, double width) {
  ground.strip(stretch.low, stretch.high, y - 0.5 * width, y + 0.5 * width, kPaintHeight);
}

}  // namespace

void buildRoad(const Street& street, World& world) {
  GroundBatch ground(street.T_map_from_street);
  for (const Street::Gap& stretch : Street::free(0.0, street.length, street.junctions))
    layCrossSection(ground, street, stretch);
  layPlots(ground, street);
  if (street.closed_start) closeEnd(ground, street, 0.0, -1.0);
  if (street.closed_end) closeEnd(ground, street, street.length, 1.0);
  ground.moveTo(world);
}

void paintZebra(GroundBatch& ground, double x, double y0, double y1) {
  constexpr double kBar = 0.5;  // m, and as much between
  ground.use(kPaintSurface);
  const int bars = static_cast<int>((y1 - y0 + kBar) / (2.0 * kBar));
  const double first = 0.5 * (y0 + y1) - kBar * (bars - 0.5);
  for (int i = 0; i < bars; ++i) {
    const double y = first + 2.0 * kBar * i;
    ground.rectangle(x - 0.5 * kZebraWidth, x + 0.5 * kZebraWidth, y, y + kBar, kPaintHeight);
  }
}

void paintArrow(GroundBatch& ground, double x, double y, double direction) {
  constexpr double kShaft = 1.6, kHead = 1.1;  // m
  const double neck = x + kShaft * direction;
  ground.rectangle(std::min(x, neck), std::max(x, neck), y - 0.08, y + 0.08, kPaintHeight);
  ground.quad({Vector2d(neck, y - 0.32), {neck + kHead * direction, y}, {neck, y + 0.32}, {neck, y}},
              kPaintHeight);
}

void buildMarkings(const Street& street, World& world) {
  GroundBatch ground(street.T_map_from_street);
  const StreetProfile& profile = street.profile;
  const double edge = profile.lanes * profile.lane_width;
  const double reach = profile.halfRoad() - kGutterWidth - 0.1;
  std::vector<Street::Gap> gaps = street.junctions;
  for (const double x : street.zebras) {
    paintZebra(ground, x, -reach, reach);
    gaps.push_back({x - 0.5 * kZebraWidth - 1.5, x + 0.5 * kZebraWidth + 1.5});
  }
  ground.use(kPaintSurface);
  for (const Street::Gap& stretch : Street::free(0.0, street.length, gaps)) {
    if (profile.lanes > 1)
      line(ground, stretch, 0.0, 1.3 * kLineWidth);
    else
      dash(ground, stretch, 0.0, kLineWidth, 3.0, 4.5);
    for (const double side : {-1.0, 1.0}) {
      for (int lane = 1; lane < profile.lanes; ++lane)
        dash(ground, stretch, side * lane * profile.lane_width, kLineWidth, 3.0, 6.0);
      if (profile.cycle_lane > 0.0) dash(ground, stretch, side * edge, 0.2, 1.0, 1.0);
      if (profile.parking > 0.0)
        dash(ground, stretch, side * (edge + profile.cycle_lane), 0.1, 1.2, 1.2);
      else if (profile.cycle_lane == 0.0)
        line(ground, stretch, side * (edge - 0.5 * kLineWidth), kLineWidth);
    }
  }
  ground.moveTo(world);
}

}  // namespace radar_dot::simulation
