// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/messages/lazy_image.h"

#include <cstddef>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "radar_dot/vision/network_images.h"

namespace radar_dot {
namespace {

/// As the header of a JPEG says; empty: it is none, or an unusual one.
cv::Size jpegSizeOf(const std::vector<std::uint8_t>& bytes) {
  const auto word = [&bytes](std::size_t at) { return bytes[at] << 8U | bytes[at + 1]; };
  constexpr int kStart = 0xFFD8;
  if (bytes.size() < 2 || word(0) != kStart) return {};
  // Segments of a marker and their length, up to the one of the frame: length, precision, height, width.
  for (std::size_t at = 2; at + 9 <= bytes.size() && bytes[at] == 0xFF;
       at += 2 + static_cast<std::size_t>(word(at + 2))) {
    const int marker = bytes[at + 1];
    const bool is_frame =
        marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (is_frame) return {word(at + 7), word(at + 5)};
  }
  return {};
}

}  // namespace

cv::Size LazyImage::size() {
  if (raw_) return imageSizeOf(*raw_, "image");
  return size_.empty() ? pixels().size() : size_;
}

const cv::Mat& LazyImage::pixels() {
  if (picture_.pixels.empty()) picture_ = raw_ ? decodedImageOf(raw_) : decodedImageOf(*compressed_, kColour);
  return picture_.pixels;
}

/// Pixels from which those on the grid are made; notes the size of the whole image.
cv::Mat LazyImage::decodedFor(int working_width, int channels) {
  if (raw_ || !picture_.pixels.empty()) {
    size_ = pixels().size();
    return pixels();
  }
  const cv::Size whole = jpegSizeOf(compressed_->data);
  const int least = workingGrid(whole, working_width).width;
  constexpr int kMostReduced = 8;
  int reduction = 1;
  while (!whole.empty() && reduction < kMostReduced && 2 * reduction * least <= whole.width) reduction *= 2;
  cv::Mat picture = decodedImageOf(*compressed_, channels, reduction).pixels;
  const auto reduced = [reduction](int side) { return (side + reduction - 1) / reduction; };
  if (reduction > 1 && picture.size() != cv::Size(reduced(whole.width), reduced(whole.height))) {
    // Turned as its EXIF asks for, or not what the header promised.
    picture = decodedImageOf(*compressed_, channels).pixels;
    reduction = 1;
  }
  size_ = reduction > 1 ? whole : picture.size();
  return picture;
}

const cv::Mat& LazyImage::onGrid(int working_width, int channels) {
  if (!on_grid_.empty() && grid_width_ == working_width && grid_channels_ == channels) return on_grid_;
  cv::Mat image = decodedFor(working_width, channels);
  // The smaller number of channels is the cheaper one to resize.
  if (image.channels() > channels) cv::cvtColor(image, image, cv::COLOR_BGR2GRAY);
  on_grid_ = resizedImage(image, workingGrid(size_, working_width));
  grid_width_ = working_width;
  grid_channels_ = channels;
  picture_ = {};
  return on_grid_;
}

}  // namespace radar_dot
