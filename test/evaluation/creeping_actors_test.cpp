// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/creeping_actors.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>
#include <vector>

#include "evaluation/simulated_dataroot.h"
#include "fixtures/nuscenes_fixture.h"
#include "fixtures/refusal.h"

namespace radar_dot::evaluation {
namespace {

using dataset::Index;

std::vector<Index> keyframesOf(const dataset::Tables& tables, Index scene) {
  std::vector<Index> rows;
  for (const Index row : tables.readingsOf(scene, "CAM_FRONT"))
    if (tables.sample_data[static_cast<std::size_t>(row)].is_key_frame) rows.push_back(row);
  return rows;
}

/// What the simulator says moves, in an image.
cv::Mat trueMotion(const dataset::Tables& tables, Index row) {
  const std::string name =
      tables.path(tables.sample_data[static_cast<std::size_t>(row)]).stem().string() + ".png";
  return cv::imread((tables.dataroot() / "ground_truth" / "motion" / name).string(), cv::IMREAD_GRAYSCALE) !=
         0;
}

TEST(CreepingActors, WhatIsCalledMovingIsNotAmongThem) {
  const test::SimulatedDataroot dataroot;
  const CreepingActors creeping(dataroot.tables(), 0);
  int moving = 0;
  for (const Index row : keyframesOf(dataroot.tables(), 0)) {
    const cv::Mat truth = trueMotion(dataroot.tables(), row);
    moving += cv::countNonZero(truth);
    EXPECT_EQ(cv::countNonZero(creeping.shownBy(row) & truth), 0);
  }
  EXPECT_GT(moving, 0);
}

TEST(CreepingActors, WhatMovesAndIsNotCalledSoIs) {
  const test::SimulatedDataroot dataroot;
  dataset::Tables tables = dataroot.tables();
  for (dataset::SampleAnnotation& box : tables.annotations) box.attributes.clear();
  const CreepingActors creeping(tables, 0);
  int moving = 0, shown = 0;
  for (const Index row : keyframesOf(tables, 0)) {
    const cv::Mat truth = trueMotion(tables, row);
    moving += cv::countNonZero(truth);
    shown += cv::countNonZero(creeping.shownBy(row) & truth);
  }
  // Those seen at a single keyframe have no way that could be measured.
  EXPECT_GT(shown, 0.9 * moving);
  // In the car park nothing moves, whatever it is called.
  const CreepingActors parked(tables, 1);
  for (const Index row : keyframesOf(tables, 1)) EXPECT_EQ(cv::countNonZero(parked.shownBy(row)), 0);
}

TEST(CreepingActors, NeedsTheNumbersOfTheActors) {
  const test::NuscenesFixture fixture;  // has no ground truth
  const dataset::Tables tables = dataset::Tables::load(fixture.dataroot());
  const std::string file = tables.scenes.front().name + "_instances.json";
  test::expectRefusal<dataset::DatasetError>([&] { CreepingActors(tables, 0); }, {file});
}

}  // namespace
}  // namespace radar_dot::evaluation
