// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/object_evaluation.h"

#include <fmt/format.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>

#include "annotated_objects.h"
#include "object_masks.h"
#include "radar_dot/common/pose_buffer.h"
#include "radar_dot/common/twist_history.h"
#include "radar_dot/objects/assignment.h"
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

/// A scan with its returns over ground, in time order.
struct SeenScan {
  double time = 0.0;
  std::size_t radar = 0;
  Eigen::Isometry3d T_odom_from_base;
  std::vector<ReturnOverGround> returns;
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

/// A track at a keyframe, map frame.
struct ReportedTrack {
  std::uint64_t id = 0;
  Eigen::Vector2d position, velocity;
  Eigen::Matrix2d velocity_covariance;
  bool in_region = false;
};

bool inRegion(const Eigen::Vector2d& in_base, const ObjectEvaluationOptions& options) {
  return in_base.norm() <= options.max_range &&
         std::abs(std::atan2(in_base.y(), in_base.x())) <= options.max_azimuth;
}

Eigen::Vector2d inBase(const Eigen::Isometry3d& T_map_from_base, const Eigen::Vector3d& in_map) {
  return (T_map_from_base.inverse() * in_map).head<2>();
}

/// Compares tracks with boxes, keyframe by keyframe.
class Comparison {
 public:
  Comparison(const dataset::Tables& tables, const RadarScene& scene, const KnownMotion& motion,
             const std::vector<SeenScan>& scans, const ObjectEvaluationOptions& options, ObjectReport& report)
      : tables_(tables), scene_(scene), motion_(motion), scans_(scans), options_(options), report_(report) {}

  void add(std::size_t keyframe, const std::vector<ObjectTrack>& moving) {
    const double time = scene_.keyframe_times[keyframe];
    const Eigen::Isometry3d T_map_from_base = scene_.truth.at(time);
    ++report_.keyframes;
    const std::vector<AnnotatedObject> boxes =
        annotatedObjects(tables_, scene_.keyframe_samples[keyframe], options_.min_speed);
    std::vector<const AnnotatedObject*> movers;
    for (const AnnotatedObject& box : boxes)
      if (box.state == BoxState::kMoves) movers.push_back(&box);
    const std::vector<ReportedTrack> tracks = reportedTracks(moving, time, T_map_from_base);
    const std::vector<int> track_of_mover = match(movers, tracks);
    std::vector<bool> matched(tracks.size(), false);
    for (std::size_t m = 0; m < movers.size(); ++m) {
      const ReportedTrack* track = nullptr;
      if (track_of_mover[m] != kUnassigned) {
        track = &tracks[static_cast<std::size_t>(track_of_mover[m])];
        matched[static_cast<std::size_t>(track_of_mover[m])] = true;
      }
      if (inRegion(inBase(T_map_from_base, movers[m]->box.centre), options_))
        addMover(*movers[m], track, time, T_map_from_base);
    }
    for (std::size_t t = 0; t < tracks.size(); ++t)
      if (tracks[t].in_region) addTrack(tracks[t], matched[t], boxes);
  }

 private:
  std::vector<ReportedTrack> reportedTracks(const std::vector<ObjectTrack>& moving, double time,
                                            const Eigen::Isometry3d& T_map_from_base) const {
    std::vector<ReportedTrack> tracks;
    const std::optional<Eigen::Isometry3d> T_odom_from_base = motion_.poseAt(time);
    if (!T_odom_from_base) return tracks;
    const Eigen::Isometry3d T_base_from_odom = T_odom_from_base->inverse();
    const Eigen::Isometry3d T_map_from_odom = T_map_from_base * T_base_from_odom;
    const Eigen::Matrix2d R = T_map_from_odom.linear().topLeftCorner<2, 2>();
    for (const ObjectTrack& track : moving) {
      const Eigen::Vector3d in_odom(track.position().x(), track.position().y(), 0.0);
      ReportedTrack reported;
      reported.id = track.id;
      reported.position = (T_map_from_odom * in_odom).head<2>();
      reported.velocity = R * track.velocity();
      reported.velocity_covariance = R * track.covariance.bottomRightCorner<2, 2>() * R.transpose();
      reported.in_region = inRegion((T_base_from_odom * in_odom).head<2>(), options_);
      tracks.push_back(reported);
    }
    return tracks;
  }

  bool lies(const Eigen::Vector2d& position, const AnnotatedObject& object) const {
    return object.contains(position, object.box.time, options_.margin) ||
           (position - object.box.centre.head<2>()).norm() <= options_.centre_distance;
  }

  std::vector<int> match(const std::vector<const AnnotatedObject*>& movers,
                         const std::vector<ReportedTrack>& tracks) const {
    Eigen::MatrixXd costs = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(movers.size()),
                                                      static_cast<Eigen::Index>(tracks.size()),
                                                      std::numeric_limits<double>::infinity());
    for (std::size_t m = 0; m < movers.size(); ++m)
      for (std::size_t t = 0; t < tracks.size(); ++t)
        if (lies(tracks[t].position, *movers[m]))
          costs(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(t)) =
              (tracks[t].position - movers[m]->box.centre.head<2>()).norm();
    constexpr double kPairsFirst = 1e6;
    return assign(costs, kPairsFirst);
  }

