// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <map>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "radar_dot/dataset/tables.h"
#include "radar_dot/evaluation/evaluation_inputs.h"
#include "radar_dot/vision/camera_intrinsics.h"
#include "radar_dot/vision/depth_estimator.h"
#include "radar_scene.h"

namespace radar_dot::evaluation {

inline constexpr double kTrueDepthStd = 0.01;  // share: a true depth is as exact as its file and grid

/// "<stem of the image>.png"
std::string pngNameOf(const dataset::Tables& tables, dataset::Index row);
/// Camera of a reading, of its full image. @throws dataset::DatasetError naming what is missing or wrong.
CameraIntrinsics cameraOf(const dataset::Tables& tables, dataset::Index row);

/// Where depth comes from.
struct DepthSource {
  DepthConfig config;  ///< its backend may be a FileSource
  DepthInputOptions input;
  /// "lidar" sees every second point of each beam, and heldOutDepth the others.
  bool half_of_lidar = false;
};
/// Refuses "files" without a folder. @throws InvalidParameter.
void validate(const DepthSource& source);

/// Camera, picture and depth of the images of a scene, on the working grid. Everything is read or computed
/// once, and kept until it is told to be forgotten.
class SceneDepths {
 public:
  /// Tables and radar must outlive it. @throws std::invalid_argument for an invalid source.
  SceneDepths(const dataset::Tables& tables, const RadarScene& radar, const DepthSource& source);

  virtual ~SceneDepths() = default;

  /// Forgets the other images.
  void keepOnly(dataset::Index row);

  const dataset::SampleData& reading(dataset::Index row) const { return tables_.sample_data[at(row)]; }
  const Eigen::Isometry3d& mountOf(const dataset::SampleData& reading) const {
    return tables_.calibrated_sensors[at(reading.calibrated_sensor)].T_base_from_sensor;
  }
  std::string pngName(dataset::Index row) const { return pngNameOf(tables_, row); }

  /// The camera on the working grid. @throws dataset::DatasetError naming what is missing or wrong.
  CameraIntrinsics gridOf(dataset::Index row) const;
  const cv::Mat& imageOf(dataset::Index row);
  /// Depth by the backend of the source, m.
  const cv::Mat& depthOf(dataset::Index row);
  /// 1 sigma of its inverse, relative, as the backend declares it (see DepthEvaluationOptions::depth).
  cv::Mat relativeStdOf(dataset::Index row);
  /// The true one of a simulated dataroot, m.
  const cv::Mat& trueDepth(dataset::Index row);

  /// Is there a LIDAR_TOP sweep on disk that goes with the image?
  bool hasLidar(dataset::Index row) const { return lidarOf(row) != nullptr; }
  /// Depth of the points held out from the backend, m; NaN elsewhere. @throws dataset::DatasetError.
  cv::Mat heldOutDepth(dataset::Index row) const;

 protected:
  /// How an image follows from the previous one, for depth that needs it; none where that is not known.
  virtual std::optional<MotionDepthInput::Step> stepTo(dataset::Index /*previous*/, dataset::Index /*row*/) {
    return std::nullopt;
  }
  std::filesystem::path truthFile(const std::string& folder, dataset::Index row) const;
  cv::Size sizeOf(dataset::Index row) const;
  /// True pose of the base at `end`, in its frame at `begin`.
  Eigen::Isometry3d trueMotion(double begin, double end) const {
    return radar_.truth.at(begin).inverse() * radar_.truth.at(end);
  }

 private:
  enum class LidarPart { kAll, kSeen, kHeldOut };
  cv::Mat computeDepth(dataset::Index row);
  DepthInput inputOf(dataset::Index row);  // of the estimator
  bool follows() const { return depth_ && depth_->needs().motion; }
  void followTo(dataset::Index row);
  bool seesRadar(const std::string& channel) const;
  std::vector<Eigen::Vector3f> radarPoints(double time);
  const dataset::SampleData* lidarOf(dataset::Index row) const;
  std::vector<Eigen::Vector3f> lidarPoints(dataset::Index row, LidarPart part) const;

  const dataset::Tables& tables_;
  const RadarScene& radar_;
  DepthSource source_;
  std::optional<FileSource> file_source_;  // none: the estimator
  std::unique_ptr<DepthEstimator> depth_;
  std::vector<std::vector<std::vector<ReturnLabel>>> labels_;  // as returnLabels(); none where not needed
  std::map<dataset::Index, cv::Mat> pictures_, depths_, true_depths_;
  std::map<dataset::Index, cv::Mat> stds_;    // of depths_, by an estimator that follows images
  dataset::Index followed_ = dataset::kNone;  // the latest image it has seen
};

}  // namespace radar_dot::evaluation
