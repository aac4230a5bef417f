// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/radar_agreement.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>

#include "radar_dot/common/quantile.h"
#include "rotated_return.h"

namespace radar_dot {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDegree = kPi / 180.0;

constexpr double kInterval = 0.29;    // s between sweeps that are looked at
constexpr double kMemory = 6.0;       // s of driving
constexpr double kLongestStep = 0.6;  // s of driving that one sweep stands for

constexpr double kMaxYawRate = 2.0;  // rad/s, no vehicle turns faster
constexpr double kStraight = 0.1;    // rad/s
constexpr double kMinSpeed = 2.0;    // m/s, below which a yaw hardly shows
constexpr double kMinReturns = 5.0;  // of a scan

// Residual at which a return counts half.
constexpr double kKernelWidth = 0.5;           // m/s
constexpr double kKernelWidthPerSpeed = 0.02;  // rad

constexpr double kFits =
    0.6;  // fraction of returns within the kernel, above which a yaw need not be searched
constexpr double kMinSearches = 3.0;
constexpr double kBetter = 1.2, kMuchBetter = 1.5;  // consensus over that of the mount as it is
constexpr double kMinConsensus = 0.4;               // fraction of the returns
constexpr double kGross = 20.0 * kDegree;           // larger yaws are none that a calibration would leave

constexpr double kTurned = 2.0 * kDegree, kTurnedStill = 1.5 * kDegree;
constexpr double kSigmas = 4.0;
constexpr double kLeastWidening = 0.5;       // variance over that of the noise model
constexpr double kMountStd = 0.5 * kDegree;  // of a mount without a fault
constexpr double kClearly = 1.2;  // ratio of the gains of the mount that is named and of the next one
constexpr double kSurely = 6.0;   // and their difference, chi-square
// s of driving. That two contradict each other may be the first that is seen of one that is turned.
constexpr double kNameAfter = 3.0, kNameBothAfter = 7.0;

// What is known of velocity and yaw rate apart from the returns.
constexpr double kPriorStd[] = {10.0, 10.0, 3.0};  // m/s, m/s, rad/s

// No car reverses like this.
constexpr double kBackwardsSpeed = 5.0, kForwardSpeed = 2.0;  // m/s
constexpr double kBackwardsTime = 8.0;                        // s

double angleOf(int cell, int cells) { return std::remainder(2.0 * kPi * cell / cells, 2.0 * kPi); }

}  // namespace

/// Normal equations of one sweep for the velocity x = [vx, vy, w] and the yaws p of all mounts.
struct RadarAgreement::Equations {
  explicit Equations(Eigen::Index radars)
      : xp(Eigen::Matrix3Xd::Zero(3, radars)),
        pp(Eigen::VectorXd::Zero(radars)),
        p(Eigen::VectorXd::Zero(radars)),
        yaw(Eigen::VectorXd::Zero(radars)) {}

  Eigen::Matrix3d xx = Eigen::Matrix3d::Zero();
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  Eigen::Matrix3Xd xp;
  Eigen::VectorXd pp, p;  // the yaws have no terms in common
  Eigen::VectorXd yaw;    // rad, linearised at
};

void RadarAgreement::configure(std::vector<Radar> radars) {
  const bool same = std::equal(
      radars.begin(), radars.end(), radars_.begin(), radars_.end(), [](const Radar& a, const Radar& b) {
        return a.name == b.name && a.mount_yaw_correction == b.mount_yaw_correction &&
               a.doppler_scale == b.doppler_scale;
      });
  if (same) return;
  radars_ = std::move(radars);
  reset();
}

void RadarAgreement::reset() {
  const auto count = static_cast<Eigen::Index>(radars_.size());
  tracks_.assign(radars_.size(), Track());
  information_ = Eigen::MatrixXd::Zero(count, count);
  vector_ = Eigen::VectorXd::Zero(count);
  time_ = looked_ = -std::numeric_limits<double>::infinity();
  backwards_for_ = 0.0;
  warning_.clear();
}

