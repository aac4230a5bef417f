// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/objects/mask_regions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>

#include "radar_dot/common/quantile.h"

namespace radar_dot {
namespace {

/// What the pixels of a region say.
struct RegionPixels {
  std::vector<float> columns, depths, residual_x, residual_y;
};

RegionPixels pixelsOf(const cv::Mat& labels, int label, const ImageBox& box, const cv::Mat& depth,
                      const cv::Mat& flow_residual) {
  RegionPixels pixels;
  for (int row = box.y; row < box.y + box.height; ++row) {
    for (int column = box.x; column < box.x + box.width; ++column) {
      if (labels.at<int>(row, column) != label) continue;
      const float metres = depth.at<float>(row, column);
      if (std::isfinite(metres) && metres > 0.F) {
        pixels.depths.push_back(metres);
        pixels.columns.push_back(static_cast<float>(column));
      }
      const cv::Vec2f& residual = flow_residual.at<cv::Vec2f>(row, column);
      if (!std::isfinite(residual[0]) || !std::isfinite(residual[1])) continue;
      pixels.residual_x.push_back(residual[0]);
      pixels.residual_y.push_back(residual[1]);
    }
  }
  return pixels;
}

/// Residual and lateral velocity. Without flow they are unknown, which the variance says.
void addFlow(RegionPixels& pixels, double speed_per_pixel, const MaskRegionParams& params,
             MaskRegion& region) {
  if (pixels.residual_x.empty()) {
    region.flow_residual.setConstant(std::numeric_limits<double>::quiet_NaN());
    region.lateral.variance = std::numeric_limits<double>::infinity();
    return;
  }
  region.flow_residual = {quantileOf(pixels.residual_x), quantileOf(pixels.residual_y)};
  const double du = region.flow_residual.x();
  region.lateral.value = speed_per_pixel * du;
  region.lateral.variance = speed_per_pixel * speed_per_pixel *
                            (params.flow_std * params.flow_std + std::pow(params.relative_depth_std * du, 2));
}

std::optional<MaskRegion> regionOf(RegionPixels& pixels, const ImageBox& box, double interval,
                                   const CameraIntrinsics& camera,
                                   const Eigen::Isometry3d& T_base_from_camera,
                                   const MaskRegionParams& params) {
  if (pixels.depths.empty()) return std::nullopt;
  MaskRegion region;
  region.box = box;
  const double depth = quantileOf(pixels.depths);
  const double u = quantileOf(pixels.columns);
  const double v = box.y + 0.5 * (box.height - 1);
  const Eigen::Vector3d ray = camera.rayOf(u, v);
  region.position = (T_base_from_camera * (depth * ray)).head<2>();

  // Axes of the camera in the plane of the base frame.
  const Eigen::Vector2d right = T_base_from_camera.linear().col(0).head<2>();
  const Eigen::Vector2d along = (T_base_from_camera.linear() * ray).head<2>();
  const double along_std = params.relative_depth_std * depth;
  const double pixel_std = std::max(params.pixel_std, 0.25 * box.width);
  const double across_std = pixel_std * depth / camera.fx;
  region.covariance =
      along_std * along_std * along * along.transpose() + across_std * across_std * right * right.transpose();

  const Eigen::Vector3d row = Eigen::Vector3d(1.0, 0.0, -ray.x());  // of V in the camera frame
  region.lateral.row = (T_base_from_camera.linear() * row).head<2>();
  addFlow(pixels, depth / (camera.fx * interval), params, region);
  return region;
}

}  // namespace

std::vector<MaskRegion> regionsOfMask(const cv::Mat& mask, const cv::Mat& depth, const cv::Mat& flow_residual,
                                      double interval, const CameraIntrinsics& camera,
                                      const Eigen::Isometry3d& T_base_from_camera,
                                      const MaskRegionParams& params) {
  validate(params);
  const cv::Size grid(camera.width, camera.height);
  if (mask.type() != CV_8UC1 || mask.size() != grid)
    throw std::invalid_argument("the mask must be CV_8UC1 on the camera's grid");
  if (depth.type() != CV_32FC1 || depth.size() != grid)
    throw std::invalid_argument("the depth must be CV_32FC1 on the camera's grid");
  if (flow_residual.type() != CV_32FC2 || flow_residual.size() != grid)
    throw std::invalid_argument("the flow residual must be CV_32FC2 on the camera's grid");
  if (!(interval > 0.0)) throw std::invalid_argument("the interval must be positive (s)");
  cv::Mat labels, statistics, centroids;
  const int count = cv::connectedComponentsWithStats(mask, labels, statistics, centroids, 8, CV_32S);
  std::vector<MaskRegion> regions;
  for (int label = 1; label < count; ++label) {
    const auto pixel_count = static_cast<std::size_t>(statistics.at<int>(label, cv::CC_STAT_AREA));
    if (pixel_count < params.min_pixels) continue;
    const ImageBox box{
        statistics.at<int>(label, cv::CC_STAT_LEFT), statistics.at<int>(label, cv::CC_STAT_TOP),
        statistics.at<int>(label, cv::CC_STAT_WIDTH), statistics.at<int>(label, cv::CC_STAT_HEIGHT)};
    RegionPixels pixels = pixelsOf(labels, label, box, depth, flow_residual);
    if (auto region = regionOf(pixels, box, interval, camera, T_base_from_camera, params)) {
      region->pixel_count = pixel_count;
      regions.push_back(*region);
    }
  }
  return regions;
}

}  // namespace radar_dot
