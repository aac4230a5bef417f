// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "radar_dot/vision/ground_plane.h"

namespace radar_dot {

/// A point of a cloud.
struct CloudPoint {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();  ///< m
  /// m/s, Doppler residual of a radar return against the vehicle's motion; NaN where it is not known.
  float residual = std::numeric_limits<float>::quiet_NaN();
};

/// s that the latest twist is taken to hold for the motion since a scan.
inline constexpr double kScanTwistHold = 0.3;

/// The latest scans of any number of sensors, as points around the vehicle at another time.
class RecentScans {
 public:
  using Sensor = std::pair<std::string, std::string>;  ///< frame and topic
  /// T_base_from_sensor; none: the scan is left out
  using Mount = std::function<std::optional<Eigen::Isometry3d>(const Sensor& sensor)>;
  /// T_begin_from_end: pose of the base at `end` (s), in its frame at `begin`
  using Motion = std::function<std::optional<Eigen::Isometry3d>(double begin, double end)>;

  /// Of radars that tell heights and give many returns of one thing, those that stand alone are ghosts, and
  /// are left out.
  /// @param time  s   @param points  sensor frame
  void add(const Sensor& sensor, double time, std::vector<CloudPoint> points);
  void clear() { scans_.clear(); }

  /// Base frame at `time`, of the scan of each sensor that is nearest to it, within `max_age` s. Points are
  /// where they were seen, as parts of a static world; where the motion since is not known, it is none.
  /// @param ground  where given, only what stands for a thing is left: of sensors that tell heights nothing
  ///                that is on the ground or overhead, and of what moves only what another scan of its sensor
  ///                shows as well, where there is one within 0.3 s
  std::vector<CloudPoint> at(double time, double max_age, const Mount& mount, const Motion& motion,
                             const GroundParams* ground = nullptr) const;

 private:
  struct Scan {
    double time = 0.0;
    std::vector<CloudPoint> points;
    bool tells_heights = false;
  };
  static const Scan* nearest(const std::deque<Scan>& scans, double time, double max_age);

  std::map<Sensor, std::deque<Scan>> scans_;
};

}  // namespace radar_dot
