// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "staged_folder.h"

#include <fmt/format.h>
#include <unistd.h>

#include <string>
#include <system_error>
#include <utility>

#include "radar_dot/dataset/tables.h"

namespace radar_dot::dataset {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail(const fs::path& path, std::string_view action, const std::error_code& cause) {
  throw DatasetError(fmt::format("{}: cannot {}: {}", path.string(), action, cause.message()));
}

/// Absolute and without links, so that the folder beside it is on the same file system.
fs::path resolve(const fs::path& output) {
  std::error_code error;
  fs::path resolved = fs::weakly_canonical(fs::absolute(output), error);
  if (error) fail(output, "use this as output", error);
  // "folder/" names the folder.
  if (!resolved.has_filename()) resolved = resolved.parent_path();
  if (!resolved.has_filename())
    throw DatasetError(fmt::format("{}: no name for the output folder", output.string()));
  return resolved;
}

fs::path hiddenSibling(const fs::path& folder, std::string_view purpose) {
  const std::string name = folder.filename().string();
  return folder.parent_path() / fmt::format(".{}.{}-{}", name, purpose, ::getpid());
}

}  // namespace

StagedFolder::StagedFolder(const fs::path& output, Guard guard)
    : output_(resolve(output)), partial_(hiddenSibling(output_, "partial")), guard_(std::move(guard)) {
  if (isOccupied()) guard_(output_);
  std::error_code error;
  fs::create_directories(output_.parent_path(), error);
  if (error) fail(output_.parent_path(), "make this folder", error);
  // Only a process that was killed leaves one, and its number has come round.
  fs::remove_all(partial_, error);
  if (!error) fs::create_directory(partial_, error);
  if (error) fail(partial_, "make this folder", error);
}

StagedFolder::~StagedFolder() {
  std::error_code ignored;
  if (!committed_) fs::remove_all(partial_, ignored);
}

bool StagedFolder::isOccupied() const {
  std::error_code error;
  const fs::file_status status = fs::symlink_status(output_, error);
  if (status.type() == fs::file_type::not_found) return false;
  if (status.type() != fs::file_type::directory)
    throw DatasetError(fmt::format("{}: is in the way and no folder", output_.string()));
  const bool is_empty = fs::is_empty(output_, error);
  if (error) fail(output_, "look into this folder", error);
  return !is_empty;
}

void StagedFolder::commit() {
  std::error_code error;
  if (!isOccupied()) {
    // Replaces an empty folder, and fails should it have been filled in between.
    fs::rename(partial_, output_, error);
    if (error) fail(output_, "give the new folder this name", error);
    committed_ = true;
    return;
  }
  guard_(output_);
  const fs::path old = hiddenSibling(output_, "replaced");
  fs::rename(output_, old, error);
  if (error) fail(output_, "move this folder out of the way", error);
  fs::rename(partial_, output_, error);
  if (error) {
    std::error_code ignored;
    fs::rename(old, output_, ignored);
    fail(output_, "give the new folder this name", error);
  }
  committed_ = true;
  fs::remove_all(old, error);
  if (error) fail(old, "delete the folder that was replaced, although the new one is in its place", error);
}

}  // namespace radar_dot::dataset
