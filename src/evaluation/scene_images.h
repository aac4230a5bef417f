// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "radar_scene.h"
#include "scene_depths.h"
#include "scene_motion.h"

namespace radar_dot::evaluation {

/// Two images of one camera.
struct ImagePair {
  dataset::Index first = dataset::kNone, second = dataset::kNone;
};

/// The pairs of a scene of which both images are on disk, in time order; `max_pairs` of them, 0 = all.
/// @throws dataset::DatasetError where there are none
std::vector<ImagePair> pairsOf(const dataset::Tables& tables, dataset::Index scene,
                               const PairOptions& options);

/// The pair by the same rule that ends with the first image of a pair; none at the begin of a scene, or where
/// its first image is not on disk.
std::optional<ImagePair> previousPair(const dataset::Tables& tables, const ImagePair& pair, ImagePairs pairs);

/// What the evaluation sees of the images of a scene: besides their depths, motion and flow of pairs.
class SceneImages : public SceneDepths {
 public:
  /// All three must outlive it. @throws std::invalid_argument for invalid options.
  SceneImages(const dataset::Tables& tables, const RadarScene& radar,
              const SegmentationEvaluationOptions& options);
  SceneImages(const dataset::Tables& tables, const RadarScene& radar,
              const SegmentationEvaluationOptions& options, const DepthSource& depth);

  /// Forgets all but what the pair shares with the one before.
  void begin(const ImagePair& pair);

  /// Motion of the base over the pair: its pose at the end, in its frame at the begin.
  Eigen::Isometry3d trueMotion(const ImagePair& pair) const;
  /// Flow by the backend of the options. @param T_first_from_second  motion of the base, for initialisation
  /// "expected"
  /// @throws dataset::DatasetError naming what is missing or wrong.
  FlowField flowOf(const ImagePair& pair, const Eigen::Isometry3d& T_first_from_second);
  /// True flow of a simulated dataroot; what the second image does not show is not valid.
  const FlowField& trueFlow(const ImagePair& pair);
  /// 255 where an image of a simulated dataroot shows what moves independently, else 0: CV_8UC1, on the grid.
  /// @throws dataset::DatasetError naming the file.
  cv::Mat trueMovers(dataset::Index row) const;

 protected:
  /// By the backward flow, and the motion that a vehicle knows at the image.
  std::optional<MotionDepthInput::Step> stepTo(dataset::Index previous, dataset::Index row) override;

 private:
  const RadarScene& radar_;
  const SegmentationEvaluationOptions& options_;
  std::optional<FileSource> file_source_;  // none: the estimator
  std::unique_ptr<OpticalFlow> flow_;
  std::unique_ptr<OpticalFlow> flow_back_;  // of steps
  std::optional<SceneMotion> motion_;       // of steps
  FlowField true_flow_;
  dataset::Index true_flow_of_ = dataset::kNone;  // the first image
};

}  // namespace radar_dot::evaluation
