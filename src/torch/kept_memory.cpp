// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "kept_memory.h"

#include <torch/version.h>

#if TORCH_VERSION_MAJOR == 1
#include <c10/core/CPUAllocator.h>

#include <cstddef>
#include <cstdlib>
#include <map>
#include <mutex>
#include <new>
#include <vector>
#endif

namespace radar_dot {

#if TORCH_VERSION_MAJOR == 1
namespace {

constexpr std::size_t kAlignment = 64;     // bytes, as libtorch's own; also the place of the size, before it
constexpr std::size_t kLarge = 1U << 16U;  // bytes; smaller ones the C library keeps by itself
constexpr std::size_t kMostKept = 1U << 30U;  // bytes; a network of another size leaves its blocks behind

/// Blocks that were given back, by size.
class Blocks {
 public:
  void* take(std::size_t size) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = free_.find(size);
    if (found == free_.end() || found->second.empty()) return nullptr;
    void* block = found->second.back();
    found->second.pop_back();
    kept_ -= size;
    return block;
  }
  /// @return false: there are enough
  bool keep(void* block, std::size_t size) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (kept_ + size > kMostKept) return false;
    free_[size].push_back(block);
    kept_ += size;
    return true;
  }

 private:
  std::mutex mutex_;
  std::map<std::size_t, std::vector<void*>> free_;
  std::size_t kept_ = 0;
};

Blocks& blocks() {
  static auto* instance = new Blocks;  // never destroyed: tensors may outlive everything
  return *instance;
}

struct KeepingAllocator : c10::Allocator {
  static void give(void* memory) {
    if (memory == nullptr) return;
    void* block = static_cast<char*>(memory) - kAlignment;
    const std::size_t size = *static_cast<std::size_t*>(block);
    if (size < kLarge || !blocks().keep(block, size)) std::free(block);
  }

  c10::DataPtr allocate(std::size_t wanted) const override {
    if (wanted == 0) return {nullptr, nullptr, &give, c10::Device(c10::kCPU)};
    const std::size_t size = (wanted + 2 * kAlignment - 1) / kAlignment * kAlignment;
    void* block = size < kLarge ? nullptr : blocks().take(size);
    if (block == nullptr) block = std::aligned_alloc(kAlignment, size);
    if (block == nullptr) throw std::bad_alloc();
    *static_cast<std::size_t*>(block) = size;
    void* memory = static_cast<char*>(block) + kAlignment;
    return {memory, memory, &give, c10::Device(c10::kCPU)};
  }
  c10::DeleterFnPtr raw_deleter() const override { return &give; }
};

}  // namespace

void keepMemory() {
  static KeepingAllocator allocator;
  static const bool installed = [] {
    c10::SetCPUAllocator(&allocator, 1);  // above the priority of libtorch's own
    return true;
  }();
  (void)installed;
}
#else
// The interface of allocators is another one in libtorch 2.
void keepMemory() {}
#endif

}  // namespace radar_dot
