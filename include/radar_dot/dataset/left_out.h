// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <memory>
#include <string>

namespace radar_dot::dataset {

/// What of a dataroot is not used, and why: scenes, sensor files, rows. Readers add to it from any thread,
/// and tools list it, so that nothing broken ends their work and nothing is lost without a word. Copies share
/// it.
class LeftOut {
 public:
  LeftOut();
  /// @param what  a scene, "<scene> <channel>" or a file; it has one entry, however often it is read
  /// @param why   becomes one line, without `what` in front
  void add(const std::string& what, std::string why) const;
  /// Why, by what.
  std::map<std::string, std::string> entries() const;

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace radar_dot::dataset
