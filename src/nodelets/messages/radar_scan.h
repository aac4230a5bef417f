// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <std_msgs/Header.h>

#include <vector>

#include "nodelets/messages/message_text.h"

// The message radar_msgs/RadarScan, for builds without the package radar_msgs.

namespace radar_dot::radar_msgs {

struct RadarReturn {
  float range = 0.F;             ///< m
  float azimuth = 0.F;           ///< rad, anticlockwise
  float elevation = 0.F;         ///< rad, above the x-y plane
  float doppler_velocity = 0.F;  ///< m/s, positive when the range grows
  float amplitude = 0.F;         ///< dB
};

struct RadarScan {
  std_msgs::Header header;
  std::vector<RadarReturn> returns;

  static const char* md5() { return "6dfacef1e665538dbd8e159d5ce7a97a"; }
  static const char* dataType() { return "radar_msgs/RadarScan"; }
  static const char* definition() {
    return "std_msgs/Header header\n"
           "radar_msgs/RadarReturn[] returns\n"
           "================================================================================\n"
           "MSG: std_msgs/Header\n"
           "uint32 seq\n"
           "time stamp\n"
           "string frame_id\n"
           "================================================================================\n"
           "MSG: radar_msgs/RadarReturn\n"
           "float32 range\n"
           "float32 azimuth\n"
           "float32 elevation\n"
           "float32 doppler_velocity\n"
           "float32 amplitude\n";
  }
};

}  // namespace radar_dot::radar_msgs

namespace ros {
namespace message_traits {

template <>
struct IsFixedSize<radar_dot::radar_msgs::RadarReturn> : TrueType {};
template <>
struct IsSimple<radar_dot::radar_msgs::RadarReturn> : TrueType {};
template <>
struct HasHeader<radar_dot::radar_msgs::RadarScan> : TrueType {};

template <>
struct MD5Sum<radar_dot::radar_msgs::RadarScan>
    : radar_dot::MessageText<radar_dot::radar_msgs::RadarScan, &radar_dot::radar_msgs::RadarScan::md5> {};
template <>
struct DataType<radar_dot::radar_msgs::RadarScan>
    : radar_dot::MessageText<radar_dot::radar_msgs::RadarScan, &radar_dot::radar_msgs::RadarScan::dataType> {
};
template <>
struct Definition<radar_dot::radar_msgs::RadarScan>
    : radar_dot::MessageText<radar_dot::radar_msgs::RadarScan,
                             &radar_dot::radar_msgs::RadarScan::definition> {};

}  // namespace message_traits

namespace serialization {

template <>
struct Serializer<radar_dot::radar_msgs::RadarScan> {
  template <typename Stream, typename Message>
  static void allInOne(Stream& stream, Message message) {
    stream.next(message.header);
    stream.next(message.returns);
  }
  ROS_DECLARE_ALLINONE_SERIALIZER
};

}  // namespace serialization
}  // namespace ros