  void addMover(const AnnotatedObject& mover, const ReportedTrack* track, double time,
                const Eigen::Isometry3d& T_map_from_base) {
    MoverCounts& counts = report_.kinds[static_cast<std::size_t>(mover.kind)];
    ++counts.movers;
    countReturns(mover, time, counts);
    if (track == nullptr) return;
    ++counts.matched;
    const Eigen::Vector2d error = track->velocity - mover.box.velocity.head<2>();
    const Eigen::Vector2d bearing = (track->position - T_map_from_base.translation().head<2>()).normalized();
    counts.errors.position.push_back((track->position - mover.box.centre.head<2>()).norm());
    counts.errors.radial.push_back(bearing.dot(error));
    counts.errors.velocity.push_back(error.norm());
    counts.errors.normalised_velocity.add(error.dot(track->velocity_covariance.inverse() * error));
    const auto [entry, is_new] = last_track_.try_emplace(mover.instance, track->id);
    if (!is_new && entry->second != track->id) ++report_.identity_switches;
    entry->second = track->id;
  }

  void countReturns(const AnnotatedObject& mover, double time, MoverCounts& counts) const {
    bool seen = false, moves = false;
    for (const SeenScan& scan : scans_) {
      if (scan.time < time - options_.unseen_time || scan.time > time) continue;
      const Eigen::Isometry3d T_map_from_base = scene_.truth.at(scan.time);
      for (const ReturnOverGround& one : scan.returns) {
        const Eigen::Vector3d in_map =
            T_map_from_base * Eigen::Vector3d(one.position.x(), one.position.y(), 0.0);
        if (!mover.contains(in_map.head<2>(), scan.time, options_.margin)) continue;
        seen = true;
        moves = moves || one.label == ReturnLabel::kDynamic;
      }
    }
    if (!seen) ++counts.unseen;
    if (seen && !moves) ++counts.unmoving;
  }

  void addTrack(const ReportedTrack& track, bool matched, const std::vector<AnnotatedObject>& boxes) {
    ++report_.tracks;
    if (matched) {
      ++report_.true_tracks;
      return;
    }
    const auto inBoxThat = [&](BoxState state) {
      return std::any_of(boxes.begin(), boxes.end(), [&](const AnnotatedObject& box) {
        return box.state == state && lies(track.position, box);
      });
    };
    if (inBoxThat(BoxState::kMoves)) {
      ++report_.duplicates;
    } else if (inBoxThat(BoxState::kUnknown)) {
      ++report_.unknown_tracks;
    } else if (inBoxThat(BoxState::kStands)) {
      ++report_.standing_tracks;
    } else {
      ++report_.empty_tracks;
    }
  }

  const dataset::Tables& tables_;
  const RadarScene& scene_;
  const KnownMotion& motion_;
  const std::vector<SeenScan>& scans_;
  const ObjectEvaluationOptions& options_;
  ObjectReport& report_;
  std::map<Index, std::uint64_t> last_track_;  // by instance
};

/// Feeds a tracker with scans and masks in the order in which they are known, and compares its tracks at
/// every keyframe.
void followObjects(const RadarScene& scene, const KnownMotion& motion, const std::vector<SeenScan>& scans,
                   ObjectMasks* masks, const ObjectEvaluationOptions& options, Comparison& comparison) {
  constexpr double kEnd = std::numeric_limits<double>::infinity();
  ObjectTracker tracker(options.objects.tracker);
  const std::vector<double>& times = scene.keyframe_times;
  std::size_t keyframe = 0, mask = 0;
  const auto compareBefore = [&](double time) {
    for (; keyframe < times.size() && times[keyframe] < time; ++keyframe)
      if (scene.truth.covers(times[keyframe])) comparison.add(keyframe, tracker.moving(times[keyframe]));
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

void ObjectEvaluationOptions::describe(FieldList& fields) {
  fields.group("Evaluation");
  describeRadarChannels(ego.radar_channels, fields);
  fields.add("object_returns", object_returns, "Returns that objects are sought in");
  fields.add("doubtful", doubtful,
             "Returns that are left out for their states alone may continue a track, but start none");
  fields.add("max_object_range", max_range, "Distance of the objects that count", "m", {1.0, 10000.0});
  fields.add("max_object_azimuth", max_azimuth,
             "Angle to either side of straight ahead of the objects that count", "rad", {0.01, 3.2});
  fields.add("margin", margin, "By which annotated boxes are grown on all sides", "m", {0.0, 100.0});
  fields.add("min_box_speed", min_speed, "A box that is called moving moves at least this fast", "m/s",
             {0.01, 100.0});
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
  Comparison comparison(tables, for_objects, motion, scans, options, report);
  followObjects(for_objects, motion, scans, object_masks ? &*object_masks : nullptr, options, comparison);
  return report;
}

}  // namespace radar_dot::evaluation
