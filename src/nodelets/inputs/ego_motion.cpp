// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/ego_motion.h"

#include <stdexcept>
#include <utility>

#include "nodelets/common/read_parameters.h"

namespace radar_dot {

void EgoMotion::add(const geometry_msgs::TwistWithCovarianceStamped& twist) {
  const std::string defect = twistDefect(twist, extrinsics_.baseFrame());
  if (!defect.empty()) throw std::invalid_argument(defect);
  const auto unobserved = [&twist](std::size_t axis) {
    constexpr std::size_t kAxes = 6;
    return twist.twist.covariance[axis * kAxes + axis] >= kUnobservedVariance;
  };
  constexpr std::size_t kForward = 0, kYaw = 5;
  unobserved_.clear();
  if (unobserved(kForward)) unobserved_ = "vx";
  if (needs_yaw_rate_ && !rotation_ && unobserved(kYaw)) {
    const EgoVelocityParams estimator;
    const RotationParams rotation;
    unobserved_ += std::string(unobserved_.empty() ? "" : " and ") + "the yaw rate (choose another " +
                   nameOf(estimator, estimator.model) + ", or a " + nameOf(rotation, rotation.source) + ")";
  }
  if (unobserved_.empty()) {
    twists_.add(velocityOf(twist));
    covariance_ = twist.twist.covariance;
  }
  changed_();
}

void EgoMotion::setUpRotation(const RotationParams& params, ros::NodeHandle& handle) {
  RotationSource::Callbacks callbacks;
  callbacks.arrival = [] {};
  callbacks.sample = [this] { changed_(); };
  callbacks.restarted = [] {};
  callbacks.warn = [this](const std::string& text) { warn_(text); };
  rotation_ = makeRotationSource(params, handle, extrinsics_, std::move(callbacks));
}

EgoMotion::Answer EgoMotion::between(const ros::Time& begin, const ros::Time& end, double max_hold,
                                     bool within_timeout) {
  Answer answer;
  std::optional<Eigen::Matrix3d> R_begin_from_end;
  if (rotation_) {
    const std::optional<PoseSample> at_begin = rotation_->at(begin);
    const std::optional<PoseSample> at_end = rotation_->at(end);
    answer.without_rotation = !at_begin || !at_end;
    if (!answer.without_rotation) {
      R_begin_from_end = (at_begin->rotation.conjugate() * at_end->rotation).toRotationMatrix();
    } else if (within_timeout) {
      answer.missing = "no rotation at the stamps of the images from " + rotation_->describe();
      return answer;
    }
  }
  answer.T_begin_from_end =
      twists_.motion(begin.toSec(), end.toSec(), max_hold, answer.missing, R_begin_from_end);
  if (!answer.T_begin_from_end) answer.missing = explained(answer.missing);
  return answer;
}

std::optional<StampedVelocity> EgoMotion::velocityAt(const ros::Time& time, double max_hold,
                                                     std::string& missing) const {
  std::optional<StampedVelocity> velocity = twists_.mean(time.toSec(), time.toSec(), max_hold, missing);
  if (!velocity) missing = explained(missing);
  return velocity;
}

std::string EgoMotion::explained(const std::string& missing) const {
  return unobserved_.empty() ? missing : missing + "; the latest twists do not observe " + unobserved_;
}

void EgoMotion::forget() {
  twists_.clear();
  unobserved_.clear();
  if (rotation_) rotation_->reset();
}

std::string EgoMotion::rotationText() const {
  return rotation_ ? rotation_->describe() : "yaw rate of the twists";
}

}  // namespace radar_dot
