// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>

#include "radar_dot/dataset/new_scene.h"

namespace radar_dot::dataset {

/// Makes a nuScenes dataroot: the 13 tables, nuinsseg.json, can_bus/ and a placeholder of the maps. Tokens
/// and files depend on nothing but the scenes, so the same scenes give the same bytes.
///
/// Everything is made in a hidden folder beside the output, `.<name>.partial-<process id>`, which gets the
/// output's name in finish(): whatever ends the program early, there is no dataroot that looks complete.
class DatarootWriter {
 public:
  /// @param output the dataroot; the folders above it are made
  /// @param version folder of the tables, e.g. "v1.0-sim"
  /// @param overwrite let finish() replace a dataroot of this version that a DatarootWriter made
  /// @throws DatasetError naming the path where the output holds anything and `overwrite` is not set, where
  ///         it holds anything else than such a dataroot, or where nothing can be written beside it;
  ///         std::invalid_argument for a version that is no plain name.
  DatarootWriter(const std::filesystem::path& output, const std::string& version, bool overwrite);
  /// Deletes the hidden folder unless finish() has succeeded.
  ~DatarootWriter();
  DatarootWriter(const DatarootWriter&) = delete;
  DatarootWriter& operator=(const DatarootWriter&) = delete;

  /// The hidden folder, where callers put samples/, sweeps/ and ground_truth/. It is the dataroot to which
  /// the file names of readings are relative.
  std::filesystem::path workFolder() const;

  /// Writes a scene's rows, masks and CAN messages; nothing of it is kept in memory. Empty masks, and
  /// instances without annotations, are left out.
  /// @throws std::invalid_argument naming scene and reading, annotation or mask for content that fits no
  ///         dataroot; the scene is then left out and the writer can go on. DatasetError naming a file that
  ///         cannot be written; the writer cannot go on.
  void add(const NewScene& scene);

  /// Completes the tables and gives the folder its name. Call once, after all add().
  /// @throws DatasetError naming the path; the output is then as it was before.
  void finish();

 private:
  class Content;
  std::unique_ptr<Content> content_;
};

/// Token that a DatarootWriter gives to instance number `instance` of the scene of this name.
std::string instanceToken(const std::string& scene_name, std::size_t instance);

}  // namespace radar_dot::dataset
