// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/pair_pace.h"

#include <algorithm>
#include <cmath>

namespace radar_dot {
namespace {

constexpr int kImages = 20;             // that the period is a mean of
constexpr double kGap = 5.0;            // periods, that do not count
constexpr double kWeight = 0.2;         // of the latest pair
constexpr double kLongest = 2.0;        // load of a pair that counts: one alone changes nothing
constexpr double kLost = 0.3;           // one pair among the latest five
constexpr double kFull = 0.9;           // load from which on pairs are lost by chance
constexpr double kEasy = 0.6;           // that a quicker pace may have; others work meanwhile
constexpr double kPatience = 5.0;       // s
constexpr double kMostPatience = 60.0;  // s, after a quicker pace has failed again and again

}  // namespace

void PairPace::addImage(double stamp, double now) {
  if (images_ > 1 && stamp - stamp_ > kGap * period_) {
    images_ = 1;  // the next image starts the period again
  } else if (images_ > 0) {
    const double weight = 1.0 / std::min(images_, kImages);
    period_ += weight * (stamp - stamp_ - period_);
    wall_period_ += weight * (now - now_ - wall_period_);
  }
  ++images_;
  stamp_ = stamp;
  now_ = now;
}

void PairPace::addPair(double interval, double seconds, double now) {
  if (period_ <= 0.0 || wall_period_ <= 0.0) return;
  // A replay has its own speed.
  const double time_for_it = interval * wall_period_ / period_;
  load_ += kWeight * (std::min(seconds / time_for_it, kLongest) - load_);
  lost_ *= 1.0 - kWeight;
  const double quicker = every_ > 1 ? load_ * every_ / (every_ - 1) : 0.0;
  // Whoever feeds images one by one, and waits for what comes of each, loses none, and must get all.
  if (load_ > kFull && lost_ > kLost && every_ < kSlowest) {
    load_ *= static_cast<double>(every_) / (every_ + 1);
    ++every_;
    // What has failed just now would fail again, and each try costs evenness.
    const bool was_tried = patience_ > 0.0 && now - quickened_ < kMostPatience;
    patience_ = was_tried ? std::min(2.0 * patience_, kMostPatience) : kPatience;
    easy_since_ = now;
  } else if (every_ == 1 || quicker > kEasy) {
    easy_since_ = now;
  } else if (now - easy_since_ > patience_) {
    load_ = quicker;
    --every_;
    easy_since_ = quickened_ = now;
  }
}

int PairPace::every(double asked, double longest) const {
  const double base = std::max(asked, period_);
  return base > 0.0 ? std::max(1, std::min(every_, static_cast<int>(longest / base))) : 1;
}

double PairPace::leastInterval(double asked, double longest) const {
  const int number = every(asked, longest);
  return number > 1 ? number * std::max(asked, period_) : asked;
}

}  // namespace radar_dot
