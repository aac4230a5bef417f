// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "drawing_parts.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace radar_dot::drawing {
namespace {

constexpr int kFont = cv::FONT_HERSHEY_SIMPLEX;
const cv::Scalar kLight(245, 245, 245);
const cv::Scalar kDark(20, 20, 20);

double fontScale(double unit) { return std::max(0.42, 0.52 * unit); }
int strokeWidth(double unit) { return std::max(1, static_cast<int>(std::lround(unit))); }

std::string typeName(int type) {
  switch (type) {
    case CV_8UC1: return "CV_8UC1";
    case CV_8UC3: return "CV_8UC3";
    case CV_32FC1: return "CV_32FC1";
    case CV_32FC2: return "CV_32FC2";
    default: return fmt::format("type {} with {} channels", CV_MAT_DEPTH(type), CV_MAT_CN(type));
  }
}

void darken(cv::Mat& picture, const cv::Rect& box) {
  cv::Mat part = picture(box & cv::Rect(cv::Point(), picture.size()));
  part.convertTo(part, -1, 0.3);
}

/// How far the last label reaches beyond the end of the bar.
int overhangOf(const std::vector<Tick>& ticks, int bar_width, double unit) {
  if (ticks.empty()) return 0;
  const double to_end = (1.0 - ticks.back().position) * bar_width;
  return std::max(0, static_cast<int>(0.5 * textSize(ticks.back().label, unit).width - to_end));
}

}  // namespace

void requireType(const cv::Mat& image, int type, const std::string& argument) {
  if (image.empty())
    throw std::invalid_argument(fmt::format("{} is empty: give a {}", argument, typeName(type)));
  if (image.type() == type) return;
  throw std::invalid_argument(
      fmt::format("{} is a {}: convert it to {}", argument, typeName(image.type()), typeName(type)));
}

void requireScale(double value, bool zero_allowed, const std::string& argument) {
  if (std::isfinite(value) && (value > 0.0 || (zero_allowed && value == 0.0))) return;
  throw std::invalid_argument(fmt::format("{} is {}: it must be positive{}", argument, value,
                                          zero_allowed ? ", or 0 to take it from the values" : ""));
}

cv::Mat bgrCopy(const cv::Mat& image, const std::string& argument) {
  if (image.type() != CV_8UC1 || image.empty()) requireType(image, CV_8UC3, argument);
  cv::Mat copy;
  if (image.channels() == 1) {
    cv::cvtColor(image, copy, cv::COLOR_GRAY2BGR);
  } else {
    copy = image.clone();
  }
  return copy;
}

Palette paletteOf(int colour_map) {
  cv::Mat ramp(1, 256, CV_8UC1);
  for (int i = 0; i < 256; ++i) ramp.at<uchar>(0, i) = static_cast<uchar>(i);
  cv::Mat colours;
  cv::applyColorMap(ramp, colours, colour_map);
  Palette palette;
  for (int i = 0; i < 256; ++i) palette[static_cast<std::size_t>(i)] = colours.at<cv::Vec3b>(0, i);
  return palette;
}

double unitOf(const cv::Size& size) { return std::min(size.width / 640.0, size.height / 360.0); }

bool isReadable(const cv::Size& size) { return size.width >= 200 && size.height >= 110; }

cv::Size textSize(const std::string& text, double unit) {
  int base_line = 0;
  return cv::getTextSize(text, kFont, fontScale(unit), strokeWidth(unit), &base_line);
}

int baseOffset(double unit) { return static_cast<int>(std::lround(13.0 * fontScale(unit))); }

int lineHeight(double unit) { return static_cast<int>(std::lround(34.0 * fontScale(unit))); }

void writeText(cv::Mat& picture, const std::string& text, const cv::Point& origin, double unit,
               const cv::Scalar& colour) {
  const int width = strokeWidth(unit);
  cv::putText(picture, text, origin, kFont, fontScale(unit), kDark, width + 2, cv::LINE_AA);
  cv::putText(picture, text, origin, kFont, fontScale(unit), colour, width, cv::LINE_AA);
}

void writeTitle(cv::Mat& picture, const std::string& text, const cv::Point& corner, double unit) {
  const cv::Size size = textSize(text, unit);
  const int height = lineHeight(unit) + 4;
  const int margin = height / 3;
  darken(picture, {corner, cv::Size(size.width + 2 * margin, height)});
  const cv::Point origin(corner.x + margin, corner.y + (height + size.height) / 2 - 1);
  cv::putText(picture, text, origin, kFont, fontScale(unit), kLight, strokeWidth(unit), cv::LINE_AA);
}

void writeCentred(cv::Mat& picture, const std::string& text, double unit) {
  const cv::Size size = textSize(text, 1.3 * unit);
  const cv::Point origin((picture.cols - size.width) / 2, (picture.rows + size.height) / 2);
  cv::putText(picture, text, origin, kFont, fontScale(1.3 * unit), cv::Scalar(170, 170, 170),
              strokeWidth(1.3 * unit), cv::LINE_AA);
}

void drawScaleBar(cv::Mat& picture, const Palette& palette, const std::vector<Tick>& ticks,
                  const std::string& unit_name) {
  if (!isReadable(picture.size())) return;
  const double unit = unitOf(picture.size());
  const cv::Size name = textSize(unit_name, unit);
  const int line = lineHeight(unit);
  const int margin = line / 2;
  const int width = static_cast<int>(0.36 * picture.cols);
  const int overhang = overhangOf(ticks, width, unit);
  const int thickness = std::max(6, static_cast<int>(std::lround(10.0 * unit)));
  const cv::Size box_size(width + overhang + name.width + 5 * margin / 2, line + thickness + margin + 4);
  const cv::Rect box(cv::Point(picture.cols - box_size.width, picture.rows - box_size.height), box_size);
  darken(picture, box);
  const cv::Rect bar(box.x + margin, box.y + margin, width, thickness);
  for (int x = 0; x < width; ++x) {
    picture(cv::Rect(bar.x + x, bar.y, 1, thickness))
        .setTo(palette[static_cast<std::size_t>(255 * x / (width - 1))]);
  }
  const int base = box.br().y - baseOffset(unit);
  const auto write = [&](const std::string& text, int x) {
    cv::putText(picture, text, {x, base}, kFont, fontScale(unit), kLight, strokeWidth(unit), cv::LINE_AA);
  };
  for (const Tick& tick : ticks) {
    const int x = bar.x + static_cast<int>(std::lround(tick.position * (width - 1)));
    picture(cv::Rect(x, bar.br().y, 1, 3)).setTo(kLight);
    write(tick.label, std::max(x - textSize(tick.label, unit).width / 2, box.x + 2));
  }
  write(unit_name, bar.br().x + overhang + margin / 2 + 1);
}

double roundScaleUp(double value) {
  if (!(value > 1.0)) return 1.0;
  const double decade = std::pow(10.0, std::floor(std::log10(value)));
  for (const double step : {1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0}) {
    if (value <= step * decade * (1.0 + 1e-6)) return step * decade;
  }
  return 10.0 * decade;
}

int sampleStep(const cv::Size& size) {
  return std::max(1, static_cast<int>(std::sqrt(size.width * static_cast<double>(size.height) / 20000.0)));
}

std::string shortNumber(double value) { return fmt::format("{:.4g}", value); }

}  // namespace radar_dot::drawing
