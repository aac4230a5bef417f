// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <opencv2/core/mat.hpp>

#include "radar_dot/dataset/tables.h"

namespace radar_dot::evaluation {

/// Road users of a simulated scene that move, but too slowly for their annotation to say so: vehicles below
/// 0.5 m/s, pedestrians below 0.3 m/s. A mask that marks them is not wrong, and one that does not is not
/// either.
class CreepingActors {
 public:
  /// @throws dataset::DatasetError naming the file that tells which actor has which number.
  CreepingActors(const dataset::Tables& tables, dataset::Index scene);

  /// 255 where the image of a keyframe shows one that moves between this keyframe and the next, or, at the
  /// last one of the actor, since the one before. CV_8UC1, of the image's size.
  /// @param reading  row of sample_data @throws dataset::DatasetError naming the missing or wrong file.
  cv::Mat shownBy(dataset::Index reading) const;

 private:
  const dataset::Tables& tables_;
  std::map<dataset::Token, std::uint16_t> numbers_;  // by instance token
};

}  // namespace radar_dot::evaluation
