// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/doppler_unwrapping.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "radar_dot/radar/odometry.h"

namespace radar_dot {
namespace {

constexpr double kMaxSpeed = 60.0;            // m/s, of a search
constexpr double kMinStep = 1.0;              // m/s, of a search: bounds its time
constexpr int kRounds = 4;                    // of unwrapping and estimating
constexpr std::size_t kSearchReturns = 1000;  // of a sweep, about: so many tell the hypotheses apart

// Of -2 log likelihood: at this difference the odds are a million to one, which leaves room for errors that
// are not as the noise model says.
constexpr double kDecisive = 30.0;
constexpr double kOutlierShare = 0.3;  // beforehand, of returns whose range rate may be anything

// What is known beforehand of velocities that the returns leave free, 1 sigma of vx vy vz wx wy wz.
constexpr double kUsual[] = {30.0, 2.0, 1.0, 0.1, 0.1, 0.5};  // m/s, rad/s

bool isAmbiguous(const RadarScan& scan) {
  return std::isfinite(scan.unambiguous_velocity) && scan.unambiguous_velocity > 0.0;
}

StampedTwist twistOf(const EgoVelocityResult& result) { return {0.0, result.linear, result.angular}; }

/// The multiple of 2 V nearest to `range_rate`.
float wrapsIn(double range_rate, const RadarScan& scan) {
  const double interval = 2.0 * scan.unambiguous_velocity;
  return static_cast<float>(interval * std::round(range_rate / interval));
}

struct Hypothesis {
  EgoVelocityResult result;
  std::vector<std::vector<DopplerReturn>> returns;  // by scan; unwrapped where that is ambiguous
  double cost = 0.0;                                // -2 log likelihood of all returns
};

/// Every `stride`-th return of the scans.
struct ThinnedScans {
  ThinnedScans(const std::vector<RadarScan>& all, std::size_t stride) : returns(all.size()), scans(all) {
    for (std::size_t i = 0; i < all.size(); ++i) {
      scans[i].known_dynamic.clear();
      for (std::size_t k = 0; k < all[i].returns.size(); k += stride) {
        returns[i].push_back(all[i].returns[k]);
        scans[i].known_dynamic.push_back(all[i].knownDynamic(k) ? 1 : 0);
      }
      scans[i].returns = returns[i];
    }
  }
  std::vector<std::vector<DopplerReturn>> returns;
  std::vector<RadarScan> scans;
};

/// Looks for hypotheses of scans, whose returns it exchanges meanwhile.
class Search {
 public:
  Search(EgoVelocityEstimator& estimator, std::vector<RadarScan>& scans, double time,
         const Eigen::Vector3d& acceleration, const std::optional<AngularVelocity>& known)
      : estimator_(estimator), scans_(scans), time_(time), acceleration_(acceleration), known_(known) {
    for (const RadarScan& scan : scans) {
      measured_.push_back(scan.returns);
      Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
      if (isAmbiguous(scan)) {
        unambiguous_ = std::min(unambiguous_, scan.unambiguous_velocity);
        for (const DopplerReturn& seen : scan.returns) {
          const Eigen::Vector3d u = scan.T_base_from_sensor.linear() * seen.bearing.cast<double>();
          if (u.allFinite()) spread += u * u.transpose();
        }
        spread /= std::max(1.0, static_cast<double>(scan.returns.size()));
      }
      spreads_.push_back(spread);
    }
  }

  /// The smallest V, m/s.
  double unambiguous() const { return unambiguous_; }
  /// m/s: difference of the range rates that two velocities give static returns, rms over an ambiguous scan.
  double apart(const StampedTwist& a, const StampedTwist& b) const;
  /// m/s: the same between what was known so many seconds ago and what may be true now.
  double margin(const StampedTwist& known, double age) const;
  /// Adds the hypothesis that this velocity leads to, unless there is none.
  void attempt(const StampedTwist& start);
  /// Sorted, the likeliest first; the scans are again as they came.
  std::vector<Hypothesis> finish();
  /// What the estimator said of the first velocity that it refused.
  const std::optional<EgoVelocityResult>& refused() const { return refused_; }

