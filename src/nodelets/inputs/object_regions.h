// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/Image.h>

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "nodelets/inputs/moment.h"
#include "nodelets/inputs/stamp_cache.h"
#include "nodelets/inputs/waiting_queue.h"
#include "nodelets/messages/image_messages.h"
#include "radar_dot/objects/mask_regions.h"

namespace radar_dot {

/// Everything that goes with one mask. The messages own the pixels.
struct MaskMessages {
  sensor_msgs::ImageConstPtr mask, depth, expected_flow;
  FlowConstPtr flow;
};

/// The regions of a mask on the grid of the flow; boxes and counts of pixels are those of the full image.
/// @throws std::invalid_argument where images are of other types, or of another shape than their camera's
std::vector<MaskRegion> regionsOf(const MaskMessages& messages, const sensor_msgs::CameraInfo& camera_info,
                                  const Eigen::Isometry3d& T_base_from_camera,
                                  const MaskRegionParams& params);

/// Masks that wait for depth, flow and expected flow of their stamp.
class MaskMatcher {
 public:
  void addMask(sensor_msgs::ImageConstPtr mask, const Moment& now) { waiting_.add(std::move(mask), now); }
  void addDepth(sensor_msgs::ImageConstPtr depth) { depths_.add(std::move(depth)); }
  void addFlow(FlowConstPtr flow) { flows_.add(std::move(flow)); }
  void addExpectedFlow(sensor_msgs::ImageConstPtr flow) { expected_flows_.add(std::move(flow)); }
  void clear();

  /// The first mask that waits, once everything is there; none: nothing is ready.
  /// @param timeout  s; a mask that has waited longer is left out, with what it lacks in `missing`
  std::optional<MaskMessages> take(double timeout, const Moment& now, std::string& missing);

 private:
  MaskMessages messagesOf(const sensor_msgs::ImageConstPtr& mask) const;

  WaitingQueue<sensor_msgs::ImageConstPtr> waiting_;
  StampCache<sensor_msgs::Image> depths_{4.0, 50}, expected_flows_{4.0, 50};
  StampCache<Flow> flows_{4.0, 50};
};

}  // namespace radar_dot
