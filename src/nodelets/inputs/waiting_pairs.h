// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/Image.h>

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "nodelets/inputs/stamp_cache.h"
#include "nodelets/inputs/waiting_queue.h"
#include "radar_dot/Flow.h"

namespace radar_dot {

/// Flows that wait for the depths at the stamps of their two images, and for whatever else a mask needs.
class WaitingPairs {
 public:
  /// The messages own the pixels.
  struct Pair {
    FlowConstPtr flow;
    sensor_msgs::ImageConstPtr depth, next_depth, depth_std;  ///< the last two where they came
  };
  using Taken = WaitingQueue<Pair>::Taken;
  struct Needs {
    bool next_depth = true, depth_std = false;
    double timeout = 0.5;     ///< s
    std::string depth_topic;  ///< for what is missing
  };
  /// What else a pair lacks, empty: nothing. @param waited  s, infinite from the timeout on
  using Rest = std::function<std::string(const Pair& pair, double waited)>;

  void addFlow(FlowConstPtr flow, const Moment& now) { waiting_.add({std::move(flow), {}, {}, {}}, now); }
  void addDepth(sensor_msgs::ImageConstPtr depth) { depths_.add(std::move(depth)); }
  void addDepthStd(sensor_msgs::ImageConstPtr depth_std) { depth_stds_.add(std::move(depth_std)); }
  void clear();
  void clearDepthStds() { depth_stds_.clear(); }
  std::size_t size() const { return waiting_.size(); }

  /// The first pair, where it is complete or lacks what will not come in time. Depths that no later pair can
  /// need are dropped.
  std::optional<Taken> take(const Needs& needs, const Moment& now, const Rest& rest);

 private:
  WaitingQueue<Pair>::Lack lackOf(Pair& pair, const Needs& needs, double waited) const;

  WaitingQueue<Pair> waiting_;
  StampCache<sensor_msgs::Image> depths_, depth_stds_;
};

}  // namespace radar_dot
