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

namespace radar_dot {

void replaceFile(const std::string& path, const std::string& text) {
  namespace fs = std::filesystem;
  const auto fail = [&](const std::string& cause) {
    throw std::runtime_error(fmt::format("{}: cannot be written: {}", path, cause));
  };
  if (path.empty()) fail("the name is empty");
  // A link is followed to the file it means; a device or pipe is written to, never replaced.
  std::error_code error;
  const fs::path target = fs::is_symlink(path, error) ? fs::weakly_canonical(path, error) : fs::path(path);
  if (fs::is_directory(target, error)) fail("it is a folder");
  const bool in_place = fs::exists(target, error) && !fs::is_regular_file(target, error);

  std::string name = in_place ? target.string() : target.string() + ".XXXXXX";
  const int descriptor = in_place ? ::open(name.c_str(), O_WRONLY | O_CLOEXEC) : ::mkstemp(name.data());
  if (descriptor < 0) fail(std::generic_category().message(errno));
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
  fail(std::generic_category().message(cause));
}

}  // namespace radar_dot
