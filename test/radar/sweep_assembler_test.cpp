// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/sweep_assembler.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "radar_dot/radar/sequence_watch.h"

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

std::size_t lostInAll(const Assembler& assembler) {
  std::size_t count = 0;
  for (const SweepLosses& radar : assembler.losses())
    count += radar.outside_window + radar.late + radar.stale + radar.forgotten;
  return count;
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

// The keyframes of nuScenes: five radars at 2 Hz, within 80 ms, in any order.
TEST(SweepAssembler, RadarsSlowerThanSilentAfterAreAwaitedToo) {
  Assembler assembler(5);
  std::mt19937 random(1);
  std::uniform_real_distribution<double> delay(0.0, 0.08);
  std::vector<std::pair<double, std::size_t>> scans;
  for (int i = 0; i < 40; ++i)
    for (std::size_t radar = 0; radar < 5; ++radar) scans.emplace_back(0.55 * i + delay(random), radar);
  std::sort(scans.begin(), scans.end());
  std::size_t complete = 0;
  for (const auto& [time, radar] : scans) complete += add(assembler, radar, time) == "01234" ? 1 : 0;
  EXPECT_GE(complete, 39U) << "of the first ones the interval is not known";
  // A slow radar does not hold up a quick one.
  Assembler mixed(2);
  for (const double time : {0.0, 1.0}) {
    add(mixed, 1, time);
    for (int i = 1; i < 10; ++i) {
      const std::string sweeps = add(mixed, 0, time + 0.1 * i);
      EXPECT_TRUE(i <= 6 || sweeps == "0") << time << " " << i << " " << sweeps;
    }
  }
}

TEST(SweepAssembler, ScansOlderThanTheWindowAreLeftOut) {
  Assembler assembler(2, {0.05, 0.5, 1.0});
  add(assembler, 0, 0.01);
  std::vector<Sweep> sweeps;
  assembler.add({1, 0.20, 0}, sweeps);
  ASSERT_EQ(sweeps.size(), 1U);
  EXPECT_EQ(sweeps[0].scans.size(), 1U);
  EXPECT_EQ(sweeps[0].left_out, 1U);
  EXPECT_EQ(assembler.losses()[0].outside_window, 1U);
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
  EXPECT_EQ(assembler.add({0, std::nan(""), 0}, sweeps), Outcome::kStale);
  EXPECT_TRUE(sweeps.empty());
  EXPECT_EQ(assembler.losses()[0].stale, 3U);
}

TEST(SweepAssembler, AScanThatCameAfterItsSweepIsLate) {
  Assembler assembler(2);
  add(assembler, 0, 0.00);
  EXPECT_EQ(add(assembler, 0, 0.07), "0");
  EXPECT_EQ(add(assembler, 1, 0.01), "01") << "of 0.07 s";
  EXPECT_EQ(add(assembler, 1, 0.02), "") << "may go into the next sweep";
  EXPECT_EQ(add(assembler, 1, 0.08), "") << "goes into it instead";
  EXPECT_EQ(assembler.losses()[1].late, 1U);
  EXPECT_EQ(add(assembler, 0, 0.14), "") << "the other was up to 0.06 s late so far, and is again";
  EXPECT_EQ(add(assembler, 1, 0.15), "01") << "of 0.14 s";
  EXPECT_EQ(lostInAll(assembler), 1U);
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
  EXPECT_EQ(assembler.losses()[0].forgotten, 1U);
}

// A clock that was set wrong: the sweeps that its scans belong to are over.
TEST(SweepAssembler, ARadarThatIsAlwaysLaterThanTheWindowHoldsNobodyUp) {
  Assembler assembler(2);
  for (int i = 0; i < 100; ++i) {
    const double time = 10.0 + 0.07 * i;
    const std::string completed = add(assembler, 0, time) + add(assembler, 1, time + (i < 30 ? 0.01 : -0.3));
    const bool is_settled = i < 30 || i > 50;
    EXPECT_TRUE(!is_settled || completed == (i < 30 ? "01" : "0")) << i << ": " << completed;
  }
  EXPECT_GE(assembler.losses()[1].outside_window, 50U);
  EXPECT_EQ(assembler.losses()[0].outside_window, 0U);
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
    std::size_t used = 0;
    double previous = -1.0;
    std::vector<double> last(5, -1.0);
    for (const auto& [time, radar] : stream) {
      std::vector<Sweep> sweeps;
      ASSERT_EQ(assembler.add({radar, time, 0}, sweeps), Outcome::kAdded);
      for (const Sweep& sweep : sweeps) {
        EXPECT_GT(sweep.time(), previous);
        previous = sweep.time();
        used += sweep.scans.size();
        for (const Assembler::Scan& scan : sweep.scans) {
          EXPECT_GT(scan.time, last[scan.radar]) << "used twice";
          last[scan.radar] = scan.time;
          EXPECT_LE(scan.time, sweep.time());
          EXPECT_GE(scan.time, sweep.time() - params.window);
        }
      }
    }
    EXPECT_GT(used, stream.size() * 9 / 10);
    assembler.reset();
    EXPECT_EQ(used + lostInAll(assembler), stream.size()) << "a scan got lost without a reason";
  }
}

