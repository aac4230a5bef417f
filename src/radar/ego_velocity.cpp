// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/ego_velocity.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <utility>

#include "constraint_system.h"
#include "model_axes.h"
#include "rotated_return.h"
#include "segmentation.h"

namespace radar_dot {

/// The stages of one estimate, and the memory they keep.
struct EgoVelocityEstimator::Workspace {
  struct Row {
    Eigen::Vector3f bearing;   ///< base frame
    Eigen::Vector3f mount;     ///< base frame, m
    Eigen::Vector2f position;  ///< of the return, base frame at the scan's time, m
    float delay;               ///< s, reference time - scan time
    float right_hand_side;     ///< -d at the reference time, m/s
    bool known_dynamic;
    bool usable;  ///< finite; else the row is zero and takes no part
  };

  explicit Workspace(const EgoVelocityParams& parameters) : params(parameters) { validate(params); }

  const EgoVelocityParams params;
  std::vector<Row> rows;
  ConstraintSystem all;              ///< every accepted return, the model's own parameters
  ConstraintSystem active;           ///< returns that may be static, reduced to the observed directions
  ConstraintSystem pass;             ///< scratch: a subset of rows of one of the above
  std::vector<std::size_t> indices;  ///< rows of `active` in `all`
  std::vector<std::size_t> subset;
  SolverScratch scratch;
  std::vector<float> residuals;  ///< of `active`
  std::vector<Eigen::Vector2f> positions;
  std::vector<std::size_t> candidates;
  double lever_arm = 0.0;    ///< m, the largest of a usable row
  EgoVelocityResult result;  ///< during an estimate, in the memory of the caller

  static Row unusableRow() {
    return {
        Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero(), Eigen::Vector2f::Zero(), 0.F, 0.F, false, false};
  }
  void stack(const std::vector<RadarScan>& scans, double reference_time, const Eigen::Vector3d& acceleration);
  void setVariance(const Parameters& solution);
  bool solvePass(const ConstraintSystem& system, bool consensus, Parameters& solution);
  EstimateStatus solve(Observability& observability, Parameters& reduced);
  EstimateStatus noConsensus(std::size_t agreeing, double within);
  EstimateStatus singular();
  void finish(const Observability& observability, const Parameters& reduced);
  Eigen::Matrix3d reducedCovariance(double threshold, double widening);
  void label();
  void refuse(EstimateStatus status);

  static void gather(const ConstraintSystem& from, const std::vector<std::size_t>& which,
                     ConstraintSystem& to);
  double inlierThreshold() const {
    return params.solver == Solver::kLeastSquares ? params.segmentation.threshold : params.inlier_threshold;
  }
};

void EgoVelocityEstimator::Workspace::gather(const ConstraintSystem& from,
                                             const std::vector<std::size_t>& which, ConstraintSystem& to) {
  to.resize(from.parameters, which.size());
  for (std::size_t i = 0; i < which.size(); ++i) {
    for (std::size_t k = 0; k < static_cast<std::size_t>(from.parameters); ++k) {
      to.columns[k][i] = from.columns[k][which[i]];
    }
    to.right_hand_side[i] = from.right_hand_side[which[i]];
    to.variance[i] = from.variance[which[i]];
  }
}

void EgoVelocityEstimator::Workspace::stack(const std::vector<RadarScan>& scans, double reference_time,
                                            const Eigen::Vector3d& acceleration) {
  rows.clear();
  lever_arm = 0.0;
  result.offsets.clear();
  for (const RadarScan& scan : scans) {
    result.offsets.push_back(rows.size());
    const Eigen::Matrix3f R_base_from_sensor = scan.T_base_from_sensor.linear().cast<float>();
    const Eigen::Vector3f mount = scan.T_base_from_sensor.translation().cast<float>();
    const auto delay = static_cast<float>(reference_time - scan.time);
    const Eigen::Vector3f velocity_change = (acceleration * (reference_time - scan.time)).cast<float>();
    for (std::size_t i = 0; i < scan.returns.size(); ++i) {
      const DopplerReturn& measured = scan.returns[i];
      Row row;
      const RotatedReturn seen = rotatedReturn(measured, R_base_from_sensor, scan.bearing_rotation);
      row.bearing = seen.bearing;
      row.mount = mount;
      row.position = (mount + measured.range * (R_base_from_sensor * measured.bearing)).head<2>();
      row.delay = delay;
      // v at the scan = v at the reference time - a (t_ref - t).
      row.right_hand_side = -seen.doppler + row.bearing.dot(velocity_change);
      row.usable = row.mount.allFinite() && row.position.allFinite() && std::isfinite(row.right_hand_side) &&
                   std::isfinite(row.delay);
      if (!row.usable) row = unusableRow();
      row.known_dynamic = scan.knownDynamic(i);
      rows.push_back(row);
    }
  }
  result.offsets.push_back(rows.size());

  const ModelAxes model = axesOf(params.model);
  all.resize(model.count, rows.size());
  indices.clear();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Eigen::Vector3f& u = rows[i].bearing;
    for (int k = 0; k < model.count; ++k) {
      const int axis = model.axes[static_cast<std::size_t>(k)];
      all.columns[static_cast<std::size_t>(k)][i] =
          axis < 3 ? u[axis] : u.y() * rows[i].mount.x() - u.x() * rows[i].mount.y();  // (t x u)_z
    }
    all.right_hand_side[i] = rows[i].right_hand_side;
    all.variance[i] = static_cast<float>(params.noise.doppler_std * params.noise.doppler_std);
    if (!rows[i].usable || rows[i].known_dynamic) continue;
    indices.push_back(i);
    lever_arm = std::max(lever_arm, static_cast<double>(rows[i].mount.head<2>().norm()));
  }
}

