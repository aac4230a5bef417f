// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/ego_motion.h"

#include <stdexcept>
#include <utility>

#include "nodelets/common/read_parameters.h"
#include "nodelets/messages/ego_messages.h"

namespace radar_dot {

void EgoMotion::add(const geometry_msgs::TwistWithCovarianceStamped& twist) {
  const std::string defect = twistDefect(twist, extrinsics_.baseFrame());
  if (!defect.empty()) throw std::invalid_argument(defect);
  const TwistHistory::Lack lack = twists_.add(twistOf(twist), needs_yaw_rate_ && !rotation_);
  unobserved_ = lack.forward ? "vx" : "";
  if (lack.yaw_rate) {
    const EgoVelocityParams estimator;
    const RotationParams rotation;
    unobserved_ += std::string(unobserved_.empty() ? "" : " and ") + "the yaw rate (choose another " +
                   nameOf(estimator, estimator.model) + ", or a " + nameOf(rotation, rotation.source) + ")";
  }
  if (rotation_) rotation_->compare(twistOf(twist));
  changed_();
}

std::string EgoMotion::contradiction() const {
  return rotation_ ? rotation_->contradiction("ego/twist", "the range rates of the radars") : "";
}

void EgoMotion::setUpRotation(const RotationParams& params, ros::NodeHandle& handle) {
  RotationSource::Callbacks callbacks;
  callbacks.arrival = [] {};
  callbacks.sample = [this] { changed_(); };
  callbacks.restarted = [] {};
  callbacks.warn = [this](const std::string& text) { warn_(text); };
  rotation_ = makeRotationSource(params, handle, extrinsics_, std::move(callbacks));
  if (rotation_) rotation_->start();
}

IntervalMotion EgoMotion::between(const ros::Time& begin, const ros::Time& end, double max_hold,
                                  bool may_wait) {
  const auto rotationAt = [this](const ros::Time& time) -> std::optional<Eigen::Quaterniond> {
    const std::optional<StampedPose> pose = rotation_->at(time);
    return pose ? std::optional<Eigen::Quaterniond>(pose->rotation) : std::nullopt;
  };
  std::optional<KnownRotation> rotation;
  if (rotation_) rotation = KnownRotation{rotation_->describe(), rotationAt(begin), rotationAt(end)};
  IntervalMotion motion =
      twists_.between(begin.toSec(), end.toSec(), max_hold, rotation ? &*rotation : nullptr, may_wait);
  const bool waits = motion.without_rotation && may_wait;
  if (!motion.T_begin_from_end && !waits) motion.missing = explained(motion.missing);
  return motion;
}

std::optional<StampedTwist> EgoMotion::velocityAt(const ros::Time& time, double max_hold,
                                                  std::string& missing) const {
  std::optional<StampedTwist> velocity = twists_.mean(time.toSec(), time.toSec(), max_hold, missing);
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
