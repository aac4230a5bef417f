// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "fixtures/tool_run.h"

namespace radar_dot::test {

/// Simulates a scene with these options of simulate_drive below `folder`, in drive/, and converts it.
/// @return the bag
inline std::filesystem::path simulatedBag(const std::filesystem::path& folder, const std::string& scene,
                                          const std::string& options) {
  const std::string drive = (folder / "drive").string();
  for (const std::string& command :
       {std::string(SIMULATOR) + " --output " + drive + " --lidar-rate 2 --ground-truth keyframes " + options,
        std::string(CONVERTER) + " --dataroot " + drive + " --version v1.0-sim --output " +
            folder.string()}) {
    const Outcome outcome = runCommand(command);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.text;
  }
  return folder / (scene + ".bag");
}

}  // namespace radar_dot::test
