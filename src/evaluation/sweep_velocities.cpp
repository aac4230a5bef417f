// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "sweep_velocities.h"

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>
#include <utility>

#include "radar_dot/radar/sweep_assembler.h"

namespace radar_dot::evaluation {

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

std::vector<SceneSweep> assembleSweeps(const RadarScene& scene, const SweepParams& params) {
  using Assembler = SweepAssembler<RadarScan>;
  std::vector<Assembler::Scan> arrivals;
  for (const LoadedRadar& radar : scene.radars)
    for (std::size_t i = 0; i < radar.scans.size(); ++i)
      arrivals.push_back({radar.number, radar.scans[i].time, radar.scan(i)});
  std::stable_sort(arrivals.begin(), arrivals.end(),
                   [](const Assembler::Scan& a, const Assembler::Scan& b) { return a.time < b.time; });
  Assembler assembler(scene.radars.size(), params);
  std::vector<SceneSweep> sweeps;
  std::vector<Assembler::Sweep> completed;
  for (Assembler::Scan& arrival : arrivals) {
    const double now = arrival.time;
    assembler.add(std::move(arrival), completed);
    for (const Assembler::Sweep& sweep : completed) {
      sweeps.push_back({sweep.time(), now, {}});
      for (const Assembler::Scan& scan : sweep.scans) sweeps.back().scans.push_back(scan.reading);
    }
  }
  return sweeps;
}

std::vector<std::vector<std::vector<ReturnLabel>>> returnLabels(const RadarScene& scene) {
  std::vector<std::vector<std::vector<ReturnLabel>>> labels;
  for (const LoadedRadar& radar : scene.radars) labels.emplace_back(radar.scans.size());
  std::vector<SceneSweep> sweeps = assembleSweeps(scene, scene.config.sweep);
  SweepEstimator estimator(scene.config);
  for (SceneSweep& sweep : sweeps) {
    const EgoVelocityResult result = estimator.estimate(sweep.scans, sweep.time).single;
    if (!result.valid()) continue;
    for (std::size_t i = 0; i < sweep.scans.size(); ++i) {
      const RadarScan& scan = sweep.scans[i];
      const std::optional<std::size_t> index = nearestScan(scene.radars[scan.radar], scan.time, 0.0);
      const auto begin = result.labels.begin();
      labels[scan.radar][index.value()].assign(begin + static_cast<std::ptrdiff_t>(result.offsets[i]),
                                               begin + static_cast<std::ptrdiff_t>(result.offsets[i + 1]));
    }
  }
  return labels;
}

SweepRunner::SweepRunner(const dataset::Tables& tables, dataset::Index index, const RadarScene& scene,
                         const VelocityEvaluationOptions& options)
    : config_(options.ego_velocity), sweeps_(assembleSweeps(scene, config_.sweep)) {
  SweepEstimatorParams params = config_;
  params.filter_radars = options.filter_radars;
  estimator_.configure(params);
  if (!options.masks.directory.empty())
    masks_.emplace(tables, index, options.masks.directory, options.masks.channel, options.masks.delay);
}

void SweepRunner::mark(std::vector<RadarScan>& scans) {
  if (!masks_) return;
  for (RadarScan& scan : scans) {
    if (const StampedMask* mask = masks_->before(scan.time))
      markReturns(scan, *mask, config_.mask_max_age, config_.footprint, raw_);
  }
}

const SweepVelocities& SweepRunner::upTo(double time) {
  for (; next_ < sweeps_.size() && sweeps_[next_].time <= time; ++next_) {
    SceneSweep& sweep = sweeps_[next_];
    ++velocities_.count;
    mark(sweep.scans);
    const SweepEstimate estimate = estimator_.estimate(sweep.scans, sweep.time);
    if (!estimate.single.valid()) {
      ++velocities_.refused;
      continue;
    }
    velocities_.velocities.emplace_back(sweep.time, estimate.single);
    const EgoVelocityResult& single = estimate.single;
    if (single.observed[0]) raw_.add({sweep.time, single.linear, single.angular});
    if (!estimate.filtered) continue;
    if (estimate.filtered->outcome == VelocityFilter::Outcome::kRejected) ++velocities_.filter_rejected;
    if (estimate.filtered->outcome == VelocityFilter::Outcome::kStarted) ++velocities_.filter_starts;
    velocities_.filtered.emplace_back(estimate.filtered->state, estimate.single);
  }
  return velocities_;
}

SweepVelocities sweepVelocities(const dataset::Tables& tables, dataset::Index index, const RadarScene& scene,
                                const VelocityEvaluationOptions& options) {
  return SweepRunner(tables, index, scene, options).upTo(std::numeric_limits<double>::infinity());
}

}  // namespace radar_dot::evaluation
