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

  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  explicit Workspace(const EgoVelocityParams& parameters) : params(parameters) { validate(params); }

  const EgoVelocityParams params;
  ModelAxes model{};  ///< of this estimate
  std::optional<AngularVelocity> known;
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
  /// The row's element in the column of an axis of vx vy vz wx wy wz: of [u, t x u].
  static float coefficient(const Row& row, int axis) {
    if (axis < 3) return row.bearing[axis];
    const int j = (axis + 1) % 3, k = (axis + 2) % 3;
    return row.bearing[k] * row.mount[j] - row.bearing[j] * row.mount[k];
  }
  void stack(const std::vector<RadarScan>& scans, double reference_time, const Eigen::Vector3d& acceleration);
  void setVariance(const Parameters& solution);
  bool solvePass(const ConstraintSystem& system, bool consensus, Parameters& solution);
  EstimateStatus solve(Observability& observability, Parameters& reduced);
  EstimateStatus noConsensus(std::size_t agreeing, double within);
  EstimateStatus singular();
  void finish(const Observability& observability, const Parameters& reduced);
  ParameterMatrix inverseInformation(double threshold);
  ParameterMatrix reducedCovariance(const ParameterMatrix& inverse, double widening) const;
  void setCovariance(const ParameterMatrix& inverse, double widening, const ParameterMatrix& basis);
  void addGiven(const ParameterMatrix& parameters_from_rows);
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
    Eigen::Vector3d change = acceleration * (reference_time - scan.time);
    if (known) change -= known->rate.cross(scan.T_base_from_sensor.translation());
    const Eigen::Vector3f velocity_change = change.cast<float>();
    for (std::size_t i = 0; i < scan.returns.size(); ++i) {
      const DopplerReturn& measured = scan.returns[i];
      Row row;
      const RotatedReturn seen = rotatedReturn(measured, R_base_from_sensor, scan.bearing_rotation);
      row.bearing = seen.bearing;
      row.mount = mount;
      row.position = (mount + measured.range * (R_base_from_sensor * measured.bearing)).head<2>();
      row.delay = delay;
      // v at the scan = v at the reference time - a (t_ref - t); at the radar, a known w x t more.
      row.right_hand_side = -seen.doppler + row.bearing.dot(velocity_change);
      row.usable = row.mount.allFinite() && row.position.allFinite() && std::isfinite(row.right_hand_side) &&
                   std::isfinite(row.delay);
      if (!row.usable) row = unusableRow();
      row.known_dynamic = scan.knownDynamic(i);
      rows.push_back(row);
    }
  }
  result.offsets.push_back(rows.size());

  all.resize(model.count, rows.size());
  for (std::size_t k = 0; k < static_cast<std::size_t>(model.count); ++k) {
    for (std::size_t i = 0; i < rows.size(); ++i) all.columns[k][i] = coefficient(rows[i], model.axes[k]);
  }
  indices.clear();
  for (std::size_t i = 0; i < rows.size(); ++i) {
    all.right_hand_side[i] = rows[i].right_hand_side;
    all.variance[i] = static_cast<float>(params.noise.doppler_std * params.noise.doppler_std);
    if (!rows[i].usable || rows[i].known_dynamic) continue;
    indices.push_back(i);
    lever_arm = std::max(lever_arm, static_cast<double>(rows[i].mount.head<2>().norm()));
  }
}

