// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/depth_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace radar_dot::evaluation {
namespace {

constexpr double kWithinSigma = 0.6827;  // fraction of normal errors within 1 sigma

bool isDepth(float value) { return std::isfinite(value) && value > 0.0F; }

}  // namespace

void NormalisedErrors::add(double ratio) {
  if (!(ratio >= 0.0)) return;
  const double bin = kPerDecade * (std::log10(ratio) - kLowest);  // -infinity for no error at all
  const auto last = static_cast<double>(counts_.size() - 1);
  ++counts_[static_cast<std::size_t>(std::clamp(bin, 0.0, last))];
}

void NormalisedErrors::describe(Figures& figures) {
  figures.figure("sigma_median", quantile(0.5));
  figures.figure("sigma_68", quantile(kWithinSigma));
  figures.part(counts_);
}

std::uint64_t NormalisedErrors::count() const {
  return std::accumulate(counts_.begin(), counts_.end(), std::uint64_t{0});
}

double NormalisedErrors::quantile(double share) const {
  const std::uint64_t all = count();
  if (all == 0) return std::numeric_limits<double>::quiet_NaN();
  const double wanted = share * static_cast<double>(all);
  std::uint64_t below = 0;
  std::size_t bin = 0;
  while (bin + 1 < counts_.size() && static_cast<double>(below + counts_[bin]) < wanted)
    below += counts_[bin++];
  return std::pow(10.0, kLowest + (static_cast<double>(bin) + 0.5) / kPerDecade);
}

double DepthErrors::Sums::meanAbsoluteError() const { return ratio(absolute, compared); }

double DepthErrors::Sums::rootMeanSquaredError() const { return std::sqrt(ratio(squared, compared)); }

double DepthErrors::Sums::coverage() const { return ratio(compared, true_pixels); }

void DepthErrors::Sums::describe(Figures& figures) {
  figures.figure("mae", meanAbsoluteError());
  figures.figure("rmse", rootMeanSquaredError());
  figures.figure("coverage", coverage());
  figures.sum("true_pixels", true_pixels);
  figures.sum("compared", compared);
  figures.part(absolute);
  figures.part(squared);
}

void DepthErrors::add(const cv::Mat& estimate, const cv::Mat& truth, const cv::Mat& relative_std) {
  if (estimate.type() != CV_32FC1 || truth.type() != CV_32FC1 || estimate.size() != truth.size()) {
    throw std::invalid_argument(fmt::format(
        "depth errors: the estimate is {}x{} of type {}, the truth {}x{} of type {}; both must be CV_32FC1 "
        "and of one size",
        estimate.cols, estimate.rows, estimate.type(), truth.cols, truth.rows, truth.type()));
  }
  if (!relative_std.empty() && (relative_std.type() != CV_32FC1 || relative_std.size() != truth.size()))
    throw std::invalid_argument("depth errors: relative_std must be CV_32FC1 and of the size of the truth");
  for (int row = 0; row < truth.rows; ++row) {
    const float* estimated = estimate.ptr<float>(row);
    const float* stds = relative_std.empty() ? nullptr : relative_std.ptr<float>(row);
    const float* known = truth.ptr<float>(row);
    for (int column = 0; column < truth.cols; ++column) {
      if (!isDepth(known[column])) continue;
      const double depth = static_cast<double>(known[column]);
      const bool compared = isDepth(estimated[column]);
      const double error = compared ? static_cast<double>(estimated[column]) - depth : 0.0;
      // 1 - rho_true / rho_est
      if (stds != nullptr && compared && depth <= kLimits.back())
        normalised.add(std::abs(error / depth) / static_cast<double>(stds[column]));
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

void DepthErrors::describe(Figures& figures) {
  for (std::size_t i = 0; i < within.size(); ++i)
    figures.group(within[i], fmt::format("_{:.0f}", kLimits[i]));
  figures.group(normalised);
}

}  // namespace radar_dot::evaluation
