// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "radar_dot/dataset/token.h"

namespace radar_dot::dataset {

/// Finds the row of a table by its token: an open-addressing hash of row numbers, six to twelve
/// bytes a row. The tokens themselves stay in the rows, so an index belongs to the rows it was
/// built from and each call is given them.
class TokenIndex {
 public:
  /// Indexes all rows. Returns the first row whose token an earlier row has, or -1.
  template <typename Row>
  std::int32_t build(const std::vector<Row>& rows) {
    std::size_t capacity = 16;
    while (2 * capacity < 3 * rows.size()) capacity *= 2;
    slots_.assign(capacity, kFree);
    for (std::size_t row = 0; row < rows.size(); ++row) {
      std::int32_t& slot = slots_[slotOf(rows, rows[row].token)];
      if (slot != kFree) return static_cast<std::int32_t>(row);
      slot = static_cast<std::int32_t>(row);
    }
    return -1;
  }

  /// Row with this token, or -1.
  template <typename Row>
  std::int32_t find(const std::vector<Row>& rows, Token token) const noexcept {
    return slots_.empty() ? kFree : slots_[slotOf(rows, token)];
  }

 private:
  static constexpr std::int32_t kFree = -1;

  /// The slot that holds the token, or the free one where it belongs.
  template <typename Row>
  std::size_t slotOf(const std::vector<Row>& rows, Token token) const noexcept {
    const std::size_t mask = slots_.size() - 1;
    // Interned tokens differ in their lowest bits only: spread them.
    std::uint64_t hash = std::hash<Token>{}(token)*0xff51afd7ed558ccdULL;
    hash ^= hash >> 32;
    std::size_t slot = static_cast<std::size_t>(hash) & mask;
    while (slots_[slot] != kFree && rows[static_cast<std::size_t>(slots_[slot])].token != token)
      slot = (slot + 1) & mask;
    return slot;
  }

  std::vector<std::int32_t> slots_;
};

}  // namespace radar_dot::dataset
