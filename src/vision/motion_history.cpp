// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/motion_history.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "parallel_rows.h"
#include "radar_dot/vision/motion_terms.h"
#include "radar_dot/vision/rigid_motion.h"

namespace radar_dot {

MotionInput seenFromSecond(const MotionInput& pair, const cv::Mat& flow, const cv::Mat& fb_error) {
  MotionInput seen;
  seen.camera = pair.camera;
  seen.pixel_scale = pair.pixel_scale;
  seen.T_current_from_previous = pair.T_current_from_previous.inverse();
  seen.duration = -pair.duration;
  // inv(D T) = (inv(T) inv(D) T) inv(T): a small motion after T is one after inv(T), of points that T took
  // along, and as uncertain.
  seen.motion_covariance = cameraCovariance(pair.T_current_from_previous, pair.motion_covariance);
  seen.flow = flow;
  seen.fb_error = fb_error;
  seen.depth = pair.next_depth;
  seen.next_depth = pair.depth;
  return seen;
}

MotionInput previousPairFromFirst(const MotionInput& pair, const MotionInput& pair_before,
                                  const cv::Mat& flow_back, const cv::Mat& fb_error) {
  MotionInput seen = seenFromSecond(pair_before, flow_back, fb_error);
  seen.grey = pair.grey;
  seen.second_grey = pair_before.grey;
  seen.depth = pair.depth;
  seen.depth_std = pair.depth_std;
  seen.ground = pair.ground;
  seen.texture_std = pair.texture_std;
  seen.dynamic_points = pair.dynamic_points;
  seen.static_points = pair.static_points;
  return seen;
}

cv::Mat logOdds(const MotionResult& result) {
  const auto tau = static_cast<float>(result.threshold);
  const auto over_scale = static_cast<float>(1.0 / result.scale);
  cv::Mat odds(result.score.size(), CV_32FC1);
  parallelRows(odds.rows, [&](int row) {
    const float* scores = result.score.ptr<float>(row);
    float* out = odds.ptr<float>(row);
    for (int column = 0; column < odds.cols; ++column) {
      // In this order the bounds leave NaN as it is.
      out[column] = std::max(std::min((scores[column] - tau) * over_scale, kMaxLogOdds), -kMaxLogOdds);
    }
  });
  return odds;
}

cv::Mat carriedBelief(const cv::Mat& log_odds, const cv::Mat& flow_back, double share) {
  if (log_odds.type() != CV_32FC1 || flow_back.type() != CV_32FC2 || log_odds.size() != flow_back.size() ||
      log_odds.rows < 2 || log_odds.cols < 2) {
    throw std::invalid_argument(
        "belief: log_odds must be CV_32FC1 and flow_back CV_32FC2, of the same size, 2 x 2 px or more");
  }
  const motion_terms::FloatImage before(log_odds);
  const auto left = static_cast<float>(share);
  cv::Mat carried(log_odds.size(), CV_32FC1);
  parallelRows(carried.rows, [&](int row) {
    const auto* flow = flow_back.ptr<cv::Vec2f>(row);
    float* out = carried.ptr<float>(row);
    for (int column = 0; column < carried.cols; ++column) {
      out[column] = left * motion_terms::bilinear(before, static_cast<float>(column) + flow[column][0],
                                                  static_cast<float>(row) + flow[column][1]);
    }
  });
  return carried;
}

cv::Mat uncoveredPixels(const MotionInput& before, const cv::Mat& log_odds, const cv::Mat& depth,
                        const FlowDepthNoise& noise) {
  if (before.fb_error.empty()) return {};
  constexpr float kUnclosed = 0.5F;    // share of the motion by which flow must not fail to close
  constexpr float kDeviations = 3.0F;  // of two flows, which is noise
  constexpr float kTooFar = 0.8F;      // of what hides; it may be drawn farther away than it is
  const auto noise_of_two = static_cast<float>(kDeviations * std::sqrt(2.0));
  const auto flow_std = static_cast<float>(noise.flow_std / before.pixel_scale);
  const auto flow_std_relative = static_cast<float>(noise.flow_std_relative);
  const motion_terms::PixelMotion motion(before.camera, before.T_current_from_previous);
  const auto last_u = static_cast<float>(log_odds.cols - 1), last_v = static_cast<float>(log_odds.rows - 1);
  cv::Mat uncovered(log_odds.size(), CV_8UC1);
  parallelRows(uncovered.rows, [&](int row) {
    const auto* flows = before.flow.ptr<cv::Vec2f>(row);
    const float* errors = before.fb_error.ptr<float>(row);
    const float* depths = before.depth.ptr<float>(row);
    auto* out = uncovered.ptr<std::uint8_t>(row);
    const auto v = static_cast<float>(row);
    for (int column = 0; column < uncovered.cols; ++column) {
      out[column] = 0;
      const cv::Vec2f& flow = flows[column];
      // An error that is NaN, where the flow back leads out of the image, closes nothing.
      const float noise_px = flow_std + flow_std_relative * std::sqrt(flow.dot(flow));
      if (errors[column] <= noise_of_two * noise_px) continue;
      const auto u = static_cast<float>(column);
      const motion_terms::Prediction there = motion_terms::predict(motion, u, v, depths[column]);
      if (!(there.depth > 0.0F && there.u >= 0.0F && there.v >= 0.0F && there.u <= last_u &&
            there.v <= last_v))
        continue;
      const float moves = std::hypot(u + flow[0] - there.u, v + flow[1] - there.v);
      if (errors[column] <= kUnclosed * moves) continue;
      const int to_u = static_cast<int>(there.u + 0.5F), to_v = static_cast<int>(there.v + 0.5F);
      const bool is_behind = !(kTooFar * depth.at<float>(to_v, to_u) > there.depth);
      if (log_odds.at<float>(to_v, to_u) > 0.0F && is_behind) out[column] = 255;
    }
  });
  return uncovered;
}

double forgetting(double dt, double memory) { return memory > 0.0 ? std::exp(-std::abs(dt) / memory) : 0.0; }

}  // namespace radar_dot