void RadarAgreement::add(double time, const std::vector<RadarScan>& scans, const EgoVelocityResult& result,
                         const EgoVelocityParams& params) {
  // Range rates whose wraps are not known would contradict everything.
  if (!std::isfinite(time) || result.status == EstimateStatus::kAmbiguous) return;
  if (time < time_) reset();
  watchDirection(time, result);
  time_ = time;
  if (time - looked_ < kInterval) return;
  const double dt = std::min(time - looked_, kLongestStep);
  looked_ = time;
  const bool two_halves = scans.size() == 2 && static_cast<double>(result.inlier_count) <
                                                   kFits * static_cast<double>(result.return_count);
  if (result.valid() && !two_halves && std::abs(result.angular.z()) < kMaxYawRate)
    return look(dt, scans, result, params);

  // Radars that contradict each other may leave too few for the model, or agree on a spin. Of two, the
  // estimate may follow now this one, now that.
  EgoVelocityParams planar = params;
  planar.model = MotionModel::kPlanar;
  std::vector<RadarScan> unturned = scans;
  for (RadarScan& scan : unturned) scan.bearing_rotation = 0.0;
  std::vector<RadarScan> reference = unturned;
  if (two_halves) {
    RadarScan& left_out = reference[reference[0].radar < reference[1].radar ? 1 : 0];
    left_out.known_dynamic.assign(left_out.returns.size(), 1);
  }
  const EgoVelocityResult without_rate = EgoVelocityEstimator(planar).estimate(reference, time);
  if (without_rate.valid()) look(dt, unturned, without_rate, planar);
}

void RadarAgreement::look(double dt, const std::vector<RadarScan>& scans, const EgoVelocityResult& result,
                          const EgoVelocityParams& params) {
  const double decay = std::exp(-dt / kMemory);
  const double speed = result.linear.head<2>().norm();
  const bool drives = speed > kMinSpeed && tracks_.size() > 1;
  Equations equations(static_cast<Eigen::Index>(tracks_.size()));
  for (std::size_t s = 0; s < scans.size(); ++s) {
    const RadarScan& scan = scans[s];
    if (scan.radar >= tracks_.size() || !scan.T_base_from_sensor.matrix().allFinite()) continue;
    Track& track = tracks_[scan.radar];
    fill(scan, result.residuals.data() + result.offsets[s], result);
    describe(track, scan.returns.size(), params.inlier_threshold, decay);
    if (!drives || static_cast<double>(rows_.count) < kMinReturns) continue;
    search(track, speed, decay);
    if (!isGross(track)) addTo(equations, scan, params, speed);
  }
  if (!drives) return;
  for (Eigen::Index i = 0; i < 3; ++i) equations.xx(i, i) += 1.0 / (kPriorStd[i] * kPriorStd[i]);
  if (params.model == MotionModel::kAckermann)
    equations.xx(1, 1) += 1.0 / (params.sideslip_std * params.sideslip_std);
  // Where the model has no yaw rate, nothing turns late bearings to where they belong (bearing_rotation).
  const double change = equations.xx.ldlt().solve(equations.x)[2];
  if (result.angular.z() == 0.0 && std::abs(change) > kStraight) return;
  learnYaws(equations, decay);
  judge(dt);
}

void RadarAgreement::watchDirection(double time, const EgoVelocityResult& result) {
  if (!result.valid() || !result.observed[0]) return;
  const double forward = result.linear.x();
  if (forward < -kBackwardsSpeed) {
    backwards_for_ += std::min(time - time_, kLongestStep);
  } else if (forward > kForwardSpeed) {
    backwards_for_ = 0.0;
    warning_.clear();
  }
  if (forward < -kBackwardsSpeed && backwards_for_ > kBackwardsTime) {
    warning_ = fmt::format(
        "drives backwards at {:.0f} m/s for {:.0f} s: if that is not so, all range rates have the opposite "
        "sign: set doppler_scale: {:g}",
        -forward, backwards_for_, radars_.empty() ? -1.0 : -radars_.front().doppler_scale);
  }
}

/// A part of the returns of a scan, not the same in every scan.
void RadarAgreement::fill(const RadarScan& scan, const float* residuals, const EgoVelocityResult& result) {
  const Eigen::Matrix3f R_base_from_sensor = scan.T_base_from_sensor.linear().cast<float>();
  const Eigen::Vector3f velocity =
      (result.linear + result.angular.cross(scan.T_base_from_sensor.translation())).cast<float>();
  const std::size_t stride = (scan.returns.size() + kReturns - 1) / kReturns;
  absolute_.clear();
  rows_.count = 0;
  for (std::size_t i = phase_++ % std::max<std::size_t>(1, stride); i < scan.returns.size(); i += stride) {
    const Eigen::Vector3f u =
        rotatedReturn(scan.returns[i], R_base_from_sensor, scan.bearing_rotation).bearing;
    if (scan.knownDynamic(i) || !u.allFinite() || !std::isfinite(residuals[i])) continue;
    const Eigen::Index row = rows_.count++;
    rows_.x[row] = u.x();
    rows_.y[row] = u.y();
    rows_.along[row] = u.x() * velocity.x() + u.y() * velocity.y();
    rows_.across[row] = u.x() * velocity.y() - u.y() * velocity.x();
    rows_.doppler[row] = residuals[i] - rows_.along[row];
    absolute_.push_back(std::abs(residuals[i]));
  }
}

