// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <vector>

#include "radar_dot/dataset/instance_masks.h"
#include "radar_dot/dataset/tables.h"

namespace radar_dot::test {

/// The short simulated drive with all its ground truth that radar_dot_needs_simulated_dataroot() makes: scene
/// 0 with oncoming cars, scene 1 a car park in which nothing moves.
class SimulatedDataroot {
 public:
  /// @param dataroot  the drive itself, which tests share, or a copy
  explicit SimulatedDataroot(const std::filesystem::path& dataroot = SIMULATED_DATAROOT)
      : tables_(dataset::Tables::load(dataroot, {"v1.0-sim", {}})),
        masks_(dataset::readInstanceMasks(tables_)) {}

  const dataset::Tables& tables() const { return tables_; }
  std::vector<const dataset::InstanceMask*> masks() const {
    std::vector<const dataset::InstanceMask*> masks;
    for (const dataset::InstanceMask& mask : masks_) masks.push_back(&mask);
    return masks;
  }

 private:
  dataset::Tables tables_;
  std::vector<dataset::InstanceMask> masks_;
};

}  // namespace radar_dot::test
