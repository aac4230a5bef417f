// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "radar_dot/dataset/tables.h"

namespace radar_dot::bag {

/// A row of a table, by the signed number that the tables use.
template <typename Row>
const Row& at(const std::vector<Row>& table, dataset::Index index) {
  return table[static_cast<std::size_t>(index)];
}

}  // namespace radar_dot::bag
