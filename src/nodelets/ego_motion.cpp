// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ego_motion.h"

#include <stdexcept>
#include <utility>

namespace radar_dot {

void EgoMotion::add(const geometry_msgs::TwistWithCovarianceStamped& twist) {
  const std::string defect = twistDefect(twist, extrinsics_.baseFrame());
  if (!defect.empty()) throw std::invalid_argument(defect);
  twists_.add(velocityOf(twist));
  changed_();
}

void EgoMotion::setUpRotation(ros::NodeHandle& handle, ros::NodeHandle& private_handle) {
  RotationSource::Callbacks callbacks;
  callbacks.arrival = [] {};
  callbacks.sample = [this] { changed_(); };
  callbacks.anew = [] {};
  callbacks.warn = [this](const std::string& text) { warn_(text); };
  rotation_ = makeRotationSource(private_handle.param<std::string>("rotation_source", "radar"), handle,
                                 private_handle, extrinsics_, std::move(callbacks));
}

std::optional<Eigen::Isometry3d> EgoMotion::between(const ros::Time& begin, const ros::Time& end,
                                                    double max_hold, bool patient, std::string& missing) {
  std::optional<Eigen::Matrix3d> R_begin_from_end;
  if (rotation_) {
    const std::optional<PoseSample> at_begin = rotation_->at(begin);
    const std::optional<PoseSample> at_end = rotation_->at(end);
    if (at_begin && at_end) {
      R_begin_from_end = (at_begin->rotation.conjugate() * at_end->rotation).toRotationMatrix();
    } else if (patient) {
      missing = "no rotation at the stamps of the images from " + rotation_->describe();
      return std::nullopt;
    } else {
      ++without_rotation_;
      warn_("no rotation at the stamps of the images from " + rotation_->describe() +
            "; using the rates of the twists");
    }
  }
  return twists_.motion(begin.toSec(), end.toSec(), max_hold, missing, R_begin_from_end);
}

void EgoMotion::forget() {
  twists_.clear();
  if (rotation_) rotation_->reset();
}

std::string EgoMotion::rotationText() const {
  return rotation_ ? rotation_->describe() : "yaw rate of the twists";
}

std::size_t EgoMotion::takeWithoutRotation() { return std::exchange(without_rotation_, 0); }

}  // namespace radar_dot
