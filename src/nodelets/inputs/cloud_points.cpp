// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/cloud_points.h"

#include <array>
#include <stdexcept>

#include "nodelets/messages/cloud_conversion.h"

namespace radar_dot {
namespace {

constexpr float kFarthest = 1e5F;  // m; what is beyond was not measured

/// The field `name` where it can be read; null where there is none.
/// @throws std::invalid_argument for a field of no known type, or that reaches beyond its point
const PointField* readableField(const std::vector<PointField>& fields, const PointCloudView& view,
                                const char* name) {
  const PointField* field = findField(fields, name);
  if (field == nullptr) return nullptr;
  if (const std::string defect = defectOf(*field, view.point_step); !defect.empty())
    throw std::invalid_argument(defect);
  return field;
}

float read(const std::uint8_t* data, const PointField& field) {
  return static_cast<float>(readScalar(data + field.offset, field.type));
}

std::vector<Eigen::Vector3f> positionsOf(const std::vector<PointField>& fields, const PointCloudView& view) {
  std::array<const PointField*, 3> axes{};
  constexpr std::array<const char*, 3> kNames = {"x", "y", "z"};
  for (std::size_t i = 0; i < axes.size(); ++i) {
    axes[i] = readableField(fields, view, kNames[i]);
    if (axes[i] == nullptr && view.size() > 0) {
      throw std::invalid_argument("its fields are " + fieldNames(fields) + "; x, y and z are needed");
    }
  }
  std::vector<Eigen::Vector3f> positions(view.size());
  for (std::size_t i = 0; i < view.size(); ++i) {
    const std::uint8_t* data = view.point(i);
    positions[i] = {read(data, *axes[0]), read(data, *axes[1]), read(data, *axes[2])};
  }
  return positions;
}

}  // namespace

std::vector<Eigen::Vector3f> positionsOf(const sensor_msgs::PointCloud2& cloud) {
  std::vector<PointField> fields;
  const PointCloudView view = viewOf(cloud, fields);
  return positionsOf(fields, view);
}

std::vector<CloudPoint> pointsOf(const sensor_msgs::PointCloud2& cloud) {
  std::vector<PointField> fields;
  const PointCloudView view = viewOf(cloud, fields);
  const std::vector<Eigen::Vector3f> positions = positionsOf(fields, view);
  // Where a cloud had a residual of its own before, ours has another name.
  const PointField* residual = readableField(fields, view, "ego_residual");
  if (residual == nullptr) residual = readableField(fields, view, "residual");
  std::vector<CloudPoint> points;
  points.reserve(view.size());
  for (std::size_t i = 0; i < view.size(); ++i) {
    CloudPoint point;
    point.position = positions[i];
    if (residual != nullptr) point.residual = read(view.point(i), *residual);
    if (point.position.cwiseAbs().maxCoeff() < kFarthest && point.position.allFinite())
      points.push_back(point);
  }
  return points;
}

void RecentClouds::add(const std::string& topic, const sensor_msgs::PointCloud2& cloud) {
  scans_.add({cloud.header.frame_id, topic}, cloud.header.stamp.toSec(), pointsOf(cloud));
}

std::vector<CloudPoint> RecentClouds::at(const ros::Time& time, double max_age, const GroundParams* ground) {
  const auto mount = [this](const RecentScans::Sensor& sensor) {
    std::string missing;
    std::optional<Eigen::Isometry3d> T_base_from_sensor = extrinsics_.lookup(sensor.first, missing);
    if (!T_base_from_sensor) warn_("the cloud on '" + sensor.second + "' is left out: " + missing);
    return T_base_from_sensor;
  };
  const auto motion = [this](double begin, double end) {
    return motion_.between(ros::Time(begin), ros::Time(end), kScanTwistHold, false).T_begin_from_end;
  };
  return scans_.at(time.toSec(), max_age, mount, motion, ground);
}

std::vector<Eigen::Vector3f> RecentClouds::positionsAt(const ros::Time& time, double max_age,
                                                       const GroundParams* ground) {
  std::vector<Eigen::Vector3f> positions;
  for (const CloudPoint& point : at(time, max_age, ground)) positions.push_back(point.position);
  return positions;
}

}  // namespace radar_dot
