// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <functional>
#include <memory>

namespace radar_dot {
class InUse;
}

namespace radar_dot::dataset {

/// A folder that is made under a hidden name beside its own, and takes its place once it is complete.
class StagedFolder {
 public:
  /// Says whether a folder that is in the way may be deleted, by throwing where it may not.
  using Guard = std::function<void(const std::filesystem::path&)>;

  /// Makes the hidden folder. A folder that is in the way may be empty, or else must pass the guard, now
  /// and in commit().
  /// @throws DatasetError naming the path, also where it is no folder or cannot be made.
  StagedFolder(const std::filesystem::path& output, Guard guard);
  /// Without commit() nothing stays behind but of a process that is killed, and that goes with the next
  /// folder of this name.
  ~StagedFolder();
  StagedFolder(const StagedFolder&) = delete;
  StagedFolder& operator=(const StagedFolder&) = delete;

  const std::filesystem::path& path() const noexcept { return partial_; }

  /// Gives the folder its name; a folder that was in the way is deleted after that.
  /// @throws DatasetError naming the path; the folder that was in the way is then still there.
  void commit();

 private:
  bool isOccupied() const;
  void clearUp() const;
  std::filesystem::path moveIn() const;

  std::filesystem::path output_, partial_;
  Guard guard_;
  std::unique_ptr<InUse> in_use_;
  bool committed_ = false;
};

}  // namespace radar_dot::dataset
