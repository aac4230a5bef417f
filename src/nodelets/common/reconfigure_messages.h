// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>

#include <string>
#include <vector>

#include "radar_dot/common/fields.h"

// A list of fields in the messages of dynamic_reconfigure, as rqt_reconfigure and dynparam read them. What
// has no type there (enums, lists, optional numbers) is a text. Fields that are read at start only are left
// out.

namespace radar_dot {

/// What there is to set, in the groups of the fields. @param defaults  a configuration with the default
/// values
dynamic_reconfigure::ConfigDescription descriptionOf(const FieldList& defaults);

/// The values.
dynamic_reconfigure::Config messageOf(const FieldList& fields);

/// Writes what a request names; the values are checked. @return the names
/// @throws InvalidParameter also for a name that is unknown or read at start only
std::vector<std::string> writeRequest(const dynamic_reconfigure::Config& request, const FieldList& fields);

}  // namespace radar_dot
