// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/object_evaluation.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <stdexcept>

#include "object_comparison.h"
#include "object_masks.h"
#include "radar_dot/common/pose_buffer.h"
#include "radar_dot/common/twist_history.h"
#include "radar_dot/radar/odometry.h"
#include "radar_scene.h"
#include "sweep_velocities.h"

namespace radar_dot::evaluation {
namespace {

using dataset::Index;

/// The motion of the vehicle by ego/twist and odom, as MovingObjects takes it: a scan comes after the twist
/// of its sweep.
class KnownMotion {
 public:
  /// @param max_age  s that the latest twist and pose are carried on
  KnownMotion(const std::vector<EstimatedVelocity>& velocities, double max_age) : max_age_(max_age) {
    VelocityIntegrator odometry;
    for (const EstimatedVelocity& velocity : velocities) {
      twists_.add(velocity, /*needs_yaw_rate=*/true);
      odometry.add(onWheels(velocity));
      poses_.add({velocity.time, odometry.state().T_odom_from_base});
    }
  }
  std::optional<StampedTwist> velocityAt(double time) const {
    std::string missing;
    return twists_.mean(time, time, max_age_, missing);
  }
  /// T_odom_from_base.
  std::optional<Eigen::Isometry3d> poseAt(double time) const {
    if (const std::optional<StampedPose> between = poses_.at(time)) return between->isometry();
    const std::optional<double> latest = poses_.latest();
    if (!latest || time < *latest || time - *latest > max_age_) return std::nullopt;
    const IntervalMotion since = twists_.between(*latest, time, max_age_);
    if (!since.T_begin_from_end) return std::nullopt;
    return poses_.at(*latest)->isometry() * *since.T_begin_from_end;
  }