/// A bearing that is off by delta shifts the Doppler by delta times the speed across the line of sight.
void EgoVelocityEstimator::Workspace::setVariance(const Parameters& solution) {
  Eigen::Vector3f linear = Eigen::Vector3f::Zero();
  Eigen::Vector3f angular = known ? known->rate.cast<float>() : linear;
  for (int k = 0; k < model.count; ++k) {
    const int axis = model.axes[static_cast<std::size_t>(k)];
    (axis < 3 ? linear[axis] : angular[axis - 3]) = static_cast<float>(solution[k]);
  }
  const auto doppler_variance = static_cast<float>(params.noise.doppler_std * params.noise.doppler_std);
  const auto azimuth_variance = static_cast<float>(params.noise.azimuth_std * params.noise.azimuth_std);
  Eigen::Vector3f sensor_velocity = linear;
  std::size_t scan = 0;  // the next one
  for (std::size_t j = 0; j < indices.size(); ++j) {
    const Row& row = rows[indices[j]];
    if (indices[j] >= result.offsets[scan]) {
      while (indices[j] >= result.offsets[scan]) ++scan;
      sensor_velocity = linear + angular.cross(row.mount);
    }
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
  const bool has_lever_arm = system.parameters == all.parameters && model.estimatesYawRate();
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
  if (observability.rank < std::min(2, model.count) && !only_forward)
    return EstimateStatus::kDegenerateBearings;
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

/// (A' W A)^-1 over the inliers, whose weights stay in the scratch memory.
ParameterMatrix EgoVelocityEstimator::Workspace::inverseInformation(double threshold) {
  const int rank = active.parameters;
  ParameterMatrix information = inlierInformation(active, residuals, threshold, scratch);
  for (int k = rank; k < information.cols(); ++k) information(k, k) = 1.0;
  return information.ldlt().solve(ParameterMatrix::Identity());
}

/// Covariance of weighted least squares, with information I = A' W A and W = 1 / variance:
///     widening I^-1  +  scan_std^2 I^-1 (sum over scans g g') I^-1,   g = A' W 1 over the scan,
/// the second term for an error common to the returns of a scan. `widening` is above 1 where the
/// residuals exceed the noise model. Free directions follow with unobserved_variance.
ParameterMatrix EgoVelocityEstimator::Workspace::reducedCovariance(const ParameterMatrix& inverse,
                                                                   double widening) const {
  const int rank = active.parameters;
  ParameterMatrix gram = ParameterMatrix::Zero();
  Parameters of_scan = Parameters::Zero();
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
  ParameterMatrix covariance =
      widening * inverse + params.scan_std * params.scan_std * inverse * gram * inverse;
  for (int k = rank; k < covariance.cols(); ++k) covariance(k, k) = params.unobserved_variance;
  return covariance;
}

void EgoVelocityEstimator::Workspace::setCovariance(const ParameterMatrix& inverse, double widening,
                                                    const ParameterMatrix& basis) {
  const int rank = active.parameters;
  const int free = model.count - rank;
  ParameterMatrix scaled = basis;
  double least = 1.0;  // fraction of a free axis in the free directions
  for (int i = 0; i < model.count; ++i) {
    const double share = basis.row(i).segment(rank, free).squaredNorm();
    if (share > 0.0) least = std::min(least, share);
    result.observed[static_cast<std::size_t>(model.axes[static_cast<std::size_t>(i)])] = share == 0.0;
  }
  scaled.middleCols(rank, free) /= std::sqrt(least);
  const ParameterMatrix covariance = scaled * reducedCovariance(inverse, widening) * scaled.transpose();
  for (int i = 0; i < model.count; ++i) {
    for (int j = 0; j < model.count; ++j)
      result.covariance(model.axes[static_cast<std::size_t>(i)], model.axes[static_cast<std::size_t>(j)]) =
          covariance(i, j);
  }
  addGiven(basis.leftCols(rank) * inverse.topRows(rank));
}

/// What is not estimated but has a variance, vy of the ackermann model and a known angular velocity, moves
/// the solution by -(A' W A)^-1 A' W C times its error, with the columns C of its axes.
/// @param parameters_from_rows  (A' W A)^-1, from the parameters of `active` to those of the model
void EgoVelocityEstimator::Workspace::addGiven(const ParameterMatrix& parameters_from_rows) {
  const bool no_sideslip = params.model == MotionModel::kAckermann;
  if (!no_sideslip && !known) return;
  Matrix6 given = Matrix6::Zero();
  if (no_sideslip) given(1, 1) = params.sideslip_std * params.sideslip_std;
  if (known) given.bottomRightCorner<3, 3>() = known->covariance;
  Matrix6 spread = Matrix6::Zero();
  for (int axis = 1; axis < 6; ++axis) {
    if (!(no_sideslip && axis == 1) && !(known && axis >= 3)) continue;
    spread(axis, axis) = 1.0;
    result.covariance(axis, axis) = 0.0;
    if (axis >= 3) {
      result.angular[axis - 3] = known->rate[axis - 3];
      result.observed[static_cast<std::size_t>(axis)] = true;
      result.sources[static_cast<std::size_t>(axis)] = AxisSource::kGiven;
    }
    scratch.residuals.resize(active.rows);
    for (std::size_t i = 0; i < active.rows; ++i)
      scratch.residuals[i] = coefficient(rows[indices[i]], axis) * scratch.weights[i];
    const Eigen::Map<const Eigen::ArrayXf> column(scratch.residuals.data(),
                                                  static_cast<Eigen::Index>(active.rows));
    Parameters moments = Parameters::Zero();
    for (int k = 0; k < active.parameters; ++k)
      moments[k] = static_cast<double>((column * active.column(k)).sum());
    const Parameters moved = -(parameters_from_rows * moments);
    for (int k = 0; k < model.count; ++k) spread(model.axes[static_cast<std::size_t>(k)], axis) = moved[k];
  }
  result.covariance += spread * given * spread.transpose();
}

void EgoVelocityEstimator::Workspace::finish(const Observability& observability, const Parameters& reduced) {
  const int rank = active.parameters;
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
  const ParameterMatrix basis = removeTrails(observability.basis, rank, model.count);
  const Parameters solution = likeliestMember(model, basis, rank, basis.leftCols(rank) * reduced.head(rank));
  for (int i = 0; i < model.count; ++i) {
    const int axis = model.axes[static_cast<std::size_t>(i)];
    (axis < 3 ? result.linear[axis] : result.angular[axis - 3]) = solution[i];
    result.sources[static_cast<std::size_t>(axis)] = AxisSource::kEstimated;
  }
  result.fully_observed = rank == model.count;
  setCovariance(inverseInformation(threshold), widening, basis);

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
  sources.fill(AxisSource::kAssumed);
  fully_observed = false;
}

EgoVelocityEstimator::EgoVelocityEstimator(const EgoVelocityParams& params)
    : workspace_(std::make_unique<Workspace>(params)) {}
EgoVelocityEstimator::~EgoVelocityEstimator() = default;
EgoVelocityEstimator::EgoVelocityEstimator(EgoVelocityEstimator&&) noexcept = default;
EgoVelocityEstimator& EgoVelocityEstimator::operator=(EgoVelocityEstimator&&) noexcept = default;

const EgoVelocityParams& EgoVelocityEstimator::params() const noexcept { return workspace_->params; }

EgoVelocityResult EgoVelocityEstimator::estimate(const std::vector<RadarScan>& scans, double reference_time,
                                                 const Eigen::Vector3d& acceleration,
                                                 const std::optional<AngularVelocity>& known) {
  EgoVelocityResult result;
  estimate(scans, reference_time, acceleration, result, known);
  return result;
}

void EgoVelocityEstimator::estimate(const std::vector<RadarScan>& scans, double reference_time,
                                    const Eigen::Vector3d& acceleration, EgoVelocityResult& result,
                                    const std::optional<AngularVelocity>& known) {
  Workspace& w = *workspace_;
  w.known = known && known->rate.allFinite() && known->covariance.allFinite() ? known : std::nullopt;
  w.model = axesOf(w.params.model, w.known.has_value());
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
