// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "radar_dot/radar/doppler_returns.h"
#include "radar_dot/radar/motion_model.h"

namespace radar_dot {

/// How the Doppler constraints are solved.
enum class Solver : std::uint8_t {
  kLeastSquares,  ///< every return weighs the same (the paper's LSQ)
  kRansac,        ///< consensus, then least squares on its inliers (the paper's LSQ+RANSAC)
  kRansacRobust,  ///< consensus, then iteratively reweighted least squares (Cauchy weights)
};
std::string_view toString(Solver solver) noexcept;
/// "least_squares", "ransac", "ransac_robust". @throws std::invalid_argument listing them.
Solver solverFromString(std::string_view name);

/// How residuals become static/dynamic labels.
struct SegmentationParams {
  /// The paper's threshold tau on |d + u.v|: in [m/s]. It cuts between the two passes of the
  /// estimate, and it is the final label where `neighbourhood` is off.
  double threshold = 0.8;
  /// Final labels with support from the neighbourhood: a residual above `isolated_threshold` is
  /// dynamic on its own; one above `supported_threshold` only when another return nearby moves
  /// with it. Single returns are mostly clutter; bodies give several.
  bool neighbourhood = true;
  double isolated_threshold = 1.2;   ///< m/s
  double supported_threshold = 0.6;  ///< m/s
  double neighbour_distance = 2.0;   ///< m
  double neighbour_velocity = 1.0;   ///< m/s, largest difference of the two signed residuals
};

/// Parameters of EgoVelocityEstimator.
struct EgoVelocityParams {
  MotionModel model = MotionModel::kPlanarYaw;
  Solver solver = Solver::kRansacRobust;
  /// The paper's two passes: estimate, drop returns beyond the threshold, estimate again (A1, A2);
  /// without it the first estimate stands (B1, B2).
  bool two_pass = true;

  std::uint64_t seed = 1;         ///< same seed and same input: same bits out
  int ransac_iterations = 100;    ///< hypotheses
  double inlier_threshold = 0.3;  ///< m/s; a return is a RANSAC inlier below it
  int robust_iterations = 10;     ///< largest number of reweighted solutions
  double doppler_std = 0.12;      ///< m/s, 1 sigma of one Doppler measurement: weights, covariance
  double azimuth_std = 0.0175;    ///< rad, 1 sigma of a bearing: its effect grows with the transverse speed

  /// m/s, 1 sigma of what all returns of one scan share: quantisation, timing, scale, mount. More
  /// returns do not average it out, so it bounds the covariance from below; 0 = independent returns.
  double scan_std = 0.06;

  int min_returns = 6;             ///< fewer accepted returns: refused
  double min_inlier_share = 0.25;  ///< of the accepted returns; less consensus: refused
  /// Directions of the parameter space that the bearings constrain this much worse than the best
  /// one count as unobserved.
  double max_condition_number = 100.0;
  double sideslip_std = 0.1;         ///< m/s, 1 sigma of the vy that the ackermann model takes as zero
  double unobserved_variance = 1e6;  ///< (m/s)^2 or (rad/s)^2, for what the returns do not tell