 private:
  static constexpr double kWholeScene = std::numeric_limits<double>::infinity();
  double max_age_;
  TwistHistory twists_{kWholeScene};
  PoseBuffer poses_{kWholeScene, std::numeric_limits<std::size_t>::max()};
};

/// Of the doubtful scan the returns that the trusted one lacks, as static ones.
void addDoubtful(const RadarScan& doubtful, const StampedTwist& velocity, const OverGroundParams& params,
                 const Span<const DopplerReturn>& trusted, std::vector<ReturnOverGround>& returns) {
  std::set<std::uint32_t> known;
  for (const DopplerReturn& one : trusted) known.insert(one.index);
  for (ReturnOverGround& one : returnsOverGround(doubtful, velocity.linear, velocity.angular, params)) {
    if (known.count(doubtful.returns[one.index].index) > 0) continue;
    one.label = ReturnLabel::kStatic;
    returns.push_back(one);
  }
}

std::vector<SeenScan> seenScans(const RadarScene& scene, const RadarScene* doubtful,
                                const KnownMotion& motion, const ObjectEvaluationOptions& options) {
  std::vector<SeenScan> seen;
  for (const LoadedRadar& radar : scene.radars) {
    for (std::size_t i = 0; i < radar.scans.size(); ++i) {
      RadarScan scan = radar.scan(i);
      const auto velocity = motion.velocityAt(scan.time);
      const auto pose = motion.poseAt(scan.time);
      if (!velocity || !pose) continue;
      scan.bearing_rotation = options.ego.ego_velocity.bearing_delay * velocity->angular.z();
      seen.push_back({scan.time, scan.radar, *pose,
                      returnsOverGround(scan, velocity->linear, velocity->angular, options.objects.returns)});
      if (doubtful == nullptr) continue;
      RadarScan with_doubtful = scan;
      with_doubtful.returns = doubtful->radars[scan.radar].scans[i].returns;
      addDoubtful(with_doubtful, *velocity, options.objects.returns, scan.returns, seen.back().returns);
    }
  }
  std::stable_sort(seen.begin(), seen.end(),
                   [](const SeenScan& a, const SeenScan& b) { return a.time < b.time; });
  return seen;
}

/// Feeds a tracker with scans and masks in the order in which they are known, and compares its tracks at
/// every keyframe.
void followObjects(const RadarScene& scene, const KnownMotion& motion, const std::vector<SeenScan>& scans,
                   ObjectMasks* masks, const ObjectEvaluationOptions& options,
                   const std::function<void(std::size_t, const std::vector<ObjectTrack>&)>& compare) {
  constexpr double kEnd = std::numeric_limits<double>::infinity();
  ObjectTracker tracker(options.objects.tracker);
  const std::vector<double>& times = scene.keyframe_times;
  std::size_t keyframe = 0, mask = 0;
  const auto compareBefore = [&](double time) {
    for (; keyframe < times.size() && times[keyframe] < time; ++keyframe)
      if (scene.truth.covers(times[keyframe])) compare(keyframe, tracker.moving(times[keyframe]));
  };
  const auto useMasksBefore = [&](double time) {
    for (; masks != nullptr && mask < masks->size() && masks->knownFrom(mask) < time; ++mask) {
      compareBefore(masks->knownFrom(mask));
      const double image_time = masks->timeOf(mask);
      const std::optional<Eigen::Isometry3d> pose = motion.poseAt(image_time);
      if (pose) tracker.update(image_time, std::nullopt, masks->detections(mask), *pose);
    }
  };
  for (const SeenScan& scan : scans) {
    useMasksBefore(scan.time);
    compareBefore(scan.time);
    tracker.update(scan.time, scan.radar,
                   detectObjects(scan.time, scan.returns, {}, options.objects.detection),
                   scan.T_odom_from_base);
  }
  useMasksBefore(kEnd);
  compareBefore(kEnd);
}

/// The returns that objects are sought in: more than the ego velocity is estimated from.
ReturnFilter objectFilter(ReturnFilter filter, ObjectReturns returns) {
  if (returns == ObjectReturns::kReserved) {
    filter.invalid_states = {0, 4, 8, 9, 10, 11, 12, 16, 17};
    filter.pdh0_states = {1, 2, 3};
  }
  if (returns == ObjectReturns::kAll) {
    filter.invalid_states.clear();
    filter.ambig_states.clear();
    filter.pdh0_states.clear();
  }
  return filter;
}

}  // namespace

void ObjectMatching::describe(FieldList& fields) {
  fields.add("max_object_range", max_range, "Distance of the objects that count", "m", {1.0, 10000.0});
  fields.add("max_object_azimuth", max_azimuth,
             "Angle to either side of straight ahead of the objects that count", "rad", {0.01, 3.2});
  fields.add("margin", margin, "By which annotated boxes are grown on all sides", "m", {0.0, 100.0});
  fields.add("min_box_speed", min_speed, "A box that is called moving moves at least this fast", "m/s",
             {0.01, 100.0});
}

void ObjectEvaluationOptions::describe(FieldList& fields) {
  fields.group("Evaluation");
  describeRadarChannels(ego.radar_channels, fields);
  fields.add("object_returns", object_returns, "Returns that objects are sought in");
  fields.add("doubtful", doubtful,
             "Returns that are left out for their states alone may continue a track, but start none");
  matching.describe(fields);
  fields.group("Masks");
  masks.describe(fields);
  depth_input.describe(fields);
}

void validate(const ObjectEvaluationOptions& options) {
  validateFields(options);
  validateFields(options.ego);
  validate(options.ego.ego_velocity);
  validate(options.objects);
  validate(options.depth);
  // A later mask would be refused by the tracker, every time and without a word.
  if (options.masks.directory.empty() || options.masks.delay <= options.objects.tracker.max_lag) return;
  throw InvalidParameter(
      {fieldsOf(options).of(&options.masks.delay).name,
       fieldsOf(options.objects).of(&options.objects.tracker.max_lag).name},
      fmt::format("masks with a delay (mask_delay) of {} s come too late for max_lag of {} s",
                  options.masks.delay, options.objects.tracker.max_lag));
}

ObjectReport evaluateObjects(const dataset::Tables& tables, Index scene,
                             const ObjectEvaluationOptions& options) {
  validate(options);
  VelocityEvaluationOptions ego = options.ego;
  ego.ego_velocity.filter = true;
  EgoVelocityConfig config = ego.ego_velocity;
  const RadarScene for_ego = loadRadarScene(tables, scene, ego.radar_channels, config);
  config.extraction.filter = objectFilter(ego.ego_velocity.extraction.filter, options.object_returns);
  const RadarScene for_objects = loadRadarScene(tables, scene, ego.radar_channels, config);
  const KnownMotion motion(sweepVelocities(tables, scene, for_ego, ego).filtered,
                           options.objects.max_pose_age);
  std::optional<RadarScene> with_doubtful;
  if (options.doubtful) {
    config.extraction.filter = objectFilter(config.extraction.filter, ObjectReturns::kAll);
    with_doubtful = loadRadarScene(tables, scene, ego.radar_channels, config);
  }
  const std::vector<SeenScan> scans =
      seenScans(for_objects, with_doubtful ? &*with_doubtful : nullptr, motion, options);

  std::optional<ObjectMasks> object_masks;
  if (!options.masks.directory.empty()) object_masks.emplace(tables, scene, for_ego, options);

  ObjectReport report;
  report.scene = tables.scenes[at(scene)].name;
  ObjectComparison comparison(for_objects.truth, scans, options.matching, report);
  const auto compare = [&](std::size_t keyframe, const std::vector<ObjectTrack>& moving) {
    const double time = for_objects.keyframe_times[keyframe];
    const std::optional<Eigen::Isometry3d> T_odom_from_base = motion.poseAt(time);
    std::vector<ReportedTrack> tracks;
    for (const ObjectTrack& track : moving)
      if (T_odom_from_base)
        tracks.push_back({track.id,
                          {track.position().x(), track.position().y(), 0.0},
                          track.velocity(),
                          track.covariance.bottomRightCorner<2, 2>()});
    comparison.add(
        time, annotatedObjects(tables, for_objects.keyframe_samples[keyframe], options.matching.min_speed),
        tracks, T_odom_from_base.value_or(Eigen::Isometry3d::Identity()).inverse());
  };
  followObjects(for_objects, motion, scans, object_masks ? &*object_masks : nullptr, options, compare);
  return report;
}

}  // namespace radar_dot::evaluation
