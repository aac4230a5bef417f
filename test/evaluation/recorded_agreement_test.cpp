// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// RadarAgreement on recorded scans, with the faults made by the parameters that would correct them.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "config/config_file.h"
#include "evaluation/sweep_velocities.h"
#include "fixtures/nuscenes_fixture.h"
#include "radar_dot/radar/radar_agreement.h"
#include "radar_dot/radar/range_rate_watch.h"

namespace radar_dot::evaluation {
namespace {

using test::NuscenesFixture;
using Verdict = RadarAgreement::Verdict;

constexpr double kDegree = 0.017453292519943295;

struct Accused {
  std::set<std::string> channels;             ///< that are not good at some time
  RadarAgreement::Figures latest;             ///< of the last of them
  std::map<std::string, double> corrections;  ///< rad, at the end
};

Accused accuse(const dataset::Tables& tables, dataset::Index index, const EgoVelocityConfig& config) {
  const RadarScene scene = loadRadarScene(tables, index, {}, config);
  std::vector<RadarAgreement::Radar> radars;
  for (const LoadedRadar& radar : scene.radars) radars.push_back({radar.channel});
  SweepEstimator estimator(config);
  RadarAgreement agreement(radars);
  Accused accused;
  for (SceneSweep& sweep : assembleSweeps(scene, config.sweep)) {
    agreement.add(sweep.time, sweep.scans, estimator.estimate(sweep.scans, sweep.time).single,
                  estimator.params());
    for (std::size_t i = 0; i < radars.size(); ++i) {
      accused.corrections[radars[i].name] = agreement.figures(i).yaw_correction;
      if (agreement.figures(i).verdict == Verdict::kGood) continue;
      accused.channels.insert(radars[i].name);
      accused.latest = agreement.figures(i);
    }
    EXPECT_EQ(agreement.warning(), "");
  }
  return accused;
}

EgoVelocityConfig withFault(EgoVelocityConfig config, double yaw, double doppler_scale) {
  RadarEntry& entry = config.radars["spoilt"];
  entry.topic = "radar_front_left";
  entry.mount_yaw_correction = yaw;
  entry.overrides["doppler_scale"] = doppler_scale;
  return config;
}

TEST(RecordedAgreement, NamesTheRadarWithinTenSecondsOfDriving) {
  test::FixtureOptions options;
  options.samples_per_scene = 20;  // 9.5 s
  options.scan.doppler_noise = 0.1;
  options.can_bus = options.instance_masks = false;
  const NuscenesFixture fixture(options);
  const dataset::Tables tables = dataset::Tables::load(fixture.dataroot());
  for (const char* name : {NuscenesFixture::kStraightScene, NuscenesFixture::kTurningScene}) {
    const dataset::Index scene = tables.findScene(name);
    EXPECT_EQ(accuse(tables, scene, {}).channels, std::set<std::string>()) << name;

    const Accused turned = accuse(tables, scene, withFault({}, 3.0 * kDegree, 1.0));
    EXPECT_EQ(turned.channels, std::set<std::string>({"RADAR_FRONT_LEFT"})) << name;
    EXPECT_EQ(turned.latest.verdict, Verdict::kTurned) << name;
    EXPECT_NEAR(turned.latest.yaw_correction, -3.0 * kDegree, 0.6 * kDegree) << name;

    const Accused reversed = accuse(tables, scene, withFault({}, 0.0, -1.0));
    EXPECT_EQ(reversed.channels, std::set<std::string>({"RADAR_FRONT_LEFT"})) << name;
    EXPECT_EQ(reversed.latest.verdict, Verdict::kReversed) << name;
  }
}

// The front radar of the car of three of the scenes is off by 20 mrad, which is no fault but shows.
TEST(RecordedAgreement, RealRadarsAreGood) {
  const std::filesystem::path dataroot = std::filesystem::path(RADAR_DOT_SHARED_DATA) / "nuscenes_mini_real";
  if (!std::filesystem::exists(dataroot)) GTEST_SKIP() << "no real data under " << dataroot;
  const dataset::Tables tables = dataset::Tables::load(dataroot);
  Configuration nuscenes;
  readConfigFile(NUSCENES_CONFIG, sectionsOf(nuscenes));
  for (std::size_t scene = 0; scene < tables.scenes.size(); ++scene) {
    const Accused accused = accuse(tables, static_cast<dataset::Index>(scene), nuscenes.ego_velocity);
    const std::string& name = tables.scenes[scene].name;
    EXPECT_EQ(accused.channels, std::set<std::string>()) << name;
    if (name != "scene-0796") continue;
    EXPECT_NEAR(accused.corrections.at("RADAR_FRONT"), -1.15 * kDegree, 0.6 * kDegree);
  }
  const EgoVelocityConfig faulty = withFault(nuscenes.ego_velocity, -3.0 * kDegree, 1.0);
  EXPECT_EQ(accuse(tables, tables.findScene("scene-0655"), faulty).channels,
            std::set<std::string>({"RADAR_FRONT_LEFT"}));
}

/// Channels whose velocities are found to be no range rates at some time of a scene.
/// @param compensated  what the estimate leaves of the range rates is taken instead of them
std::set<std::string> withoutRangeRates(const dataset::Tables& tables, dataset::Index index,
                                        const EgoVelocityConfig& config, bool compensated) {
  const RadarScene scene = loadRadarScene(tables, index, {}, config);
  SweepEstimator estimator(config);
  std::vector<RangeRateWatch> watches(scene.radars.size());
  std::set<std::string> found;
  for (SceneSweep& sweep : assembleSweeps(scene, config.sweep)) {
    const EgoVelocityResult result = estimator.estimate(sweep.scans, sweep.time).single;
    for (std::size_t s = 0; s < sweep.scans.size() && result.valid(); ++s) {
      const RadarScan& scan = sweep.scans[s];
      std::vector<DopplerReturn> returns(scan.returns.begin(), scan.returns.end());
      for (std::size_t i = 0; i < returns.size() && compensated; ++i)
        returns[i].doppler = result.residuals[result.offsets[s] + i];
      watches[scan.radar].add(scan.time, returns, scan.T_base_from_sensor);
      if (watches[scan.radar].verdict() != RangeRateWatch::Verdict::kGood)
        found.insert(scene.radars[scan.radar].channel);
    }
  }
  return found;
}

TEST(RecordedRangeRates, AreNoneWhereTheyAreCompensated) {
  const std::filesystem::path dataroot = std::filesystem::path(RADAR_DOT_SHARED_DATA) / "nuscenes_mini_real";
  if (!std::filesystem::exists(dataroot)) GTEST_SKIP() << "no real data under " << dataroot;
  const dataset::Tables tables = dataset::Tables::load(dataroot);
  Configuration nuscenes;
  readConfigFile(NUSCENES_CONFIG, sectionsOf(nuscenes));
  std::size_t found = 0;
  for (std::size_t i = 0; i < tables.scenes.size(); ++i) {
    const auto scene = static_cast<dataset::Index>(i);
    EXPECT_EQ(withoutRangeRates(tables, scene, nuscenes.ego_velocity, false), std::set<std::string>())
        << tables.scenes[i].name;
    found += !withoutRangeRates(tables, scene, nuscenes.ego_velocity, true).empty();
  }
  EXPECT_GE(found, 5U) << "the others stand, or have nothing to hold on to";
}

}  // namespace
}  // namespace radar_dot::evaluation
