// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "mask_box.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace radar_dot::dataset {

// Not cv::boundingRect: that of OpenCV 4.6 loses columns of images a few pixels wide.
cv::Rect boundingBox(const cv::Mat& mask) {
  const auto width = static_cast<std::size_t>(mask.cols);
  std::vector<std::uint8_t> columns(width, 0);  // all rows on top of each other
  int first_row = mask.rows;
  int last_row = -1;
  for (int row = 0; row < mask.rows; ++row) {
    const std::uint8_t* pixels = mask.ptr<std::uint8_t>(row);
    std::uint8_t any = 0;
    for (std::size_t column = 0; column < width; ++column) any |= pixels[column];
    if (any == 0) continue;
    first_row = std::min(first_row, row);
    last_row = row;
    for (std::size_t column = 0; column < width; ++column) columns[column] |= pixels[column];
  }
  if (last_row < 0) return {};
  const auto is_set = [](std::uint8_t value) { return value != 0; };
  const auto left = std::find_if(columns.begin(), columns.end(), is_set);
  const auto right = std::find_if(columns.rbegin(), columns.rend(), is_set).base();
  return {static_cast<int>(left - columns.begin()), first_row, static_cast<int>(right - left),
          last_row - first_row + 1};
}

}  // namespace radar_dot::dataset
