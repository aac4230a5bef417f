// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "radar_dot/common/fields.h"
#include "radar_dot/vision/depth_estimator.h"
#include "radar_dot/vision/optical_flow.h"

// What several evaluators read, each option declared once.

namespace radar_dot::evaluation {

/// Where flow or depth come from besides the backends of makeOpticalFlow and makeDepthEstimator.
enum class FileSource { kGroundTruth, kNoisy, kFiles };
/// None: the name of a backend.
std::optional<FileSource> fileSourceOf(const std::string& backend);

/// Makes a backend once, so that one that cannot be made is refused before the data are read.
/// @throws std::invalid_argument, as makeDepthEstimator and makeOpticalFlow
void checkBackend(const DepthParams& params);
void checkBackend(const OpticalFlowParams& params);

/// Which images make a pair.
enum class ImagePairs { kKeyframes, kNext };

/// Radars of the scene that are used.
inline void describeRadarChannels(std::vector<std::string>& channels, FieldList& fields) {
  fields.add("radar_channels", channels,
             "Radars that are used, as in RADAR_FRONT,RADAR_BACK_LEFT; empty: all");
}
inline void describeCamera(std::string& channel, FieldList& fields) {
  fields.add("camera", channel, "Channel of the camera");
}

/// Pairs of images, and their flow where it comes from files.
struct PairOptions {
  std::string camera = "CAM_FRONT";
  ImagePairs pairs = ImagePairs::kKeyframes;
  std::size_t max_pairs = 0;
  std::string flow_directory;

  void describe(FieldList& fields);
};

/// What depth looks at besides the image.
struct DepthInputOptions {
  std::string depth_directory;
  std::vector<std::string> depth_radar_channels;

  void describe(FieldList& fields);
};

/// Saved masks as an input.
struct SavedMaskOptions {
  std::string directory;
  std::string channel = "CAM_FRONT";
  double delay = 0.0;

  void describe(FieldList& fields);
};

}  // namespace radar_dot::evaluation

namespace radar_dot {

template <>
struct EnumNames<evaluation::FileSource> {
  static constexpr EnumName<evaluation::FileSource> kValues[] = {
      {evaluation::FileSource::kGroundTruth, "ground_truth"},
      {evaluation::FileSource::kNoisy, "noisy"},
      {evaluation::FileSource::kFiles, "files"}};
};

template <>
struct EnumNames<evaluation::ImagePairs> {
  static constexpr EnumName<evaluation::ImagePairs> kValues[] = {
      {evaluation::ImagePairs::kKeyframes, "keyframes", "a keyframe and the next one, as in the paper"},
      {evaluation::ImagePairs::kNext, "next", "a keyframe and the image after it"}};
};

}  // namespace radar_dot
