// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace radar_dot::dataset {

/// "a, b, c" in alphabetical order; the rest of a long list is only counted. "none" for no names.
std::string sortedList(std::vector<std::string> names);

/// Checks that a dataroot holds a version with all the tables that are needed, before any of them is read.
/// @throws DatasetError naming what is missing and what is there.
void requireTables(const std::filesystem::path& dataroot, const std::string& version, bool with_annotations);

}  // namespace radar_dot::dataset