/// A bearing that is off by delta shifts the Doppler by delta times the speed across the line of sight.
void EgoVelocityEstimator::Workspace::setVariance(const Parameters& solution) {
  const ModelAxes model = axesOf(params.model);
  Eigen::Vector3f linear = Eigen::Vector3f::Zero();
  float yaw_rate = 0.F;
  for (int k = 0; k < model.count; ++k) {
    const int axis = model.axes[static_cast<std::size_t>(k)];
    (axis < 3 ? linear[axis] : yaw_rate) = static_cast<float>(solution[k]);
  }
  const auto doppler_variance = static_cast<float>(params.noise.doppler_std * params.noise.doppler_std);
  const auto azimuth_variance = static_cast<float>(params.noise.azimuth_std * params.noise.azimuth_std);
  for (std::size_t j = 0; j < indices.size(); ++j) {
    const Row& row = rows[indices[j]];
    const Eigen::Vector3f sensor_velocity =
        linear + Eigen::Vector3f(-yaw_rate * row.mount.y(), yaw_rate * row.mount.x(), 0.F);
    const float along = row.bearing.dot(sensor_velocity);
    const float across_squared = std::max(0.F, sensor_velocity.squaredNorm() - along * along);
    active.variance[j] = doppler_variance + azimuth_variance * across_squared;
  }
}

bool EgoVelocityEstimator::Workspace::solvePass(const ConstraintSystem& system, bool consensus,
                                                Parameters& solution) {
  if (params.solver == Solver::kLeastSquares) return solveLeastSquares(system, solution, scratch);
  if (!consensus) return refineRobust(system, params.robust_iterations, solution, scratch);
  // Directions of a projected system are of length 1; the yaw rate has the lever arm as its column.
  const bool has_lever_arm = system.parameters == all.parameters && params.model != MotionModel::kPlanar &&
                             params.model != MotionModel::kSpatial;
  const RansacParams ransac{params.seed, params.ransac_iterations, params.inlier_threshold,
                            has_lever_arm ? lever_arm : 1.0};
  return solveRansac(system, ransac, solution, scratch) &&
         solveInliers(system, params.inlier_threshold, solution, scratch);
}

EstimateStatus EgoVelocityEstimator::Workspace::solve(Observability& observability, Parameters& reduced) {
  result.return_count = indices.size();
  if (indices.size() < static_cast<std::size_t>(params.min_returns)) return EstimateStatus::kTooFewReturns;

  gather(all, indices, pass);
  observability = analyseObservability(pass, params.max_condition_number);
  result.condition_number = observability.condition_number;
  const bool only_forward = params.model == MotionModel::kAckermann && observability.rank == 1 &&
                            std::abs(observability.basis(0, 0)) > 0.999;
  if (observability.rank < 2 && !only_forward) return EstimateStatus::kDegenerateBearings;
  if (observability.rank < all.parameters) {
    projectSystem(pass, observability, active);
  } else {
    std::swap(active, pass);
  }
  const auto fullSolution = [&] {
    return Parameters(observability.basis.leftCols(active.parameters) * reduced.head(active.parameters));
  };

  const bool robust = params.solver == Solver::kRansacRobust;
  if (!solvePass(active, true, reduced)) return singular();
  setVariance(fullSolution());
  if (robust && !solvePass(active, false, reduced)) return singular();
  if (!params.two_pass) return EstimateStatus::kOk;

  // The paper's second pass: only returns whose residual lies below tau.
  evaluateResiduals(active, reduced, residuals);
  const auto tau = static_cast<float>(params.segmentation.threshold);
  subset.clear();
  for (std::size_t i = 0; i < active.rows; ++i) {
    if (std::abs(residuals[i]) < tau) subset.push_back(i);
  }
  if (subset.size() < static_cast<std::size_t>(params.min_returns))
    return noConsensus(subset.size(), params.segmentation.threshold);
  if (subset.size() == active.rows && params.solver != Solver::kRansac) return EstimateStatus::kOk;
  gather(active, subset, pass);
  return solvePass(pass, !robust, reduced) ? EstimateStatus::kOk : EstimateStatus::kDegenerateBearings;
}

