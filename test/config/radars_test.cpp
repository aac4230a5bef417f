// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// What holds for one radar alone, and the presets.
#include <gtest/gtest.h>

#include <filesystem>

#include "fixtures/files.h"
#include "fixtures/refusal.h"
#include "radar_dot/config/sections.h"

namespace radar_dot {
namespace {

class Radars : public testing::Test {
 protected:
  Radars() { front().topic = "points"; }
  RadarEntry& front() { return config_.radars["front"]; }
  void set(const char* name, const std::string& text) { fieldsOf(front()).find(name)->setFromText(text); }
  std::string refusal() {
    return test::refusalOf<InvalidParameter>([this] { validate(config_); });
  }
  std::string file(const std::string& yaml) {
    const std::string path = (folder_.path() / "mine.yaml").string();
    test::writeFile(path, yaml);
    return path;
  }

  EgoVelocityConfig config_;
  test::TemporaryFolder folder_;
};

TEST_F(Radars, AnEntryOverridesTheCommonParameters) {
  config_.extraction.doppler_scale = 2.0;
  config_.extraction.filter.max_range = 90.0;
  set("doppler_scale", "-1");
  set("doppler_field", "v");
  set("invalid_states", "[]");
  set("expected_rate", "20");
  const ExtractionParams params = extractionOf(config_, front());
  EXPECT_EQ(params.doppler_scale, -1.0);
  EXPECT_EQ(params.doppler_field, "v");
  EXPECT_TRUE(params.filter.invalid_states.empty());
  EXPECT_EQ(params.filter.max_range, 90.0);
  EXPECT_EQ(rateOf(config_, front()).expected_rate, 20.0);
  EXPECT_EQ(rateOf(config_, front()).max_age, config_.rate.max_age);
  EXPECT_TRUE(sameFields(extractionOf(config_, RadarEntry()), config_.extraction));
}

TEST_F(Radars, APresetHoldsWhereTheEntryAndBeforeTheSectionSay) {
  config_.extraction.doppler_field = "w";
  config_.extraction.filter.min_range = 3.0;
  front().preset =
      file("doppler_field: v   # of the driver\nmax_range: 300\nstamp: arrival\ntime_offset: -0.07\n");
  set("max_range", "50");
  const ExtractionParams params = extractionOf(config_, front());
  EXPECT_EQ(params.doppler_field, "v");
  EXPECT_EQ(params.filter.max_range, 50.0);
  EXPECT_EQ(params.filter.min_range, 3.0);
  RadarEntry whole = withPreset(front());
  EXPECT_EQ(whole.topic, "points");
  EXPECT_EQ(whole.preset, "") << "it is done";
  EXPECT_EQ(whole.stamp, StampSource::kArrival);
  EXPECT_EQ(whole.time_offset, -0.07);
  set("stamp", "header");
  EXPECT_EQ(withPreset(front()).stamp, StampSource::kHeader) << "as the default, but said";
  EXPECT_EQ(refusal(), "accepted");
}

TEST_F(Radars, RefusalsNameRadarAndParameter) {
  const auto expect = [this](const std::vector<std::string>& parts) {
    test::expectRefusal<InvalidParameter>([this] { validate(config_); }, parts);
  };
  front().preset = "ars584";
  expect({"radars/front/preset is 'ars584', must be one of ", "ars548, ", "did you mean ars548?"});
  front().preset = file("doppler_fild: v\n");
  expect({"radars/front/preset is '" + front().preset + "': " + front().preset,
          ":1: unknown parameter doppler_fild; did you mean doppler_field?"});
  front().preset = file("doppler_field: v\nmax_range: far\n");
  expect({":2: max_range is 'far', must be a number"});
  front().preset = file("preset: ars548\n");
  expect({"radars/front/preset is ", "which names another one"});
  front().preset = "/nowhere.yaml";
  expect({"radars/front/preset is '/nowhere.yaml': cannot read /nowhere.yaml"});
  front().preset = "";
  set("mount_xyz", "3.5, 0, 0.5");
  expect({"radars/front/mount_rpy is not set; a mount needs mount_xyz and mount_rpy"});
  set("mount_xyz", "");
  set("max_range", "0.1");
  expect({"radars/front/min_range (0.5 m) must be smaller than max_range (0.1 m)"});
}

TEST_F(Radars, ATopicIsSharedByRadarsOfDifferentFrames) {
  config_.radars["rear"].topic = "/points";
  const std::string shared =
      "radars/rear has the topic of radars/front: its returns would count twice; "
      "radars that share a topic need different only_frame";
  EXPECT_EQ(refusal(), shared);
  config_.radars["rear"].only_frame = "radar_rear";
  EXPECT_EQ(refusal(), shared);
  front().only_frame = "radar_rear";
  EXPECT_EQ(refusal(), shared);
  front().only_frame = "/radar_rear";
  EXPECT_EQ(refusal(), shared) << "a frame has no slash";
  front().only_frame = "radar_front";
  EXPECT_EQ(refusal(), "accepted");
}

TEST_F(Radars, AFrameHasOneMount) {
  front().frame_id = "radar";
  set("mount_xyz", "[3.5, 0, 0.5]");
  set("mount_rpy", "[0, 0, 0]");
  config_.radars["rear"] = front();
  config_.radars["rear"].topic = "others";
  config_.radars["rear"].frame_id = "/radar";
  EXPECT_EQ(refusal(), "accepted") << "two topics of one radar, as for near and far";
  config_.radars["rear"].mount_xyz = std::array<double, 3>{-1.0, 0.0, 0.5};
  EXPECT_EQ(refusal(), "radars/rear has the frame_id of radars/front, and another mount: a frame has one");
}

// The matrix that static_transform_publisher makes of x y z yaw pitch roll = 1 2 3 90 0 90 degrees.
TEST_F(Radars, TheMountIsThatOfAStaticTransformPublisher) {
  EXPECT_FALSE(mountOf(front()));
  set("mount_xyz", "[1, 2, 3]");
  set("mount_rpy", "[1.5707963267948966, 0, 1.5707963267948966]");
  Eigen::Matrix4d expected;
  expected << 0, 0, 1, 1, 1, 0, 0, 2, 0, 1, 0, 3, 0, 0, 0, 1;
  const std::optional<Eigen::Isometry3d> mount = mountOf(front());
  ASSERT_TRUE(mount);
  EXPECT_TRUE(mount->matrix().isApprox(expected, 1e-12)) << mount->matrix();
  set("mount_rpy", "[0, 0.1, 0]");
  EXPECT_LT((*mountOf(front()) * Eigen::Vector3d::UnitX()).z(), 3.0) << "pitched down";
  set("mount_yaw_correction", "1.5707963267948966");
  set("mount_rpy", "[0, 0, 0]");
  const Eigen::Vector3d seen = corrected(*mountOf(front()), front()) * Eigen::Vector3d::UnitX();
  EXPECT_TRUE(seen.isApprox(Eigen::Vector3d(1, 3, 3), 1e-12)) << seen;
}

TEST_F(Radars, ThePresetsAreValid) {
  std::size_t count = 0;
  for (const auto& preset : std::filesystem::directory_iterator(PRESETS)) {
    front() = {};
    front().topic = "points";
    front().preset = preset.path().stem().string();
    EXPECT_EQ(refusal(), "accepted") << preset.path();
    ++count;
  }
  EXPECT_GT(count, 10U);
}

}  // namespace
}  // namespace radar_dot
