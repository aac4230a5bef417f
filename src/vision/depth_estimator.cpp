// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/depth_estimator.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "backend_registry.h"
#include "depth_backends.h"
#include "ground_ray.h"
#include "parameter_checks.h"

namespace radar_dot {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

void validate(const DepthParams& params) {
  const ParameterChecks checks("depth");
  checks.positive("max_depth", params.max_depth);
  checks.require(std::abs(params.ground_pitch) < 0.5, "ground_pitch", params.ground_pitch,
                 "between -0.5 and 0.5 rad");
  checks.require(std::isfinite(params.ground_height), "ground_height", params.ground_height, "finite");
  checks.positive("column_height", params.column_height);
  checks.positive("column_half_width", params.column_half_width);
  checks.require(params.azimuth_std >= 0.0, "azimuth_std", params.azimuth_std, "zero or positive");
  checks.require(std::isfinite(params.background_depth) && params.background_depth >= 0.0, "background_depth",
                 params.background_depth, "zero or positive");
  checks.positive("background_angle", params.background_angle);
  checks.notNegative("ground_pitch_std", params.ground_pitch_std);
  checks.notNegative("ground_height_std", params.ground_height_std);
  for (const auto& [name, value] :
       {std::pair("relative_std", params.relative_std), std::pair("column_std", params.column_std),
        std::pair("ground_relative_std", params.ground_relative_std),
        std::pair("background_std", params.background_std), std::pair("lidar_std", params.lidar_std)})
    checks.positive(name, value);
  checks.notNegative("completion_std", params.completion_std);
  checks.require(params.completion_kernel >= 1 && params.completion_kernel <= 199, "completion_kernel",
                 params.completion_kernel, "between 1 and 199 px");
}

using Registry = BackendRegistry<DepthEstimatorFactory>;

Registry& registry() {
  static Registry instance("depth", {{"lidar", makeLidarDepth}, {"radar_ground", makeRadarGroundDepth}});
  return instance;
}

}  // namespace

std::unique_ptr<DepthEstimator> makeDepthEstimator(const DepthParams& params) {
  validate(params);
  return registry().find(params.backend)(params);
}

void registerDepthEstimator(const std::string& backend, DepthEstimatorFactory factory) {
  registry().add(backend, std::move(factory));
}

std::vector<std::string> depthBackends() { return registry().names(); }

cv::Mat DepthEstimator::relativeStd(const DepthInput& /*input*/, const cv::Mat& depth) const {
  return constantStd(depth, DepthParams{}.relative_std);
}

cv::Mat constantStd(const cv::Mat& depth, double relative_std) {
  if (depth.type() != CV_32FC1) throw std::invalid_argument("depth: its type must be CV_32FC1");
  cv::Mat stds(depth.size(), CV_32FC1);
  for (int row = 0; row < depth.rows; ++row) {
    const auto* pixels = depth.ptr<float>(row);
    std::transform(pixels, pixels + depth.cols, stds.ptr<float>(row), [relative_std](float d) {
      return d > 0.0F && std::isfinite(d) ? static_cast<float>(relative_std) : kNaN;
    });
  }
  return stds;
}

cv::Mat groundDepth(const CameraIntrinsics& camera, const Eigen::Isometry3d& T_base_from_camera,
                    double height, double pitch, double max_depth) {
  // Points of the ray: c + s d. Ground: z = height + x tan(pitch). The ray has z = 1 in the camera frame, so
  // s is depth.
  const Eigen::Vector3d c = T_base_from_camera.translation();
  const Eigen::Matrix3d& R = T_base_from_camera.linear();
  const double slope = std::tan(pitch);
  const double above = height + slope * c.x() - c.z();
  cv::Mat depth(camera.height, camera.width, CV_32FC1);
  for (int v = 0; v < camera.height; ++v) {
    float* pixels = depth.ptr<float>(v);
    for (int u = 0; u < camera.width; ++u) {
      const Eigen::Vector3d d = R * camera.rayOf(u, v);
      const double s = above / (d.z() - slope * d.x());
      pixels[u] = s > 0.0 && s <= max_depth ? static_cast<float>(s) : kNaN;
    }
  }
  return depth;
}

cv::Mat groundRelativeStd(const CameraIntrinsics& camera, const Eigen::Isometry3d& T_base_from_camera,
                          double height, double pitch, const GroundUncertainty& uncertainty) {
  const double slope = std::tan(pitch);
  const double slope_std = uncertainty.pitch_std * (1.0 + slope * slope);
  cv::Mat stds(camera.height, camera.width, CV_32FC1);
  for (int v = 0; v < camera.height; ++v) {
    float* pixels = stds.ptr<float>(v);
    for (int u = 0; u < camera.width; ++u) {
      const GroundRay ray = groundRay(camera, T_base_from_camera, u, v, slope, height);
      const Eigen::Vector3d shares(ray.by_slope * slope_std / ray.rho,
                                   ray.by_height * uncertainty.height_std / ray.rho,
                                   uncertainty.relative_std);
      pixels[u] = ray.rho > 0.0 ? static_cast<float>(shares.norm()) : kNaN;
    }
  }
  return stds;
}

cv::Mat projectedDepth(const std::vector<Eigen::Vector3f>& points_base, const CameraIntrinsics& camera,
                       const Eigen::Isometry3d& T_base_from_camera, double max_depth) {
  const Eigen::Isometry3d T_camera_from_base = T_base_from_camera.inverse();
  cv::Mat depth(camera.height, camera.width, CV_32FC1, cv::Scalar(std::numeric_limits<double>::quiet_NaN()));
  for (const Eigen::Vector3f& point : points_base) {
    const Eigen::Vector3d seen = T_camera_from_base * point.cast<double>();
    if (!(seen.z() > 0.0 && seen.z() <= max_depth)) continue;
    const Eigen::Vector2d pixel = camera.project(seen);
    if (!(pixel.x() > -0.5 && pixel.y() > -0.5 && pixel.x() < camera.width - 0.5 &&
          pixel.y() < camera.height - 0.5))
      continue;
    float& nearest =
        depth.at<float>(static_cast<int>(std::lround(pixel.y())), static_cast<int>(std::lround(pixel.x())));
    if (!(nearest <= static_cast<float>(seen.z()))) nearest = static_cast<float>(seen.z());
  }
  return depth;
}

}  // namespace radar_dot
