// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/messages/ego_messages.h"

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "common/transform_messages.h"

namespace radar_dot {
namespace {

// What is beyond would overflow where it is squared and summed up.
constexpr double kFastest = 1e3;   // m/s, rad/s
constexpr double kVaguest = 1e12;  // (m/s)^2, (rad/s)^2

}  // namespace

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

StampedTwist twistOf(const geometry_msgs::TwistWithCovarianceStamped& message) {
  const auto vectorOf = [](const geometry_msgs::Vector3& v) { return Eigen::Vector3d(v.x, v.y, v.z); };
  const geometry_msgs::TwistWithCovariance& twist = message.twist;
  return {message.header.stamp.toSec(), vectorOf(twist.twist.linear), vectorOf(twist.twist.angular),
          Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(twist.covariance.data())};
}

std::string twistDefect(const geometry_msgs::TwistWithCovarianceStamped& message,
                        const std::string& base_frame) {
  if (withoutSlash(message.header.frame_id) != base_frame) {
    return "its frame is '" + message.header.frame_id + "', not the base frame '" + base_frame + "'";
  }
  const StampedTwist twist = twistOf(message);
  const bool finite = twist.linear.allFinite() && twist.angular.allFinite() && twist.covariance.allFinite();
  if (!finite) return "it is not finite";
  if (twist.linear.norm() > kFastest || twist.angular.norm() > kFastest)
    return "it is faster than anything on wheels";
  if (twist.covariance.diagonal().minCoeff() < 0.0) return "its covariance has a negative variance";
  return twist.covariance.cwiseAbs().maxCoeff() > kVaguest ? "its covariance is beyond any number of use"
                                                           : "";
}

EgoStatus statusMessage(const ros::Time& stamp, const std::string& base_frame,
                        const EgoVelocityParams& params, const EgoVelocityResult& result) {
  EgoStatus message;
  message.header.stamp = stamp;
  message.header.frame_id = base_frame;
  switch (result.status) {
    case EstimateStatus::kOk: message.status = EgoStatus::OK; break;
    case EstimateStatus::kTooFewReturns: message.status = EgoStatus::TOO_FEW_RETURNS; break;
    case EstimateStatus::kDegenerateBearings: message.status = EgoStatus::DEGENERATE_BEARINGS; break;
    case EstimateStatus::kNoConsensus: message.status = EgoStatus::NO_CONSENSUS; break;
    case EstimateStatus::kAmbiguous: message.status = EgoStatus::AMBIGUOUS; break;
  }
  message.model = std::string(toString(params.model));
  message.solver = std::string(toString(params.solver));
  message.return_count = static_cast<std::uint32_t>(result.return_count);
  message.inlier_count = static_cast<std::uint32_t>(result.inlier_count);
  message.dynamic_count = static_cast<std::uint32_t>(result.dynamic_count);
  message.rms = result.rms;
  message.condition_number = result.condition_number;
  for (std::size_t i = 0; i < result.observed.size(); ++i) message.observed[i] = result.observed[i];
  return message;
}

}  // namespace radar_dot
