// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "backend_library.h"

namespace radar_dot {

/// The backends of one kind, by name. Thread-safe.
template <typename Factory>
class BackendRegistry {
 public:
  /// @param kind  "optical flow": begins every refusal
  BackendRegistry(std::string kind, std::map<std::string, Factory> factories)
      : kind_(std::move(kind)), factories_(std::move(factories)) {}

  void add(const std::string& name, Factory factory) {
    if (name.empty() || !factory)
      throw std::invalid_argument(kind_ + ": a backend needs a name and a factory to be registered");
    const std::lock_guard<std::mutex> lock(mutex_);
    factories_[name] = std::move(factory);
  }

  std::vector<std::string> names() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::vector<std::string> names;
    for (const auto& [name, factory] : factories_) names.push_back(name);
    return names;
  }

  /// One that is not registered is looked for in its library first.
  /// @throws std::invalid_argument when it is not there, with the names at hand
  Factory find(const std::string& name) {
    Factory factory = registered(name);
    if (factory) return factory;
    const std::string problem = loadBackendLibrary(name);  // without the lock: the library registers itself
    factory = registered(name);
    if (factory) return factory;
    std::string known;
    for (const std::string& each : names()) known += (known.empty() ? "" : ", ") + each;
    throw std::invalid_argument(
        fmt::format("{}: no backend '{}'; there are: {}{}", kind_, name, known, problem));
  }

 private:
  Factory registered(const std::string& name) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = factories_.find(name);
    return found == factories_.end() ? Factory() : found->second;
  }

  std::string kind_;
  mutable std::mutex mutex_;
  std::map<std::string, Factory> factories_;
};

}  // namespace radar_dot
