// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/dataset/left_out.h"

#include <algorithm>
#include <cctype>
#include <mutex>

namespace radar_dot::dataset {

struct LeftOut::State {
  mutable std::mutex mutex;
  std::map<std::string, std::string> entries;
};

LeftOut::LeftOut() : state_(std::make_shared<State>()) {}

void LeftOut::add(const std::string& what, std::string why) const {
  if (why.rfind(what + ": ", 0) == 0) why.erase(0, what.size() + 2);
  while (!why.empty() && std::isspace(static_cast<unsigned char>(why.back())) != 0) why.pop_back();
  std::replace_if(
      why.begin(), why.end(), [](unsigned char c) { return std::iscntrl(c) != 0; }, ' ');
  const std::lock_guard<std::mutex> lock(state_->mutex);
  state_->entries.emplace(what, std::move(why));
}

std::map<std::string, std::string> LeftOut::entries() const {
  const std::lock_guard<std::mutex> lock(state_->mutex);
  return state_->entries;
}

}  // namespace radar_dot::dataset
