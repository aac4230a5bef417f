// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace radar_dot::bag {

/// Are the lengths and places in a bag those of its records? rosbag believes them: it allocates what a length
/// says, and reads beyond the end of a header that is shorter than its fields. In compressed chunks only
/// their size and what the index says of them is checked. Files of other versions, and recordings that were
/// not ended, are left to rosbag.
/// @throw std::runtime_error where not, with the byte.
void checkBagRecords(const std::filesystem::path& path);

}  // namespace radar_dot::bag