 private:
  void unwrap(const StampedTwist& start, Hypothesis& hypothesis);
  bool unwrapAgain(Hypothesis& hypothesis) const;
  double cost(const EgoVelocityResult& result) const;

  EgoVelocityEstimator& estimator_;
  std::vector<RadarScan>& scans_;
  const double time_;
  const Eigen::Vector3d acceleration_;
  const std::optional<AngularVelocity> known_;
  std::vector<Span<const DopplerReturn>> measured_;
  std::vector<Eigen::Matrix3d> spreads_;  // mean of u u' over an ambiguous scan, else zero
  double unambiguous_ = std::numeric_limits<double>::infinity();
  std::vector<Hypothesis> hypotheses_;
  std::optional<EgoVelocityResult> refused_;
};

double Search::apart(const StampedTwist& a, const StampedTwist& b) const {
  double largest = 0.0;
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    const Eigen::Vector3d difference =
        a.linear - b.linear + (a.angular - b.angular).cross(scans_[i].T_base_from_sensor.translation());
    largest = std::max(largest, difference.dot(spreads_[i] * difference));
  }
  return std::sqrt(largest);
}

double Search::margin(const StampedTwist& known, double age) const {
  using Matrix = Eigen::Matrix<double, 6, 6>;
  const Matrix usual =
      Eigen::Map<const Eigen::Matrix<double, 6, 1>>(kUsual).array().square().matrix().asDiagonal();
  const Matrix covariance = usual * (known.covariance + usual).ldlt().solve(known.covariance);
  double largest = 0.0;
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    const Eigen::Vector3d& t = scans_[i].T_base_from_sensor.translation();
    Eigen::Matrix<double, 3, 6> at_radar = Eigen::Matrix<double, 3, 6>::Identity();
    at_radar.rightCols<3>() << 0.0, t.z(), -t.y(), -t.z(), 0.0, t.x(), t.y(), -t.x(), 0.0;
    largest = std::max(largest, (spreads_[i] * at_radar * covariance * at_radar.transpose()).trace());
  }
  const double margin = 3.0 * std::sqrt(largest) + AccelerationTracker::kMaxAcceleration * std::max(0.0, age);
  return std::min(2.0 * kMaxSpeed, margin);  // also where that is not a number
}

void Search::unwrap(const StampedTwist& start, Hypothesis& hypothesis) {
  hypothesis.returns.resize(scans_.size());
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    RadarScan& scan = scans_[i];
    if (!isAmbiguous(scan)) continue;
    const Eigen::Isometry3d& T = scan.T_base_from_sensor;
    const Eigen::Vector3f velocity =
        (T.linear().transpose() * (start.linear + start.angular.cross(T.translation()))).cast<float>();
    std::vector<DopplerReturn>& returns = hypothesis.returns[i];
    returns.assign(measured_[i].begin(), measured_[i].end());
    for (DopplerReturn& seen : returns)
      seen.doppler -= wrapsIn(static_cast<double>(seen.doppler + seen.bearing.dot(velocity)), scan);
    scan.returns = returns;
  }
}

/// The static returns among those of a wrong wrap have residuals near 2 V; whether a mover's lies a little
/// above V does not matter. @return whether anything has changed
bool Search::unwrapAgain(Hypothesis& hypothesis) const {
  bool changed = false;
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    std::vector<DopplerReturn>& returns = hypothesis.returns[i];
    for (std::size_t k = 0; k < returns.size(); ++k) {
      const double residual =
          static_cast<double>(hypothesis.result.residuals[hypothesis.result.offsets[i] + k]);
      if (!(std::abs(residual) > 1.5 * scans_[i].unambiguous_velocity)) continue;
      returns[k].doppler -= wrapsIn(residual, scans_[i]);
      changed = true;
    }
  }
  return changed;
}