void RadarAgreement::describe(Track& track, std::size_t returns, double inlier_threshold, double decay) {
  Figures& figures = track.figures;
  track.weight = decay * track.weight + 1.0;
  figures.returns += (static_cast<double>(returns) - figures.returns) / track.weight;
  if (absolute_.empty()) return;
  const auto inliers = std::count_if(absolute_.begin(), absolute_.end(), [&](float residual) {
    return static_cast<double>(residual) < inlier_threshold;
  });
  const double share = static_cast<double>(inliers) / static_cast<double>(absolute_.size());
  track.described = decay * track.described + 1.0;
  figures.inlier_share += (share - figures.inlier_share) / track.described;
  figures.median_residual +=
      (static_cast<double>(quantileOf(absolute_)) - figures.median_residual) / track.described;
}

/// How well the returns fit when the mount is turned, by cells of the full circle.
void RadarAgreement::search(Track& track, double speed, double decay) {
  const Eigen::Index n = rows_.count;
  const auto width = static_cast<float>(kKernelWidth + kKernelWidthPerSpeed * speed);
  const auto fits = ((rows_.doppler + rows_.along).head(n).abs() < width).count();
  // Returns across the direction of travel fit either way: what was found to be gross is searched on.
  if (!isGross(track) && static_cast<double>(fits) > kFits * static_cast<double>(n)) {
    track.searched = 0.0;
    track.consensus.setZero();
    return;
  }
  track.searched = decay * track.searched + 1.0;
  track.consensus *= static_cast<float>(decay);
  for (int cell = 0; cell < kCells; ++cell) {
    const double angle = angleOf(cell, kCells);
    const auto c = static_cast<float>(std::cos(angle) / static_cast<double>(width));
    const auto s = static_cast<float>(std::sin(angle) / static_cast<double>(width));
    const auto residuals = rows_.doppler / width + c * rows_.along + s * rows_.across;
    track.consensus[cell] += (1.F + residuals.head(n).square()).inverse().mean();
  }
  if (track.searched < kMinSearches) return;
  int best = 0, near = 0;
  for (int cell = 0; cell < kCells; ++cell) {
    if (track.consensus[cell] > track.consensus[best]) best = cell;
    if (std::abs(angleOf(cell, kCells)) < kGross && track.consensus[cell] > track.consensus[near])
      near = cell;
  }
  const auto consensus = [&](int cell) { return static_cast<double>(track.consensus[cell]); };
  if (consensus(best) > std::max(kMuchBetter * consensus(near), kMinConsensus * track.searched)) {
    track.cell = best;
  } else {
    track.cell = consensus(near) > kBetter * consensus(0) ? near : 0;
  }
}

bool RadarAgreement::isGross(const Track& track) { return std::abs(angleOf(track.cell, kCells)) >= kGross; }

