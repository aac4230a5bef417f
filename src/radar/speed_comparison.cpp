// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/speed_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace radar_dot {
namespace {

constexpr double kMemory = 3.0;     // s
constexpr double kMaxGap = 2.0;     // s
constexpr double kLeastTime = 2.0;  // s of readings

// Largest difference of speeds that agree: of a delay while braking, and of a scale.
constexpr double kDifference = 2.0;  // m/s
constexpr double kFraction = 0.25;   // of the larger speed
constexpr double kStill = 0.7;       // of the limits, below which they agree again
constexpr double kStands = 0.1;      // of the other speed

}  // namespace

void SpeedComparison::expire(double time) {
  if (time < time_ || time - time_ > kMaxGap) reset();
}

void SpeedComparison::add(double time, double speed, double reference) {
  if (!std::isfinite(time) || !std::isfinite(speed) || !std::isfinite(reference)) return;
  expire(time);
  const double dt = std::isfinite(time_) ? time - time_ : 0.0;
  time_ = time;
  const auto forget = [dt](double& sum, double value) { sum = std::exp(-dt / kMemory) * sum + dt * value; };
  forget(weight_, 1.0);
  forget(speed_, speed);
  forget(reference_, reference);
  forget(difference_, std::abs(speed - reference));
  // The weight comes near kMemory only after some time: too little of it tells nothing.
  if (weight_ < kMemory * -std::expm1(-kLeastTime / kMemory)) return;
  const double larger = std::max(std::abs(this->speed()), std::abs(this->reference()));
  const double limit =
      std::max(kDifference, kFraction * larger) * (verdict_ == Verdict::kAgree ? 1.0 : kStill);
  verdict_ = mean(difference_) > limit ? cause() : Verdict::kAgree;
}

SpeedComparison::Verdict SpeedComparison::cause() const {
  const double a = speed(), b = reference();
  if (std::abs(a) < kStands * std::abs(b)) return Verdict::kStands;
  if (std::abs(b) < kStands * std::abs(a)) return Verdict::kReferenceStands;
  return std::abs(a / b + 1.0) < kFraction ? Verdict::kOpposite : Verdict::kFactor;
}

std::string SpeedComparison::warning(const std::string& name, const std::string& reference_name,
                                     const std::string& rates) const {
  std::string text = fmt::format("{} drives at {:.1f} m/s, {} at {:.1f} (over {:.0f} s): ", name, speed(),
                                 reference_name, reference(), kMemory);
  switch (verdict_) {
    case Verdict::kAgree: return {};
    case Verdict::kStands:
      return text + rates + " are zero, constant, or compensated for the motion of the vehicle";
    case Verdict::kReferenceStands: return text + "that source does not follow the vehicle";
    case Verdict::kOpposite:
      return text + "opposite signs: doppler_scale -1 for " + rates + ", or that source counts backwards";
    case Verdict::kFactor:
      return text + fmt::format("a factor of {:.2f}: the unit or the scale of ", speed() / reference()) +
             rates + " or of that source, or they are no range rates";
  }
  return text;
}

}  // namespace radar_dot
