// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "radar_dot/dataset/tables.h"
#include "radar_dot/vision/mask_footprint.h"

namespace radar_dot::evaluation {

/// The saved masks of one camera in one scene: <stem of the image>.png in a folder.
class MaskFolder {
 public:
  /// @param delay  s, from an image to the time its mask is known
  /// @throws dataset::DatasetError naming the folder where it holds no mask of the scene, or the channel
  ///         where the scene has no image of it.
  MaskFolder(const dataset::Tables& tables, dataset::Index scene, const std::filesystem::path& folder,
             const std::string& channel, double delay);

  /// The newest mask known at `time` (s), good until the next call; null where there is none.
  /// @throws dataset::DatasetError naming a file that is no mask.
  const StampedMask* before(double time);

  std::size_t size() const noexcept { return entries_.size(); }
  /// Of the masks in time order: s, stamp of the image, and its row in sample_data.
  double timeOf(std::size_t index) const { return entries_[index].time; }
  dataset::Index rowOf(std::size_t index) const { return entries_[index].row; }
  /// The mask, good until the next call. @throws dataset::DatasetError naming a file that is no mask.
  const StampedMask& load(std::size_t index);

 private:
  struct Entry {
    double time = 0.0;  // s, of the image
    dataset::Index row = dataset::kNone;
    std::filesystem::path file;
  };
  const dataset::Tables& tables_;
  double delay_;
  std::vector<Entry> entries_;  // in time order
  std::optional<std::size_t> loaded_;
  StampedMask mask_;
};

}  // namespace radar_dot::evaluation
