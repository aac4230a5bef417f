// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "radar_dot/vision/network_params.h"

namespace radar_dot {

/// (images, channels, rows, columns), as PyTorch orders them.
using TensorShape = std::array<std::int64_t, 4>;

/// What a network takes and gives: float tensors.
struct NetworkSignature {
  std::vector<TensorShape> inputs;
  TensorShape output{};
  std::string maker;  ///< script that makes such files, for messages
};

/// A TorchScript network, loaded, proven to have its signature, and warmed up. Thread-safe: calls run one
/// after the other.
class TorchModel {
 public:
  /// A network in use already, with the same file, device and signature, is shared.
  /// @throws std::invalid_argument in one line, when there is no such file, it is not TorchScript, it does
  /// not
  ///         take these inputs or give this output, or there is no such device
  static std::shared_ptr<TorchModel> load(const NetworkParams& params, const NetworkSignature& signature);

  virtual ~TorchModel() = default;

  /// @param inputs  the values of each input, row by row
  /// @return CV_32FC1, the channels of the output one below the other
  /// @throws std::runtime_error in one line, when the network fails
  virtual cv::Mat run(const std::vector<const float*>& inputs, int threads) = 0;
};

}  // namespace radar_dot
