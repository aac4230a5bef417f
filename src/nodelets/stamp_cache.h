// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <boost/shared_ptr.hpp>
#include <cstddef>
#include <deque>
#include <utility>

namespace radar_dot {

/// The latest messages of a topic, found again by their exact stamp.
template <typename Message>
class StampCache {
 public:
  using Pointer = boost::shared_ptr<const Message>;
  explicit StampCache(std::size_t capacity = 8) : capacity_(capacity) {}

  void add(Pointer message) {
    messages_.push_back(std::move(message));
    if (messages_.size() > capacity_) messages_.pop_front();
  }
  /// Null when there is none.
  Pointer find(const ros::Time& stamp) const {
    for (auto message = messages_.rbegin(); message != messages_.rend(); ++message)
      if ((*message)->header.stamp == stamp) return *message;
    return {};
  }
  void clear() { messages_.clear(); }
  bool empty() const noexcept { return messages_.empty(); }

 private:
  std::size_t capacity_;
  std::deque<Pointer> messages_;
};

}  // namespace radar_dot
