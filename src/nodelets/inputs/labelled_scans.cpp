// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/labelled_scans.h"

#include <cmath>
#include <stdexcept>

namespace radar_dot {
namespace {

constexpr std::size_t kMaxWaiting = 100;  // scans; more come only where one of the topics is silent
constexpr float kFastest = 1e3F;          // m/s; what is beyond is no measurement
constexpr std::size_t kMaxRadars = 100;   // more are frame names that vary from message to message

std::vector<CloudPoint> pointsWithResidual(const sensor_msgs::PointCloud2& cloud) {
  std::vector<CloudPoint> finite;
  const std::vector<CloudPoint> points = pointsOf(cloud);
  for (const CloudPoint& point : points)
    if (std::abs(point.residual) < kFastest && point.position.norm() > 0.F) finite.push_back(point);
  if (finite.empty() && !points.empty())
    throw std::invalid_argument("it has no finite residual: is it a cloud of EgoVelocity?");
  return finite;
}

}  // namespace

std::size_t LabelledScans::numberOf(const std::string& frame) {
  if (numbers_.size() >= kMaxRadars && numbers_.count(frame) == 0) {
    numbers_.clear();
    taken_.clear();
  }
  return numbers_.try_emplace(frame, numbers_.size()).first->second;
}

void LabelledScans::add(const sensor_msgs::PointCloud2& cloud, ReturnLabel label, const Moment& now) {
  const std::string& frame = cloud.header.frame_id;
  std::vector<CloudPoint> points = pointsWithResidual(cloud);
  const auto taken = taken_.find(frame);
  if (taken != taken_.end() && cloud.header.stamp <= taken->second)
    throw std::invalid_argument("stamp not newer than that of a scan already used");
  const auto [entry, is_new] = waiting_.try_emplace({cloud.header.stamp, frame});
  LabelledScan& scan = entry->second;
  if (is_new) {
    scan.stamp = cloud.header.stamp;
    scan.frame = frame;
    scan.radar = numberOf(frame);
    scan.arrival = now;
  }
  auto& half = label == ReturnLabel::kDynamic ? scan.moving : scan.still;
  if (half) throw std::invalid_argument("its stamp is that of the cloud before");
  half = std::move(points);
}

std::vector<LabelledScan> LabelledScans::take(double timeout, const Moment& now) {
  std::vector<LabelledScan> ready;
  while (!waiting_.empty()) {
    LabelledScan& front = waiting_.begin()->second;
    const bool within_timeout = front.arrival.waits(timeout, now) && waiting_.size() <= kMaxWaiting;
    if (!front.complete() && within_timeout) break;
    ros::Time& latest = taken_[front.frame];
    if (front.stamp > latest) latest = front.stamp;
    ready.push_back(std::move(front));
    waiting_.erase(waiting_.begin());
  }
  return ready;
}

void LabelledScans::clear() {
  waiting_.clear();
  taken_.clear();
}

std::vector<ReturnOverGround> returnsOf(const LabelledScan& scan, const Eigen::Isometry3d& T_base_from_sensor,
                                        const StampedTwist& velocity, const OverGroundParams& params) {
  std::vector<DopplerReturn> returns;
  RadarScan radar_scan;
  const Eigen::Vector3d sensor_velocity =
      velocity.linear + velocity.angular.cross(T_base_from_sensor.translation());
  const Eigen::Vector3f in_sensor = (T_base_from_sensor.linear().transpose() * sensor_velocity).cast<float>();
  const auto add = [&](const std::optional<std::vector<CloudPoint>>& points, std::uint8_t known) {
    if (!points) return;
    for (const CloudPoint& point : *points) {
      DopplerReturn& one = returns.emplace_back();
      one.range = point.position.norm();
      one.bearing = point.position / one.range;
      // The Doppler velocity of which this residual is what the vehicle's motion leaves.
      one.doppler = point.residual - one.bearing.dot(in_sensor);
      one.index = static_cast<std::uint32_t>(returns.size() - 1);
      radar_scan.known_dynamic.push_back(known);
    }
  };
  add(scan.still, 0);
  add(scan.moving, 1);
  radar_scan.returns = returns;
  radar_scan.T_base_from_sensor = T_base_from_sensor;
  radar_scan.time = scan.stamp.toSec();
  radar_scan.radar = scan.radar;
  return returnsOverGround(radar_scan, velocity.linear, velocity.angular, params);
}

}  // namespace radar_dot
