// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <limits>

#include "radar_dot/evaluation/segmentation_evaluation.h"
#include "report_format.h"

namespace radar_dot::evaluation {

double SegmentationReport::iou() const {
  return ratio(pixels.true_positives,
               pixels.true_positives + pixels.false_positives + pixels.false_negatives);
}

double SegmentationReport::iouError() const {
  if (frames < 2) return std::numeric_limits<double>::quiet_NaN();
  const double squares =
      intersection_squared - 2.0 * iou() * intersection_by_union + iou() * iou() * union_squared;
  const auto n = static_cast<double>(frames);
  const auto all =
      static_cast<double>(pixels.true_positives + pixels.false_positives + pixels.false_negatives);
  return std::sqrt(std::max(0.0, squares) * n / (n - 1.0)) / all;
}

void SegmentationReport::addPair(const Confusion& of_pair) {
  pixels += of_pair;
  const auto both = static_cast<double>(of_pair.true_positives);
  const double either = both + static_cast<double>(of_pair.false_positives + of_pair.false_negatives);
  intersection_squared += both * both;
  intersection_by_union += both * either;
  union_squared += either * either;
}

double SegmentationReport::falsePositiveShare() const {
  return ratio(pixels.false_positives, pixels.false_positives + pixels.true_negatives);
}

void SegmentationReport::describe(Figures& figures) {
  figures.name(scene);
  figures.figure("iou", iou());
  figures.figure("iou_error", iouError());
  figures.sum("frames", frames);
  figures.sum("without_motion", without_motion);
  figures.group(pixels);
  figures.sum("intersection_squared", intersection_squared);
  figures.sum("intersection_by_union", intersection_by_union);
  figures.sum("union_squared", union_squared);
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
                  {"+-", 8, "iou_error", 4},
                  {"Precision", 11, "precision", 4},
                  {"Recall", 11, "recall", 4},
                  {"F1", 11, "f1", 4},
                  {"People", 11, "people_recall", 4},
                  {"FP share", 11, "false_positive_share", 4},
                  {"v err m/s", 11, "velocity_error", 4},
                  {"mask ms", 9, "mask_ms", 1}});
}

}  // namespace radar_dot::evaluation
