// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "radar_dot/config/section.h"

namespace radar_dot::tools {

/// All parameters as a configuration file with the values they have, which readConfigFile() reads back.
std::string parametersYaml(const std::vector<Section>& sections);

/// All parameters as tables, a chapter for each section.
std::string parametersMarkdown(const std::vector<Section>& sections);

}  // namespace radar_dot::tools