double Search::cost(const EgoVelocityResult& result) const {
  const EgoVelocityParams& params = estimator_.params();
  const double variance =
      params.noise.doppler_std * params.noise.doppler_std + params.scan_std * params.scan_std;
  const double azimuth_variance = params.noise.azimuth_std * params.noise.azimuth_std;
  double sum = 0.0;
  for (std::size_t i = 0; i < scans_.size(); ++i) {
    const RadarScan& scan = scans_[i];
    const Eigen::Isometry3d& T = scan.T_base_from_sensor;
    const Eigen::Vector3f velocity =
        (T.linear().transpose() * (result.linear + result.angular.cross(T.translation()))).cast<float>();
    const double interval = 2.0 * (isAmbiguous(scan) ? scan.unambiguous_velocity : kMaxSpeed);
    for (std::size_t k = 0; k < scan.returns.size(); ++k) {
      if (scan.knownDynamic(k)) continue;
      const auto residual = static_cast<double>(result.residuals[result.offsets[i] + k]);
      const double along = static_cast<double>(scan.returns[k].bearing.dot(velocity));
      const double across = std::max(0.0, static_cast<double>(velocity.squaredNorm()) - along * along);
      const double total = variance + azimuth_variance * across;
      const double likelihood = (1.0 - kOutlierShare) / std::sqrt(2.0 * M_PI * total) *
                                    std::exp(-0.5 * residual * residual / total) +
                                kOutlierShare / interval;
      if (std::isfinite(likelihood)) sum -= 2.0 * std::log(likelihood);
    }
  }
  return sum;
}

void Search::attempt(const StampedTwist& start) {
  Hypothesis hypothesis;
  unwrap(start, hypothesis);
  for (int round = 0; round < kRounds; ++round) {
    estimator_.estimate(scans_, time_, acceleration_, hypothesis.result, known_);
    if (!hypothesis.result.valid()) {
      if (!refused_) refused_ = hypothesis.result;
      return;
    }
    if (unwrapAgain(hypothesis)) continue;
    hypothesis.cost = cost(hypothesis.result);
    for (Hypothesis& other : hypotheses_) {
      if (apart(twistOf(other.result), twistOf(hypothesis.result)) > 0.5 * unambiguous_) continue;
      if (hypothesis.cost < other.cost) other = std::move(hypothesis);
      return;
    }
    hypotheses_.push_back(std::move(hypothesis));
    return;
  }
}

std::vector<Hypothesis> Search::finish() {
  for (std::size_t i = 0; i < scans_.size(); ++i) scans_[i].returns = measured_[i];
  std::sort(hypotheses_.begin(), hypotheses_.end(),
            [](const Hypothesis& a, const Hypothesis& b) { return a.cost < b.cost; });
  return std::move(hypotheses_);
}

/// @param margin  m/s, that `centre` may be off
void explore(Search& search, const StampedTwist& centre, double margin) {
  const double v = search.unambiguous();
  const bool certain = margin <= 0.5 * v;
  // Even then the neighbours 2 V away may show that something went wrong before.
  const double step = certain ? 2.0 * v : std::max(v, kMinStep);
  const double reach = certain ? step : margin + 2.0 * v;
  search.attempt(centre);
  for (double offset = step; offset <= std::min(reach, 2.0 * kMaxSpeed); offset += step) {
    for (const double sign : {1.0, -1.0}) {
      StampedTwist start = centre;
      start.linear.x() += sign * offset;
      if (std::abs(start.linear.x()) <= kMaxSpeed) search.attempt(start);
    }
  }
}

EgoVelocityResult refused(const std::vector<RadarScan>& scans, const std::string& reason,
                          double unobserved_variance) {
  EgoVelocityResult result;
  result.status = EstimateStatus::kAmbiguous;
  result.reason = reason;
  result.clearVelocity(unobserved_variance);
  for (const RadarScan& scan : scans) result.return_count += scan.returns.size();
  return result;
}

struct Choice {
  std::size_t index = 0;
  std::string refusal, assumption;  // at most one
};