EstimateStatus EgoVelocityEstimator::Workspace::noConsensus(std::size_t agreeing, double within) {
  result.inlier_count = agreeing;
  result.reason = fmt::format("only {} of {} returns agree on one velocity within {:.2f} m/s", agreeing,
                              result.return_count, within);
  return EstimateStatus::kNoConsensus;
}

EstimateStatus EgoVelocityEstimator::Workspace::singular() {
  result.reason = fmt::format("no velocity found for {} returns: their bearings are too close to parallel",
                              result.return_count);
  return EstimateStatus::kNoConsensus;
}

/// Covariance of weighted least squares, with information I = A' W A and W = 1 / variance:
///     widening I^-1  +  scan_std^2 I^-1 (sum over scans g g') I^-1,   g = A' W 1 over the scan,
/// the second term for an error common to the returns of a scan. `widening` is above 1 where the
/// residuals exceed the noise model. Free directions follow with unobserved_variance.
Eigen::Matrix3d EgoVelocityEstimator::Workspace::reducedCovariance(double threshold, double widening) {
  const int rank = active.parameters;
  Eigen::Matrix3d information = inlierInformation(active, residuals, threshold, scratch);
  for (int k = rank; k < 3; ++k) information(k, k) = 1.0;
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  Eigen::Vector3d of_scan = Eigen::Vector3d::Zero();
  std::size_t scan = 0;
  for (std::size_t i = 0; i <= active.rows; ++i) {
    while (i == active.rows ? scan + 1 < result.offsets.size() : indices[i] >= result.offsets[scan + 1]) {
      gram += of_scan * of_scan.transpose();
      of_scan.setZero();
      ++scan;
    }
    if (i == active.rows) break;
    for (int k = 0; k < rank; ++k) {
      of_scan[k] += static_cast<double>(scratch.weights[i] * active.columns[static_cast<std::size_t>(k)][i]);
    }
  }
  const Eigen::Matrix3d inverse = information.ldlt().solve(Eigen::Matrix3d::Identity());
  Eigen::Matrix3d covariance =
      widening * inverse + params.scan_std * params.scan_std * inverse * gram * inverse;
  for (int k = rank; k < 3; ++k) covariance(k, k) = params.unobserved_variance;
  return covariance;
}

void EgoVelocityEstimator::Workspace::finish(const Observability& observability, const Parameters& reduced) {
  const int rank = active.parameters;
  const ModelAxes model = axesOf(params.model);
  evaluateResiduals(active, reduced, residuals);
  double sum = 0.0;
  double chi_squared = 0.0;
  const double threshold = inlierThreshold();
  for (std::size_t i = 0; i < active.rows; ++i) {
    const double e = static_cast<double>(residuals[i]);
    if (std::abs(e) >= threshold) continue;
    ++result.inlier_count;
    sum += e * e;
    chi_squared += e * e / static_cast<double>(active.variance[i]);
  }
  if (result.inlier_count > 0) result.rms = std::sqrt(sum / static_cast<double>(result.inlier_count));

  const double freedom = static_cast<double>(result.inlier_count) - rank;
  const double widening = freedom > 0.0 ? std::max(1.0, chi_squared / freedom) : 1.0;
  const Eigen::Matrix3d reduced_covariance = reducedCovariance(threshold, widening);
  const Eigen::Matrix3d basis = removeTrails(observability.basis, rank, model.count);
  const Parameters solution =
      leastSideslipMember(model, basis, rank, basis.leftCols(rank) * reduced.head(rank));
  const Eigen::Matrix3d covariance = basis * reduced_covariance * basis.transpose();

  if (params.model == MotionModel::kAckermann)
    result.covariance(1, 1) = params.sideslip_std * params.sideslip_std;
  result.fully_observed = rank == model.count;
  for (int i = 0; i < model.count; ++i) {
    const int row_axis = model.axes[static_cast<std::size_t>(i)];
    (row_axis < 3 ? result.linear[row_axis] : result.angular[row_axis - 3]) = solution[i];
    result.observed[static_cast<std::size_t>(row_axis)] =
        basis.row(i).segment(rank, model.count - rank).isZero(0.0);
    for (int j = 0; j < model.count; ++j) {
      result.covariance(row_axis, model.axes[static_cast<std::size_t>(j)]) = covariance(i, j);
    }
  }

  if (!solution.allFinite() || !result.covariance.allFinite()) {
    result.status = EstimateStatus::kDegenerateBearings;
  } else if (result.inlier_count < static_cast<std::size_t>(params.min_returns) ||
             static_cast<double>(result.inlier_count) <
                 params.min_inlier_fraction * static_cast<double>(result.return_count)) {
    result.status = noConsensus(result.inlier_count, threshold);
  } else {
    evaluateResiduals(all, solution, result.residuals);
  }
}

