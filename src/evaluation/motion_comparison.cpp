// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/motion_comparison.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include "radar_dot/radar/odometry.h"

namespace radar_dot::evaluation {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
// Of vx, vy and the yaw rate, in a twist.
constexpr std::array<Eigen::Index, 3> kAxes = {0, 1, 5};

double component(const StampedTwist& twist, Eigen::Index axis) {
  return axis < 3 ? twist.linear[axis] : twist.angular[axis - 3];
}

/// The 95 % quantile (z = 1.645) or another of chi-square, by Wilson and Hilferty (1931): within 1 % for one
/// degree of freedom, and better for more.
double chiSquare(double degrees, double z) {
  const double variance = 2.0 / (9.0 * degrees);
  return degrees * std::pow(std::max(0.0, 1.0 - variance + z * std::sqrt(variance)), 3);
}

/// Correlation of neighbours, at least 0.
double neighbourCorrelation(const std::vector<double>& values) {
  double product = 0.0, square = 0.0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    square += values[i] * values[i];
    if (i > 0) product += values[i] * values[i - 1];
  }
  return square > 0.0 ? std::clamp(product / square, 0.0, 0.999) : 0.0;
}

template <typename Sample>
std::vector<double> timesOf(const std::vector<Sample>& samples) {
  std::vector<double> times;
  for (const Sample& sample : samples) times.push_back(sample.time);
  return times;
}

/// Sorts by time; what has the time of another is left out.
template <typename Sample>
void sortByTime(std::vector<Sample>& samples, StreamCounts& counts) {
  double latest = -std::numeric_limits<double>::infinity();
  for (const Sample& sample : samples) {
    if (sample.time < latest) ++counts.unordered;
    latest = std::max(latest, sample.time);
  }
  const auto isEarlier = [](const Sample& a, const Sample& b) { return a.time < b.time; };
  std::stable_sort(samples.begin(), samples.end(), isEarlier);
  const auto isSame = [](const Sample& a, const Sample& b) { return !(a.time < b.time); };
  const auto end = std::unique(samples.begin(), samples.end(), isSame);
  counts.repeated += static_cast<std::uint64_t>(samples.end() - end);
  samples.erase(end, samples.end());
}

/// The path of integrated twists from `start` on, over the times that the truth covers.
std::vector<StampedPose> integrated(const std::vector<StampedTwist>& twists, const PoseTrack* truth,
                                    bool with_heading) {
  VelocityIntegrator integrator;
  std::vector<StampedPose> path;
  for (const StampedTwist& twist : twists) {
    if (!twist.observes(0) || (truth != nullptr && !truth->covers(twist.time))) continue;
    std::optional<Eigen::Quaterniond> heading;
    if (truth != nullptr) {
      const Eigen::Isometry3d pose = truth->at(twist.time);
      if (path.empty()) integrator.reset(pose);
      if (with_heading) heading = Eigen::Quaterniond(pose.linear());
    }
    integrator.add(onWheels(twist), heading);
    path.emplace_back(twist.time, integrator.state().T_odom_from_base);
  }
  return path;
}

std::optional<PathErrors> pathErrors(const std::vector<StampedPose>& path, const PoseTrack& truth) {
  if (path.size() < 2) return std::nullopt;
  PathErrors result;
  result.start = compareTrajectory(path, truth);
  const auto size = static_cast<Eigen::Index>(path.size());
  Eigen::Matrix3Xd estimated(3, size), actual(3, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const StampedPose& pose = path[static_cast<std::size_t>(i)];
    estimated.col(i) = pose.position;
    actual.col(i) = truth.at(pose.time).translation();
  }
  const Eigen::Matrix4d T = Eigen::umeyama(estimated, actual, /*with_scaling=*/false);
  result.aligned_squared =
      ((T.topLeftCorner<3, 3>() * estimated).colwise() + T.topRightCorner<3, 1>() - actual).squaredNorm();
  return result;
}

/// Poses in a frame of their own, brought to the first true one.
std::vector<StampedPose> startingAtTruth(const std::vector<StampedPose>& poses, const PoseTrack& truth) {
  std::vector<StampedPose> path;
  Eigen::Isometry3d T_map_from_odom;
  for (const StampedPose& pose : poses) {
    if (!truth.covers(pose.time)) continue;
    if (path.empty()) T_map_from_odom = truth.at(pose.time) * pose.isometry().inverse();
    path.emplace_back(pose.time, T_map_from_odom * pose.isometry());
  }
  return path;
}

