// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "staged_folder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <string>
#include <system_error>
#include <utility>

#include "common/leftovers.h"
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

constexpr std::string_view kPartial = "partial", kReplaced = "replaced";

std::string prefixOf(const fs::path& folder, std::string_view purpose) {
  return fmt::format(".{}.{}-", folder.filename().string(), purpose);
}

fs::path hiddenSibling(const fs::path& folder, std::string_view purpose) {
  return folder.parent_path() / fmt::format("{}{}", prefixOf(folder, purpose), ::getpid());
}

}  // namespace

StagedFolder::StagedFolder(const fs::path& output, Guard guard)
    : output_(resolve(output)), partial_(hiddenSibling(output_, kPartial)), guard_(std::move(guard)) {
  clearUp();
  if (isOccupied()) guard_(output_);
  std::error_code error;
  fs::create_directories(output_.parent_path(), error);
  if (error) fail(output_.parent_path(), "make this folder", error);
  // One that could not be locked, of a process that was killed and whose number has come round.
  fs::remove_all(partial_, error);
  if (!error) fs::create_directory(partial_, error);
  if (error) fail(partial_, "make this folder", error);
  in_use_ = std::make_unique<InUse>(partial_);
}

StagedFolder::~StagedFolder() {
  std::error_code ignored;
  if (!committed_) fs::remove_all(partial_, ignored);
}

/// What processes that were killed have left, among it a folder that was about to be replaced.
void StagedFolder::clearUp() const {
  std::error_code ignored;
  for (const fs::path& replaced : leftoversIn(output_.parent_path(), prefixOf(output_, kReplaced)))
    if (!fs::exists(output_, ignored)) fs::rename(replaced, output_, ignored);
  for (const std::string_view purpose : {kPartial, kReplaced})
    removeLeftovers(output_.parent_path(), prefixOf(output_, purpose));
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
  fs::path old = partial_;
  if (::renameat2(AT_FDCWD, partial_.c_str(), AT_FDCWD, output_.c_str(), RENAME_EXCHANGE) != 0)
    old = moveIn();
  committed_ = true;
  fs::remove_all(old, error);
  if (error) fail(old, "delete the folder that was replaced, although the new one is in its place", error);
}

/// Where a file system cannot exchange two folders at once. @return where the old one is
fs::path StagedFolder::moveIn() const {
  std::error_code error;
  fs::path old = hiddenSibling(output_, kReplaced);
  fs::rename(output_, old, error);
  if (error) fail(output_, "move this folder out of the way", error);
  fs::rename(partial_, output_, error);
  if (error) {
    std::error_code ignored;
    fs::rename(old, output_, ignored);
    fail(output_, "give the new folder this name", error);
  }
  return old;
}

}  // namespace radar_dot::dataset
