// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

#include "radar_dot/dataset/new_scene.h"

namespace radar_dot::dataset {

/// Checks all of a scene that can be checked without other scenes, so that writing it can only fail
/// for reasons of the file system.
/// @throws std::invalid_argument "scene '...': reading 12: ...", numbers counted from 0.
void checkScene(const NewScene& scene);

/// A name that can be a folder or the beginning of a file name.
bool isPlainName(std::string_view name);

}  // namespace radar_dot::dataset
