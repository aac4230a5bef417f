// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/return_reach.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <opencv2/imgproc.hpp>

namespace radar_dot {
namespace {

constexpr float kSparse = 3.0F;  // returns within the reach, itself included, that all have it whole

// m of the footprint of a radar return, below and above it: radars look at bumpers and grilles.
constexpr float kFootprintBelow = 0.5F;
constexpr float kFootprintAbove = 1.5F;

}  // namespace

std::vector<float> reachesOf(const std::vector<Eigen::Vector2f>& places, float reach) {
  std::vector<float> reaches(places.size(), reach);
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < places.size(); ++i)
    if (places[i].allFinite()) order.push_back(i);
  std::sort(order.begin(), order.end(),
            [&places](std::size_t a, std::size_t b) { return places[a].x() < places[b].x(); });
  std::vector<float> counts(places.size(), 1.0F);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Eigen::Vector2f& here = places[order[i]];
    for (std::size_t j = i + 1; j < order.size() && places[order[j]].x() - here.x() < reach; ++j) {
      if ((places[order[j]] - here).squaredNorm() >= reach * reach) continue;
      ++counts[order[i]];
      ++counts[order[j]];
    }
  }
  for (const std::size_t i : order) reaches[i] *= std::min(1.0F, kSparse / counts[i]);
  return reaches;
}

void drawReturns(const CameraIntrinsics& camera, const std::vector<CloudPoint>& points,
                 const RadarEvidenceParams& params, std::uint16_t first, cv::Mat& footprints) {
  std::vector<Eigen::Vector2f> places;
  std::vector<std::size_t> seen;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f& point = points[i].position;
    places.emplace_back(point.x(), point.z());
    if (point.z() > 0.1F && point.allFinite()) seen.push_back(i);
  }
  std::stable_sort(seen.begin(), seen.end(),
                   [&places](std::size_t a, std::size_t b) { return places[a].y() > places[b].y(); });
  const std::vector<float> reaches = reachesOf(places, static_cast<float>(params.radius));
  for (const std::size_t i : seen) {
    const Eigen::Vector3f& point = points[i].position;
    const float half_width = std::max(reaches[i], static_cast<float>(params.azimuth_std) * point.norm());
    const auto corner = [&](float right, float down) {
      const Eigen::Vector2d pixel =
          camera.project((point + Eigen::Vector3f(right, down, 0.0F)).cast<double>());
      // Far outside is outside; the conversion to int must not overflow.
      return cv::Point(static_cast<int>(std::lround(std::clamp(pixel.x(), -1e5, 1e5))),
                       static_cast<int>(std::lround(std::clamp(pixel.y(), -1e5, 1e5))));
    };
    cv::rectangle(footprints, corner(-half_width, -kFootprintAbove), corner(half_width, kFootprintBelow),
                  cv::Scalar(static_cast<double>(first + i)), cv::FILLED);
  }
}

}  // namespace radar_dot
