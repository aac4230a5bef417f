// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "segmentation_runner.h"

#include <algorithm>
#include <thread>

namespace radar_dot::tools {

SegmentationRunner::SegmentationRunner(const dataset::Tables& tables,
                                       const std::vector<dataset::InstanceMask>& masks,
                                       const std::vector<Options>& variants, int jobs, bool all_or_none)
    : tables_(tables),
      variants_(variants),
      jobs_(jobs),
      all_or_none_(all_or_none),
      by_scene_(tables.scenes.size()),
      results_(tables.scenes.size() * variants.size()),
      progress_(results_.size(), {0, 0}),
      bar_("segmenting", "pairs") {
  for (const dataset::InstanceMask& mask : masks) {
    const dataset::Index reading = tables.findReading(mask.sample_data_token);
    const dataset::SampleData& data = tables.sample_data[static_cast<std::size_t>(reading)];
    const dataset::Index scene = tables.samples[static_cast<std::size_t>(data.sample)].scene;
    by_scene_[static_cast<std::size_t>(scene)].push_back(&mask);
  }
}

std::vector<std::vector<SegmentationRunner::Report>> SegmentationRunner::run() {
  std::vector<std::thread> threads;
  const std::size_t jobs = std::min(static_cast<std::size_t>(jobs_), results_.size());
  for (std::size_t i = 0; i < jobs; ++i) threads.emplace_back([this] { work(); });
  for (std::thread& thread : threads) thread.join();
  if (error_) std::rethrow_exception(error_);
  std::vector<std::vector<Report>> reports(variants_.size());
  for (std::size_t task = 0; task < results_.size(); ++task)
    if (results_[task]) reports[task % variants_.size()].push_back(std::move(*results_[task]));
  return reports;
}

void SegmentationRunner::work() {
  for (std::size_t task = next_++; task < results_.size() && !failed_; task = next_++) {
    const std::size_t scene = task / variants_.size();
    const std::size_t variant = task % variants_.size();
    try {
      results_[task] =
          evaluateSegmentation(tables_, static_cast<dataset::Index>(scene), by_scene_[scene],
                               variants_[variant], [this, task](std::size_t done, std::size_t all) {
                                 signals_.check();  // between pairs, where no mask is half written
                                 showProgress(task, done, all);
                               });
    } catch (const evaluation::NoImages& error) {
      // A dataroot may hold a part of the scenes; one that was asked for must be there.
      if (all_or_none_) {
        fail();
      } else if (variant == 0) {
        const std::lock_guard<std::mutex> lock(mutex_);
        left_out_.emplace_back(error.what());
      }
    } catch (...) {
      fail();
    }
  }
}

void SegmentationRunner::fail() {
  const std::lock_guard<std::mutex> lock(mutex_);
  failed_ = true;
  if (!error_) error_ = std::current_exception();
}

void SegmentationRunner::showProgress(std::size_t task, std::size_t done, std::size_t all) {
  const std::lock_guard<std::mutex> lock(mutex_);
  progress_[task] = {done, all};
  // Scenes that have not begun are taken to be as long as this one.
  std::size_t sum = 0;
  std::size_t total = 0;
  for (const auto& [so_far, pairs] : progress_) {
    sum += so_far;
    total += pairs == 0 ? all : pairs;
  }
  bar_.update(sum, total);
}

}  // namespace radar_dot::tools
