// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/depth_metrics.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace radar_dot::evaluation {
namespace {

double ratio(double part, std::uint64_t whole) {
  return whole == 0 ? std::numeric_limits<double>::quiet_NaN() : part / static_cast<double>(whole);
}

bool isDepth(float value) { return std::isfinite(value) && value > 0.0F; }

}  // namespace

double DepthErrors::Sums::meanAbsoluteError() const { return ratio(absolute, compared); }

double DepthErrors::Sums::rootMeanSquaredError() const { return std::sqrt(ratio(squared, compared)); }

double DepthErrors::Sums::coverage() const { return ratio(static_cast<double>(compared), true_pixels); }

void DepthErrors::add(const cv::Mat& estimate, const cv::Mat& truth) {
  if (estimate.type() != CV_32FC1 || truth.type() != CV_32FC1 || estimate.size() != truth.size()) {
    throw std::invalid_argument(fmt::format(
        "depth errors: the estimate is {}x{} of type {}, the truth {}x{} of type {}; both must be CV_32FC1 "
        "and of one size",
        estimate.cols, estimate.rows, estimate.type(), truth.cols, truth.rows, truth.type()));
  }
  for (int row = 0; row < truth.rows; ++row) {
    const float* estimated = estimate.ptr<float>(row);
    const float* known = truth.ptr<float>(row);
    for (int column = 0; column < truth.cols; ++column) {
      if (!isDepth(known[column])) continue;
      const double depth = static_cast<double>(known[column]);
      const bool compared = isDepth(estimated[column]);
      const double error = compared ? static_cast<double>(estimated[column]) - depth : 0.0;
      for (std::size_t i = 0; i < within.size(); ++i) {
        if (depth > kLimits[i]) continue;
        Sums& sums = within[i];
        ++sums.true_pixels;
        if (!compared) continue;
        ++sums.compared;
        sums.absolute += std::abs(error);
        sums.squared += error * error;
      }
    }
  }
}

DepthErrors& DepthErrors::operator+=(const DepthErrors& other) {
  for (std::size_t i = 0; i < within.size(); ++i) {
    within[i].true_pixels += other.within[i].true_pixels;
    within[i].compared += other.within[i].compared;
    within[i].absolute += other.within[i].absolute;
    within[i].squared += other.within[i].squared;
  }
  return *this;
}

}  // namespace radar_dot::evaluation
