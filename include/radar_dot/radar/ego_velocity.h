// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "radar_dot/common/angular_velocity.h"
#include "radar_dot/common/fields.h"
#include "radar_dot/common/radar_noise.h"
#include "radar_dot/common/span.h"
#include "radar_dot/radar/doppler_returns.h"
#include "radar_dot/radar/motion_model.h"

namespace radar_dot {

/// How the Doppler constraints are solved.
enum class Solver : std::uint8_t {
  kLeastSquares,
  kRansac,
  kRansacRobust,
};
template <>
struct EnumNames<Solver> {
  static constexpr EnumName<Solver> kValues[] = {
      {Solver::kLeastSquares, "least_squares", "every return weighs the same (LSQ of the paper)"},
      {Solver::kRansac, "ransac", "consensus, then least squares on its inliers (LSQ+RANSAC of the paper)"},
      {Solver::kRansacRobust, "ransac_robust", "consensus, then reweighted least squares (Cauchy weights)"}};
};

/// How residuals become static/dynamic labels.
struct SegmentationParams {
  double threshold = 0.8;
  // Single returns are mostly clutter; bodies give several.
  bool neighbourhood = true;
  double isolated_threshold = 1.2;
  double supported_threshold = 0.6;
  double neighbour_distance = 2.0;
  double neighbour_velocity = 1.0;

  void describe(FieldList& fields) {
    fields.add(
        "threshold", threshold,
        "Residual |d + u.v| between static and dynamic returns, tau of the paper: between the two passes, "
        "for the filter, and as the final label without neighbourhood",
        "m/s", {0.001, 100.0});
    fields.add("neighbourhood", neighbourhood,
               "Final labels take support from neighbouring returns; otherwise threshold alone decides");
    fields.add("isolated_threshold", isolated_threshold, "Residual that makes a lone return dynamic", "m/s",
               {0.001, 100.0});
    fields.add("supported_threshold", supported_threshold,
               "Residual that makes a return dynamic when a neighbour moves with it", "m/s", {0.001, 100.0});
    describeNeighbours(fields);
  }
  void describeNeighbours(FieldList& fields) {
    fields.add("neighbour_distance", neighbour_distance, "Largest distance between neighbouring returns", "m",
               {0.0, 50.0});
    fields.add("neighbour_velocity", neighbour_velocity,
               "Largest difference between the signed residuals of neighbours", "m/s", {0.0, 50.0});
  }
};

/// Parameters of sensorVelocities; noise and threshold are those of EgoVelocityParams.
struct SensorVelocityParams {
  double sensor_scan_std = 0.02;
  int min_sensor_returns = 3;

  void describe(FieldList& fields) {
    fields.add(
        "sensor_scan_std", sensor_scan_std,
        "1 sigma of the error shared by all returns of a scan beside that of the mount, which the filter "
        "learns: for the velocity of each radar alone",
        "m/s", {0.0, 100.0});
    fields.add("min_sensor_returns", min_sensor_returns,
               "Static returns below which a scan is not used by the filter", "", {1, 1000});
  }
};

/// Parameters of EgoVelocityEstimator.
struct EgoVelocityParams {
  MotionModel model = MotionModel::kPlanarYaw;
  Solver solver = Solver::kRansacRobust;
  bool two_pass = true;
  std::uint64_t seed = 1;
  int ransac_iterations = 100;
  double inlier_threshold = 0.3;
  int robust_iterations = 10;
  RadarNoise noise;
  double scan_std = 0.06;  // more returns do not average it out: it bounds the covariance from below
  int min_returns = 6;
  double min_inlier_fraction = 0.25;
  double max_condition_number = 100.0;
  double sideslip_std = 0.1;
  double unobserved_variance = 1e6;
  SegmentationParams segmentation;
  SensorVelocityParams sensor;

