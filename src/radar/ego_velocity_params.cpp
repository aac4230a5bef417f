// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <stdexcept>
#include <string>

#include "radar_dot/radar/ego_velocity.h"

namespace radar_dot {
namespace {

void requireParameter(bool condition, const char* message) {
  if (!condition) throw std::invalid_argument(message);
}

}  // namespace

void validate(const EgoVelocityParams& p) {
  requireParameter(p.ransac_iterations >= 1, "ransac_iterations must be at least 1");
  requireParameter(p.inlier_threshold > 0.0, "inlier_threshold must be positive (m/s)");
  requireParameter(p.robust_iterations >= 1, "robust_iterations must be at least 1");
  requireParameter(p.doppler_std > 0.0, "doppler_std must be positive (m/s)");
  requireParameter(p.azimuth_std >= 0.0, "azimuth_std must not be negative (rad)");
  requireParameter(p.scan_std >= 0.0, "scan_std must not be negative (m/s)");
  requireParameter(p.min_returns >= 3, "min_returns must be at least 3");
  requireParameter(p.min_inlier_share >= 0.0 && p.min_inlier_share <= 1.0,
                   "min_inlier_share must lie in 0..1");
  requireParameter(p.max_condition_number > 1.0, "max_condition_number must be above 1");
  requireParameter(p.sideslip_std > 0.0, "sideslip_std must be positive (m/s)");
  requireParameter(p.unobserved_variance > 0.0, "unobserved_variance must be positive");
  const SegmentationParams& s = p.segmentation;
  requireParameter(s.threshold > 0.0, "segmentation threshold must be positive (m/s)");
  requireParameter(s.isolated_threshold > 0.0 && s.supported_threshold > 0.0,
                   "isolated_threshold and supported_threshold must be positive (m/s)");
  requireParameter(s.neighbour_distance >= 0.0 && s.neighbour_velocity >= 0.0,
                   "neighbour_distance and neighbour_velocity must not be negative");
}

std::string_view toString(Solver solver) noexcept {
  switch (solver) {
    case Solver::kLeastSquares: return "least_squares";
    case Solver::kRansac: return "ransac";
    case Solver::kRansacRobust: return "ransac_robust";
  }
  return "unknown";
}

Solver solverFromString(std::string_view name) {
  for (const Solver solver : {Solver::kLeastSquares, Solver::kRansac, Solver::kRansacRobust}) {
    if (name == toString(solver)) return solver;
  }
  throw std::invalid_argument("solver '" + std::string(name) +
                              "' is not one of least_squares, ransac, ransac_robust");
}

std::string_view toString(EstimateStatus status) noexcept {
  switch (status) {
    case EstimateStatus::kOk: return "ok";
    case EstimateStatus::kTooFewReturns: return "too few returns";
    case EstimateStatus::kDegenerateBearings: return "degenerate bearings";
    case EstimateStatus::kNoConsensus: return "no consensus";
  }
  return "unknown";
}

}  // namespace radar_dot