struct Arrival {
  double time, arrival;
  std::size_t radar;
};

// The sweeps of scans that arrive in this order, as text: "13.370 s of 0 2 3".
std::vector<std::string> sweepsOf(const std::vector<Arrival>& scans) {
  Assembler assembler(4);
  std::vector<std::string> texts;
  std::vector<Sweep> sweeps;
  for (const Arrival& scan : scans) {
    assembler.add({scan.radar, scan.time, 0}, sweeps);
    for (const Sweep& sweep : sweeps) {
      texts.push_back(std::to_string(sweep.time()) + " s of");
      for (const Assembler::Scan& one : sweep.scans) texts.back() += " " + std::to_string(one.radar);
    }
  }
  return texts;
}

// Law: once the delays among the radars are known, sweeps depend on the stamps alone.
TEST(SweepAssembler, TheOrderOfArrivalDoesNotMatter) {
  constexpr double kDelay = 0.09, kShortest = 0.06;  // s
  for (unsigned seed = 1; seed <= 50; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<Arrival> ordered, mixed;
    for (std::size_t radar = 0; radar < 4; ++radar) {
      // At first all show how late they may be, and how close their scans follow each other.
      double time = radar == 0 ? kDelay : 0.0, arrival = 0.1 + 0.001 * static_cast<double>(radar);
      for (int i = 0; i < 200; ++i) {
        if (i > 0) time += kShortest;
        if (i > 10) time += 1e-6 + 0.03 * unit(random) + (unit(random) < 0.03 ? 0.2 : 0.0);
        if (i > 0) arrival = std::max(arrival, time + kDelay);
        ordered.push_back({time, arrival, radar});
        if (i > 10) arrival = std::max(mixed.back().arrival, time + unit(random) * kDelay);
        mixed.push_back({time, arrival, radar});
      }
      for (std::vector<Arrival>* scans : {&ordered, &mixed})  // completes what waits
        scans->push_back({1000.0, 1000.0 + static_cast<double>(radar), radar});
    }
    for (std::vector<Arrival>* scans : {&ordered, &mixed})
      std::stable_sort(scans->begin(), scans->end(),
                       [](const Arrival& a, const Arrival& b) { return a.arrival < b.arrival; });
    EXPECT_FALSE(std::is_sorted(mixed.begin() + 40, mixed.end(),
                                [](const Arrival& a, const Arrival& b) { return a.time < b.time; }));
    EXPECT_EQ(sweepsOf(mixed), sweepsOf(ordered));
  }
}

// A quick replay: 0.4 s of one radar after 0.4 s of another. Only the first of them surprise.
TEST(SweepAssembler, NothingIsLostWhenScansArriveInHeaps) {
  Assembler assembler(5);
  std::size_t lost_at_first = 0;
  for (int heap = 0; heap < 20; ++heap) {
    for (std::size_t radar = 0; radar < 5; ++radar)
      for (int i = 0; i < 5; ++i)
        add(assembler, radar, 0.4 * heap + 0.08 * i + 0.015 * static_cast<double>(radar));
    if (heap == 1) lost_at_first = lostInAll(assembler);
  }
  EXPECT_GT(lost_at_first, 0U);
  EXPECT_EQ(lostInAll(assembler), lost_at_first);
}

TEST(SequenceWatch, CountsGapsAndMistrustsWhatIsNoCount) {
  SequenceWatch watch;
  EXPECT_EQ(watch.lostBefore(7), 0U) << "nothing is known of what was before";
  EXPECT_EQ(watch.lostBefore(8), 0U);
  EXPECT_EQ(watch.lostBefore(12), 3U);
  EXPECT_EQ(watch.lostBefore(0), 0U) << "starts again";
  EXPECT_EQ(watch.lostBefore(0), 0U) << "does not count";
  EXPECT_EQ(watch.lostBefore(2), 1U);
  EXPECT_EQ(watch.lostBefore(90000), 0U) << "another publisher";
  watch.lostBefore(0xffffffffU);
  EXPECT_EQ(watch.lostBefore(1), 1U) << "the number wraps";
}

}  // namespace
}  // namespace radar_dot
