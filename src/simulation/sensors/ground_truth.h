// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <opencv2/core/mat.hpp>

#include "radar_dot/simulation/camera_sensor.h"

namespace radar_dot::simulation {

/// Depth along the optical axis of every pixel's centre: CV_32FC1, m; 0 where there is only sky.
cv::Mat depthTruth(const VisibleSurfaces& surfaces, const PinholeCamera& camera);

/// Number of the actor that each pixel's centre sees plus one: CV_16UC1; 0 = static or sky.
cv::Mat actorTruth(const VisibleSurfaces& surfaces, const Snapshot& snapshot);

/// 255 where a moving actor is seen ("*.moving" and "cycle.with_rider", as the dataset's masks are
/// merged), else 0: CV_8UC1.
cv::Mat motionTruth(const cv::Mat& actors, const World& world, double time_s);

/// Values of FlowTruth::occlusion.
enum : std::uint8_t {
  kVisibleInOther = 0,    ///< seen in the other image too
  kOutsideOther = 127,    ///< leaves the other image, or has no flow
  kOccludedInOther = 255  ///< something stands in front of it in the other image
};

struct FlowTruth {
  cv::Mat flow;       ///< CV_32FC2 px: where the surface point under the pixel's centre goes; NaN for sky
  cv::Mat occlusion;  ///< CV_8UC1
};

/// Optical flow from one image to another, of rigid bodies moved exactly, and whether each point is
/// still seen there, by a ray from the other camera.
FlowTruth flowTruth(const VisibleSurfaces& surfaces, const Snapshot& snapshot, const PinholeCamera& camera,
                    const Snapshot& other, const PinholeCamera& other_camera);

/// 16-bit PNG form of a depth image: m * 256, rounded; 0 = none or 256 m and more.
cv::Mat encodeDepth(const cv::Mat& depth);
/// KITTI's 16-bit PNG form of a flow: channels (in OpenCV's order) valid, v, u with value = flow * 64
/// + 2^15; invalid where NaN or beyond 511 px.
cv::Mat encodeFlow(const cv::Mat& flow);

}  // namespace radar_dot::simulation
