// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <map>
#include <string>

#include "radar_dot/vision/motion_refinement.h"
#include "radar_dot/vision/motion_segmentation.h"

namespace radar_dot::tools {

/// The score by uncertainty, and what both scores have besides the paper's terms.
inline void declareScore(CLI::App& app, MotionParams& motion) {
  const std::map<std::string, MotionScore> scores = {{"paper", MotionScore::kPaper},
                                                     {"uncertainty", MotionScore::kUncertainty}};
  app.add_option("--score", motion.score, "paper; uncertainty: standard deviations from static")
      ->transform(CLI::CheckedTransformer(scores))
      ->default_str("paper");
  app.add_option("--flow-std", motion.flow_std, "px, of a flow's components (uncertainty)")
      ->capture_default_str();
  app.add_option("--flow-std-relative", motion.flow_std_relative, "Share of the flow on top (uncertainty)")
      ->capture_default_str();
  app.add_option("--fb_error-weight", motion.fb_error_weight,
                 "Share of the gap of --forward-backward that is noise (uncertainty)")
      ->capture_default_str();
  app.add_option("--depth-std", motion.depth_std, "Share of the inverse depth (uncertainty)")
      ->capture_default_str();
  app.add_option("--next-depth-std", motion.next_depth_std,
                 "Share of the depth in the second image (uncertainty)")
      ->capture_default_str();
  app.add_option("--false-alarm", motion.false_alarm,
                 "Probability of a static pixel above the threshold (uncertainty)")
      ->capture_default_str();
  app.add_option("--radar-azimuth-std", motion.radar_azimuth_std,
                 "rad, least half width of a return's footprint, seen from the camera")
      ->capture_default_str();
  app.add_option("--static-gain", motion.static_gain,
                 "Static returns lower the score by this factor, less 1; 0 = off")
      ->capture_default_str();
  app.add_option("--min-scale", motion.min_scale,
                 "Least multiple of the threshold where images agree better than the uncertainties say "
                 "(uncertainty)")
      ->capture_default_str();
  app.add_option("--seed", motion.seed,
                 "Multiple of the threshold that a part of a region must reach; 1 = off (uncertainty)")
      ->capture_default_str();
}

/// Refinement of the motion by the image, and what it starts from.
inline void declareRefinement(CLI::App& app, bool& refine, MotionUncertainty& motion) {
  app.add_flag("--refine,!--no-refine", refine,
               "Refine the motion, and the ground, by the image (default: off)");
  app.add_option("--forward-velocity-std", motion.forward_velocity_std, "m/s")->capture_default_str();
  app.add_option("--lateral-velocity-std", motion.lateral_velocity_std, "m/s")->capture_default_str();
  app.add_option("--vertical-velocity-std", motion.vertical_velocity_std, "m/s")->capture_default_str();
  app.add_option("--yaw-rate-std", motion.yaw_rate_std, "rad/s")->capture_default_str();
  app.add_option("--tilt-std", motion.tilt_std, "rad after one second, of pitch and roll")
      ->capture_default_str();
}

}  // namespace radar_dot::tools
