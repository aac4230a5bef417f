// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/waiting_pairs.h"

#include <algorithm>
#include <cmath>

namespace radar_dot {

void WaitingPairs::clear() {
  waiting_.clear();
  depths_.clear();
  depth_stds_.clear();
}

WaitingQueue<WaitingPairs::Pair>::Lack WaitingPairs::lackOf(Pair& pair, const Needs& needs,
                                                            double waited) const {
  const ros::Time first = pair.flow->header.stamp;
  const ros::Time second = pair.flow->second_stamp;
  if (!pair.depth) pair.depth = depths_.find(first);
  if (!pair.depth) {
    return {"no depth on '" + needs.depth_topic + "' at the time of the flow's first image",
            depths_.isPast(first)};
  }
  if (needs.next_depth && !pair.next_depth) pair.next_depth = depths_.find(second);
  // The flow alone can tell as well.
  const bool may_come =
      needs.next_depth && !pair.next_depth && !depths_.isPast(second) && std::isfinite(waited);
  if (may_come) return {"no depth on '" + needs.depth_topic + "' at the time of the flow's second image"};
  // It is sent just before its depth, so that it is there or lost.
  if (needs.depth_std) pair.depth_std = depth_stds_.find(first);
  return {};
}

std::optional<WaitingPairs::Taken> WaitingPairs::take(const Needs& needs, const Moment& now,
                                                      const Rest& rest) {
  std::optional<Taken> taken = waiting_.take(needs.timeout, now, [&](Pair& pair, double waited) {
    WaitingQueue<Pair>::Lack lack = lackOf(pair, needs, waited);
    if (lack.missing.empty()) lack.missing = rest(pair, waited);
    return lack;
  });
  if (!taken) return taken;
  const Flow& flow = *taken->item.flow;
  const ros::Time used = std::min(flow.header.stamp, flow.second_stamp);
  depths_.dropBefore(used);
  depth_stds_.dropBefore(used);
  return taken;
}

}  // namespace radar_dot
