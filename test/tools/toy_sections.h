// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "radar_dot/common/fields.h"
#include "radar_dot/config/section.h"

namespace radar_dot {

enum class Solver { kLeastSquares, kRansac };
template <>
struct EnumNames<Solver> {
  static constexpr const char* kWhat = "solver";
  static constexpr EnumName<Solver> kValues[] = {
      {Solver::kLeastSquares, "least_squares", "All returns, as they are"},
      {Solver::kRansac, "ransac", "Consensus of most"}};
};

enum class Side { kLeft, kRight };
template <>
struct EnumNames<Side> {
  static constexpr const char* kWhat = "side";
  static constexpr EnumName<Side> kValues[] = {{Side::kLeft, "left"}, {Side::kRight, "right"}};
};

namespace test {

struct ToyRadar {
  std::string topic = "radar";
  std::optional<double> doppler_scale;
  void describe(FieldList& fields) {
    fields.add("topic", topic, "Topic of its clouds");
    fields.add("doppler_scale", doppler_scale, "Factor of this radar", "", {-10.0, 10.0});
  }
};

struct ToyVelocity {
  double threshold = 0.5, azimuth_std = 0.01, farthest = std::numeric_limits<double>::infinity();
  std::optional<double> min_azimuth;
  int iterations = 200;
  std::size_t memory = 5;
  bool neighbourhood = true, refine = false;
  Solver solver = Solver::kRansac;
  Side side = Side::kLeft;
  std::vector<int> states = {0, 4};
  std::vector<std::string> channels;
  std::string frame = "base_link";
  double expected_rate = 13.0;
  std::map<std::string, ToyRadar> radars;

  void describe(FieldList& fields) {
    fields.group("Estimate");
    fields.add("threshold", threshold, "Residual of a return that moves", "m/s", {0.001, 100.0});
    fields.add("azimuth_std", azimuth_std, "1 sigma of a bearing", "rad", {0.0, 1.0});
    fields.add("iterations", iterations, "Hypotheses", "", {1, 1000000});
    fields.add("solver", solver, "How the velocity is found");
    fields.add("neighbourhood", neighbourhood, "Let neighbours decide where a return alone does not");
    fields.add("refine", refine, "Refine it");
    fields.group("Returns", FieldList::kAtStart);
    fields.add("farthest", farthest, "Farther returns are left out", "m", {0.0});
    fields.add("min_azimuth", min_azimuth, "Begin of the field of view", "rad", {-3.2, 3.2});
    fields.add("memory", memory, "Scans that are kept");
    fields.add("side", side, "Side of the road");
    fields.add("states", states, "Valid states", "", {0, 255});
    fields.add("channels", channels, "Radars; empty: all");
    fields.add("frame", frame, "Frame of the result");
    fields.group("Diagnostics", FieldList::kLiveOnly);
    fields.add("expected_rate", expected_rate, "Rate of the clouds", "Hz", {0.1, 1000.0});
    fields.addDictionary("radars", radars, "Radars by name");
  }
};

struct ToyDepth {
  double azimuth_std = 0.02, max_depth = 120.0;
  void describe(FieldList& fields) {
    fields.add("azimuth_std", azimuth_std, "1 sigma of a bearing", "rad", {0.0, 1.0});
    fields.add("max_depth", max_depth, "Farther is unknown", "m", {1.0, 10000.0});
  }
};

struct ToyInput {
  std::string dataroot;
  std::vector<std::string> scenes;
  bool all = false;
  void describe(FieldList& fields) {
    fields.add("dataroot", dataroot, "Folder of the data set");
    fields.add("scenes", scenes, "Scenes by name; empty: all of them");
    fields.add("all", all, "All scenes");
  }
};

struct ToyOutput {
  std::string json;
  void describe(FieldList& fields) { fields.add("json", json, "File for the report"); }
};

struct ToyConfiguration {
  ToyVelocity velocity;
  ToyDepth depth;
  std::vector<Section> sections() {
    return {{"ego_velocity", "radar_dot/EgoVelocity", fieldsOf(velocity)}, {"depth", "", fieldsOf(depth)}};
  }
};

}  // namespace test
}  // namespace radar_dot
