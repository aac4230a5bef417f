// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <opencv2/core/mat.hpp>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string>

#include "fixtures/nuscenes_fixture.h"

namespace radar_dot::test {

inline void writeImage(const std::filesystem::path& file, const cv::Mat& image) {
  std::filesystem::create_directories(file.parent_path());
  if (!cv::imwrite(file.string(), image)) throw std::runtime_error(file.string() + ": cannot be written");
}

/// CV_32FC2, px, in KITTI's 16-bit form; NaN is not valid.
inline void writeFlow(const std::filesystem::path& file, const cv::Mat& flow) {
  cv::Mat code(flow.size(), CV_16UC3, cv::Scalar::all(0));
  for (int row = 0; row < flow.rows; ++row) {
    for (int column = 0; column < flow.cols; ++column) {
      const auto& vector = flow.at<cv::Vec2f>(row, column);
      if (!std::isfinite(vector[0])) continue;
      const auto coded = [](float value) {
        return static_cast<std::uint16_t>(std::lround(64.0F * value + 32768.0F));
      };
      code.at<cv::Vec3w>(row, column) = {1, coded(vector[1]), coded(vector[0])};
    }
  }
  writeImage(file, code);
}

/// The true flow between keyframes for a NuscenesFixture, the same for every pair: kStaticFlow, but
/// kMoverFlow in the fixture's kMovingPixels, which are marked as moving, and none in the upper tenth. The
/// left tenth is occluded in the second image, the right one outside of it.
struct FixtureFlow {
  static constexpr float kStaticFlow[2] = {12.0F, -5.0F};  ///< px
  static constexpr float kMoverFlow[2] = {12.0F, 15.0F};   ///< px
  /// Shares of the image's pixels.
  static constexpr double kVisible = 0.8 * 0.9;  ///< with true flow, and seen in the second image
  static constexpr double kMoving = 200.0 * 120.0 / (1600.0 * 900.0);  ///< all of them visible

  static cv::Size size() { return {NuscenesFixture::kImageColumns, NuscenesFixture::kImageRows}; }
  static cv::Rect mover() {
    const int* box = NuscenesFixture::kMovingPixels;
    return {box[0], box[1], box[2], box[3]};
  }
  static cv::Mat flow() {
    cv::Mat image(size(), CV_32FC2, cv::Scalar(kStaticFlow[0], kStaticFlow[1]));
    image(mover()) = cv::Scalar(kMoverFlow[0], kMoverFlow[1]);
    image.rowRange(0, size().height / 10) = cv::Scalar::all(std::numeric_limits<double>::quiet_NaN());
    return image;
  }

  /// Writes the files of every image.
  static void write(const NuscenesFixture& fixture) {
    cv::Mat occlusion = cv::Mat::zeros(size(), CV_8UC1);
    occlusion.colRange(0, size().width / 10) = 255;
    occlusion.colRange(size().width - size().width / 10, size().width) = 127;
    cv::Mat motion = cv::Mat::zeros(size(), CV_8UC1);
    motion(mover()) = 255;
    const std::filesystem::path truth = fixture.dataroot() / "ground_truth";
    const auto file_of = [&truth](const char* folder, const std::string& name) {
      return truth / folder / (name + ".png");
    };
    writeFlow(file_of("keyframe_flow", "all"), flow());
    writeImage(file_of("keyframe_occlusion", "all"), occlusion);
    writeImage(file_of("motion", "all"), motion);
    for (const auto& image :
         std::filesystem::directory_iterator(fixture.dataroot() / "samples" / "CAM_FRONT")) {
      for (const char* folder : {"keyframe_flow", "keyframe_occlusion", "motion"})
        std::filesystem::copy_file(file_of(folder, "all"), file_of(folder, image.path().stem().string()));
    }
  }
};

}  // namespace radar_dot::test
