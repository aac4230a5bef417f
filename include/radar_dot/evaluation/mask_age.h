// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace radar_dot::evaluation {

/// s, default of the largest age of a mask, from its image to a scan, at which it still tells which returns
/// move. Keyframes are 0.5 s apart, give or take a tenth, and the mask of a pair belongs to the first of its
/// images: it is half a second old at the begin of the next pair and a second at its end. This is that second
/// and the tenth, so that every scan of a pair may use the mask of the previous pair, and none a mask from
/// before a gap. In simulated traffic the estimator gains more from a whole pair than from its first tenth of
/// a second. Only the vehicle's own motion since the mask is accounted for: a mover that crosses the view has
/// left its place in an old mask, one that moves along the line of sight has not.
inline constexpr double kMaxMaskAge = 1.1;

}  // namespace radar_dot::evaluation
