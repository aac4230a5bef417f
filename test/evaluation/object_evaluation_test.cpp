// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/object_evaluation.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fixtures/nuscenes_fixture.h"

namespace radar_dot::evaluation {
namespace {

using test::NuscenesFixture;

/// The fixture's clutter are movers without a box: those returns do not repeat, so they give no tracks.
ObjectReport evaluate(const NuscenesFixture& fixture, const ObjectEvaluationOptions& options = {}) {
  const dataset::Tables tables = dataset::Tables::load(fixture.dataroot());
  return evaluateObjects(tables, tables.findScene(NuscenesFixture::kStraightScene), options);
}

// A car 15 m ahead drives 2 m/s faster; a parked one stands beside the road.
TEST(ObjectEvaluation, FindsTheCarAhead) {
  test::FixtureOptions fixture;
  fixture.samples_per_scene = 8;
  const ObjectReport report = evaluate(NuscenesFixture(fixture));
  EXPECT_EQ(report.keyframes, 8U);
  const MoverCounts& vehicles = report.kinds[static_cast<std::size_t>(MoverKind::kVehicle)];
  EXPECT_EQ(vehicles.movers, 8U);
  EXPECT_LE(vehicles.unseen, 1U) << "at the first keyframe, before any scan";
  EXPECT_GE(vehicles.matched, 6U) << "all but those before the track is confirmed";
  EXPECT_EQ(report.all().movers, vehicles.movers);
  EXPECT_EQ(report.true_tracks, vehicles.matched);
  EXPECT_EQ(report.standing_tracks, 0U);
  EXPECT_EQ(report.identity_switches, 0U);
  EXPECT_LT(meanAbsolute(vehicles.errors.radial), 0.1);
  EXPECT_LT(meanAbsolute(vehicles.errors.velocity), 1.0);
  EXPECT_LT(meanAbsolute(vehicles.errors.position), 2.0);
}

TEST(ObjectEvaluation, OnlyTheRegionCounts) {
  const NuscenesFixture fixture;
  ObjectEvaluationOptions options;
  options.matching.max_range = 10.0;
  EXPECT_EQ(evaluate(fixture, options).all().movers, 0U);
  EXPECT_TRUE(std::isnan(evaluate(fixture, options).all().recall()));
  options = {};
  options.matching.min_speed = 12.0;
  EXPECT_EQ(evaluate(fixture, options).all().movers, 0U) << "called moving, but slower: unknown";
}

TEST(ObjectReport, SumsAndShares) {
  ObjectReport report;
  MoverCounts& counts = report.kinds[0];
  counts.movers = 10;
  counts.matched = 4;
  counts.unseen = 2;
  counts.errors.radial = {-0.2, 0.4, 0.3};
  report.tracks = 9;
  report.true_tracks = 4;
  report.unknown_tracks = 1;
  ObjectReport sum = report;
  sum += report;
  EXPECT_EQ(sum.all().movers, 20U);
  EXPECT_DOUBLE_EQ(sum.all().recall(), 0.4);
  EXPECT_DOUBLE_EQ(sum.all().seenRecall(), 0.5);
  EXPECT_DOUBLE_EQ(sum.precision(), 0.5);
  EXPECT_NEAR(meanAbsolute(sum.all().errors.radial), 0.3, 1e-12);
  EXPECT_NEAR(medianAbsolute(sum.all().errors.radial), 0.3, 1e-12);
  report.scene = "scene-0001";
  EXPECT_NE(formatTable({report}, sum).find("scene-0001"), std::string::npos);
  EXPECT_NE(formatJson(std::vector{report}, sum).find("\"recall_of_seen_vehicle\": 0.5"), std::string::npos);
}

}  // namespace
}  // namespace radar_dot::evaluation
