// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/simulation/chassis_sensors.h"

#include <cmath>

#include "radar_dot/common/random_stream.h"
#include "simulation/sensors/pose_arrays.h"

namespace radar_dot::simulation {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kGravity = 9.81;        // m/s^2
constexpr double kPosePeriod = 0.02;     // s
constexpr double kChassisPeriod = 0.01;  // s
constexpr double kDifference = 5e-3;     // s, for accelerations
constexpr std::uint64_t kNoiseStream = 0xca11;

struct Motion {
  Eigen::Isometry3d T_map_from_base = Eigen::Isometry3d::Identity();
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();       // base frame
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();   // base frame, felt: with gravity
  Eigen::Vector3d rotation_rate = Eigen::Vector3d::Zero();  // base frame
};

Motion motionAt(const Trajectory& ego, double time_s) {
  Motion motion;
  motion.T_map_from_base = ego.at(time_s).T_map_from_body;
  const Eigen::Matrix3d R_base_from_map = motion.T_map_from_base.linear().transpose();
  const Eigen::Vector3d acceleration =
      (ego.velocity(time_s + kDifference) - ego.velocity(time_s - kDifference)) / (2.0 * kDifference);
  motion.velocity = R_base_from_map * ego.velocity(time_s);
  motion.acceleration = R_base_from_map * (acceleration + kGravity * Eigen::Vector3d::UnitZ());
  motion.rotation_rate = R_base_from_map * ego.angularVelocity(time_s);
  return motion;
}

class NoisyChassis {
 public:
  NoisyChassis(const ChassisModel& model, std::uint64_t seed) : model_(model), random_(seed, kNoiseStream) {}

  std::array<double, 3> noisy(const Eigen::Vector3d& value, double sigma) {
    return {value.x() + random_.normal(0.0, sigma), value.y() + random_.normal(0.0, sigma),
            value.z() + random_.normal(0.0, sigma)};
  }

  dataset::CanVehicleInfo vehicleInfo(const Motion& motion, double steering, std::int64_t time_us) {
    const double yaw_rate = motion.rotation_rate.z();
    const auto rpm = [&](double x, double y) {
      const double speed = std::hypot(motion.velocity.x() - yaw_rate * y, yaw_rate * x);
      if (speed < 1e-3) return 0.0;
      return speed / dataset::kZoeWheelRadius * 60.0 / (2.0 * kPi) + random_.normal(0.0, model_.wheel_noise);
    };
    dataset::CanVehicleInfo info;
    info.timestamp_us = time_us;
    info.front_left_rpm = rpm(model_.wheel_base, 0.5 * model_.track);
    info.front_right_rpm = rpm(model_.wheel_base, -0.5 * model_.track);
    info.rear_left_rpm = rpm(0.0, 0.5 * model_.track);
    info.rear_right_rpm = rpm(0.0, -0.5 * model_.track);
    info.odometer_speed_kph = std::round(3.6 * std::abs(motion.velocity.x()));
    info.steering_angle_deg = steering * model_.steering_ratio * 180.0 / kPi;
    return info;
  }

 private:
  const ChassisModel& model_;
  RandomStream random_;
};

}  // namespace

dataset::CanBus simulateCanBus(const Trajectory& ego, double begin_s, double end_s, std::int64_t start_us,
                               const ChassisModel& model, std::uint64_t seed) {
  // Every drive has noise of its own.
  NoisyChassis chassis(model, mixBits(seed) ^ static_cast<std::uint64_t>(start_us));
  const auto stamp = [&](double time_s) { return start_us + std::llround(1e6 * time_s); };
  dataset::CanBus can_bus;
  for (int i = 0; begin_s + i * kPosePeriod <= end_s; ++i) {
    const double time_s = begin_s + i * kPosePeriod;
    const Motion motion = motionAt(ego, time_s);
    can_bus.poses.push_back({stamp(time_s), asArray(motion.T_map_from_base.translation()),
                             quaternionOf(motion.T_map_from_base), asArray(motion.velocity),
                             chassis.noisy(motion.acceleration, model.acceleration_noise),
                             chassis.noisy(motion.rotation_rate, model.rotation_noise)});
  }
  for (int i = 0; begin_s + i * kChassisPeriod <= end_s; ++i) {
    const double time_s = begin_s + i * kChassisPeriod;
    const Motion motion = motionAt(ego, time_s);
    can_bus.imu.push_back({stamp(time_s), chassis.noisy(motion.acceleration, model.acceleration_noise),
                           quaternionOf(motion.T_map_from_base),
                           chassis.noisy(motion.rotation_rate, model.rotation_noise)});
    can_bus.vehicle.push_back(chassis.vehicleInfo(motion, ego.at(time_s).steering_angle, stamp(time_s)));
  }
  return can_bus;
}

}  // namespace radar_dot::simulation
