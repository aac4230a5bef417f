// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "object_masks.h"

#include <limits>
#include <stdexcept>

#include "radar_dot/objects/mask_regions.h"
#include "segmentation_images.h"

namespace radar_dot::evaluation {
namespace {

DepthSource depthSourceOf(const ObjectMaskOptions& options) {
  DepthSource source;
  source.backend = options.depth;
  source.directory = options.depth_directory;
  source.working_width = options.working_width;
  return source;
}

const ObjectMaskOptions& validated(const ObjectMaskOptions& options) {
  if (!(options.delay >= 0.0)) throw std::invalid_argument("the delay of masks must not be negative (s)");
  if (options.working_width < 0) throw std::invalid_argument("working_width must not be negative (px)");
  validate(options.regions);
  return options;
}

}  // namespace

ObjectMasks::ObjectMasks(const dataset::Tables& tables, dataset::Index scene, const RadarScene& radar,
                         const ObjectMaskOptions& options)
    : options_(validated(options)),
      masks_(tables, scene, options.directory, options.channel, options.delay),
      depths_(tables, radar, depthSourceOf(options)) {}

std::vector<MaskRegion> ObjectMasks::regions(std::size_t index) {
  const dataset::Index row = masks_.rowOf(index);
  depths_.keepOnly(row);
  const cv::Mat& depth = depths_.depthOf(row);
  // The least area of a region is in px of this grid, whatever grid the masks were saved on.
  const cv::Mat mask = resizeNearest(masks_.load(index).mask, depth.size());
  const cv::Mat unknown_flow(depth.size(), CV_32FC2,
                             cv::Scalar::all(std::numeric_limits<double>::quiet_NaN()));
  constexpr double kInterval = 1.0;  // s, of no effect on a flow that is not known
  return regionsOfMask(mask, depth, unknown_flow, kInterval, depths_.gridOf(row),
                       depths_.mountOf(depths_.reading(row)), options_.regions);
}

std::vector<ObjectDetection> ObjectMasks::detections(std::size_t index, const DetectionParams& params) {
  std::vector<ObjectDetection> detections = detectObjects(timeOf(index), {}, regions(index), params);
  for (ObjectDetection& detection : detections) detection.moving = options_.starts_tracks;
  return detections;
}

}  // namespace radar_dot::evaluation
