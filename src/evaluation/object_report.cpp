// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "radar_dot/evaluation/object_evaluation.h"
#include "report_format.h"

namespace radar_dot::evaluation {
namespace {

double ratio(std::size_t part, std::size_t whole) {
  return whole == 0 ? std::numeric_limits<double>::quiet_NaN()
                    : static_cast<double>(part) / static_cast<double>(whole);
}

/// All movers and each kind of them, as files name them.
std::vector<std::pair<std::string, MoverCounts>> groupsOf(const ObjectReport& report) {
  std::vector<std::pair<std::string, MoverCounts>> groups = {{"all", report.all()}};
  for (std::size_t kind = 0; kind < kMoverKinds.size(); ++kind)
    groups.emplace_back(kMoverKinds[kind], report.kinds[kind]);
  return groups;
}

Figures figuresOf(const ObjectReport& report) {
  Figures figures = {{"precision", report.precision()}};
  for (const auto& [name, counts] : groupsOf(report)) {
    const ObjectErrors& errors = counts.errors;
    figures.emplace_back("recall_" + name, counts.recall());
    figures.emplace_back("recall_of_seen_" + name, counts.seenRecall());
    figures.emplace_back("moving_share_" + name, counts.movingShare());
    figures.emplace_back("position_mae_" + name, meanAbsolute(errors.position));
    figures.emplace_back("radial_mae_" + name, meanAbsolute(errors.radial));
    figures.emplace_back("radial_median_" + name, medianAbsolute(errors.radial));
    figures.emplace_back("velocity_mae_" + name, meanAbsolute(errors.velocity));
    figures.emplace_back("velocity_median_" + name, medianAbsolute(errors.velocity));
    figures.emplace_back("velocity_nees_" + name, errors.normalised_velocity.value());
  }
  return figures;
}

Counts countsOf(const ObjectReport& report) {
  Counts counts = {{"keyframes", report.keyframes},         {"tracks", report.tracks},
                   {"true_tracks", report.true_tracks},     {"unknown_tracks", report.unknown_tracks},
                   {"duplicate_tracks", report.duplicates}, {"standing_tracks", report.standing_tracks},
                   {"empty_tracks", report.empty_tracks},   {"identity_switches", report.identity_switches}};
  for (const auto& [name, group] : groupsOf(report)) {
    counts.emplace_back("movers_" + name, group.movers);
    counts.emplace_back("matched_" + name, group.matched);
    counts.emplace_back("unseen_" + name, group.unseen);
    counts.emplace_back("unmoving_" + name, group.unmoving);
  }
  return counts;
}

void append(std::vector<double>& values, const std::vector<double>& more) {
  values.insert(values.end(), more.begin(), more.end());
}

std::string percent(double share) { return figure(1e2 * share, 1); }

}  // namespace

double meanAbsolute(const std::vector<double>& values) {
  Mean mean;
  for (const double value : values) mean.add(std::abs(value));
  return mean.value();
}

double medianAbsolute(const std::vector<double>& values) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  std::vector<double> sorted;
  for (const double value : values) sorted.push_back(std::abs(value));
  std::sort(sorted.begin(), sorted.end());
  const std::size_t half = sorted.size() / 2;
  return sorted.size() % 2 == 1 ? sorted[half] : 0.5 * (sorted[half - 1] + sorted[half]);
}

ObjectErrors& ObjectErrors::operator+=(const ObjectErrors& other) {
  append(position, other.position);
  append(radial, other.radial);
  append(velocity, other.velocity);
  normalised_velocity += other.normalised_velocity;
  return *this;
}

double MoverCounts::recall() const { return ratio(matched, movers); }
double MoverCounts::seenRecall() const { return ratio(matched, movers - unseen); }
double MoverCounts::movingShare() const { return ratio(movers - unseen - unmoving, movers); }

MoverCounts& MoverCounts::operator+=(const MoverCounts& other) {
  movers += other.movers;
  matched += other.matched;
  unseen += other.unseen;
  unmoving += other.unmoving;
  errors += other.errors;
  return *this;
}

MoverCounts ObjectReport::all() const {
  MoverCounts counts;
  for (const MoverCounts& kind : kinds) counts += kind;
  return counts;
}

double ObjectReport::precision() const { return ratio(true_tracks, tracks - unknown_tracks); }

ObjectReport& ObjectReport::operator+=(const ObjectReport& other) {
  keyframes += other.keyframes;
  for (std::size_t kind = 0; kind < kinds.size(); ++kind) kinds[kind] += other.kinds[kind];
  tracks += other.tracks;
  true_tracks += other.true_tracks;
  unknown_tracks += other.unknown_tracks;
  duplicates += other.duplicates;
  standing_tracks += other.standing_tracks;
  empty_tracks += other.empty_tracks;
  identity_switches += other.identity_switches;
  return *this;
}

std::string formatTable(const std::vector<ObjectReport>& scenes, const ObjectReport& overall) {
  std::string table =
      "Tracks of moving objects against annotated movers at keyframes. Unseen: movers without any return, "
      "still: with returns, none of which is trusted and moves.\n";
  table += fmt::format("{:<14}{:<12}{:>7}{:>9}{:>8}{:>9}{:>9}{:>10}{:>10}{:>10}{:>10}\n", "Scene", "Kind",
                       "Movers", "Unseen %", "Still %", "Recall %", "of seen", "pos. m", "rad. m/s",
                       "rad. med.", "vel. m/s");
  const auto rows = [&table](const ObjectReport& report, const std::string& name) {
    for (const auto& [kind, counts] : groupsOf(report)) {
      if (counts.movers == 0 && kind != "all") continue;
      table += fmt::format(
          "{:<14}{:<12}{:>7}{:>9}{:>8}{:>9}{:>9}{:>10}{:>10}{:>10}{:>10}\n", kind == "all" ? name : "", kind,
          counts.movers, percent(ratio(counts.unseen, counts.movers)),
          percent(ratio(counts.unmoving, counts.movers)), percent(counts.recall()),
          percent(counts.seenRecall()), figure(meanAbsolute(counts.errors.position), 2),
          figure(meanAbsolute(counts.errors.radial)), figure(medianAbsolute(counts.errors.radial)),
          figure(meanAbsolute(counts.errors.velocity), 2));
    }
  };
  for (const ObjectReport& scene : scenes) rows(scene, scene.scene);
  rows(overall, "Overall");
  table += fmt::format("\n{:<14}{:>7}{:>12}{:>9}{:>12}{:>12}{:>9}{:>12}\n", "Scene", "Tracks", "Precision %",
                       "unknown", "duplicates", "standing", "empty", "ID switches");
  const auto row = [&table](const ObjectReport& report, const std::string& name) {
    table += fmt::format("{:<14}{:>7}{:>12}{:>9}{:>12}{:>12}{:>9}{:>12}\n", name, report.tracks,
                         percent(report.precision()), report.unknown_tracks, report.duplicates,
                         report.standing_tracks, report.empty_tracks, report.identity_switches);
  };
  for (const ObjectReport& scene : scenes) row(scene, scene.scene);
  row(overall, "Overall");
  return table;
}

std::string formatJson(const std::vector<ObjectReport>& scenes, const ObjectReport& overall) {
  return jsonOf(scenes, overall, figuresOf, countsOf);
}

std::string formatCsv(const std::vector<ObjectReport>& scenes, const ObjectReport& overall) {
  return csvOf(scenes, overall, figuresOf, countsOf);
}

}  // namespace radar_dot::evaluation