void EgoVelocityEstimator::Workspace::label() {
  // Where a static return stands at the reference time: it moves by -(v + w x p) in the base frame.
  positions.resize(rows.size());
  const Eigen::Vector2f v = result.linear.head<2>().cast<float>();
  const auto w = static_cast<float>(result.angular.z());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Eigen::Vector2f& p = rows[i].position;
    positions[i] = p - rows[i].delay * (v + w * Eigen::Vector2f(-p.y(), p.x()));
  }
  segmentReturns(params.segmentation, result.residuals, positions, candidates, result.labels);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].known_dynamic) result.labels[i] = ReturnLabel::kDynamic;
    if (result.labels[i] == ReturnLabel::kDynamic) ++result.dynamic_count;
  }
}

void EgoVelocityEstimator::Workspace::refuse(EstimateStatus status) {
  result.status = status;
  switch (status) {
    case EstimateStatus::kOk:
    case EstimateStatus::kNoConsensus:
    case EstimateStatus::kAmbiguous: break;  // whoever found it has said why
    case EstimateStatus::kTooFewReturns:
      result.reason = fmt::format("{} accepted returns, {} needed", result.return_count, params.min_returns);
      break;
    case EstimateStatus::kDegenerateBearings:
      result.reason = fmt::format("the bearings of {} returns do not constrain the {} model",
                                  result.return_count, std::string(toString(params.model)));
      break;
  }
  result.clearVelocity(params.unobserved_variance);
  result.residuals.clear();
  result.labels.clear();
}

void EgoVelocityResult::clearVelocity(double unobserved_variance) {
  linear.setZero();
  angular.setZero();
  covariance = Eigen::Matrix<double, 6, 6>::Identity() * unobserved_variance;
  observed.fill(false);
  fully_observed = false;
}

EgoVelocityEstimator::EgoVelocityEstimator(const EgoVelocityParams& params)
    : workspace_(std::make_unique<Workspace>(params)) {}
EgoVelocityEstimator::~EgoVelocityEstimator() = default;
EgoVelocityEstimator::EgoVelocityEstimator(EgoVelocityEstimator&&) noexcept = default;
EgoVelocityEstimator& EgoVelocityEstimator::operator=(EgoVelocityEstimator&&) noexcept = default;

const EgoVelocityParams& EgoVelocityEstimator::params() const noexcept { return workspace_->params; }

EgoVelocityResult EgoVelocityEstimator::estimate(const std::vector<RadarScan>& scans, double reference_time,
                                                 const Eigen::Vector3d& acceleration) {
  EgoVelocityResult result;
  estimate(scans, reference_time, acceleration, result);
  return result;
}

void EgoVelocityEstimator::estimate(const std::vector<RadarScan>& scans, double reference_time,
                                    const Eigen::Vector3d& acceleration, EgoVelocityResult& result) {
  Workspace& w = *workspace_;
  w.result = std::move(result);
  w.result.reason.clear();
  w.result.clearVelocity(w.params.unobserved_variance);
  w.result.condition_number = w.result.rms = 0.0;
  w.result.return_count = w.result.inlier_count = w.result.dynamic_count = 0;

  w.stack(scans, reference_time, acceleration);
  Observability observability;
  Parameters reduced = Parameters::Zero();
  w.result.status = w.solve(observability, reduced);
  if (w.result.valid()) w.finish(observability, reduced);
  if (w.result.valid()) {
    w.label();
  } else {
    w.refuse(w.result.status);
  }
  result = std::move(w.result);
}

}  // namespace radar_dot
