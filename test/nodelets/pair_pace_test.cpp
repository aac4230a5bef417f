// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/pair_pace.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

namespace radar_dot {
namespace {

constexpr double kPeriod = 1.0 / 12.0;  // s, of the images
constexpr double kLongest = 1.0;        // s, of a pair

/// A camera, and a machine that computes one pair after the other.
class Machine {
 public:
  /// @param cost   s that a pair takes, by the time and by how many images make one
  /// @param speed  of the replay
  void run(double duration, const std::function<double(double, int)>& cost, double speed = 1.0,
           double asked = 0.0) {
    const double end = stamp_ + duration;
    for (; stamp_ < end; stamp_ += kPeriod) {
      now_ += kPeriod / speed;
      compute(cost, asked);
      pace_.addImage(stamp_, now_);
      if (stamp_ - previous_ < 0.9 * pace_.leastInterval(asked, kLongest)) continue;
      // A later pair takes the place of one that still waits.
      if (waiting_ > 0.0) pace_.addLost();
      if (previous_ > -1.0) waiting_ = stamp_ - previous_;
      previous_ = stamp_;
      arrival_ = now_;
      compute(cost, asked);
    }
  }
  int every(double asked = 0.0) const { return pace_.every(asked, kLongest); }
  /// In images; those of the latest pairs.
  std::vector<int> lastIntervals(std::size_t number) const {
    std::vector<int> images;
    for (std::size_t i = intervals_.size() - number; i < intervals_.size(); ++i)
      images.push_back(static_cast<int>(intervals_[i] / kPeriod + 0.5));
    return images;
  }
  std::size_t pairs() const { return intervals_.size(); }

 private:
  void compute(const std::function<double(double, int)>& cost, double asked) {
    if (waiting_ == 0.0 || free_ > now_) return;
    const double seconds = cost(stamp_, every(asked));
    free_ = std::max(free_, arrival_) + seconds;
    intervals_.push_back(std::exchange(waiting_, 0.0));
    pace_.addPair(intervals_.back(), seconds, free_);
  }

  PairPace pace_;
  double stamp_ = 0.0, now_ = 1000.0, free_ = 0.0, previous_ = -2.0, waiting_ = 0.0, arrival_ = 0.0;
  std::vector<double> intervals_;
};

std::function<double(double, int)> always(double seconds) {
  return [seconds](double, int) { return seconds; };
}

TEST(PairPace, EachImageWhereThereIsTime) {
  Machine machine;
  machine.run(60.0, always(0.07));
  EXPECT_EQ(machine.every(), 1);
  EXPECT_EQ(machine.pairs(), 719U);
}

TEST(PairPace, EverySecondOrThirdImageEvenlyWhereThereIsNot) {
  for (const auto& [seconds, every] :
       {std::pair(0.1, 2), std::pair(0.14, 2), std::pair(0.2, 3), std::pair(0.8, 4)}) {
    Machine machine;
    machine.run(20.0, always(seconds));
    EXPECT_EQ(machine.every(), every) << seconds;
    EXPECT_EQ(machine.lastIntervals(10), std::vector<int>(10, every)) << seconds;
  }
}

TEST(PairPace, WhoWaitsForEachPairGetsAll) {
  PairPace pace;
  for (int i = 0; i < 100; ++i) {
    pace.addImage(0.5 * i, 1000.0 + 0.21 * i);
    pace.addPair(0.5, 0.2, 1000.2 + 0.21 * i);
  }
  EXPECT_GT(pace.load(), 0.9);
  EXPECT_EQ(pace.every(0.0, kLongest), 1);
}

TEST(PairPace, OneSlowPairChangesNothing) {
  Machine machine;
  machine.run(30.0, [](double time, int) { return time > 10.0 && time < 10.05 ? 3.0 : 0.04; });
  EXPECT_EQ(machine.every(), 1);
}

TEST(PairPace, QuickensWhereTheMachineIsFreeAgain) {
  Machine machine;
  machine.run(20.0, always(0.12));
  ASSERT_EQ(machine.every(), 2);
  machine.run(20.0, always(0.03));
  EXPECT_EQ(machine.every(), 1);
}

TEST(PairPace, TriesLessAndLessOftenWhatFails) {
  // With each image everything fights for the cores, with every second one it does not.
  Machine machine;
  int changes = 0, last = 1;
  machine.run(600.0, [&](double, int every) {
    changes += every != last ? 1 : 0;
    last = every;
    return every == 1 ? 0.12 : 0.04;
  });
  EXPECT_GE(changes, 3) << "a quicker pace is tried";
  EXPECT_LE(changes, 30);
}

TEST(PairPace, AReplayHasItsOwnSpeed) {
  Machine machine;
  machine.run(20.0, always(0.2), 0.25);
  EXPECT_EQ(machine.every(), 1);
  machine.run(20.0, always(0.06), 4.0);
  EXPECT_EQ(machine.every(), 3);
}

TEST(PairPace, KeepsToTheIntervalsThatAreAskedForAndAllowed) {
  // 0.4 s is five images; what takes 0.5 s gets twice that, and no more than is allowed.
  Machine machine;
  machine.run(60.0, always(0.5), 1.0, 0.4);
  EXPECT_EQ(machine.every(0.4), 2);
  EXPECT_EQ(machine.every(0.6), 1);
  for (const int images : machine.lastIntervals(10)) EXPECT_NEAR(images, 9.5, 1.0);
}

TEST(PairPace, AGapIsNoPeriod) {
  PairPace pace;
  double stamp = 0.0;
  for (int i = 0; i < 60; ++i) {
    stamp += i == 40 ? 30.0 : kPeriod;
    pace.addImage(stamp, 1000.0 + stamp);
    pace.addLost();
    if (i > 0) pace.addPair(kPeriod, 0.12, 1000.0 + stamp);
  }
  EXPECT_EQ(pace.every(0.0, kLongest), PairPace::kSlowest);
  EXPECT_NEAR(pace.leastInterval(0.0, kLongest), pace.every(0.0, kLongest) * kPeriod, 1e-9);
}

}  // namespace
}  // namespace radar_dot
