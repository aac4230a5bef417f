// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "radar_dot/objects/object_detection.h"

namespace radar_dot {

/// Parameters of ObjectTracker.
struct ObjectTrackerParams {
  double acceleration_std = 2.0;  // the spectral density of the white acceleration is its square times 1 s
  double initial_speed_std = 4.0;
  double gate = 3.7;

  int confirm_hits = 3;
  int confirm_scans = 5;
  double min_coast = 0.25;
  double max_coast = 0.8;
  double max_weak_time = 1.0;

  // Large bodies give several detections, and large bodies are fast. One body reaches from a track, along
  // its heading, as far as it moves in body_time, within the two lengths, and sideways as far as its width
  // allows (an ellipse); and its velocities, as far as they are known, differ by less than body_velocity and
  // their own 3 sigma. A detection without a partner that belongs to the body of a confirmed track starts no
  // track; of two confirmed tracks of one body the younger ends.
  double min_body_length = 2.0;
  double max_body_length = 7.0;
  double max_body_width = 2.5;
  double body_time = 2.0;
  double body_velocity = 2.0;

  double max_lag = 0.2;
  double min_speed = 0.5;

  void describe(FieldList& fields) {
    const Range length{0.01, 100.0};
    fields.group("Tracker");
    fields.add("acceleration_std", acceleration_std,
               "1 sigma of the change of an object's velocity in one second", "m/s^2", {0.001, 100.0});
    fields.add("initial_speed_std", initial_speed_std, "1 sigma of an unmeasured velocity of a new track",
               "m/s", {0.01, 100.0});
    fields.add("gate", gate, "Largest Mahalanobis distance between a track and its detection", "sigma",
               {0.1, 100.0});
    fields.add("confirm_hits", confirm_hits,
               "Detections that confirm a track, its first one included; those of other radars count too", "",
               {1, 1000});
    fields.add("confirm_scans", confirm_scans,
               "Scans of the radar that started a track, before which they must come", "", {1, 1000});
    fields.add(
        "min_coast", min_coast,
        "Shortest life of a track without a detection; it lives as long as it has been followed before", "s",
        {0.01, 60.0});
    fields.add("max_coast", max_coast, "Longest life of a track without a detection", "s", {0.01, 60.0});
    fields.add("max_weak_time", max_weak_time,
               "Longest life of a track on detections that do not move independently", "s", {0.01, 100.0});
    fields.add("min_body_length", min_body_length, "Lower limit of the reach of one body along its heading",
               "m", length);
    fields.add("max_body_length", max_body_length, "Upper limit of the reach of one body along its heading",
               "m", length);
    fields.add("max_body_width", max_body_width, "Reach of one body perpendicular to its heading", "m",
               length);
    fields.add("body_time", body_time, "Time in which a body moves by its reach", "s", {0.0, 100.0});
    fields.add("body_velocity", body_velocity, "Largest difference between velocities on one body", "m/s",
               {0.0, 100.0});
    fields.add("max_lag", max_lag, "Largest age of a scan or mask relative to the newest scan", "s",
               {0.0, 10.0});
    fields.add("min_speed", min_speed, "Slower tracks are not reported as moving", "m/s", {0.0, 100.0});
  }
};
/// @throws InvalidParameter, also for limits in the wrong order
void validate(const ObjectTrackerParams& params);

/// An object followed over time, in a world-fixed frame (odom). Covariance of [position, velocity].
struct ObjectTrack {
  std::uint64_t id = 0;      ///< from 1, never used again
  double time = 0.0;         ///< s, the state holds at
  double birth = 0.0;        ///< s
  double last_hit = 0.0;     ///< s, of the latest detection, whether or not it moves independently
  double last_moving = 0.0;  ///< s, of the latest one that does
  Eigen::Vector4d state = Eigen::Vector4d::Zero();           ///< [x, y, vx, vy], m and m/s, odom frame
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Identity();  ///< of `state`
  std::size_t hits = 0;                                      ///< detections so far
  bool confirmed = false;
  std::size_t return_count = 0;  ///< of the latest detection with returns
  /// s, of the latest detection with an image; minus infinity: there was none. Box and count are of it.
  double last_image = -std::numeric_limits<double>::infinity();
  std::size_t pixel_count = 0;
  ImageBox box;

