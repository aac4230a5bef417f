// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rapidjson/document.h>

#include <array>
#include <string>
#include <utility>

#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "report_format.h"

namespace radar_dot::evaluation {

/// The figures of a report, as files name them.
std::array<std::pair<const char*, double>, 6> figuresOf(const SegmentationReport& report);

/// One object of formatJson; the overall one has no name.
void writeReport(JsonWriter& writer, const SegmentationReport& report, bool overall);

/// The inverse, without the name. @throws std::runtime_error naming `where` and the field.
SegmentationReport readCounts(const rapidjson::Value& value, const std::string& where);

/// A result of formatJson. @throws std::runtime_error naming the file.
rapidjson::Document readResult(const std::string& file);

}  // namespace radar_dot::evaluation
