// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "sweep_velocities.h"

#include <algorithm>
#include <iterator>
#include <memory>
#include <utility>

#include "radar_dot/radar/sensor_velocity.h"
#include "radar_dot/radar/sweep_assembler.h"

namespace radar_dot::evaluation {
namespace {

constexpr double kMaxVelocityAge = 1.0;  // s

/// Every sweep of the scene, assembled as on a vehicle where each scan arrives at its stamp.
std::vector<Sweep> assembleSweeps(const RadarScene& scene, const VelocityEvaluationOptions& options) {
  std::vector<SweepScan> arrivals;
  for (std::size_t radar = 0; radar < scene.radars.size(); ++radar) {
    for (const LoadedScan& scan : scene.radars[radar].scans) {
      // Not owned: the scene outlives its sweeps.
      arrivals.push_back(
          {radar, scan.time, std::shared_ptr<const void>(std::shared_ptr<const void>(), &scan)});
    }
  }
  std::stable_sort(arrivals.begin(), arrivals.end(),
                   [](const SweepScan& a, const SweepScan& b) { return a.time < b.time; });
  SweepAssembler assembler(scene.radars.size(), options.ego_velocity.sweep);
  std::vector<Sweep> sweeps;
  std::vector<Sweep> completed;
  for (SweepScan& scan : arrivals) {
    assembler.add(std::move(scan), completed);
    std::move(completed.begin(), completed.end(), std::back_inserter(sweeps));
  }
  return sweeps;
}

/// The filter as on a vehicle, which hears of every valid estimate.
class SweepFilter {
 public:
  explicit SweepFilter(const VelocityEvaluationOptions& options)
      : with_radars_(options.filter_radars),
        params_(options.ego_velocity.estimator),
        filter_(options.ego_velocity.filter_params) {}

  void add(double time, const std::vector<RadarScan>& scans, const EgoVelocityResult& result,
           SweepVelocities& sweeps) {
    std::vector<SensorVelocity> sensors;
    if (with_radars_) sensors = sensorVelocities(scans, result, params_);
    switch (filter_.update(time, result, sensors)) {
      case VelocityFilter::Outcome::kRejected: ++sweeps.filter_rejected; break;
      case VelocityFilter::Outcome::kStarted: ++sweeps.filter_starts; break;
      case VelocityFilter::Outcome::kUpdated: break;
      case VelocityFilter::Outcome::kStale: return;
    }
    sweeps.filtered.emplace_back(filter_.at(time), result);
  }

 private:
  bool with_radars_;
  EgoVelocityParams params_;
  VelocityFilter filter_;
};

}  // namespace

EstimatedVelocity::EstimatedVelocity(double stamp, const EgoVelocityResult& result)
    : StampedTwist{stamp, result.linear, result.angular, result.covariance}, observed(result.observed) {}

EstimatedVelocity::EstimatedVelocity(const VelocityFilter::State& state, const EgoVelocityResult& result)
    : EstimatedVelocity(state.time, filteredResult(state, result)) {
  acceleration = state.acceleration;
}

EstimatedVelocity EstimatedVelocity::broughtTo(double when) const {
  EstimatedVelocity moved = *this;
  const double dt = when - time;
  moved.time = when;
  moved.linear.head<2>() += dt * acceleration.head<2>();
  moved.angular.z() += dt * acceleration.z();
  return moved;
}

const EstimatedVelocity* latestAt(const std::vector<EstimatedVelocity>& velocities, double time) {
  const auto after =
      std::upper_bound(velocities.begin(), velocities.end(), time,
                       [](double t, const EstimatedVelocity& velocity) { return t < velocity.time; });
  return after == velocities.begin() ? nullptr : &*std::prev(after);
}

Eigen::Vector3d accelerationAt(const std::vector<EstimatedVelocity>& velocities, double time) {
  AccelerationTracker tracker;
  for (const EstimatedVelocity& velocity : velocities) {
    if (velocity.time > time) break;
    if (time - velocity.time < kMaxVelocityAge) tracker.add(velocity.time, velocity.linear);
  }
  return tracker.acceleration(time);
}

double yawRateAt(const std::vector<EstimatedVelocity>& velocities, double time) {
  const EstimatedVelocity* latest = latestAt(velocities, time);
  return latest != nullptr && time - latest->time < kMaxVelocityAge ? latest->angular.z() : 0.0;
}

void turnBearings(std::vector<RadarScan>& scans, double bearing_delay, double yaw_rate) {
  for (RadarScan& scan : scans) scan.bearing_rotation = bearing_delay * yaw_rate;
}

SavedMasks::SavedMasks(const dataset::Tables& tables, dataset::Index scene,
                       const VelocityEvaluationOptions& options)
    : feedback_(options.ego_velocity) {
  if (!options.masks.directory.empty())
    folder_.emplace(tables, scene, options.masks.directory, options.masks.channel, options.masks.delay);
}

void SavedMasks::mark(std::vector<RadarScan>& scans, const std::vector<EstimatedVelocity>& velocities,
                      double time) {
  if (!folder_) return;
  const EstimatedVelocity* latest = latestAt(velocities, time);
  if (latest == nullptr) return;
  feedback_.mark(
      scans, [this](double scan_time) { return folder_->before(scan_time); }, *latest);
}

SweepVelocities sweepVelocities(const RadarScene& scene, const VelocityEvaluationOptions& options,
                                SavedMasks& masks) {
  SweepVelocities sweeps;
  EgoVelocityEstimator estimator(options.ego_velocity.estimator);
  AccelerationTracker tracker;
  SweepFilter filter(options);
  for (const Sweep& sweep : assembleSweeps(scene, options)) {
    std::vector<RadarScan> scans;
    for (const SweepScan& scan : sweep.scans) {
      const auto* loaded = static_cast<const LoadedScan*>(scan.reading.get());
      scans.push_back({&loaded->returns, scene.radars[scan.radar].T_base_from_sensor, scan.time, nullptr});
      scans.back().radar = scan.radar;
    }
    ++sweeps.count;
    masks.mark(scans, sweeps.velocities, sweep.time());
    turnBearings(scans, options.ego_velocity.bearing_delay, yawRateAt(sweeps.velocities, sweep.time()));
    const EgoVelocityResult& result =
        estimator.estimate(scans, sweep.time(), tracker.acceleration(sweep.time()));
    if (!result.valid()) {
      ++sweeps.refused;
      continue;
    }
    if (result.observed[0]) tracker.add(sweep.time(), result.linear);
    sweeps.velocities.emplace_back(sweep.time(), result);
    if (options.ego_velocity.filter) filter.add(sweep.time(), scans, result, sweeps);
  }
  return sweeps;
}

}  // namespace radar_dot::evaluation
