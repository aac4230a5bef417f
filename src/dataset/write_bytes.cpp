// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/dataset/write_bytes.h"

#include <string_view>

#include "output_file.h"

namespace radar_dot::dataset {

void writeBytes(const std::filesystem::path& file, const void* data, std::size_t size) {
  OutputFile output(file);
  output.write(std::string_view(static_cast<const char*>(data), size));
  output.close();
}

}  // namespace radar_dot::dataset
