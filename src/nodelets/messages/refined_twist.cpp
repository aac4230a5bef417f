// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/messages/refined_twist.h"

#include <algorithm>

#include "radar_dot/common/base_motion.h"
#include "radar_dot/vision/rigid_motion.h"

namespace radar_dot {
namespace {

void fill(geometry_msgs::Vector3& message, const Eigen::Vector3d& vector) {
  message.x = vector.x();
  message.y = vector.y();
  message.z = vector.z();
}

}  // namespace

StampedTwist refinedVelocity(const MaskPair& pair, const MotionInput& refined) {
  const double dt = pair.second_time - pair.first_time;
  const Eigen::Isometry3d T_camera_from_base = pair.T_base_from_camera.inverse();
  // Points seen from the base, and the base seen from them, move the opposite way.
  StampedTwist velocity = baseVelocity(
      (pair.T_base_from_camera * refined.T_current_from_previous * T_camera_from_base).inverse(), dt);
  velocity.time = std::max(pair.first_time, pair.second_time);
  const Eigen::Matrix<double, 6, 6> covariance =
      cameraCovariance(T_camera_from_base, refined.motion_covariance) / (dt * dt);
  // Twists have the translation first.
  velocity.covariance << covariance.bottomRightCorner<3, 3>(), covariance.bottomLeftCorner<3, 3>(),
      covariance.topRightCorner<3, 3>(), covariance.topLeftCorner<3, 3>();
  return velocity;
}

geometry_msgs::TwistWithCovarianceStamped refinedTwist(const StampedTwist& velocity,
                                                       const std_msgs::Header& header) {
  geometry_msgs::TwistWithCovarianceStamped twist;
  twist.header = header;
  fill(twist.twist.twist.linear, velocity.linear);
  fill(twist.twist.twist.angular, velocity.angular);
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(twist.twist.covariance.data()) =
      velocity.covariance;
  return twist;
}

}  // namespace radar_dot
