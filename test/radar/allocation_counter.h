// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace radar_dot::test {

/// Calls of operator new in this program so far. Linking allocation_counter.cpp replaces the global
/// operators.
std::size_t allocationCount() noexcept;

}  // namespace radar_dot::test
