// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "report_format.h"

namespace radar_dot::evaluation {

double SegmentationReport::iou() const {
  return ratio(pixels.true_positives,
               pixels.true_positives + pixels.false_positives + pixels.false_negatives);
}

double SegmentationReport::falsePositiveShare() const {
  return ratio(pixels.false_positives, pixels.false_positives + pixels.true_negatives);
}

void SegmentationReport::describe(Figures& figures) {
  figures.name(scene);
  figures.figure("iou", iou());
  figures.sum("frames", frames);
  figures.sum("without_motion", without_motion);
  figures.group(pixels);
  figures.figure("false_positive_share", falsePositiveShare());
  figures.sum("people_found", people_found);
  figures.sum("people_pixels", people_pixels);
  figures.figure("people_recall", ratio(people_found, people_pixels));
  figures.figure("velocity_error", velocity_error.value());
  figures.sum("velocity_error_count", velocity_error.count);
  figures.sum("seconds", seconds);
  figures.sum("velocity_error_sum", velocity_error.sum);
  figures.column("mask_ms", ratio(1e3 * seconds, frames - without_motion));
}

std::string formatTable(const std::vector<SegmentationReport>& scenes, const SegmentationReport& overall) {
  return tableOf("Scene", 14, rowsOf(scenes, overall),
                 {{"Frames", 7, "frames"},
                  {"IoU", 11, "iou", 4},
                  {"Precision", 11, "precision", 4},
                  {"Recall", 11, "recall", 4},
                  {"F1", 11, "f1", 4},
                  {"People", 11, "people_recall", 4},
                  {"FP share", 11, "false_positive_share", 4},
                  {"v err m/s", 11, "velocity_error", 4},
                  {"mask ms", 9, "mask_ms", 1}});
}

}  // namespace radar_dot::evaluation
