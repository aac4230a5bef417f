// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "radar_dot/common/random_stream.h"
#include "simulation/sensors/radar_sensor.h"

namespace radar_dot::simulation {

/// invalid_state of nuScenes, as far as simulated.
enum InvalidState : std::int8_t {
  kValid = 0,
  kNotConfirmedNear = 3,  ///< of the narrow scan, not seen by the wide one
  kLowRcs = 4,
  kOutsideView = 7,
  kAzimuthCorrected = 8,
  kChild = 9,
  kFiftyDegrees = 10,
  kNoLocalMaximum = 11,
  kBeyond95m = 15,  ///< in the wide scan
  kMultipleTargets = 16,
};

/// dyn_prop of nuScenes.
enum DynamicProperty : std::int8_t {
  kMoving = 0,
  kStationary = 1,
  kOncoming = 2,
  kStationaryCandidate = 3,
  kUnknown = 4,
  kCrossingStationary = 5,
  kCrossingMoving = 6,
  kStopped = 7,
};

/// What the radar judges a return by.
struct ReturnContext {
  double range = 0.0;         ///< m
  double azimuth = 0.0;       ///< rad
  double ground_speed = 0.0;  ///< m/s, radial, over ground
  bool narrow = false;        ///< of the narrow scan
  bool sideways = false;      ///< of a radar that looks sideways
  bool isolated = true;       ///< no stronger return beside it
  bool folded = false;        ///< its velocity is off by an ambiguity
};

/// Fills invalid_state, ambig_state, pdh0 and dyn_prop; rcs must be set. The shares are those of real
/// scans by range, azimuth and cross-section.
void judgeReturn(RadarReturn& judged, const ReturnContext& context, const RadarModel& model,
                 RandomStream& random);

/// Fills the accuracy codes: one step is a factor 1.29.
void codeAccuracies(RadarReturn& coded, const ReturnContext& context, RandomStream& random);

}  // namespace radar_dot::simulation
