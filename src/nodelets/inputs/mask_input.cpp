// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/mask_input.h"

#include <algorithm>
#include <stdexcept>

#include "nodelets/common/read_parameters.h"

namespace radar_dot {

void MaskInput::configure(const EgoVelocityConfig& config) {
  enabled_ = config.use_mask;
  max_age_ = config.mask_max_age;
  footprint_ = config.footprint;
  // A mask is late where no scan can use it any more.
  masks_.expectMaxAge(max_age_);
}

void MaskInput::setMask(const sensor_msgs::ImageConstPtr& mask) {
  if (decodedImageOf(mask).pixels.type() != CV_8UC1)
    throw std::invalid_argument("its encoding is '" + mask->encoding + "', not mono8");
  mask_ = mask;
}

void MaskInput::setCamera(const sensor_msgs::CameraInfoConstPtr& camera) {
  cameraOf(*camera);
  camera_ = camera;
}

void MaskInput::add(const StampedVelocity& velocity) {
  if (enabled_) velocities_.add(velocity);
}

void MaskInput::forget() {
  mask_.reset();
  velocities_.clear();
}

std::vector<std::uint8_t> MaskInput::marked(const std::vector<DopplerReturn>& returns,
                                            const Eigen::Isometry3d& T_base_from_sensor,
                                            const ros::Time& stamp) {
  if (!enabled_) return {};
  ++scans_;
  std::string reason;
  std::vector<std::uint8_t> flags;
  try {
    flags = markedBy(returns, T_base_from_sensor, stamp, reason);
  } catch (const std::exception& error) {
    reason = error.what();  // a mask must never cost a scan
  }
  if (flags.empty() && !returns.empty()) {
    ++unused_;
    unused_reason_ = reason;
  }
  marked_ += static_cast<std::size_t>(std::count(flags.begin(), flags.end(), 1));
  return flags;
}

std::vector<std::uint8_t> MaskInput::markedBy(const std::vector<DopplerReturn>& returns,
                                              const Eigen::Isometry3d& T_base_from_sensor,
                                              const ros::Time& stamp, std::string& reason) {
  if (!mask_ || !camera_) {
    reason = "nothing on '" + (mask_ ? cameras_ : masks_).topic() + "' yet";
    return {};
  }
  const double age = stamp.toSec() - mask_->header.stamp.toSec();
  if (age < 0.0) {
    reason = "the latest mask is " + std::to_string(-age) + " s younger than the scan";
    return {};
  }
  if (age > max_age_) {
    const EgoVelocityConfig names;
    reason = "the latest mask is " + std::to_string(age) + " s older than the scan (" +
             nameOf(names, names.mask_max_age) + ")";
    return {};
  }
  const std::optional<Eigen::Isometry3d> T_base_from_camera =
      extrinsics_.lookup(mask_->header.frame_id, reason);
  if (!T_base_from_camera) return {};
  // Returns that move independently have moved on since; the limit on the age keeps that small.
  const std::optional<Eigen::Isometry3d> T_mask_from_scan =
      velocities_.motion(mask_->header.stamp.toSec(), stamp.toSec(), max_age_, reason);
  if (!T_mask_from_scan) return {};
  const Eigen::Isometry3d T = *T_mask_from_scan * T_base_from_sensor;
  std::vector<Eigen::Vector3f> points;
  points.reserve(returns.size());
  for (const DopplerReturn& seen : returns) points.push_back(positionOf(seen, T));

  const DecodedImage mask = decodedImageOf(mask_);
  const CameraIntrinsics camera = cameraOf(*camera_);
  if (!isGridOf(mask.pixels.size(), {camera.width, camera.height})) {
    throw std::invalid_argument("the mask on '" + masks_.topic() + "' of " + sizeText(mask.pixels.size()) +
                                " px does not have the shape of camera_info on '" + cameras_.topic() + "'");
  }
  return pointsInMask(points, mask.pixels, camera.scaledTo(mask.pixels.cols, mask.pixels.rows),
                      T_base_from_camera->inverse(), footprint_);
}

void MaskInput::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  if (scans_ > 0 && unused_ == scans_)
    status.mergeSummary(DiagnosticStatus::WARN, "no scan has a mask: " + unused_reason_);
  status.addf("returns in the mask", "%zu", marked_);
  status.addf("scans without a mask", "%zu of %zu", unused_, scans_);
  marked_ = scans_ = unused_ = 0;
}

}  // namespace radar_dot
