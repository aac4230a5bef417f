// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/annotation_labels.h"

#include <cmath>

#include "radar_dot/common/stamps.h"

namespace radar_dot::evaluation {
namespace {

using dataset::Index;
using dataset::kNone;
using dataset::SampleAnnotation;
using dataset::Tables;

double timeOf(const Tables& tables, const SampleAnnotation& annotation) {
  return secondsOf(tables.samples[static_cast<std::size_t>(annotation.sample)].timestamp_us);
}

Eigen::Vector3d centreOf(const SampleAnnotation& annotation) {
  return {annotation.translation[0], annotation.translation[1], annotation.translation[2]};
}

}  // namespace

std::vector<MovingBox> boxesAt(const Tables& tables, Index sample) {
  std::vector<MovingBox> boxes;
  for (const Index row : tables.annotationsOf(sample)) {
    const SampleAnnotation& annotation = tables.annotations[static_cast<std::size_t>(row)];
    const SampleAnnotation& before = annotation.previous == kNone
                                         ? annotation
                                         : tables.annotations[static_cast<std::size_t>(annotation.previous)];
    const SampleAnnotation& after =
        annotation.next == kNone ? annotation : tables.annotations[static_cast<std::size_t>(annotation.next)];
    MovingBox box;
    box.time = timeOf(tables, annotation);
    box.centre = centreOf(annotation);
    const double span = timeOf(tables, after) - timeOf(tables, before);
    if (span > 0.0) box.velocity = (centreOf(after) - centreOf(before)) / span;
    box.R_box_from_map = annotation.T_map_from_box().linear().topLeftCorner<2, 2>().transpose();
    box.half_size = 0.5 * Eigen::Vector2d(annotation.size[1], annotation.size[0]);
    boxes.push_back(box);
  }
  return boxes;
}

TrueLabel trueLabel(const std::vector<MovingBox>& boxes, const Eigen::Vector3d& position,
                    const Eigen::Vector3d& sensor, double time, const LabelParams& params) {
  const Eigen::Vector2d line_of_sight = (position - sensor).head<2>().normalized();
  TrueLabel label = TrueLabel::kStatic;
  for (const MovingBox& box : boxes) {
    if (box.velocity.head<2>().norm() <= params.min_speed) continue;
    const Eigen::Vector2d centre = (box.centre + (time - box.time) * box.velocity).head<2>();
    const Eigen::Vector2d inside = (box.R_box_from_map * (position.head<2>() - centre)).cwiseAbs();
    if (inside.x() > box.half_size.x() + params.margin || inside.y() > box.half_size.y() + params.margin)
      continue;
    if (std::abs(line_of_sight.dot(box.velocity.head<2>())) > params.min_speed) return TrueLabel::kDynamic;
    label = TrueLabel::kIgnored;
  }
  return label;
}

void Confusion::add(bool predicted, bool actual) {
  ++(predicted ? (actual ? true_positives : false_positives) : (actual ? false_negatives : true_negatives));
}

double Confusion::precision() const { return ratio(true_positives, true_positives + false_positives); }
double Confusion::recall() const { return ratio(true_positives, true_positives + false_negatives); }
double Confusion::f1() const {
  return ratio(2 * true_positives, 2 * true_positives + false_positives + false_negatives);
}

void Confusion::describe(Figures& figures) {
  figures.figure("precision", precision());
  figures.figure("recall", recall());
  figures.figure("f1", f1());
  figures.sum("true_positives", true_positives);
  figures.sum("false_positives", false_positives);
  figures.sum("false_negatives", false_negatives);
  figures.sum("true_negatives", true_negatives);
}

}  // namespace radar_dot::evaluation
