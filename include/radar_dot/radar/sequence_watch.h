// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

namespace radar_dot {

/// Counts the messages of one topic that were lost before they arrived, by the sequence numbers that their
/// publisher gives them. Numbers that stay the same, go back, or leap say nothing: not all drivers count, and
/// a driver that restarts counts from zero again.
class SequenceWatch {
 public:
  static constexpr std::uint32_t kMaxLost = 1000;  ///< between two messages; more is a leap

  /// @return messages lost between the previous one and this
  std::size_t lostBefore(std::uint32_t seq) {
    // Also across the wrap to 0; what goes back leaps ahead.
    const std::uint32_t step = last_ ? seq - *last_ : 0;
    last_ = seq;
    return step > 1 && step - 1 <= kMaxLost ? step - 1 : 0;
  }

 private:
  std::optional<std::uint32_t> last_;
};

}  // namespace radar_dot
