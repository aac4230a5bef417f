// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "radar_dot/radar/sensor_velocity.h"

namespace radar_dot {

/// Parameters of VelocityFilter.
struct VelocityFilterParams {
  // The spectral density of the white jerk is the square of these times 1 s.
  double longitudinal_jerk = 1.5;
  double lateral_jerk = 0.3;
  // The yaw acceleration is a Gauss-Markov process. What bounds it is the rate at which the driver steers at
  // low speeds and the lateral jerk at high ones: its sigma is min(curvature_rate |vx|, yaw_jerk / |vx|).
  double curvature_rate = 0.1;
  double yaw_jerk = 0.4;
  double yaw_acceleration_time = 0.5;
  double lateral_slip_std = 0.0;  // vy is 0 within this fraction of |vx| plus 0.02 m/s
  double lateral_slip_time = 2.0;
  double mount_yaw_std = 0.005;
  double error_correlation_time = 0.15;  // measurements closer in time count accordingly less
  int max_rejected = 5;
  double max_gap = 1.0;

  void describe(FieldList& fields) {
    const Range positive{1e-4, 1000.0};
    fields.add("longitudinal_jerk", longitudinal_jerk,
               "1 sigma of the change of the longitudinal acceleration in one second", "m/s^3", positive);
    fields.add("lateral_jerk", lateral_jerk, "The same of the sideslip velocity vy", "m/s^3", positive);
    fields.add("curvature_rate", curvature_rate,
               "Change of the curvature of the path per second: bounds the yaw acceleration at low speed",
               "1/(m s)", positive);
    fields.add("yaw_jerk", yaw_jerk,
               "Change of the centripetal acceleration per second: bounds the yaw acceleration at high speed",
               "m/s^3", positive);
    fields.add("yaw_acceleration_time", yaw_acceleration_time, "Correlation time of the yaw acceleration",
               "s", {0.01, 100.0});
    fields.add(
        "lateral_slip_std", lateral_slip_std,
        "1 sigma of the slip angle of base_frame, which must be at the rear axle; 0: vy is not assumed to "
        "be small",
        "rad", {0.0, 1.0});
    fields.add("lateral_slip_time", lateral_slip_time, "Correlation time of the slip", "s", {0.01, 100.0});
    fields.add("mount_yaw_std", mount_yaw_std,
               "1 sigma of the yaw error of each mount, which the filter learns; 0: mounts are exact", "rad",
               {0.0, 1.0});
    fields.add("error_correlation_time", error_correlation_time,
               "Correlation time of measurement errors (successive sweeps see the same objects)", "s",
               {0.0, 10.0});
    fields.add("max_rejected", max_rejected,
               "Updates in a row outside the gate, after which the filter resets", "", {1, 100});
    fields.add("max_filter_gap", max_gap, "Time without an update, after which the filter resets", "s",
               {0.01, 60.0});
  }
};

/// Causal Kalman filter over the velocity estimates of a vehicle's radars.
///
/// State, in the base frame:
///     x = [vx, vy, w, ax, ay, alpha, psi_1 ... psi_n],   m/s, rad/s, m/s^2, rad/s^2, rad
/// velocity of the origin, yaw rate, their rates of change, and the yaw by which each radar's mount is turned
/// from its calibration. vx and vy change with constant acceleration driven by white jerk; alpha is a
/// Gauss-Markov process (Singer's model of manoeuvring targets, IEEE Trans. AES-6, 1970); the psi are
/// constants.
///
/// Measurements, either or both:
/// - a velocity estimate of all radars together, z = [vx, vy, w] (update with a covariance), or
/// - the velocity over ground of each radar by itself at the time of its own scan (update with sensor
/// velocities),
///       z_i = (v + w x t_i) + psi_i (v + w x t_i) x z,       t_i the lever arm,
///   linearised at the prediction. Three or more radars overdetermine the motion, which shows how their
///   mounts are turned against each other; a rotation common to all, and one that grows along the vehicle,
///   differ from a sideslip and a curve only by lateral_slip_std and mount_yaw_std.
/// Each measurement must lie within the 99.9 % ellipsoid of its innovation covariance. Updates are in Joseph
/// form.
///
/// Axes that the motion model of the estimates assumes keep the assumed value, and its variance, which widens
/// what is estimated (Schmidt's consider states): with the ackermann model vy stays 0 within sideslip_std.
///
/// An update in which more measurements were refused than used is rejected. After max_rejected of them in a
/// row, or a gap, the filter restarts from the estimate at hand and keeps what it learnt of the mounts.
///
/// Bar-Shalom, Li, Kirubarajan: Estimation with Applications to Tracking and Navigation, 2001, chapters 5
/// and 6.
class VelocityFilter {
 public:
  using Sources = std::array<AxisSource, 3>;
  static constexpr Sources kEstimatedAxes = {AxisSource::kEstimated, AxisSource::kEstimated,
                                             AxisSource::kEstimated};

