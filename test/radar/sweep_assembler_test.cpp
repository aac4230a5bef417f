// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/sweep_assembler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace radar_dot {
namespace {

using Assembler = SweepAssembler<int>;
using Outcome = Assembler::Outcome;
using Sweep = Assembler::Sweep;

// The radars of the sweeps that a scan completes, as text: "01|2".
std::string add(Assembler& assembler, std::size_t radar, double time) {
  std::vector<Sweep> sweeps;
  assembler.add({radar, time, 0}, sweeps);
  std::string text;
  for (const Sweep& sweep : sweeps) {
    if (!text.empty()) text += "|";
    for (const Assembler::Scan& scan : sweep.scans) text += std::to_string(scan.radar);
  }
  return text;
}

TEST(SweepAssembler, OneRadarCompletesASweepWithEveryScan) {
  Assembler assembler(1);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(add(assembler, 0, 0.1 * i), "0");
}

TEST(SweepAssembler, WaitsForEveryRadar) {
  Assembler assembler(3);
  EXPECT_EQ(add(assembler, 0, 0.00), "");
  EXPECT_EQ(add(assembler, 1, 0.01), "");
  EXPECT_EQ(add(assembler, 2, 0.02), "012");
  EXPECT_EQ(add(assembler, 1, 0.08), "");
  EXPECT_EQ(add(assembler, 0, 0.09), "");
  EXPECT_EQ(add(assembler, 2, 0.10), "012");
}

TEST(SweepAssembler, SecondScanOfARadarEndsTheWaiting) {
  Assembler assembler(2);
  EXPECT_EQ(add(assembler, 0, 0.00), "");
  EXPECT_EQ(add(assembler, 0, 0.07), "0") << "of 0.00 s; the scan of 0.07 s begins the next";
  EXPECT_EQ(add(assembler, 1, 0.08), "01");
}

TEST(SweepAssembler, SilentRadarIsNotWaitedForUntilItIsBack) {
  Assembler assembler(2, {0.1, 0.3, 1.0});
  add(assembler, 0, 0.00);
  EXPECT_EQ(add(assembler, 1, 0.01), "01");
  EXPECT_EQ(add(assembler, 0, 0.10), "");
  EXPECT_EQ(add(assembler, 0, 0.20), "0");
  EXPECT_EQ(add(assembler, 0, 0.40), "0|0") << "the waiting scan, then the new one at once";
  EXPECT_EQ(add(assembler, 0, 0.50), "0");
  EXPECT_EQ(add(assembler, 1, 0.55), "") << "back: radar 0 is live and awaited";
  EXPECT_EQ(add(assembler, 0, 0.60), "01");
}

TEST(SweepAssembler, RadarThatNeverSpeaksIsAwaitedAtTheBeginningOnly) {
  Assembler assembler(2, {0.1, 0.3, 1.0});
  EXPECT_EQ(add(assembler, 0, 7.00), "");
  EXPECT_EQ(add(assembler, 0, 7.20), "0");
  EXPECT_EQ(add(assembler, 0, 7.40), "0|0");
  EXPECT_EQ(add(assembler, 0, 7.50), "0");
}

TEST(SweepAssembler, ScansOlderThanTheWindowAreLeftOut) {
  Assembler assembler(2, {0.05, 0.5, 1.0});
  add(assembler, 0, 0.01);
  std::vector<Sweep> sweeps;
  assembler.add({1, 0.20, 0}, sweeps);
  ASSERT_EQ(sweeps.size(), 1U);
  EXPECT_EQ(sweeps[0].scans.size(), 1U);
  EXPECT_EQ(sweeps[0].left_out, 1U);
  EXPECT_EQ(sweeps[0].time(), 0.20);
}

TEST(SweepAssembler, NewestScanGivesTheTimeWhateverTheOrderOfArrival) {
  Assembler assembler(3);
  add(assembler, 1, 0.03);
  add(assembler, 2, 0.02);
  std::vector<Sweep> sweeps;
  assembler.add({0, 0.025, 0}, sweeps);
  ASSERT_EQ(sweeps.size(), 1U);
  EXPECT_EQ(sweeps[0].time(), 0.03);
  EXPECT_EQ(sweeps[0].scans[sweeps[0].newest].radar, 1U);
}

TEST(SweepAssembler, RepeatedAndLateScansOfARadarAreStale) {
  Assembler assembler(1);
  std::vector<Sweep> sweeps;
  EXPECT_EQ(assembler.add({0, 5.0, 0}, sweeps), Outcome::kAdded);
  EXPECT_EQ(assembler.add({0, 5.0, 0}, sweeps), Outcome::kStale);
  EXPECT_EQ(assembler.add({0, 4.5, 0}, sweeps), Outcome::kStale);
  EXPECT_TRUE(sweeps.empty());
}

TEST(SweepAssembler, TimeGoingBackStartsAnewOnce) {
  Assembler assembler(2);
  add(assembler, 0, 100.00);
  add(assembler, 1, 100.01);
  std::vector<Sweep> sweeps;
  add(assembler, 0, 100.07);
  EXPECT_EQ(assembler.add({0, 2.0, 0}, sweeps), Outcome::kReset);
  EXPECT_TRUE(sweeps.empty()) << "the scan of 100.07 s is forgotten";
  EXPECT_EQ(assembler.add({1, 2.01, 0}, sweeps), Outcome::kAdded)
      << "the second radar's step back is no news";
  ASSERT_EQ(sweeps.size(), 1U);
  EXPECT_EQ(sweeps[0].scans.size(), 2U);
  EXPECT_EQ(sweeps[0].time(), 2.01);
}

// Law: with any jitter and any silences no scan is used twice, no sweep goes back in time, and
// every sweep lies within its window.
TEST(SweepAssembler, RandomStreamsKeepTheInvariants) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    const SweepParams params;
    Assembler assembler(5, params);
    std::vector<std::pair<double, std::size_t>> stream;
    for (std::size_t radar = 0; radar < 5; ++radar) {
      double time = 0.1 * unit(random);
      for (int i = 0; i < 200; ++i) {
        time += 0.06 + 0.03 * unit(random) + (unit(random) < 0.02 ? 1.0 : 0.0);
        stream.emplace_back(time, radar);
      }
    }
    std::sort(stream.begin(), stream.end());
    std::size_t used = 0, left_out = 0;
    double previous = -1.0;
    std::vector<double> last(5, -1.0);
    for (const auto& [time, radar] : stream) {
      std::vector<Sweep> sweeps;
      ASSERT_EQ(assembler.add({radar, time, 0}, sweeps), Outcome::kAdded);
      for (const Sweep& sweep : sweeps) {
        EXPECT_GT(sweep.time(), previous);
        previous = sweep.time();
        used += sweep.scans.size();
        left_out += sweep.left_out;
        for (const Assembler::Scan& scan : sweep.scans) {
          EXPECT_GT(scan.time, last[scan.radar]) << "used twice";
          last[scan.radar] = scan.time;
          EXPECT_LE(scan.time, sweep.time());
          EXPECT_GE(scan.time, sweep.time() - params.window);
        }
      }
    }
    EXPECT_GT(used, stream.size() * 9 / 10);
    EXPECT_GE(used + left_out + 5, stream.size()) << "a scan got lost";
  }
}

}  // namespace
}  // namespace radar_dot
