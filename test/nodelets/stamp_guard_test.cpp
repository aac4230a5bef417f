// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/stamp_guard.h"

#include <gtest/gtest.h>

#include "nodelets/common/log_throttle.h"
#include "nodelets/common/monitors.h"

namespace radar_dot {
namespace {

using Verdict = StampGuard::Verdict;

TEST(StampGuard, OneOldStampIsStaleAndFiveInARowAreARestart) {
  StampGuard guard;
  EXPECT_EQ(guard.check(ros::Time(100.0)), Verdict::kGood);
  EXPECT_EQ(guard.check(ros::Time(100.0)), Verdict::kStale) << "not later";
  EXPECT_EQ(guard.check(ros::Time(10.0)), Verdict::kStale);
  EXPECT_EQ(guard.check(ros::Time(100.1)), Verdict::kGood) << "a glitch leaves no trace";
  for (int i = 0; i < 4; ++i) EXPECT_EQ(guard.check(ros::Time(10.0 + i)), Verdict::kStale);
  EXPECT_EQ(guard.check(ros::Time(14.0)), Verdict::kRestart);
  EXPECT_EQ(guard.check(ros::Time(14.1)), Verdict::kGood);
}

TEST(StampGuard, SmallDisorderOrAStampThatStandsStillNeverRestarts) {
  StampGuard guard;
  guard.check(ros::Time(100.0));
  for (int i = 0; i < 20; ++i) EXPECT_EQ(guard.check(ros::Time(5.0)), Verdict::kStale);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(guard.check(ros::Time(99.5)), Verdict::kStale);
}

TEST(StampGuard, RecoversFromTheLastStampThereIs) {
  StampGuard guard;
  EXPECT_EQ(guard.check(ros::Time(4294967000U, 0)), Verdict::kGood);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(guard.check(ros::Time(5.0 + i)), Verdict::kStale);
  EXPECT_EQ(guard.check(ros::Time(9.0)), Verdict::kRestart);
}

TEST(IsAhead, ToleratesASecondAndNeedsAClock) {
  EXPECT_FALSE(isAhead(ros::Time(10.9), ros::Time(10.0)));
  EXPECT_TRUE(isAhead(ros::Time(11.1), ros::Time(10.0)));
  EXPECT_TRUE(isAhead(ros::Time(4294967000U, 0), ros::Time(10.0))) << "ros::Duration would overflow";
  EXPECT_FALSE(isAhead(ros::Time(11.1), ros::Time()));
}

TEST(ClockWatch, SeesEachStepBackOnce) {
  ClockWatch clock;
  EXPECT_FALSE(clock.wentBack(ros::Time(100.0)));
  EXPECT_FALSE(clock.wentBack(ros::Time(99.5)));
  EXPECT_TRUE(clock.wentBack(ros::Time(98.9)));
  EXPECT_FALSE(clock.wentBack(ros::Time(98.9)));
  EXPECT_FALSE(clock.wentBack(ros::Time(99.9)));
}

TEST(LogThrottle, FiguresAndNamesFromMessagesMakeNoNewKind) {
  LogThrottle throttle(60.0);
  EXPECT_TRUE(throttle.allow("radar_1", "it has 10 bytes of data for 'a'"));
  EXPECT_FALSE(throttle.allow("radar_1", "it has 999 bytes of data for 'bc'"));
  EXPECT_TRUE(throttle.allow("radar_2", "it has 10 bytes of data for 'a'")) << "another radar";
  EXPECT_TRUE(throttle.allow("radar_1", "its stamp is zero")) << "another kind";
  EXPECT_EQ(throttle.size(), 3U);
}

TEST(StreamMonitor, SurvivesStampsDecadesAway) {
  StreamMonitor monitor;
  monitor.tick(ros::Time(5.0), ros::Time(10.0));
  monitor.tick(ros::Time(4294967000U, 0), ros::Time(10.0));
  EXPECT_GT(monitor.rate(), 0.0);
  EXPECT_LT(monitor.age(), -4e9);
  EXPECT_EQ(monitor.silence(ros::Time(4294967000U, 0)), 4294966990.0);
}

TEST(RadarMonitor, NamesARadarWhoseScansNoSweepUses) {
  RadarMonitor monitor("radar", {}, 0.1);
  monitor.setTopic("/radar");
  diagnostic_updater::DiagnosticStatusWrapper status;
  double seconds = 100.0;
  const auto scans = [&](int used) {
    for (int i = 0; i < 13; ++i) {
      std_msgs::Header header;
      header.stamp.fromSec(seconds += 1.0 / 13.0);
      header.frame_id = "front";
      monitor.accept(header, header.stamp);
      monitor.scan(header.frame_id, {}, 0);
      if (i < used) monitor.used();
    }
    monitor.report(ros::Time(seconds), status);
  };
  scans(12);
  EXPECT_EQ(status.level, diagnostic_msgs::DiagnosticStatus::OK) << "one may wait for its sweep";
  scans(0);
  EXPECT_EQ(status.level, diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_NE(status.message.find("13 of 13 scans outside the window of 0.10 s"), std::string::npos)
      << status.message;
}

// What a radar sends after `frame`, and of it what is reported.
std::string reportAfter(const std::string& frame, std::size_t lost) {
  RadarMonitor monitor("radar", {}, 0.1);
  monitor.setTopic("/radar");
  std_msgs::Header header;
  header.stamp.fromSec(100.0);
  header.frame_id = "front";
  monitor.accept(header, header.stamp);
  monitor.scan("front", {}, 0);
  monitor.used();
  monitor.scan(frame, {}, lost);
  monitor.used();
  diagnostic_updater::DiagnosticStatusWrapper status;
  monitor.report(header.stamp, status);
  return std::to_string(static_cast<int>(status.level)) + " " + status.message;
}

TEST(RadarMonitor, WarnsOfSharedTopicsAndLostClouds) {
  EXPECT_EQ(reportAfter("front", 0).front(), '0') << reportAfter("front", 0);
  EXPECT_NE(reportAfter("rear", 0).find("only_frame"), std::string::npos) << reportAfter("rear", 0);
  EXPECT_NE(reportAfter("front", 3).find("3 of 5 clouds lost"), std::string::npos) << reportAfter("front", 3);
}

}  // namespace
}  // namespace radar_dot
