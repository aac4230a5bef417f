// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "fixtures/files.h"
#include "fixtures/tool_run.h"
#include "radar_dot/dataset/instance_masks.h"
#include "radar_dot/dataset/tables.h"

namespace radar_dot::test {

/// A short simulated drive with all its ground truth: scene 0 with oncoming cars, scene 1 a car park in which
/// nothing moves.
class SimulatedDataroot {
 public:
  /// @param simulator  the program
  explicit SimulatedDataroot(const std::string& simulator)
      : tables_(load(simulator, folder_.path() / "dataroot")), masks_(dataset::readInstanceMasks(tables_)) {}

  const dataset::Tables& tables() const { return tables_; }
  std::vector<const dataset::InstanceMask*> masks() const {
    std::vector<const dataset::InstanceMask*> masks;
    for (const dataset::InstanceMask& mask : masks_) masks.push_back(&mask);
    return masks;
  }

 private:
  static dataset::Tables load(const std::string& simulator, const std::filesystem::path& dataroot) {
    const Outcome outcome =
        runCommand(simulator + " --output " + dataroot.string() +
                   " --scenarios oncoming,car_park --duration 2 --frames pairs --width 640 --height 360"
                   " --lidar-rate 2");
    if (outcome.exit_code != 0) throw std::runtime_error(outcome.text);
    dataset::LoadOptions options;
    options.version = "v1.0-sim";
    return dataset::Tables::load(dataroot, options);
  }

  TemporaryFolder folder_;
  dataset::Tables tables_;
  std::vector<dataset::InstanceMask> masks_;
};

}  // namespace radar_dot::test
