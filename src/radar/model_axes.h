// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>

#include "constraint_system.h"
#include "radar_dot/radar/motion_model.h"

namespace radar_dot {

/// Where the parameters of each model stand in vx vy vz wx wy wz.
struct ModelAxes {
  int count;
  std::array<int, ConstraintSystem::kMaxParameters> axes;
  int least;  ///< the axis that is most likely near zero: vy of a vehicle on wheels, the yaw rate of others

  bool estimatesYawRate() const { return axes[static_cast<std::size_t>(count - 1)] == 5; }
};

/// @param turn_known  the angular velocity is given: the yaw rate is no parameter
ModelAxes axesOf(MotionModel model, bool turn_known) noexcept;

/// Moves a solution along the free directions (the columns of `basis` from `rank`) to the member of its
/// family with the least motion along the model's axis `least` and the vertical (and, after them, along the
/// others), near which the vehicle most likely is. The returns cannot tell the members apart.
Parameters likeliestMember(const ModelAxes& model, const ParameterMatrix& basis, int rank,
                           const Parameters& solution);

/// The basis without the axes that the free directions hardly touch. A radar a centimetre beside the centre
/// line leaves vx free by a hundredth of the yaw rate, which is no news; with the variance of a free
/// direction it would still pass for unobserved.
ParameterMatrix removeTrails(ParameterMatrix basis, int rank, int parameters);

}  // namespace radar_dot
