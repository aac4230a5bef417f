// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/noisy_depth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <stdexcept>

namespace radar_dot::evaluation {
namespace {

cv::Mat plane(double depth) { return cv::Mat(450, 800, CV_32FC1, cv::Scalar(depth)); }

TEST(NoisyDepth, ErrsByItsShareOfTheDepth) {
  NoisyDepthParams params;
  params.hole_share = 0.0;
  params.relative_std = 0.1;
  double sum = 0.0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const cv::Mat noisy = noisyDepth(plane(40.0), params, seed);
    for (int v = 0; v < noisy.rows; v += 3)
      for (int u = 0; u < noisy.cols; u += 3, ++count)
        sum += std::pow(std::log(noisy.at<float>(v, u) / 40.0), 2);
  }
  const double spread = std::sqrt(sum / count);
  EXPECT_GT(spread, 0.05);  // between nodes the field is an average, and smaller
  EXPECT_LT(spread, 0.11);
}

TEST(NoisyDepth, SameSeedSameErrors) {
  const cv::Mat first = noisyDepth(plane(20.0), {}, 5);
  cv::Mat known = first == first;
  EXPECT_EQ(cv::norm(first, noisyDepth(plane(20.0), {}, 5), cv::NORM_INF, known), 0.0);
  EXPECT_GT(cv::norm(first, noisyDepth(plane(20.0), {}, 6), cv::NORM_INF, known), 0.1);
}

TEST(NoisyDepth, EdgesBleedAndTheUnknownStaysUnknown) {
  NoisyDepthParams params;
  params.relative_std = 0.0;
  params.hole_share = 0.0;
  cv::Mat depth = plane(50.0);
  depth(cv::Rect(0, 0, 400, 450)).setTo(10.0);
  depth(cv::Rect(0, 0, 800, 50)).setTo(std::numeric_limits<double>::quiet_NaN());
  const cv::Mat noisy = noisyDepth(depth, params, 1);
  EXPECT_FLOAT_EQ(noisy.at<float>(200, 300), 10.0F);
  EXPECT_FLOAT_EQ(noisy.at<float>(200, 500), 50.0F);
  EXPECT_GT(noisy.at<float>(200, 399), 10.5F);
  EXPECT_LT(noisy.at<float>(200, 400), 45.0F);
  EXPECT_TRUE(std::isnan(noisy.at<float>(20, 500)));
}

TEST(NoisyDepth, HasHoles) {
  NoisyDepthParams params;
  params.hole_share = 0.05;
  const cv::Mat noisy = noisyDepth(plane(20.0), params, 3);
  const double share = 1.0 - cv::countNonZero(noisy == noisy) / (450.0 * 800.0);
  EXPECT_GT(share, 0.02);
  EXPECT_LT(share, 0.07);
}

TEST(NoisyDepth, DeclaresTheSigmaOfItsModel) {
  NoisyDepthParams params;
  params.relative_std = 0.1;
  params.growth = 2.0;
  cv::Mat truth = plane(60.0), noisy = plane(50.0);
  truth.at<float>(0, 0) = noisy.at<float>(1, 1) = std::numeric_limits<float>::quiet_NaN();
  const cv::Mat stds = noisyDepthStd(truth, noisy, params);
  EXPECT_FLOAT_EQ(stds.at<float>(5, 5), 0.4F);
  EXPECT_TRUE(std::isnan(stds.at<float>(0, 0)));
  EXPECT_TRUE(std::isnan(stds.at<float>(1, 1)));
  EXPECT_THROW(noisyDepthStd(truth, noisy.rowRange(0, 9), params), std::invalid_argument);
}

TEST(NoisyDepth, RefusesNonsense) {
  EXPECT_THROW(noisyDepth(cv::Mat(3, 3, CV_8UC1), {}, 1), std::invalid_argument);
  NoisyDepthParams params;
  params.cell = 0;
  EXPECT_THROW(noisyDepth(plane(1.0), params, 1), std::invalid_argument);
}

}  // namespace
}  // namespace radar_dot::evaluation
