// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/messages/refined_twist.h"

#include <algorithm>

#include "radar_dot/vision/rigid_motion.h"

namespace radar_dot {
namespace {

void fill(geometry_msgs::Vector3& message, const Eigen::Vector3d& vector) {
  message.x = vector.x();
  message.y = vector.y();
  message.z = vector.z();
}

}  // namespace

geometry_msgs::TwistWithCovarianceStamped refinedTwist(const PairInputs& pair,
                                                       const Eigen::Isometry3d& T_base_from_camera,
                                                       const std::string& base_frame) {
  const ros::Time first = pair.flow->header.stamp;
  const double dt = (pair.flow->second_stamp - first).toSec();
  const Eigen::Isometry3d T_camera_from_base = T_base_from_camera.inverse();
  // Points seen from the base, and the base seen from them, move the opposite way.
  const StampedTwist velocity = baseVelocity(
      (T_base_from_camera * pair.motion.T_current_from_previous * T_camera_from_base).inverse(), dt);
  geometry_msgs::TwistWithCovarianceStamped twist;
  twist.header.stamp = std::max(first, pair.flow->second_stamp);
  twist.header.frame_id = base_frame;
  fill(twist.twist.twist.linear, velocity.linear);
  fill(twist.twist.twist.angular, velocity.angular);
  const Eigen::Matrix<double, 6, 6> covariance =
      cameraCovariance(T_camera_from_base, pair.motion.motion_covariance) / (dt * dt);
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> message(twist.twist.covariance.data());
  // Messages have the translation first.
  message << covariance.bottomRightCorner<3, 3>(), covariance.bottomLeftCorner<3, 3>(),
      covariance.topRightCorner<3, 3>(), covariance.topLeftCorner<3, 3>();
  return twist;
}

}  // namespace radar_dot
