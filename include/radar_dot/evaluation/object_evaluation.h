// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "radar_dot/config/sections.h"
#include "radar_dot/dataset/tables.h"
#include "radar_dot/evaluation/ego_velocity_evaluation.h"
#include "radar_dot/evaluation/evaluation_inputs.h"
#include "radar_dot/evaluation/figures.h"
#include "radar_dot/radar/returns_over_ground.h"

namespace radar_dot::evaluation {

/// Which returns objects are sought in.
enum class ObjectReturns { kStrict, kReserved, kAll };

/// Which objects count, and which track is which.
struct ObjectMatching {
  double max_range = 50.0;
  double max_azimuth = 1.0471975511965976;
  double margin = 1.0;
  double min_speed = 0.5;
  double centre_distance = 2.0;  ///< m; a track this near to the centre of a box matches too
  double unseen_time = 0.5;      ///< s before a keyframe in which a return makes a mover seen
  void describe(FieldList& fields);
};

/// What is evaluated, and with which parameters.
struct ObjectEvaluationOptions {
  /// Of the ego velocity; radars, scale and bearing delay count for the objects too. Its filter is always on,
  /// and its masks are not used.
  VelocityEvaluationOptions ego;
  MovingObjectsConfig objects;
  /// Depth of the images of saved masks, by any backend but "torch".
  DepthConfig depth;
  DepthInputOptions depth_input;
  /// Saved masks as a further source of detections. They have no flow, so that they give the place, but no
  /// velocity. A mask is used from its delay on, as a measurement at the time of its image: a delay above
  /// max_lag is refused.
  SavedMaskOptions masks;

  ObjectReturns object_returns = ObjectReturns::kReserved;
  /// Returns that are left out for their states alone start no track, but may continue one.
  bool doubtful = true;
  ObjectMatching matching;

  /// Those that are in no section of a configuration file.
  void describe(FieldList& fields);
};

/// @throws InvalidParameter, also for what does not go together
void validate(const ObjectEvaluationOptions& options);

/// The kinds of movers, by category of their box.
enum class MoverKind : std::uint8_t { kVehicle, kCycle, kPedestrian, kOther };
inline constexpr std::array<const char*, 4> kMoverKinds = {"vehicle", "cycle", "pedestrian", "other"};

/// Errors of the matched tracks.
struct ObjectErrors {
  std::vector<double> position;  ///< m, from the centre of the box
  std::vector<double> radial;    ///< m/s, along the bearing from the base frame's origin, signed
  std::vector<double> velocity;  ///< m/s, length of the difference
  /// Squared Mahalanobis distance of the difference of the velocities: 2 in the mean where the covariance is
  /// right.
  Mean normalised_velocity;
};

/// Counts of one kind of movers, over keyframes.
struct MoverCounts {
  std::size_t movers = 0;   ///< annotated boxes that move, in the region
  std::size_t matched = 0;  ///< of them, with a track
  std::size_t unseen = 0;   ///< of them, without any return in the box within unseen_time
  /// Of them, with returns, none of which is labelled dynamic: doubtful ones never are.
  std::size_t unmoving = 0;
  ObjectErrors errors;
  double recall() const;      ///< matched / movers
  double seenRecall() const;  ///< matched / (movers - unseen)
  void describe(Figures& figures);
};

/// Results of one scene, or of several merged by operator+=.
struct ObjectReport {
  std::string scene;
  std::size_t keyframes = 0;
  std::array<MoverCounts, kMoverKinds.size()> kinds;
  std::size_t tracks = 0;           ///< moving tracks in the region at keyframes
  std::size_t true_tracks = 0;      ///< of them, matched to a mover
  std::size_t unknown_tracks = 0;   ///< of them, in a box of which is not known whether it moves: not counted
  std::size_t duplicates = 0;       ///< false: in the box of a mover that has another track
  std::size_t standing_tracks = 0;  ///< false: in the box of a standing thing
  std::size_t empty_tracks = 0;     ///< false: in no box
  std::size_t identity_switches = 0;

  MoverCounts all() const;   ///< all kinds together
  double precision() const;  ///< true_tracks / (tracks - unknown_tracks)
  void describe(Figures& figures);
};

/// Follows the moving objects of a scene with radar, and with saved masks where there are some, and compares
/// them at every keyframe with the annotated boxes. All is causal, but for masks that `masks.delay` lets
/// speak too early. The ego velocity and the world-fixed frame are the package's own; the true poses serve to
/// bring tracks to the map frame of the boxes.
///
/// A box moves when its attribute says so and its speed, by central difference of its track, is at least
/// min_speed. It stands when neither is so, and its state is unknown otherwise, or when its track has one
/// box. A track matches a box when it lies in it, grown by `margin`, or within centre_distance of its centre;
/// matching is one-to-one with the least sum of distances. A mover in the region may be matched by any track,
/// and a track in the region by any mover.
/// @throws dataset::DatasetError as evaluateEgoVelocity, and naming the folder
///         where it holds no mask of the scene, or an image without depth; std::invalid_argument for
///         invalid parameters.
ObjectReport evaluateObjects(const dataset::Tables& tables, dataset::Index scene,
                             const ObjectEvaluationOptions& options = {});

/// Plain-text table; the last row is the overall result.
std::string formatTable(const std::vector<ObjectReport>& scenes, const ObjectReport& overall);

}  // namespace radar_dot::evaluation

namespace radar_dot {

template <>
struct EnumNames<evaluation::ObjectReturns> {
  static constexpr EnumName<evaluation::ObjectReturns> kValues[] = {
      {evaluation::ObjectReturns::kStrict, "strict", "those that the ego velocity is estimated from"},
      {evaluation::ObjectReturns::kReserved, "reserved",
       "also those that the sensor calls valid with a reservation, and a false-alarm probability up to 75 %"},
      {evaluation::ObjectReturns::kAll, "all", "whatever their states"}};
};

}  // namespace radar_dot
