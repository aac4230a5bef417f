// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "radar_dot/evaluation/ego_velocity_evaluation.h"

namespace radar_dot::evaluation {

/// Plain-text tables for a terminal; the last row is the overall result.
std::string formatTable(const std::vector<VelocityReport>& scenes, const VelocityReport& overall);

/// {"scenes": [{"scene", "frames", "refused", "mae", "models", "trajectory", "dynamic", ...}],
/// "overall": {same keys}}; figures that do not exist are null.
std::string formatJson(const std::vector<VelocityReport>& scenes, const VelocityReport& overall);

/// One line per scene and one "overall", the same figures as columns.
std::string formatCsv(const std::vector<VelocityReport>& scenes, const VelocityReport& overall);

/// Writes text to a file by way of a temporary one beside it, so that a failure leaves the old file, or
/// none. Links are followed; devices and pipes are written to directly.
/// @throws std::runtime_error naming the path.
void writeFile(const std::string& path, const std::string& text);

}  // namespace radar_dot::evaluation
