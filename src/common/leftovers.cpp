// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "common/leftovers.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <system_error>

namespace radar_dot {

namespace fs = std::filesystem;

namespace {

/// @return a descriptor with the lock, or -1
int lock(const fs::path& path, int kind) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
  if (descriptor < 0 || ::flock(descriptor, kind | LOCK_NB) == 0) return descriptor;
  ::close(descriptor);
  return -1;
}

}  // namespace

InUse::InUse(const fs::path& path) : descriptor_(lock(path, LOCK_SH)) {}

InUse::~InUse() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

std::vector<fs::path> leftoversIn(const fs::path& folder, const std::string& prefix) {
  std::vector<fs::path> found;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    if (entry->path().filename().string().rfind(prefix, 0) != 0) continue;
    const int descriptor = lock(entry->path(), LOCK_EX);
    if (descriptor < 0) continue;
    ::close(descriptor);
    found.push_back(entry->path());
  }
  return found;
}

void removeLeftovers(const fs::path& folder, const std::string& prefix) noexcept {
  std::error_code ignored;
  for (const fs::path& path : leftoversIn(folder, prefix)) fs::remove_all(path, ignored);
}

}  // namespace radar_dot
