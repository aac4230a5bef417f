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

#include "parallel_rows.h"
#include "radar_dot/common/quantile.h"
#include "warp.h"

namespace radar_dot {
namespace {

constexpr float kCore = 0.4F;          // of the largest distance of a region from its border: always inside
constexpr float kUnknown = 0.003F;     // weight of what is in the band
constexpr double kSpread = 7.0;        // of the smoother, over the square of the reach
constexpr double kEdge = 4.0;          // grey values from px to px that hold it up, to 1/e
constexpr float kChanged = 1.5F;       // grey values, rms, that make a marked pixel certain
constexpr int kWindow = 5;             // px, of that
constexpr double kSurroundings = 1.5;  // reaches around a region that are looked at
constexpr float kNoise = 3.0F;         // variances of the noise that are no change
constexpr float kScharr = 0.115F;      // the mean square change by noise, over the variance of a difference
constexpr float kShift = 2.0F;         // px, of which a pixel that stands must show the absence
constexpr float kShown = 0.1F;         // variances of the noise that it must show at least
constexpr int kSampling = 4;           // px

cv::Rect grown(const cv::Rect& box, int margin, const cv::Size& image) {
  return cv::Rect(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin) &
         cv::Rect({}, image);
}

/// Boxes around the regions, with their surroundings; those that meet are one.
std::vector<cv::Rect> boxesOf(const cv::Mat& stats, int margin, const cv::Size& image) {
  std::vector<cv::Rect> boxes;
  for (int i = 1; i < stats.rows; ++i) {
    const int* region = stats.ptr<int>(i);
    cv::Rect box = grown({region[cv::CC_STAT_LEFT], region[cv::CC_STAT_TOP], region[cv::CC_STAT_WIDTH],
                          region[cv::CC_STAT_HEIGHT]},
                         margin, image);
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

/// Between two images, in grey values: exposures differ, and so do the pixels of two pictures of the same.
struct ImageDifference {
  float offset = 0.0F;
  float variance = 0.0F;  ///< of the noise
};

/// Of what the flow leaves, which most pixels are explained by.
ImageDifference differenceBy(const ImagePairInput& pair) {
  const cv::Size size((pair.grey.cols - 1) / kSampling + 1, (pair.grey.rows - 1) / kSampling + 1);
  cv::Mat targets(size, CV_32FC2), second;
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column)
      targets.at<cv::Vec2f>(row, column) =
          pair.flow.at<cv::Vec2f>(row * kSampling, column * kSampling) +
          cv::Vec2f(static_cast<float>(column * kSampling), static_cast<float>(row * kSampling));
  cv::remap(pair.second_grey, second, targets, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  std::vector<float> differences;
  differences.reserve(second.total());
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column)
      differences.push_back(
          static_cast<float>(second.at<std::uint8_t>(row, column) -
                             pair.grey.at<std::uint8_t>(row * kSampling, column * kSampling)));
  ImageDifference difference;
  difference.offset = quantileOf(differences);
  for (float& value : differences) value = (value - difference.offset) * (value - difference.offset);
  constexpr float kChiSquare = 0.455F;  // its median, for one degree of freedom
  difference.variance = quantileOf(differences) / kChiSquare;
  return difference;
}

/// Means of the products of the changes of a grey image from px to px, CV_32FC3: sideways, both, downwards.
cv::Mat structureOf(const cv::Mat& grey) {
  cv::Mat sideways, downwards, structure(grey.size(), CV_32FC3);
  cv::Scharr(grey, sideways, CV_32F, 1, 0, 1.0 / 32.0);
  cv::Scharr(grey, downwards, CV_32F, 0, 1, 1.0 / 32.0);
  parallelRows(structure.rows, [&](int row) {
    const float *x = sideways.ptr<float>(row), *y = downwards.ptr<float>(row);
    auto* to = structure.ptr<cv::Vec3f>(row);
    for (int column = 0; column < structure.cols; ++column)
      to[column] = {x[column] * x[column], x[column] * y[column], y[column] * y[column]};
  });
  cv::boxFilter(structure, structure, -1, {kWindow, kWindow});
  return structure;
}

/// Flow of a static world, of a part of the grid.
cv::Mat expectedIn(const ImagePairInput& pair, const cv::Rect& box) {
  CameraIntrinsics camera = pair.camera;
  camera.cx -= box.x;
  camera.cy -= box.y;
  camera.width = box.width;
  camera.height = box.height;
  return expectedFlow(camera, pair.T_current_from_previous, pair.depth(box));
}

/// A pair of images, and how the second differs from the first where nothing has moved.
struct ComparedPair {
  const ImagePairInput& images;
  ImageDifference difference;
};

/// Mean squares of what is left between the images of a pair, were each pixel of the box to go where `flow`
/// leads: grey values^2.
cv::Mat unexplainedBy(const cv::Mat& flow, const ComparedPair& pair, const cv::Rect& box) {
  cv::Mat left;
  cv::subtract(warpedBack(pair.images.second_grey, flow + cv::Scalar(box.x, box.y)), pair.images.grey(box),
               left, cv::noArray(), CV_32F);
  cv::subtract(left, pair.difference.offset, left);
  cv::multiply(left, left, left);
  cv::boxFilter(left, left, -1, {kWindow, kWindow});
  return left;
}

/// Mean square by which an image changes where it is shifted by 1 px, in the direction in which it does the
/// least: the smaller eigenvalue. A stripe does not show that it moves along itself.
float leastChange(const cv::Vec3f& structure) {
  const float half_sum = 0.5F * (structure[0] + structure[2]),
              half_difference = 0.5F * (structure[0] - structure[2]);
  return half_sum - std::sqrt(half_difference * half_difference + structure[1] * structure[1]);
}

/// How certain the images make it that a marked pixel moves, and that it stands: CV_32FC2, 0 to 1, within the
/// box. What moves lends its flow to surfaces without texture, which look as if they stood as well, and to
/// what one of the images hides, which the other shows where a static world would be.
/// @param grey   the first image of all pairs
/// @param pairs  the first of them tells what moves, any what stands
cv::Mat certaintyOf(const cv::Mat& grey, const std::vector<ComparedPair>& pairs, const cv::Rect& box) {
  const cv::Mat structure = structureOf(grey(box));
  cv::Mat certainty(structure.size(), CV_32FC2);
  parallelRows(certainty.rows, [&](int row) {
    auto* to = certainty.ptr<cv::Vec2f>(row);
    const auto* change = structure.ptr<cv::Vec3f>(row);
    for (int column = 0; column < certainty.cols; ++column)
      to[column] = {change[column][0] + change[column][2], 0.0F};
  });
  for (const ComparedPair& pair : pairs) {
    const float variance = pair.difference.variance;
    const cv::Mat by_static = unexplainedBy(expectedIn(pair.images, box), pair, box);
    const cv::Mat by_flow = unexplainedBy(pair.images.flow(box), pair, box);
    const bool tells_what_moves = &pair == &pairs.front();
    parallelRows(certainty.rows, [&](int row) {
      auto* to = certainty.ptr<cv::Vec2f>(row);
      const auto* change = structure.ptr<cv::Vec3f>(row);
      const float *of_static = by_static.ptr<float>(row), *of_flow = by_flow.ptr<float>(row);
      for (int column = 0; column < certainty.cols; ++column) {
        const float left = of_static[column];
        const float would_show = kShift * kShift * (leastChange(change[column]) - kScharr * variance);
        const float shows = std::min(would_show, of_flow[column] - left);
        if (shows > std::max(kShown * variance, left - variance))
          to[column][1] = std::max(to[column][1], shows / (4.0F * kShown * variance));
        if (tells_what_moves) to[column][0] = std::min(to[column][0], left - kNoise * variance);
      }
    });
  }
  parallelRows(certainty.rows, [&](int row) {
    auto* to = certainty.ptr<cv::Vec2f>(row);
    for (int column = 0; column < certainty.cols; ++column)
      to[column] = {std::clamp(to[column][0] / (kChanged * kChanged), kUnknown, 1.0F),
                    std::min(to[column][1], 1.0F)};
  });
  return certainty;
}

/// Weighted mask and weight, CV_32FC2: 1 where the mask is taken as it is.
/// @param certainty      as of certaintyOf, where the mask is marked
/// @param inside, cores  px, distances within regions from their borders, and where by label their cores
/// begin
cv::Mat knownOf(const cv::Mat& mask, const cv::Mat& certainty, const cv::Mat& labels, const cv::Mat& inside,
                const std::vector<float>& cores, float reach) {
  cv::Mat outside, known(mask.size(), CV_32FC2);
  cv::distanceTransform(~mask, outside, cv::DIST_L2, 3);
  for (int row = 0; row < mask.rows; ++row) {
    const auto* is_marked = mask.ptr<std::uint8_t>(row);
    const auto* certain = certainty.ptr<cv::Vec2f>(row);
    const int* label = labels.ptr<int>(row);
    auto* to = known.ptr<cv::Vec2f>(row);
    for (int column = 0; column < mask.cols; ++column) {
      if (is_marked[column] == 0) {
        to[column] = {0.0F, outside.at<float>(row, column) > reach ? 1.0F : kUnknown};
      } else if (certain[column][1] > 0.0F) {
        to[column] = {0.0F, certain[column][1]};
      } else {
        const bool is_core = inside.at<float>(row, column) > cores[static_cast<std::size_t>(label[column])];
        to[column] = cv::Vec2f::all(is_core ? certain[column][0] : kUnknown);
      }
    }
  }
  return known;
}

}  // namespace

void moveBordersToEdges(cv::Mat& mask, const ImagePairInput& pair, double reach,
                        const ImagePairInput* before) {
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
  std::vector<ComparedPair> pairs;
  if (!pair.second_grey.empty()) pairs.push_back({pair, differenceBy(pair)});
  if (!pairs.empty() && before != nullptr && !before->second_grey.empty())
    pairs.push_back({*before, differenceBy(*before)});
  const int margin = static_cast<int>(std::ceil(kSurroundings * reach));
  for (const cv::Rect& box : boxesOf(stats, margin, mask.size())) {
    cv::Mat region = mask(box);
    const cv::Mat picture = pair.grey(box).clone();
    cv::Mat certainty(box.size(), CV_32FC2);
    const cv::Rect marked = grown(cv::boundingRect(region), kWindow / 2, box.size());
    certaintyOf(pair.grey, pairs, marked + box.tl()).copyTo(certainty(marked));
    const cv::Mat known =
        knownOf(region, certainty, labels(box), distances(box), cores, static_cast<float>(reach));
    cv::Mat spread;
    cv::ximgproc::fastGlobalSmootherFilter(picture, known, spread, kSpread * reach * reach, kEdge);
    for (int row = 0; row < region.rows; ++row) {
      const auto* blurred = spread.ptr<cv::Vec2f>(row);
      const auto* exact = known.ptr<cv::Vec2f>(row);
      auto* to = region.ptr<std::uint8_t>(row);
      for (int column = 0; column < region.cols; ++column) {
        const cv::Vec2f& from = exact[column][1] < 1.0F ? blurred[column] : exact[column];
        to[column] = from[0] > 0.5F * from[1] ? 255 : 0;
      }
    }
  }
}

}  // namespace radar_dot
