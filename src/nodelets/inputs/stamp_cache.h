// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>

#include <algorithm>
#include <boost/shared_ptr.hpp>
#include <cmath>
#include <cstddef>
#include <deque>
#include <utility>

namespace radar_dot {

/// The latest messages of a topic, found again by their exact stamp.
template <typename Message>
class StampCache {
 public:
  using Pointer = boost::shared_ptr<const Message>;
  /// @param span  s of stamps that are kept   @param capacity  messages that are kept, whatever their stamps
  explicit StampCache(double span = 4.0, std::size_t capacity = 100) : span_(span), capacity_(capacity) {}

  /// Holds from the next message on.
  void setSpan(double span) noexcept { span_ = span; }
  void add(Pointer message) {
    const double newest = message->header.stamp.toSec();
    messages_.push_back(std::move(message));
    while (messages_.size() > capacity_ || newest - messages_.front()->header.stamp.toSec() > span_)
      messages_.pop_front();
  }
  /// Null when there is none.
  Pointer find(const ros::Time& stamp) const {
    for (auto message = messages_.rbegin(); message != messages_.rend(); ++message)
      if ((*message)->header.stamp == stamp) return *message;
    return {};
  }
  /// The nearest in time; null when there is none at all.
  Pointer nearest(const ros::Time& stamp) const {
    const auto apart = [&stamp](const Pointer& message) {
      return std::abs(message->header.stamp.toSec() - stamp.toSec());
    };
    const auto found =
        std::min_element(messages_.begin(), messages_.end(),
                         [&](const Pointer& a, const Pointer& b) { return apart(a) < apart(b); });
    return found == messages_.end() ? Pointer() : *found;
  }
  /// True where a later message was added: one with this stamp will not come any more on an ordered topic.
  bool isPast(const ros::Time& stamp) const {
    return !messages_.empty() && messages_.back()->header.stamp > stamp;
  }
  /// Forgets the messages before a stamp, but the latest, which isPast() needs.
  void dropBefore(const ros::Time& stamp) {
    while (messages_.size() > 1 && messages_.front()->header.stamp < stamp) messages_.pop_front();
  }
  void clear() { messages_.clear(); }
  bool empty() const noexcept { return messages_.empty(); }

 private:
  double span_;
  std::size_t capacity_;
  std::deque<Pointer> messages_;
};

}  // namespace radar_dot
