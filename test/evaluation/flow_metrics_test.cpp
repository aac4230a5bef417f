// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/flow_metrics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "fixtures/refusal.h"

namespace radar_dot::evaluation {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr double kMedianTolerance = 0.003;  // of the median

FlowField rowOf(const std::initializer_list<cv::Vec2f>& vectors) {
  FlowField field{cv::Mat(1, static_cast<int>(vectors.size()), CV_32FC2), {}};
  std::copy(vectors.begin(), vectors.end(), field.flow.begin<cv::Vec2f>());
  return field;
}

FlowErrors errorsOf(const FlowField& estimate, const FlowField& truth, const cv::Mat& movers = {}) {
  FlowErrors errors;
  errors.add(estimate, truth, movers, truth.flow.size());
  return errors;
}

TEST(FlowErrors, AreTheLengthOfTheDifference) {
  const FlowErrors::Group all =
      errorsOf(rowOf({{3, 4}, {1, 1}, {0, 2}}), rowOf({{0, 0}, {1, 1}, {0, 0}})).all;
  EXPECT_EQ(all.true_pixels, 3U);
  EXPECT_EQ(all.compared, 3U);
  EXPECT_DOUBLE_EQ(all.mean(), 7.0 / 3.0);
  EXPECT_NEAR(all.median(), 2.0, 2.0 * kMedianTolerance);
  EXPECT_DOUBLE_EQ(all.outlierShare(), 1.0 / 3.0);
  EXPECT_EQ(all.density(), 1.0);
}

TEST(FlowErrors, ArePixelsOfTheFullImage) {
  FlowErrors errors;
  errors.add(rowOf({{3, 1}}), rowOf({{0, 0}}), {}, cv::Size(2, 8));
  EXPECT_DOUBLE_EQ(errors.all.mean(), 10.0);
}

TEST(FlowErrors, OutliersAreOffByThreePixelsAndByFivePercent) {
  const auto outliers = [](const cv::Vec2f& estimate, const cv::Vec2f& truth) {
    return errorsOf(rowOf({estimate}), rowOf({truth})).all.outliers;
  };
  EXPECT_EQ(outliers({3, 0}, {0, 0}), 0U);
  EXPECT_EQ(outliers({3.1F, 0}, {0, 0}), 1U);
  EXPECT_EQ(outliers({104, 0}, {100, 0}), 0U);
  EXPECT_EQ(outliers({106, 0}, {100, 0}), 1U);
}

TEST(FlowErrors, WithoutTruthAPixelTakesNoPartAndWithoutFlowItIsNotDense) {
  FlowField truth = rowOf({{0, 0}, {0, 0}, {0, 0}, {kNaN, 0}, {0, 0}});
  truth.valid = (cv::Mat_<std::uint8_t>(1, 5) << 255, 255, 255, 255, 0);
  FlowField estimate = rowOf({{1, 0}, {9, 0}, {0, kNaN}, {9, 0}, {9, 0}});
  estimate.valid = (cv::Mat_<std::uint8_t>(1, 5) << 255, 0, 255, 255, 255);
  const FlowErrors::Group all = errorsOf(estimate, truth).all;
  EXPECT_EQ(all.true_pixels, 3U);
  EXPECT_EQ(all.compared, 1U);
  EXPECT_DOUBLE_EQ(all.mean(), 1.0);
  EXPECT_DOUBLE_EQ(all.density(), 1.0 / 3.0);
}

TEST(FlowErrors, MoversCountApart) {
  const FlowField truth = rowOf({{0, 0}, {0, 0}, {0, 0}});
  const FlowField estimate = rowOf({{1, 0}, {2, 0}, {6, 0}});
  const FlowErrors split = errorsOf(estimate, truth, (cv::Mat_<std::uint8_t>(1, 3) << 0, 0, 1));
  EXPECT_DOUBLE_EQ(split.still.mean(), 1.5);
  EXPECT_DOUBLE_EQ(split.moving.mean(), 6.0);
  EXPECT_DOUBLE_EQ(split.all.mean(), 3.0);
  const FlowErrors unknown = errorsOf(estimate, truth);
  EXPECT_EQ(unknown.still.true_pixels + unknown.moving.true_pixels, 0U);
  EXPECT_TRUE(std::isnan(unknown.moving.mean()) && std::isnan(unknown.moving.median()));
  EXPECT_TRUE(std::isnan(unknown.moving.outlierShare()) && std::isnan(unknown.moving.density()));
}

TEST(FlowErrors, TheMedianIsFoundAmongSmallAndLargeErrors) {
  for (const double middle : {0.0, 0.002, 0.01, 0.37, 1.0, 8.0, 250.0, 3000.0}) {
    FlowErrors::Group group;
    for (const double factor : {0.1, 0.5, 1.0, 2.0, 30.0}) group.add(factor * middle, 0.0);
    EXPECT_NEAR(group.median(), middle, kMedianTolerance * middle) << middle;
  }
  FlowErrors::Group beyond;
  beyond.add(1e6, 0.0);
  EXPECT_GT(beyond.median(), 1e4);
}

TEST(FlowErrors, PicturesAddUp) {
  const FlowField truth = rowOf({{0, 0}});
  const cv::Mat moves = (cv::Mat_<std::uint8_t>(1, 1) << 255);
  FlowErrors errors = errorsOf(rowOf({{1, 0}}), truth);
  errors += errorsOf(rowOf({{2, 0}}), truth, moves);
  errors.add(rowOf({{9, 0}}), truth, moves, {1, 1});
  EXPECT_DOUBLE_EQ(errors.all.mean(), 4.0);
  EXPECT_NEAR(errors.all.median(), 2.0, 2.0 * kMedianTolerance);
  EXPECT_DOUBLE_EQ(errors.moving.mean(), 5.5);
  EXPECT_DOUBLE_EQ(errors.moving.outlierShare(), 0.5);
}

TEST(FlowErrors, RefusesOtherTypesAndSizes) {
  const FlowField field = rowOf({{0, 0}, {0, 0}});
  const auto expect = [&field](const FlowField& estimate, const FlowField& truth, const cv::Mat& movers,
                               const cv::Size& image, const char* part) {
    test::expectRefusal([&] { FlowErrors().add(estimate, truth, movers, image); }, {part});
  };
  expect(rowOf({{0, 0}}), field, {}, {2, 1}, "the flow is 1x1");
  expect({}, {}, {}, {2, 1}, "not empty");
  expect({cv::Mat(1, 2, CV_32FC1), {}}, field, {}, {2, 1}, "type");
  expect({field.flow, cv::Mat(1, 3, CV_8UC1)}, field, {}, {2, 1}, "valid of the flow");
  expect(field, {field.flow, cv::Mat(1, 3, CV_8UC1)}, {}, {2, 1}, "valid of the true flow");
  expect(field, field, cv::Mat(1, 3, CV_8UC1), {2, 1}, "movers");
  expect(field, field, {}, {0, 1}, "full image is 0x1");
}

}  // namespace
}  // namespace radar_dot::evaluation
