// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <geometry_msgs/AccelWithCovariance.h>
#include <geometry_msgs/Polygon.h>
#include <geometry_msgs/PoseWithCovariance.h>
#include <geometry_msgs/TwistWithCovariance.h>
#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <std_msgs/Header.h>

#include <cstdint>
#include <string>
#include <vector>

#include "nodelets/messages/message_text.h"

// The messages derived_object_msgs/ObjectWithCovarianceArray and costmap_converter/ObstacleArrayMsg, for
// builds without these packages.

namespace radar_dot::derived_object_msgs {

struct SolidPrimitiveWithCovariance {
  static constexpr std::uint8_t kCylinder = 3;  ///< dimensions: height, radius
  std::uint8_t type = 0;
  std::vector<double> dimensions;  ///< m
  std::vector<double> covariance;  ///< m^2, row-major
};

struct ObjectWithCovariance {
  static constexpr std::uint8_t kTracked = 1;
  std_msgs::Header header;
  std::uint32_t id = 0;
  std::uint8_t detection_level = 0;
  std::uint8_t object_classified = 0;
  geometry_msgs::PoseWithCovariance pose;
  geometry_msgs::TwistWithCovariance twist;
  geometry_msgs::AccelWithCovariance accel;
  geometry_msgs::Polygon polygon;
  SolidPrimitiveWithCovariance shape;
  std::uint8_t classification = 0;  ///< 0: unknown
  std::uint8_t classification_certainty = 0;
  std::uint32_t classification_age = 0;
};

struct ObjectWithCovarianceArray {
  std_msgs::Header header;
  std::vector<ObjectWithCovariance> objects;

  static const char* md5() { return "59dfdf4ed3407a2558ccbc7f5732bf46"; }
  static const char* dataType() { return "derived_object_msgs/ObjectWithCovarianceArray"; }
  /// Of the message and, once each, of all that it is made of.
  static const char* definition();
};

}  // namespace radar_dot::derived_object_msgs

namespace radar_dot::costmap_converter {

struct ObstacleMsg {
  std_msgs::Header header;
  geometry_msgs::Polygon polygon;  ///< one point: a disc of `radius`
  double radius = 0.0;             ///< m
  std::int64_t id = 0;
  geometry_msgs::Quaternion orientation;
  geometry_msgs::TwistWithCovariance velocities;
};

struct ObstacleArrayMsg {
  std_msgs::Header header;
  std::vector<ObstacleMsg> obstacles;

  static const char* md5() { return "8a1bdcde72c65ca7d3ce8ebf52d43516"; }
  static const char* dataType() { return "costmap_converter/ObstacleArrayMsg"; }
  /// As of ObjectWithCovarianceArray.
  static const char* definition();
};

}  // namespace radar_dot::costmap_converter

namespace ros {
namespace message_traits {

template <>
struct HasHeader<radar_dot::derived_object_msgs::ObjectWithCovarianceArray> : TrueType {};
template <>
struct HasHeader<radar_dot::costmap_converter::ObstacleArrayMsg> : TrueType {};

template <>
struct MD5Sum<radar_dot::derived_object_msgs::ObjectWithCovarianceArray>
    : radar_dot::MessageText<radar_dot::derived_object_msgs::ObjectWithCovarianceArray,
                             &radar_dot::derived_object_msgs::ObjectWithCovarianceArray::md5> {};
template <>
struct DataType<radar_dot::derived_object_msgs::ObjectWithCovarianceArray>
    : radar_dot::MessageText<radar_dot::derived_object_msgs::ObjectWithCovarianceArray,
                             &radar_dot::derived_object_msgs::ObjectWithCovarianceArray::dataType> {};
template <>
struct Definition<radar_dot::derived_object_msgs::ObjectWithCovarianceArray>
    : radar_dot::MessageText<radar_dot::derived_object_msgs::ObjectWithCovarianceArray,
                             &radar_dot::derived_object_msgs::ObjectWithCovarianceArray::definition> {};

template <>
struct MD5Sum<radar_dot::costmap_converter::ObstacleArrayMsg>
    : radar_dot::MessageText<radar_dot::costmap_converter::ObstacleArrayMsg,
                             &radar_dot::costmap_converter::ObstacleArrayMsg::md5> {};
template <>
struct DataType<radar_dot::costmap_converter::ObstacleArrayMsg>
    : radar_dot::MessageText<radar_dot::costmap_converter::ObstacleArrayMsg,
                             &radar_dot::costmap_converter::ObstacleArrayMsg::dataType> {};
template <>
struct Definition<radar_dot::costmap_converter::ObstacleArrayMsg>
    : radar_dot::MessageText<radar_dot::costmap_converter::ObstacleArrayMsg,
                             &radar_dot::costmap_converter::ObstacleArrayMsg::definition> {};

}  // namespace message_traits

namespace serialization {

template <>
struct Serializer<radar_dot::derived_object_msgs::SolidPrimitiveWithCovariance> {
  template <typename Stream, typename Message>
  static void allInOne(Stream& stream, Message message) {
    stream.next(message.type);
    stream.next(message.dimensions);
    stream.next(message.covariance);
  }
  ROS_DECLARE_ALLINONE_SERIALIZER
};

template <>
struct Serializer<radar_dot::derived_object_msgs::ObjectWithCovariance> {
  template <typename Stream, typename Message>
  static void allInOne(Stream& stream, Message message) {
    stream.next(message.header);
    stream.next(message.id);
    stream.next(message.detection_level);
    stream.next(message.object_classified);
    stream.next(message.pose);
    stream.next(message.twist);
    stream.next(message.accel);
    stream.next(message.polygon);
    stream.next(message.shape);
    stream.next(message.classification);
    stream.next(message.classification_certainty);
    stream.next(message.classification_age);
  }
  ROS_DECLARE_ALLINONE_SERIALIZER
};

template <>
struct Serializer<radar_dot::derived_object_msgs::ObjectWithCovarianceArray> {
  template <typename Stream, typename Message>
  static void allInOne(Stream& stream, Message message) {
    stream.next(message.header);
    stream.next(message.objects);
  }
  ROS_DECLARE_ALLINONE_SERIALIZER
};

template <>
struct Serializer<radar_dot::costmap_converter::ObstacleMsg> {
  template <typename Stream, typename Message>
  static void allInOne(Stream& stream, Message message) {
    stream.next(message.header);
    stream.next(message.polygon);
    stream.next(message.radius);
    stream.next(message.id);
    stream.next(message.orientation);
    stream.next(message.velocities);
  }
  ROS_DECLARE_ALLINONE_SERIALIZER
};

template <>
struct Serializer<radar_dot::costmap_converter::ObstacleArrayMsg> {
  template <typename Stream, typename Message>
  static void allInOne(Stream& stream, Message message) {
    stream.next(message.header);
    stream.next(message.obstacles);
  }
  ROS_DECLARE_ALLINONE_SERIALIZER
};

}  // namespace serialization
}  // namespace ros
