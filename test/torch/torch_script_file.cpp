// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "torch_script_file.h"

#include <fmt/format.h>
#include <torch/script.h>

namespace radar_dot::test {

void writeTorchScript(const std::filesystem::path& file, const std::string& forward) {
  torch::jit::Module module("network");
  module.define(forward);
  module.save(file.string());
}

namespace networks {

std::string constantFlow(double u, double v) {
  return fmt::format(R"(
def forward(self, image1, image2):
    plane = image1[:, 0:1] * 0.0
    return torch.cat([plane + {}, plane + {}], 1)
)",
                     u, v);
}

std::string flowOfColours() {
  return R"(
def forward(self, image1, image2):
    return torch.cat([image1[:, 0:1], image2[:, 2:3]], 1)
)";
}

std::string depthOfRadar() {
  return R"(
def forward(self, image, radar):
    return image[:, 0:1] * 0.0 + radar
)";
}

std::string depthOfFarthestReturn() {
  return R"(
def forward(self, image, radar):
    return image[:, 0:1] * 0.0 + radar.max()
)";
}

std::string depthOfRed() {
  return R"(
def forward(self, image, radar):
    return (image[:, 0:1] * 0.229 + 0.485) * 255.0 + radar * 0.0
)";
}

}  // namespace networks
}  // namespace radar_dot::test
