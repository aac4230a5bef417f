// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/config/sections.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "fixtures/field_values.h"

namespace radar_dot {
namespace {

template <typename Config>
std::vector<std::string> refusedNames(const Config& config) {
  try {
    validate(config);
  } catch (const InvalidParameter& error) {
    return error.names();
  }
  return {};
}

TEST(Sections, DefaultsAreValid) {
  const Configuration configuration;
  EXPECT_NO_THROW(validate(configuration));
}

TEST(Sections, NamesAreUniqueInASection) {
  Configuration configuration;
  for (const Section& section : sectionsOf(configuration)) {
    std::set<std::string> names;
    for (const Field& field : section.fields)
      EXPECT_TRUE(names.insert(field.name).second) << section.name << "/" << field.name << " stands twice";
  }
}

// What an option sets in two sections must mean the same in both.
TEST(Sections, ANameHasOneMeaning) {
  Configuration configuration;
  std::map<std::string, Field> known;
  for (const Section& section : sectionsOf(configuration)) {
    for (const Field& field : section.fields) {
      const Field& first = known.emplace(field.name, field).first->second;
      const std::string where = std::string(section.name) + "/" + field.name;
      EXPECT_STREQ(field.text, first.text) << where;
      EXPECT_STREQ(field.unit, first.unit) << where;
      EXPECT_EQ(field.valid(), first.valid()) << where;
      EXPECT_EQ(field.type, first.type) << where;
    }
  }
}

TEST(Sections, EveryFieldIsASentenceAboutSomethingNamedInSmallLetters) {
  Configuration configuration;
  for (const Section& section : sectionsOf(configuration)) {
    for (const Field& field : section.fields) {
      const std::string where = std::string(section.name) + "/" + field.name;
      EXPECT_EQ(std::string(field.name).find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_"),
                std::string::npos)
          << where;
      EXPECT_GT(std::string(field.text).size(), 8U) << where;
      EXPECT_STRNE(field.group, "") << where;
      EXPECT_NE(std::string(field.text).back(), '.') << where;
    }
  }
}

// A wrong pair of member and name would change another field, or two.
TEST(Sections, SettingAFieldChangesThatFieldAlone) {
  std::size_t count = 0;
  Configuration probe;
  const std::vector<Section> probes = sectionsOf(probe);
  for (std::size_t s = 0; s < probes.size(); ++s) {
    for (std::size_t f = 0; f < probes[s].fields.size(); ++f) {
      Configuration before, after;
      const std::vector<Section> untouched = sectionsOf(before);
      const std::vector<Section> changed = sectionsOf(after);
      const Field& field = *(changed[s].fields.begin() + static_cast<std::ptrdiff_t>(f));
      field.set(test::anotherValue(field));
      for (std::size_t t = 0; t < changed.size(); ++t) {
        for (std::size_t g = 0; g < changed[t].fields.size(); ++g) {
          const Field& now = *(changed[t].fields.begin() + static_cast<std::ptrdiff_t>(g));
          const Field& then = *(untouched[t].fields.begin() + static_cast<std::ptrdiff_t>(g));
          EXPECT_EQ(now.get() == then.get(), s != t || f != g)
              << changed[t].name << "/" << now.name << " after setting " << changed[s].name << "/"
              << field.name;
        }
      }
      ++count;
    }
  }
  EXPECT_GT(count, 190U);
}

TEST(Sections, ValuesOutOfRangeAreRefusedByName) {
  Configuration configuration;
  std::size_t count = 0;
  for (const Section& section : sectionsOf(configuration)) {
    for (const Field& field : section.fields) {
      for (const FieldValue& wrong : test::wrongValues(field)) {
        const FieldValue before = field.get();
        try {
          field.set(wrong);
          ADD_FAILURE() << section.name << "/" << field.name << " accepts " << toText(wrong);
        } catch (const InvalidParameter& error) {
          EXPECT_EQ(error.names(), std::vector<std::string>{field.name});
          EXPECT_NE(std::string(error.what()).find(field.name), std::string::npos);
        }
        EXPECT_EQ(field.get(), before) << section.name << "/" << field.name;
        ++count;
      }
    }
  }
  EXPECT_GT(count, 250U);
}

TEST(Sections, RulesBetweenFieldsNameThoseFields) {
  EgoVelocityConfig ego;
  ego.extraction.filter.min_range = 300.0;
  EXPECT_EQ(refusedNames(ego), (std::vector<std::string>{"min_range", "max_range"}));
  ego = {};
  ego.extraction.doppler_scale = 0.0;
  EXPECT_EQ(refusedNames(ego), (std::vector<std::string>{"doppler_scale"}));
  ego = {};
  ego.footprint.bottom = 2.0;
  EXPECT_EQ(refusedNames(ego), (std::vector<std::string>{"mask_bottom", "mask_top"}));
  OpticalFlowConfig flow;
  flow.pair_interval = flow.max_pair_gap;
  EXPECT_EQ(refusedNames(flow), (std::vector<std::string>{"pair_interval", "max_pair_gap"}));
  DynamicSegmentationConfig segmentation;
  segmentation.motion.noise.flow_std = segmentation.motion.noise.flow_std_relative = 0.0;
  EXPECT_EQ(refusedNames(segmentation), (std::vector<std::string>{"flow_std", "flow_std_relative"}));
  MovingObjectsConfig objects;
  objects.tracker.min_coast = 2.0;
  EXPECT_EQ(refusedNames(objects), (std::vector<std::string>{"min_coast", "max_coast"}));
  objects = {};
  objects.tracker.max_body_length = 1.0;
  EXPECT_EQ(refusedNames(objects), (std::vector<std::string>{"min_body_length", "max_body_length"}));
}

}  // namespace
}  // namespace radar_dot
