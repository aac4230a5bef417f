// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/objects/object_tracker.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "radar_dot/objects/assignment.h"

namespace radar_dot {
namespace {

constexpr double kNever = -std::numeric_limits<double>::infinity();

Eigen::Matrix4d transition(double dt) {
  Eigen::Matrix4d F = Eigen::Matrix4d::Identity();
  F.topRightCorner<2, 2>() = dt * Eigen::Matrix2d::Identity();
  return F;
}

Eigen::Matrix4d processNoise(double dt, double acceleration_std) {
  const double h = std::abs(dt);
  const Eigen::Matrix2d I = acceleration_std * acceleration_std * Eigen::Matrix2d::Identity();
  Eigen::Matrix4d Q;
  Q.topLeftCorner<2, 2>() = h * h * h / 3.0 * I;
  Q.topRightCorner<2, 2>() = 0.5 * h * h * I;
  Q.bottomLeftCorner<2, 2>() = 0.5 * h * h * I;
  Q.bottomRightCorner<2, 2>() = h * I;
  return Q;
}

}  // namespace

/// A detection in the world-fixed frame.
struct ObjectTracker::Measurement {
  const ObjectDetection* detection = nullptr;
  double time = 0.0;
  Eigen::Vector4d value;
  Eigen::Matrix4d covariance;
  bool used = false;

  /// Innovation of a track, with its matrix of measurement H and covariance S.
  struct Innovation {
    Eigen::Vector4d value;
    Eigen::Matrix4d H, R, S;
    double distance() const { return value.dot(S.ldlt().solve(value)); }
  };
  Innovation innovation(const ObjectTrack& track, double acceleration_std) const {
    Innovation innovation;
    const double dt = time - track.time;  // not zero for a scan of the past
    innovation.H = transition(dt);
    innovation.R = covariance;
    if (dt != 0.0) innovation.R += processNoise(dt, acceleration_std);
    innovation.value = value - innovation.H * track.state;
    innovation.S = innovation.H * track.covariance * innovation.H.transpose() + innovation.R;
    return innovation;
  }
};

void validate(const ObjectTrackerParams& params) {
  const FieldList fields = fieldsOf(params);
  checkFields(fields);
  requireNotMore(fields, params.min_coast, params.max_coast);
  requireNotMore(fields, params.min_body_length, params.max_body_length);
}

ObjectTrack ObjectTrack::at(double when, double acceleration_std) const {
  ObjectTrack moved = *this;
  const Eigen::Matrix4d F = transition(when - time);
  moved.time = when;
  moved.state = F * state;
  moved.covariance = F * covariance * F.transpose() + processNoise(when - time, acceleration_std);
  return moved;
}

ObjectTracker::ObjectTracker(const ObjectTrackerParams& params) : params_(params), newest_(kNever) {
  validate(params);
}

void ObjectTracker::reset() {
  candidates_.clear();
  newest_ = kNever;
}

void ObjectTracker::configure(const ObjectTrackerParams& params) {
  validate(params);
  params_ = params;
}

ObjectTracker::Measurement ObjectTracker::measurementOf(const ObjectDetection& detection,
                                                        const Eigen::Isometry3d& T_odom_from_base) {
  const double yaw = std::atan2(T_odom_from_base.linear()(1, 0), T_odom_from_base.linear()(0, 0));
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(yaw).toRotationMatrix();
  Measurement measurement;
  measurement.detection = &detection;
  measurement.value << T_odom_from_base.translation().head<2>() + R * detection.position,
      R * detection.velocity;
  measurement.covariance.setZero();
  measurement.covariance.topLeftCorner<2, 2>() = R * detection.position_covariance * R.transpose();
  measurement.covariance.bottomRightCorner<2, 2>() = R * detection.velocity_covariance * R.transpose();
  return measurement;
}

bool ObjectTracker::update(double time, std::optional<std::size_t> radar,
                           const std::vector<ObjectDetection>& detections,
                           const Eigen::Isometry3d& T_odom_from_base) {
  if (!std::isfinite(time) || !T_odom_from_base.matrix().allFinite() || time < newest_ - params_.max_lag)
    return false;
  newest_ = std::max(newest_, time);
  for (Candidate& candidate : candidates_) {
    if (time > candidate.track.time) candidate.track = candidate.track.at(time, params_.acceleration_std);
    if (candidate.radar == radar && !candidate.track.confirmed) ++candidate.scans;
  }
  std::vector<Measurement> measurements;
  for (const ObjectDetection& detection : detections) {
    Measurement measurement = measurementOf(detection, T_odom_from_base);
    measurement.time = time;
    if (measurement.value.allFinite() && measurement.covariance.allFinite())
      measurements.push_back(measurement);
  }
  std::vector<bool> updated(candidates_.size(), false);
  associate(measurements, true, true, updated);
  associate(measurements, false, true, updated);
  associate(measurements, true, false, updated);
  for (const Measurement& measurement : measurements) {
    if (measurement.used || !measurement.detection->moving || isAbsorbed(measurement)) continue;
    start(measurement, radar);
  }
  endTracks(newest_);
  mergeTracks();
  return true;
}

void ObjectTracker::associate(std::vector<Measurement>& measurements, bool confirmed, bool moving,
                              std::vector<bool>& updated) {
  std::vector<std::size_t> rows, columns;
  for (std::size_t i = 0; i < updated.size(); ++i)
    if (!updated[i] && candidates_[i].track.confirmed == confirmed) rows.push_back(i);
  for (std::size_t j = 0; j < measurements.size(); ++j)
    if (!measurements[j].used && measurements[j].detection->moving == moving) columns.push_back(j);
  if (rows.empty() || columns.empty()) return;

  constexpr double kForbidden = std::numeric_limits<double>::infinity();
  Eigen::MatrixXd costs = Eigen::MatrixXd::Constant(static_cast<Eigen::Index>(rows.size()),
                                                    static_cast<Eigen::Index>(columns.size()), kForbidden);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const auto innovation =
          measurements[columns[c]].innovation(candidates_[rows[r]].track, params_.acceleration_std);
      const double distance = innovation.distance();
      if (!(distance <= params_.gate * params_.gate)) continue;
      costs(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) =
          distance + std::log(innovation.S.determinant());
    }
  }
  constexpr double kPairsFirst = 1e6;  // as many pairs as the gates allow, then the least cost
  const std::vector<int> partners = assign(costs, kPairsFirst);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    if (partners[r] == kUnassigned) continue;
    Measurement& measurement = measurements[columns[static_cast<std::size_t>(partners[r])]];
    Candidate& candidate = candidates_[rows[r]];
    correct(measurement, candidate.track);
    measurement.used = true;
    updated[rows[r]] = true;
    if (candidate.track.hits >= static_cast<std::size_t>(params_.confirm_hits))
      candidate.track.confirmed = true;
  }
}

