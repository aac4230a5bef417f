// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/flow_metrics.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace radar_dot::evaluation {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

void require(const cv::Mat& image, int type, const cv::Size& size, const char* name) {
  if (image.type() == type && image.size() == size && !image.empty()) return;
  throw std::invalid_argument(
      fmt::format("flow errors: {} is {}x{} of type {}; it must be {}x{} of type {} and not empty", name,
                  image.cols, image.rows, image.type(), size.width, size.height, type));
}

bool isKnown(const FlowField& field, int row, int column) {
  const auto& vector = field.flow.at<cv::Vec2f>(row, column);
  return (field.valid.empty() || field.valid.at<std::uint8_t>(row, column) != 0) &&
         std::isfinite(vector[0]) && std::isfinite(vector[1]);
}

}  // namespace

double FlowErrors::Group::mean() const { return ratio(sum, compared); }

double FlowErrors::Group::outlierShare() const { return ratio(outliers, compared); }

double FlowErrors::Group::density() const { return ratio(compared, true_pixels); }

std::size_t FlowErrors::Group::binOf(double error) {
  constexpr int kBins = kBinsPerOctave * kOctaves;
  if (!(error >= std::ldexp(1.0, kFirstOctave))) return 0;
  const double bin = std::floor(kBinsPerOctave * (std::log2(error) - kFirstOctave));
  return 1 + static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(kBins)));
}

double FlowErrors::Group::median() const {
  if (compared == 0) return kNaN;
  const std::uint64_t before = (compared - 1) / 2;
  std::uint64_t seen = bins_[0];
  if (seen > before) return 0.0;
  std::size_t bin = 0;
  while (seen <= before && bin + 1 < bins_.size()) seen += bins_[++bin];
  // The middle of the bin.
  return std::exp2((static_cast<double>(bin) - 0.5) / kBinsPerOctave + kFirstOctave);
}

void FlowErrors::Group::add(double error, double length) {
  ++compared;
  sum += error;
  if (error > kOutlierError && error > kOutlierShare * length) ++outliers;
  ++bins_[binOf(error)];
}

void FlowErrors::Group::describe(Figures& figures) {
  figures.figure("epe", mean());
  figures.figure("epe_median", median());
  figures.figure("fl", outlierShare());
  figures.figure("density", density());
  figures.sum("true_pixels", true_pixels);
  figures.sum("compared", compared);
  figures.part(outliers);
  figures.part(sum);
  figures.part(bins_);
}

void FlowErrors::add(const FlowField& estimate, const FlowField& truth, const cv::Mat& movers,
                     const cv::Size& image) {
  const cv::Size grid = truth.flow.size();
  require(truth.flow, CV_32FC2, grid, "the true flow");
  require(estimate.flow, CV_32FC2, grid, "the flow");
  if (!truth.valid.empty()) require(truth.valid, CV_8UC1, grid, "what is valid of the true flow");
  if (!estimate.valid.empty()) require(estimate.valid, CV_8UC1, grid, "what is valid of the flow");
  if (!movers.empty()) require(movers, CV_8UC1, grid, "the image of movers");
  if (image.width <= 0 || image.height <= 0) {
    throw std::invalid_argument(
        fmt::format("flow errors: the full image is {}x{} px", image.width, image.height));
  }
  const double scale_x = static_cast<double>(image.width) / grid.width;
  const double scale_y = static_cast<double>(image.height) / grid.height;
  const auto length = [&](const cv::Vec2f& vector) {
    return std::hypot(scale_x * static_cast<double>(vector[0]), scale_y * static_cast<double>(vector[1]));
  };
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      if (!isKnown(truth, row, column)) continue;
      Group* part = nullptr;
      if (!movers.empty()) part = movers.at<std::uint8_t>(row, column) != 0 ? &moving : &still;
      ++all.true_pixels;
      if (part != nullptr) ++part->true_pixels;
      if (!isKnown(estimate, row, column)) continue;
      const auto& wanted = truth.flow.at<cv::Vec2f>(row, column);
      const double error = length(estimate.flow.at<cv::Vec2f>(row, column) - wanted);
      all.add(error, length(wanted));
      if (part != nullptr) part->add(error, length(wanted));
    }
  }
}

void FlowErrors::describe(Figures& figures) {
  figures.group(all, "_all");
  figures.group(still, "_static");
  figures.group(moving, "_moving");
}

}  // namespace radar_dot::evaluation
