// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/sweep_estimator.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "radar_dot/radar/sensor_velocity.h"

namespace radar_dot {
namespace {

// A yaw rate older than this does not tell how far the bearings have turned.
constexpr double kMaxTurningAge = 1.0;  // s

// Mounts move a little between drives, whatever the last one has learnt.
constexpr double kLeastStartStd = 1e-3;  // rad

// A sigma that has shrunk by less has so by rounding.
constexpr double kLearnt = 0.99;

}  // namespace

std::optional<EgoVelocityResult> SweepEstimate::output() const {
  if (filtered) return filteredResult(filtered->state, single);
  return filters || !single.valid() ? std::nullopt : std::optional<EgoVelocityResult>(single);
}

void SweepEstimator::configure(const SweepEstimatorParams& params) {
  // Everything that can throw comes first.
  std::optional<EgoVelocityEstimator> estimator;
  std::optional<VelocityFilter> filter;
  const EgoVelocityParams& present = estimator_.params();
  if (!sameFields(present, params.estimator) || !sameFields(present.sensor, params.estimator.sensor))
    estimator.emplace(params.estimator);
  if (!sameFields(filter_.params(), params.filter_params)) {
    filter.emplace(params.filter_params);
    filter->setMountYawStds(startStds());
  }

  if (estimator) estimator_ = std::move(*estimator);
  if (filter) filter_ = std::move(*filter);
  filters_ = params.filter;
  filters_radars_ = params.filter_radars;
  bearing_delay_ = params.bearing_delay;
}

void SweepEstimator::startFrom(std::vector<std::optional<MountYaw>> mounts) {
  start_ = std::move(mounts);
  filter_.setMountYawStds(startStds());
  reset();
}

std::vector<std::optional<double>> SweepEstimator::startStds() const {
  std::vector<std::optional<double>> stds(start_.size());
  for (std::size_t i = 0; i < start_.size(); ++i)
    if (start_[i]) stds[i] = std::max(start_[i]->std, kLeastStartStd);
  return stds;
}

MountYaw SweepEstimator::mountYaw(std::size_t radar) const {
  const double start = radar < start_.size() && start_[radar] ? start_[radar]->yaw : 0.0;
  return {start + filter_.mountYaw(radar), std::sqrt(filter_.mountYawVariance(radar))};
}

bool SweepEstimator::hasLearnt(std::size_t radar) const {
  return filter_.mountYawVariance(radar) < kLearnt * kLearnt * filter_.startVariance(radar);
}

void SweepEstimator::turnBearings(std::vector<RadarScan>& scans) const {
  for (RadarScan& scan : scans) {
    const bool known = turning_ && std::abs(scan.time - turning_->time) < kMaxTurningAge;
    scan.bearing_rotation = known ? bearing_delay_ * turning_->angular.z() : 0.0;
  }
}

std::optional<StampedTwist> SweepEstimator::latestVelocity() const {
  if (!latest_ || latest_->observes(0) || !filters_ || !filter_.started()) return latest_;
  EgoVelocityResult single;
  single.linear = latest_->linear;
  single.angular = latest_->angular;
  single.covariance = latest_->covariance;
  const EgoVelocityResult filtered = filteredResult(filter_.at(latest_->time), single);
  return StampedTwist{latest_->time, filtered.linear, filtered.angular, filtered.covariance};
}

SweepEstimate SweepEstimator::estimate(std::vector<RadarScan>& scans, double time,
                                       const std::optional<AngularVelocity>& known) {
  if (known && known->rate.allFinite()) turning_ = StampedTwist{time, Eigen::Vector3d::Zero(), known->rate};
  for (RadarScan& scan : scans) {
    if (scan.radar < start_.size() && start_[scan.radar]) {
      scan.T_base_from_sensor.linear() =
          Eigen::AngleAxisd(start_[scan.radar]->yaw, Eigen::Vector3d::UnitZ()) *
          scan.T_base_from_sensor.linear();
    }
  }
  turnBearings(scans);
  const auto latest = DopplerUnwrapping::needed(scans) ? latestVelocity() : std::nullopt;
  SweepEstimate estimate{unwrapping_.estimate(estimator_, scans, time, acceleration(time), latest, known),
                         std::nullopt, filters_ && params().model != MotionModel::kSpatial,
                         unwrapping_.assumption()};
  const EgoVelocityResult& single = estimate.single;
  if (!single.valid()) return estimate;
  latest_ = turning_ = StampedTwist{time, single.linear, single.angular, single.covariance};
  if (single.observed[0]) tracker_.add(time, single.linear);
  if (!estimate.filters) return estimate;

  std::vector<SensorVelocity> sensors;
  // Without a yaw rate the radars contradict one another in every turn.
  if (filters_radars_ && single.sources[5] != AxisSource::kAssumed)
    sensors = sensorVelocities(scans, single, estimator_.params());
  const bool was_started = filter_.started();
  const VelocityFilter::Outcome outcome = filter_.update(time, single, sensors);
  if (outcome != VelocityFilter::Outcome::kStale) {
    estimate.filtered = {filter_.at(time), outcome,
                         was_started && outcome == VelocityFilter::Outcome::kStarted};
  }
  return estimate;
}

void SweepEstimator::reset() {
  tracker_.reset();
  filter_.reset();
  latest_.reset();
  turning_.reset();
}

}  // namespace radar_dot
