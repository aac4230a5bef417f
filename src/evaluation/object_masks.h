// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "mask_folder.h"
#include "radar_dot/evaluation/object_evaluation.h"
#include "radar_dot/objects/object_detection.h"
#include "radar_scene.h"
#include "scene_depths.h"

namespace radar_dot::evaluation {

/// What the saved masks of one camera in one scene tell of moving objects: where their regions are. Saved
/// masks come without flow, so that velocities are unknown.
class ObjectMasks {
 public:
  /// Tables, radar and options must outlive it.
  /// @throws dataset::DatasetError see MaskFolder; std::invalid_argument for invalid options.
  ObjectMasks(const dataset::Tables& tables, dataset::Index scene, const RadarScene& radar,
              const ObjectEvaluationOptions& options);

  std::size_t size() const noexcept { return masks_.size(); }
  double timeOf(std::size_t index) const { return masks_.timeOf(index); }  ///< s, of the image, ascending
  /// s, from when on the mask is known.
  double knownFrom(std::size_t index) const { return timeOf(index) + options_.masks.delay; }
  /// Detections at the time of the image, base frame. @throws dataset::DatasetError naming a file.
  std::vector<ObjectDetection> detections(std::size_t index);

 private:
  std::vector<MaskRegion> regions(std::size_t index);

  const ObjectEvaluationOptions& options_;
  MaskFolder masks_;
  SceneDepths depths_;
};

}  // namespace radar_dot::evaluation
