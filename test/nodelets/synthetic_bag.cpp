// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "synthetic_bag.h"

#include <nav_msgs/Odometry.h>
#include <rosbag/bag.h>
#include <sensor_msgs/Imu.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cctype>
#include <cmath>
#include <random>
#include <stdexcept>

#include "fixtures/pcd_writer.h"
#include "fixtures/simulated_drive.h"

namespace radar_dot::test {
namespace {

constexpr double kStep = 1e-3;  // s, of the integration
constexpr std::size_t kIdField = 4, kInvalidStateField = 14;

/// Of the types that a radar of nuScenes has.
std::uint8_t datatypeOf(const PcdField& field) {
  using sensor_msgs::PointField;
  if (field.type == 'F') return PointField::FLOAT32;
  return field.size == 1 ? PointField::INT8 : PointField::INT16;
}

geometry_msgs::Quaternion yawQuaternion(double yaw) {
  geometry_msgs::Quaternion q;
  q.z = std::sin(0.5 * yaw);
  q.w = std::cos(0.5 * yaw);
  return q;
}

// A latched connection, so that who subscribes later gets the transforms as well.
boost::shared_ptr<ros::M_string> latched() {
  auto header = boost::make_shared<ros::M_string>();
  (*header)["latching"] = "1";
  (*header)["callerid"] = "/synthetic_bag";
  (*header)["md5sum"] = ros::message_traits::MD5Sum<tf2_msgs::TFMessage>::value();
  (*header)["type"] = ros::message_traits::DataType<tf2_msgs::TFMessage>::value();
  (*header)["message_definition"] = ros::message_traits::Definition<tf2_msgs::TFMessage>::value();
  return header;
}

void writeTruth(rosbag::Bag& bag, const TrueState& state, const ros::Time& stamp) {
  nav_msgs::Odometry odometry;
  odometry.header.stamp = stamp;
  odometry.header.frame_id = "map";
  odometry.child_frame_id = "base_link";
  odometry.pose.pose.position.x = state.x;
  odometry.pose.pose.position.y = state.y;
  odometry.pose.pose.orientation = yawQuaternion(state.yaw);
  odometry.twist.twist.linear.x = state.speed;
  odometry.twist.twist.angular.z = state.yaw_rate;
  bag.write("/ground_truth/odom", stamp, odometry);

  tf2_msgs::TFMessage tf;
  geometry_msgs::TransformStamped& transform = tf.transforms.emplace_back();
  transform.header = odometry.header;
  transform.child_frame_id = "base_link";
  transform.transform.translation.x = state.x;
  transform.transform.translation.y = state.y;
  transform.transform.rotation = odometry.pose.pose.orientation;
  bag.write("/tf", stamp, tf);
}

void writeImu(rosbag::Bag& bag, const TrueState& state, const ros::Time& stamp) {
  sensor_msgs::Imu imu;
  imu.header.stamp = stamp;
  imu.header.frame_id = "base_link";
  imu.orientation_covariance[0] = -1.0;
  imu.angular_velocity.z = state.yaw_rate;
  bag.write("/can/imu", stamp, imu);
}

}  // namespace

SyntheticDrive::SyntheticDrive(double duration) : duration_(duration) {
  TrueState state;
  state.x = 400.0;
  state.y = 1100.0;
  state.yaw = 0.7;
  for (double t = 0.0; t <= duration + 1.0; t += kStep) {
    state.speed = 8.0 + 2.0 * std::sin(0.5 * t);
    state.yaw_rate = 0.25 * std::sin(0.4 * t);
    states_.push_back(state);
    const double middle = state.yaw + 0.5 * state.yaw_rate * kStep;
    state.x += state.speed * std::cos(middle) * kStep;
    state.y += state.speed * std::sin(middle) * kStep;
    state.yaw += state.yaw_rate * kStep;
  }
}

TrueState SyntheticDrive::at(double seconds) const {
  const double index = std::clamp(seconds / kStep, 0.0, static_cast<double>(states_.size() - 1));
  return states_[static_cast<std::size_t>(std::lround(index))];
}

std::vector<SyntheticRadar> syntheticRadars() {
  std::vector<SyntheticRadar> radars;
  for (const Mount& mount : radarMounts()) {
    SyntheticRadar radar;
    radar.name = mount.channel;
    std::transform(radar.name.begin(), radar.name.end(), radar.name.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    radar.mount.header.frame_id = "base_link";
    radar.mount.child_frame_id = radar.name;
    radar.mount.transform.translation.x = mount.translation.x();
    radar.mount.transform.translation.y = mount.translation.y();
    radar.mount.transform.translation.z = mount.translation.z();
    radar.mount.transform.rotation.w = mount.rotation.w();
    radar.mount.transform.rotation.x = mount.rotation.x();
    radar.mount.transform.rotation.y = mount.rotation.y();
    radar.mount.transform.rotation.z = mount.rotation.z();
    radars.push_back(radar);
  }
  return radars;
}

sensor_msgs::PointCloud2 syntheticScan(const TrueState& state, std::size_t radar, const ros::Time& stamp,
                                       unsigned seed, int points) {
  Drive drive;
  drive.x = state.x;
  drive.y = state.y;
  drive.yaw = state.yaw;
  drive.speed = state.speed;
  drive.yaw_rate = state.yaw_rate;
  MovingBox far_away;
  far_away.position = {1e5, 1e5, 0.0};
  ScanOptions options;
  options.points = points;
  options.dynamic_fraction = 0.2;
  std::mt19937 random(seed);
  std::vector<std::vector<double>> records =
      simulateScan(drive, radarMounts().at(radar), far_away, drive.start_us, options, random);

  sensor_msgs::PointCloud2 cloud;
  cloud.header.stamp = stamp;
  cloud.header.frame_id = syntheticRadars().at(radar).name;
  const std::vector<PcdField> fields = nuscenesRadarFields();
  for (const PcdField& field : fields) {
    sensor_msgs::PointField& column = cloud.fields.emplace_back();
    column.name = field.name;
    column.offset = cloud.point_step;
    column.datatype = datatypeOf(field);
    column.count = 1;
    cloud.point_step += static_cast<std::uint32_t>(field.size);
  }
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(records.size());
  cloud.row_step = cloud.width * cloud.point_step;
  cloud.is_dense = 1;
  for (std::size_t i = 0; i < records.size(); ++i) {
    records[i].at(kIdField) = static_cast<double>(i);
    records[i].at(kInvalidStateField) = isRefused(static_cast<int>(i)) ? 4.0 : 0.0;
    const std::string bytes = formatRecord(fields, records[i]);
    cloud.data.insert(cloud.data.end(), bytes.begin(), bytes.end());
  }
  return cloud;
}

std::size_t offsetOf(const sensor_msgs::PointCloud2& cloud, const std::string& field) {
  for (const sensor_msgs::PointField& column : cloud.fields) {
    if (column.name == field) return column.offset;
  }
  throw std::out_of_range("no field " + field);
}

std::map<ScanKey, sensor_msgs::PointCloud2> writeSyntheticBag(const SyntheticDrive& drive,
                                                              const std::filesystem::path& file) {
  rosbag::Bag bag(file.string(), rosbag::bagmode::Write);
  const auto stampAt = [](double seconds) { return ros::Time(SyntheticDrive::kStart + seconds); };
  const std::vector<SyntheticRadar> radars = syntheticRadars();
  tf2_msgs::TFMessage mounts;
  for (const SyntheticRadar& radar : radars) {
    mounts.transforms.push_back(radar.mount);
    mounts.transforms.back().header.stamp = stampAt(0.0);
  }
  bag.write("/tf_static", stampAt(0.0), mounts, latched());

  for (double t = 0.0; t <= drive.duration(); t += 0.02) writeTruth(bag, drive.at(t), stampAt(t));
  for (double t = 0.0; t <= drive.duration(); t += 0.01) writeImu(bag, drive.at(t), stampAt(t));

  std::map<ScanKey, sensor_msgs::PointCloud2> scans;
  unsigned seed = 1;
  for (std::size_t radar = 0; radar < radars.size(); ++radar) {
    for (double t = 0.005 + 0.014 * static_cast<double>(radar); t < drive.duration(); t += 1.0 / 13.0) {
      const ros::Time stamp = stampAt(t);
      sensor_msgs::PointCloud2 scan = syntheticScan(drive.at(t), radar, stamp, seed++);
      bag.write("/" + radars[radar].name, stamp, scan);
      scans[{radars[radar].name, stamp}] = std::move(scan);
    }
  }
  return scans;
}

}  // namespace radar_dot::test
