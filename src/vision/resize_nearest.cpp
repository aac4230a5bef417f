// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "resize_nearest.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace radar_dot {
namespace {

int sourceOf(int pixel, std::int64_t from, int to) {
  const std::int64_t step = ((from << 16) + to / 2) / to;  // 16 bits behind the point, as in OpenCV
  return static_cast<int>(std::min((step * pixel + step / 2 - (from + 1) % 2) >> 16, from - 1));
}

template <std::size_t kBytes>
void fill(const cv::Mat& image, cv::Mat& resized) {
  using Pixel = std::array<std::uint8_t, kBytes>;
  std::vector<int> columns;
  for (int column = 0; column < resized.cols; ++column)
    columns.push_back(sourceOf(column, image.cols, resized.cols));
  int filled = -1;  // row of the image that the row before was filled from
  for (int row = 0; row < resized.rows; ++row) {
    const int source = sourceOf(row, image.rows, resized.rows);
    const auto* from = image.ptr<Pixel>(source);
    auto* to = resized.ptr<Pixel>(row);
    if (source == filled) {
      std::copy_n(resized.ptr<Pixel>(row - 1), resized.cols, to);
    } else {
      for (const int column : columns) *to++ = from[column];
    }
    filled = source;
  }
}

}  // namespace

cv::Mat resizeNearest(const cv::Mat& image, const cv::Size& size) {
  if (image.empty() || image.size() == size) return image;
  cv::Mat resized(size, image.type());
  switch (image.elemSize()) {
    case 1: fill<1>(image, resized); break;
    case 4: fill<4>(image, resized); break;
    case 8: fill<8>(image, resized); break;
    default: CV_Error(cv::Error::StsUnsupportedFormat, "nearest: neither bytes nor one or two floats");
  }
  return resized;
}

}  // namespace radar_dot