  /// What became of an update.
  enum class Outcome : std::uint8_t {
    kStarted,  ///< first estimate, after a reset, a gap, or too many rejections
    kUpdated,
    kRejected,  ///< contradicts the filter: only predicted
    kStale,     ///< not later than the update before, or not finite: no change
  };

  /// Velocity [vx, vy, w] and its covariance, m/s and rad/s.
  struct State {
    double time = 0.0;  ///< s
    Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
    Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  ///< of `velocity`, per second
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();    ///< of `velocity`
  };

  /// @throws std::invalid_argument naming the invalid parameter.
  explicit VelocityFilter(const VelocityFilterParams& params = {});

  /// A velocity [vx, vy, w] at `time` (s) and its covariance.
  /// @param sensors  the radars of the sweep, each at its own time, which may precede the update before by a
  ///                 little; with them the joint estimate only starts the filter, and tells what is given
  /// @param sources  of vx, vy, w; the filter restarts where others are assumed than before
  Outcome update(double time, const Eigen::Vector3d& velocity, const Eigen::Matrix3d& covariance,
                 const std::vector<SensorVelocity>& sensors = {}, const Sources& sources = kEstimatedAxes);

  /// The same of an estimate of EgoVelocityEstimator in the plane, whatever its motion model.
  Outcome update(double time, const EgoVelocityResult& result, const std::vector<SensorVelocity>& sensors);

  bool started() const noexcept { return started_; }
  /// The state brought forward to `time`, at the earliest that of the latest update. Only when started.
  State at(double time) const;
  const Eigen::VectorXd& state() const noexcept { return state_; }            ///< x, at time()
  const Eigen::MatrixXd& covariance() const noexcept { return covariance_; }  ///< of x
  double time() const noexcept { return time_; }                              ///< s, of the latest update
  /// rad, to be added to the yaw of the mount; 0 for radars not seen yet.
  double mountYaw(std::size_t radar) const;
  double mountYawVariance(std::size_t radar) const;  ///< rad^2, of mountYaw()
  /// rad, by radar: 1 sigma of mounts known otherwise than by mount_yaw_std, for now and after a reset. With
  /// a mount_yaw_std of 0 these are exact too. Resets.
  void setMountYawStds(std::vector<std::optional<double>> stds);
  /// rad^2, of mountYaw() before anything is learnt.
  double startVariance(std::size_t radar) const;
  /// Forgets everything, what was learnt of the mounts as well.
  void reset();

  const VelocityFilterParams& params() const noexcept { return params_; }

 private:
  struct Measurement;
  void start(double time, const Eigen::Vector3d& velocity, const Eigen::Matrix3d& covariance);
  bool acceptsTime(double time) const;
  void predict(double time);
  void constrainSlip(double interval);
  Measurement measurementOf(const SensorVelocity& sensor) const;
  Measurement jointMeasurement(const Eigen::Vector3d& velocity, Eigen::Matrix3d covariance) const;
  bool correct(const Measurement& measurement);
  Outcome conclude(double time, const Eigen::Vector3d& velocity, const Eigen::Matrix3d& covariance,
                   std::size_t used, std::size_t refused);
  void addMounts(std::size_t count);

  VelocityFilterParams params_;
  std::vector<std::optional<double>> mount_yaw_stds_;  ///< rad, by radar
  bool started_ = false;
  double time_ = 0.0;              ///< s, the state holds at
  double last_update_ = 0.0;       ///< s
  int rejected_ = 0;               ///< in a row
  std::array<bool, 3> assumed_{};  ///< vx, vy, w
  Eigen::VectorXd state_;
  Eigen::MatrixXd covariance_;
  std::vector<double> last_scan_;  ///< s, by radar: of its latest used measurement
};

/// Velocity, covariance and observed axes of a filtered estimate: vx, vy and the yaw rate of `state`, the
/// other axes and the figures of the latest single estimate. Without residuals and labels, which belong to
/// that one.
EgoVelocityResult filteredResult(const VelocityFilter::State& state, const EgoVelocityResult& result);

}  // namespace radar_dot
