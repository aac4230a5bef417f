// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "calibration_problem.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "radar_dot/common/quantile.h"
#include "radar_dot/radar/ego_velocity.h"

namespace radar_dot {
namespace {

using Index = Eigen::Index;
using Quantity = CalibrationQuantity;

constexpr double kCauchyScale = 2.0;   // sigmas of a residual at which it has half its weight
constexpr double kStaticLimit = 4.0;   // sigmas beyond which a return moves, or is none
constexpr double kConsensus = 0.3;     // m/s, of a return with its scan
constexpr double kMargin = 0.3;        // s, before and after the scans
constexpr double kCluster = 1.0;       // s, over which errors go together
constexpr double kSlipTime = 2.0;      // s, the same of the slip
constexpr double kSlipFloor = 0.02;    // m/s
constexpr double kTellingSpeed = 1.0;  // m/s, below which a scan does not tell its sign
constexpr double kGauge = 1e8;         // information of a mean that is held

// 1 sigma of what is known beforehand, and the 1 sigma above which a value is of no use: by quantity, of the
// delay, and of the bias of a gyroscope.
constexpr std::array<double, 7> kPrior = {0.05, 0.2, 0.2, 0.02, 0.1, 0.1, 0.02};
constexpr std::array<double, 7> kLimit = {0.005, 0.05, 0.05, 0.005, 0.01, 0.02, 0.01};

// 1 sigma of the second differences of motion between knots, m/s^3 and rad/s^3: what bridges gaps.
const Eigen::Array3d kJerk(5.0, 2.0, 3.0);
// Below these the reference would take over what the radars see.
const Eigen::Array3d kReferenceFloor(0.01, 0.01, 0.001);

std::size_t kindOf(Index quantity, Index delay) {
  return quantity >= delay ? static_cast<std::size_t>(kCalibrationQuantities + (quantity - delay))
                           : static_cast<std::size_t>(quantity) % kCalibrationQuantities;
}

}  // namespace

double CalibrationProblem::limit(Index quantity, Index delay) { return kLimit[kindOf(quantity, delay)]; }
double CalibrationProblem::prior(Index quantity) const { return kPrior[kindOf(quantity, delay())]; }

CalibrationProblem::CalibrationProblem(const std::vector<CalibratedRadar>& radars,
                                       const std::vector<CalibrationDrive>& drives,
                                       const CalibrationParams& params, bool use_reference)
    : radars_(radars), params_(params), use_reference_(use_reference) {
  spread_.assign(radars_.size(), 1.0);
  votes_.resize(radars_.size());
  quantities = Eigen::VectorXd::Zero(bias() + 1);
  quantities[delay()] = params_.bearing_delay;
  free.assign(static_cast<std::size_t>(bias()) + 1, true);
  for (const CalibrationDrive& drive : drives) addDrive(drive);
  for (std::size_t radar = 0; radar < radars_.size(); ++radar)
    quantities[at(radar, Quantity::kDopplerScale)] = votes_[radar].second > votes_[radar].first ? -1.0 : 1.0;
  configured_ = quantities;
}

void CalibrationProblem::addDrive(const CalibrationDrive& drive) {
  double begin = std::numeric_limits<double>::infinity(), end = -begin;
  for (const CalibrationScan& scan : drive.scans) {
    begin = std::min(begin, scan.time);
    end = std::max(end, scan.time);
  }
  if (!(end > begin)) return;
  Drive added{DriveSpline(begin - kMargin, end + kMargin, params_.knot_interval), {}, {}};
  for (const ReferenceReading& reading : drive.reference) {
    if (reading.time < begin || reading.time > end) continue;
    added.reference.push_back(reading);
    for (std::size_t axis = 0; axis < 3; ++axis)
      has_reference_[axis] =
          has_reference_[axis] || std::isfinite(reading.velocity[static_cast<Index>(axis)]);
  }
  EgoVelocityParams each;
  each.model = MotionModel::kPlanar;
  each.noise = params_.noise;
  EgoVelocityEstimator estimator(each);
  scan_velocities_.assign(radars_.size(), {});
  for (const CalibrationScan& scan : drive.scans) addScan(scan, added, estimator);
  vote(drive);
  drives_.push_back(std::move(added));
}

void CalibrationProblem::addScan(const CalibrationScan& scan, Drive& drive, EgoVelocityEstimator& estimator) {
  RadarScan alone;
  alone.returns = scan.returns;
  const Eigen::Matrix3d R = radars_[scan.radar].T_base_from_sensor.linear();
  alone.T_base_from_sensor.linear() = R;
  const EgoVelocityResult own = estimator.estimate({alone}, 0.0);
  if (own.valid() && own.observed[0])
    scan_velocities_[scan.radar].emplace_back(scan.time, own.linear.head<2>());
  for (std::size_t i = 0; i < scan.returns.size(); ++i) {
    const DopplerReturn& seen = scan.returns[i];
    const Eigen::Vector3d bearing = R * seen.bearing.cast<double>();
    drive.seen.push_back({scan.radar, scan.time, bearing.head<2>(), static_cast<double>(seen.doppler),
                          R(2, 2) * static_cast<double>(seen.tangential_speed),
                          own.valid() && std::abs(own.residuals[i]) < kConsensus});
  }
}

/// A reversed sign reverses the velocity that a scan tells.
void CalibrationProblem::vote(const CalibrationDrive& drive) {
  std::vector<ReferenceReading> speeds;
  for (const ReferenceReading& reading : drive.reference)
    if (std::isfinite(reading.velocity[0])) speeds.push_back(reading);
  const auto earlier = [](const ReferenceReading& a, const ReferenceReading& b) { return a.time < b.time; };
  std::sort(speeds.begin(), speeds.end(), earlier);
  for (std::size_t radar = 0; radar < radars_.size(); ++radar) {
    for (const auto& [time, velocity] : scan_velocities_[radar]) {
      double speed = kTellingSpeed;  // vehicles drive forwards for most of the time
      if (!speeds.empty()) {
        ReferenceReading now;
        now.time = time;
        const auto after = std::lower_bound(speeds.begin(), speeds.end(), now, earlier);
        speed = (after == speeds.end() ? speeds.back() : *after).velocity[0];
      }
      if (std::abs(velocity.x()) < kTellingSpeed || std::abs(speed) < kTellingSpeed) continue;
      ++(velocity.x() * speed > 0.0 ? votes_[radar].first : votes_[radar].second);
    }
  }
}

CalibrationProblem::Row CalibrationProblem::rowOf(const Drive& drive, const Seen& seen) const {
  const Index base = at(seen.radar, Quantity::kYaw);
  const auto q = quantities.segment<5>(base);
  const double beta = quantities[delay()];
  Row row;
  row.source = seen.radar;
  row.first = base;
  row.last = delay();
  row.place = drive.spline.at(seen.time + q[4]);
  const Eigen::Vector3d motion = drive.spline.velocity(row.place);
  const double w = motion.z();
  const Eigen::Vector2d u = Eigen::Rotation2Dd(q[0] + beta * w) * seen.bearing;
  const Eigen::Vector2d p = radars_[seen.radar].T_base_from_sensor.translation().head<2>() + q.segment<2>(1);
  const Eigen::Vector2d v(motion.x() - w * p.y(), motion.y() + w * p.x());
  // The range rate stays as measured: its noise in a regressor would pull scale and speed towards zero.
  const double g = 1.0 / q[3];
  const double across = g * (u.x() * v.y() - u.y() * v.x());
  const double along = g * u.dot(v);
  const double turned = across + seen.tangential;
  row.residual = seen.doppler + beta * w * seen.tangential + along;
  row.motion << g * u.x(), g * u.y(), g * (u.y() * p.x() - u.x() * p.y()) + beta * turned;
  row.local << across, g * w * u.y(), -g * w * u.x(), -g * along,
      row.motion.dot(drive.spline.acceleration(row.place)), w * turned;
  row.variance =
      params_.noise.doppler_std * params_.noise.doppler_std + std::pow(params_.noise.azimuth_std * across, 2);
  const double scaled = std::abs(row.residual) / (std::sqrt(row.variance) * spread_[seen.radar]);
  row.variance *= spread_[seen.radar] * spread_[seen.radar];
  if (is_start_) {
    row.weight = seen.starts ? 1.0 / row.variance : 0.0;
  } else if (scaled < kStaticLimit * kCauchyScale) {
    row.weight = 1.0 / (row.variance * (1.0 + std::pow(scaled / kCauchyScale, 2)));
  }
  return row;
}

template <typename Body>
void CalibrationProblem::forEachRow(const Drive& drive, const Body& body) const {
  for (const Seen& seen : drive.seen) body(rowOf(drive, seen), seen.time);
}

template <typename Body>
void CalibrationProblem::forEachReference(const Drive& drive, const Body& body) const {
  if (!use_reference_) return;
  for (const ReferenceReading& reading : drive.reference) {
    for (Index axis = 0; axis < 3; ++axis) {
      if (!std::isfinite(reading.velocity[axis])) continue;
      Row row;
      row.source = radars_.size();
      row.place = drive.spline.at(reading.time);
      row.motion[axis] = 1.0;
      row.first = 0;
      row.last = bias();
      row.local[5] = axis == 2 && params_.rate_has_bias ? 1.0 : 0.0;
      row.residual =
          drive.spline.velocity(row.place)[axis] + row.local[5] * quantities[bias()] - reading.velocity[axis];
      row.variance = reference_std_[axis] * reference_std_[axis];
      const double scaled = row.residual / (kCauchyScale * reference_std_[axis]);
      row.weight = 1.0 / (row.variance * (is_start_ ? 1.0 : 1.0 + scaled * scaled));
      body(row, reading.time, axis);
    }
  }
}

/// Smoothness is added in equationsOf; this is the slip.
template <typename Body>
void CalibrationProblem::forEachAssumption(const Drive& drive, const Body& body) const {
  if (has_reference_[1] && use_reference_) return;
  for (Index piece = 0; piece < drive.spline.pieces(); ++piece) {
    Row row;
    row.source = radars_.size();
    row.place = drive.spline.at(drive.spline.knot(piece));
    const Eigen::Vector3d motion = drive.spline.velocity(row.place);
    row.motion[1] = 1.0;
    row.last = bias();
    row.residual = motion.y();
    const double std = params_.slip_std * std::abs(motion.x()) + kSlipFloor;
    row.weight = params_.knot_interval / (2.0 * kSlipTime * std * std);
    body(row);
  }
}

void CalibrationProblem::learnScales() {
  constexpr double kSigma = 1.4826;  // of a normal distribution, from the median
  std::vector<std::vector<double>> sizes(radars_.size());
  std::array<std::vector<double>, 3> differences;
  for (const Drive& drive : drives_) {
    forEachRow(drive, [&](const Row& row, double) {
      const double spread = spread_[row.source];
      const double size = std::abs(row.residual) * spread / std::sqrt(row.variance);
      if (row.weight > 0.0 && size < kStaticLimit * spread) sizes[row.source].push_back(size);
    });
    forEachReference(drive, [&](const Row& row, double, Index axis) {
      differences[static_cast<std::size_t>(axis)].push_back(std::abs(row.residual));
    });
  }
  for (std::size_t radar = 0; radar < radars_.size(); ++radar)
    if (!sizes[radar].empty()) spread_[radar] = std::clamp(kSigma * quantileOf(sizes[radar]), 0.05, 3.0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto i = static_cast<Index>(axis);
    if (!differences[axis].empty())
      reference_std_[i] = std::max(kReferenceFloor[i], kSigma * quantileOf(differences[axis]));
  }
}

void CalibrationProblem::add(const Row& row, Equations& equations) {
  if (!(row.weight > 0.0)) return;
  Eigen::Matrix<double, 12, 1> motion;
  for (Index i = 0; i < 4; ++i) motion.segment<3>(3 * i) = row.place.weights[i] * row.motion;
  const double pull = -row.weight * row.residual;
  const Index at = 3 * row.place.first;
  equations.pieces[static_cast<std::size_t>(row.place.first)].noalias() +=
      row.weight * motion * motion.transpose();
  equations.motion_right.segment<12>(at) += pull * motion;
  const auto five = row.local.head<5>();
  equations.mixed.block<12, 5>(at, row.first).noalias() += row.weight * motion * five.transpose();
  equations.mixed.block<12, 1>(at, row.last) += row.weight * row.local[5] * motion;
  equations.common.block<5, 5>(row.first, row.first).noalias() += row.weight * five * five.transpose();
  equations.common.block<5, 1>(row.first, row.last) += row.weight * row.local[5] * five;
  equations.common.block<1, 5>(row.last, row.first) += row.weight * row.local[5] * five.transpose();
  equations.common(row.last, row.last) += row.weight * row.local[5] * row.local[5];
  equations.common_right.segment<5>(row.first) += pull * five;
  equations.common_right[row.last] += pull * row.local[5];
}

CalibrationProblem::Equations CalibrationProblem::equationsOf(const Drive& drive) const {
  const Index size = drive.spline.coefficients().size();
  const Index count = quantities.size();
  Equations equations{Eigen::SparseMatrix<double>(size, size),
                      Eigen::MatrixXd::Zero(size, count),
                      Eigen::MatrixXd::Zero(count, count),
                      Eigen::VectorXd::Zero(size),
                      Eigen::VectorXd::Zero(count),
                      {}};
  equations.pieces.assign(static_cast<std::size_t>(drive.spline.pieces()),
                          Eigen::Matrix<double, 12, 12>::Zero());
  forEachRow(drive, [&](const Row& row, double) { add(row, equations); });
  forEachReference(drive, [&](const Row& row, double, Index) { add(row, equations); });
  forEachAssumption(drive, [&](const Row& row) { add(row, equations); });

  std::vector<Eigen::Triplet<double>> entries;
  for (Index piece = 0; piece < drive.spline.pieces(); ++piece) {
    const auto& block = equations.pieces[static_cast<std::size_t>(piece)];
    for (Index i = 0; i < 12; ++i)
      for (Index j = 0; j < 12; ++j) entries.emplace_back(3 * piece + i, 3 * piece + j, block(i, j));
  }
  const Eigen::Matrix3Xd& c = drive.spline.coefficients();
  const Eigen::Array3d smooth = 1.0 / (kJerk * std::pow(params_.knot_interval, 2)).square();
  constexpr std::array<double, 3> kSecond = {1.0, -2.0, 1.0};
  for (Index k = 0; k + 2 < c.cols(); ++k) {
    const Eigen::Vector3d bend = c.col(k) - 2.0 * c.col(k + 1) + c.col(k + 2);
    for (Index axis = 0; axis < 3; ++axis) {
      for (Index i = 0; i < 3; ++i) {
        const double a = kSecond[static_cast<std::size_t>(i)] * smooth[axis];
        equations.motion_right[3 * (k + i) + axis] -= a * bend[axis];
        for (Index j = 0; j < 3; ++j)
          entries.emplace_back(3 * (k + i) + axis, 3 * (k + j) + axis,
                               a * kSecond[static_cast<std::size_t>(j)]);
      }
    }
  }
  // Where nothing is seen for long, nothing is known.
  for (Index i = 0; i < size; ++i) entries.emplace_back(i, i, 1e-6);
  equations.motion.setFromTriplets(entries.begin(), entries.end());
  return equations;
}

void CalibrationProblem::addPriors(Eigen::MatrixXd& common, Eigen::VectorXd& right) const {
  for (Index i = 0; i < quantities.size(); ++i) {
    const double information = 1.0 / (prior(i) * prior(i));
    common(i, i) += information;
    right[i] -= information * (quantities[i] - configured_[i]);
  }
  const bool moves = use_reference_ && (has_reference_[0] || has_reference_[2]);
  for (const Quantity quantity : {Quantity::kDopplerScale, Quantity::kTimeOffset}) {
    if (quantity == Quantity::kDopplerScale ? use_reference_ && has_reference_[0] : moves) continue;
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(quantities.size());
    for (std::size_t radar = 0; radar < radars_.size(); ++radar)
      mean[at(radar, quantity)] =
          quantity == Quantity::kDopplerScale ? configured_[at(radar, quantity)] : 1.0;
    common += kGauge * mean * mean.transpose();
    right -= kGauge * mean * mean.dot(quantities - configured_);
  }
}

void CalibrationProblem::start() {
  is_start_ = true;
  const std::vector<bool> asked = std::exchange(free, std::vector<bool>(free.size(), false));
  step();
  free = asked;
  is_start_ = false;
}

double CalibrationProblem::step() {
  const Index count = quantities.size();
  Eigen::MatrixXd common = Eigen::MatrixXd::Zero(count, count);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
  struct Eliminated {
    Eigen::MatrixXd by_common;
    Eigen::VectorXd alone;
  };
  std::vector<Eliminated> eliminated;
  for (const Drive& drive : drives_) {
    const Equations equations = equationsOf(drive);
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(equations.motion);
    eliminated.push_back({solver.solve(equations.mixed), solver.solve(equations.motion_right)});
    common += equations.common - equations.mixed.transpose() * eliminated.back().by_common;
    right += equations.common_right - equations.mixed.transpose() * eliminated.back().alone;
  }
  addPriors(common, right);
  for (Index i = 0; i < count; ++i) {
    if (free[static_cast<std::size_t>(i)]) continue;
    common.row(i).setZero();
    common.col(i).setZero();
    common(i, i) = 1.0;
    right[i] = 0.0;
  }
  const Eigen::VectorXd change = common.ldlt().solve(right);
  for (std::size_t d = 0; d < drives_.size(); ++d) {
    const Eigen::VectorXd moved = eliminated[d].alone - eliminated[d].by_common * change;
    Eigen::Matrix3Xd& coefficients = drives_[d].spline.coefficients();
    coefficients += Eigen::Map<const Eigen::Matrix3Xd>(moved.data(), 3, coefficients.cols());
  }
  quantities += change;
  learnScales();
  double largest = 0.0;
  for (Index i = 0; i < count; ++i) largest = std::max(largest, std::abs(change[i]) / limit(i, delay()));
  return largest;
}

Eigen::MatrixXd CalibrationProblem::covariance() {
  const Index count = quantities.size();
  Eigen::MatrixXd common = Eigen::MatrixXd::Zero(count, count);
  Eigen::MatrixXd pulls = Eigen::MatrixXd::Zero(count, count);
  for (const Drive& drive : drives_) {
    const Equations equations = equationsOf(drive);
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(equations.motion);
    const Eigen::MatrixXd by_common = solver.solve(equations.mixed);
    common += equations.common - equations.mixed.transpose() * by_common;
    std::map<std::pair<std::size_t, std::int64_t>, Eigen::VectorXd> clusters;
    const auto pull = [&](const Row& row, double time) {
      if (!(row.weight > 0.0)) return;
      const auto key = std::make_pair(row.source, static_cast<std::int64_t>(std::floor(time / kCluster)));
      Eigen::VectorXd& sum = clusters.try_emplace(key, Eigen::VectorXd::Zero(count)).first->second;
      const double force = row.weight * row.residual;
      sum.segment<5>(row.first) += force * row.local.head<5>();
      sum[row.last] += force * row.local[5];
      for (Index i = 0; i < 4; ++i) {
        sum.noalias() -= force * row.place.weights[i] *
                         (by_common.middleRows<3>(3 * (row.place.first + i)).transpose() * row.motion);
      }
    };
    forEachRow(drive, pull);
    forEachReference(drive, [&](const Row& row, double time, Index) { pull(row, time); });
    for (const auto& [key, sum] : clusters) pulls += sum * sum.transpose();
  }
  Eigen::VectorXd unused = Eigen::VectorXd::Zero(count);
  const Eigen::MatrixXd data = common;
  addPriors(common, unused);
  pulls += common - data;  // what is known beforehand errs by its own sigma
  for (Index i = 0; i < count; ++i) {
    if (free[static_cast<std::size_t>(i)]) continue;
    common.row(i).setZero();
    common.col(i).setZero();
    common(i, i) = 1.0;
    pulls.row(i).setZero();
    pulls.col(i).setZero();
  }
  const Eigen::MatrixXd inverse = common.ldlt().solve(Eigen::MatrixXd::Identity(count, count));
  Eigen::MatrixXd covariance = inverse * pulls * inverse;
  covariance.diagonal() = covariance.diagonal().cwiseMax(inverse.diagonal());
  return covariance;
}

std::vector<std::pair<double, std::size_t>> CalibrationProblem::residuals() {
  std::vector<std::pair<double, std::size_t>> sums(radars_.size());
  for (const Drive& drive : drives_) {
    forEachRow(drive, [&sums](const Row& row, double) {
      // Not by their spread, which a bad calibration widens.
      if (!(std::abs(row.residual) < 2.0 * kConsensus)) return;
      sums[row.source].first += row.residual * row.residual;
      ++sums[row.source].second;
    });
  }
  return sums;
}

Eigen::Array3d CalibrationProblem::differences() const {
  Eigen::Array3d sums = Eigen::Array3d::Zero(), counts = sums;
  for (const Drive& drive : drives_) {
    for (const ReferenceReading& reading : drive.reference) {
      const Eigen::Array3d difference =
          (drive.spline.velocity(drive.spline.at(reading.time)).array() - reading.velocity).abs();
      for (Index axis = 0; axis < 3; ++axis) {
        if (!std::isfinite(difference[axis])) continue;
        sums[axis] += difference[axis];
        counts[axis] += 1.0;
      }
    }
  }
  return sums / counts;
}

Eigen::Array3d CalibrationProblem::excitation() const {
  Eigen::Array3d sums = Eigen::Array3d::Zero();
  double count = 0.0;
  for (const Drive& drive : drives_) {
    for (Index piece = 2; piece + 2 < drive.spline.pieces(); ++piece) {
      const DriveSpline::Place place = drive.spline.at(drive.spline.knot(piece));
      const Eigen::Vector3d rate = drive.spline.acceleration(place);
      sums += Eigen::Array3d(drive.spline.velocity(place).z(), rate.x(), rate.z()).square();
      count += 1.0;
    }
  }
  return (sums / std::max(1.0, count)).sqrt();
}

}  // namespace radar_dot
