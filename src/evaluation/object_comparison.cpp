// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "object_comparison.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "radar_dot/objects/assignment.h"

namespace radar_dot::evaluation {

void ObjectComparison::add(double time, const std::vector<AnnotatedObject>& boxes,
                           std::vector<ReportedTrack> tracks, const Eigen::Isometry3d& T_base_from_tracks) {
  ++report_.keyframes;
  const Eigen::Isometry3d T_map_from_base = truth_.at(time);
  const Eigen::Isometry3d T_map_from_tracks = T_map_from_base * T_base_from_tracks;
  const Eigen::Matrix2d R = T_map_from_tracks.linear().topLeftCorner<2, 2>();
  std::vector<bool> counts, matched(tracks.size(), false);
  for (ReportedTrack& track : tracks) {
    counts.push_back(inRegion(T_base_from_tracks * track.position));
    track.position = T_map_from_tracks * track.position;
    track.velocity = R * track.velocity;
    track.velocity_covariance = R * track.velocity_covariance * R.transpose();
  }
  std::vector<const AnnotatedObject*> movers;
  for (const AnnotatedObject& box : boxes)
    if (box.state == BoxState::kMoves) movers.push_back(&box);
  const std::vector<int> track_of_mover = match(movers, tracks);
  for (std::size_t m = 0; m < movers.size(); ++m) {
    const ReportedTrack* track = nullptr;
    if (track_of_mover[m] != kUnassigned) {
      track = &tracks[static_cast<std::size_t>(track_of_mover[m])];
      matched[static_cast<std::size_t>(track_of_mover[m])] = true;
    }
    if (inRegion(T_map_from_base.inverse() * movers[m]->box.centre)) addMover(*movers[m], track, time);
  }
  for (std::size_t t = 0; t < tracks.size(); ++t)
    if (counts[t]) addTrack(tracks[t], matched[t], boxes);
}

bool ObjectComparison::inRegion(const Eigen::Vector3d& in_base) const {
  return in_base.head<2>().norm() <= matching_.max_range &&
         std::abs(std::atan2(in_base.y(), in_base.x())) <= matching_.max_azimuth;
}

bool ObjectComparison::lies(const Eigen::Vector3d& position, const AnnotatedObject& object) const {
  return object.contains(position.head<2>(), object.box.time, matching_.margin) ||
         (position - object.box.centre).head<2>().norm() <= matching_.centre_distance;
}

std::vector<int> ObjectComparison::match(const std::vector<const AnnotatedObject*>& movers,
                                         const std::vector<ReportedTrack>& tracks) const {
  Eigen::MatrixXd costs = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(movers.size()),
                                                    static_cast<Eigen::Index>(tracks.size()),
                                                    std::numeric_limits<double>::infinity());
  for (std::size_t m = 0; m < movers.size(); ++m)
    for (std::size_t t = 0; t < tracks.size(); ++t)
      if (lies(tracks[t].position, *movers[m]))
        costs(static_cast<Eigen::Index>(m), static_cast<Eigen::Index>(t)) =
            (tracks[t].position - movers[m]->box.centre).head<2>().norm();
  constexpr double kPairsFirst = 1e6;
  return assign(costs, kPairsFirst);
}

void ObjectComparison::addMover(const AnnotatedObject& mover, const ReportedTrack* track, double time) {
  MoverCounts& counts = report_.kinds[static_cast<std::size_t>(mover.kind)];
  ++counts.movers;
  countReturns(mover, time, counts);
  if (track == nullptr) return;
  ++counts.matched;
  const Eigen::Vector2d error = track->velocity - mover.box.velocity.head<2>();
  const Eigen::Vector2d bearing = (track->position - truth_.at(time).translation()).head<2>().normalized();
  counts.errors.position.push_back((track->position - mover.box.centre).head<2>().norm());
  counts.errors.radial.push_back(bearing.dot(error));
  counts.errors.velocity.push_back(error.norm());
  counts.errors.normalised_velocity.add(error.dot(track->velocity_covariance.inverse() * error));
  const auto [entry, is_new] = last_track_.try_emplace(mover.instance, track->id);
  if (!is_new && entry->second != track->id) ++report_.identity_switches;
  entry->second = track->id;
}

void ObjectComparison::countReturns(const AnnotatedObject& mover, double time, MoverCounts& counts) const {
  bool seen = false, moves = false;
  auto scan = std::lower_bound(scans_.begin(), scans_.end(), time - matching_.unseen_time,
                               [](const SeenScan& other, double t) { return other.time < t; });
  for (; scan != scans_.end() && scan->time <= time; ++scan) {
    const Eigen::Isometry3d T_map_from_base = truth_.at(scan->time);
    for (const ReturnOverGround& one : scan->returns) {
      const Eigen::Vector3d in_map =
          T_map_from_base * Eigen::Vector3d(one.position.x(), one.position.y(), 0.0);
      if (!mover.contains(in_map.head<2>(), scan->time, matching_.margin)) continue;
      seen = true;
      moves = moves || one.label == ReturnLabel::kDynamic;
    }
  }
  if (!seen) ++counts.unseen;
  if (seen && !moves) ++counts.unmoving;
}

void ObjectComparison::addTrack(const ReportedTrack& track, bool matched,
                                const std::vector<AnnotatedObject>& boxes) {
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

}  // namespace radar_dot::evaluation
