// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <deque>
#include <memory>
#include <string>

#include "nodelets/common/stream_nodelet.h"
#include "nodelets/inputs/ego_motion.h"
#include "nodelets/inputs/moment.h"
#include "nodelets/inputs/pair_pace.h"
#include "nodelets/inputs/stamp_cache.h"
#include "radar_dot/config/sections.h"

namespace radar_dot {

/// Optical flow between images of one camera, consecutive or a given time apart.
///
/// Only the latest pair is worked on: a slower machine gets pairs that lie farther apart (PairPace), not
/// later ones.
class OpticalFlowNodelet : public ConfiguredNodelet<OpticalFlowConfig> {
 private:
  using SharedImage = std::shared_ptr<LazyImage>;
  /// In the order of the flow: it lies on the grid of `first`.
  struct Pair {
    SharedImage first, second;
    Moment arrival;
  };

  void setUp() override;
  bool hasAudience() const override;
  void apply(const OpticalFlowConfig& config) override;
  void clearHistory() override;
  void report(diagnostic_updater::DiagnosticStatusWrapper& status) override;

  void onImage(LazyImage picture);
  /// Is it known that the vehicle stands?
  bool stands(const ros::Time& stamp) const;
  /// Has the first waiting pair looked at, `delay` s from now.
  void scheduleQueue(double delay);
  double leastInterval() const { return pace_.leastInterval(config_.pair_interval, config_.max_pair_gap); }
  /// Computes the first waiting pair, when what it starts from is there or has been waited for long enough.
  void processQueue();
  /// Flow of a static world; empty, with the reason in `missing`, when something is not there (yet).
  cv::Mat expectedFlowOf(const Pair& pair, bool within_timeout, std::string& missing);
  void compute(const Pair& pair, const cv::Mat& expected);
  const cv::Mat& pixelsOf(LazyImage& picture) const;

  std::unique_ptr<OpticalFlow> flow_;  // none: no backend could be made
  SharedImage latest_, previous_;      // image, and the one of the latest pair
  PairPace pace_;
  std::deque<Pair> waiting_;
  std::size_t repeated_ = 0, repeated_since_report_ = 0;  // images

  // For initialisation "expected".
  std::unique_ptr<EgoMotion> motion_;
  StampCache<sensor_msgs::Image> depths_;
  sensor_msgs::CameraInfoConstPtr camera_;

  InputMonitor *image_ = nullptr, *depth_input_ = nullptr, *camera_input_ = nullptr;
  ros::Publisher publisher_, backward_publisher_;
  ProcessTimer compute_timer_;

  // s, of the latest pair
  double interval_ = 0.0, computation_time_ = 0.0, latency_ = 0.0;
  double waiting_time_ = 0.0, decoding_time_ = 0.0, backward_time_ = 0.0;
  std::size_t computed_ = 0, replaced_ = 0, apart_ = 0, without_start_ = 0;
};

}  // namespace radar_dot
