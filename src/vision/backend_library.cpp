// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "backend_library.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

namespace radar_dot {
namespace {

/// Folder of the shared library that this function is in.
std::filesystem::path ownFolder() {
  Dl_info info;
  if (dladdr(reinterpret_cast<const void*>(&ownFolder), &info) == 0 || info.dli_fname == nullptr) return {};
  return std::filesystem::path(info.dli_fname).parent_path();
}

/// Names come from parameters: they must not lead anywhere else.
bool isPlain(const std::string& name) {
  return !name.empty() && std::all_of(name.begin(), name.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
  });
}

}  // namespace

std::string loadBackendLibrary(const std::string& name) {
  if (!isPlain(name)) return {};
  const std::string library = "libradar_dot_backend_" + name + ".so";
  const std::filesystem::path beside = ownFolder() / library;
  std::error_code error;
  const bool is_beside = std::filesystem::exists(beside, error);
  if (dlopen(is_beside ? beside.c_str() : library.c_str(), RTLD_NOW | RTLD_LOCAL) != nullptr) return {};
  const std::string reason = dlerror();
  const bool is_missing = !is_beside && reason.rfind(library, 0) == 0;  // itself, not one that it needs
  if (!is_missing) return fmt::format("; its library cannot be loaded: {}", reason);
  if (name != "torch") return {};
  return "; 'torch' is built where libtorch is found: install libtorch-dev and libopenblas0-pthread "
         "(Debian), or set Torch_DIR to another libtorch, and configure and build radar_dot again";
}

}  // namespace radar_dot
