// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/ego_velocity_evaluation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "radar_dot/radar/odometry.h"
#include "radar_scene.h"
#include "sweep_velocities.h"
#include "wheel_speed.h"

namespace radar_dot::evaluation {
namespace {

using dataset::Index;

constexpr double kReportedRange = 70.0;  // m; movers beyond are hardly annotated

EgoVelocityParams variantParams(EgoVelocityParams params, const std::string& variant) {
  params.model = MotionModel::kPlanar;
  if (variant != "robust") {
    params.solver = variant[1] == '1' ? Solver::kLeastSquares : Solver::kRansac;
    params.two_pass = variant[0] == 'A';
  }
  return params;
}

/// Time between two consecutive keyframes, s.
struct Interval {
  double begin = 0.0;
  double end = 0.0;
  double middle() const { return 0.5 * (begin + end); }
  double half() const { return 0.5 * (end - begin); }
};

/// The intervals of the scene whose true displacement is known.
std::vector<Interval> intervalsOf(const RadarScene& scene) {
  std::vector<Interval> intervals;
  for (std::size_t i = 0; i + 1 < scene.keyframe_times.size(); ++i) {
    const Interval interval{scene.keyframe_times[i], scene.keyframe_times[i + 1]};
    if (scene.truth.covers(interval.begin) && scene.truth.covers(interval.end)) intervals.push_back(interval);
  }
  return intervals;
}

void addErrors(const EstimatedVelocity& estimate, const Eigen::Vector3d& truth, double true_yaw_rate,
               ModelErrors& errors) {
  const auto add = [&](int axis, double error, Mean& absolute, Mean& normalised) {
    absolute.add(std::abs(error));
    if (estimate.observes(axis)) normalised.add(error * error / estimate.covariance(axis, axis));
  };
  add(0, estimate.linear.x() - truth.x(), errors.vx, errors.normalised_vx);
  add(1, estimate.linear.y() - truth.y(), errors.vy, errors.normalised_vy);
  errors.velocity.add((estimate.linear - truth).head<2>().norm());
  if (estimate.observed[5])
    add(5, estimate.angular.z() - true_yaw_rate, errors.yaw_rate, errors.normalised_yaw_rate);
}

void evaluatePairs(const RadarScene& scene, const VelocityEvaluationOptions& options, SweepRunner sweeps,
                   VelocityReport& report) {
  std::map<std::string, EgoVelocityEstimator> variants;
  for (const char* variant : kVariants) {
    variants.emplace(variant, EgoVelocityEstimator(variantParams(options.ego_velocity.estimator, variant)));
  }
  std::map<MotionModel, EgoVelocityEstimator> models;
  for (const MotionModel model :
       {MotionModel::kPlanar, MotionModel::kPlanarYaw, MotionModel::kAckermann, MotionModel::kSpatial}) {
    EgoVelocityParams params = options.ego_velocity.estimator;
    params.model = model;
    models.emplace(model, EgoVelocityEstimator(params));
  }
  const WheelSpeed wheels(scene.wheels);

  for (const Interval& interval : intervalsOf(scene)) {
    const double middle = interval.middle();
    std::vector<RadarScan> scans;
    for (const LoadedRadar& radar : scene.radars) {
      const auto nearest = nearestScan(radar, middle, interval.half());
      if (nearest) scans.push_back(radar.scan(*nearest));
    }
    sweeps.upTo(middle);
    sweeps.mark(scans);
    // A model without a yaw rate knows of no turning of the bearings either.
    std::vector<RadarScan> turned = scans;
    sweeps.estimator().turnBearings(turned);
    const Eigen::Vector3d acceleration = sweeps.estimator().acceleration(middle);
    const Eigen::Vector3d truth = scene.truth.meanVelocity(interval.begin, interval.end);
    const double true_yaw_rate = scene.truth.meanYawRate(interval.begin, interval.end);

    ++report.frames;
    for (auto& [name, estimator] : variants) {
      const EgoVelocityResult result = estimator.estimate(scans, middle, acceleration);
      if (result.valid()) report.mae[name].add((result.linear - truth).head<2>().norm());
    }
    for (auto& [model, estimator] : models) {
      const EgoVelocityResult result =
          estimator.estimate(model == MotionModel::kPlanar ? scans : turned, middle, acceleration);
      const bool in_use = model == options.ego_velocity.estimator.model;
      if (!result.valid()) {
        if (in_use) {
          ++report.refused;
          ++report.refusals[std::string(toString(result.status))];
        }
        continue;
      }
      ModelErrors& errors = report.models[std::string(toString(model))];
      addErrors(EstimatedVelocity(middle, result), truth, true_yaw_rate, errors);
      if (model == MotionModel::kPlanarYaw) {
        const auto now = wheels.at(middle);
        const auto mean = wheels.mean(interval.begin, interval.end);
        if (now && mean) {
          report.wheel_estimate.add(std::abs(result.linear.x() - *now));
          report.wheel_ground_truth.add(std::abs(truth.x() - *mean));
        }
      }
    }
  }
}

/// The latest velocity at or before the middle of each pair of keyframes, brought to it, as on a vehicle.
void evaluateSweeps(const RadarScene& scene, const SweepVelocities& sweeps, VelocityReport& report) {
  for (const Interval& interval : intervalsOf(scene)) {
    const double middle = interval.middle();
    const Eigen::Vector3d truth = scene.truth.meanVelocity(interval.begin, interval.end);
    const double true_yaw_rate = scene.truth.meanYawRate(interval.begin, interval.end);
    if (const EstimatedVelocity* velocity = latestAt(sweeps.velocities, middle))
      addErrors(velocity->broughtTo(middle), truth, true_yaw_rate, report.causal);
    if (const EstimatedVelocity* velocity = latestAt(sweeps.filtered, middle))
      addErrors(velocity->broughtTo(middle), truth, true_yaw_rate, report.filtered);
  }
  report.filter_rejected = sweeps.filter_rejected;
  report.filter_starts = sweeps.filter_starts;
}

/// Yaw error of every mount from its scans nearest to the middle of each pair of keyframes.
void evaluateMounts(const RadarScene& scene, const VelocityEvaluationOptions& options,
                    VelocityReport& report) {
  const std::vector<Interval> intervals = intervalsOf(scene);
  const double static_limit = options.ego_velocity.estimator.segmentation.threshold;
  for (const LoadedRadar& radar : scene.radars) {
    MountError& error = report.mounts[radar.channel];
    const Eigen::Matrix3d R_base_from_sensor = radar.T_base_from_sensor.linear();
    for (const Interval& interval : intervals) {
      const auto nearest = nearestScan(radar, interval.middle(), interval.half());
      if (!nearest) continue;
      const Eigen::Vector3d angular(0.0, 0.0, scene.truth.meanYawRate(interval.begin, interval.end));
      const double rotation = options.ego_velocity.bearing_delay * angular.z();
      const Eigen::Vector3d velocity = scene.truth.meanVelocity(interval.begin, interval.end) +
                                       angular.cross(radar.T_base_from_sensor.translation());
      for (const DopplerReturn& measured : radar.scans[*nearest].returns) {
        const Eigen::Vector3d bearing = Eigen::AngleAxisd(rotation, Eigen::Vector3d::UnitZ()) *
                                        R_base_from_sensor * measured.bearing.cast<double>();
        const double residual = static_cast<double>(measured.doppler) +
                                rotation * static_cast<double>(measured.tangential_speed) +
                                bearing.dot(velocity);
        if (std::abs(residual) >= static_limit) continue;
        const double tangential_speed = Eigen::Vector3d::UnitZ().cross(bearing).dot(velocity);
        error.numerator -= tangential_speed * residual;
        error.denominator += tangential_speed * tangential_speed;
      }
    }
  }
}

void evaluateTrajectory(const RadarScene& scene, const std::vector<EstimatedVelocity>& velocities,
                        VelocityReport& report) {
  for (const bool with_heading : {true, false}) {
    VelocityIntegrator integrator;
    std::vector<StampedPose> path;
    for (const EstimatedVelocity& velocity : velocities) {
      if (!scene.truth.covers(velocity.time)) continue;
      const Eigen::Isometry3d truth = scene.truth.at(velocity.time);
      if (path.empty()) integrator.reset(truth);
      std::optional<Eigen::Quaterniond> heading;
      if (with_heading) heading = Eigen::Quaterniond(truth.linear());
      integrator.add(velocity, heading);
      path.emplace_back(velocity.time, integrator.state().T_odom_from_base);
    }
    (with_heading ? report.gt_heading : report.own_heading) += compareTrajectory(path, scene.truth);
  }
}

void evaluateLabels(const dataset::Tables& tables, const RadarScene& scene,
                    const VelocityEvaluationOptions& options, SweepRunner sweeps, VelocityReport& report) {
  const bool annotated = std::any_of(scene.keyframe_samples.begin(), scene.keyframe_samples.end(),
                                     [&](Index sample) { return !tables.annotationsOf(sample).empty(); });
  if (!annotated) return;  // no boxes is no evidence that nothing moves
  EgoVelocityEstimator estimator(options.ego_velocity.estimator);
  for (std::size_t k = 0; k < scene.keyframe_samples.size(); ++k) {
    const Index sample = scene.keyframe_samples[k];
    std::vector<RadarScan> scans;
    for (const LoadedRadar& radar : scene.radars) {
      for (std::size_t i = 0; i < radar.scans.size(); ++i) {
        if (radar.scans[i].sample == sample && radar.scans[i].is_key_frame) scans.push_back(radar.scan(i));
      }
    }
    const double time = scene.keyframe_times[k];
    if (!scene.truth.covers(time)) continue;
    sweeps.upTo(time);
    sweeps.mark(scans);
    sweeps.estimator().turnBearings(scans);
    const EgoVelocityResult result = estimator.estimate(scans, time, sweeps.estimator().acceleration(time));
    if (!result.valid()) continue;
    const std::vector<MovingBox> boxes = boxesAt(tables, sample);
    for (std::size_t s = 0; s < scans.size(); ++s) {
      const Eigen::Isometry3d T_map_from_base = scene.truth.at(scans[s].time);
      const Eigen::Vector3d sensor = T_map_from_base * scans[s].T_base_from_sensor.translation();
      for (std::size_t i = 0; i < scans[s].returns.size(); ++i) {
        const DopplerReturn& measured = scans[s].returns[i];
        const Eigen::Vector3d in_base = scans[s].T_base_from_sensor * (static_cast<double>(measured.range) *
                                                                       measured.bearing.cast<double>());
        const TrueLabel label =
            trueLabel(boxes, T_map_from_base * in_base, sensor, scans[s].time, options.labels);
        if (label == TrueLabel::kIgnored) continue;
        const bool predicted = result.labels[result.offsets[s] + i] == ReturnLabel::kDynamic;
        const bool actual = label == TrueLabel::kDynamic;
        report.dynamic.add(predicted, actual);
        if (in_base.head<2>().norm() < kReportedRange) report.dynamic_70m.add(predicted, actual);
      }
    }
  }
}

}  // namespace

void VelocityEvaluationOptions::describe(FieldList& fields) {
  fields.group("Evaluation");
  describeRadarChannels(radar_channels, fields);
  fields.add("mount_yaw_correction", mount_yaw_corrections,
             "Added to the yaw of mounts, as in RADAR_FRONT=-0.0111,RADAR_BACK_LEFT=0.0094", "rad");
  fields.add("filter_radars", filter_radars,
             "The filter takes the velocity of each radar alone; otherwise the joint estimates");
  fields.group("Masks");
  masks.describe(fields);
}

void validate(const VelocityEvaluationOptions& options) {
  validateFields(options);
  validate(options.ego_velocity);
}

VelocityReport evaluateEgoVelocity(const dataset::Tables& tables, Index scene,
                                   const VelocityEvaluationOptions& options) {
  validate(options);
  VelocityReport report;
  report.scene = tables.scenes[static_cast<std::size_t>(scene)].name;
  const RadarScene loaded =
      loadRadarScene(tables, scene, options.radar_channels,
                     withMountCorrections(options.ego_velocity, options.mount_yaw_corrections));
  const auto start = [&] { return SweepRunner(tables, scene, loaded, options); };
  const SweepVelocities sweeps = sweepVelocities(tables, scene, loaded, options);
  report.sweeps = sweeps.count;
  report.sweeps_refused = sweeps.refused;
  evaluatePairs(loaded, options, start(), report);
  evaluateSweeps(loaded, sweeps, report);
  evaluateMounts(loaded, options, report);
  evaluateTrajectory(loaded, sweeps.filtered.empty() ? sweeps.velocities : sweeps.filtered, report);
  evaluateLabels(tables, loaded, options, start(), report);
  return report;
}

}  // namespace radar_dot::evaluation
