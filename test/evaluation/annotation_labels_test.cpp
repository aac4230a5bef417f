// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/annotation_labels.h"

#include <gtest/gtest.h>

#include <cmath>

#include "fixtures/nuscenes_fixture.h"

namespace radar_dot::evaluation {
namespace {

using Eigen::Vector3d;

/// A car of 4 m x 2 m at (20, 0), heading along x at `speed`.
MovingBox car(double speed) {
  MovingBox box;
  box.centre = Vector3d(20.0, 0.0, 1.0);
  box.velocity = Vector3d(speed, 0.0, 0.0);
  box.half_size = Eigen::Vector2d(2.0, 1.0);
  return box;
}

const Vector3d kSensor(0.0, 0.0, 0.5);

TEST(TrueLabel, InsideAMovingBoxIsDynamic) {
  EXPECT_EQ(trueLabel({car(5.0)}, {20.0, 0.0, 0.0}, kSensor, 0.0), TrueLabel::kDynamic);
  EXPECT_EQ(trueLabel({car(5.0)}, {30.0, 0.0, 0.0}, kSensor, 0.0), TrueLabel::kStatic);
  EXPECT_EQ(trueLabel({car(0.3)}, {20.0, 0.0, 0.0}, kSensor, 0.0), TrueLabel::kStatic)
      << "slower than 0.5 m/s";
}

TEST(TrueLabel, BoxesAreGrownByHalfAMetre) {
  EXPECT_EQ(trueLabel({car(5.0)}, {22.4, 0.0, 0.0}, kSensor, 0.0), TrueLabel::kDynamic);
  EXPECT_EQ(trueLabel({car(5.0)}, {22.6, 0.0, 0.0}, kSensor, 0.0), TrueLabel::kStatic);
  EXPECT_EQ(trueLabel({car(5.0)}, {20.0, 1.4, 0.0}, kSensor, 0.0), TrueLabel::kDynamic);
  EXPECT_EQ(trueLabel({car(5.0)}, {20.0, 1.6, 0.0}, kSensor, 0.0), TrueLabel::kStatic);
}

TEST(TrueLabel, MotionAcrossTheLineOfSightIsIgnored) {
  MovingBox crossing = car(0.0);
  crossing.velocity = Vector3d(0.0, 5.0, 0.0);
  EXPECT_EQ(trueLabel({crossing}, {20.0, 0.0, 0.0}, kSensor, 0.0), TrueLabel::kIgnored);
  EXPECT_EQ(trueLabel({crossing, car(5.0)}, {20.0, 0.0, 0.0}, kSensor, 0.0), TrueLabel::kDynamic)
      << "a second box can still explain the Doppler";
}

TEST(TrueLabel, TheBoxMovesWithItsTrack) {
  EXPECT_EQ(trueLabel({car(10.0)}, {26.0, 0.0, 0.0}, kSensor, 0.0), TrueLabel::kStatic);
  EXPECT_EQ(trueLabel({car(10.0)}, {26.0, 0.0, 0.0}, kSensor, 0.5), TrueLabel::kDynamic);
}

TEST(BoxesAt, VelocityIsThatOfTheTrack) {
  const test::NuscenesFixture fixture;
  const dataset::Tables tables = dataset::Tables::load(fixture.dataroot());
  const dataset::Index scene = tables.findScene(test::NuscenesFixture::kStraightScene);
  ASSERT_NE(scene, dataset::kNone);
  const auto& truth = fixture.scene(test::NuscenesFixture::kStraightScene);
  for (const dataset::Index sample : tables.samplesOf(scene)) {
    const std::vector<MovingBox> boxes = boxesAt(tables, sample);
    ASSERT_EQ(boxes.size(), 2U);
    int moving = 0;
    for (const MovingBox& box : boxes) {
      if (box.velocity.norm() < 1e-6) continue;
      ++moving;
      EXPECT_LT((box.velocity - truth.moving_box.velocity()).norm(), 1e-3);
    }
    EXPECT_EQ(moving, 1);
  }
}

TEST(Confusion, KnownCounts) {
  Confusion counts;
  for (int i = 0; i < 6; ++i) counts.add(true, true);
  for (int i = 0; i < 2; ++i) counts.add(true, false);
  for (int i = 0; i < 4; ++i) counts.add(false, true);
  counts.add(false, false);
  EXPECT_DOUBLE_EQ(counts.precision(), 0.75);
  EXPECT_DOUBLE_EQ(counts.recall(), 0.6);
  EXPECT_DOUBLE_EQ(counts.f1(), 2 * 0.75 * 0.6 / (0.75 + 0.6));
  EXPECT_EQ(counts.true_negatives, 1U);
  EXPECT_TRUE(std::isnan(Confusion{}.precision()));
}

}  // namespace
}  // namespace radar_dot::evaluation
