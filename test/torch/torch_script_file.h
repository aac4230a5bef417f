// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <string>

namespace radar_dot::test {

/// Writes a TorchScript network without weights. @param forward  its method in TorchScript's Python
void writeTorchScript(const std::filesystem::path& file, const std::string& forward);

/// Networks whose results are known.
namespace networks {

/// The same flow everywhere, px of the images it gets.
std::string constantFlow(double u, double v);
/// Red of the first image as u, blue of the second as v.
std::string flowOfColours();
/// Depth of every pixel: that of the radar in its column, m.
std::string depthOfRadar();
/// Depth of every pixel: the largest of the radar, m.
std::string depthOfFarthestReturn();
/// Depth of every pixel: its red, 0 to 255, as m.
std::string depthOfRed();

}  // namespace networks
}  // namespace radar_dot::test
