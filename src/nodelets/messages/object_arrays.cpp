// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/messages/object_arrays.h"

namespace radar_dot {
namespace {

const std::string kSeparator = "\n" + std::string(80, '=') + "\n";

constexpr const char* kObjects =
    "std_msgs/Header header\n"
    "derived_object_msgs/ObjectWithCovariance[] objects";
constexpr const char* kObject =
    "MSG: derived_object_msgs/ObjectWithCovariance\n"
    "std_msgs/Header header\n"
    "uint32 id\n"
    "uint8 detection_level\n"
    "uint8 OBJECT_DETECTED=0\n"
    "uint8 OBJECT_TRACKED=1\n"
    "bool object_classified\n"
    "geometry_msgs/PoseWithCovariance pose\n"
    "geometry_msgs/TwistWithCovariance twist\n"
    "geometry_msgs/AccelWithCovariance accel\n"
    "geometry_msgs/Polygon polygon\n"
    "derived_object_msgs/SolidPrimitiveWithCovariance shape\n"
    "uint8 classification\n"
    "uint8 CLASSIFICATION_UNKNOWN=0\n"
    "uint8 CLASSIFICATION_UNKNOWN_SMALL=1\n"
    "uint8 CLASSIFICATION_UNKNOWN_MEDIUM=2\n"
    "uint8 CLASSIFICATION_UNKNOWN_BIG=3\n"
    "uint8 CLASSIFICATION_PEDESTRIAN=4\n"
    "uint8 CLASSIFICATION_BIKE=5\n"
    "uint8 CLASSIFICATION_CAR=6\n"
    "uint8 CLASSIFICATION_TRUCK=7\n"
    "uint8 CLASSIFICATION_MOTORCYCLE=8\n"
    "uint8 CLASSIFICATION_OTHER_VEHICLE=9\n"
    "uint8 CLASSIFICATION_BARRIER=10\n"
    "uint8 CLASSIFICATION_SIGN=11\n"
    "uint8 classification_certainty\n"
    "uint32 classification_age";
constexpr const char* kShape =
    "MSG: derived_object_msgs/SolidPrimitiveWithCovariance\n"
    "uint8 BOX=1\n"
    "uint8 SPHERE=2\n"
    "uint8 CYLINDER=3\n"
    "uint8 CONE=4\n"
    "uint8 type\n"
    "float64[] dimensions\n"
    "uint8 BOX_X=0\n"
    "uint8 BOX_Y=1\n"
    "uint8 BOX_Z=2\n"
    "uint8 SPHERE_RADIUS=0\n"
    "uint8 CYLINDER_HEIGHT=0\n"
    "uint8 CYLINDER_RADIUS=1\n"
    "uint8 CONE_HEIGHT=0\n"
    "uint8 CONE_RADIUS=1\n"
    "float64[] covariance";
constexpr const char* kObstacles =
    "std_msgs/Header header\n"
    "costmap_converter/ObstacleMsg[] obstacles";
constexpr const char* kObstacle =
    "MSG: costmap_converter/ObstacleMsg\n"
    "std_msgs/Header header\n"
    "geometry_msgs/Polygon polygon\n"
    "float64 radius\n"
    "int64 id\n"
    "geometry_msgs/Quaternion orientation\n"
    "geometry_msgs/TwistWithCovariance velocities";

/// Adds the sections of a message and of its parts that are not there yet.
template <typename Message>
void addSections(std::string& definition) {
  std::string rest = std::string("MSG: ") + ros::message_traits::datatype<Message>() + "\n" +
                     ros::message_traits::definition<Message>();
  while (!rest.empty()) {
    const std::size_t end = rest.find(kSeparator);
    const std::string section = rest.substr(0, end);
    rest = end == std::string::npos ? "" : rest.substr(end + kSeparator.size());
    const std::string title = kSeparator + section.substr(0, section.find('\n') + 1);
    if (definition.find(title) == std::string::npos) definition += kSeparator + section;
  }
}

template <typename... Parts>
std::string definitionOf(std::string own) {
  (addSections<Parts>(own), ...);
  return own;
}

}  // namespace

using geometry_msgs::AccelWithCovariance;
using geometry_msgs::Polygon;
using geometry_msgs::PoseWithCovariance;
using geometry_msgs::TwistWithCovariance;

const char* derived_object_msgs::ObjectWithCovarianceArray::definition() {
  static const std::string text =
      definitionOf<std_msgs::Header, PoseWithCovariance, TwistWithCovariance, AccelWithCovariance, Polygon>(
          kObjects + kSeparator + kObject + kSeparator + kShape);
  return text.c_str();
}

const char* costmap_converter::ObstacleArrayMsg::definition() {
  static const std::string text =
      definitionOf<std_msgs::Header, Polygon, geometry_msgs::Quaternion, TwistWithCovariance>(
          kObstacles + kSeparator + kObstacle);
  return text.c_str();
}

}  // namespace radar_dot
