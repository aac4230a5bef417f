// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace radar_dot {

/// A text that roscpp asks of a message, for its traits MD5Sum, DataType and Definition.
template <typename Message, const char* (*kText)()>
struct MessageText {
  static const char* value() { return kText(); }
  static const char* value(const Message& /*message*/) { return kText(); }
};

}  // namespace radar_dot
