// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/yaw_rate_comparison.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace radar_dot {
namespace {

constexpr double kSmoothing = 0.7;   // s
constexpr double kMemory = 3.0;      // s
constexpr double kLongMemory = 6.0;  // s
constexpr double kMaxGap = 2.0;      // s
constexpr double kLeastTime = 2.0;   // s of readings

// Largest difference of rates that agree.
constexpr double kDifference = 0.04;  // rad/s
constexpr double kFraction = 0.2;     // of the rate
constexpr double kSigmas = 4.0;
constexpr double kStill = 0.7;  // of the limits, below which they agree again

constexpr double kDegrees = 57.3;

}  // namespace

void YawRateComparison::expire(double time) {
  if (time < time_ || time - time_ > kMaxGap) reset();
}

void YawRateComparison::add(double time, double rate, double std, double reference) {
  if (!std::isfinite(rate) || !std::isfinite(reference) || !std::isfinite(std)) return;
  expire(time);
  if (!std::isfinite(time_)) {
    time_ = time;
    return;
  }
  const double dt = time - time_;
  time_ = time;
  const auto forget = [&](double& sum, double memory, double value) {
    sum = std::exp(-dt / memory) * sum + dt * value;
  };
  smooth_ += (1.0 - std::exp(-dt / kSmoothing)) * (rate - reference - smooth_);
  forget(weight_, kMemory, 1.0);
  forget(rate_, kMemory, rate);
  forget(reference_, kMemory, reference);
  forget(difference_, kMemory, std::abs(smooth_));
  forget(variance_, kMemory, std * std);
  forget(size_, kMemory, std::min(std::abs(rate), std::abs(reference)));
  forget(long_weight_, kLongMemory, 1.0);
  forget(aa_, kLongMemory, rate * rate);
  forget(ab_, kLongMemory, rate * reference);
  forget(bb_, kLongMemory, reference * reference);
  forget(signed_, kLongMemory, rate - reference);

  // The weight comes near kMemory only after some time: too little of it tells nothing.
  if (weight_ < kMemory * -std::expm1(-kLeastTime / kMemory)) return;
  const double limit =
      std::max({kDifference, kSigmas * std::sqrt(mean(variance_)), kFraction * mean(size_)}) *
      (verdict_ == Verdict::kAgree ? 1.0 : kStill);
  verdict_ = difference() > limit ? cause() : Verdict::kAgree;
}

/// Which of rate = k reference and rate = reference + c fits better.
YawRateComparison::Verdict YawRateComparison::cause() const {
  const double squares = aa_ - 2.0 * ab_ + bb_;  // of the differences
  const double of_offset = squares - signed_ * signed_ / long_weight_;
  const double of_factor = bb_ > 0.0 ? aa_ - ab_ * ab_ / bb_ : aa_;
  const double factor = bb_ > 0.0 ? ab_ / bb_ : 0.0;
  if (factor < -0.5 && of_factor < 0.3 * aa_) return Verdict::kOpposite;
  const double ratio = std::sqrt(aa_ / std::max(bb_, 1e-12));
  for (const double degrees : {kDegrees, 1.0 / kDegrees}) {
    if (std::abs(ratio / degrees - 1.0) < 0.3 && of_factor < 0.3 * aa_) return Verdict::kDegrees;
  }
  return of_offset < of_factor ? Verdict::kOffset : Verdict::kFactor;
}

std::string YawRateComparison::warning(const std::string& name, const std::string& reference_name,
                                       const char* remedy) const {
  std::string text = fmt::format("{} turns by {:.2f} rad/s, {} by {:.2f} (over {:.0f} s): ", name, rate(),
                                 reference_name, reference(), kMemory);
  switch (verdict_) {
    case Verdict::kAgree: return {};
    case Verdict::kOpposite:
      return text + "opposite signs: the vertical axis of the frame of one of them points down in TF";
    case Verdict::kDegrees: return text + "one of them is in degrees per second";
    case Verdict::kOffset:
      return text +
             "they differ whatever the rate: an offset of the gyroscope, or the mount of a radar is turned";
    case Verdict::kFactor: return text + remedy;
  }
  return text;
}

}  // namespace radar_dot
