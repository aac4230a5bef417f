// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "object_masks.h"

#include <limits>

#include "radar_dot/objects/mask_regions.h"
#include "segmentation_images.h"

namespace radar_dot::evaluation {

ObjectMasks::ObjectMasks(const dataset::Tables& tables, dataset::Index scene, const RadarScene& radar,
                         const ObjectEvaluationOptions& options)
    : options_(options),
      masks_(tables, scene, options.masks.directory, options.masks.channel, options.masks.delay),
      depths_(tables, radar, {options.depth, options.depth_input}) {}

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
                       depths_.mountOf(depths_.reading(row)), options_.objects.regions);
}

std::vector<ObjectDetection> ObjectMasks::detections(std::size_t index) {
  std::vector<ObjectDetection> detections =
      detectObjects(timeOf(index), {}, regions(index), options_.objects.detection);
  for (ObjectDetection& detection : detections) detection.moving = options_.objects.mask_starts_tracks;
  return detections;
}

}  // namespace radar_dot::evaluation