  Eigen::Vector2d position() const { return state.head<2>(); }
  Eigen::Vector2d velocity() const { return state.tail<2>(); }
  double speed() const { return velocity().norm(); }
  /// The state brought to `time` at constant velocity, with the uncertainty that this adds.
  ObjectTrack at(double when, double acceleration_std) const;
};

/// Tracks of moving objects from detections: a Kalman filter for each with constant velocity and white
/// acceleration,
///     x' = F(dt) x,   F = [I, dt I; 0, I],   Q = q^2 [dt^3/3 I, dt^2/2 I; dt^2/2 I, dt I],
/// and the detection z = [p, v] with its covariances, turned into the world-fixed frame, as measurement.
/// Components of v that a detection does not know have a large variance and hence no weight: the velocity
/// across the line of sight comes from the change of the bearing, from radars elsewhere on the vehicle, and
/// from images. Updates are in Joseph form.
///
/// Association is by global nearest neighbour (Mahalanobis distance d^2 + ln det S, gated, Hungarian method)
/// in three passes: confirmed tracks with moving detections, tentative tracks with those left over, confirmed
/// tracks left over with weak detections.
///
/// Scans come one by one, each at its own stamp. One that is older than the newest by at most max_lag is used
/// as a measurement of the past state, z = H F(t - t_track) x, with the process noise in between added to its
/// covariance.
///
/// Bar-Shalom, Li, Kirubarajan: Estimation with Applications to Tracking and Navigation, 2001, chapter 6;
/// Blackman, Popoli: Design and Analysis of Modern Tracking Systems, 1999, chapter 6.
class ObjectTracker {
 public:
  /// @throws std::invalid_argument see validate
  explicit ObjectTracker(const ObjectTrackerParams& params = {});

  /// Adds the detections of one scan or mask, which may be none.
  /// @param time   s, of the scan @param radar  its number, the same in all scans; none: a mask of the camera
  /// @param T_odom_from_base  pose of the vehicle at `time`; only its planar part is used
  /// @return false, and no change, for a scan older than max_lag or an input that is not finite
  bool update(double time, std::optional<std::size_t> radar, const std::vector<ObjectDetection>& detections,
              const Eigen::Isometry3d& T_odom_from_base);

  /// Confirmed tracks that move, brought to `time` (s), ordered by id.
  std::vector<ObjectTrack> moving(double time) const;
  /// All tracks as they are, tentative ones included.
  std::vector<ObjectTrack> all() const;

  void reset();  ///< forgets all tracks; ids go on
  /// Goes on with other parameters; tracks stay. @throws std::invalid_argument see validate, without any
  /// change
  void configure(const ObjectTrackerParams& params);
  const ObjectTrackerParams& params() const noexcept { return params_; }

 private:
  struct Candidate {
    ObjectTrack track;
    std::optional<std::size_t> radar;  ///< that started it; none: the camera
    int scans = 1;                     ///< of this source, until the track is confirmed
  };
  struct Measurement;
  static Measurement measurementOf(const ObjectDetection& detection,
                                   const Eigen::Isometry3d& T_odom_from_base);
  void associate(std::vector<Measurement>& measurements, bool confirmed, bool moving,
                 std::vector<bool>& updated);
  void correct(const Measurement& measurement, ObjectTrack& track) const;
  static void note(const Measurement& measurement, ObjectTrack& track);
  bool isOneBody(const ObjectTrack& track, const Eigen::Vector4d& apart,
                 const Eigen::Matrix2d& velocity_covariance) const;
  bool isAbsorbed(const Measurement& measurement) const;
  void start(const Measurement& measurement, std::optional<std::size_t> radar);
  void endTracks(double time);
  void mergeTracks();

  ObjectTrackerParams params_;
  std::vector<Candidate> candidates_;
  std::uint64_t next_id_ = 1;
  double newest_;  ///< s
};

}  // namespace radar_dot