/// Linear between two twists, which are in the order of time; none outside, and in gaps.
std::optional<StampedTwist> interpolated(const std::vector<StampedTwist>& twists, double time,
                                         double max_gap) {
  const auto after = std::lower_bound(twists.begin(), twists.end(), time,
                                      [](const StampedTwist& twist, double t) { return twist.time < t; });
  if (after == twists.end()) return std::nullopt;
  if (after->time == time) return *after;
  if (after == twists.begin() || after->time - std::prev(after)->time > max_gap) return std::nullopt;
  const StampedTwist& before = *std::prev(after);
  const double share = (time - before.time) / (after->time - before.time);
  StampedTwist twist;
  twist.time = time;
  twist.linear = (1.0 - share) * before.linear + share * after->linear;
  twist.angular = (1.0 - share) * before.angular + share * after->angular;
  twist.covariance = before.covariance.cwiseMax(after->covariance);
  return twist;
}

/// What a vehicle knows at a time: the latest twist, and how it has changed just before.
std::optional<StampedTwist> latestBroughtTo(const std::vector<StampedTwist>& twists, double time,
                                            double max_gap) {
  constexpr double kChange = 0.2;  // s
  const auto after = std::upper_bound(twists.begin(), twists.end(), time,
                                      [](double t, const StampedTwist& twist) { return t < twist.time; });
  if (after == twists.begin() || time - std::prev(after)->time > max_gap) return std::nullopt;
  StampedTwist latest = *std::prev(after);
  if (const auto earlier = interpolated(twists, latest.time - kChange, max_gap)) {
    const double ratio = (time - latest.time) / (latest.time - earlier->time);
    latest.linear += ratio * (latest.linear - earlier->linear);
    latest.angular += ratio * (latest.angular - earlier->angular);
  }
  latest.time = time;
  return latest;
}

void addErrors(const StampedTwist& estimate, const StampedTwist& reference, MotionReport& report) {
  const std::array<ComponentErrors*, 3> components = {&report.vx, &report.vy, &report.yaw_rate};
  std::vector<Eigen::Index> known;
  Eigen::Vector3d errors = Eigen::Vector3d::Zero(), normalised = errors;
  for (std::size_t i = 0; i < kAxes.size(); ++i) {
    const Eigen::Index axis = kAxes[i];
    if (!estimate.observes(axis) || !reference.observes(axis)) continue;
    const auto entry = static_cast<Eigen::Index>(i);
    errors[entry] = component(estimate, axis) - component(reference, axis);
    components[i]->errors.push_back(errors[entry]);
    const double variance = estimate.covariance(axis, axis);
    if (!(variance > 0.0)) continue;
    normalised[entry] = errors[entry] / std::sqrt(variance);
    components[i]->normalised.push_back(normalised[entry]);
    known.push_back(entry);
  }
  if (known.empty()) return;
  const auto size = static_cast<Eigen::Index>(known.size());
  Eigen::VectorXd error(size);
  Eigen::MatrixXd covariance(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const auto axisOf = [&](Eigen::Index k) {
      return kAxes[static_cast<std::size_t>(known[static_cast<std::size_t>(k)])];
    };
    error[i] = errors[known[static_cast<std::size_t>(i)]];
    for (Eigen::Index k = 0; k < size; ++k) covariance(i, k) = estimate.covariance(axisOf(i), axisOf(k));
  }
  const double squared = error.dot(covariance.inverse() * error);
  if (!std::isfinite(squared) || squared < 0.0) return;  // the covariance is none
  const auto degrees = static_cast<double>(size);
  report.joint.nees.push_back(squared);
  report.joint.errors.push_back(normalised);
  report.joint.degrees_of_freedom += degrees;
  if (squared <= chiSquare(degrees, 1.6449)) ++report.joint.within_95;
}

/// How little an estimate, moved in time, agrees with a reference: one signal.
struct Residual {
  double squared = 0.0;  // less the mean
  double correlation = 0.0;
};

