// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/depth_metrics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "evaluation/noisy_depth.h"

namespace radar_dot::evaluation {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

cv::Mat rowOf(std::initializer_list<float> values) {
  cv::Mat row(1, static_cast<int>(values.size()), CV_32FC1);
  std::copy(values.begin(), values.end(), row.begin<float>());
  return row;
}

// Truth 10, 50, 60, 75, 90 m and unknown twice; estimates 13, 46, unknown, 76, 5 m.
DepthErrors example() {
  DepthErrors errors;
  errors.add(rowOf({13.0F, 46.0F, kNaN, 76.0F, 5.0F, 7.0F, 7.0F}),
             rowOf({10.0F, 50.0F, 60.0F, 75.0F, 90.0F, kNaN, 0.0F}));
  return errors;
}

TEST(DepthErrors, KnownSums) {
  const DepthErrors errors = example();
  EXPECT_EQ(errors.within[0].true_pixels, 2U);  // the limit itself is within
  EXPECT_EQ(errors.within[1].true_pixels, 3U);
  EXPECT_EQ(errors.within[2].true_pixels, 4U);
  EXPECT_EQ(errors.within[1].compared, 2U);
  EXPECT_EQ(errors.within[2].compared, 3U);
  EXPECT_DOUBLE_EQ(errors.within[0].meanAbsoluteError(), 3.5);
  EXPECT_DOUBLE_EQ(errors.within[0].rootMeanSquaredError(), std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(errors.within[2].meanAbsoluteError(), 8.0 / 3.0);
  EXPECT_DOUBLE_EQ(errors.within[2].rootMeanSquaredError(), std::sqrt(26.0 / 3.0));
  EXPECT_DOUBLE_EQ(errors.within[0].coverage(), 1.0);
  EXPECT_DOUBLE_EQ(errors.within[1].coverage(), 2.0 / 3.0);
}

TEST(DepthErrors, PicturesAddUp) {
  DepthErrors sum = example();
  DepthErrors other;
  other.add(rowOf({20.0F}), rowOf({25.0F}));
  sum += other;
  EXPECT_EQ(sum.within[0].compared, 3U);
  EXPECT_DOUBLE_EQ(sum.within[0].meanAbsoluteError(), 4.0);
  EXPECT_DOUBLE_EQ(sum.within[0].squared, 50.0);
}

TEST(DepthErrors, NothingComparedIsNaN) {
  DepthErrors errors;
  EXPECT_TRUE(std::isnan(errors.within[0].meanAbsoluteError()));
  EXPECT_TRUE(std::isnan(errors.within[0].coverage()));
  // Neither infinite nor negative nor zero is an estimate.
  errors.add(rowOf({std::numeric_limits<float>::infinity(), -3.0F, 0.0F}), rowOf({9.0F, 9.0F, 9.0F}));
  EXPECT_TRUE(std::isnan(errors.within[0].rootMeanSquaredError()));
  EXPECT_DOUBLE_EQ(errors.within[0].coverage(), 0.0);
}

// Inverse depths off by 0.2, 0.1, 0.5 and 0.1 of the estimated one, of which 0.1, 0.1, 1 and 0.4 are
// declared; farther than the last limit, or with unknown depth or sigma, nothing counts.
TEST(DepthErrors, InUnitsOfTheDeclaredSigma) {
  DepthErrors errors;
  errors.add(rowOf({12.0F, 18.0F, 15.0F, 44.0F, 200.0F, kNaN, 7.0F}),
             rowOf({10.0F, 20.0F, 10.0F, 40.0F, 100.0F, 10.0F, 10.0F}),
             rowOf({0.1F, 0.1F, 1.0F, 0.4F, 0.01F, 0.1F, kNaN}));
  const NormalisedErrors& normalised = errors.normalised;
  EXPECT_EQ(normalised.count(), 4U);
  EXPECT_NEAR(normalised.quantile(0.25), 0.25, 0.003);
  EXPECT_NEAR(normalised.quantile(0.5), 0.5, 0.006);
  EXPECT_NEAR(normalised.quantile(0.75), 1.0, 0.012);
  EXPECT_NEAR(normalised.quantile(1.0), 2.0, 0.024);
  DepthErrors sum = errors;
  sum += errors;
  EXPECT_EQ(sum.normalised.count(), 8U);
  EXPECT_TRUE(std::isnan(example().normalised.quantile(0.5)));  // nothing is declared
}

TEST(NormalisedErrors, TheLargestAndTheSmallestStayCounted) {
  NormalisedErrors errors;
  errors.add(0.0);
  errors.add(std::numeric_limits<double>::infinity());
  errors.add(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(errors.count(), 2U);
  EXPECT_LT(errors.quantile(0.5), 0.0011);
  EXPECT_GT(errors.quantile(0.9), 9000.0);
}

// The smooth error of a depth network, as its model declares it: between its nodes the field averages, so
// that it is a little less.
TEST(NoisyDepthErrors, AreAsLargeAsDeclared) {
  DepthErrors errors;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const cv::Mat truth(450, 800, CV_32FC1, cv::Scalar(seed % 2 == 0 ? 15.0 : 45.0));
    const cv::Mat noisy = noisyDepth(truth, {}, seed);
    const cv::Mat stds = noisyDepthStd(truth, noisy, {});
    EXPECT_EQ(cv::countNonZero((stds == stds) != (noisy == noisy)), 0);
    errors.add(noisy, truth, stds);
  }
  EXPECT_NEAR(errors.normalised.quantile(0.6827), 0.85, 0.15);
}

TEST(DepthErrors, RefusesImagesThatDoNotFit) {
  DepthErrors errors;
  EXPECT_THROW(errors.add(rowOf({1.0F}), rowOf({1.0F}), rowOf({1.0F, 2.0F})), std::invalid_argument);
  EXPECT_THROW(errors.add(rowOf({1.0F}), rowOf({1.0F, 2.0F})), std::invalid_argument);
  EXPECT_THROW(errors.add(cv::Mat(1, 1, CV_64FC1), rowOf({1.0F})), std::invalid_argument);
}

// A smooth factor with a normal logarithm of small sigma s is off by sqrt(2 / pi) s in the mean; between its
// nodes the field averages, so that a part of that is seen.
TEST(NoisyDepthErrors, GrowWithTheDepthAsTold) {
  NoisyDepthParams params;
  params.hole_share = 0.0;
  params.relative_std = 0.1;
  params.growth = 1.0;
  DepthErrors near, far;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const cv::Mat truth_near(450, 800, CV_32FC1, cv::Scalar(15.0));
    const cv::Mat truth_far(450, 800, CV_32FC1, cv::Scalar(45.0));
    near.add(noisyDepth(truth_near, params, seed), truth_near);
    far.add(noisyDepth(truth_far, params, seed), truth_far);
  }
  const double expected = std::sqrt(2.0 / 3.14159265358979) * 0.05 * 15.0;
  EXPECT_LT(near.within[0].meanAbsoluteError(), 1.05 * expected);
  EXPECT_GT(near.within[0].meanAbsoluteError(), 0.5 * expected);
  // Three times the depth, three times the share.
  EXPECT_NEAR(far.within[0].meanAbsoluteError() / near.within[0].meanAbsoluteError(), 9.0, 0.6);
}

// A flat road as a camera 1.5 m high sees it, and a wall at 35 m. The target is one of whole streets, so that
// one picture is near it, not at it.
TEST(NoisyDepthErrors, OfTheSizeOfADepthNetwork) {
  cv::Mat truth(450, 800, CV_32FC1, cv::Scalar(kNaN));
  for (int v = 240; v < 450; ++v) truth.row(v).setTo(633.0 * 1.5 / (v - 225));
  truth(cv::Rect(0, 120, 800, 120)).setTo(35.0);
  DepthErrors errors;
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    const cv::Mat noisy = noisyDepth(truth, {}, seed);
    EXPECT_EQ(cv::countNonZero(noisy.rowRange(0, 120) == noisy.rowRange(0, 120)), 0);  // NaN stays
    errors.add(noisy, truth);
  }
  EXPECT_NEAR(errors.within[0].meanAbsoluteError(), 1.3, 0.5);
  EXPECT_GT(errors.within[0].coverage(), 0.97);
}

}  // namespace
}  // namespace radar_dot::evaluation
