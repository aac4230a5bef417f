// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "radar_dot/evaluation/flow_evaluation.h"
#include "report_format.h"

namespace radar_dot::evaluation {
namespace {

/// The groups of pixels, as files name them.
std::array<std::pair<const char*, const FlowErrors::Group*>, 3> groupsOf(const FlowReport& report) {
  return {{{"all", &report.errors.all}, {"static", &report.errors.still}, {"moving", &report.errors.moving}}};
}

Figures figuresOf(const FlowReport& report) {
  Figures figures;
  for (const auto& [name, group] : groupsOf(report)) {
    figures.emplace_back(fmt::format("epe_{}", name), group->mean());
    figures.emplace_back(fmt::format("epe_median_{}", name), group->median());
    figures.emplace_back(fmt::format("fl_{}", name), group->outlierShare());
    figures.emplace_back(fmt::format("density_{}", name), group->density());
  }
  figures.emplace_back("ms_per_pair", 1e3 * report.medianSeconds());
  return figures;
}

Counts countsOf(const FlowReport& report) {
  Counts counts = {{"pairs", report.pairs}};
  for (const auto& [name, group] : groupsOf(report)) {
    counts.emplace_back(fmt::format("true_pixels_{}", name), group->true_pixels);
    counts.emplace_back(fmt::format("compared_{}", name), group->compared);
  }
  return counts;
}

}  // namespace

double FlowReport::medianSeconds() const {
  if (seconds.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> sorted = seconds;
  std::sort(sorted.begin(), sorted.end());
  const std::size_t half = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[half] : 0.5 * (sorted[half - 1] + sorted[half]);
}

FlowReport& FlowReport::operator+=(const FlowReport& other) {
  pairs += other.pairs;
  errors += other.errors;
  seconds.insert(seconds.end(), other.seconds.begin(), other.seconds.end());
  return *this;
}

std::string formatTable(const std::vector<FlowReport>& scenes, const FlowReport& overall) {
  constexpr std::size_t kBefore = 21, kFirstFigure = 11, kGroup = 33;  // characters
  std::string table =
      "End-point error in px of the full image. Fl: of the pixels with flow, those off by over 3 px and over "
      "5 %. Dense: pixels with flow, of those with truth.\n";
  std::size_t width = kBefore + kFirstFigure;
  for (const auto& [name, group] : groupsOf(overall)) {
    table += fmt::format("{:>{}}", name, width);
    width = kGroup;
  }
  table += fmt::format("\n{:<14}{:>7}", "Scene", "Pairs");
  for (std::size_t i = 0; i < groupsOf(overall).size(); ++i)
    table += fmt::format("{:>11}{:>8}{:>6}{:>8}", "mean", "median", "Fl %", "dense %");
  table += fmt::format("{:>10}\n", "ms/pair");
  const auto row = [&table](const FlowReport& report, const std::string& name) {
    table += fmt::format("{:<14}{:>7}", name, report.pairs);
    for (const auto& [key, group] : groupsOf(report)) {
      table += fmt::format("{:>11}{:>8}{:>6}{:>8}", figure(group->mean()), figure(group->median()),
                           figure(1e2 * group->outlierShare(), 1), figure(1e2 * group->density(), 1));
    }
    table += fmt::format("{:>10}\n", figure(1e3 * report.medianSeconds(), 1));
  };
  for (const FlowReport& scene : scenes) row(scene, scene.scene);
  row(overall, "Overall");
  return table;
}

std::string formatJson(const std::vector<FlowReport>& scenes, const FlowReport& overall) {
  return jsonOf(scenes, overall, figuresOf, countsOf);
}

std::string formatCsv(const std::vector<FlowReport>& scenes, const FlowReport& overall) {
  return csvOf(scenes, overall, figuresOf, countsOf);
}

}  // namespace radar_dot::evaluation
