// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "radar_dot/evaluation/figures.h"

namespace radar_dot::evaluation {

/// Errors of the inverse depth in units of the sigma that the estimate declares, as a histogram: quantiles of
/// many pictures. Were the errors normal and the sigmas right, the median were 0.674 and the quantile of 68.3
/// % were 1.
class NormalisedErrors {
 public:
  /// @param ratio  |rho_est - rho_true| / (sigma rho_est), sigma as share; NaN does not count
  void add(double ratio);
  std::uint64_t count() const;
  /// To 1 %, between 0.001 and 10000; NaN where nothing was added. @param share  of the ratios below, 0 to 1
  double quantile(double share) const;
  void describe(Figures& figures);

 private:
  static constexpr int kPerDecade = 200;
  static constexpr int kLowest = -3, kHighest = 4;  // decades
  std::array<std::uint64_t, std::size_t{kPerDecade} * (kHighest - kLowest)> counts_{};
};

/// Errors of a depth against the true one, as JustDepth reports them: of the pixels whose true depth is
/// within 50, 70 and 80 m. These are sums, so that pictures and scenes add up. Unknown depth is NaN or not
/// positive.
struct DepthErrors {
  static constexpr std::array<double, 3> kLimits = {50.0, 70.0, 80.0};  ///< m

  struct Sums {
    std::uint64_t true_pixels = 0;  ///< whose true depth is known and within the limit
    std::uint64_t compared = 0;     ///< of these, estimated
    double absolute = 0.0;          ///< m, sum over `compared` of |error|
    double squared = 0.0;           ///< m^2

    double meanAbsoluteError() const;     ///< m; NaN where nothing was compared
    double rootMeanSquaredError() const;  ///< m; NaN where nothing was compared
    double coverage() const;              ///< estimated fraction of the true pixels; NaN where there are none
    void describe(Figures& figures);
  };
  std::array<Sums, kLimits.size()> within;  ///< one per limit, a pixel counting in all it is within
  NormalisedErrors normalised;              ///< of what was compared within the last limit

  /// Adds one image. @param relative_std  1 sigma of the estimate's inverse depth, relative; empty: not
  /// declared. @throws std::invalid_argument unless all are CV_32FC1 and of one size.
  void add(const cv::Mat& estimate, const cv::Mat& truth, const cv::Mat& relative_std = {});
  void describe(Figures& figures);
};

}  // namespace radar_dot::evaluation
