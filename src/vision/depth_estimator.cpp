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
#include "vectorised.h"

namespace radar_dot {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// above / (first + u step), m, as far as that is positive and not beyond `most`.
RADAR_DOT_VECTORISED void groundRow(double above, double first, double step, double most, int columns,
                                    float* depths) {
  for (int u = 0; u < columns; ++u) {
    const double s = above / (first + u * step);
    depths[u] = s > 0.0 && s <= most ? static_cast<float>(s) : kNaN;
  }
}

using Registry = BackendRegistry<DepthEstimatorFactory>;

Registry& registry() {
  static Registry instance("depth", {{"lidar", makeLidarDepth},
                                     {kMotionBackend, makeMotionDepth},
                                     {kRadarGroundBackend, makeRadarGroundDepth}});
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
  // d.z - slope d.x of a ray d grows evenly along a row.
  const Eigen::RowVector3d across = R.row(2) - slope * R.row(0);
  cv::Mat depth(camera.height, camera.width, CV_32FC1);
  for (int v = 0; v < camera.height; ++v) {
    groundRow(above, across * camera.rayOf(0.0, v), across.x() / camera.fx, max_depth, camera.width,
              depth.ptr<float>(v));
  }
  return depth;
}

cv::Mat groundRelativeStd(const CameraIntrinsics& camera, const Eigen::Isometry3d& T_base_from_camera,
                          const GroundParams& ground) {
  const GroundUncertainty& uncertainty = ground.uncertainty;
  const double slope = std::tan(ground.pitch);
  const double slope_std = uncertainty.pitch_std * (1.0 + slope * slope);
  cv::Mat stds(camera.height, camera.width, CV_32FC1);
  for (int v = 0; v < camera.height; ++v) {
    float* pixels = stds.ptr<float>(v);
    for (int u = 0; u < camera.width; ++u) {
      const GroundRay ray = groundRay(camera, T_base_from_camera, u, v, slope, ground.height);
      const Eigen::Vector3d shares(ray.by_slope * slope_std / ray.rho,
                                   ray.by_height * uncertainty.height_std / ray.rho,
                                   uncertainty.relative_std);
      pixels[u] = ray.rho > 0.0 ? static_cast<float>(shares.norm()) : kNaN;
    }
  }
  return stds;
}

cv::Mat farthestGround(const CameraIntrinsics& camera, const Eigen::Isometry3d& T_base_from_camera,
                       const GroundParams& ground) {
  const cv::Mat depth = groundDepth(camera, T_base_from_camera, ground.height, ground.pitch,
                                    std::numeric_limits<double>::infinity());
  const cv::Mat share = 1.0 - 2.0 * groundRelativeStd(camera, T_base_from_camera, ground);
  return depth / cv::max(share, 1e-3);
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
