// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>
#include <map>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "radar_scene.h"

namespace radar_dot::evaluation {

inline constexpr double kRadarReach = 0.1;  // s between an image and the scans that go with it

/// Two images of one camera.
struct ImagePair {
  dataset::Index first = dataset::kNone, second = dataset::kNone;
};

/// What the evaluation sees of the images of a scene: camera, picture, depth and flow, on the working grid.
/// Everything is read or computed once, and kept as long as a pair needs it.
class SceneImages {
 public:
  /// All three must outlive it. @throws std::invalid_argument for options that make no sense.
  SceneImages(const dataset::Tables& tables, const RadarScene& radar,
              const SegmentationEvaluationOptions& options);

  /// Forgets all but what the pair shares with the one before.
  void begin(const ImagePair& pair);

  const dataset::SampleData& reading(dataset::Index row) const { return tables_.sample_data[at(row)]; }
  const Eigen::Isometry3d& mountOf(const dataset::SampleData& reading) const {
    return tables_.calibrated_sensors[at(reading.calibrated_sensor)].T_base_from_sensor;
  }
  /// Motion of the base over the pair: its pose at the end, in its frame at the begin.
  Eigen::Isometry3d trueMotion(const ImagePair& pair) const;
  /// "<stem of the image>.png"
  std::string pngName(dataset::Index row) const;

  /// @throws dataset::DatasetError naming what is missing or wrong.
  CameraIntrinsics cameraOf(dataset::Index row) const;
  CameraIntrinsics gridOf(dataset::Index row) const;
  /// Depth by the backend of the options, m; and the true one of a simulated dataroot.
  const cv::Mat& depthOf(dataset::Index row);
  const cv::Mat& trueDepth(dataset::Index row);
  /// Flow by the backend of the options. @param input  with camera, motion and depth
  FlowField flowOf(const ImagePair& pair, const MotionInput& input);
  /// True flow of a simulated dataroot; what the second image does not show is not valid.
  const FlowField& trueFlow(const ImagePair& pair);

 private:
  std::filesystem::path truthFile(const std::string& folder, dataset::Index row) const;
  cv::Size sizeOf(dataset::Index row) const;
  const cv::Mat& pictureOf(dataset::Index row);
  cv::Mat computeDepth(dataset::Index row);
  std::vector<Eigen::Vector3f> radarPoints(double time) const;
  std::vector<Eigen::Vector3f> lidarPoints(const dataset::SampleData& image) const;

  const dataset::Tables& tables_;
  const RadarScene& radar_;
  const SegmentationEvaluationOptions& options_;
  std::unique_ptr<OpticalFlow> flow_;
  std::unique_ptr<DepthEstimator> depth_;
  std::map<dataset::Index, cv::Mat> pictures_, depths_, true_depths_;  // of the latest pair
  std::map<dataset::Index, FlowField> true_flows_;                     // by the first image
};

}  // namespace radar_dot::evaluation
