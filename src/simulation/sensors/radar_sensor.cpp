// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensors/radar_sensor.h"

#include <algorithm>
#include <cmath>

#include "simulation/sensors/radar_echoes.h"
#include "simulation/sensors/radar_states.h"

namespace radar_dot::simulation {
namespace {

double quantised(double value, double step) { return step * std::round(value / step); }

/// Turns echoes into what the radar reports of them.
class Reporter {
 public:
  Reporter(const RadarMotion& motion, const RadarModel& model, RandomStream& random)
      : motion_(motion), model_(model), random_(random) {
    previous_yaw_rate_ = motion.yaw_rate;
    const Eigen::Vector3d own = motion.T_map_from_sensor.linear().transpose() * motion.velocity;
    own_velocity_ = own.head<2>();
    speed_ = own_velocity_.norm();
    if (speed_ < kStands) return;
    previous_yaw_rate_ += model.yaw_rate_deviation * random.normal();
    own_velocity_ *= 1.0 + model.speed_deviation * random.normal() / speed_;
  }

  RadarReturn report(const Echo& echo, const RadarScanModel& scan, bool narrow) {
    RadarReturn reported;
    reported.is_quality_valid = 1;
    reported.object = echo.object;
    reported.true_range_rate = static_cast<float>(echo.range_rate);
    reported.rcs = static_cast<float>(quantised(echo.rcs, model_.rcs_step));
    place(reported, echo, scan);
    ReturnContext context;
    context.range = std::hypot(reported.x, reported.y);
    context.azimuth = std::atan2(reported.y, reported.x);
    context.narrow = narrow;
    context.isolated = echo.isolated;
    context.sideways = motion_.sideways;
    context.folded = random_.chance(model_.folded_share);
    const Eigen::Vector2d bearing(std::cos(context.azimuth), std::sin(context.azimuth));
    const double doppler = measuredRangeRate(echo, context, scan);
    context.ground_speed = doppler + bearing.dot(own_velocity_);
    judgeReturn(reported, context, model_, random_);
    writeVelocity(reported, doppler, bearing);
    codeAccuracies(reported, context, random_);
    return reported;
  }

 private:
  static constexpr double kStands = 0.05;  // m/s

  void place(RadarReturn& reported, const Echo& echo, const RadarScanModel& scan) {
    const double cosine = std::max(0.2, std::cos(echo.azimuth));
    const double azimuth = echo.azimuth + scan.azimuth_deviation / (cosine * cosine) * random_.normal();
    const double range = std::max(0.5, echo.range + scan.range_deviation * random_.normal());
    const double step = model_.position_step;
    // Real x are multiples of the step, real y lie half a step beside them.
    reported.x = static_cast<float>(std::max(step, quantised(range * std::cos(azimuth), step)));
    reported.y = static_cast<float>(quantised(range * std::sin(azimuth) - 0.5 * step, step) + 0.5 * step);
  }

  double measuredRangeRate(const Echo& echo, const ReturnContext& context, const RadarScanModel& scan) {
    const double spread = model_.doppler_spread * std::min(1.0, speed_ / model_.spread_speed);
    double deviation = std::hypot(model_.doppler_deviation, spread);
    constexpr double kWeak = 4.0;  // dB above the threshold
    if (echo.rcs < detectionThreshold(echo.range, echo.azimuth, scan, model_) + kWeak)
      deviation *= model_.weak_doppler_factor;
    const double fold = context.folded ? model_.folded_deviation * random_.normal() : 0.0;
    return echo.range_rate + fold + deviation * random_.normal();
  }

  /// A lone Doppler leaves the velocity across the bearing open. The radar takes vy of static returns
  /// from its own turning, of others as 0, and solves for vx so that the projection is the Doppler.
  void writeVelocity(RadarReturn& reported, double doppler, const Eigen::Vector2d& bearing) const {
    if (reported.dyn_prop != kUnknown) {
      const bool assumed_static =
          reported.dyn_prop == kStationary || reported.dyn_prop == kStationaryCandidate;
      const double vy =
          assumed_static && reported.ambig_state == 3
              ? -previous_yaw_rate_ * (static_cast<double>(reported.x) + model_.assumed_lever_arm)
              : 0.0;
      reported.vy = static_cast<float>(quantised(vy, model_.velocity_step));
      const double vx = (doppler - bearing.y() * static_cast<double>(reported.vy)) / bearing.x();
      reported.vx = static_cast<float>(quantised(vx, model_.velocity_step));
    }
    const double reported_doppler =
        bearing.x() * static_cast<double>(reported.vx) + bearing.y() * static_cast<double>(reported.vy);
    const Eigen::Vector2d over_ground = bearing * (reported_doppler + bearing.dot(own_velocity_));
    reported.vx_comp = static_cast<float>(over_ground.x());
    reported.vy_comp = static_cast<float>(over_ground.y());
  }

  const RadarMotion& motion_;
  const RadarModel& model_;
  RandomStream& random_;
  double previous_yaw_rate_ = 0.0;                          // rad/s
  double speed_ = 0.0;                                      // m/s
  Eigen::Vector2d own_velocity_ = Eigen::Vector2d::Zero();  // m/s, as told, sensor frame
};

std::vector<Echo> scanEchoes(const Snapshot& snapshot, const RadarMotion& motion, const RadarScanModel& scan,
                             const RadarModel& model, RandomStream& random) {
  std::vector<Echo> echoes = surfaceEchoes(snapshot, motion, scan, model, random);
  addGhosts(echoes, motion, scan, model, random);
  std::stable_sort(echoes.begin(), echoes.end(),
                   [](const Echo& a, const Echo& b) { return a.range < b.range; });
  return echoes;
}

}  // namespace

std::vector<RadarReturn> simulateRadarScan(const Snapshot& snapshot, const SensorMount& mount,
                                           const Trajectory& ego, std::uint64_t seed, std::uint64_t stream,
                                           const RadarModel& model) {
  RandomStream random(seed, stream);
  const RadarMotion motion(mount, ego, snapshot.time());
  Reporter reporter(motion, model, random);
  std::vector<RadarReturn> returns;
  for (const bool narrow : {false, true}) {
    const RadarScanModel& scan = narrow ? model.narrow : model.wide;
    for (const Echo& echo : scanEchoes(snapshot, motion, scan, model, random)) {
      if (static_cast<int>(returns.size()) >= model.max_returns) break;
      returns.push_back(reporter.report(echo, scan, narrow));
      returns.back().id = static_cast<std::int16_t>(returns.size() - 1);
    }
  }
  return returns;
}

}  // namespace radar_dot::simulation
