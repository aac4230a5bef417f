// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/velocity_filter.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "radar_dot/common/stamped_twist.h"

namespace radar_dot {
namespace {

constexpr Eigen::Index kMotion = 6;  // vx vy w ax ay alpha

constexpr Eigen::Index kTwistAxes[] = {0, 1, 5};  // vx vy w among vx vy vz wx wy wz

// 99.9 % quantiles of chi-square with 1, 2, 3 degrees of freedom.
constexpr std::array<double, 3> kGate = {10.83, 13.82, 16.27};

// What is known of the accelerations when the filter starts: those of ordinary driving.
constexpr double kStartAcceleration = 2.0;         // m/s^2, 1 sigma
constexpr double kStartLateralAcceleration = 0.5;  // m/s^2
constexpr double kStartYawAcceleration = 0.3;      // rad/s^2

constexpr double kManoeuvre = 8.0;  // m/s^2, 1 sigma of the longitudinal acceleration after a refused update

constexpr double kSlipFloor = 0.02;  // m/s, of vy while standing: the origin is not exactly on the axle
constexpr double kLeastSpeed = 0.3;  // m/s, below which the yaw acceleration no longer shrinks

// Scans of a sweep precede one another by less; older ones are no measurement of the state.
constexpr double kMaxLateness = 0.2;  // s

/// Integral of white jerk of spectral density 1 over dt: covariance of [velocity, acceleration].
Eigen::Matrix2d whiteJerk(double dt) {
  Eigen::Matrix2d q;
  q << dt * dt * dt / 3.0, dt * dt / 2.0, dt * dt / 2.0, dt;
  return q;
}

/// Change of a velocity over dt whose acceleration a decays with the time constant tau: factors of a.
struct Decay {
  double velocity, acceleration;
  Decay(double dt, double tau) : velocity(-tau * std::expm1(-dt / tau)), acceleration(std::exp(-dt / tau)) {}
};

/// Covariance of [velocity, acceleration] of Singer's model with stationary variance 1 of the acceleration.
Eigen::Matrix2d singer(double dt, double tau) {
  const double s = dt / tau;
  Eigen::Matrix2d q;
  if (s < 1e-2) {
    q = 2.0 / tau * whiteJerk(dt);  // the closed form cancels here
    return q;
  }
  const double e1 = std::exp(-s);
  const double e2 = e1 * e1;
  q(0, 0) = tau * tau * (4.0 * e1 - 3.0 - e2 + 2.0 * s);
  q(0, 1) = q(1, 0) = tau * (e2 + 1.0 - 2.0 * e1);
  q(1, 1) = 1.0 - e2;
  return q;
}

}  // namespace

/// z = h(x) + noise, linearised: the innovation z - h and the Jacobian H at the present state.
struct VelocityFilter::Measurement {
  Eigen::VectorXd innovation;
  Eigen::MatrixXd jacobian;
  Eigen::MatrixXd noise;
};

VelocityFilter::VelocityFilter(const VelocityFilterParams& params) : params_(params) {
  validate(params_);
  reset();
}

void VelocityFilter::reset() {
  started_ = false;
  rejected_ = 0;
  state_ = Eigen::VectorXd::Zero(kMotion);
  covariance_ = Eigen::MatrixXd::Zero(kMotion, kMotion);
  last_scan_.clear();
}

double VelocityFilter::mountYaw(std::size_t radar) const {
  return radar < last_scan_.size() ? state_[kMotion + static_cast<Eigen::Index>(radar)] : 0.0;
}

double VelocityFilter::mountYawVariance(std::size_t radar) const {
  if (radar >= last_scan_.size()) return startVariance(radar);
  const Eigen::Index mount = kMotion + static_cast<Eigen::Index>(radar);
  return covariance_(mount, mount);
}

void VelocityFilter::setMountYawStds(std::vector<std::optional<double>> stds) {
  mount_yaw_stds_ = std::move(stds);
  reset();
}

double VelocityFilter::startVariance(std::size_t radar) const {
  double std = params_.mount_yaw_std;
  if (std > 0.0 && radar < mount_yaw_stds_.size()) std = mount_yaw_stds_[radar].value_or(std);
  return std * std;
}

void VelocityFilter::addMounts(std::size_t count) {
  if (count <= last_scan_.size()) return;
  const Eigen::Index before = state_.size();
  const Eigen::Index after = kMotion + static_cast<Eigen::Index>(count);
  state_.conservativeResize(after);
  state_.tail(after - before).setZero();
  Eigen::MatrixXd grown = Eigen::MatrixXd::Zero(after, after);
  grown.topLeftCorner(before, before) = covariance_;
  for (std::size_t radar = last_scan_.size(); radar < count; ++radar) {
    const Eigen::Index mount = kMotion + static_cast<Eigen::Index>(radar);
    grown(mount, mount) = startVariance(radar);
  }
  covariance_ = std::move(grown);
  last_scan_.resize(count, -std::numeric_limits<double>::infinity());
}

void VelocityFilter::start(double time, const Eigen::Vector3d& velocity, const Eigen::Matrix3d& covariance) {
  state_.head<3>() = velocity;
  state_.segment<3>(3).setZero();
  covariance_.topRows(kMotion).setZero();
  covariance_.leftCols(kMotion).setZero();
  covariance_.topLeftCorner<3, 3>() = covariance;
  covariance_(3, 3) = kStartAcceleration * kStartAcceleration;
  covariance_(4, 4) = kStartLateralAcceleration * kStartLateralAcceleration;
  covariance_(5, 5) = kStartYawAcceleration * kStartYawAcceleration;
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (assumed_[static_cast<std::size_t>(i)]) covariance_(3 + i, 3 + i) = 0.0;
  }
  time_ = last_update_ = time;
  rejected_ = 0;
  started_ = true;
}

