// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/bag/messages.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>

namespace radar_dot::bag {
namespace {

constexpr std::int64_t kMicrosecondsPerSecond = 1'000'000;

geometry_msgs::Vector3 toVector3(const std::array<double, 3>& v) {
  geometry_msgs::Vector3 message;
  message.x = v[0];
  message.y = v[1];
  message.z = v[2];
  return message;
}

}  // namespace

ros::Time toTime(std::int64_t timestamp_us) {
  const std::int64_t seconds = timestamp_us / kMicrosecondsPerSecond;
  if (timestamp_us <= 0 || seconds > std::numeric_limits<std::uint32_t>::max()) {
    throw dataset::DatasetError(
        fmt::format("timestamp {}: not between 1970 and 2106; stamps are microseconds", timestamp_us));
  }
  return {static_cast<std::uint32_t>(seconds),
          static_cast<std::uint32_t>(timestamp_us % kMicrosecondsPerSecond) * 1000U};
}

std::string frameOf(std::string_view channel) {
  std::string frame(channel);
  std::transform(frame.begin(), frame.end(), frame.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return frame;
}

geometry_msgs::Pose toPose(const Eigen::Isometry3d& T) {
  Eigen::Quaterniond rotation(T.linear());
  if (rotation.w() < 0.0) rotation.coeffs() = -rotation.coeffs();
  geometry_msgs::Pose pose;
  pose.position.x = T.translation().x();
  pose.position.y = T.translation().y();
  pose.position.z = T.translation().z();
  pose.orientation.w = rotation.w();
  pose.orientation.x = rotation.x();
  pose.orientation.y = rotation.y();
  pose.orientation.z = rotation.z();
  return pose;
}

geometry_msgs::TransformStamped toTransform(const dataset::CalibratedSensor& sensor, const std::string& frame,
                                            const ros::Time& stamp) {
  const geometry_msgs::Pose pose = toPose(sensor.T_base_from_sensor);
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = stamp;
  transform.header.frame_id = kBaseFrame;
  transform.child_frame_id = frame;
  transform.transform.translation.x = pose.position.x;
  transform.transform.translation.y = pose.position.y;
  transform.transform.translation.z = pose.position.z;
  transform.transform.rotation = pose.orientation;
  return transform;
}

sensor_msgs::PointCloud2 toPointCloud2(PointCloud&& cloud, const std::string& frame, const ros::Time& stamp) {
  sensor_msgs::PointCloud2 message;
  message.header.stamp = stamp;
  message.header.frame_id = frame;
  message.fields.reserve(cloud.fields.size());
  for (const PointField& field : cloud.fields) {
    sensor_msgs::PointField& added = message.fields.emplace_back();
    added.name = field.name;
    added.offset = field.offset;
    added.datatype = static_cast<std::uint8_t>(field.type);
    added.count = field.count;
  }
  message.height = 1;
  message.width = static_cast<std::uint32_t>(cloud.size);
  message.point_step = static_cast<std::uint32_t>(cloud.point_step);
  message.row_step = message.width * message.point_step;
  message.is_bigendian = false;
  message.is_dense = false;
  message.data = std::move(cloud.data);
  return message;
}

sensor_msgs::CameraInfo toCameraInfo(const dataset::CalibratedSensor& sensor,
                                     const dataset::SampleData& reading, const std::string& frame,
                                     const ros::Time& stamp) {
  sensor_msgs::CameraInfo info;
  info.header.stamp = stamp;
  info.header.frame_id = frame;
  info.width = reading.width;
  info.height = reading.height;
  info.distortion_model = "plumb_bob";
  info.D.assign(5, 0.0);
  info.R = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  if (!sensor.camera_matrix) return info;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      const double value =
          (*sensor.camera_matrix)(static_cast<Eigen::Index>(row), static_cast<Eigen::Index>(column));
      info.K[3 * row + column] = value;
      info.P[4 * row + column] = value;
    }
  }
  return info;
}

sensor_msgs::Imu toImu(const dataset::CanImu& imu) {
  sensor_msgs::Imu message;
  message.header.stamp = toTime(imu.timestamp_us);
  message.header.frame_id = kBaseFrame;
  message.orientation.w = imu.orientation[0];
  message.orientation.x = imu.orientation[1];
  message.orientation.y = imu.orientation[2];
  message.orientation.z = imu.orientation[3];
  // The unit's heading counts from a reference of its own, neither the map's nor ENU: by the message's
  // convention, -1 tells filters not to use the orientation, while the measured values stay.
  message.orientation_covariance[0] = -1.0;
  message.angular_velocity = toVector3(imu.rotation_rate);
  message.linear_acceleration = toVector3(imu.linear_acceleration);
  return message;
}

geometry_msgs::TwistWithCovarianceStamped toWheelSpeed(const dataset::CanVehicleInfo& info) {
  geometry_msgs::TwistWithCovarianceStamped message;
  message.header.stamp = toTime(info.timestamp_us);
  message.header.frame_id = kBaseFrame;
  message.twist.twist.linear.x = dataset::rearAxleSpeed(info);
  message.twist.covariance[0] = kWheelSpeedStd * kWheelSpeedStd;
  for (std::size_t axis = 1; axis < 6; ++axis) message.twist.covariance[7 * axis] = kUnknownVariance;
  return message;
}

}  // namespace radar_dot::bag
