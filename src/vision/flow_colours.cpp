// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <vector>

#include "drawing_parts.h"
#include "radar_dot/common/quantile.h"
#include "radar_dot/vision/drawing.h"

namespace radar_dot {
namespace {

constexpr int kRadius = 128;
constexpr int kSide = 2 * kRadius + 1;

/// The wheel has 55 steps from red over yellow, green, cyan, blue and magenta back to red; the numbers of
/// steps between them (S. Baker et al., "A Database and Evaluation Methodology for Optical Flow", IJCV 2011)
/// make equal angles look about equally different.
cv::Vec3f wheelColour(double angle) {
  struct Corner {
    double step;
    cv::Vec3f bgr;
  };
  static const Corner kCorners[] = {{0, {0, 0, 255}},    {15, {0, 255, 255}}, {21, {0, 255, 0}},
                                    {25, {255, 255, 0}}, {36, {255, 0, 0}},   {49, {255, 0, 255}},
                                    {55, {0, 0, 255}}};
  const double turn = angle / (2.0 * CV_PI);
  const double step = 55.0 * (turn - std::floor(turn));
  const Corner* next = kCorners + 1;
  while (step > next->step) ++next;
  const Corner* last = next - 1;
  const auto share = static_cast<float>((step - last->step) / (next->step - last->step));
  return last->bgr + share * (next->bgr - last->bgr);
}

/// Colours of all flows on a grid over the square -1..1 of the largest magnitude: one look-up per pixel
/// instead of an angle.
std::vector<cv::Vec3b> makeTable() {
  std::vector<cv::Vec3b> table;
  table.reserve(static_cast<std::size_t>(kSide) * kSide);
  for (int y = -kRadius; y <= kRadius; ++y) {
    for (int x = -kRadius; x <= kRadius; ++x) {
      const auto magnitude = static_cast<float>(std::min(1.0, std::hypot(x, y) / kRadius));
      const cv::Vec3f white(255.0F, 255.0F, 255.0F);
      const cv::Vec3f colour = white + magnitude * (wheelColour(std::atan2(y, x)) - white);
      table.emplace_back(cv::saturate_cast<uchar>(colour[0]), cv::saturate_cast<uchar>(colour[1]),
                         cv::saturate_cast<uchar>(colour[2]));
    }
  }
  return table;
}

/// @param x, y  flow in units of the largest magnitude
cv::Vec3b flowColour(const std::vector<cv::Vec3b>& table, float x, float y) {
  const float square = x * x + y * y;
  if (!(square <= 1.0F)) {
    if (!(square < std::numeric_limits<float>::infinity())) return drawing::kUnknown;
    const float shorten = 1.0F / std::sqrt(square);
    x *= shorten;
    y *= shorten;
  }
  const int column = static_cast<int>(x * kRadius + (kRadius + 0.5F));
  const int row = static_cast<int>(y * kRadius + (kRadius + 0.5F));
  return table[static_cast<std::size_t>(row * kSide + column)];
}

const std::vector<cv::Vec3b>& colourTable() {
  static const std::vector<cv::Vec3b> kTable = makeTable();
  return kTable;
}

void sampleMagnitudes(const cv::Mat& flow, std::vector<float>& magnitudes) {
  const int step = drawing::sampleStep(flow.size());
  for (int v = step / 2; v < flow.rows; v += step) {
    const auto* row = flow.ptr<cv::Vec2f>(v);
    for (int u = step / 2; u < flow.cols; u += step) {
      const float magnitude = std::sqrt(row[u][0] * row[u][0] + row[u][1] * row[u][1]);
      if (std::isfinite(magnitude)) magnitudes.push_back(magnitude);
    }
  }
}

}  // namespace

double flowScale(const cv::Mat& flow, const cv::Mat& other) {
  std::vector<float> magnitudes;
  if (!flow.empty()) {
    drawing::requireType(flow, CV_32FC2, "flow");
    sampleMagnitudes(flow, magnitudes);
  }
  if (!other.empty()) {
    drawing::requireType(other, CV_32FC2, "other");
    sampleMagnitudes(other, magnitudes);
  }
  return drawing::roundScaleUp(static_cast<double>(quantileOf(magnitudes, 0.98)));
}

cv::Mat drawFlow(const cv::Mat& flow, double max_flow) {
  drawing::requireType(flow, CV_32FC2, "flow");
  drawing::requireScale(max_flow, true, "max_flow");
  const auto scale = static_cast<float>(1.0 / (max_flow > 0.0 ? max_flow : flowScale(flow)));
  const std::vector<cv::Vec3b>& table = colourTable();
  cv::Mat picture(flow.size(), CV_8UC3);
  for (int v = 0; v < flow.rows; ++v) {
    const auto* row = flow.ptr<cv::Vec2f>(v);
    auto* out = picture.ptr<cv::Vec3b>(v);
    for (int u = 0; u < flow.cols; ++u) out[u] = flowColour(table, scale * row[u][0], scale * row[u][1]);
  }
  return picture;
}

cv::Mat drawFlowLegend(int size, double max_flow) {
  if (size < 24) throw std::invalid_argument(fmt::format("size is {}: it must be 24 px or more", size));
  drawing::requireScale(max_flow, false, "max_flow");
  const double unit = size / 110.0;
  const int line = drawing::lineHeight(unit);
  const bool has_text = size >= 3 * line;
  const double diameter = size - (has_text ? line : 0) - 4;
  const double centre_x = 0.5 * (size - 1);
  const double centre_y = 0.5 * diameter + 1.5;
  const double radius = 0.5 * diameter;
  cv::Mat legend(size, size, CV_8UC3, cv::Scalar::all(24));
  for (int v = 0; v < size; ++v) {
    for (int u = 0; u < size; ++u) {
      const double x = (u - centre_x) / radius;
      const double y = (v - centre_y) / radius;
      const double cover = std::clamp((1.0 - std::hypot(x, y)) * radius + 0.5, 0.0, 1.0);
      if (cover == 0.0) continue;
      const cv::Vec3b colour = flowColour(colourTable(), static_cast<float>(x), static_cast<float>(y));
      legend.at<cv::Vec3b>(v, u) = cover * colour + (1.0 - cover) * legend.at<cv::Vec3b>(v, u);
    }
  }
  if (has_text) {
    const std::string text = drawing::shortNumber(max_flow) + " px";
    const cv::Size extent = drawing::textSize(text, unit);
    drawing::writeText(legend, text, {(size - extent.width) / 2, size - drawing::baseOffset(unit)}, unit,
                       cv::Scalar::all(245));
  }
  return legend;
}

}  // namespace radar_dot