void RadarAgreement::addTo(Equations& equations, const RadarScan& scan, const EgoVelocityParams& params,
                           double speed) const {
  const Eigen::Index n = rows_.count;
  const auto radar = static_cast<Eigen::Index>(scan.radar);
  const Eigen::Vector3f mount = scan.T_base_from_sensor.translation().cast<float>();
  const double angle = angleOf(tracks_[scan.radar].cell, kCells);
  const auto c = static_cast<float>(std::cos(angle)), s = static_cast<float>(std::sin(angle));
  const Eigen::ArrayXf residual = (rows_.doppler + c * rows_.along + s * rows_.across).head(n);
  Eigen::ArrayX4f columns(n, 4);  // vx, vy, w, yaw
  columns.col(0) = (c * rows_.x - s * rows_.y).head(n);
  columns.col(1) = (s * rows_.x + c * rows_.y).head(n);
  columns.col(2) = columns.col(1) * mount.x() - columns.col(0) * mount.y();
  columns.col(3) = (c * rows_.across - s * rows_.along).head(n);

  // An error common to the scan bounds what many returns tell.
  const double of_scan = params.noise.doppler_std * params.noise.doppler_std +
                         static_cast<double>(n) * params.scan_std * params.scan_std;
  const double width = kKernelWidth + kKernelWidthPerSpeed * speed;
  const auto azimuth = static_cast<float>(params.noise.azimuth_std);
  const Eigen::ArrayXf weight = ((static_cast<float>(of_scan) + (azimuth * columns.col(3)).square()) *
                                 (1.F + (residual / static_cast<float>(width)).square()))
                                    .inverse();
  const Eigen::ArrayX4f weighted = columns.colwise() * weight;
  const Eigen::Matrix4d normal = (weighted.matrix().transpose() * columns.matrix()).cast<double>();
  const Eigen::Vector4d right = -(weighted.matrix().transpose() * residual.matrix()).cast<double>();
  equations.xx += normal.topLeftCorner<3, 3>();
  equations.x += right.head<3>();
  equations.xp.col(radar) += normal.topRightCorner<3, 1>();
  equations.pp[radar] += normal(3, 3);
  equations.p[radar] += right[3];
  equations.yaw[radar] = angle;
}

void RadarAgreement::learnYaws(const Equations& equations, double decay) {
  const Eigen::Matrix3Xd eliminated = equations.xx.ldlt().solve(equations.xp);
  Eigen::MatrixXd information = -equations.xp.transpose() * eliminated;
  information.diagonal() += equations.pp;
  const Eigen::VectorXd vector =
      equations.p - eliminated.transpose() * equations.x + information * equations.yaw;
  if (!information.allFinite() || !vector.allFinite()) return;
  information_ = decay * information_ + information;
  vector_ = decay * vector_ + vector;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const double h = vector[static_cast<Eigen::Index>(i)];
    const double s = information(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(i));
    Track& track = tracks_[i];
    track.hh = decay * decay * track.hh + h * h;
    track.hs = decay * decay * track.hs + h * s;
    track.ss = decay * decay * track.ss + s * s;
  }
}

RadarAgreement::Yaw RadarAgreement::yawOf(std::size_t radar, const std::vector<std::size_t>& turned) const {
  const auto i = static_cast<Eigen::Index>(radar);
  double s = information_(i, i);
  double h = vector_[i];
  const double total = s;
  Yaw yaw;
  if (!(s > 0.0)) return yaw;
  // The sums over sweeps show how large the noise really is.
  const Track& track = tracks_[radar];
  const double alone = h / s;
  yaw.widening = std::max(kLeastWidening, (track.hh - 2.0 * alone * track.hs + alone * alone * track.ss) / s);

  // The others may be off as well: those that are turned by whatever it takes, the rest by a little.
  Eigen::MatrixXd others = information_;
  Eigen::VectorXd with = information_.col(i), right = vector_;
  for (Eigen::Index j = 0; j < others.rows(); ++j) {
    const bool is_turned =
        std::find(turned.begin(), turned.end(), static_cast<std::size_t>(j)) != turned.end();
    others(j, j) += is_turned ? 1e-6 : std::max(1.0, yaw.widening) / (kMountStd * kMountStd);
  }
  others.row(i).setZero();
  others.col(i).setZero();
  others(i, i) = 1.0;
  with[i] = right[i] = 0.0;
  const Eigen::VectorXd solved = others.ldlt().solve(with);
  s -= solved.dot(with);
  h -= solved.dot(right);
  if (!(s > 1e-6 * total)) return yaw;
  yaw.value = h / s;
  yaw.std = std::sqrt(yaw.widening / s);
  yaw.gain = h * h / s;
  return yaw;
}

void RadarAgreement::judge(double dt) {
  std::vector<Verdict> verdicts(tracks_.size(), Verdict::kGood);
  std::vector<std::size_t> gross, others;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    if (tracks_[i].described > 0.0) (isGross(tracks_[i]) ? gross : others).push_back(i);
  }
  for (const std::size_t i : gross) {
    Figures& figures = tracks_[i].figures;
    figures.yaw_correction = angleOf(tracks_[i].cell, kCells);
    figures.yaw_std = 2.0 * kPi / kCells;
    verdicts[i] = std::abs(figures.yaw_correction) > kPi - kGross ? Verdict::kReversed : Verdict::kTurned;
    if (gross.size() < others.size() || others.empty()) continue;
    verdicts[i] = verdicts[others.front()] = Verdict::kDisagrees;
    tracks_[i].other = others.front();
    tracks_[others.front()].other = i;
  }
  judgeYaws(others, verdicts);
  for (std::size_t i = 0; i < tracks_.size(); ++i) conclude(i, verdicts[i], dt);
}

