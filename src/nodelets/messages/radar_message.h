// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Header.h>

#include <cstdint>
#include <string>

namespace radar_dot {

/// What comes on the topic of a radar, to be subscribed like a message: sensor_msgs/PointCloud2,
/// sensor_msgs/PointCloud or radar_msgs/RadarScan. The publisher tells which.
struct RadarMessage {
  std_msgs::Header header;
  /// As it was sent; made of the points and channels of a PointCloud (float32, a channel without a name is
  /// called channel0 after its number), or of the returns of a RadarScan, with x, y and z behind its own
  /// fields.
  sensor_msgs::PointCloud2ConstPtr cloud;
  std::string type;    ///< as the publisher calls it
  std::string defect;  ///< why there is no cloud, and then mostly no header either; empty: there is

  /// Is a type, as the master knows it, one of those?
  static bool takes(const std::string& type);
  /// Of the connection; comes before read().
  void setType(const std::string& given, const std::string& md5sum);
  /// @throws ros::serialization::StreamOverrunException for data that end too early
  void read(std::uint8_t* data, std::uint32_t length);
};

using RadarMessageConstPtr = boost::shared_ptr<const RadarMessage>;

}  // namespace radar_dot

namespace ros {
namespace message_traits {

template <>
struct MD5Sum<radar_dot::RadarMessage> {
  static const char* value() { return "*"; }
};
template <>
struct DataType<radar_dot::RadarMessage> {
  static const char* value() { return "*"; }
};

}  // namespace message_traits

namespace serialization {

template <>
struct PreDeserialize<radar_dot::RadarMessage> {
  static void notify(const PreDeserializeParams<radar_dot::RadarMessage>& params) {
    params.message->setType((*params.connection_header)["type"], (*params.connection_header)["md5sum"]);
  }
};

template <>
struct Serializer<radar_dot::RadarMessage> {
  template <typename Stream>
  static void read(Stream& stream, radar_dot::RadarMessage& message) {
    const std::uint32_t length = stream.getLength();
    message.read(stream.advance(length), length);
  }
};

}  // namespace serialization
}  // namespace ros
