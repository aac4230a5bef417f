// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "radar_dot/common/fields.h"
#include "radar_dot/config/section.h"

namespace radar_dot {

/// A configuration file refused. what() is one line: file, line, and what is wrong.
class ConfigFileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Sets what a YAML file says, the same that roslaunch loads into the namespaces of the nodelets: a key for
/// each section, below it the parameters. All of `sections` are read and checked, also where the caller
/// uses some. Entries of dictionaries are added to those that exist.
///
/// A report written with withParameters() by the tool of this name is read too: a file with a key
/// "parameters". That alone counts then; it holds the sections and a section "options".
/// @return the members that were set, and where: "vehicle.yaml:12"
/// @throws ConfigFileError; some values may be set by then
std::map<const void*, std::string> readConfigFile(const std::string& path,
                                                  const std::vector<Section>& sections,
                                                  const std::string& tool = "",
                                                  const FieldList& options = {});

/// Sets the fields that a YAML file of names and values names. @throws ConfigFileError
void readFieldsFile(const std::string& path, const FieldList& fields);

/// Adds what a YAML file of entries by their names says to a dictionary. @throws ConfigFileError
void readDictionaryFile(const std::string& path, const FieldDictionary& dictionary);

/// Sets what each dictionary of a YAML list says. @param next  fields of a new entry @throws ConfigFileError
void readListFile(const std::string& path, const std::function<FieldList()>& next);

}  // namespace radar_dot
