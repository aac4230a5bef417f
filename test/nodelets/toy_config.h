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

namespace radar_dot {

enum class Mode { kSlow, kFast };
template <>
struct EnumNames<Mode> {
  static constexpr EnumName<Mode> kValues[] = {{Mode::kSlow, "slow", "it's careful"},
                                               {Mode::kFast, "fast", "a back\\slash"}};
};

struct ToyLamp {
  std::string topic;
  std::optional<double> scale;
  void describe(FieldList& fields) {
    fields.add("topic", topic, "Where it listens");
    fields.add("scale", scale, "Factor", "", {-2.0, 2.0});
  }
};

/// Every type of parameter, for tests.
struct ToyConfig {
  std::string frame = "base_link";
  std::map<std::string, ToyLamp> lamps;
  bool lit = true;
  int lanes = 2;
  std::size_t houses = 7;
  double near = 1.0, far = 50.0;
  double view = std::numeric_limits<double>::infinity();
  std::optional<double> tilt;
  Mode mode = Mode::kSlow;
  std::string label = "none";
  std::vector<int> states = {0};
  std::vector<std::string> kinds = {"car"};
  bool filter = true;

  void describe(FieldList& fields) {
    fields.group("Inputs", FieldList::kAtStart);
    fields.add("frame", frame, "Base frame");
    fields.addDictionary("lamps", lamps, "Its lamps by name");
    fields.group("");
    fields.add("lit", lit, "Lamps are on");
    fields.add("lanes", lanes, "Lanes in both directions", "", {1, 8});
    fields.add("houses", houses, "Houses on both sides");
    fields.group("Range of view");
    fields.add("near", near, "Where it begins", "m", {0.0, 1000.0});
    fields.add("far", far, "Where it ends", "m", {0.0, 1000.0});
    fields.add("view", view, "Farthest view", "m", {0.0});
    fields.add("tilt", tilt, "Angle against the vertical", "rad", {-1.0, 1.0});
    fields.group("Filter");
    fields.add("mode", mode, "How it's done");
    fields.add("label", label, "What it says; broken: cannot be applied");
    fields.add("states", states, "Accepted states", "", {0, 255});
    fields.add("kinds", kinds, "Accepted kinds");
    fields.add("filter", filter, "Also the name of a group");
  }
};

inline void validate(const ToyConfig& config) {
  const FieldList fields = fieldsOf(config);
  checkFields(fields);
  requireLess(fields, config.near, config.far);
  for (const auto& [name, lamp] : config.lamps) {
    if (lamp.topic.empty()) throw InvalidParameter({"lamps/" + name}, "lamps/" + name + " has no topic");
  }
}

}  // namespace radar_dot