/// The mounts that gain the most, one after the other, as long as they are a minority.
void RadarAgreement::judgeYaws(const std::vector<std::size_t>& radars, std::vector<Verdict>& verdicts) {
  std::vector<std::size_t> turned;
  const auto isTurned = [&](std::size_t i) { return verdicts[i] == Verdict::kTurned; };
  const auto note = [&](std::size_t i, const Yaw& yaw) {
    tracks_[i].figures.yaw_correction = yaw.value;
    tracks_[i].figures.yaw_std = yaw.std;
    const double angle = isTurned(i) ? yaw.value : 0.0;
    tracks_[i].cell = static_cast<int>(std::lround(angle / (2.0 * kPi) * kCells) + kCells) % kCells;
  };
  for (;;) {
    std::optional<std::size_t> best, second;
    Yaw yaw, next;
    for (const std::size_t i : radars) {
      if (isTurned(i)) continue;
      const Yaw candidate = yawOf(i, turned);
      note(i, candidate);
      if (!best || candidate.gain > yaw.gain) {
        second = best;
        next = yaw;
        best = i;
        yaw = candidate;
      } else if (!second || candidate.gain > next.gain) {
        second = i;
        next = candidate;
      }
    }
    if (!second) break;
    const double least = tracks_[*best].figures.verdict == Verdict::kGood ? kTurned : kTurnedStill;
    // By half a sigma more than the limit, so that what lies just below it is not named now and then.
    if (!(std::abs(yaw.value) > std::max(least + 0.5 * yaw.std, kSigmas * yaw.std))) break;
    const bool clear = yaw.gain > kClearly * next.gain && yaw.gain - next.gain > kSurely * yaw.widening &&
                       2 * (turned.size() + 1) < radars.size();
    verdicts[*best] = clear ? Verdict::kTurned : Verdict::kDisagrees;
    if (!clear) {
      verdicts[*second] = Verdict::kDisagrees;
      tracks_[*best].other = *second;
      tracks_[*second].other = *best;
      break;
    }
    turned.push_back(*best);
  }
  for (const std::size_t i : turned) {
    std::vector<std::size_t> others = turned;
    others.erase(std::find(others.begin(), others.end(), i));
    note(i, yawOf(i, others));
  }
}

/// A verdict stands when it has been the same for a while.
void RadarAgreement::conclude(std::size_t radar, Verdict verdict, double dt) {
  Track& track = tracks_[radar];
  track.pending_for = verdict == track.pending ? track.pending_for + dt : 0.0;
  track.pending = verdict;
  if (track.pending_for < (verdict == Verdict::kDisagrees ? kNameBothAfter : kNameAfter)) return;
  track.figures.verdict = verdict;
  track.figures.warning = textOf(radar);
}

std::string RadarAgreement::textOf(std::size_t radar) const {
  const Figures& figures = tracks_[radar].figures;
  const Radar& configured = radars_[radar];
  switch (figures.verdict) {
    case Verdict::kGood: break;
    case Verdict::kTurned:
      return fmt::format(
          "{}: its mount is turned by {:+.1f} +- {:.1f} degrees against the motion that the other radars "
          "see: correct its yaw in TF, or set mount_yaw_correction: {:.3f}",
          configured.name, -figures.yaw_correction / kDegree, figures.yaw_std / kDegree,
          std::remainder(configured.mount_yaw_correction + figures.yaw_correction, 2.0 * kPi));
    case Verdict::kReversed:
      return fmt::format(
          "{}: its range rates fit the motion that the other radars see with the opposite sign: set "
          "doppler_scale: {:g} (or its mount in TF is turned by half a turn)",
          configured.name, -configured.doppler_scale);
    case Verdict::kDisagrees: {
      const Track& other = tracks_[tracks_[radar].other];
      return fmt::format(
          "{} and {} contradict each other by {:.1f} degrees, and nothing tells which of them is wrong: "
          "check the yaw of both mounts and the sign of both doppler_scale",
          configured.name, radars_[tracks_[radar].other].name,
          std::max(std::abs(figures.yaw_correction), std::abs(other.figures.yaw_correction)) / kDegree);
    }
  }
  return {};
}

}  // namespace radar_dot