Residual residualOf(const std::vector<StampedTwist>& estimate, const ReferenceMotion& reference,
                    double offset, Eigen::Index axis) {
  std::vector<double> differences;
  double mean = 0.0;
  for (const StampedTwist& twist : estimate) {
    const std::optional<StampedTwist> other = reference.at(twist.time + offset);
    differences.push_back(component(twist, axis) - (other ? component(*other, axis) : 0.0));
    mean += differences.back() / static_cast<double>(estimate.size());
  }
  Residual residual;
  for (double& difference : differences) {
    difference -= mean;
    residual.squared += difference * difference;
  }
  residual.correlation = neighbourCorrelation(differences);
  return residual;
}

}  // namespace

void ComparisonOptions::describe(FieldList& fields) {
  fields.group("Comparison");
  fields.add("time_offset", time_offset, "Added to the stamps of the estimate", "s", {-1e4, 1e4});
  fields.add("align_time", align_time,
             "Add the offset that speed and yaw rate show, which is reported in any case");
  fields.add("max_time_offset", max_time_offset,
             "Largest offset that is sought, to either side of time_offset", "s", {0.02, 10.0});
  fields.add("reference_velocity", reference_velocity, "Velocity of a reference that has poses and twists");
  fields.add("interval", interval, "Over which poses and fixes are differentiated", "s", {0.001, 10.0});
  fields.add("max_gap", max_gap, "Longest time between two messages of the reference to interpolate across",
             "s", {0.001, 100.0});
}

void StreamCounts::describe(Figures& figures) {
  figures.sum("messages", messages);
  figures.figure("rate", rate);
  figures.figure("longest_gap", longest_gap);
  figures.sum("not_finite", not_finite);
  figures.sum("no_fix", no_fix);
  figures.sum("zero_stamps", zero_stamps);
  figures.sum("unordered", unordered);
  figures.sum("repeated", repeated);
}

void RecordedMotion::putInOrder() {
  StreamCounts other;
  sortByTime(twists, counts);
  sortByTime(poses, twists.empty() ? counts : other);
  const std::vector<double> times = twists.empty() ? timesOf(poses) : timesOf(twists);
  counts.rate = counts.longest_gap = kNaN;
  if (times.size() < 2) return;
  counts.rate = static_cast<double>(times.size() - 1) / (times.back() - times.front());
  counts.longest_gap = 0.0;
  for (std::size_t i = 1; i < times.size(); ++i)
    counts.longest_gap = std::max(counts.longest_gap, times[i] - times[i - 1]);
}

ReferenceMotion::ReferenceMotion(const RecordedMotion& motion, const ComparisonOptions& options)
    : twists_(motion.twists), half_interval_(0.5 * options.interval), max_gap_(options.max_gap) {
  const bool moves = std::any_of(twists_.begin(), twists_.end(), [](const StampedTwist& twist) {
    return !twist.linear.isZero(0.0) || !twist.angular.isZero(0.0);
  });
  using Velocity = ReferenceVelocity;
  const bool has_poses = motion.poses.size() > 1;
  is_from_poses_ = has_poses && options.reference_velocity != Velocity::kTwist &&
                   (!moves || options.reference_velocity == Velocity::kPose);
  if (!is_from_poses_ && (twists_.empty() || options.reference_velocity == Velocity::kPose))
    throw std::runtime_error(has_poses ? "the reference has no twists (reference_velocity)"
                                       : "the reference has no poses to differentiate");
  const std::vector<StampedPose> poses = has_poses ? motion.poses : integrated(twists_, nullptr, false);
  pose_times_ = timesOf(poses);
  if (poses.size() > 1) track_.emplace(poses);
}

std::optional<StampedTwist> ReferenceMotion::at(double time) const {
  return over(time - half_interval_, time + half_interval_);
}

std::optional<StampedTwist> ReferenceMotion::over(double begin, double end) const {
  const double time = 0.5 * (begin + end);
  if (is_from_poses_) {
    const auto first = std::upper_bound(pose_times_.begin(), pose_times_.end(), begin);
    const auto last = std::lower_bound(pose_times_.begin(), pose_times_.end(), end);
    if (first == pose_times_.begin() || last == pose_times_.end()) return std::nullopt;
    for (auto next = first; next <= last; ++next)
      if (*next - *std::prev(next) > max_gap_) return std::nullopt;
    StampedTwist twist;
    twist.time = time;
    twist.linear = track_->meanVelocity(begin, end);
    twist.angular.z() = track_->meanYawRate(begin, end);
    return twist;
  }
  return interpolated(twists_, time, max_gap_);
}

