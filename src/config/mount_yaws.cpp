// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "config/mount_yaws.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <variant>

#include "common/replace_file.h"
#include "config/config_file.h"

namespace radar_dot {
namespace {

struct Entry {
  MountYaw mount{std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};

  // NaN, which says that a value is missing, lies outside every range.
  void describe(FieldList& fields) {
    fields.add("yaw", mount.yaw, "Added to the yaw of the mount", "rad", {-3.2, 3.2});
    fields.add("std", mount.std, "Its 1 sigma", "rad", {0.0, 3.2});
  }
};

}  // namespace

std::map<std::string, MountYaw> readMountYaws(const std::string& path) {
  std::map<std::string, Entry> entries;
  FieldList fields;
  fields.addDictionary("radars", entries, "");
  readDictionaryFile(path, fields.dictionaries().front());
  std::map<std::string, MountYaw> yaws;
  for (const auto& [name, entry] : entries) {
    for (const Field& field : fieldsOf(entry))
      if (std::isnan(std::get<double>(field.get())))
        throw ConfigFileError(fmt::format("{}: {} has no {}", path, name, field.name));
    yaws[name] = entry.mount;
  }
  return yaws;
}

void writeMountYaws(const std::string& path, const std::map<std::string, MountYaw>& yaws) {
  YAML::Emitter yaml;
  yaml << YAML::Comment("rad, added to the yaws of the mounts as configured") << YAML::BeginMap;
  for (const auto& [name, mount] : yaws) {
    try {
      validateFields(Entry{mount});
    } catch (const InvalidParameter& error) {
      throw std::runtime_error(fmt::format("{}: not written: {}/{}", path, name, error.what()));
    }
    yaml << YAML::Key << name << YAML::Value << YAML::Flow << YAML::BeginMap << YAML::Key << "yaw"
         << YAML::Value << mount.yaw << YAML::Key << "std" << YAML::Value << mount.std << YAML::EndMap;
  }
  yaml << YAML::EndMap;
  replaceFile(path, std::string(yaml.c_str()) + "\n");
}

}  // namespace radar_dot