bool VelocityFilter::acceptsTime(double time) const {
  return std::isfinite(time) && (!started_ || time > last_update_);
}

namespace {

/// Transition and process noise of the motion over dt.
void motionModel(const VelocityFilterParams& params, const std::array<bool, 3>& assumed, double speed,
                 double dt, Eigen::Matrix<double, 6, 6>& F, Eigen::Matrix<double, 6, 6>& Q) {
  const double v = std::max(std::abs(speed), kLeastSpeed);
  const double yaw = std::min(params.curvature_rate * v, params.yaw_jerk / v);
  const Decay decay(dt, params.yaw_acceleration_time);
  F.setIdentity();
  F(0, 3) = F(1, 4) = dt;
  F(2, 5) = decay.velocity;
  F(5, 5) = decay.acceleration;
  const Eigen::Matrix2d white = whiteJerk(dt);
  const Eigen::Matrix2d coloured = singer(dt, params.yaw_acceleration_time);
  const std::array<Eigen::Matrix2d, 3> noise = {params.longitudinal_jerk * params.longitudinal_jerk * white,
                                                params.lateral_jerk * params.lateral_jerk * white,
                                                yaw * yaw * coloured};
  Q.setZero();
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (assumed[static_cast<std::size_t>(i)]) continue;
    const Eigen::Matrix2d& q = noise[static_cast<std::size_t>(i)];
    Q(i, i) = q(0, 0);
    Q(i, i + 3) = Q(i + 3, i) = q(0, 1);
    Q(i + 3, i + 3) = q(1, 1);
  }
}

}  // namespace

void VelocityFilter::predict(double time) {
  const double dt = time - time_;
  if (!(dt > 0.0)) return;
  Eigen::Matrix<double, 6, 6> F;
  Eigen::Matrix<double, 6, 6> Q;
  motionModel(params_, assumed_, state_[0], dt, F, Q);
  const Eigen::Index mounts = state_.size() - kMotion;
  state_.head<kMotion>() = (F * state_.head<kMotion>()).eval();
  covariance_.topLeftCorner<kMotion, kMotion>() =
      (F * covariance_.topLeftCorner<kMotion, kMotion>() * F.transpose() + Q).eval();
  covariance_.topRightCorner(kMotion, mounts) = (F * covariance_.topRightCorner(kMotion, mounts)).eval();
  covariance_.bottomLeftCorner(mounts, kMotion) = covariance_.topRightCorner(kMotion, mounts).transpose();
  time_ = time;
}

VelocityFilter::State VelocityFilter::at(double time) const {
  Eigen::Matrix<double, 6, 6> F;
  Eigen::Matrix<double, 6, 6> Q;
  motionModel(params_, assumed_, state_[0], std::max(0.0, time - time_), F, Q);
  const Eigen::Matrix<double, 6, 1> x = F * state_.head<kMotion>();
  const Eigen::Matrix<double, 6, 6> P = F * covariance_.topLeftCorner<kMotion, kMotion>() * F.transpose() + Q;
  return {std::max(time, time_), x.head<3>(), x.tail<3>(), P.topLeftCorner<3, 3>()};
}

