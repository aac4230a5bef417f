// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace radar_dot {

/// A dynamic_reconfigure configuration in which what made no sense has been replaced by its default.
template <typename Config>
struct Mended {
  Config config;
  std::vector<std::string> problems;               ///< one line per replaced parameter, or pair of them
  std::vector<std::vector<std::string>> replaced;  ///< their names
  bool valid = true;                               ///< `config` makes sense now
};

namespace mending {

template <typename T, typename Config>
bool copyIfOfType(const typename Config::AbstractParamDescription& field, const Config& from, Config& to) {
  const auto* typed = dynamic_cast<const typename Config::template ParamDescription<T>*>(&field);
  if (typed != nullptr) to.*(typed->field) = from.*(typed->field);
  return typed != nullptr;
}

template <typename Config>
void copyField(const std::string& name, const Config& from, Config& to) {
  for (const auto& field : Config::__getParamDescriptions__()) {
    if (field->name != name) continue;
    if (copyIfOfType<double>(*field, from, to) || copyIfOfType<int>(*field, from, to) ||
        copyIfOfType<bool>(*field, from, to) || copyIfOfType<std::string>(*field, from, to)) {
      return;
    }
  }
}

/// What is wrong with the configuration; empty: nothing.
template <typename Config>
std::string defectOf(const Config& config, const std::function<void(const Config&)>& check) {
  for (const auto& field : Config::__getParamDescriptions__()) {
    const auto* real = dynamic_cast<const typename Config::template ParamDescription<double>*>(field.get());
    if (real != nullptr && !std::isfinite(config.*(real->field))) return field->name + " is not finite";
  }
  try {
    check(config);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return {};
}

}  // namespace mending

/// Checks every parameter by itself, so that one bad value does not take the good ones with it.
/// @param check  throws std::invalid_argument for a configuration that makes no sense
/// @param pairs  names of parameters that make sense only together
template <typename Config>
Mended<Config> mend(const Config& config, const std::function<void(const Config&)>& check,
                    const std::vector<std::vector<std::string>>& pairs = {}) {
  const Config& defaults = Config::__getDefault__();
  Mended<Config> result;
  result.config = config;
  if (mending::defectOf(config, check).empty()) return result;

  std::vector<std::vector<std::string>> parts = pairs;
  for (const auto& field : Config::__getParamDescriptions__()) {
    const bool paired = std::any_of(pairs.begin(), pairs.end(), [&field](const auto& pair) {
      return std::find(pair.begin(), pair.end(), field->name) != pair.end();
    });
    if (!paired) parts.push_back({field->name});
  }
  for (const std::vector<std::string>& part : parts) {
    Config alone = defaults;
    for (const std::string& name : part) mending::copyField(name, config, alone);
    const std::string defect = mending::defectOf(alone, check);
    if (defect.empty()) continue;
    std::string names;
    for (const std::string& name : part) {
      mending::copyField(name, defaults, result.config);
      names += (names.empty() ? "" : ", ") + name;
    }
    result.problems.push_back(names + ": " + defect + "; using the default");
    result.replaced.push_back(part);
  }
  const std::string rest = mending::defectOf(result.config, check);
  if (!rest.empty()) {
    result.problems.push_back(rest);
    result.valid = false;
  }
  return result;
}

}  // namespace radar_dot
