// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/messages/object_messages.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <string>

namespace radar_dot {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

constexpr std::array<const char*, 3> kNamespaces = {"objects", "velocities", "labels"};
constexpr double kDiameter = 2.0, kHeight = 1.6;  // m: how large an object is, is not measured

template <typename Array>
void store(const Eigen::Matrix2d& covariance, Array& message) {
  Eigen::Map<Eigen::Matrix<double, 2, 2, Eigen::RowMajor>>(message.data()) = covariance;
}

/// Stamps before 1970 do not exist.
ros::Time timeOf(double seconds) { return seconds > 0.0 ? ros::Time(seconds) : ros::Time(); }

// Markers have 32-bit ids; ids that far apart are never on show together.
std::int32_t markerId(std::uint64_t id) {
  return static_cast<std::int32_t>(id & static_cast<std::uint64_t>(std::numeric_limits<std::int32_t>::max()));
}

/// Colours of consecutive ids lie far apart: the hue steps by the golden section.
std_msgs::ColorRGBA colourOf(std::uint64_t id) {
  constexpr double kGolden = 0.6180339887498949;
  const double hue = 6.0 * std::fmod(static_cast<double>(id) * kGolden, 1.0);
  const auto channel = [hue](double peak) {
    const double apart = std::abs(std::remainder(hue - peak, 6.0));
    return static_cast<float>(0.25 + 0.75 * std::clamp(2.0 - apart, 0.0, 1.0));
  };
  std_msgs::ColorRGBA colour;
  colour.r = channel(0.0);
  colour.g = channel(2.0);
  colour.b = channel(4.0);
  colour.a = 0.8F;
  return colour;
}

std::string labelOf(const MovingObject& object) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%llu: %.1f m/s", static_cast<unsigned long long>(object.id),
                std::hypot(object.velocity.x, object.velocity.y));
  return text.data();
}

void addMarkers(const MovingObject& object, const Marker& common, MarkerArray& array) {
  Marker body = common;
  body.ns = kNamespaces[0];
  body.type = Marker::CYLINDER;
  body.pose.position = object.position;
  body.pose.position.z += 0.5 * kHeight;
  body.scale.x = body.scale.y = kDiameter;
  body.scale.z = kHeight;
  body.color.a = 0.5F;
  array.markers.push_back(body);

  Marker arrow = common;
  arrow.ns = kNamespaces[1];
  arrow.type = Marker::ARROW;
  arrow.points.assign(2, body.pose.position);
  arrow.points[1].x += object.velocity.x;
  arrow.points[1].y += object.velocity.y;
  arrow.scale.x = 0.3;  // m, shaft
  arrow.scale.y = 0.8;  // m, head
  array.markers.push_back(arrow);

  Marker label = common;
  label.ns = kNamespaces[2];
  label.type = Marker::TEXT_VIEW_FACING;
  label.pose.position = object.position;
  label.pose.position.z += kHeight + 1.0;
  label.scale.z = 1.2;  // m, height of a letter
  label.color.a = 1.0F;
  label.text = labelOf(object);
  array.markers.push_back(label);
}

/// Covariance of six components of which only the first two are known.
template <typename Array>
void store6(const boost::array<double, 4>& planar, Array& message) {
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> covariance(message.data());
  covariance = kUnknownVariance * Eigen::Matrix<double, 6, 6>::Identity();
  covariance.topLeftCorner<2, 2>() =
      Eigen::Map<const Eigen::Matrix<double, 2, 2, Eigen::RowMajor>>(planar.data());
}

geometry_msgs::TwistWithCovariance twistOf(const MovingObject& object) {
  geometry_msgs::TwistWithCovariance twist;
  twist.twist.linear = object.velocity;
  store6(object.velocity_covariance, twist.covariance);
  return twist;
}

/// The direction in which an object moves.
geometry_msgs::Quaternion headingOf(const MovingObject& object) {
  const double yaw = std::atan2(object.velocity.y, object.velocity.x);
  geometry_msgs::Quaternion heading;
  heading.w = std::cos(0.5 * yaw);
  heading.z = std::sin(0.5 * yaw);
  return heading;
}

/// Of that direction, rad^2; at most that of any direction.
double headingVariance(const MovingObject& object) {
  const double vx = object.velocity.x, vy = object.velocity.y, square = vx * vx + vy * vy;
  const auto& c = object.velocity_covariance;
  const double across = (vy * vy * c[0] - vx * vy * (c[1] + c[2]) + vx * vx * c[3]) / square;
  constexpr double kAny = M_PI * M_PI / 3.0;
  return across < kAny * square ? across / square : kAny;
}

}  // namespace

Eigen::Isometry2d planarPose(const Eigen::Isometry3d& pose) {
  Eigen::Isometry2d planar(Eigen::Rotation2Dd(std::atan2(pose.linear()(1, 0), pose.linear()(0, 0))));
  planar.translation() = pose.translation().head<2>();
  return planar;
}

