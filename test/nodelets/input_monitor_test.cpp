// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "fixtures/refusal.h"
#include "nodelets/common/monitors.h"

namespace radar_dot {
namespace {

using diagnostic_msgs::DiagnosticStatus;
using diagnostic_updater::DiagnosticStatusWrapper;
using test::expectRefusal;

const ros::Time kNow(100.0);

std_msgs::Header headerAt(double stamp, const std::string& frame = "camera") {
  std_msgs::Header header;
  header.stamp = ros::Time(stamp);
  header.frame_id = frame;
  return header;
}

// Any rate, as of cameras; silent after 2 s.
InputMonitor monitorOf(bool required) {
  StreamExpectation expectation;
  expectation.rate = 0.0;
  expectation.max_age = 1.0;
  expectation.silent_after = 2.0;
  InputMonitor monitor("depth", expectation, required);
  monitor.setTopic("/depth/image");
  return monitor;
}

DiagnosticStatusWrapper reportOf(InputMonitor& monitor, const ros::Time& now = kNow) {
  DiagnosticStatusWrapper status;
  monitor.report(now, status);
  return status;
}

// Of a figure in the status; "(none)" where there is no such figure.
std::string figure(const DiagnosticStatusWrapper& status, const std::string& key) {
  for (const diagnostic_msgs::KeyValue& value : status.values)
    if (value.key == key) return value.value;
  return "(none)";
}

TEST(CheckHeader, NamesWhatIsWrong) {
  EXPECT_NO_THROW(checkHeader(headerAt(100.0), kNow));
  EXPECT_NO_THROW(checkHeader(headerAt(100.9), kNow)) << "clocks differ a little";
  EXPECT_NO_THROW(checkHeader(headerAt(5.0), kNow)) << "an old stamp is for the order of stamps to judge";
  EXPECT_NO_THROW(checkHeader(headerAt(5.0), ros::Time())) << "a clock at zero says nothing";
  expectRefusal([] { checkHeader(headerAt(100.0, ""), kNow); }, {"frame_id is empty"});
  expectRefusal([] { checkHeader(headerAt(0.0), kNow); }, {"stamp is zero"});
  expectRefusal([] { checkHeader(headerAt(101.5), kNow); }, {"ahead of the clock"});
}

TEST(InputMonitor, KnowsItsNameAndTopic) {
  InputMonitor monitor("depth", {}, true);
  EXPECT_EQ(monitor.name(), "depth");
  EXPECT_EQ(monitor.topic(), "");
  monitor.setTopic("/depth/image");
  EXPECT_EQ(monitor.topic(), "/depth/image");
}

TEST(InputMonitor, AcceptsRisingStampsAndRefusesTheOthers) {
  InputMonitor monitor = monitorOf(true);
  EXPECT_TRUE(monitor.accept(headerAt(99.0), kNow));
  EXPECT_TRUE(monitor.accept(headerAt(99.1), kNow));
  for (const double stale : {99.1, 99.05, 50.0}) {
    expectRefusal([&] { monitor.accept(headerAt(stale), kNow); }, {"stamp not newer"});
  }
  EXPECT_TRUE(monitor.accept(headerAt(99.2), kNow));
}

TEST(InputMonitor, ABadHeaderLeavesTheOrderAlone) {
  InputMonitor monitor = monitorOf(true);
  EXPECT_TRUE(monitor.accept(headerAt(99.0), kNow));
  EXPECT_THROW(monitor.accept(headerAt(99.5, ""), kNow), std::invalid_argument);
  EXPECT_THROW(monitor.accept(headerAt(0.0), kNow), std::invalid_argument);
  EXPECT_THROW(monitor.accept(headerAt(500.0), kNow), std::invalid_argument);
  EXPECT_TRUE(monitor.accept(headerAt(99.1), kNow)) << "none of them was taken into the order";
}

TEST(InputMonitor, FiveOlderStampsAreARestart) {
  InputMonitor monitor = monitorOf(true);
  EXPECT_TRUE(monitor.accept(headerAt(99.0), kNow));
  for (int i = 0; i < 4; ++i)
    EXPECT_THROW(monitor.accept(headerAt(10.0 + i), kNow), std::invalid_argument) << i;
  EXPECT_FALSE(monitor.accept(headerAt(14.0), kNow)) << "everything from before is to be forgotten";
  EXPECT_TRUE(monitor.accept(headerAt(14.1), kNow));
}

TEST(InputMonitor, ResetForgetsTheOrderButNotWhatWasRefused) {
  InputMonitor monitor = monitorOf(true);
  monitor.accept(headerAt(99.0), kNow);
  monitor.refuse("it is empty");
  monitor.reset();
  DiagnosticStatusWrapper status = reportOf(monitor);
  EXPECT_EQ(status.level, DiagnosticStatus::ERROR);
  EXPECT_EQ(status.message, "nothing received yet");
  EXPECT_EQ(figure(status, "messages refused"), "1");
  EXPECT_TRUE(monitor.accept(headerAt(10.0), kNow)) << "earlier than before";
}

TEST(InputMonitor, UnorderedStampsNeedOnlyAGoodHeader) {
  InputMonitor monitor = monitorOf(true);
  for (const double stamp : {99.8, 99.5, 99.5, 99.9}) {
    EXPECT_NO_THROW(monitor.acceptUnordered(headerAt(stamp), kNow));
  }
  EXPECT_EQ(reportOf(monitor).level, DiagnosticStatus::OK);
  EXPECT_THROW(monitor.acceptUnordered(headerAt(99.9, ""), kNow), std::invalid_argument);
  EXPECT_THROW(monitor.acceptUnordered(headerAt(0.0), kNow), std::invalid_argument);
  EXPECT_THROW(monitor.acceptUnordered(headerAt(101.5), kNow), std::invalid_argument);
}

TEST(InputMonitorReport, SilenceIsAnErrorWhereTheInputIsRequired) {
  InputMonitor required = monitorOf(true), optional = monitorOf(false);
  EXPECT_EQ(reportOf(required).level, DiagnosticStatus::ERROR);
  EXPECT_EQ(reportOf(optional).level, DiagnosticStatus::OK);
  EXPECT_EQ(reportOf(optional).message, "nothing received yet")
      << "the figure is no error, but worth knowing";

  for (InputMonitor* monitor : {&required, &optional}) {
    monitor->accept(headerAt(99.9), kNow);
    EXPECT_EQ(reportOf(*monitor, ros::Time(101.0)).level, DiagnosticStatus::OK);
  }
  EXPECT_EQ(reportOf(required, ros::Time(105.0)).level, DiagnosticStatus::ERROR);
  EXPECT_EQ(reportOf(required, ros::Time(105.0)).message, "silent for 5.0 s");
  EXPECT_EQ(reportOf(optional, ros::Time(105.0)).level, DiagnosticStatus::OK);
  EXPECT_EQ(reportOf(optional, ros::Time(105.0)).message, "silent for 5.0 s");
}

TEST(InputMonitorReport, AnOptionalInputStillWarnsOfOldStamps) {
  InputMonitor monitor = monitorOf(false);
  monitor.accept(headerAt(95.0), kNow);
  EXPECT_EQ(reportOf(monitor).level, DiagnosticStatus::WARN);
}

TEST(InputMonitorReport, RefusalsWarnWhileGoodMessagesCome) {
  for (const bool required : {true, false}) {
    InputMonitor monitor = monitorOf(required);
    monitor.accept(headerAt(99.8), kNow);
    monitor.refuse("its frame_id is empty");
    monitor.refuse("its stamp is zero");
    monitor.accept(headerAt(99.9), kNow);
    DiagnosticStatusWrapper status = reportOf(monitor);
    EXPECT_EQ(status.level, DiagnosticStatus::WARN);
    EXPECT_EQ(status.message, "2 messages refused: its stamp is zero");

    monitor.refuse("it is empty");
    status = reportOf(monitor);
    EXPECT_EQ(status.level, DiagnosticStatus::ERROR) << "no good message in this interval";
    EXPECT_EQ(status.message, "1 messages refused: it is empty");
    EXPECT_EQ(figure(status, "messages refused"), "3");
    EXPECT_EQ(figure(status, "last refusal"), "it is empty");
  }
}

TEST(InputMonitorReport, ARefusalIsForgivenButNotForgotten) {
  InputMonitor monitor = monitorOf(true);
  EXPECT_EQ(figure(reportOf(monitor), "last refusal"), "(none)");
  monitor.refuse("it is empty");
  EXPECT_EQ(reportOf(monitor).level, DiagnosticStatus::ERROR);
  monitor.accept(headerAt(99.9), kNow);
  const DiagnosticStatusWrapper status = reportOf(monitor);
  EXPECT_EQ(status.level, DiagnosticStatus::OK) << status.message;
  EXPECT_EQ(figure(status, "topic"), "/depth/image");
  EXPECT_EQ(figure(status, "messages refused"), "1");
  EXPECT_EQ(figure(status, "last refusal"), "it is empty");
}

TEST(InputMonitorReport, WhatIsRefusedAfterItsHeaderWasAcceptedIsNoGoodMessage) {
  InputMonitor monitor = monitorOf(true);
  monitor.accept(headerAt(100.0), kNow);
  monitor.refuse("its encoding is wrong");
  EXPECT_EQ(reportOf(monitor).level, DiagnosticStatus::ERROR);
}

TEST(InputMonitorReport, WhatLastsMayBeSilentOnceItCame) {
  InputMonitor monitor = monitorOf(true);
  EXPECT_EQ(reportOf(monitor).level, DiagnosticStatus::ERROR);
  monitor.acceptLatched(kNow);
  EXPECT_EQ(reportOf(monitor, kNow + ros::Duration(1000.0)).level, DiagnosticStatus::OK);
  monitor.acceptLatched(kNow);
  monitor.refuse("the focal length is 0");
  EXPECT_EQ(reportOf(monitor).level, DiagnosticStatus::ERROR);
}

TEST(InputMonitorReport, WhatIsNotSubscribedIsFine) {
  InputMonitor monitor = monitorOf(true);
  monitor.setTopic("");
  const DiagnosticStatusWrapper status = reportOf(monitor);
  EXPECT_EQ(status.level, DiagnosticStatus::OK);
  EXPECT_NE(status.message.find("not subscribed"), std::string::npos) << status.message;
}

TEST(InputMonitor, TheExpectedAgeCanChange) {
  InputMonitor monitor = monitorOf(true);
  const auto levelAtAge = [&monitor](double age) {
    monitor.reset();
    monitor.accept(headerAt(100.0 - age), kNow);
    return reportOf(monitor).level;
  };
  EXPECT_EQ(levelAtAge(1.05), DiagnosticStatus::WARN);
  monitor.expectMaxAge(1.1);
  EXPECT_EQ(levelAtAge(1.05), DiagnosticStatus::OK);
  EXPECT_EQ(levelAtAge(1.15), DiagnosticStatus::WARN);
}

}  // namespace
}  // namespace radar_dot
