// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/object_regions.h"

#include <cmath>
#include <stdexcept>

#include "vision/resize_nearest.h"

namespace radar_dot {
namespace {

/// An image of the camera's shape on the grid of the flow.
cv::Mat onGrid(const cv::Mat& image, const cv::Size& grid, const std::string& what) {
  if (image.size() == grid) return image;
  if (!isGridOf(image.size(), grid)) {
    throw std::invalid_argument(what + " of " + sizeText(image.size()) +
                                " px does not have the shape of the flow of " + sizeText(grid) + " px");
  }
  return resizeNearest(image, grid);
}

/// From px of the grid to px of the image.
void enlarge(MaskRegion& region, double across, double down) {
  const auto scaled = [](int value, double scale) { return static_cast<int>(std::lround(value * scale)); };
  const ImageBox box = region.box;
  region.box.x = scaled(box.x, across);
  region.box.y = scaled(box.y, down);
  region.box.width = scaled(box.x + box.width, across) - region.box.x;
  region.box.height = scaled(box.y + box.height, down) - region.box.y;
  region.pixel_count =
      static_cast<std::size_t>(std::lround(static_cast<double>(region.pixel_count) * across * down));
}

}  // namespace

std::vector<MaskRegion> regionsOf(const MaskMessages& messages, const sensor_msgs::CameraInfo& camera_info,
                                  const Eigen::Isometry3d& T_base_from_camera,
                                  const MaskRegionParams& params) {
  const FlowField flow = flowOf(*messages.flow);
  const cv::Size grid = flow.flow.size();
  const CameraIntrinsics camera = cameraOf(camera_info);
  if (!isGridOf(grid, {camera.width, camera.height})) {
    throw std::invalid_argument("flow of " + sizeText(grid) +
                                " px does not have the shape of camera_info of " +
                                sizeText({camera.width, camera.height}) + " px");
  }
  const DecodedImage mask = decodedImageOf(messages.mask);
  if (mask.pixels.type() != CV_8UC1) {
    throw std::invalid_argument("mask: its encoding is '" + messages.mask->encoding + "', not mono8");
  }
  const cv::Mat expected = flowImageOf(*messages.expected_flow);
  if (expected.size() != grid) {
    throw std::invalid_argument("expected flow of " + sizeText(expected.size()) +
                                " px does not match the flow of " + sizeText(grid) + " px");
  }
  const double interval = messages.flow->second_stamp.toSec() - messages.flow->header.stamp.toSec();
  // Flow to an earlier image shows the motion backwards.
  cv::Mat residual = flow.flow - expected;
  if (interval < 0.0) residual = -residual;
  std::vector<MaskRegion> regions = regionsOfMask(
      onGrid(mask.pixels, grid, "mask"), onGrid(depthOf(*messages.depth), grid, "depth"), residual,
      std::abs(interval), camera.scaledTo(grid.width, grid.height), T_base_from_camera, params);
  for (MaskRegion& region : regions)
    enlarge(region, static_cast<double>(camera.width) / grid.width,
            static_cast<double>(camera.height) / grid.height);
  return regions;
}

void MaskMatcher::clear() {
  waiting_.clear();
  depths_.clear();
  expected_flows_.clear();
  flows_.clear();
}

MaskMessages MaskMatcher::messagesOf(const sensor_msgs::ImageConstPtr& mask) const {
  const ros::Time stamp = mask->header.stamp;
  return {mask, depths_.find(stamp), expected_flows_.find(stamp), flows_.find(stamp)};
}

std::optional<MaskMessages> MaskMatcher::take(double timeout, const Moment& now, std::string& missing) {
  using Queue = WaitingQueue<sensor_msgs::ImageConstPtr>;
  const auto lackOf = [this](const sensor_msgs::ImageConstPtr& mask, double) -> Queue::Lack {
    const MaskMessages found = messagesOf(mask);
    if (found.depth && found.flow && found.expected_flow) return {};
    const char* lack = !found.depth ? "depth" : !found.flow ? "flow" : "dynamic/expected_flow";
    return {std::string("no ") + lack + " with the stamp of the mask"};
  };
  while (const std::optional<Queue::Taken> taken = waiting_.take(timeout, now, lackOf)) {
    const MaskMessages found = messagesOf(taken->item);
    const ros::Time stamp = found.mask->header.stamp;
    depths_.dropBefore(stamp);
    expected_flows_.dropBefore(stamp);
    flows_.dropBefore(stamp);
    if (taken->missing.empty()) return found;
    missing = taken->missing;
  }
  return std::nullopt;
}

}  // namespace radar_dot