  SegmentationParams segmentation;
};

/// @throws std::invalid_argument naming the invalid parameter.
void validate(const EgoVelocityParams& params);

/// One scan of one radar, ready for the estimator. The returns stay with the caller.
struct RadarScan {
  const std::vector<DopplerReturn>* returns = nullptr;
  Eigen::Isometry3d T_base_from_sensor = Eigen::Isometry3d::Identity();
  double time = 0.0;  ///< s, the scan's own stamp
  /// Optional, as long as *returns: nonzero = known to move (from an image mask), kept out of the
  /// estimate and labelled dynamic.
  const std::vector<std::uint8_t>* known_dynamic = nullptr;
  /// rad, counter-clockwise in the base frame: turns the bearings of the scan to where they were when the
  /// velocities were measured. A radar that brings its positions forward by the time T while the vehicle
  /// turns with the rate w needs T w, see ExtractionParams.
  double bearing_rotation = 0.0;
  std::size_t radar = 0;  ///< number of the radar, the same in all sweeps; for sensorVelocities alone
};

/// What became of an estimate.
enum class EstimateStatus : std::uint8_t {
  kOk,
  kTooFewReturns,       ///< fewer accepted returns than min_returns
  kDegenerateBearings,  ///< not even the direction of travel is constrained
  kNoConsensus,         ///< no velocity explains enough of the returns
};
std::string_view toString(EstimateStatus status) noexcept;

/// Label of one return.
enum class ReturnLabel : std::uint8_t { kStatic = 0, kDynamic = 1 };

/// The vehicle's velocity in the base frame, and the residual and label of every return.
/// Arrays run over all scans in the order they were given.
///
/// Where the returns leave directions free, they determine a family of velocities. Its member with
/// the least sideslip is given, `observed` marks the axes that are not determined, and their
/// variance is unobserved_variance along the free directions: what is determined jointly (the
/// velocity at a single radar, say) stays well determined in the covariance.
struct EgoVelocityResult {
  EstimateStatus status = EstimateStatus::kTooFewReturns;
  std::string reason;  ///< empty when valid; else one line with the figures

  Eigen::Vector3d linear = Eigen::Vector3d::Zero();   ///< m/s, of the base origin, base frame
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  ///< rad/s, base frame
  /// Order vx vy vz wx wy wz. Axes outside the model, and directions the bearings do not
  /// constrain, carry unobserved_variance; vy of the ackermann model, which is an assumption of the
  /// model and not a gap in the data, carries sideslip_std^2.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  /// For each axis (vx vy vz wx wy wz): estimated by the model and constrained by the returns.
  std::array<bool, 6> observed{};
  bool fully_observed = false;    ///< every parameter of the motion model is observed
  double condition_number = 0.0;  ///< of the design matrix; infinite when a direction is free
  double rms = 0.0;               ///< m/s, of the inliers' residuals
  std::size_t return_count = 0;   ///< accepted returns that took part
  std::size_t inlier_count = 0;   ///< of them, consistent with the estimate
  std::size_t dynamic_count = 0;

  std::vector<float> residuals;      ///< signed, m/s: d + u.(v + w x t); positive = recedes
  std::vector<ReturnLabel> labels;   ///< by SegmentationParams
  std::vector<std::size_t> offsets;  ///< start of each scan in the two arrays, plus the end

  bool valid() const noexcept { return status == EstimateStatus::kOk; }
};

/// Velocity of a vehicle from one sweep of its radars.
///
/// With mount t and unit bearing u in the base frame a static return obeys
///     d = -u.(v + w x t)   <=>   [u, t x u].[v, w] = -d
/// (the paper's Doppler constraint, extended by the lever arm of the mount). A scan taken at time
/// s is brought to the reference time with the given acceleration a: u.v = -(d + u.a (s - s_ref)).
///
/// Not thread-safe; keeps its memory between calls, so that a steady stream does not allocate.
class EgoVelocityEstimator {
 public:
  /// @throws std::invalid_argument naming the invalid parameter.
  explicit EgoVelocityEstimator(EgoVelocityParams params = {});
  ~EgoVelocityEstimator();
  EgoVelocityEstimator(EgoVelocityEstimator&&) noexcept;
  EgoVelocityEstimator& operator=(EgoVelocityEstimator&&) noexcept;

  /// @param scans           the sweep: one scan of each radar, any number of radars
  /// @param reference_time  s; the estimate holds at this time
  /// @param acceleration    m/s^2, base frame, of the base origin; zero when unknown
  /// @return the result, owned by the estimator and valid until the next call. Bad geometry or
  ///         data refuse with status and reason; nothing throws. Returns that are not finite, or
  ///         whose mount or time is not, take no part and are labelled static.
  const EgoVelocityResult& estimate(const std::vector<RadarScan>& scans, double reference_time,
                                    const Eigen::Vector3d& acceleration = Eigen::Vector3d::Zero());

  const EgoVelocityParams& params() const noexcept { return params_; }

 private:
  struct Workspace;
  EgoVelocityParams params_;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace radar_dot