bool VelocityFilter::correct(const Measurement& m) {
  const Eigen::MatrixXd cross = covariance_ * m.jacobian.transpose();
  const Eigen::LDLT<Eigen::MatrixXd> spread = (m.jacobian * cross + m.noise).eval().ldlt();
  const double distance = m.innovation.dot(spread.solve(m.innovation));
  if (!(distance <= kGate[static_cast<std::size_t>(m.innovation.size() - 1)])) return false;
  Eigen::MatrixXd gain = spread.solve(cross.transpose()).transpose();
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (assumed_[static_cast<std::size_t>(i)]) gain.row(i).setZero();
  }
  state_ += gain * m.innovation;
  // Joseph form: right for any gain; stays symmetric and positive, also with free directions of variance 1e6.
  const Eigen::MatrixXd rest = Eigen::MatrixXd::Identity(state_.size(), state_.size()) - gain * m.jacobian;
  covariance_ = (rest * covariance_ * rest.transpose() + gain * m.noise * gain.transpose()).eval();
  return true;
}

/// The slip is a process with a correlation time, not new at every update: the noise of a single
/// pseudo-measurement is widened so that those of one correlation time together weigh about one.
void VelocityFilter::constrainSlip(double interval) {
  if (params_.lateral_slip_std <= 0.0 || !(interval > 0.0) || assumed_[1]) return;
  const double std = params_.lateral_slip_std * std::abs(state_[0]) + kSlipFloor;
  Measurement slip;
  slip.innovation = Eigen::VectorXd::Constant(1, -state_[1]);
  slip.jacobian = Eigen::MatrixXd::Zero(1, state_.size());
  slip.jacobian(0, 1) = 1.0;
  slip.noise =
      Eigen::MatrixXd::Constant(1, 1, std * std * std::max(1.0, 2.0 * params_.lateral_slip_time / interval));
  correct(slip);
}

VelocityFilter::Outcome VelocityFilter::conclude(double time, const Eigen::Vector3d& velocity,
                                                 const Eigen::Matrix3d& covariance, std::size_t used,
                                                 std::size_t refused) {
  predict(time);
  constrainSlip(time - last_update_);
  last_update_ = time;
  if (used >= refused && used > 0) {
    rejected_ = 0;
    return Outcome::kUpdated;
  }
  if (++rejected_ < params_.max_rejected) {
    // An emergency braking looks like an outlier at first; the next update may tell.
    covariance_(3, 3) += kManoeuvre * kManoeuvre;
    return Outcome::kRejected;
  }
  start(time, velocity, covariance);
  return Outcome::kStarted;
}

/// A scan that is older than the state sees the velocity that the state had then.
VelocityFilter::Measurement VelocityFilter::measurementOf(const SensorVelocity& sensor) const {
  const double lag = sensor.time - time_;
  const Eigen::Index mount = kMotion + static_cast<Eigen::Index>(sensor.radar);
  const double psi = state_[mount];
  const Eigen::Vector2d& t = sensor.lever_arm;
  Eigen::Matrix<double, 2, 3> rigid;  // v + w x t
  rigid << 1.0, 0.0, -t.y(), 0.0, 1.0, t.x();
  Eigen::Matrix2d rotation;  // by -psi
  rotation << 1.0, psi, -psi, 1.0;
  const Eigen::Vector2d at_radar = rigid * (state_.head<3>() + lag * state_.segment<3>(3));
  Measurement measured;
  measured.innovation = sensor.velocity - rotation * at_radar;
  measured.jacobian = Eigen::MatrixXd::Zero(2, state_.size());
  measured.jacobian.leftCols<3>() = rotation * rigid;
  measured.jacobian.middleCols<3>(3) = lag * rotation * rigid;
  measured.jacobian.col(mount) << at_radar.y(), -at_radar.x();
  measured.noise = sensor.covariance;
  return measured;
}

/// What the estimate says beside its assumptions. With S = P_ea / P_aa it has moved by S times the error of
/// an assumed axis, which is the filter's own error of that axis; the rest of its covariance is noise.
VelocityFilter::Measurement VelocityFilter::jointMeasurement(const Eigen::Vector3d& velocity,
                                                             Eigen::Matrix3d covariance) const {
  Measurement joint;
  joint.innovation = velocity - state_.head<3>();
  joint.jacobian = Eigen::MatrixXd::Identity(3, state_.size());
  for (Eigen::Index i = 0; i < 3; ++i) {
    if (!assumed_[static_cast<std::size_t>(i)]) continue;
    const Eigen::Vector3d moved = covariance.col(i) / covariance(i, i);
    joint.jacobian.col(i) -= moved;  // a row of zeros for the axis itself
    covariance -= (moved * covariance.row(i)).eval();
    covariance(i, i) = 1.0;
    joint.innovation[i] = 0.0;
  }
  joint.noise = covariance;
  return joint;
}

