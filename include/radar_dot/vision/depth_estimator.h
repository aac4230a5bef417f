// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "radar_dot/common/fields.h"
#include "radar_dot/vision/camera_intrinsics.h"
#include "radar_dot/vision/lidar_depth.h"
#include "radar_dot/vision/motion_depth.h"
#include "radar_dot/vision/network_params.h"
#include "radar_dot/vision/radar_ground_depth.h"
#include "radar_dot/vision/shared_fields.h"

namespace radar_dot {

/// What a depth estimator may look at. The result lies on the grid of `camera`.
struct DepthInput {
  cv::Mat image;            ///< CV_8UC3 (BGR) or CV_8UC1 of the camera, any size; may be empty
  CameraIntrinsics camera;  ///< of the grid that depth is wanted on
  Eigen::Isometry3d T_base_from_camera = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Vector3f> radar_points;   ///< m, base frame, at the time of the image
  std::vector<Eigen::Vector3f> lidar_points;   ///< m, base frame, at the time of the image
  double pixel_scale = 1.0;                    ///< px of the full image per px of the grid
  double time = 0.0;                           ///< s, of the image
  std::optional<MotionDepthInput::Step> step;  ///< from the previous image; none: a first image
};

/// The parts of DepthInput that an estimator looks at, besides the camera.
struct DepthNeeds {
  bool image = false, radar = false, lidar = false;
  bool trained_radars_only = false;  ///< of the radars those that a network was trained with
  bool motion = false;               ///< `step`, and every image in the order of time
};

/// The backend that draws the ground plane.
inline constexpr const char* kRadarGroundBackend = "radar_ground";
/// The backend MotionDepth with radar_ground as its prior, which it shows where what is seen is no static
/// point.
inline constexpr const char* kMotionBackend = "motion";

/// Parameters of makeDepthEstimator: which backend, and what each takes.
struct DepthParams {
  std::string backend = kRadarGroundBackend;
  double max_depth = 120.0;
  double relative_std = 0.1;
  RadarGroundParams radar_ground;
  MotionDepthParams motion;
  LidarParams lidar;
  NetworkParams network;  ///< torch: with JustDepth's signature, see just_depth.h

  void describe(FieldList& fields) {
    fields.group("Depth");
    fields.add("depth_backend", backend,
               "radar_ground: ground plane and radar returns; motion: parallax of consecutive images, from "
               "radar_ground on; lidar: completed lidar sweep; torch: a network; or a registered one. "
               "Depth also takes topic: an external depth on depth/input. Evaluators also take "
               "ground_truth, noisy (ground truth with the errors of a network) and files");
    describeMaxDepth(max_depth, fields);
    fields.add(
        "relative_std", relative_std,
        "1 sigma of the inverse depth, relative, of sources that do not know it better (torch, topic, files)",
        "", {1e-6, 10.0});
    fields.group("RadarGround");
    radar_ground.describe(fields);
    motion.describe(fields);
    fields.group("Lidar");
    lidar.describe(fields);
    fields.group("Network");
    fields.add("depth_model", network.model,
               "TorchScript file of export_justdepth.py, for depth_backend torch");
    network.describe(fields);
  }
};

/// Metric depth (m along the optical axis, CV_32FC1) on the grid of the input's camera; NaN = unknown.
class DepthEstimator {
 public:
  virtual ~DepthEstimator() = default;
  /// @throws std::invalid_argument when what this estimator needs is not there, saying what.
  virtual cv::Mat estimate(const DepthInput& input) = 0;
  virtual DepthNeeds needs() const = 0;
  /// How uncertain a depth is: 1 sigma of the inverse depth, relative, CV_32FC1 on the grid of the
  /// depth; NaN where that is unknown. The same constant for every pixel where a backend knows nothing
  /// better.
  /// @param input  that the depth was estimated from
  /// @param depth  CV_32FC1, m: by estimate() of this backend; more of it may be unknown
  /// @throws std::invalid_argument where input and depth do not go together
  virtual cv::Mat relativeStd(const DepthInput& input, const cv::Mat& depth) const;
};

/// The same 1 sigma (relative, inverse depth) for every pixel whose depth is known: CV_32FC1, NaN
/// elsewhere.
/// @param depth  CV_32FC1, m
cv::Mat constantStd(const cv::Mat& depth, double relative_std);

/// Makes the backend `params.backend`. One that is not registered is looked for in the shared library
/// `libradar_dot_backend_<name>.so`, beside this one or where the loader looks, which registers it.
/// @throws std::invalid_argument for invalid parameters, or a backend that is not there, with the
///         names of those that are.
std::unique_ptr<DepthEstimator> makeDepthEstimator(const DepthParams& params = {});

/// Adds a backend, or replaces one, for every later makeDepthEstimator. Thread-safe.
using DepthEstimatorFactory = std::function<std::unique_ptr<DepthEstimator>(const DepthParams&)>;
void registerDepthEstimator(const std::string& backend, DepthEstimatorFactory factory);
/// Names of the backends at hand, sorted.
std::vector<std::string> depthBackends();

/// Depth of points seen by the camera, the nearest where several fall on one pixel; NaN elsewhere.
cv::Mat projectedDepth(const std::vector<Eigen::Vector3f>& points_base, const CameraIntrinsics& camera,
                       const Eigen::Isometry3d& T_base_from_camera, double max_depth);

}  // namespace radar_dot
