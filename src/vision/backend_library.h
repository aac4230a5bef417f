// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace radar_dot {

/// Loads `libradar_dot_backend_<name>.so`, which registers backends of that name when it is loaded: from the
/// folder of this library, else from where the loader looks (LD_LIBRARY_PATH). Never unloaded.
/// @return why it is not there, as the end of a sentence, beginning with "; "; or nothing.
std::string loadBackendLibrary(const std::string& name);

}  // namespace radar_dot
