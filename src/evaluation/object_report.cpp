// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "radar_dot/evaluation/object_evaluation.h"
#include "report_format.h"

namespace radar_dot::evaluation {

double MoverCounts::recall() const { return ratio(matched, movers); }
double MoverCounts::seenRecall() const { return ratio(matched, movers - unseen); }

void MoverCounts::describe(Figures& figures) {
  figures.figure("recall", recall());
  figures.figure("recall_of_seen", seenRecall());
  // What a tracker of moving returns can find at most, but for those it carries over gaps.
  figures.figure("moving_share", ratio(movers - unseen - unmoving, movers));
  figures.figure("position_mae", meanAbsolute(errors.position));
  figures.figure("radial_mae", meanAbsolute(errors.radial));
  figures.figure("radial_median", medianAbsolute(errors.radial));
  figures.figure("velocity_mae", meanAbsolute(errors.velocity));
  figures.figure("velocity_median", medianAbsolute(errors.velocity));
  figures.figure("velocity_nees", errors.normalised_velocity.value());
  figures.sum("movers", movers);
  figures.sum("matched", matched);
  figures.sum("unseen", unseen);
  figures.sum("unmoving", unmoving);
  figures.column("unseen_share", ratio(unseen, movers));
  figures.column("still_share", ratio(unmoving, movers));
  figures.part(errors.position);
  figures.part(errors.radial);
  figures.part(errors.velocity);
  figures.part(errors.normalised_velocity);
}

MoverCounts ObjectReport::all() const {
  MoverCounts counts;
  for (const MoverCounts& kind : kinds) counts += kind;
  return counts;
}

double ObjectReport::precision() const { return ratio(true_tracks, tracks - unknown_tracks); }

void ObjectReport::describe(Figures& figures) {
  figures.name(scene);
  figures.figure("precision", precision());
  figures.sum("keyframes", keyframes);
  figures.sum("tracks", tracks);
  figures.sum("true_tracks", true_tracks);
  figures.sum("unknown_tracks", unknown_tracks);
  figures.sum("duplicate_tracks", duplicates);
  figures.sum("standing_tracks", standing_tracks);
  figures.sum("empty_tracks", empty_tracks);
  figures.sum("identity_switches", identity_switches);
  figures.show(all(), "_all");
  for (std::size_t i = 0; i < kinds.size(); ++i) figures.group(kinds[i], std::string("_") + kMoverKinds[i]);
}

std::string formatTable(const std::vector<ObjectReport>& scenes, const ObjectReport& overall) {
  std::vector<Row> rows;
  const auto name = [](const std::string& scene, const std::string& kind) {
    return fmt::format("{:<14}{:<12}", scene, kind);
  };
  const auto add = [&](const ObjectReport& report, const std::string& scene) {
    rows.emplace_back(name(scene, "all"), figuresOf(report.all()));
    for (std::size_t i = 0; i < report.kinds.size(); ++i)
      if (report.kinds[i].movers > 0) rows.emplace_back(name("", kMoverKinds[i]), figuresOf(report.kinds[i]));
  };
  for (const ObjectReport& scene : scenes) add(scene, scene.scene);
  add(overall, "Overall");
  return "Tracks of moving objects against annotated movers at keyframes. Unseen: movers without any return, "
         "still: with returns, none of which is trusted and moves.\n" +
         tableOf(name("Scene", "Kind"), 26, rows,
                 {{"Movers", 7, "movers"},
                  {"Unseen %", 9, "unseen_share", 1, 1e2},
                  {"Still %", 8, "still_share", 1, 1e2},
                  {"Recall %", 9, "recall", 1, 1e2},
                  {"of seen", 9, "recall_of_seen", 1, 1e2},
                  {"pos. m", 10, "position_mae", 2},
                  {"rad. m/s", 10, "radial_mae"},
                  {"rad. med.", 10, "radial_median"},
                  {"vel. m/s", 10, "velocity_mae", 2}}) +
         "\n" +
         tableOf("Scene", 14, rowsOf(scenes, overall),
                 {{"Tracks", 7, "tracks"},
                  {"Precision %", 12, "precision", 1, 1e2},
                  {"unknown", 9, "unknown_tracks"},
                  {"duplicates", 12, "duplicate_tracks"},
                  {"standing", 12, "standing_tracks"},
                  {"empty", 9, "empty_tracks"},
                  {"ID switches", 12, "identity_switches"}});
}

}  // namespace radar_dot::evaluation
