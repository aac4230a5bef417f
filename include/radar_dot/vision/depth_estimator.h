// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "radar_dot/vision/camera_intrinsics.h"
#include "radar_dot/vision/network_params.h"

namespace radar_dot {

/// What a depth estimator may look at. The result lies on the grid of `camera`.
struct DepthInput {
  cv::Mat image;            ///< CV_8UC3 (BGR) or CV_8UC1 of the camera, any size; may be empty
  CameraIntrinsics camera;  ///< of the grid that depth is wanted on
  Eigen::Isometry3d T_base_from_camera = Eigen::Isometry3d::Identity();
  std::vector<Eigen::Vector3f> radar_points;  ///< m, base frame, at the time of the image
  std::vector<Eigen::Vector3f> lidar_points;  ///< m, base frame, at the time of the image
};

/// The parts of DepthInput that an estimator looks at, besides the camera.
struct DepthNeeds {
  bool image = false, radar = false, lidar = false;
};

/// How well the ground plane is known, 1 sigma.
struct GroundUncertainty {
  double pitch_std = 0.02;    ///< rad, of the ground before the vehicle
  double height_std = 0.05;   ///< m
  double relative_std = 0.1;  ///< share of the inverse depth, of what is not flat
};

/// Parameters of makeDepthEstimator; a backend ignores what it does not know.
struct DepthParams {
  std::string backend = "radar_ground";  ///< "radar_ground"; "lidar"; "torch", a network; or a registered one
  double max_depth = 120.0;              ///< m; farther is unknown
  /// 1 sigma of the inverse depth, share of it, of a backend that knows nothing better: "torch", and external
  /// somebody else.
  double relative_std = 0.1;

  // radar_ground
  double ground_pitch = 0.0;   ///< rad, of the ground against the base frame's x-y plane; nose down positive
  double ground_height = 0.0;  ///< m, of the ground in the base frame
  double column_height = 1.6;  ///< m, of the upright column a radar return stands for
  double column_half_width = 0.9;  ///< m, at least as wide as azimuth_std makes it
  double azimuth_std = 0.0175;     ///< rad, 1 sigma of a radar bearing
  /// Moves the borders of columns to edges of the image: heights between 0.6 and 2 times, widths between 0.4
  /// and 1.6 times the expected one. Without an image there is nothing to move to.
  bool image_edges = false;
  /// m, of what is above the horizon and in no column where radar says nothing, and what radar columns in
  /// about the same direction pull nearer; it hides the ground behind it. 0 leaves it unknown.
  double background_depth = 40.0;
  double background_angle = 0.1;                              ///< rad, 1 sigma of "about the same direction"
  double ground_pitch_std = GroundUncertainty{}.pitch_std;    ///< rad, as groundRelativeStd
  double ground_height_std = GroundUncertainty{}.height_std;  ///< m
  double ground_relative_std = GroundUncertainty{}.relative_std;  ///< share of the inverse depth
  double column_std = 0.35;     ///< 1 sigma of the inverse depth in a column, share of it
  double background_std = 0.5;  ///< the same of the background

  // lidar
  /// px at 1600 px image width: largest gap between points that is filled. Beams of a 32-beam lidar are
  /// 30 px apart.
  int completion_kernel = 40;
  double lidar_std = 0.005;  ///< 1 sigma of the inverse depth where a point is, share of it
  /// Share per px at 1600 px image width to the nearest point: sigma^2 = lidar_std^2 + (this px)^2.
  double completion_std = 0.0012;

  NetworkParams network;  ///< torch: with JustDepth's signature, see just_depth.h
};

/// Metric depth (m along the optical axis, CV_32FC1) on the grid of the input's camera; NaN = unknown.
class DepthEstimator {
 public:
  virtual ~DepthEstimator() = default;
  /// @throws std::invalid_argument when what this estimator needs is not there, saying what.
  virtual cv::Mat estimate(const DepthInput& input) = 0;
  virtual DepthNeeds needs() const = 0;
  /// How uncertain a depth is: 1 sigma of the inverse depth as share of it, CV_32FC1 on the grid of the
  /// depth; NaN where that is unknown. The same constant for every pixel where a backend knows nothing
  /// better.
  /// @param input  that the depth was estimated from
  /// @param depth  CV_32FC1, m: by estimate() of this backend; more of it may be unknown
  /// @throws std::invalid_argument where input and depth do not go together
  virtual cv::Mat relativeStd(const DepthInput& input, const cv::Mat& depth) const;
};

/// The same 1 sigma (share of the inverse depth) for every pixel whose depth is known: CV_32FC1, NaN
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

/// Depth of the ground plane (z = height in the base frame, turned by pitch about the base's y axis): NaN at
/// and above the horizon and beyond max_depth.
cv::Mat groundDepth(const CameraIntrinsics& camera, const Eigen::Isometry3d& T_base_from_camera,
                    double height, double pitch, double max_depth);

/// 1 sigma of the inverse depth rho of the ground plane as share of it, CV_32FC1: NaN at and above the
/// horizon.
///
/// With h the height of the camera above the plane straight below it, c_x the camera's place ahead of the
/// base frame's origin, d the ray of a pixel in the base frame (1 m along the optical axis) and s =
/// tan(pitch),
///     rho = (s d_x - d_z) / h,    drho/dheight = rho / h,
///     drho/dpitch = (1 + s^2) (d_x + rho c_x) / h.
/// So the share that the height adds is the same everywhere, height_std / h; that of the pitch grows with the
/// distance ahead, about distance / h. Both and relative_std are independent of each other.
cv::Mat groundRelativeStd(const CameraIntrinsics& camera, const Eigen::Isometry3d& T_base_from_camera,
                          double height, double pitch, const GroundUncertainty& uncertainty);

/// Depth of points seen by the camera, the nearest where several fall on one pixel; NaN elsewhere.
cv::Mat projectedDepth(const std::vector<Eigen::Vector3f>& points_base, const CameraIntrinsics& camera,
                       const Eigen::Isometry3d& T_base_from_camera, double max_depth);

}  // namespace radar_dot
