// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/Pose.h>
#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <ros/time.h>
#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/PointCloud2.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <string_view>

#include "radar_dot/dataset/can_bus.h"
#include "radar_dot/dataset/tables.h"
#include "radar_dot/radar/point_cloud.h"

namespace radar_dot::bag {

inline constexpr char kMapFrame[] = "map";
inline constexpr char kBaseFrame[] = "base_link";

/// The stamp, exact to the microsecond. @throws dataset::DatasetError outside the range of ros::Time.
ros::Time toTime(std::int64_t timestamp_us);

/// Frame of a channel's readings: "RADAR_FRONT" -> "radar_front".
std::string frameOf(std::string_view channel);

/// Position in m and rotation as a message; the quaternion has w >= 0.
geometry_msgs::Pose toPose(const Eigen::Isometry3d& T);

/// base_link -> `frame`.
geometry_msgs::TransformStamped toTransform(const dataset::CalibratedSensor& sensor, const std::string& frame,
                                            const ros::Time& stamp);

/// Every field with its name, offset, type and count; one row; is_dense false, since clouds of a
/// dataset may hold NaN. Takes the cloud's bytes.
sensor_msgs::PointCloud2 toPointCloud2(PointCloud&& cloud, const std::string& frame, const ros::Time& stamp);

/// Intrinsics of a rectified picture. Without a camera matrix K is zero, which says "uncalibrated".
sensor_msgs::CameraInfo toCameraInfo(const dataset::CalibratedSensor& sensor,
                                     const dataset::SampleData& reading, const std::string& frame,
                                     const ros::Time& stamp);

/// In base_link; covariances zero, which says "unknown".
sensor_msgs::Imu toImu(const dataset::CanImu& imu);

/// Speed of the rear axle along x of base_link; the other components are zero with kUnknownVariance.
geometry_msgs::TwistWithCovarianceStamped toWheelSpeed(const dataset::CanVehicleInfo& info);

inline constexpr double kWheelSpeedStd = 0.1;    ///< m/s, 1 sigma
inline constexpr double kUnknownVariance = 1e6;  ///< (m/s)^2 or (rad/s)^2

}  // namespace radar_dot::bag