/// @param hypotheses  one or more, the likeliest first
Choice choose(const Search& search, const std::vector<Hypothesis>& hypotheses, double time,
              const std::optional<StampedTwist>& latest, double margin) {
  const double v = search.unambiguous();
  const auto speed = [&](std::size_t i) { return hypotheses[i].result.linear.x(); };
  std::vector<std::size_t> possible;
  for (std::size_t i = 0; i < hypotheses.size(); ++i) {
    if (latest && !(search.apart(twistOf(hypotheses[i].result), *latest) <= std::max(margin, 0.5 * v)))
      continue;
    if (possible.empty() || hypotheses[i].cost < hypotheses[possible[0]].cost + kDecisive)
      possible.push_back(i);
  }
  if (possible.empty() || hypotheses[possible[0]].cost > hypotheses[0].cost + kDecisive) {
    return {
        0,
        fmt::format("forward {:.1f} m/s explains the returns but cannot follow {:.1f} m/s {:.2f} s before; "
                    "is unambiguous_velocity {:.2f} m/s right?",
                    speed(0), latest->linear.x(), time - latest->time, v),
        ""};
  }
  if (possible.size() == 1) return {possible[0], "", ""};
  const std::string rivals = fmt::format("forward {:.1f} and {:.1f} m/s explain the returns equally well",
                                         speed(possible[0]), speed(possible[1]));
  if (!latest) {
    possible.erase(std::remove_if(possible.begin(), possible.end(),
                                  [&](std::size_t i) { return hypotheses[i].result.linear.norm() >= v; }),
                   possible.end());
    if (possible.size() == 1)
      return {possible[0], "",
              rivals + fmt::format(": {:.1f} m/s is taken, as a run starts below "
                                   "unambiguous_velocity ({:.2f} m/s)",
                                   speed(possible[0]), v)};
  }
  return {0,
          rivals + fmt::format(": {} below unambiguous_velocity ({:.2f} m/s), or add a radar with another "
                               "one or with wider bearings",
                               latest ? "restart the nodelet" : "start", v),
          ""};
}

}  // namespace

bool DopplerUnwrapping::needed(const std::vector<RadarScan>& scans) {
  return std::any_of(scans.begin(), scans.end(), isAmbiguous);
}

EgoVelocityResult DopplerUnwrapping::estimate(EgoVelocityEstimator& estimator, std::vector<RadarScan>& scans,
                                              double time, const Eigen::Vector3d& acceleration,
                                              const std::optional<StampedTwist>& latest,
                                              const std::optional<AngularVelocity>& known) {
  assumption_.clear();
  if (!needed(scans)) return estimator.estimate(scans, time, acceleration, known);

  const double unobserved_variance = estimator.params().unobserved_variance;
  std::size_t total = 0;
  for (const RadarScan& scan : scans) total += scan.returns.size();
  const std::size_t stride = 1 + total / kSearchReturns;
  ThinnedScans thinned(scans, stride);
  Search search(estimator, thinned.scans, time, acceleration, known);
  const double margin = latest ? search.margin(*latest, time - latest->time) : 2.0 * kMaxSpeed;
  StampedTwist velocity = latest.value_or(StampedTwist{});
  explore(search, velocity, margin);
  std::vector<Hypothesis> hypotheses = search.finish();
  Choice choice;
  if (!hypotheses.empty()) {
    choice = choose(search, hypotheses, time, latest, margin);
    if (!choice.refusal.empty()) return refused(scans, choice.refusal, unobserved_variance);
    std::swap(hypotheses.front(), hypotheses[choice.index]);
    velocity = twistOf(hypotheses.front().result);
  }
  if (stride > 1 || hypotheses.empty()) {
    Search all(estimator, scans, time, acceleration, known);
    all.attempt(velocity);
    hypotheses = all.finish();
    if (hypotheses.empty() && all.refused()) return *all.refused();
    if (hypotheses.empty() ||
        all.apart(twistOf(hypotheses.front().result), velocity) > 0.5 * all.unambiguous()) {
      return refused(scans, "the returns agree on no choice of wraps", unobserved_variance);
    }
  }
  Hypothesis& chosen = hypotheses.front();
  assumption_ = std::move(choice.assumption);
  returns_ = std::move(chosen.returns);
  for (std::size_t i = 0; i < scans.size(); ++i) {
    if (isAmbiguous(scans[i])) scans[i].returns = returns_[i];
  }
  return std::move(chosen.result);
}

}  // namespace radar_dot
