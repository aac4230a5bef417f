// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "annotated_objects.h"

#include <algorithm>
#include <cstddef>
#include <string>

#include "radar_dot/dataset/instance_masks.h"
#include "radar_scene.h"

namespace radar_dot::evaluation {

using dataset::kNone;
using dataset::SampleAnnotation;
using dataset::Tables;

MoverKind kindOf(const std::string& category) {
  const auto contains = [&category](const char* part) { return category.find(part) != std::string::npos; };
  if (contains("cycle")) return MoverKind::kCycle;
  if (contains("vehicle.")) return MoverKind::kVehicle;
  return contains("human.") ? MoverKind::kPedestrian : MoverKind::kOther;
}

BoxState stateOf(const MovingBox& box, bool has_speed, bool is_called_moving, double min_speed) {
  const bool is_fast = box.velocity.head<2>().norm() >= min_speed;
  if (!has_speed || is_called_moving != is_fast) return BoxState::kUnknown;
  return is_fast ? BoxState::kMoves : BoxState::kStands;
}

bool AnnotatedObject::contains(const Eigen::Vector2d& position, double time, double margin) const {
  const Eigen::Vector2d centre = (box.centre + (time - box.time) * box.velocity).head<2>();
  const Eigen::Vector2d inside = (box.R_box_from_map * (position - centre)).cwiseAbs();
  return inside.x() <= box.half_size.x() + margin && inside.y() <= box.half_size.y() + margin;
}

std::vector<AnnotatedObject> annotatedObjects(const Tables& tables, dataset::Index sample, double min_speed) {
  const std::vector<MovingBox> boxes = boxesAt(tables, sample);
  const std::vector<dataset::Index> rows = tables.annotationsOf(sample);
  std::vector<AnnotatedObject> objects;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const SampleAnnotation& annotation = tables.annotations[at(rows[i])];
    const dataset::Index category = tables.instances[at(annotation.instance)].category;
    AnnotatedObject object;
    object.box = boxes[i];
    object.instance = annotation.instance;
    object.kind = kindOf(tables.categories[at(category)].name);
    const bool has_speed = annotation.previous != kNone || annotation.next != kNone;
    object.state = stateOf(boxes[i], has_speed, isMoving(tables, annotation), min_speed);
    objects.push_back(object);
  }
  return objects;
}

}  // namespace radar_dot::evaluation
