// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensors/radar_states.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

namespace radar_dot::simulation {
namespace {

using Table = std::initializer_list<std::pair<double, double>>;

/// Linear between the entries, constant outside.
double lookUp(const Table& table, double at) {
  auto entry = table.begin();
  if (at <= entry->first) return entry->second;
  for (auto next = entry + 1; next != table.end(); entry = next++)
    if (at <= next->first)
      return entry->second +
             (next->second - entry->second) * (at - entry->first) / (next->first - entry->first);
  return entry->second;
}

/// Number of the event that happens; probabilities above 1 in total cut off the last ones.
template <std::size_t kCount>
int draw(const std::pair<InvalidState, double> (&events)[kCount], RandomStream& random) {
  double chance = random.uniform();
  for (const auto& [state, probability] : events) {
    if (chance < probability) return state;
    chance -= probability;
  }
  return kValid;
}

// Shares of real returns, by range in m (a return is weak up to 0 dBsm) or azimuth in degrees.
int wideScanState(double rcs, const ReturnContext& context, RandomStream& random) {
  const double degrees = std::abs(context.azimuth) * 57.29578;
  const double range = context.range;
  const bool weak = rcs <= 0.0;
  const double crowding = context.isolated ? 0.7 : 1.6;
  if (degrees > 60.0) return kOutsideView;
  if (range > 95.0 && degrees < 9.0 && random.chance(context.sideways ? 0.70 : 0.73)) return kBeyond95m;
  const double low = context.sideways
                         ? lookUp({{12, 0}, {17, 0.08}, {25, 0.32}, {35, 0.61}, {50, 0.76}}, range)
                         : lookUp({{12, 0}, {17, 0.06}, {25, 0.23}, {35, 0.46}, {50, 0.59}}, range);
  const double near_peak = lookUp({{5, 0.04}, {12, 0.09}, {25, 0.11}, {35, 0.13}, {90, 0.15}}, range) *
                           (weak ? 1.35 : 1.0) * (context.sideways ? 0.5 : 1.0) * crowding;
  const double child = lookUp({{5, 0.008}, {12, 0.03}, {17, 0.05}, {25, 0.08}, {35, 0.1}}, range) *
                       (weak ? 1.65 : 1.0) * (context.sideways ? 0.57 : 1.0) * crowding;
  const double multiple =
      lookUp({{5, 0.03}, {17, 0.045}, {32, 0.085}, {42, 0.13}, {52, 0.19}, {58, 0.31}}, degrees) *
      (weak ? lookUp({{20, 1.0}, {45, 0.1}}, range) : 1.0) * (context.sideways ? 0.6 : 1.0);
  const double fifty = degrees > 45.0 && degrees < 55.0 ? 0.18 : 0.0;
  return draw({{kLowRcs, weak ? low : 0.0},
               {kFiftyDegrees, fifty},
               {kChild, child},
               {kNoLocalMaximum, near_peak},
               {kMultipleTargets, multiple}},
              random);
}

int narrowScanState(double rcs, const ReturnContext& context, RandomStream& random) {
  const double degrees = std::abs(context.azimuth) * 57.29578;
  const double range = context.range;
  if (degrees > 9.0) return kOutsideView;
  return draw({{kAzimuthCorrected, range < 14.0 ? (context.sideways ? 0.2 : 0.1) : 0.0},
               {kNotConfirmedNear, lookUp({{8, 0}, {20, 0.22}, {35, 0.25}, {70, 0}}, range)},
               {kLowRcs, rcs <= 0.0 ? lookUp({{15, 0}, {50, 0.5}, {90, 0.6}}, range) : 0.0},
               {kNoLocalMaximum, lookUp({{10, 0}, {40, 0.1}, {80, 0.16}}, range)},
               {kMultipleTargets, context.sideways ? 0.03 : lookUp({{40, 0.06}, {80, 0.16}}, range)}},
              random);
}

int falseAlarmClass(int invalid_state) {
  switch (invalid_state) {
    case kLowRcs:
    case kChild:
    case kFiftyDegrees:
    case kNoLocalMaximum: return 3;
    case kNotConfirmedNear:
    case kOutsideView:
    case kAzimuthCorrected: return 6;
    default: return 1;
  }
}

int ambiguity(int invalid_state, const ReturnContext& context, RandomStream& random) {
  if (invalid_state == kNotConfirmedNear || invalid_state == kOutsideView) return 0;
  if (invalid_state == kAzimuthCorrected) return 3;
  const double staggered =
      context.sideways && !context.narrow ? lookUp({{8, 0.12}, {25, 0.33}, {60, 0.5}}, context.range) : 0.012;
  const bool doubtful = random.chance(context.folded ? 0.55 : staggered);
  return !doubtful ? 3 : random.chance(0.22) ? 2 : 1;
}

int dynamicProperty(const RadarReturn& judged, const ReturnContext& context, const RadarModel& model,
                    RandomStream& random) {
  if (judged.invalid_state == kOutsideView) return kUnknown;
  const bool stationary = std::abs(context.ground_speed) < model.stationary_speed;
  // A radar that looks sideways cannot tell by one Doppler which of two velocities it is.
  if (judged.ambig_state == 1 || judged.ambig_state == 2)
    return stationary && !context.sideways && random.chance(0.22) ? kStationary
           : random.chance(0.5)                                   ? kMoving
                                                                  : kOncoming;
  if (!stationary) {
    if (random.chance(0.09)) return kCrossingMoving;
    return context.ground_speed > 0.0 ? kMoving : kOncoming;
  }
  if (context.sideways) {
    const double crossing = lookUp({{20, 0.5}, {60, 0.15}}, context.range);
    if (random.chance(crossing)) return random.chance(0.2) ? kCrossingStationary : kCrossingMoving;
    if (random.chance(0.2)) return random.chance(0.5) ? kMoving : kOncoming;
  } else if (random.chance(0.02)) {
    return random.chance(0.5) ? kStopped : kCrossingStationary;
  }
  const double candidate = judged.invalid_state == kLowRcs
                               ? 0.58
                               : lookUp({{8, 0.08}, {25, 0.17}, {50, 0.34}, {90, 0.52}}, context.range);
  return random.chance(candidate) ? kStationaryCandidate : kStationary;
}

std::int8_t accuracyCode(double steps, int lowest, RandomStream& random) {
  return static_cast<std::int8_t>(lowest + std::max(0.0, std::floor(steps + random.uniform())));
}

}  // namespace

void judgeReturn(RadarReturn& judged, const ReturnContext& context, const RadarModel& model,
                 RandomStream& random) {
  const double rcs = static_cast<double>(judged.rcs);
  judged.invalid_state = static_cast<std::int8_t>(context.narrow ? narrowScanState(rcs, context, random)
                                                                 : wideScanState(rcs, context, random));
  judged.pdh0 = static_cast<std::int8_t>(falseAlarmClass(judged.invalid_state));
  judged.ambig_state = static_cast<std::int8_t>(ambiguity(judged.invalid_state, context, random));
  judged.dyn_prop = static_cast<std::int8_t>(dynamicProperty(judged, context, model, random));
}

void codeAccuracies(RadarReturn& coded, const ReturnContext& context, RandomStream& random) {
  if (coded.dyn_prop == kUnknown) {
    coded.x_rms = coded.y_rms = coded.vx_rms = coded.vy_rms = 0;
    return;
  }
  const double weakness = std::clamp((16.0 - static_cast<double>(coded.rcs)) / 20.0, 0.0, 1.0);
  const double distance = std::clamp((context.range - 10.0) / 90.0, 0.0, 1.2);
  coded.x_rms =
      accuracyCode(std::pow(weakness, 1.2) * (0.25 + 1.5 * distance), context.narrow ? 21 : 19, random);
  coded.y_rms = accuracyCode(0.05 + std::pow(distance, 1.5) * (1.3 + 1.5 * weakness), 19, random);
  const double obliqueness = std::log(1.0 / std::cos(std::min(1.5, std::abs(context.azimuth))));
  coded.vx_rms = accuracyCode(obliqueness / std::log(1.29), 16, random);
  coded.vy_rms = 3;
}

}  // namespace radar_dot::simulation