void ObjectTracker::correct(const Measurement& measurement, ObjectTrack& track) const {
  const auto innovation = measurement.innovation(track, params_.acceleration_std);
  const Eigen::Matrix4d gain = innovation.S.ldlt().solve(innovation.H * track.covariance).transpose();
  track.state += gain * innovation.value;
  const Eigen::Matrix4d rest = Eigen::Matrix4d::Identity() - gain * innovation.H;
  track.covariance = rest * track.covariance * rest.transpose() + gain * innovation.R * gain.transpose();
  ++track.hits;
  track.last_hit = std::max(track.last_hit, measurement.time);
  if (measurement.detection->moving) track.last_moving = std::max(track.last_moving, measurement.time);
  note(measurement, track);
}

void ObjectTracker::note(const Measurement& measurement, ObjectTrack& track) {
  const ObjectDetection& detection = *measurement.detection;
  if (detection.return_count > 0) track.return_count = detection.return_count;
  if (detection.box.empty()) return;
  track.box = detection.box;
  track.pixel_count = detection.pixel_count;
  track.last_image = measurement.time;
}

bool ObjectTracker::isOneBody(const ObjectTrack& track, const Eigen::Vector4d& apart,
                              const Eigen::Matrix2d& velocity_covariance) const {
  const double speed = track.speed();
  const double shortest = std::min(params_.min_body_length, params_.max_body_length);
  const double length = std::clamp(params_.body_time * speed, shortest, params_.max_body_length);
  const Eigen::Vector2d heading = track.velocity() / std::max(speed, 1e-9);
  const double along = heading.dot(apart.head<2>());
  const double across = heading.x() * apart.y() - heading.y() * apart.x();
  if (std::pow(along / length, 2) + std::pow(across / params_.max_body_width, 2) > 1.0) return false;
  // Velocities are compared as far as they are known.
  const double tolerance = params_.body_velocity / 3.0;
  const Eigen::Matrix2d covariance = velocity_covariance + track.covariance.bottomRightCorner<2, 2>() +
                                     tolerance * tolerance * Eigen::Matrix2d::Identity();
  return apart.tail<2>().dot(covariance.inverse() * apart.tail<2>()) <= 9.0;
}

