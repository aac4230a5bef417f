// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace radar_dot {

/// The network of a backend that runs one: "torch".
struct NetworkParams {
  std::string
      model;  ///< path of a TorchScript file; scripts/export_raft.py and export_justdepth.py make them
  /// "auto": CUDA where this libtorch and this machine have it, else the CPU; "cpu"; "cuda"; "cuda:1", ...
  std::string device = "auto";
  int threads = 0;  ///< on the CPU; 0 = one per core
};

}  // namespace radar_dot
