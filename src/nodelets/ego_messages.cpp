// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ego_messages.h"

#include <Eigen/Core>

namespace radar_dot {

geometry_msgs::TwistWithCovarianceStamped twistMessage(const ros::Time& stamp, const std::string& base_frame,
                                                       const EgoVelocityResult& result) {
  geometry_msgs::TwistWithCovarianceStamped message;
  message.header.stamp = stamp;
  message.header.frame_id = base_frame;
  message.twist.twist.linear.x = result.linear.x();
  message.twist.twist.linear.y = result.linear.y();
  message.twist.twist.linear.z = result.linear.z();
  message.twist.twist.angular.x = result.angular.x();
  message.twist.twist.angular.y = result.angular.y();
  message.twist.twist.angular.z = result.angular.z();
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(message.twist.covariance.data()) =
      result.covariance;
  return message;
}

}  // namespace radar_dot
