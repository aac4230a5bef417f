// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/config/sections.h"

#include <gtest/gtest.h>
#include <yaml-cpp/yaml.h>

#include <map>
#include <set>

#include "fixtures/field_values.h"
#include "radar/synthetic_sweep.h"
#include "radar_dot/common/stamped_twist.h"

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

/// All fields, as section/name.
std::vector<std::pair<std::string, Field>> allFields(Configuration& configuration) {
  std::vector<std::pair<std::string, Field>> all;
  for (const Section& section : sectionsOf(configuration))
    for (const Field& field : section.fields)
      all.emplace_back(std::string(section.name) + "/" + field.name, field);
  return all;
}

TEST(Sections, DefaultsAreValid) { EXPECT_NO_THROW(validate(Configuration())); }

// What an option sets in two sections must mean the same in both.
TEST(Sections, ANameIsThereOnceInASectionAndHasOneMeaningInAll) {
  Configuration configuration;
  std::set<std::string> names;
  std::map<std::string, Field> known;
  for (const auto& [where, field] : allFields(configuration)) {
    EXPECT_TRUE(names.insert(where).second) << where << " stands twice";
    const Field& first = known.emplace(field.name, field).first->second;
    EXPECT_STREQ(field.text, first.text) << where;
    EXPECT_STREQ(field.unit, first.unit) << where;
    EXPECT_EQ(field.valid(), first.valid()) << where;
    EXPECT_EQ(field.type, first.type) << where;
  }
}

TEST(Sections, EveryFieldIsASentenceAboutSomethingNamedInSmallLetters) {
  Configuration configuration;
  for (const auto& [where, field] : allFields(configuration)) {
    const std::string name = field.name, text = field.text;
    EXPECT_EQ(name.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_"), std::string::npos) << where;
    EXPECT_GT(text.size(), 8U) << where;
    EXPECT_STRNE(field.group, "") << where;
    EXPECT_NE(text.back(), '.') << where;
  }
}

// A wrong pair of member and name would change another field, or two.
TEST(Sections, SettingAFieldChangesThatFieldAlone) {
  Configuration before;
  const auto untouched = allFields(before);
  for (std::size_t i = 0; i < untouched.size(); ++i) {
    Configuration after;
    const auto changed = allFields(after);
    changed[i].second.set(test::anotherValue(changed[i].second));
    for (std::size_t j = 0; j < changed.size(); ++j)
      EXPECT_EQ(changed[j].second.get() == untouched[j].second.get(), i != j)
          << changed[j].first << " after setting " << changed[i].first;
  }
  EXPECT_GT(untouched.size(), 190U);
}

TEST(Sections, ValuesOutOfRangeAreRefusedByName) {
  Configuration configuration;
  std::size_t count = 0;
  for (const auto& [where, field] : allFields(configuration)) {
    for (const FieldValue& wrong : test::wrongValues(field)) {
      const FieldValue before = field.get();
      try {
        field.set(wrong);
        ADD_FAILURE() << where << " accepts " << toText(wrong);
      } catch (const InvalidParameter& error) {
        EXPECT_EQ(error.names(), std::vector<std::string>{field.name});
        EXPECT_NE(std::string(error.what()).find(field.name), std::string::npos);
      }
      EXPECT_EQ(field.get(), before) << where;
      ++count;
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
  ego = {};
  ego.radars["front"].topic = "radar_front";
  ego.radars["front_again"].topic = "/radar_front";
  EXPECT_EQ(refusedNames(ego), (std::vector<std::string>{"radars/front_again"}));
  OpticalFlowConfig flow;
  flow.pair_interval = flow.max_pair_gap;
  EXPECT_EQ(refusedNames(flow), (std::vector<std::string>{"pair_interval", "max_pair_gap"}));
  DynamicSegmentationConfig segmentation;
  segmentation.motion.uncertainty.noise.flow_std = segmentation.motion.uncertainty.noise.flow_std_relative =
      0.0;
  EXPECT_EQ(refusedNames(segmentation), (std::vector<std::string>{"flow_std", "flow_std_relative"}));
  MovingObjectsConfig objects;
  objects.tracker.min_coast = 2.0;
  EXPECT_EQ(refusedNames(objects), (std::vector<std::string>{"min_coast", "max_coast"}));
  objects = {};
  objects.tracker.max_body_length = 1.0;
  EXPECT_EQ(refusedNames(objects), (std::vector<std::string>{"min_body_length", "max_body_length"}));
}

// The frames by default, and of the twist what each model tells: vx, vy and the yaw rate, and nothing of the
// rest.
TEST(RobotLocalization, FusesWhatIsPublished) {
  const YAML::Node ekf = YAML::LoadFile(ROBOT_LOCALIZATION);
  const Configuration defaults;
  EXPECT_EQ(ekf["base_link_frame"].as<std::string>(), defaults.ego_velocity.base_frame);
  EXPECT_EQ(ekf["odom_frame"].as<std::string>(), defaults.odometry.rotation.odom_frame);
  EXPECT_EQ(ekf["world_frame"].as<std::string>(), ekf["odom_frame"].as<std::string>());
  EXPECT_TRUE(ekf["publish_tf"].as<bool>());

  constexpr std::size_t kStates = 15, kVelocity = 6;
  const auto twist = ekf["twist0_config"].as<std::vector<bool>>();
  const auto imu = ekf["imu0_config"].as<std::vector<bool>>();
  ASSERT_EQ(twist.size(), kStates);
  ASSERT_EQ(imu.size(), kStates);
  const auto sweep = test::makeSweep(test::carMounts(), {8.0, 0.1, 0.0}, {0.0, 0.0, 0.2});
  for (const MotionModel model : {MotionModel::kPlanarYaw, MotionModel::kAckermann}) {
    EgoVelocityParams params;
    params.model = model;
    const EgoVelocityResult result = EgoVelocityEstimator(params).estimate(sweep.scans(), 0.0);
    ASSERT_TRUE(result.valid()) << result.reason;
    const StampedTwist published{0.0, result.linear, result.angular, result.covariance};
    for (std::size_t i = 0; i < kStates; ++i) {
      const bool is_velocity = i >= kVelocity && i < kVelocity + 6;
      const bool told = is_velocity && published.observes(static_cast<Eigen::Index>(i - kVelocity));
      EXPECT_EQ(twist[i], told) << toString(model) << ", state " << i;
      EXPECT_EQ(imu[i], i == kVelocity + 5) << "state " << i;
    }
  }
}

}  // namespace
}  // namespace radar_dot
