// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/network_images.h"

#include <opencv2/imgproc.hpp>

namespace radar_dot {

cv::Mat resizedImage(const cv::Mat& image, const cv::Size& size) {
  if (image.size() == size) return image;
  const bool smaller = size.width <= image.cols && size.height <= image.rows;
  cv::Mat resized;
  cv::resize(image, resized, size, 0.0, 0.0, smaller ? cv::INTER_AREA : cv::INTER_LINEAR);
  return resized;
}

void colourPlanes(const cv::Mat& image, const std::array<double, 3>& factor,
                  const std::array<double, 3>& offset, cv::Mat& planes) {
  planes.create(3 * image.rows, image.cols, CV_32FC1);
  for (int channel = 0; channel < 3; ++channel) {
    cv::Mat bytes = image;
    if (image.channels() == 3) cv::extractChannel(image, bytes, 2 - channel);  // BGR to RGB
    cv::Mat plane = planes.rowRange(channel * image.rows, (channel + 1) * image.rows);
    const auto c = static_cast<std::size_t>(channel);
    bytes.convertTo(plane, CV_32F, factor[c], offset[c]);
  }
}

}  // namespace radar_dot