namespace {

/// How well an estimate fits a reference, by the offset that is added to its stamps.
struct OffsetFit {
  using Signal = std::pair<Eigen::Index, double>;  // axis, noise

  double cost(double offset) const {
    double cost = 0.0;
    for (const auto& [axis, noise] : signals)
      cost += 0.5 * count() *
              std::log(residualOf(twists, reference, offset, axis).squared / count() + noise * noise);
    return cost;
  }
  double best(double from, double to, double step) const {
    double best = from, least = std::numeric_limits<double>::infinity();
    for (double offset = from; offset <= to + 1e-9; offset += step) {
      const double there = cost(offset);
      if (there < least) least = there, best = offset;
    }
    return best;
  }
  bool tellsNothing(const Signal& signal, double offset) const {
    constexpr double kMinShare = 0.5;  // of the variance of a signal, explained
    double mean = 0.0, squared = 0.0;
    for (const StampedTwist& twist : twists) mean += component(twist, signal.first) / count();
    for (const StampedTwist& twist : twists) squared += std::pow(component(twist, signal.first) - mean, 2);
    return residualOf(twists, reference, offset, signal.first).squared > (1.0 - kMinShare) * squared ||
           squared < count() * signal.second * signal.second;
  }
  double count() const { return static_cast<double>(twists.size()); }

  const ReferenceMotion& reference;
  std::vector<StampedTwist> twists;  // within the reference whatever the offset: all are judged by the same
  std::vector<Signal> signals = {{0, 1e-3}, {5, 1e-4}};
};

}  // namespace

TimeOffset findTimeOffset(const std::vector<StampedTwist>& estimate, const ReferenceMotion& reference,
                          double max_offset) {
  constexpr double kCoarse = 0.02, kFine = 0.002;  // s
  constexpr double kMaxSigma = 0.02;               // s
  OffsetFit fit{reference, {}};
  for (const StampedTwist& twist : estimate)
    if (twist.observes(0) && reference.at(twist.time - max_offset) && reference.at(twist.time + max_offset))
      fit.twists.push_back(twist);
  TimeOffset result;
  const auto refuse = [&](const char* why) {
    result.why_not = why;
    return result;
  };
  if (fit.twists.size() < 20) return refuse("too little of the estimate lies within the reference");

  double best = 0.0;
  for (std::size_t kept = 0; kept != fit.signals.size();) {  // again without a signal that tells nothing
    kept = fit.signals.size();
    best = fit.best(-max_offset, max_offset, kCoarse);
    const auto tellsNothing = [&](const OffsetFit::Signal& signal) { return fit.tellsNothing(signal, best); };
    fit.signals.erase(std::remove_if(fit.signals.begin(), fit.signals.end(), tellsNothing),
                      fit.signals.end());
    if (fit.signals.empty()) return refuse("speed and yaw rate change too little, or do not agree");
  }
  if (std::abs(best) > max_offset - 1.5 * kCoarse) return refuse("it is larger than max_time_offset");
  best = fit.best(best - kCoarse, best + kCoarse, kFine);
  const double before = fit.cost(best - kFine), at = fit.cost(best), after = fit.cost(best + kFine);
  const double bend = before - 2.0 * at + after;
  result.offset = best + (bend > 0.0 ? 0.5 * kFine * (before - after) / bend : 0.0);
  double correlation = 0.0;
  for (const auto& signal : fit.signals)
    correlation = std::max(correlation, residualOf(fit.twists, reference, best, signal.first).correlation);
  const double curvature =
      (fit.cost(best - kCoarse) - 2.0 * at + fit.cost(best + kCoarse)) / (kCoarse * kCoarse);
  result.sigma = 1.0 / std::sqrt(curvature * (1.0 - correlation) / (1.0 + correlation));
  if (!(result.sigma < kMaxSigma)) {
    result.why_not = "speed and yaw rate change too little";
    result.offset = kNaN;
  }
  return result;
}

