// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "radar_dot/common/fields.h"

namespace radar_dot {

/// One section of a configuration file: a top-level key and the parameters below it.
struct Section {
  const char* name = "";     ///< of the section, and of the node in the launch files
  const char* nodelet = "";  ///< its class
  FieldList fields;
};

}  // namespace radar_dot
