// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/evaluation_inputs.h"

namespace radar_dot::evaluation {

std::optional<FileSource> fileSourceOf(const std::string& backend) {
  for (const EnumName<FileSource>& each : EnumNames<FileSource>::kValues)
    if (backend == each.name) return each.value;
  return std::nullopt;
}

void checkBackend(const DepthParams& params) {
  if (!fileSourceOf(params.backend)) makeDepthEstimator(params);
}

void checkBackend(const OpticalFlowParams& params) {
  if (!fileSourceOf(params.backend)) makeOpticalFlow(params);
}

void PairOptions::describe(FieldList& fields) {
  describeCamera(camera, fields);
  fields.add("pairs", pairs, "Which images make a pair");
  fields.add("max_pairs", max_pairs, "Number of pairs of each scene, the first ones; 0: all");
  fields.add("flow_directory", flow_directory,
             "Folder of 16-bit PNG flows (KITTI), named after the first image, for flow_backend files");
}

void DepthInputOptions::describe(FieldList& fields) {
  fields.add(
      "depth_directory", depth_directory,
      "Folder of 16-bit PNG depths (m * 256, 0: unknown), named after the image, for depth_backend files");
  fields.add("depth_radar_channels", depth_radar_channels,
             "Radars that depth sees; empty: RADAR_FRONT for depth_backend torch, whose networks are trained "
             "with it, otherwise all");
}

void SavedMaskOptions::describe(FieldList& fields) {
  fields.add("saved_masks", directory, "Folder of masks that evaluate_segmentation saved");
  fields.add("mask_channel", channel, "Channel of the camera of the masks");
  fields.add("mask_delay", delay,
             "Time from an image until its mask is available; 0.5 is what a vehicle has with pairs of "
             "keyframes, with 0 a mask is used before its second image was taken",
             "s", {0.0, 1000.0});
}

}  // namespace radar_dot::evaluation
