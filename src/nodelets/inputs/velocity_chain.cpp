// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/velocity_chain.h"

#include <cmath>
#include <utility>

#include "radar_dot/radar/sensor_velocity.h"

namespace radar_dot {
namespace {

// A yaw rate older than this does not tell how far the bearings have turned.
constexpr double kMaxTurningAge = 1.0;  // s

}  // namespace

void VelocityChain::configure(const EgoVelocityConfig& config) {
  // Everything that can throw comes first.
  std::optional<EgoVelocityEstimator> estimator;
  std::optional<VelocityFilter> filter;
  const EgoVelocityParams& params = estimator_.params();
  if (!sameFields(params, config.estimator) || !sameFields(params.sensor, config.estimator.sensor))
    estimator.emplace(config.estimator);
  if (!sameFields(filter_.params(), config.filter_params)) filter.emplace(config.filter_params);

  if (estimator) estimator_ = std::move(*estimator);
  if (filter) filter_ = std::move(*filter);
  filters_ = config.filter;
  bearing_delay_ = config.bearing_delay;
}

double VelocityChain::bearingRotation(double time) const {
  if (!turning_ || std::abs(time - turning_->time) >= kMaxTurningAge) return 0.0;
  return bearing_delay_ * turning_->angular.z();
}

const EgoVelocityResult& VelocityChain::estimate(const std::vector<RadarScan>& scans, double time) {
  const EgoVelocityResult& result = estimator_.estimate(scans, time, tracker_.acceleration(time));
  if (result.valid()) {
    turning_ = StampedTwist{time, result.linear, result.angular};
    if (result.observed[0]) tracker_.add(time, result.linear);
  }
  return result;
}

std::optional<VelocityChain::Filtered> VelocityChain::filtered(double time,
                                                               const std::vector<RadarScan>& scans,
                                                               const EgoVelocityResult& result) {
  const bool was_started = filter_.started();
  const VelocityFilter::Outcome outcome =
      filter_.update(time, result, sensorVelocities(scans, result, estimator_.params()));
  if (outcome == VelocityFilter::Outcome::kStale) return std::nullopt;
  return Filtered{filteredResult(filter_.at(time), result),
                  was_started && outcome == VelocityFilter::Outcome::kStarted};
}

void VelocityChain::reset() {
  tracker_.reset();
  filter_.reset();
  turning_.reset();
}

}  // namespace radar_dot
