// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <opencv2/core.hpp>
#include <stdexcept>

#include "mask_box.h"
#include "radar_dot/dataset/instance_masks.h"

// COCO's text is a row of signed numbers in groups of five bits, least significant group first: bit
// 5 of a character says that another group follows, bit 4 of the last group is the sign, and 48 is
// added to make it printable. From the fourth run on, the number is the difference to the run two
// places before.

namespace radar_dot::dataset {
namespace {

constexpr int kFirstCharacter = 48;
constexpr std::int64_t kMoreFollow = 0x20;
constexpr std::int64_t kSign = 0x10;
constexpr int kMaxGroups = 7;  ///< 35 bits hold the difference of any two runs
constexpr std::size_t kFirstDifference = 3;

std::int64_t readNumber(std::string_view counts, std::size_t& position) {
  std::int64_t number = 0;
  for (int group = 0; group < kMaxGroups; ++group) {
    if (position == counts.size()) throw std::invalid_argument("run lengths end inside a number");
    const std::int64_t bits = counts[position] - kFirstCharacter;
    if (bits < 0 || bits > 0x3f)
      throw std::invalid_argument(
          fmt::format("character {} of the run lengths is not of COCO's alphabet", position));
    ++position;
    number += (bits & 0x1f) * (std::int64_t{1} << (5 * group));
    if ((bits & kMoreFollow) == 0)
      return (bits & kSign) != 0 ? number - (std::int64_t{1} << (5 * (group + 1))) : number;
  }
  throw std::invalid_argument(fmt::format("character {} of the run lengths: number too long", position));
}

void appendNumber(std::string& text, std::int64_t number) {
  for (;;) {
    std::int64_t bits = number & 0x1f;
    number >>= 5;
    const bool done = (bits & kSign) != 0 ? number == -1 : number == 0;
    if (!done) bits |= kMoreFollow;
    text.push_back(static_cast<char>(bits + kFirstCharacter));
    if (done) return;
  }
}

void requireFullCanvas(const RunLengthMask& mask) {
  std::uint64_t sum = 0;
  for (const std::uint32_t run : mask.counts) sum += run;
  if (mask.rows < 0 || mask.columns < 0 ||
      sum != static_cast<std::uint64_t>(mask.rows) * static_cast<std::uint64_t>(mask.columns))
    throw std::invalid_argument(
        fmt::format("run lengths add up to {}, not to {} x {}", sum, mask.rows, mask.columns));
}

}  // namespace

RunLengthMask parseRunLengths(std::string_view counts, int rows, int columns) {
  RunLengthMask mask{rows, columns, {}};
  for (std::size_t position = 0; position < counts.size();) {
    const std::size_t start = position;
    std::int64_t run = readNumber(counts, position);
    if (mask.counts.size() >= kFirstDifference) run += mask.counts[mask.counts.size() - 2];
    if (run < 0 || run > UINT32_MAX)
      throw std::invalid_argument(fmt::format("character {} of the run lengths: a run of {}", start, run));
    mask.counts.push_back(static_cast<std::uint32_t>(run));
  }
  requireFullCanvas(mask);
  return mask;
}

std::string formatRunLengths(const RunLengthMask& mask) {
  std::string text;
  for (std::size_t i = 0; i < mask.counts.size(); ++i) {
    std::int64_t number = mask.counts[i];
    if (i >= kFirstDifference) number -= mask.counts[i - 2];
    appendNumber(text, number);
  }
  return text;
}

cv::Mat decodeMask(const RunLengthMask& mask) {
  requireFullCanvas(mask);
  // Runs go down the columns, so they are contiguous in the transposed image.
  cv::Mat transposed(mask.columns, mask.rows, CV_8UC1);
  if (transposed.empty()) return cv::Mat(mask.rows, mask.columns, CV_8UC1);  // OpenCV does not turn nothing
  std::uint8_t* pixel = transposed.data;
  std::uint8_t value = 0;
  for (const std::uint32_t run : mask.counts) {
    std::fill_n(pixel, run, value);
    pixel += run;
    value = static_cast<std::uint8_t>(255 - value);
  }
  return transposed.t();
}

RunLengthMask encodeMask(const cv::Mat& mask) {
  if (mask.type() != CV_8UC1) throw std::invalid_argument("a mask must be a CV_8UC1 image");
  RunLengthMask result{mask.rows, mask.cols, {}};
  std::size_t run_start = 0;
  bool inside = false;
  const auto continueWith = [&](bool is_set, std::size_t position) {
    if (is_set == inside) return;
    result.counts.push_back(static_cast<std::uint32_t>(position - run_start));
    run_start = position;
    inside = is_set;
  };
  // Most masks are small: only the box around them is looked at pixel by pixel.
  const cv::Rect box = boundingBox(mask);
  const cv::Mat transposed = box.empty() ? cv::Mat() : cv::Mat(mask(box).t());
  const auto rows = static_cast<std::size_t>(mask.rows);
  for (int column = 0; column < box.width; ++column) {
    const std::size_t top = static_cast<std::size_t>(box.x + column) * rows;
    if (box.y > 0) continueWith(false, top);
    std::size_t position = top + static_cast<std::size_t>(box.y);
    const std::uint8_t* pixels = transposed.ptr<std::uint8_t>(column);
    for (int row = 0; row < box.height; ++row, ++position) continueWith(pixels[row] != 0, position);
    if (position < top + rows) continueWith(false, position);
  }
  if (box.br().x < mask.cols) continueWith(false, static_cast<std::size_t>(box.br().x) * rows);
  if (run_start < mask.total()) result.counts.push_back(static_cast<std::uint32_t>(mask.total() - run_start));
  return result;
}

}  // namespace radar_dot::dataset
