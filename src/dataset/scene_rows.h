// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "json_table_writer.h"
#include "radar_dot/dataset/new_scene.h"

namespace radar_dot::dataset {

/// The tables that grow with every scene, open for writing.
struct SceneTables {
  explicit SceneTables(const std::filesystem::path& version_folder);
  void finish();

  JsonTableWriter calibrated_sensor, ego_pose, instance, log, nuinsseg, sample, sample_annotation,
      sample_data, scene;
};

std::string sensorToken(std::string_view channel);
std::string logToken(std::string_view log_name);

/// Appends all rows of a scene that checkScene has passed.
void writeSceneRows(const NewScene& scene, SceneTables& tables);

}  // namespace radar_dot::dataset