VelocityFilter::Outcome VelocityFilter::update(double time, const Eigen::Vector3d& velocity,
                                               const Eigen::Matrix3d& covariance,
                                               const std::vector<SensorVelocity>& sensors,
                                               const Sources& sources) {
  if (!acceptsTime(time) || !velocity.allFinite() || !covariance.allFinite()) return Outcome::kStale;
  const std::array<bool, 3> before = assumed_;
  for (std::size_t i = 0; i < 3; ++i) assumed_[i] = sources[i] == AxisSource::kAssumed;
  if (!started_ || time - last_update_ > params_.max_gap || assumed_ != before) {
    start(time, velocity, covariance);
    return Outcome::kStarted;
  }
  const auto widening = [this](double interval) {
    return std::max(1.0, 2.0 * params_.error_correlation_time / interval);
  };

  if (sensors.empty()) {
    predict(time);
    Measurement joint = jointMeasurement(velocity, covariance);
    joint.noise *= widening(time - last_update_);
    const bool used = correct(joint);
    return conclude(time, velocity, covariance, used ? 1 : 0, used ? 0 : 1);
  }

  std::vector<SensorVelocity> ordered = sensors;
  std::sort(ordered.begin(), ordered.end(),
            [](const SensorVelocity& a, const SensorVelocity& b) { return a.time < b.time; });
  std::size_t used = 0;
  std::size_t refused = 0;
  for (const SensorVelocity& sensor : ordered) {
    if (!std::isfinite(sensor.time) || sensor.time > time || sensor.time < time_ - kMaxLateness) continue;
    addMounts(sensor.radar + 1);
    double& last_scan = last_scan_[sensor.radar];
    if (!(sensor.time > last_scan)) continue;
    predict(sensor.time);
    Measurement measured = measurementOf(sensor);
    measured.noise *= widening(std::min(sensor.time - last_scan, params_.max_gap));
    if (correct(measured)) {
      ++used;
      last_scan = sensor.time;
    } else {
      ++refused;
    }
  }
  if (sources[2] == AxisSource::kGiven) {
    predict(time);
    Measurement turn;
    turn.innovation = Eigen::VectorXd::Constant(1, velocity.z() - state_[2]);
    turn.jacobian = Eigen::MatrixXd::Zero(1, state_.size());
    turn.jacobian(0, 2) = 1.0;
    turn.noise = covariance.bottomRightCorner<1, 1>();
    correct(turn);  // which tells nothing of whether the radars are believed
  }
  return conclude(time, velocity, covariance, used, refused);
}

VelocityFilter::Outcome VelocityFilter::update(double time, const EgoVelocityResult& result,
                                               const std::vector<SensorVelocity>& sensors) {
  if (!result.valid()) return Outcome::kStale;
  Eigen::Matrix3d covariance;
  Sources sources;
  for (Eigen::Index i = 0; i < 3; ++i) {
    sources[static_cast<std::size_t>(i)] = result.sources[static_cast<std::size_t>(kTwistAxes[i])];
    for (Eigen::Index j = 0; j < 3; ++j) covariance(i, j) = result.covariance(kTwistAxes[i], kTwistAxes[j]);
  }
  return update(time, {result.linear.x(), result.linear.y(), result.angular.z()}, covariance, sensors,
                sources);
}

EgoVelocityResult filteredResult(const VelocityFilter::State& state, const EgoVelocityResult& result) {
  EgoVelocityResult filtered;
  filtered.status = result.status;
  filtered.linear = {state.velocity.x(), state.velocity.y(), result.linear.z()};
  filtered.angular = {result.angular.x(), result.angular.y(), state.velocity.z()};
  filtered.covariance = result.covariance;
  filtered.observed = result.observed;
  filtered.sources = result.sources;
  filtered.fully_observed = true;
  for (const Eigen::Index axis : kTwistAxes) {
    filtered.covariance.row(axis).setZero();
    filtered.covariance.col(axis).setZero();
  }
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < 3; ++j)
      filtered.covariance(kTwistAxes[i], kTwistAxes[j]) = state.covariance(i, j);
    const auto axis = static_cast<std::size_t>(kTwistAxes[i]);
    const bool assumed = result.sources[axis] == AxisSource::kAssumed;
    filtered.observed[axis] = !assumed && state.covariance(i, i) < kUnobservedVariance;
    filtered.fully_observed = filtered.fully_observed && (assumed || filtered.observed[axis]);
  }
  filtered.condition_number = result.condition_number;
  filtered.rms = result.rms;
  filtered.return_count = result.return_count;
  filtered.inlier_count = result.inlier_count;
  filtered.dynamic_count = result.dynamic_count;
  return filtered;
}

}  // namespace radar_dot
