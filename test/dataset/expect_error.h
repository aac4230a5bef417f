// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>
#include <string_view>

#include "radar_dot/dataset/tables.h"

namespace radar_dot::test {

/// `action` must throw a DatasetError of one line that contains all `parts`.
template <typename Action>
void expectDatasetError(const Action& action, std::initializer_list<std::string_view> parts) {
  try {
    action();
    FAIL() << "no DatasetError was thrown";
  } catch (const dataset::DatasetError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    for (const std::string_view part : parts)
      EXPECT_NE(message.find(part), std::string::npos) << "'" << part << "' is not in: " << message;
  }
}

}  // namespace radar_dot::test
