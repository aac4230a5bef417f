// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace radar_dot {

/// Writes a file by way of a temporary one beside it, so that a failure leaves the old file, or none. Links
/// are followed; devices and pipes are written to directly. @throws std::runtime_error naming the path
void replaceFile(const std::string& path, const std::string& text);

/// Finds out beforehand what would keep replaceFile() from it. @throws std::runtime_error naming the path
void requireReplaceable(const std::string& path);

}  // namespace radar_dot
