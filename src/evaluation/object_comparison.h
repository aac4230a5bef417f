// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <map>
#include <vector>

#include "annotated_objects.h"
#include "radar_dot/evaluation/object_evaluation.h"
#include "radar_dot/evaluation/pose_track.h"
#include "radar_dot/radar/returns_over_ground.h"

namespace radar_dot::evaluation {

/// A scan with its returns over ground.
struct SeenScan {
  double time = 0.0;  ///< s
  std::size_t radar = 0;
  Eigen::Isometry3d T_odom_from_base = Eigen::Isometry3d::Identity();
  std::vector<ReturnOverGround> returns;
};

/// A track at the time of boxes.
struct ReportedTrack {
  std::uint64_t id = 0;
  Eigen::Vector3d position;             ///< m
  Eigen::Vector2d velocity;             ///< m/s
  Eigen::Matrix2d velocity_covariance;  ///< (m/s)^2
};

/// Compares tracks with boxes, keyframe by keyframe.
class ObjectComparison {
 public:
  /// @param truth  T_map_from_base, where "map" is the frame of the boxes @param scans  in time order
  ObjectComparison(const PoseTrack& truth, const std::vector<SeenScan>& scans, const ObjectMatching& matching,
                   ObjectReport& report)
      : truth_(truth), scans_(scans), matching_(matching), report_(report) {}

  /// @param boxes  and tracks at `time` (s) @param T_base_from_tracks  from the frame of the tracks, then
  void add(double time, const std::vector<AnnotatedObject>& boxes, std::vector<ReportedTrack> tracks,
           const Eigen::Isometry3d& T_base_from_tracks);

 private:
  bool inRegion(const Eigen::Vector3d& in_base) const;
  bool lies(const Eigen::Vector3d& position, const AnnotatedObject& object) const;
  std::vector<int> match(const std::vector<const AnnotatedObject*>& movers,
                         const std::vector<ReportedTrack>& tracks) const;
  void addMover(const AnnotatedObject& mover, const ReportedTrack* track, double time);
  void countReturns(const AnnotatedObject& mover, double time, MoverCounts& counts) const;
  void addTrack(const ReportedTrack& track, bool matched, const std::vector<AnnotatedObject>& boxes);

  const PoseTrack& truth_;
  const std::vector<SeenScan>& scans_;
  const ObjectMatching& matching_;
  ObjectReport& report_;
  std::map<dataset::Index, std::uint64_t> last_track_;  // by instance
};

}  // namespace radar_dot::evaluation
