// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/recent_scans.h"

#include <cmath>
#include <cstddef>

namespace radar_dot {
namespace {

// s of scans that are kept of each sensor: the images of a pair, and masks of them, come later.
constexpr double kKept = 4.0;
constexpr std::size_t kMaxScans = 200;    // of each sensor
constexpr std::size_t kMaxSensors = 100;  // more are frame names that vary from message to message

}  // namespace

void RecentScans::add(const Sensor& sensor, double time, std::vector<CloudPoint> points) {
  if (scans_.size() > kMaxSensors) scans_.clear();
  std::deque<Scan>& scans = scans_[sensor];
  scans.push_back({time, std::move(points)});
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

std::vector<CloudPoint> RecentScans::at(double time, double max_age, const Mount& mount,
                                        const Motion& motion) const {
  std::vector<CloudPoint> points;
  for (const auto& [sensor, scans] : scans_) {
    const Scan* scan = nearest(scans, time, max_age);
    if (scan == nullptr) continue;
    const std::optional<Eigen::Isometry3d> T_base_from_sensor = mount(sensor);
    if (!T_base_from_sensor) continue;
    const std::optional<Eigen::Isometry3d> T_now_from_scan = motion(time, scan->time);
    const Eigen::Isometry3f T =
        (T_now_from_scan ? *T_now_from_scan * *T_base_from_sensor : *T_base_from_sensor).cast<float>();
    for (const CloudPoint& point : scan->points) points.push_back({T * point.position, point.residual});
  }
  return points;
}

}  // namespace radar_dot
