// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "radar_dot/vision/optical_flow.h"

namespace radar_dot::tools {

/// Threads of a network that wait for each other hold their cores, and beside any other program make it
/// several times as slow: let them sleep. To be called before anything else; libgomp, which comes with
/// libtorch, reads it when it is loaded. Whoever has chosen for himself keeps his choice.
inline void letWaitingThreadsSleep() { setenv("OMP_WAIT_POLICY", "passive", 0); }

/// Device and threads of networks.
inline void declareDevice(CLI::App& app, const std::vector<NetworkParams*>& networks) {
  app.add_option_function<std::string>(
         "--device",
         [networks](const std::string& device) {
           for (NetworkParams* network : networks) network->device = device;
         },
         "auto, cpu, cuda, cuda:1 (torch)")
      ->default_str(NetworkParams{}.device);
  app.add_option_function<int>(
         "--threads",
         [networks](int threads) {
           for (NetworkParams* network : networks) network->threads = threads;
         },
         "Of a network on the CPU; 0 = one per core (torch)")
      ->check(CLI::Range(0, 1024))
      ->default_str("0");
}

/// The network of the flow backend "torch".
inline void declareFlowNetwork(CLI::App& app, OpticalFlowParams& flow) {
  app.add_option("--flow-model", flow.network.model, "TorchScript file, of export_raft.py (--flow torch)");
  app.add_option_function<std::string>(
         "--flow-size",
         [&flow](const std::string& text) {
           char rest = 0;
           if (std::sscanf(text.c_str(), "%dx%d%c", &flow.network_width, &flow.network_height, &rest) != 2)
             throw CLI::ValidationError("--flow-size", "'" + text + "' is not WIDTHxHEIGHT");
         },
         "Images for the network, WIDTHxHEIGHT px, multiples of 8 (--flow torch)")
      ->default_str("640x360");
}

}  // namespace radar_dot::tools
