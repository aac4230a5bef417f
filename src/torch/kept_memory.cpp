// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "kept_memory.h"

#include <torch/version.h>

#if TORCH_VERSION_MAJOR == 1
#include <c10/core/CPUAllocator.h>
#include <tbb/scalable_allocator.h>

#include <new>
#endif

namespace radar_dot {

#if TORCH_VERSION_MAJOR == 1
namespace {

constexpr std::size_t kAlignment = 64;  // bytes, as libtorch's own: a line of the cache

struct KeepingAllocator : c10::Allocator {
  static void free(void* memory) { scalable_aligned_free(memory); }

  c10::DataPtr allocate(std::size_t size) const override {
    void* memory = size == 0 ? nullptr : scalable_aligned_malloc(size, kAlignment);
    if (memory == nullptr && size != 0) throw std::bad_alloc();
    return {memory, memory, &free, c10::Device(c10::kCPU)};
  }
  c10::DeleterFnPtr raw_deleter() const override { return &free; }
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
