// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "result_files.h"

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

#include "parameter_document.h"

namespace radar_dot::tools {
namespace {

/// By way of a temporary file beside it, so that a failure leaves the old file, or none. Links are followed;
/// devices and pipes are written to directly. @throws std::runtime_error naming the path
void writeFile(const std::string& path, const std::string& text) {
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

}  // namespace

void ResultFiles::describe(FieldList& fields) {
  fields.group("Output");
  fields.add("json", json,
             "JSON file for the results and all parameters in force; --config takes it to repeat the run");
  fields.add("csv", csv, "CSV file for the results");
}

void ResultFiles::check() const {
  require(json.empty() || json != csv, fieldsOf(*this), {&json, &csv}, "they must differ");
}

void ResultFiles::write(const std::string& parameters, const std::string& json_text,
                        const std::string& csv_text, const std::string& table) const {
  if (!json.empty()) writeFile(json, withParameters(json_text, parameters));
  if (!csv.empty()) writeFile(csv, csv_text);
  if (std::fwrite(table.data(), 1, table.size(), stdout) != table.size() || std::fflush(stdout) != 0)
    throw std::runtime_error("the table cannot be written to standard output");
}

}  // namespace radar_dot::tools
