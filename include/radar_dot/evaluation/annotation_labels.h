// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "radar_dot/dataset/tables.h"
#include "radar_dot/evaluation/figures.h"

namespace radar_dot::evaluation {

/// What the annotated boxes say of a return.
enum class TrueLabel : std::uint8_t {
  kStatic,
  kDynamic,  ///< in a box that moves along the line of sight
  kIgnored,  ///< in a box that moves, but hardly along the line of sight
};

/// When a return in a box counts as moving.
struct LabelParams {
  double margin = 0.5;     ///< m, by which every box is grown on all sides
  double min_speed = 0.5;  ///< m/s: of the box, and of its radial part
};

/// A box at the time of a keyframe, with the velocity of its track.
struct MovingBox {
  double time = 0.0;                                   ///< s
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();    ///< m, map frame
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< m/s, map frame
  Eigen::Matrix2d R_box_from_map = Eigen::Matrix2d::Identity();
  Eigen::Vector2d half_size = Eigen::Vector2d::Zero();  ///< m: along, across
};

/// The boxes of a keyframe; velocity by central difference to the neighbouring keyframes of the
/// track, one-sided at its ends, zero for a track of one box.
std::vector<MovingBox> boxesAt(const dataset::Tables& tables, dataset::Index sample);

/// Label of a return at `position` (m, map frame) seen from `sensor` (m, map frame) at `time` (s).
/// Boxes are moved along their track to that time. Height does not count: planar radars have none.
TrueLabel trueLabel(const std::vector<MovingBox>& boxes, const Eigen::Vector3d& position,
                    const Eigen::Vector3d& sensor, double time, const LabelParams& params = {});

/// Counts of a binary decision.
struct Confusion {
  std::size_t true_positives = 0;
  std::size_t false_positives = 0;
  std::size_t false_negatives = 0;
  std::size_t true_negatives = 0;

  void add(bool predicted, bool actual);
  double precision() const;  ///< NaN when nothing was predicted
  double recall() const;     ///< NaN when nothing was there
  double f1() const;         ///< NaN when there is neither
  void describe(Figures& figures);
};

}  // namespace radar_dot::evaluation
