// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "radar_dot/common/fields.h"

namespace radar_dot {

/// The network of a backend that runs one: "torch".
struct NetworkParams {
  std::string model;  ///< path of a TorchScript file; flow and depth name the parameter
  std::string device = "auto";
  int threads = 0;

  void describe(FieldList& fields) {
    fields.add(
        "device", device,
        "Device of the network: auto (CUDA where libtorch and the machine have it), cpu, cuda, cuda:1 ...");
    fields.add("threads", threads, "Threads of the network on the CPU; 0: one per core", "", {0, 1024});
  }
};

}  // namespace radar_dot
