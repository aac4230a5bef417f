// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation_images.h"

#include <fmt/format.h>

#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "radar_dot/common/image_fault.h"
#include "radar_dot/dataset/file_bytes.h"
#include "radar_dot/dataset/tables.h"

namespace radar_dot::evaluation {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

cv::Mat read(const std::filesystem::path& file, int type, const char* wanted) {
  cv::Mat image = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
  if (image.empty())
    throw dataset::DatasetError(fmt::format("{}: cannot be read as an image", file.string()));
  if (image.type() != type) throw dataset::DatasetError(fmt::format("{}: is not {}", file.string(), wanted));
  return image;
}

}  // namespace

cv::Mat readColour(const std::filesystem::path& file) {
  const std::vector<std::uint8_t> bytes = dataset::readBytes(file);
  const std::string fault = imageFault(bytes);
  cv::Mat image = fault.empty() ? cv::imdecode(bytes, cv::IMREAD_COLOR) : cv::Mat();
  if (image.empty())
    throw dataset::DatasetError(
        fmt::format("{}: cannot be read as an image{}{}", file.string(), fault.empty() ? "" : ": ", fault));
  return image;
}

FlowField readFlow(const std::filesystem::path& file) {
  const cv::Mat code = read(file, CV_16UC3, "a flow in KITTI's form, a PNG of three 16-bit channels");
  FlowField field{cv::Mat(code.size(), CV_32FC2), cv::Mat(code.size(), CV_8UC1)};
  for (int row = 0; row < code.rows; ++row) {
    for (int column = 0; column < code.cols; ++column) {
      const auto& pixel = code.at<cv::Vec3w>(row, column);
      const bool valid = pixel[0] != 0;
      field.valid.at<std::uint8_t>(row, column) = valid ? 255 : 0;
      field.flow.at<cv::Vec2f>(row, column) =
          valid ? cv::Vec2f((static_cast<float>(pixel[2]) - 32768.0F) / 64.0F,
                            (static_cast<float>(pixel[1]) - 32768.0F) / 64.0F)
                : cv::Vec2f(kNaN, kNaN);
    }
  }
  return field;
}

cv::Mat readDepth(const std::filesystem::path& file) {
  const cv::Mat code = read(file, CV_16UC1, "a depth, a PNG of one 16-bit channel");
  cv::Mat depth;
  code.convertTo(depth, CV_32F, 1.0 / 256.0);
  depth.setTo(kNaN, code == 0);
  return depth;
}

cv::Mat readGrey(const std::filesystem::path& file) {
  return read(file, CV_8UC1, "a PNG of one 8-bit channel");
}

FlowField resizeNearest(const FlowField& field, const cv::Size& size) {
  if (field.flow.size() == size) return field;
  FlowField resized;
  resized.flow = resizeNearest(field.flow, size);
  const cv::Scalar scale(static_cast<double>(size.width) / field.flow.cols,
                         static_cast<double>(size.height) / field.flow.rows);
  cv::multiply(resized.flow, scale, resized.flow);
  if (!field.valid.empty()) resized.valid = resizeNearest(field.valid, size);
  return resized;
}

}  // namespace radar_dot::evaluation
