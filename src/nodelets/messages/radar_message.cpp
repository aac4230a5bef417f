// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/messages/radar_message.h"

#include <fmt/format.h>
#include <sensor_msgs/PointCloud.h>

#include <boost/make_shared.hpp>
#include <cstring>
#include <vector>

#include "nodelets/messages/cloud_conversion.h"
#include "nodelets/messages/radar_scan.h"

namespace radar_dot {
namespace {

namespace traits = ros::message_traits;

/// One row of points with these float32 fields, not yet filled.
boost::shared_ptr<sensor_msgs::PointCloud2> floatCloud(const std_msgs::Header& header,
                                                       const std::vector<std::string>& names,
                                                       std::size_t width) {
  auto cloud = boost::make_shared<sensor_msgs::PointCloud2>();
  cloud->header = header;
  cloud->height = 1;
  cloud->width = static_cast<std::uint32_t>(width);
  for (const std::string& name : names) {
    sensor_msgs::PointField& field = cloud->fields.emplace_back();
    field.name = name;
    field.offset = cloud->point_step;
    field.datatype = sensor_msgs::PointField::FLOAT32;
    field.count = 1;
    cloud->point_step += sizeof(float);
  }
  cloud->row_step = cloud->point_step * cloud->width;
  cloud->data.resize(std::size_t{cloud->point_step} * width);
  return cloud;
}

sensor_msgs::PointCloud2ConstPtr cloudOf(const sensor_msgs::PointCloud& points, std::string& defect) {
  std::vector<std::string> names = {"x", "y", "z"};
  for (const sensor_msgs::ChannelFloat32& channel : points.channels) {
    const std::string number = std::to_string(names.size() - 3);
    names.push_back(channel.name.empty() ? "channel" + number : channel.name);
    if (channel.values.size() != points.points.size()) {
      defect = fmt::format("channel {} '{}' has {} values for {} points", number, channel.name,
                           channel.values.size(), points.points.size());
      return nullptr;
    }
  }
  auto cloud = floatCloud(points.header, names, points.points.size());
  std::uint8_t* out = cloud->data.data();
  for (std::size_t i = 0; i < points.points.size(); ++i) {
    static_assert(sizeof(geometry_msgs::Point32) == 3 * sizeof(float));
    std::memcpy(out, &points.points[i], sizeof points.points[i]);
    out += sizeof points.points[i];
    for (const sensor_msgs::ChannelFloat32& channel : points.channels) {
      std::memcpy(out, &channel.values[i], sizeof(float));
      out += sizeof(float);
    }
  }
  return cloud;
}

sensor_msgs::PointCloud2ConstPtr cloudOf(const radar_msgs::RadarScan& scan, std::string& defect) {
  static_assert(sizeof(radar_msgs::RadarReturn) == 5 * sizeof(float));
  auto cloud = floatCloud(scan.header, {"range", "azimuth", "elevation", "doppler_velocity", "amplitude"},
                          scan.returns.size());
  if (!scan.returns.empty()) std::memcpy(cloud->data.data(), scan.returns.data(), cloud->data.size());
  // The message has radians, whatever angle_unit says of clouds.
  std::vector<std::string> faults;
  auto result = withPositions(cloud, AngleUnit::kRadians, faults);
  if (faults.empty()) return result;
  defect = "its azimuths are of more than a turn, must be radians";
  return nullptr;
}

template <typename Message>
bool isOf(const std::string& type) {
  return type == traits::datatype<Message>();
}

/// Empty: not taken.
std::string md5sumOf(const std::string& type) {
  return isOf<sensor_msgs::PointCloud2>(type)  ? traits::md5sum<sensor_msgs::PointCloud2>()
         : isOf<sensor_msgs::PointCloud>(type) ? traits::md5sum<sensor_msgs::PointCloud>()
         : isOf<radar_msgs::RadarScan>(type)   ? traits::md5sum<radar_msgs::RadarScan>()
                                               : "";
}

}  // namespace

bool RadarMessage::takes(const std::string& type) { return !md5sumOf(type).empty(); }

void RadarMessage::setType(const std::string& given, const std::string& md5sum) {
  type = given;
  const std::string expected = md5sumOf(type);
  if (expected.empty()) {
    defect = fmt::format(
        "{} is no message that is taken; {}, {} and {} are, and scripts/radar_lists_to_cloud converts "
        "lists of clusters and objects",
        type, traits::datatype<sensor_msgs::PointCloud2>(), traits::datatype<sensor_msgs::PointCloud>(),
        traits::datatype<radar_msgs::RadarScan>());
  } else if (md5sum != expected) {
    defect =
        fmt::format("this is another version of {}: its md5sum is {}, must be {}", type, md5sum, expected);
  }
}

void RadarMessage::read(std::uint8_t* data, std::uint32_t length) {
  if (!defect.empty()) return;
  ros::serialization::IStream stream(data, length);
  if (isOf<sensor_msgs::PointCloud2>(type)) {
    auto message = boost::make_shared<sensor_msgs::PointCloud2>();
    ros::serialization::deserialize(stream, *message);
    header = message->header;
    cloud = message;
  } else if (isOf<sensor_msgs::PointCloud>(type)) {
    sensor_msgs::PointCloud message;
    ros::serialization::deserialize(stream, message);
    header = message.header;
    cloud = cloudOf(message, defect);
  } else {
    radar_msgs::RadarScan message;
    ros::serialization::deserialize(stream, message);
    header = message.header;
    cloud = cloudOf(message, defect);
  }
}

}  // namespace radar_dot
