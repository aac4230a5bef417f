// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <memory>

#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "radar_scene.h"
#include "scene_depths.h"

namespace radar_dot::evaluation {

/// Two images of one camera.
struct ImagePair {
  dataset::Index first = dataset::kNone, second = dataset::kNone;
};

/// What the evaluation sees of the images of a scene: besides their depths, motion and flow of pairs.
class SceneImages : public SceneDepths {
 public:
  /// All three must outlive it. @throws std::invalid_argument for options that make no sense.
  SceneImages(const dataset::Tables& tables, const RadarScene& radar,
              const SegmentationEvaluationOptions& options);

  /// Forgets all but what the pair shares with the one before.
  void begin(const ImagePair& pair);

  /// Motion of the base over the pair: its pose at the end, in its frame at the begin.
  Eigen::Isometry3d trueMotion(const ImagePair& pair) const;
  /// Flow by the backend of the options. @param input  with camera, motion and depth
  /// @throws dataset::DatasetError naming what is missing or wrong.
  FlowField flowOf(const ImagePair& pair, const MotionInput& input);
  /// True flow of a simulated dataroot; what the second image does not show is not valid.
  const FlowField& trueFlow(const ImagePair& pair);

 private:
  const SegmentationEvaluationOptions& options_;
  std::unique_ptr<OpticalFlow> flow_;
  FlowField true_flow_;
  dataset::Index true_flow_of_ = dataset::kNone;  // the first image
};

}  // namespace radar_dot::evaluation
