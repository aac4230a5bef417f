// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/mask_input.h"

#include <algorithm>
#include <stdexcept>

#include "radar_dot/objects/mask_marking.h"

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

void MaskInput::add(const StampedTwist& velocity) {
  if (enabled_) velocities_.add(velocity);
}

void MaskInput::forget() {
  mask_.reset();
  velocities_.clear();
}

void MaskInput::mark(RadarScan& scan) {
  if (!enabled_) return;
  ++scans_;
  std::string reason;
  try {
    reason = markByLatest(scan);
  } catch (const std::exception& error) {
    reason = error.what();  // a mask must never cost a scan
  }
  if (!reason.empty() && scan.returns.size() > 0) {
    ++unused_;
    unused_reason_ = reason;
  }
  marked_ += static_cast<std::size_t>(std::count(scan.known_dynamic.begin(), scan.known_dynamic.end(), 1));
}

std::string MaskInput::markByLatest(RadarScan& scan) {
  if (!mask_ || !camera_) return "nothing on '" + (mask_ ? cameras_ : masks_).topic() + "' yet";
  std::string missing;
  const std::optional<Eigen::Isometry3d> T_base_from_camera =
      extrinsics_.lookupCamera(mask_->header.frame_id, missing);
  if (!T_base_from_camera) return missing;
  const DecodedImage mask = decodedImageOf(mask_);
  const CameraIntrinsics camera = cameraOf(*camera_);
  if (!isGridOf(mask.pixels.size(), {camera.width, camera.height})) {
    throw std::invalid_argument("the mask on '" + masks_.topic() + "' of " + sizeText(mask.pixels.size()) +
                                " px does not have the shape of camera_info on '" + cameras_.topic() + "'");
  }
  const StampedMask stamped{mask_->header.stamp.toSec(), mask.pixels,
                            camera.scaledTo(mask.pixels.cols, mask.pixels.rows),
                            T_base_from_camera->inverse()};
  return markReturns(scan, stamped, max_age_, footprint_, velocities_);
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
