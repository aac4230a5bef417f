// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>

#include "nodelets/messages/image_messages.h"

namespace radar_dot {

/// A picture that is decoded or converted only when its pixels are asked for.
class LazyImage {
 public:
  explicit LazyImage(sensor_msgs::ImageConstPtr raw) : raw_(std::move(raw)) {}
  explicit LazyImage(sensor_msgs::CompressedImageConstPtr compressed) : compressed_(std::move(compressed)) {}

  /// Is it the same picture of the same input, byte for byte? Others differ after a few bytes.
  bool repeats(const LazyImage& other) const {
    return raw_ ? raw_->data == other.raw_->data : compressed_->data == other.compressed_->data;
  }

  const std_msgs::Header& header() const { return raw_ ? raw_->header : compressed_->header; }
  /// Of the whole image. Raw images need not be converted for it.
  /// @throws std::invalid_argument as decodedImageOf()
  cv::Size size();
  /// @throws std::invalid_argument as decodedImageOf()
  const cv::Mat& pixels();
  /// The picture on the grid of `working_width` (workingGrid()), kept instead of the whole one. A JPEG is
  /// decoded no finer than that needs. @param channels  1: CV_8UC1; 3: CV_8UC3, but as it is where a raw
  /// image is grey
  /// @throws std::invalid_argument as decodedImageOf()
  const cv::Mat& onGrid(int working_width, int channels);

 private:
  cv::Mat decodedFor(int working_width, int channels);

  sensor_msgs::ImageConstPtr raw_;
  sensor_msgs::CompressedImageConstPtr compressed_;
  DecodedImage picture_;
  cv::Size size_;  // where it is known from a picture on a grid
  cv::Mat on_grid_;
  int grid_width_ = 0, grid_channels_ = 0;  // that on_grid_ was asked for with
};

}  // namespace radar_dot
