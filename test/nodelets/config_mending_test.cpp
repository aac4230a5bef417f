// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/config_mending.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "nodelets/vision_parameters.h"

namespace radar_dot {
namespace {

using Names = std::vector<std::string>;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void checkDepth(const DepthConfig& config) { makeDepthEstimator(depthParams(config)); }
void checkFlow(const OpticalFlowConfig& config) { makeOpticalFlow(opticalFlowParams(config)); }

// Two parameters that make sense only together.
void checkColumns(const DepthConfig& config) {
  if (config.column_half_width > config.column_height)
    throw std::invalid_argument("columns are wider than high");
}
const Names kColumns{"column_height", "column_half_width"};

void expectProblem(const std::string& problem, const std::string& beginning, const std::string& part) {
  EXPECT_EQ(problem.compare(0, beginning.size(), beginning), 0) << problem;
  EXPECT_NE(problem.find(part), std::string::npos) << problem;
}

TEST(Mend, GoodOnesAreUntouched) {
  DepthConfig config = DepthConfig::__getDefault__();
  config.max_depth = 60.0;
  config.backend = "lidar";
  const Mended<DepthConfig> mended = mend<DepthConfig>(config, checkDepth);
  EXPECT_TRUE(mended.valid);
  EXPECT_TRUE(mended.problems.empty());
  EXPECT_TRUE(mended.replaced.empty());
  EXPECT_EQ(mended.config.max_depth, 60.0);
  EXPECT_EQ(mended.config.backend, "lidar");
}

TEST(Mend, OneBadNumberDoesNotTakeTheGoodOnesWithIt) {
  DepthConfig config = DepthConfig::__getDefault__();
  config.max_depth = kNaN;
  config.ground_pitch = 0.1;
  config.image_edges = true;
  config.completion_kernel = 33;
  config.backend = "lidar";
  const Mended<DepthConfig> mended = mend<DepthConfig>(config, checkDepth);
  EXPECT_TRUE(mended.valid);
  EXPECT_EQ(mended.config.max_depth, DepthConfig::__getDefault__().max_depth);
  EXPECT_EQ(mended.config.ground_pitch, 0.1);
  EXPECT_TRUE(mended.config.image_edges);
  EXPECT_EQ(mended.config.completion_kernel, 33);
  EXPECT_EQ(mended.config.backend, "lidar");
  ASSERT_EQ(mended.problems.size(), 1U);
  expectProblem(mended.problems[0], "max_depth: ", "not finite; using the default");
  EXPECT_EQ(mended.replaced, (std::vector<Names>{{"max_depth"}}));
}

// dynamic_reconfigure clamps numbers, but neither NaN nor what only the nodelet itself uses is checked there.
TEST(Mend, NumbersThatTheCheckDoesNotSeeMustBeFiniteToo) {
  for (const double value : {kNaN, std::numeric_limits<double>::infinity()}) {
    DepthConfig config = DepthConfig::__getDefault__();
    config.radar_max_age = value;
    EXPECT_NO_THROW(checkDepth(config));
    const Mended<DepthConfig> mended = mend<DepthConfig>(config, checkDepth);
    EXPECT_TRUE(mended.valid);
    EXPECT_EQ(mended.config.radar_max_age, DepthConfig::__getDefault__().radar_max_age);
    EXPECT_EQ(mended.replaced, (std::vector<Names>{{"radar_max_age"}}));
  }
}

TEST(Mend, EachBadValueIsNamedOnItsOwnLine) {
  OpticalFlowConfig config = OpticalFlowConfig::__getDefault__();
  config.preset = "turbo";
  config.backend = "magic";
  config.working_width = -1;
  config.forward_backward = true;
  config.initialisation = "temporal";
  config.forward_backward_relative = 0.2;
  const Mended<OpticalFlowConfig> mended = mend<OpticalFlowConfig>(config, checkFlow);
  const OpticalFlowConfig& defaults = OpticalFlowConfig::__getDefault__();
  EXPECT_TRUE(mended.valid);
  EXPECT_EQ(mended.config.preset, defaults.preset);
  EXPECT_EQ(mended.config.backend, defaults.backend);
  EXPECT_EQ(mended.config.working_width, defaults.working_width);
  EXPECT_TRUE(mended.config.forward_backward);
  EXPECT_EQ(mended.config.initialisation, "temporal");
  EXPECT_EQ(mended.config.forward_backward_relative, 0.2);
  ASSERT_EQ(mended.problems.size(), 3U);
  expectProblem(mended.problems[0], "backend: ", "'magic'");
  expectProblem(mended.problems[1], "working_width: ", "-1");
  expectProblem(mended.problems[2], "preset: ", "'turbo'");
  EXPECT_EQ(mended.replaced, (std::vector<Names>{{"backend"}, {"working_width"}, {"preset"}}));
}

TEST(Mend, SwitchesAreReplacedAsWell) {
  DepthConfig config = DepthConfig::__getDefault__();
  config.image_edges = true;
  const Mended<DepthConfig> mended = mend<DepthConfig>(config, [](const DepthConfig& candidate) {
    if (candidate.image_edges) throw std::invalid_argument("there is no image");
  });
  EXPECT_TRUE(mended.valid);
  EXPECT_FALSE(mended.config.image_edges);
  EXPECT_EQ(mended.replaced, (std::vector<Names>{{"image_edges"}}));
}

TEST(Mend, PairsAreReplacedTogether) {
  DepthConfig config = DepthConfig::__getDefault__();
  config.column_height = 1.0;  // both are fine with the other's default, but not together
  config.column_half_width = 1.5;
  config.max_depth = 60.0;
  const Mended<DepthConfig> mended = mend<DepthConfig>(config, checkColumns, {kColumns});
  EXPECT_TRUE(mended.valid);
  EXPECT_EQ(mended.config.column_height, DepthConfig::__getDefault__().column_height);
  EXPECT_EQ(mended.config.column_half_width, DepthConfig::__getDefault__().column_half_width);
  EXPECT_EQ(mended.config.max_depth, 60.0);
  ASSERT_EQ(mended.problems.size(), 1U);
  expectProblem(mended.problems[0], "column_height, column_half_width: ", "wider than high");
  EXPECT_EQ(mended.replaced, (std::vector<Names>{kColumns}));
}

TEST(Mend, PairsThatMakeSenseTogetherStay) {
  DepthConfig config = DepthConfig::__getDefault__();
  config.column_height = 3.0;
  config.column_half_width = 2.0;  // more than the default of the height
  config.max_depth = kNaN;
  const Mended<DepthConfig> mended = mend<DepthConfig>(config, checkColumns, {kColumns});
  EXPECT_TRUE(mended.valid);
  EXPECT_EQ(mended.config.column_height, 3.0);
  EXPECT_EQ(mended.config.column_half_width, 2.0);
  EXPECT_EQ(mended.replaced, (std::vector<Names>{{"max_depth"}}));
}

TEST(Mend, ValuesThatContradictEachOtherUnpairedAreNotValid) {
  DepthConfig config = DepthConfig::__getDefault__();
  config.column_height = 1.0;
  config.column_half_width = 1.5;
  const Mended<DepthConfig> mended = mend<DepthConfig>(config, checkColumns);
  EXPECT_FALSE(mended.valid);
  EXPECT_EQ(mended.problems, (Names{"columns are wider than high"}));
}

TEST(Mend, ACheckThatRefusesEvenTheDefaultsIsReported) {
  const Mended<DepthConfig> mended = mend<DepthConfig>(DepthConfig::__getDefault__(), [](const DepthConfig&) {
    throw std::invalid_argument("there is no camera");
  });
  EXPECT_FALSE(mended.valid);
  ASSERT_FALSE(mended.problems.empty());
  EXPECT_EQ(mended.problems.back(), "there is no camera");
}

}  // namespace
}  // namespace radar_dot
