// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <deque>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "nodelets/inputs/moment.h"

namespace radar_dot {

/// Messages that wait, in their order, for others that belong to them.
template <typename Item>
class WaitingQueue {
 public:
  static constexpr std::size_t kMaxWaiting = 4;  // at 12 Hz a third of a second
  /// @param max_waiting  items; where there are more the first has waited in vain
  explicit WaitingQueue(std::size_t max_waiting = kMaxWaiting) : max_waiting_(max_waiting) {}

  /// What an item lacks; nothing: it is complete.
  struct Lack {
    std::string missing;
    bool forever = false;  ///< it will not come
  };
  struct Taken {
    Item item;
    std::string missing;  ///< empty: it is complete
    Moment arrival;
  };

  void add(Item item, const Moment& now) { waiting_.push_back({std::move(item), now}); }
  void clear() { waiting_.clear(); }
  std::size_t size() const { return waiting_.size(); }

  /// The first item, where it is complete or has waited in vain; none: it still waits, or there is none.
  /// @param timeout  s
  /// @param lackOf   Lack(Item&, double waited), with s since its arrival, infinite from the timeout on
  template <typename LackOf>
  std::optional<Taken> take(double timeout, const Moment& now, const LackOf& lackOf) {
    if (waiting_.empty()) return std::nullopt;
    Waiting& front = waiting_.front();
    const bool is_over = !front.arrival.waits(timeout, now) || waiting_.size() > max_waiting_;
    const double waited = is_over ? std::numeric_limits<double>::infinity() : now.ros - front.arrival.ros;
    Lack lack = lackOf(front.item, waited);
    if (!lack.missing.empty() && !lack.forever && !is_over) return std::nullopt;
    Taken taken{std::move(front.item), std::move(lack.missing), front.arrival};
    waiting_.pop_front();
    return taken;
  }

 private:
  struct Waiting {
    Item item;
    Moment arrival;
  };
  std::size_t max_waiting_;
  std::deque<Waiting> waiting_;
};

}  // namespace radar_dot