  void describe(FieldList& fields) {
    fields.group("Estimator");
    fields.add("model", model, "Components of the motion of the base frame that are estimated");
    fields.add("solver", solver, "How the Doppler constraints are solved");
    fields.add(
        "two_pass", two_pass,
        "Estimate, drop the returns beyond threshold, estimate again (A1, A2 of the paper); otherwise the "
        "first estimate stands (B1, B2)");
    fields.add("seed", seed, "Seed of the random sampling: same seed and input, same result");
    fields.add("ransac_iterations", ransac_iterations, "Hypotheses of the random sampling", "", {1, 1000000});
    fields.add("inlier_threshold", inlier_threshold, "Residual below which a return supports a hypothesis",
               "m/s", {0.001, 100.0});
    fields.add("robust_iterations", robust_iterations, "Largest number of reweighted solutions", "",
               {1, 100});
    noise.describe(fields);
    fields.add(
        "scan_std", scan_std,
        "1 sigma of the error shared by all returns of one scan (quantisation, timing, scale, mount); 0: "
        "independent returns",
        "m/s", {0.0, 100.0});
    fields.add("min_returns", min_returns, "Accepted returns of a sweep below which there is no estimate", "",
               {3, 1000});
    fields.add("min_inlier_fraction", min_inlier_fraction,
               "Fraction of inliers among the accepted returns below which there is no estimate", "",
               {0.0, 1.0});
    fields.add("max_condition_number", max_condition_number,
               "Directions with a larger condition number are reported as unobserved", "", {1.001, 1e9});
    fields.add("sideslip_std", sideslip_std, "1 sigma of the vy that the ackermann model takes as zero",
               "m/s", {0.001, 100.0});
    fields.add("unobserved_variance", unobserved_variance, "Variance of what the returns do not determine",
               "(m/s)^2 or (rad/s)^2", {1e-3, 1e12});
    fields.group("Segmentation");
    segmentation.describe(fields);
  }
};

/// One scan of one radar, ready for the estimator. The returns stay with the caller.
struct RadarScan {
  Span<const DopplerReturn> returns;
  Eigen::Isometry3d T_base_from_sensor = Eigen::Isometry3d::Identity();
  double time = 0.0;      ///< s, the scan's own stamp
  std::size_t radar = 0;  ///< number of the radar, the same in all sweeps
  /// By return: nonzero = known to move (from an image mask), kept out of the estimate and labelled dynamic.
  /// What is missing at the end, or everything, is not known.
  std::vector<std::uint8_t> known_dynamic = {};
  /// rad, counter-clockwise in the base frame: turns the bearings of the scan to where they were when the
  /// velocities were measured; positions are right as measured. A radar that brings its positions forward by
  /// the time T while the vehicle turns with the rate w needs T w, see SweepEstimatorParams::bearing_delay.
  double bearing_rotation = 0.0;
  /// m/s; range rates of the scan are known modulo twice this, see DopplerUnwrapping.
  double unambiguous_velocity = std::numeric_limits<double>::infinity();

  bool knownDynamic(std::size_t i) const { return i < known_dynamic.size() && known_dynamic[i] != 0; }
};

/// Where an axis of the velocity comes from.
enum class AxisSource : std::uint8_t {
  kAssumed,    ///< zero by the motion model
  kEstimated,  ///< parameter of the model, from the returns
  kGiven,      ///< from the AngularVelocity
};

/// What became of an estimate.
enum class EstimateStatus : std::uint8_t {
  kOk,
  kTooFewReturns,       ///< fewer accepted returns than min_returns
  kDegenerateBearings,  ///< not even the direction of travel is constrained
  kNoConsensus,         ///< no velocity explains enough of the returns
  kAmbiguous,           ///< more than one velocity may be true, as range rates are known modulo an interval
};
template <>
struct EnumNames<EstimateStatus> {
  static constexpr EnumName<EstimateStatus> kValues[] = {
      {EstimateStatus::kOk, "ok"},
      {EstimateStatus::kTooFewReturns, "too few returns"},
      {EstimateStatus::kDegenerateBearings, "degenerate bearings"},
      {EstimateStatus::kNoConsensus, "no consensus"},
      {EstimateStatus::kAmbiguous, "ambiguous Doppler"}};
};

/// Label of one return.
enum class ReturnLabel : std::uint8_t { kStatic = 0, kDynamic = 1 };

/// The vehicle's velocity in the base frame, and the residual and label of every return.
/// Arrays run over all scans in the order they were given.
///
/// Where the returns leave directions free, they determine a family of velocities. Its member with the least
/// sideslip (spatial: the least yaw rate) is given, `observed` marks the axes that are not determined, and
/// each of them has a variance of unobserved_variance or more, along the free directions: what is determined
/// jointly (the velocity at a single radar, say) stays well determined in the covariance.
struct EgoVelocityResult {
  EstimateStatus status = EstimateStatus::kTooFewReturns;
  std::string reason;  ///< empty when valid; else one line with the figures