void ComponentErrors::describe(Figures& figures) {
  Mean squared, bias, nees;
  std::vector<double> sorted;
  for (const double error : errors) {
    squared.add(error * error);
    bias.add(error);
    sorted.push_back(std::abs(error));
  }
  for (const double one : normalised) nees.add(one * one);
  std::sort(sorted.begin(), sorted.end());
  const auto rank = static_cast<std::size_t>(std::ceil(0.95 * static_cast<double>(sorted.size())));
  figures.figure("mae", meanAbsolute(errors));
  figures.figure("rmse", std::sqrt(squared.value()));
  figures.figure("bias", bias.value());
  figures.figure("p95", sorted.empty() ? kNaN : sorted[rank - 1]);
  figures.figure("nees", nees.value());
  figures.count("count", errors.size());
}

double JointErrors::mean() const {
  double sum = 0.0;
  for (const double one : nees) sum += one;
  return degrees_of_freedom > 0.0 ? sum / degrees_of_freedom : kNaN;
}

double JointErrors::effectiveCount() const {
  double squared = 0.0;  // correlation of neighbouring errors, squared, of the mean component
  for (Eigen::Index i = 0; i < 3; ++i) {
    std::vector<double> values;
    for (const Eigen::Vector3d& error : errors) values.push_back(error[i]);
    squared += std::pow(neighbourCorrelation(values), 2) / 3.0;
  }
  return std::max(1.0, static_cast<double>(nees.size()) * (1.0 - squared) / (1.0 + squared));
}

double JointErrors::lower() const {
  const double degrees = ratio(degrees_of_freedom, nees.size()) * effectiveCount();
  return chiSquare(degrees, -1.96) / degrees;
}

double JointErrors::upper() const {
  const double degrees = ratio(degrees_of_freedom, nees.size()) * effectiveCount();
  return chiSquare(degrees, 1.96) / degrees;
}

void JointErrors::describe(Figures& figures) const {
  figures.figure("nees", mean());
  figures.figure("lower_limit", lower());
  figures.figure("upper_limit", upper());
  figures.figure("within_95", ratio(within_95, nees.size()));
  figures.figure("effective_count", nees.empty() ? 0.0 : effectiveCount());
  figures.count("count", nees.size());
}

void PathErrors::describe(Figures& figures) const {
  figures.figure("ate_rmse", start.rootMeanSquare());
  figures.figure("ate_rmse_aligned", std::sqrt(ratio(aligned_squared, start.count)));
  figures.figure("drift_percent", start.driftPercent());
  figures.figure("distance", start.distance);
}

MotionReport compareMotion(const RecordedMotion& estimate, const RecordedMotion& odometry,
                           const RecordedMotion& reference, const ComparisonOptions& options,
                           const std::vector<double>& keyframes) {
  const ReferenceMotion truth(reference, options);
  const auto shifted = [](auto samples, double offset) {
    for (auto& sample : samples) sample.time += offset;
    return samples;
  };
  MotionReport report;
  report.estimate = estimate.counts;
  report.reference = reference.counts;
  report.applied_offset = options.time_offset;
  std::vector<StampedTwist> twists = shifted(estimate.twists, options.time_offset);
  report.time_offset = findTimeOffset(twists, truth, options.max_time_offset);
  report.time_offset.offset += options.time_offset;
  if (options.align_time && report.time_offset.why_not.empty()) {
    report.applied_offset = report.time_offset.offset;
    twists = shifted(estimate.twists, report.applied_offset);
  }
  const auto compare = [&report](const StampedTwist& twist, const std::optional<StampedTwist>& actual) {
    ++(actual ? report.compared : report.outside);
    if (actual) addErrors(twist, *actual, report);
  };
  for (std::size_t i = 1; i < keyframes.size(); ++i) {
    const double begin = keyframes[i - 1], end = keyframes[i];
    if (const auto twist = latestBroughtTo(twists, 0.5 * (begin + end), options.max_gap))
      compare(*twist, truth.over(begin, end));
  }
  if (keyframes.empty())
    for (const StampedTwist& twist : twists) compare(twist, truth.at(twist.time));
  if (report.compared == 0)
    throw std::runtime_error("the estimate and the reference have no time in common (time_offset, max_gap)");
  if (const PoseTrack* track = truth.track()) {
    report.reference_heading = pathErrors(integrated(twists, track, true), *track);
    report.own_heading = pathErrors(integrated(twists, track, false), *track);
    report.odometry =
        pathErrors(startingAtTruth(shifted(odometry.poses, report.applied_offset), *track), *track);
  }
  return report;
}

}  // namespace radar_dot::evaluation
