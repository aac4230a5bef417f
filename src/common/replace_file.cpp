// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "common/replace_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "common/leftovers.h"

namespace radar_dot {

namespace {

constexpr const char* kPartial = ".partial-";

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, const std::string& cause) {
  throw std::runtime_error(fmt::format("{}: cannot be written: {}", path, cause));
}

fs::path folderOf(const fs::path& file) { return file.has_parent_path() ? file.parent_path() : "."; }

/// What is written to for a path, and whether it is a device or pipe, which is never replaced.
std::pair<fs::path, bool> targetOf(const std::string& path) {
  if (path.empty()) fail(path, "the name is empty");
  // A link is followed to the file it means.
  std::error_code error;
  const fs::path target = fs::is_symlink(path, error) ? fs::weakly_canonical(path, error) : fs::path(path);
  if (fs::is_directory(target, error)) fail(path, "it is a folder");
  return {target, fs::exists(target, error) && !fs::is_regular_file(target, error)};
}

}  // namespace

void requireReplaceable(const std::string& path) {
  const auto [target, in_place] = targetOf(path);
  std::string name = target.string() + (in_place ? "" : std::string(kPartial) + "XXXXXX");
  // Opening a pipe would wait for its reader.
  const int descriptor = in_place ? ::access(name.c_str(), W_OK) : ::mkstemp(name.data());
  if (descriptor < 0) fail(path, std::generic_category().message(errno));
  if (in_place) return;
  ::close(descriptor);
  ::unlink(name.c_str());
}

void replaceFile(const std::string& path, const std::string& text) {
  const auto [target, in_place] = targetOf(path);
  if (!in_place) removeLeftovers(folderOf(target), target.filename().string() + kPartial);
  std::string name = target.string() + (in_place ? "" : std::string(kPartial) + "XXXXXX");
  const int descriptor = in_place ? ::open(name.c_str(), O_WRONLY | O_CLOEXEC) : ::mkstemp(name.data());
  if (descriptor < 0) fail(path, std::generic_category().message(errno));
  const InUse in_use(in_place ? "" : name);
  int cause = 0;
  for (std::size_t written = 0; written < text.size() && cause == 0;) {
    const ssize_t count = ::write(descriptor, text.data() + written, text.size() - written);
    if (count < 0 && errno != EINTR) cause = errno;
    if (count > 0) written += static_cast<std::size_t>(count);
  }
  if (!in_place && cause == 0 && ::fchmod(descriptor, 0644) != 0) cause = errno;
  if (::close(descriptor) != 0 && cause == 0) cause = errno;
  if (!in_place && cause == 0 && std::rename(name.c_str(), target.c_str()) != 0) cause = errno;
  if (cause == 0) return;
  if (!in_place) ::unlink(name.c_str());
  fail(path, std::generic_category().message(cause));
}

}  // namespace radar_dot
