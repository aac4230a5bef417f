// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "progress_bar.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

namespace radar_dot::tools {
namespace {

constexpr std::chrono::milliseconds kRedraw{100};
constexpr std::size_t kWidth = 30;  // characters of the bar
constexpr char kClearLine[] = "\r\033[K";

}  // namespace

ProgressBar::ProgressBar(std::string label, std::string unit, bool enabled)
    : label_(std::move(label)),
      unit_(std::move(unit)),
      enabled_(enabled && ::isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      next_draw_(start_ + kRedraw) {}

ProgressBar::~ProgressBar() {
  if (drawn_) std::fputs(kClearLine, stderr);
}

void ProgressBar::update(std::size_t done, std::size_t total) {
  if (!enabled_ || done == 0 || total == 0) return;
  const Clock::time_point now = Clock::now();
  if (now < next_draw_) return;
  next_draw_ = now + kRedraw;
  drawn_ = true;
  const double seconds = std::chrono::duration<double>(now - start_).count();
  const double rate = static_cast<double>(done) / seconds;
  const auto left = static_cast<long>(static_cast<double>(total - done) / rate + 0.5);
  const std::size_t filled = kWidth * done / total;
  std::fputs(fmt::format("{}{} [{:#>{}}{:.>{}}] {:3d} %  {:.0f} {}/s  {}:{:02d} left", kClearLine, label_, "",
                         filled, "", kWidth - filled, 100 * done / total, rate, unit_, left / 60, left % 60)
                 .c_str(),
             stderr);
  std::fflush(stderr);
}

}  // namespace radar_dot::tools
