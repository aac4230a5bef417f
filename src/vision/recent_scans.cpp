// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/recent_scans.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace radar_dot {
namespace {

// s of scans that are kept of each sensor: the images of a pair, and masks of them, come later.
constexpr double kKept = 4.0;
constexpr double kConfirmation = 0.3;     // s within which another scan shows what moves as well
constexpr std::size_t kMaxScans = 200;    // of each sensor
constexpr std::size_t kMaxSensors = 100;  // more are frame names that vary from message to message

// What is upright, m above the ground: not the road and what lies on it, nor ghosts and what hangs over it.
constexpr float kLowest = 0.5F;
constexpr float kHighest = 4.0F;
constexpr float kElevationStd = 0.02F;  // rad, of far returns, by which both limits give way
constexpr float kNear = 20.0F;          // m

/// A planar radar puts all returns into one plane of its own.
bool tellsHeights(const std::vector<CloudPoint>& points) {
  constexpr float kSpread = 0.05F;  // m
  return std::any_of(points.begin(), points.end(), [&points](const CloudPoint& point) {
    return std::fabs(point.position.z() - points.front().position.z()) > kSpread;
  });
}

/// Removes the returns that stand alone where others do not: a radar that gives dozens of a car gives one of
/// many ghosts.
void removeLonely(std::vector<CloudPoint>& points) {
  constexpr float kReach = 1.0F;      // m
  constexpr float kFarReach = 0.02F;  // rad, in addition
  constexpr float kAlike = 1.0F;      // m/s, of residuals
  constexpr std::size_t kDense = 8;   // neighbours of the densest, for each that all others need
  constexpr std::size_t kEnough = 3;
  const auto is_nowhere = [](const CloudPoint& point) { return !point.position.allFinite(); };
  points.erase(std::remove_if(points.begin(), points.end(), is_nowhere), points.end());
  std::sort(points.begin(), points.end(),
            [](const CloudPoint& a, const CloudPoint& b) { return a.position.x() < b.position.x(); });
  std::vector<std::size_t> counts(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const CloudPoint& here = points[i];
    const float reach = kReach + kFarReach * here.position.norm();
    for (std::size_t j = i + 1; j < points.size() && points[j].position.x() - here.position.x() < reach;
         ++j) {
      const bool is_near = (points[j].position - here.position).head<2>().squaredNorm() < reach * reach;
      if (!is_near || std::fabs(points[j].residual - here.residual) > kAlike) continue;
      ++counts[i];
      ++counts[j];
    }
  }
  if (points.empty()) return;
  const std::size_t needed = std::min(kEnough, *std::max_element(counts.begin(), counts.end()) / kDense);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (counts[i] >= needed) points[kept++] = points[i];
  points.resize(kept);
}

/// Or points of a lidar, which has neither Doppler nor ghosts.
bool areReturns(const std::vector<CloudPoint>& points) {
  return !points.empty() && !std::isnan(points.front().residual);
}

/// Another scan of a sensor.
struct Beside {
  float dt;  // s, after the scan
  Eigen::Isometry3f T_now_from_sensor;
  const std::vector<CloudPoint>* points;
};

/// Does another scan show what moves where it should be by then? What does not move needs none, nor the only
/// scan for long.
/// @param away  unit vector along the line of sight
bool isConfirmed(const CloudPoint& point, const Eigen::Vector3f& away, const std::vector<Beside>& others) {
  constexpr float kMoves = 0.5F;   // m/s
  constexpr float kAlike = 2.0F;   // m/s
  constexpr float kReach = 1.5F;   // m
  constexpr float kAcross = 5.0F;  // m/s that Doppler does not tell
  if (others.empty() || !(std::fabs(point.residual) > kMoves)) return true;
  return std::any_of(others.begin(), others.end(), [&](const Beside& other) {
    const Eigen::Vector3f expected = point.position + point.residual * other.dt * away;
    const float reach = kReach + kAcross * std::fabs(other.dt);
    return std::any_of(other.points->begin(), other.points->end(), [&](const CloudPoint& there) {
      return std::fabs(there.residual - point.residual) < kAlike &&
             (other.T_now_from_sensor * there.position - expected).head<2>().squaredNorm() < reach * reach;
    });
  });
}

bool isUpright(const Eigen::Vector3f& position, const GroundParams& ground) {
  const float height = position.z() - static_cast<float>(ground.height) -
                       std::tan(static_cast<float>(ground.pitch)) * position.x();
  const float margin = kElevationStd * std::max(0.0F, position.head<2>().norm() - kNear);
  return height > kLowest - margin && height < kHighest + margin;
}

}  // namespace

void RecentScans::add(const Sensor& sensor, double time, std::vector<CloudPoint> points) {
  if (scans_.size() > kMaxSensors) scans_.clear();
  std::deque<Scan>& scans = scans_[sensor];
  const bool tells_heights = tellsHeights(points);
  if (tells_heights && areReturns(points)) removeLonely(points);
  scans.push_back({time, std::move(points), tells_heights});
  while (scans.size() > kMaxScans || time - scans.front().time > kKept) scans.pop_front();
}

const RecentScans::Scan* RecentScans::nearest(const std::deque<Scan>& scans, double time, double max_age) {
  const Scan* nearest = nullptr;
  double least = max_age;
  for (const Scan& scan : scans) {
    const double age = std::abs(time - scan.time);
    if (age > least) continue;
    least = age;
    nearest = &scan;
  }
  return nearest;
}

std::vector<CloudPoint> RecentScans::at(double time, double max_age, const Mount& mount, const Motion& motion,
                                        const GroundParams* ground) const {
  std::vector<CloudPoint> points;
  for (const auto& [sensor, scans] : scans_) {
    const Scan* scan = nearest(scans, time, max_age);
    if (scan == nullptr) continue;
    const std::optional<Eigen::Isometry3d> T_base_from_sensor = mount(sensor);
    if (!T_base_from_sensor) continue;
    const auto poseAt = [&](double then) {
      const std::optional<Eigen::Isometry3d> T_now_from_then = motion(time, then);
      return (T_now_from_then ? *T_now_from_then * *T_base_from_sensor : *T_base_from_sensor).cast<float>();
    };
    const Eigen::Isometry3f T = poseAt(scan->time);
    // Of a planar radar that has one return all heights are the same, too: it is the sensor that tells.
    const bool with_heights = ground != nullptr && std::any_of(scans.begin(), scans.end(),
                                                               [](const Scan& s) { return s.tells_heights; });
    std::vector<Beside> others;
    for (const Scan& other : scans) {
      const double dt = other.time - scan->time;
      if (ground == nullptr || &other == scan || !(std::abs(dt) <= kConfirmation)) continue;
      others.push_back({static_cast<float>(dt), poseAt(other.time), &other.points});
    }
    for (const CloudPoint& point : scan->points) {
      const Eigen::Vector3f position = T * point.position;
      if (with_heights && !isUpright(position, *ground)) continue;
      const Eigen::Vector3f away = (position - T.translation()).normalized();
      if (isConfirmed({position, point.residual}, away, others)) points.push_back({position, point.residual});
    }
  }
  return points;
}

}  // namespace radar_dot