MovingObject objectMessage(const ObjectTrack& track, const ros::Time& stamp, const FrameOfObjects& frame,
                           double image_max_age) {
  const Eigen::Matrix2d R = frame.T_frame_from_odom.linear();
  const Eigen::Vector2d position = frame.T_frame_from_odom * track.position();
  const Eigen::Vector2d velocity = R * track.velocity();
  MovingObject object;
  object.id = track.id;
  object.stamp = stamp;
  object.position.x = position.x();
  object.position.y = position.y();
  object.position.z = frame.height;
  object.velocity.x = velocity.x();
  object.velocity.y = velocity.y();
  store(R * track.covariance.topLeftCorner<2, 2>() * R.transpose(), object.position_covariance);
  store(R * track.covariance.bottomRightCorner<2, 2>() * R.transpose(), object.velocity_covariance);
  object.first_seen = timeOf(track.birth);
  object.last_seen = timeOf(track.last_hit);
  object.detections = static_cast<std::uint32_t>(track.hits);
  object.return_count = static_cast<std::uint32_t>(track.return_count);
  if (track.box.empty() || stamp.toSec() - track.last_image > image_max_age) return object;
  object.image_stamp = timeOf(track.last_image);
  object.box_x = static_cast<std::uint32_t>(std::max(0, track.box.x));
  object.box_y = static_cast<std::uint32_t>(std::max(0, track.box.y));
  object.box_width = static_cast<std::uint32_t>(track.box.width);
  object.box_height = static_cast<std::uint32_t>(track.box.height);
  object.pixel_count = static_cast<std::uint32_t>(track.pixel_count);
  return object;
}

derived_object_msgs::ObjectWithCovarianceArray objectsWithCovariance(const MovingObjects& objects) {
  using derived_object_msgs::ObjectWithCovariance;
  derived_object_msgs::ObjectWithCovarianceArray array;
  array.header = objects.header;
  for (const MovingObject& object : objects.objects) {
    ObjectWithCovariance& message = array.objects.emplace_back();
    message.header = objects.header;
    message.id = static_cast<std::uint32_t>(object.id);
    message.detection_level = ObjectWithCovariance::kTracked;
    message.pose.pose.position = object.position;
    message.pose.pose.orientation = headingOf(object);
    store6(object.position_covariance, message.pose.covariance);
    message.pose.covariance.back() = headingVariance(object);
    message.twist = twistOf(object);
    store6({kUnknownVariance, 0.0, 0.0, kUnknownVariance}, message.accel.covariance);
    message.shape.type = derived_object_msgs::SolidPrimitiveWithCovariance::kCylinder;
    message.shape.dimensions = {kHeight, 0.5 * kDiameter};
    message.shape.covariance = {kUnknownVariance, 0.0, 0.0, kUnknownVariance};
  }
  return array;
}

costmap_converter::ObstacleArrayMsg obstaclesOf(const MovingObjects& objects) {
  costmap_converter::ObstacleArrayMsg array;
  array.header = objects.header;
  for (const MovingObject& object : objects.objects) {
    costmap_converter::ObstacleMsg& message = array.obstacles.emplace_back();
    message.header = objects.header;
    geometry_msgs::Point32& centre = message.polygon.points.emplace_back();
    centre.x = static_cast<float>(object.position.x);
    centre.y = static_cast<float>(object.position.y);
    message.radius = 0.5 * kDiameter;
    message.id = static_cast<std::int64_t>(object.id);
    message.orientation = headingOf(object);
    message.velocities = twistOf(object);
  }
  return array;
}

MarkerArray ObjectMarkers::update(const MovingObjects& objects, double lifetime) {
  MarkerArray array;
  std::set<std::int32_t> present;
  for (const MovingObject& object : objects.objects) {
    Marker common;
    common.header = objects.header;
    common.id = markerId(object.id);
    common.action = Marker::ADD;
    common.pose.orientation.w = 1.0;
    common.color = colourOf(object.id);
    common.lifetime = ros::Duration(lifetime);
    addMarkers(object, common, array);
    present.insert(common.id);
  }
  for (const std::int32_t id : shown_) {
    if (present.count(id) > 0) continue;
    Marker gone;
    gone.header = objects.header;
    gone.id = id;
    gone.action = Marker::DELETE;
    for (const char* name : kNamespaces) {
      gone.ns = name;
      array.markers.push_back(gone);
    }
  }
  shown_ = present;
  return array;
}

MarkerArray ObjectMarkers::deleteAll(const std_msgs::Header& header) {
  MarkerArray array;
  array.markers.resize(1);
  array.markers[0].header = header;
  array.markers[0].action = Marker::DELETEALL;
  shown_.clear();
  return array;
}

}  // namespace radar_dot
