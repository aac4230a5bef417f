// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "noisy_depth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <random>
#include <stdexcept>

namespace radar_dot::evaluation {
namespace {

/// Uniform in [0, 1), the same everywhere: distributions of the standard library differ between libraries.
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : random_(seed) {}
  double next() { return static_cast<double>(random_() >> 11U) * 0x1p-53; }

 private:
  std::mt19937_64 random_;
};

int scaled(int pixels, const cv::Mat& image) {
  return std::max(1, static_cast<int>(std::lround(pixels * image.cols / 1600.0)));
}

/// Smooth field of mean 0 and standard deviation 1 at its nodes, one node per cell.
cv::Mat smoothField(const cv::Size& size, int cell, Uniform& uniform) {
  cv::Mat nodes(size.height / cell + 3, size.width / cell + 3, CV_32FC1);
  for (int row = 0; row < nodes.rows; ++row) {
    for (int column = 0; column < nodes.cols; ++column) {
      double sum = -6.0;  // twelve uniform numbers are as good as normal
      for (int i = 0; i < 12; ++i) sum += uniform.next();
      nodes.at<float>(row, column) = static_cast<float>(sum);
    }
  }
  cv::Mat field;
  cv::resize(nodes, field, cv::Size(nodes.cols * cell, nodes.rows * cell), 0.0, 0.0, cv::INTER_CUBIC);
  return field(cv::Rect(cell, cell, size.width, size.height));
}

/// Blends inverse depths across edges, as a network that is not sure on which side it is.
cv::Mat bled(const cv::Mat& depth, int width) {
  cv::Mat inverse(depth.size(), CV_32FC1);
  cv::Mat known(depth.size(), CV_32FC1);
  for (int row = 0; row < depth.rows; ++row) {
    for (int column = 0; column < depth.cols; ++column) {
      const float d = depth.at<float>(row, column);
      known.at<float>(row, column) = d > 0.0F ? 1.0F : 0.0F;
      inverse.at<float>(row, column) = d > 0.0F ? 1.0F / d : 0.0F;
    }
  }
  const cv::Size window(width | 1, width | 1);
  cv::blur(inverse, inverse, window);
  cv::blur(known, known, window);
  cv::Mat result = depth.clone();
  for (int row = 0; row < depth.rows; ++row) {
    for (int column = 0; column < depth.cols; ++column) {
      if (depth.at<float>(row, column) > 0.0F)
        result.at<float>(row, column) = known.at<float>(row, column) / inverse.at<float>(row, column);
    }
  }
  return result;
}

/// @param depth  m, true
double sigmaAt(double depth, const NoisyDepthParams& params) {
  return params.relative_std * std::pow(depth / NoisyDepthParams::kReferenceDepth, params.growth);
}

}  // namespace

cv::Mat noisyDepth(const cv::Mat& true_depth, const NoisyDepthParams& params, std::uint64_t seed) {
  if (true_depth.empty() || true_depth.type() != CV_32FC1)
    throw std::invalid_argument("noisy depth: the true depth must be a CV_32FC1 image that is not empty");
  if (!(params.relative_std >= 0.0) || !(params.growth >= 0.0) ||
      !(params.hole_share >= 0.0 && params.hole_share <= 1.0) || params.cell < 1 || params.bleeding < 0)
    throw std::invalid_argument(
        "noisy depth: relative_std, growth and bleeding must not be negative, cell positive, hole_share "
        "between 0 and 1");
  Uniform uniform(seed);
  cv::Mat depth = bled(true_depth, scaled(params.bleeding, true_depth));
  const cv::Mat field = smoothField(depth.size(), scaled(params.cell, depth), uniform);
  for (int row = 0; row < depth.rows; ++row) {
    for (int column = 0; column < depth.cols; ++column) {
      float& d = depth.at<float>(row, column);
      if (!(d > 0.0F)) continue;
      const double sigma = sigmaAt(static_cast<double>(d), params);
      d *= static_cast<float>(std::exp(sigma * static_cast<double>(field.at<float>(row, column))));
    }
  }
  const int radius = scaled(params.cell / 8, depth);
  const double one = 3.14159265358979 * radius * radius / static_cast<double>(depth.total());
  const auto holes = static_cast<int>(std::lround(params.hole_share / one));
  for (int i = 0; i < holes; ++i) {
    const auto u = static_cast<int>(uniform.next() * depth.cols);
    const auto v = static_cast<int>(uniform.next() * depth.rows);
    cv::circle(depth, cv::Point(u, v), radius, cv::Scalar(std::numeric_limits<double>::quiet_NaN()),
               cv::FILLED);
  }
  return depth;
}

cv::Mat noisyDepthStd(const cv::Mat& true_depth, const cv::Mat& noisy_depth, const NoisyDepthParams& params) {
  if (true_depth.type() != CV_32FC1 || noisy_depth.type() != CV_32FC1 ||
      true_depth.size() != noisy_depth.size())
    throw std::invalid_argument("noisy depth: both depths must be CV_32FC1 and of one size");
  cv::Mat stds(true_depth.size(), CV_32FC1, cv::Scalar(std::numeric_limits<double>::quiet_NaN()));
  for (int row = 0; row < stds.rows; ++row) {
    for (int column = 0; column < stds.cols; ++column) {
      const float depth = true_depth.at<float>(row, column);
      if (depth > 0.0F && noisy_depth.at<float>(row, column) > 0.0F)
        stds.at<float>(row, column) = static_cast<float>(sigmaAt(static_cast<double>(depth), params));
    }
  }
  return stds;
}

}  // namespace radar_dot::evaluation