  Eigen::Vector3d linear = Eigen::Vector3d::Zero();   ///< m/s, of the base origin, base frame
  Eigen::Vector3d angular = Eigen::Vector3d::Zero();  ///< rad/s, base frame
  /// Order vx vy vz wx wy wz. Axes outside the model, and directions the bearings do not
  /// constrain, carry unobserved_variance; vy of the ackermann model, which is an assumption of the
  /// model and not a gap in the data, carries sideslip_std^2. That, and the covariance of a given angular
  /// velocity, widen what is estimated and correlate with it.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  /// For each axis (vx vy vz wx wy wz): estimated by the model and constrained by the returns, or given.
  std::array<bool, 6> observed{};
  std::array<AxisSource, 6> sources{};
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
  /// Nothing is known: zero velocity, every axis with this variance.
  void clearVelocity(double unobserved_variance);
};

/// Velocity of a vehicle from one sweep of its radars.
///
/// With mount t and unit bearing u in the base frame a static return obeys
///     d = -u.(v + w x t)   <=>   [u, t x u].[v, w] = -d
/// (the paper's Doppler constraint, extended by the lever arm of the mount). A scan taken at time
/// s is brought to the reference time with the given acceleration a: u.v = -(d + u.a (s - s_ref)).
/// Where w is known from elsewhere, u.(w x t) goes to the right-hand side, and the yaw rate is no parameter.
///
/// Not thread-safe; keeps its memory between calls, so that a steady stream into one result does not
/// allocate.
class EgoVelocityEstimator {
 public:
  /// @throws std::invalid_argument naming the invalid parameter.
  explicit EgoVelocityEstimator(const EgoVelocityParams& params = {});
  ~EgoVelocityEstimator();
  EgoVelocityEstimator(EgoVelocityEstimator&&) noexcept;
  EgoVelocityEstimator& operator=(EgoVelocityEstimator&&) noexcept;

  /// @param scans           the sweep: one scan of each radar, any number of radars
  /// @param reference_time  s; the estimate holds at this time
  /// @param acceleration    m/s^2, base frame, of the base origin; zero when unknown
  /// @param result          replaced; its memory is used again. Bad geometry or data refuse with status and
  ///         reason; nothing throws. Returns that are not finite, or whose mount or time is not, take no part
  ///         and are labelled static.
  /// @param known           the vehicle's angular velocity where another source tells it; one that is not
  ///                        finite is none
  void estimate(const std::vector<RadarScan>& scans, double reference_time,
                const Eigen::Vector3d& acceleration, EgoVelocityResult& result,
                const std::optional<AngularVelocity>& known = std::nullopt);
  EgoVelocityResult estimate(const std::vector<RadarScan>& scans, double reference_time,
                             const Eigen::Vector3d& acceleration = Eigen::Vector3d::Zero(),
                             const std::optional<AngularVelocity>& known = std::nullopt);

  const EgoVelocityParams& params() const noexcept;

 private:
  struct Workspace;
  std::unique_ptr<Workspace> workspace_;
};

}  // namespace radar_dot
