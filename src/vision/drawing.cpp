// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "drawing_parts.h"
#include "radar_dot/common/quantile.h"

namespace radar_dot {
namespace {

using drawing::Palette;

/// max_depth over the nearest depth that has a colour of its own.
constexpr double kDepthRange = 60.0;
constexpr std::size_t kMostVelocities = 8;
constexpr int kDepthSteps = 4096;
constexpr int kResidualSteps = 4096;
const cv::Scalar kStatic(70, 230, 60);
const cv::Scalar kDynamic(40, 40, 255);
// Magenta: few things in a street have that colour.
const cv::Vec3i kMask(230, 20, 255);
const cv::Scalar kContour(255, 110, 255);

/// Dark far, bright near.
const Palette& depthPalette() {
  static const Palette kPalette = drawing::paletteOf(cv::COLORMAP_PLASMA);
  return kPalette;
}

const Palette& residualPalette() {
  static const Palette kPalette = drawing::paletteOf(cv::COLORMAP_INFERNO);
  return kPalette;
}

/// Colours of depths 0..max_depth in equal steps: one look-up per pixel instead of a logarithm.
std::vector<cv::Vec3b> depthTable(double max_depth) {
  std::vector<cv::Vec3b> table;
  const double nearest = max_depth / kDepthRange;
  for (int i = 0; i <= kDepthSteps; ++i) {
    const double depth = std::max(nearest, max_depth * i / kDepthSteps);
    const double far = std::log(depth / nearest) / std::log(kDepthRange);
    table.push_back(depthPalette()[static_cast<std::size_t>(std::lround(255.0 * (1.0 - far)))]);
  }
  return table;
}

/// Colours of residuals 0..max in equal steps, on a scale of square roots.
const std::vector<cv::Vec3b>& residualTable() {
  static const std::vector<cv::Vec3b> kTable = [] {
    std::vector<cv::Vec3b> table;
    for (int i = 0; i <= kResidualSteps; ++i) {
      const double share = std::sqrt(i / static_cast<double>(kResidualSteps));
      table.push_back(residualPalette()[static_cast<std::size_t>(std::lround(255.0 * share))]);
    }
    return table;
  }();
  return kTable;
}

/// table[round(value * steps_per_unit)], the last entry for whatever is beyond.
cv::Mat lookUp(const cv::Mat& values, const cv::Vec3b* table, int last, double steps_per_unit,
               bool zero_is_known) {
  const auto factor = static_cast<float>(steps_per_unit);
  const auto end = static_cast<float>(last);
  cv::Mat picture(values.size(), CV_8UC3);
  for (int v = 0; v < values.rows; ++v) {
    const auto* row = values.ptr<float>(v);
    auto* out = picture.ptr<cv::Vec3b>(v);
    for (int u = 0; u < values.cols; ++u) {
      const float value = row[u];
      const bool known = std::isfinite(value) && (zero_is_known ? value >= 0.0F : value > 0.0F);
      out[u] = known ? table[static_cast<int>(std::min(value * factor, end) + 0.5F)] : drawing::kUnknown;
    }
  }
  return picture;
}

double residualScale(const cv::Mat& residual) {
  std::vector<float> values;
  const int step = drawing::sampleStep(residual.size());
  for (int v = step / 2; v < residual.rows; v += step) {
    const auto* row = residual.ptr<float>(v);
    for (int u = step / 2; u < residual.cols; u += step)
      if (std::isfinite(row[u])) values.push_back(row[u]);
  }
  return drawing::roundScaleUp(static_cast<double>(quantileOf(values, 0.98)));
}

/// Static before dynamic, far before near: what matters most is drawn last.
std::vector<RadarPixel> visibleInOrder(const std::vector<RadarPixel>& points, const cv::Size& size) {
  std::vector<RadarPixel> visible;
  for (const RadarPixel& point : points) {
    const cv::Point2f p = point.pixel;
    const bool inside = p.x >= -0.5F && p.y >= -0.5F && p.x < static_cast<float>(size.width) - 0.5F &&
                        p.y < static_cast<float>(size.height) - 0.5F;
    if (inside && point.depth > 0.0F) visible.push_back(point);
  }
  std::stable_sort(visible.begin(), visible.end(), [](const RadarPixel& a, const RadarPixel& b) {
    return a.dynamic != b.dynamic ? b.dynamic : a.depth > b.depth;
  });
  return visible;
}

/// Boxes of `size` right of, left of, above and below a return.
std::vector<cv::Rect> boxesBeside(const RadarPixel& point, const cv::Size& size, double unit) {
  const cv::Point centre(cvRound(point.pixel.x), cvRound(point.pixel.y));
  const int gap = cvRound(10.0 * unit);
  const int x = centre.x - size.width / 2;
  const int y = centre.y - size.height / 2;
  return {{{centre.x + gap, y}, size},
          {{centre.x - gap - size.width, y}, size},
          {{x, centre.y - gap - size.height}, size},
          {{x, centre.y + gap}, size}};
}

/// Velocities of the fastest dynamic returns, as many as have room beside other returns and each other.
void writeVelocities(cv::Mat& picture, const std::vector<RadarPixel>& points, double unit) {
  std::vector<RadarPixel> fastest;
  std::copy_if(points.begin(), points.end(), std::back_inserter(fastest),
               [](const RadarPixel& p) { return p.dynamic && std::isfinite(p.residual); });
  std::stable_sort(fastest.begin(), fastest.end(), [](const RadarPixel& a, const RadarPixel& b) {
    return std::fabs(a.residual) > std::fabs(b.residual);
  });
  const double text_unit = 0.85 * unit;
  const cv::Rect frame(cv::Point(), picture.size());
  std::vector<cv::Rect> taken;
  const auto isFree = [&](const cv::Rect& box) {
    const int space = cvRound(5.0 * unit);
    const cv::Rect wide(box.x - space, box.y - space, box.width + 2 * space, box.height + 2 * space);
    return (box & frame) == box &&
           std::none_of(taken.begin(), taken.end(),
                        [&](const cv::Rect& other) { return (other & wide).area() > 0; }) &&
           std::none_of(points.begin(), points.end(), [&](const RadarPixel& p) {
             return wide.contains(cv::Point(cvRound(p.pixel.x), cvRound(p.pixel.y)));
           });
  };
  for (const RadarPixel& point : fastest) {
    if (taken.size() == kMostVelocities) return;
    const std::string text = fmt::format("{:+.1f}", static_cast<double>(point.residual));
    const auto boxes = boxesBeside(point, drawing::textSize(text, text_unit), unit);
    const auto box = std::find_if(boxes.begin(), boxes.end(), isFree);
    if (box == boxes.end()) continue;
    taken.push_back(*box);
    drawing::writeText(picture, text, {box->x, box->br().y}, text_unit, cv::Scalar::all(255));
  }
}

/// On the grid of the picture, 255 where the mask is not 0.
cv::Mat binaryOn(const cv::Mat& mask, const cv::Size& size) {
  cv::Mat resized = mask;
  if (mask.size() != size) cv::resize(mask, resized, size, 0.0, 0.0, cv::INTER_NEAREST);
  return resized != 0;
}

void hatchExcluded(cv::Mat& picture, const cv::Mat& valid, int period) {
  for (int v = 0; v < picture.rows; ++v) {
    const auto* is_valid = valid.ptr<uchar>(v);
    auto* pixel = picture.ptr<uchar>(v);
    int phase = v % period;
    for (int u = 0; u < picture.cols; ++u, pixel += 3) {
      const int add = phase == 0 ? 40 : 0;
      if (++phase == period) phase = 0;
      if (is_valid[u] != 0) continue;
      for (int c = 0; c < 3; ++c) pixel[c] = static_cast<uchar>((pixel[c] * 5 >> 3) + add);
    }
  }
}

void tint(cv::Mat& picture, const cv::Mat& marked) {
  for (int v = 0; v < picture.rows; ++v) {
    const auto* is_marked = marked.ptr<uchar>(v);
    auto* pixel = picture.ptr<uchar>(v);
    for (int u = 0; u < picture.cols; ++u, pixel += 3) {
      if (is_marked[u] == 0) continue;
      for (int c = 0; c < 3; ++c) pixel[c] = static_cast<uchar>((pixel[c] * 5 + kMask[c] * 3) >> 3);
    }
  }
}

}  // namespace

cv::Mat drawDepth(const cv::Mat& depth, double max_depth) {
  drawing::requireType(depth, CV_32FC1, "depth");
  drawing::requireScale(max_depth, false, "max_depth");
  cv::Mat picture = lookUp(depth, depthTable(max_depth).data(), kDepthSteps, kDepthSteps / max_depth, false);
  Palette near_to_far;
  std::reverse_copy(depthPalette().begin(), depthPalette().end(), near_to_far.begin());
  std::vector<drawing::Tick> ticks;
  for (double decade = 0.01; decade < max_depth; decade *= 10.0) {
    for (const double step : {1.0, 2.0, 5.0}) {
      const double position = 1.0 + std::log(step * decade / max_depth) / std::log(kDepthRange);
      if (position >= -1e-9 && position <= 1.0 + 1e-9)
        ticks.push_back({position, drawing::shortNumber(step * decade)});
    }
  }
  drawing::drawScaleBar(picture, near_to_far, ticks, "m");
  return picture;
}

cv::Mat drawResidual(const cv::Mat& residual, double max, const std::string& unit) {
  drawing::requireType(residual, CV_32FC1, "residual");
  drawing::requireScale(max, true, "max");
  const double scale = max > 0.0 ? max : residualScale(residual);
  cv::Mat picture = lookUp(residual, residualTable().data(), kResidualSteps, kResidualSteps / scale, true);
  drawing::drawScaleBar(picture, residualPalette(),
                        {{0.0, "0"},
                         {std::sqrt(0.05), drawing::shortNumber(0.05 * scale)},
                         {0.5, drawing::shortNumber(0.25 * scale)},
                         {1.0, drawing::shortNumber(scale)}},
                        unit);
  return picture;
}

cv::Mat drawRadar(const cv::Mat& image, const std::vector<RadarPixel>& points) {
  cv::Mat picture = drawing::bgrCopy(image, "image");
  picture.convertTo(picture, -1, 0.45);
  const double unit = drawing::unitOf(picture.size());
  const std::vector<RadarPixel> visible = visibleInOrder(points, picture.size());
  constexpr int kShift = 4;  // binary places of the coordinates that OpenCV is given
  for (const RadarPixel& point : visible) {
    const double radius = std::max(1.5, unit * (2.2 + 50.0 / (point.depth + 4.0)));
    const cv::Point centre(cvRound(16.0F * point.pixel.x), cvRound(16.0F * point.pixel.y));
    const auto disc = [&](double r, const cv::Scalar& colour) {
      cv::circle(picture, centre, cvRound(16.0 * r), colour, cv::FILLED, cv::LINE_AA, kShift);
    };
    disc(radius + std::max(1.0, unit), point.dynamic ? cv::Scalar::all(255) : cv::Scalar());
    disc(radius, point.dynamic ? kDynamic : kStatic);
  }
  if (drawing::isReadable(picture.size())) writeVelocities(picture, visible, unit);
  return picture;
}

cv::Mat overlayMask(const cv::Mat& image, const cv::Mat& mask, const cv::Mat& valid) {
  cv::Mat picture = drawing::bgrCopy(image, "image");
  const double unit = drawing::unitOf(picture.size());
  if (!valid.empty()) {
    drawing::requireType(valid, CV_8UC1, "valid");
    hatchExcluded(picture, binaryOn(valid, picture.size()), std::max(4, cvRound(8.0 * unit)));
  }
  if (mask.empty()) return picture;
  drawing::requireType(mask, CV_8UC1, "mask");
  const cv::Mat marked = binaryOn(mask, picture.size());
  tint(picture, marked);
  const int width = std::max(1, cvRound(unit));
  cv::Mat inside;
  cv::erode(marked, inside, cv::Mat::ones(2 * width + 1, 2 * width + 1, CV_8UC1));
  picture.setTo(kContour, marked & ~inside);
  return picture;
}

}  // namespace radar_dot
