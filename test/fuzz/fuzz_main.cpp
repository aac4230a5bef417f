// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "fuzz/fuzz_targets.h"

/// libFuzzer's way in.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  radar_dot::test::FUZZ_TARGET(data, size);
  return 0;
}
