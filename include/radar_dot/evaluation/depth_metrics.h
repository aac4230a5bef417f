// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>

namespace radar_dot::evaluation {

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
    double coverage() const;              ///< estimated share of the true pixels; NaN where there are none
  };
  std::array<Sums, kLimits.size()> within;  ///< one per limit, a pixel counting in all it is within

  /// Adds one picture. @throws std::invalid_argument unless both are CV_32FC1 and of one size.
  void add(const cv::Mat& estimate, const cv::Mat& truth);
  DepthErrors& operator+=(const DepthErrors& other);
};

}  // namespace radar_dot::evaluation
