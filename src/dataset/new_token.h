// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

namespace radar_dot::dataset {

/// The token of a row: 32 hexadecimal digits that depend on nothing but the row's name, e.g. {"sample",
/// "scene-0001", "1532402927647951"}.
std::string newToken(std::initializer_list<std::string_view> name);

}  // namespace radar_dot::dataset
