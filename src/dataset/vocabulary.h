// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace radar_dot::dataset {

// The names that nuScenes gives to kinds of objects, to what they do and to how well they are seen.
// They are the same in every dataroot, and so are their tokens here.

bool isCategory(std::string_view name);
bool isAttribute(std::string_view name);
bool isVisibility(int level) noexcept;  ///< 1..4

std::string categoryToken(std::string_view name);
std::string attributeToken(std::string_view name);
std::vector<std::string> attributeTokens(const std::vector<std::string>& names);
/// The official tokens "1".."4": programs read the level from them.
std::string visibilityToken(int level);

/// category, attribute, visibility.
void writeVocabulary(const std::filesystem::path& version_folder);

}  // namespace radar_dot::dataset
