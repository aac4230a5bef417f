// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace radar_dot {

/// Tells others that a file or folder that is not complete yet is being worked on, until this or its process
/// ends, in whatever way. Without effect on file systems that know no locks.
class InUse {
 public:
  explicit InUse(const std::filesystem::path& path);
  ~InUse();
  InUse(const InUse&) = delete;
  InUse& operator=(const InUse&) = delete;

 private:
  int descriptor_;
};

/// What processes that were killed have left in a folder: all whose name starts with `prefix` but what is
/// InUse.
std::vector<std::filesystem::path> leftoversIn(const std::filesystem::path& folder,
                                               const std::string& prefix);
/// Deletes it, as far as that can be done.
void removeLeftovers(const std::filesystem::path& folder, const std::string& prefix) noexcept;

}  // namespace radar_dot
