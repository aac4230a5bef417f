// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/static_world.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "resize_nearest.h"

namespace radar_dot {
namespace {

constexpr float kNearest = 0.1F;   // m; what is nearer to the camera's plane has no useful pixel
constexpr int kSurroundings = 16;  // px around what is filled

using Pixel = cv::Vec4f;  // colour times weight, and the weight: 1 = known

/// Half as large. Whatever is known of a pixel's four decides it.
cv::Mat pulled(const cv::Mat& level) {
  cv::Mat half;
  cv::resize(level, half, {(level.cols + 1) / 2, (level.rows + 1) / 2}, 0.0, 0.0, cv::INTER_AREA);
  half.forEach<Pixel>([](Pixel& pixel, const int*) {
    if (pixel[3] > 0.0F) pixel *= std::min(1.0F, 4.0F * pixel[3]) / pixel[3];
  });
  return half;
}

/// What is not known of `level` comes from the coarser one.
void push(const cv::Mat& coarser, cv::Mat& level) {
  cv::Mat rest;
  cv::resize(coarser, rest, level.size(), 0.0, 0.0, cv::INTER_LINEAR);
  level.forEach<Pixel>([&rest](Pixel& pixel, const int* place) {
    pixel += (1.0F - pixel[3]) * rest.at<Pixel>(place[0], place[1]);
  });
}

/// The known pixels of an image, and none of the others.
cv::Mat knownOf(const cv::Mat& image, const cv::Mat& keep) {
  cv::Mat known = cv::Mat::zeros(image.size(), CV_32FC4);
  known.forEach<Pixel>([&](Pixel& pixel, const int* place) {
    if (keep.at<std::uint8_t>(place[0], place[1]) == 0) return;
    const std::uint8_t* colour = image.ptr(place[0], place[1]);
    for (int i = 0; i < 3; ++i) pixel[i] = colour[image.channels() == 3 ? i : 0];
    pixel[3] = 1.0F;
  });
  return known;
}

}  // namespace

cv::Mat distanceToMoving(const cv::Mat& mask, const cv::Size& size) {
  const cv::Mat still = resizeNearest(mask, size) == 0;
  if (cv::countNonZero(still) == size.area())
    return {size, CV_32FC1, cv::Scalar(std::numeric_limits<double>::infinity())};
  cv::Mat distance;
  cv::distanceTransform(still, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  return distance;
}

// By a pyramid: cv::inpaint leaves seams where its fronts meet, edges for whoever looks for some.
cv::Mat filled(const cv::Mat& image, const cv::Mat& keep) {
  cv::Mat result = image.clone();
  cv::Rect area = cv::boundingRect(keep == 0);
  if (area.empty()) return result;
  area -= cv::Point(kSurroundings, kSurroundings);
  area += cv::Size(2 * kSurroundings, 2 * kSurroundings);
  area &= cv::Rect({0, 0}, image.size());
  std::vector<cv::Mat> levels = {knownOf(image(area), keep(area))};
  while (levels.back().total() > 1) levels.push_back(pulled(levels.back()));
  for (std::size_t i = levels.size() - 1; i > 0; --i) push(levels[i], levels[i - 1]);
  cv::Mat smooth;
  levels.front().convertTo(smooth, CV_8U);
  cv::cvtColor(smooth, smooth, image.channels() == 3 ? cv::COLOR_BGRA2BGR : cv::COLOR_BGRA2GRAY);
  smooth.copyTo(result(area), keep(area) == 0);
  return result;
}

std::vector<std::uint8_t> keptPoints(const std::vector<Eigen::Vector3f>& points, const cv::Mat& keep,
                                     const CameraIntrinsics& camera,
                                     const Eigen::Isometry3d& T_camera_from_points) {
  std::vector<std::uint8_t> kept(points.size(), 1);
  const Eigen::Isometry3f T = T_camera_from_points.cast<float>();
  const cv::Rect2d view(-0.5, -0.5, camera.width, camera.height);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f seen = T * points[i];
    if (!seen.allFinite() || seen.z() < kNearest) continue;
    const Eigen::Vector2d pixel = camera.project(seen.cast<double>());
    if (!view.contains({pixel.x(), pixel.y()})) continue;
    const auto column = static_cast<int>(std::floor(pixel.x() + 0.5));
    const auto row = static_cast<int>(std::floor(pixel.y() + 0.5));
    kept[i] = keep.at<std::uint8_t>(row, column) != 0 ? 1 : 0;
  }
  return kept;
}

}  // namespace radar_dot
