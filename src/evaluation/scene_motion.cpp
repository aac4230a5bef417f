// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "scene_motion.h"

#include <string>
#include <utility>

namespace radar_dot::evaluation {

SceneMotion::SceneMotion(const RadarScene& radar, const SegmentationEvaluationOptions& options)
    : radar_(radar),
      options_(options),
      sweeps_(assembleSweeps(radar, options.ego_velocity.sweep)),
      estimator_(options.ego_velocity) {}

void SceneMotion::advanceTo(double time) {
  for (; next_ < sweeps_.size() && sweeps_[next_].complete <= time; ++next_) take(sweeps_[next_]);
}

void SceneMotion::take(SceneSweep& sweep) {
  const EgoVelocityConfig& config = options_.ego_velocity;
  if (mask_) {
    for (RadarScan& scan : sweep.scans)
      markReturns(scan, *mask_, config.mask_max_age, config.footprint, raw_);
  }
  const SweepEstimate estimate = estimator_.estimate(sweep.scans, sweep.time);
  const EgoVelocityResult& single = estimate.single;
  if (!single.valid()) return;
  if (single.observed[0]) raw_.add({sweep.time, single.linear, single.angular});
  if (const std::optional<EgoVelocityResult> output = estimate.output()) {
    twists_.add({sweep.time, output->linear, output->angular, output->covariance},
                options_.rotation == RotationSource::kRadar);
  }
  keepPoints(sweep, single);
}

void SceneMotion::keepPoints(const SceneSweep& sweep, const EgoVelocityResult& result) {
  for (std::size_t i = 0; i < sweep.scans.size(); ++i) {
    const RadarScan& scan = sweep.scans[i];
    std::vector<CloudPoint> with_label[2];
    for (std::size_t k = 0; k < scan.returns.size(); ++k) {
      const std::size_t index = result.offsets[i] + k;
      const DopplerReturn& seen = scan.returns[k];
      const CloudPoint point{seen.range * seen.bearing, result.residuals[index]};
      if (result.labels[index] == ReturnLabel::kStatic) with_label[0].push_back(point);
      if (result.labels[index] == ReturnLabel::kDynamic) with_label[1].push_back(point);
    }
    const RecentScans::Sensor sensor(radar_.radars[scan.radar].channel, "");
    static_.add(sensor, scan.time, std::move(with_label[0]));
    dynamic_.add(sensor, scan.time, std::move(with_label[1]));
  }
}

std::optional<StampedTwist> SceneMotion::mean(double begin, double end) const {
  std::string missing;
  return twists_.mean(begin, end, options_.segmentation.max_twist_age, missing);
}

std::optional<Eigen::Isometry3d> SceneMotion::between(double begin, double end, double max_hold) const {
  if (options_.rotation == RotationSource::kRadar)
    return twists_.between(begin, end, max_hold).T_begin_from_end;
  const KnownRotation truth{"ground truth", Eigen::Quaterniond(radar_.truth.at(begin).linear()),
                            Eigen::Quaterniond(radar_.truth.at(end).linear())};
  return twists_.between(begin, end, max_hold, &truth).T_begin_from_end;
}

Eigen::Matrix<double, 6, 6> SceneMotion::covariance() const {
  return twists_.latest() != nullptr ? twists_.latest()->covariance : StampedTwist().covariance;
}

std::vector<CloudPoint> SceneMotion::pointsAt(ReturnLabel label, double time) const {
  const auto mount = [this](const RecentScans::Sensor& sensor) -> std::optional<Eigen::Isometry3d> {
    for (const LoadedRadar& radar : radar_.radars)
      if (radar.channel == sensor.first) return radar.T_base_from_sensor;
    return std::nullopt;
  };
  const auto motion = [this](double begin, double end) { return between(begin, end, kScanTwistHold); };
  const double max_age = options_.segmentation.radar_max_age;
  return label == ReturnLabel::kStatic
             ? static_.at(time, max_age, mount, motion)
             : dynamic_.at(time, max_age, mount, motion, &options_.segmentation.ground);
}

}  // namespace radar_dot::evaluation
