// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "progress_bar.h"
#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "signal_watch.h"

namespace radar_dot::tools {

/// Evaluates scenes, each with some variants of the options, on some threads.
class SegmentationRunner {
 public:
  using Options = evaluation::SegmentationEvaluationOptions;
  using Report = evaluation::SegmentationReport;

  /// @param jobs         threads
  /// @param all_or_none  a scene without images is an error; otherwise it is left out
  /// All must outlive it.
  SegmentationRunner(const dataset::Tables& tables, const std::vector<dataset::InstanceMask>& masks,
                     const std::vector<Options>& variants, int jobs, bool all_or_none);

  /// By variant: the reports in the order of the tables.
  /// @throws what evaluateSegmentation throws, and Interrupted.
  std::vector<std::vector<Report>> run();
  /// One line for each scene that has no images.
  const std::vector<std::string>& leftOut() const { return left_out_; }

 private:
  void work();
  void fail();
  void showProgress(std::size_t task, std::size_t done, std::size_t all);

  const dataset::Tables& tables_;
  const std::vector<Options>& variants_;
  int jobs_;
  bool all_or_none_;
  SignalWatch signals_;
  std::vector<std::vector<const dataset::InstanceMask*>> by_scene_;
  std::vector<std::optional<Report>> results_;                 // by scene, and in it by variant
  std::vector<std::pair<std::size_t, std::size_t>> progress_;  // done, all; the same
  std::vector<std::string> left_out_;
  std::atomic<std::size_t> next_{0};
  std::atomic<bool> failed_{false};
  std::exception_ptr error_;
  std::mutex mutex_;
  ProgressBar bar_;
};

}  // namespace radar_dot::tools
