// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "radar_dot/evaluation/figures.h"
#include "radar_dot/vision/optical_flow.h"

namespace radar_dot::evaluation {

/// End-point errors of a flow against the true one, px OF THE FULL IMAGE, whatever grid they are found on.
/// These are sums, so that pictures and scenes add up.
struct FlowErrors {
  /// KITTI's outlier: off by more than 3 px and by more than 5 % of the true flow's length.
  static constexpr double kOutlierError = 3.0;  ///< px
  static constexpr double kOutlierShare = 0.05;

  /// Errors of a group of pixels.
  class Group {
   public:
    std::uint64_t true_pixels = 0;  ///< of the grid, whose true flow is valid
    std::uint64_t compared = 0;     ///< of these, with a flow that is valid and finite
    std::uint64_t outliers = 0;     ///< of `compared`
    double sum = 0.0;               ///< px, over `compared`

    double mean() const;          ///< px; NaN where nothing was compared
    double median() const;        ///< px, to 0.3 % or 0.001 px; NaN where nothing was compared
    double outlierShare() const;  ///< of `compared`, KITTI's Fl; NaN where nothing was compared
    double density() const;       ///< fraction of the true pixels that was compared; NaN where there are none

    /// One pixel that was compared; `true_pixels` is the caller's. @param error  px  @param length  px, of
    /// the true flow
    void add(double error, double length);
    void describe(Figures& figures);

   private:
    // Of equal ratio, because a median is asked for in hundredths of a pixel as well as in tens, and pixels
    // are too many to be kept.
    static constexpr int kBinsPerOctave = 128;
    static constexpr int kFirstOctave = -10;
    static constexpr int kOctaves = 24;
    static std::size_t binOf(double error);
    /// Below 2^kFirstOctave; the bins; 2^(kFirstOctave + kOctaves) and more.
    std::array<std::uint64_t, kBinsPerOctave * kOctaves + 2> bins_{};
  };
  Group all;
  Group still;   ///< pixels that do not move independently
  Group moving;  ///< pixels that do

  /// Adds one picture. Pixels whose true flow is not valid take no part.
  /// @param estimate,truth  on one grid, px of the grid; a flow that is not finite is as one not valid
  /// @param movers  CV_8UC1 of the grid, not 0 = moves independently; empty: not known, counts in `all` only
  /// @param image   px, size of the full image
  /// @throws std::invalid_argument for other types or sizes, or an image without pixels.
  void add(const FlowField& estimate, const FlowField& truth, const cv::Mat& movers, const cv::Size& image);
  void describe(Figures& figures);
};

}  // namespace radar_dot::evaluation
