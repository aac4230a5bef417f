// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <opencv2/core/mat.hpp>
#include <opencv2/core/types.hpp>
#include <string>
#include <vector>

#include "radar_dot/vision/drawing.h"

namespace radar_dot::drawing {

using Palette = std::array<cv::Vec3b, 256>;
inline const cv::Vec3b kUnknown(64, 64, 64);

/// @throws std::invalid_argument naming `argument` when the image is empty or of another type.
void requireType(const cv::Mat& image, int type, const std::string& argument);
/// @throws std::invalid_argument unless value > 0, or value == 0 where that is allowed.
void requireScale(double value, bool zero_allowed, const std::string& argument);

/// A BGR copy. @throws std::invalid_argument naming `argument` unless CV_8UC3 or CV_8UC1.
cv::Mat bgrCopy(const cv::Mat& image, const std::string& argument);

/// Colour table of one of OpenCV's maps.
Palette paletteOf(int colour_map);

/// 1 for a picture of 640x360 px: what sizes of text and markers are multiplied by.
double unitOf(const cv::Size& size);
/// Is there room for text?
bool isReadable(const cv::Size& size);

/// Height of a line of text, px.
int lineHeight(double unit);
/// From the base line to the lower end of a line of text, px.
int baseOffset(double unit);
/// Text with a margin on a translucent dark box.
/// @param corner  of the box: its top left one
void writeTitle(cv::Mat& picture, const std::string& text, const cv::Point& corner, double unit);
/// Text in the middle of a picture.
void writeCentred(cv::Mat& picture, const std::string& text, double unit);
/// Light text, dark outline. @param origin  left end of the base line
void writeText(cv::Mat& picture, const std::string& text, const cv::Point& origin, double unit,
               const cv::Scalar& colour);
cv::Size textSize(const std::string& text, double unit);

struct Tick {
  double position;  ///< 0..1 along the bar
  std::string label;
};
/// A scale bar in the lower right corner, its unit right of it.
void drawScaleBar(cv::Mat& picture, const Palette& palette, const std::vector<Tick>& ticks,
                  const std::string& unit_name);

/// Rounded up to 1, 1.5, 2, 3, 4, 5, 6, 8 times a power of ten; at least 1.
double roundScaleUp(double value);
/// Pixels between two that are looked at so that about 20000 are.
int sampleStep(const cv::Size& size);
std::string shortNumber(double value);

}  // namespace radar_dot::drawing