bool ObjectTracker::isAbsorbed(const Measurement& measurement) const {
  return std::any_of(candidates_.begin(), candidates_.end(), [&](const Candidate& candidate) {
    const ObjectTrack& track = candidate.track;
    return track.confirmed &&
           isOneBody(track, measurement.value - transition(measurement.time - track.time) * track.state,
                     measurement.covariance.bottomRightCorner<2, 2>());
  });
}

void ObjectTracker::start(const Measurement& measurement, std::optional<std::size_t> radar) {
  Candidate candidate;
  ObjectTrack& track = candidate.track;
  candidate.radar = radar;
  track.id = next_id_++;
  track.time = track.birth = track.last_hit = track.last_moving = measurement.time;
  track.hits = 1;
  track.confirmed = params_.confirm_hits <= 1;
  const Eigen::Matrix2d measured = measurement.covariance.bottomRightCorner<2, 2>().inverse();
  const Eigen::Matrix2d prior =
      Eigen::Matrix2d::Identity() / (params_.initial_speed_std * params_.initial_speed_std);
  track.covariance.setZero();
  track.covariance.topLeftCorner<2, 2>() = measurement.covariance.topLeftCorner<2, 2>();
  track.covariance.bottomRightCorner<2, 2>() = (measured + prior).inverse();
  track.state.head<2>() = measurement.value.head<2>();
  // The prior is about the unknown part alone: it does not pull the known one towards zero.
  track.state.tail<2>() = measurement.value.tail<2>();
  note(measurement, track);
  candidates_.push_back(candidate);
}

void ObjectTracker::endTracks(double time) {
  const auto ended = [&](const Candidate& candidate) {
    const ObjectTrack& track = candidate.track;
    if (!track.confirmed && candidate.scans >= params_.confirm_scans) return true;
    // Trust has to be earned: a track coasts no longer than it has been followed.
    const double followed = track.last_hit - track.birth;
    const double coast =
        std::clamp(followed, std::min(params_.min_coast, params_.max_coast), params_.max_coast);
    return time - track.last_hit > coast || time - track.last_moving > params_.max_weak_time;
  };
  candidates_.erase(std::remove_if(candidates_.begin(), candidates_.end(), ended), candidates_.end());
}

void ObjectTracker::mergeTracks() {
  for (std::size_t i = 0; i < candidates_.size(); ++i) {
    const ObjectTrack& older = candidates_[i].track;
    if (!older.confirmed) continue;
    for (std::size_t j = candidates_.size() - 1; j > i; --j) {
      const ObjectTrack& younger = candidates_[j].track;
      if (!younger.confirmed) continue;
      const Eigen::Vector4d apart = transition(older.time - younger.time) * younger.state - older.state;
      if (isOneBody(older, apart, younger.covariance.bottomRightCorner<2, 2>()))
        candidates_.erase(candidates_.begin() + static_cast<std::ptrdiff_t>(j));
    }
  }
}

std::vector<ObjectTrack> ObjectTracker::moving(double time) const {
  std::vector<ObjectTrack> tracks;
  for (const Candidate& candidate : candidates_)
    if (candidate.track.confirmed && candidate.track.speed() >= params_.min_speed)
      tracks.push_back(candidate.track.at(time, params_.acceleration_std));
  return tracks;
}

std::vector<ObjectTrack> ObjectTracker::all() const {
  std::vector<ObjectTrack> tracks;
  for (const Candidate& candidate : candidates_) tracks.push_back(candidate.track);
  return tracks;
}

}  // namespace radar_dot
