// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scenarios/path_trajectory.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "radar_dot/common/random_stream.h"

namespace radar_dot::simulation {
namespace {

constexpr double kTwoPi = 6.283185307179586;
constexpr double kStepLength = 0.6;      // m, over which a walker climbs a kerb
constexpr double kSwayWheelbase = 2.59;  // m, of the nuScenes car
constexpr int kLags = 40;                // of the springs' response
constexpr double kLag = 0.04;            // s
constexpr double kRoadFadeSpeed = 3.0;   // m/s

double smoothStep(double x) noexcept {
  const double inside = std::clamp(x, 0.0, 1.0);
  return inside * inside * inside * (10.0 - inside * (15.0 - 6.0 * inside));
}

}  // namespace

PathTrajectory::PathTrajectory(std::shared_ptr<const Path> path, SpeedProfile profile, Options options)
    : path_(std::move(path)), profile_(std::move(profile)), options_(std::move(options)) {}

double PathTrajectory::heightAt(double along) const noexcept {
  double height = options_.height;
  for (const HeightStep& step : options_.height_steps)
    height += step.step * smoothStep((along - step.along) / kStepLength + 0.5);
  return height;
}

BodyState PathTrajectory::at(double time_s) const {
  BodyState state;
  const double along_path = along(time_s);
  state.distance = options_.odometer + profile_.distance(time_s);
  state.speed = profile_.speed(time_s);
  const PathPoint point = path_->at(along_path);
  state.steering_angle = std::atan(options_.wheelbase * point.curvature);
  const Eigen::Vector2d forward(std::cos(point.heading), std::sin(point.heading));
  const Eigen::Vector2d origin = point.position - options_.rear_axle_x * forward;
  state.T_map_from_body.linear() =
      Eigen::AngleAxisd(point.heading, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  state.T_map_from_body.translation() << origin, heightAt(along_path);
  return state;
}

SprungTrajectory::SprungTrajectory(std::shared_ptr<const Path> path, SpeedProfile profile, double start,
                                   std::uint64_t seed)
    : SprungTrajectory(std::move(path), std::move(profile), start, seed, Options()) {}

SprungTrajectory::SprungTrajectory(std::shared_ptr<const Path> path, SpeedProfile profile, double start,
                                   std::uint64_t seed, const Options& options)
    : base_(std::move(path), std::move(profile), {start, 0.0, kSwayWheelbase, 0.0, {}, 0.0}),
      options_(options) {
  RandomStream random(seed, 71);
  for (std::vector<Sine>* sines : {&pitch_, &roll_, &heave_})
    for (int i = 0; i < 5; ++i)
      sines->push_back({kTwoPi * random.uniform(1.0 + 0.2 * i, 1.2 + 0.2 * i), random.uniform(0.0, kTwoPi)});
  // Impulse response of a damped oscillator and its slope, scaled so that a lasting acceleration
  // comes out as it went in.
  const double frequency = kTwoPi * options.natural_frequency;
  const double decay = options.damping * frequency;
  const double damped = frequency * std::sqrt(1.0 - options.damping * options.damping);
  double sum = 0.0;
  double slope_sum = 0.0;
  for (int i = 0; i < kLags; ++i) {
    const double lag = (i + 0.5) * kLag;
    const double envelope = std::exp(-decay * lag);
    impulse_.push_back(envelope * std::sin(damped * lag));
    impulse_slope_.push_back(envelope * (damped * std::cos(damped * lag) - decay * std::sin(damped * lag)));
    sum += impulse_.back();
    slope_sum -= impulse_slope_.back() * lag;
  }
  for (double& weight : impulse_) weight /= sum;
  for (double& weight : impulse_slope_) weight /= slope_sum;
}

/// Longitudinal: by parts from the speed, since its derivative, the acceleration, has corners.
SprungTrajectory::Sway SprungTrajectory::response(double time_s) const noexcept {
  Sway sway;
  const double speed_now = base_.profile().speed(time_s);
  for (std::size_t i = 0; i < impulse_.size(); ++i) {
    const double time = time_s - (static_cast<double>(i) + 0.5) * kLag;
    const double speed = base_.profile().speed(time);
    const double curvature = base_.path().at(base_.along(time)).curvature;
    sway.pitch -= options_.pitch_per_acceleration * impulse_slope_[i] * (speed - speed_now);
    sway.roll += options_.roll_per_acceleration * impulse_[i] * speed * speed * curvature;
  }
  return sway;
}

BodyState SprungTrajectory::at(double time_s) const {
  BodyState state = base_.at(time_s);
  Sway sway = response(time_s);
  const double fade =
      state.speed * state.speed / (state.speed * state.speed + kRoadFadeSpeed * kRoadFadeSpeed);
  const auto unevenness = [&](const std::vector<Sine>& sines, double deviation) {
    double sum = 0.0;
    for (const Sine& sine : sines) sum += std::sin(sine.frequency * time_s + sine.phase);
    return fade * deviation * std::sqrt(2.0 / static_cast<double>(sines.size())) * sum;
  };
  sway.pitch += unevenness(pitch_, options_.pitch_deviation);
  sway.roll += unevenness(roll_, options_.roll_deviation);
  state.T_map_from_body.linear() =
      state.T_map_from_body.linear() * (Eigen::AngleAxisd(sway.pitch, Eigen::Vector3d::UnitY()) *
                                        Eigen::AngleAxisd(sway.roll, Eigen::Vector3d::UnitX()))
                                           .toRotationMatrix();
  state.T_map_from_body.translation().z() += unevenness(heave_, options_.heave_deviation);
  return state;
}

}  // namespace radar_dot::simulation
