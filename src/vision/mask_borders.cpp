// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "mask_borders.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <opencv2/imgproc.hpp>
#include <opencv2/ximgproc/edge_filter.hpp>
#include <vector>

#include "image_change.h"

namespace radar_dot {
namespace {

constexpr float kCore = 0.4F;        // of the largest distance of a region from its border: always inside
constexpr float kUnknown = 0.003F;   // weight of what is in the band
constexpr double kSpread = 7.0;      // of the smoother, over the square of the reach
constexpr double kEdge = 4.0;        // grey values from px to px that hold it up, to 1/e
constexpr float kTextured = 1.5F;    // grey values from px to px, rms, that make a marked pixel certain
constexpr int kWindow = 5;           // px, of that
constexpr double kSurroundings = 3;  // reaches around a region that are looked at

/// Boxes around the regions, with their surroundings; those that meet are one.
std::vector<cv::Rect> boxesOf(const cv::Mat& stats, int margin, const cv::Size& image) {
  std::vector<cv::Rect> boxes;
  for (int i = 1; i < stats.rows; ++i) {
    const int* region = stats.ptr<int>(i);
    cv::Rect box = cv::Rect(region[cv::CC_STAT_LEFT] - margin, region[cv::CC_STAT_TOP] - margin,
                            region[cv::CC_STAT_WIDTH] + 2 * margin, region[cv::CC_STAT_HEIGHT] + 2 * margin) &
                   cv::Rect({}, image);
    const auto meets = [&box](const cv::Rect& other) { return (other & box).area() > 0; };
    for (auto other = std::find_if(boxes.begin(), boxes.end(), meets); other != boxes.end();
         other = std::find_if(boxes.begin(), boxes.end(), meets)) {
      box |= *other;
      boxes.erase(other);
    }
    boxes.push_back(box);
  }
  return boxes;
}

/// Weighted mask and weight, CV_32FC2: 1 where the mask is taken as it is.
/// @param inside, cores  px, distances within regions from their borders, and where by label their cores
/// begin
cv::Mat knownOf(const cv::Mat& mask, const cv::Mat& grey, const cv::Mat& labels, const cv::Mat& inside,
                const std::vector<float>& cores, float reach) {
  const cv::Mat change = meanSquareChange(grey, kWindow);
  cv::Mat outside, known(mask.size(), CV_32FC2);
  cv::distanceTransform(~mask, outside, cv::DIST_L2, 3);
  for (int row = 0; row < mask.rows; ++row) {
    const auto* is_marked = mask.ptr<std::uint8_t>(row);
    const int* label = labels.ptr<int>(row);
    auto* to = known.ptr<cv::Vec2f>(row);
    for (int column = 0; column < mask.cols; ++column) {
      const bool marked = is_marked[column] != 0;
      const bool is_known =
          marked ? inside.at<float>(row, column) > cores[static_cast<std::size_t>(label[column])]
                 : outside.at<float>(row, column) > reach;
      // What moves may have lent its flow to a surface without texture.
      const float certain = marked ? change.at<float>(row, column) / (kTextured * kTextured) : 1.0F;
      const float weight = is_known ? std::clamp(certain, kUnknown, 1.0F) : kUnknown;
      to[column] = {marked ? weight : 0.0F, weight};
    }
  }
  return known;
}

}  // namespace

void moveBordersToEdges(cv::Mat& mask, const cv::Mat& grey, double reach) {
  cv::Mat labels, stats, centroids, distances;
  const int regions = cv::connectedComponentsWithStats(mask, labels, stats, centroids, 8, CV_32S);
  if (regions < 2) return;
  cv::distanceTransform(mask, distances, cv::DIST_L2, 3);
  std::vector<float> cores(static_cast<std::size_t>(regions), 0.0F);
  for (int row = 0; row < mask.rows; ++row) {
    const int* label = labels.ptr<int>(row);
    const float* distance = distances.ptr<float>(row);
    for (int column = 0; column < mask.cols; ++column) {
      float& largest = cores[static_cast<std::size_t>(label[column])];
      largest = std::max(largest, distance[column]);
    }
  }
  for (float& core : cores) core = std::min(kCore * core, static_cast<float>(reach));
  const int margin = static_cast<int>(std::ceil(kSurroundings * reach));
  for (const cv::Rect& box : boxesOf(stats, margin, mask.size())) {
    cv::Mat region = mask(box);
    const cv::Mat picture = grey(box).clone();
    const cv::Mat known =
        knownOf(region, picture, labels(box), distances(box), cores, static_cast<float>(reach));
    cv::Mat spread;
    cv::ximgproc::fastGlobalSmootherFilter(picture, known, spread, kSpread * reach * reach, kEdge);
    for (int row = 0; row < region.rows; ++row) {
      const auto* from = spread.ptr<cv::Vec2f>(row);
      const auto* weights = known.ptr<cv::Vec2f>(row);
      auto* to = region.ptr<std::uint8_t>(row);
      for (int column = 0; column < region.cols; ++column)
        if (weights[column][1] < 1.0F) to[column] = from[column][0] > 0.5F * from[column][1] ? 255 : 0;
    }
  }
}

}  // namespace radar_dot
