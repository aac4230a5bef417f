// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/radar_input.h"

#include <gtest/gtest.h>

#include <boost/make_shared.hpp>
#include <string>
#include <vector>

#include "fixtures/refusal.h"
#include "float_cloud.h"

namespace radar_dot {
namespace {

const ros::Time kNow(100.0);

RadarMessage messageOf(const std::vector<std::string>& names, const std::vector<float>& values,
                       const std::string& frame = "radar", double stamp = 99.9) {
  auto cloud = boost::make_shared<sensor_msgs::PointCloud2>(test::floatCloud(names, values));
  cloud->header.frame_id = frame;
  cloud->header.stamp = ros::Time(stamp);
  RadarMessage message;
  message.header = cloud->header;
  message.cloud = cloud;
  message.type = "sensor_msgs/PointCloud2";
  return message;
}

RadarMessage goodMessage(const std::string& frame = "radar", double stamp = 99.9) {
  return messageOf({"x", "y", "z", "vr"}, {10.F, 0.F, 0.F, -5.F, 0.F, 20.F, 2.F, 0.F}, frame, stamp);
}

std::optional<Eigen::Isometry3d> noMount(const std::string& frame, std::string& error) {
  error = "no transform from '" + frame + "'";
  return std::nullopt;
}

RadarReading readingOf(RadarInput& input, const RadarMessage& message,
                       const RadarInput::FindMount& find_mount = noMount) {
  RadarReading reading;
  input.read(message, kNow, find_mount, reading);
  return reading;
}

TEST(RadarInput, ReadsWhatTheMessageSays) {
  RadarInput input{RadarEntry()};
  const RadarReading reading = readingOf(input, goodMessage());
  EXPECT_EQ(reading.header.frame_id, "radar");
  EXPECT_EQ(reading.header.stamp, ros::Time(99.9));
  ASSERT_EQ(reading.returns.size(), 2U);
  EXPECT_FLOAT_EQ(reading.returns[0].doppler, -5.F);
  EXPECT_EQ(input.description(),
            "sensor_msgs/PointCloud2 in frame 'radar', range rate from field 'vr' times 1, stamps of the "
            "header");
}

TEST(RadarInput, TheEntrySetsFrameAndTime) {
  RadarEntry entry;
  entry.frame_id = "front";
  entry.stamp = StampSource::kArrival;
  entry.time_offset = -0.07;
  RadarInput input(entry);
  const RadarReading reading = readingOf(input, goodMessage("", 0.0));
  EXPECT_EQ(reading.header.frame_id, "front");
  EXPECT_NEAR(reading.header.stamp.toSec(), 99.93, 1e-6);
  EXPECT_NE(input.description().find("in frame 'front'"), std::string::npos) << input.description();
  EXPECT_NE(input.description().find("time of arrival -0.07 s"), std::string::npos) << input.description();
}

// The clock of a quick replay stands still between two scans.
TEST(RadarInput, TimesOfArrivalRise) {
  RadarEntry entry;
  entry.stamp = StampSource::kArrival;
  RadarInput input(entry);
  const ros::Time first = readingOf(input, goodMessage()).header.stamp;
  EXPECT_EQ(first, kNow);
  EXPECT_GT(readingOf(input, goodMessage()).header.stamp, first);
}

// Five rounds for one bag otherwise.
TEST(RadarInput, NamesAllFaultsAtOnceWithWhatCuresThem) {
  RadarInput input{RadarEntry()};
  test::expectRefusal(
      [&] {
        readingOf(input, messageOf({"x", "power"}, {1.F, 2.F}, "", 0.0));
      },
      {"frame_id is empty: set frame_id", "stamp is zero: set stamp: arrival", "'y'", "doppler_field",
       "x, power"});
  test::expectRefusal(
      [&] {
        readingOf(input, messageOf({"x", "power"}, {1.F, 2.F}));
      },
      {"'y'", "no transform from 'radar'"});
  EXPECT_EQ(readingOf(input, goodMessage()).returns.size(), 2U) << "a mount may still come";
}

TEST(RadarInput, AMessageOfAnotherTypeIsNamed) {
  RadarMessage message;
  message.type = "sensor_msgs/LaserScan";
  message.defect = "its type is sensor_msgs/LaserScan";
  RadarEntry entry;
  entry.only_frame = "left";
  RadarInput input(entry);
  EXPECT_TRUE(input.isOwn(message)) << "nobody else would report it";
  test::expectRefusal([&] { readingOf(input, message); }, {"sensor_msgs/LaserScan"});
}

TEST(RadarInput, RadarsOfOneTopicAreToldApartByFrame) {
  RadarEntry entry;
  entry.only_frame = "left";
  const RadarInput left(entry), any{RadarEntry()};
  EXPECT_TRUE(left.isOwn(goodMessage("left")));
  EXPECT_TRUE(left.isOwn(goodMessage("/left"))) << "drivers from the days of tf";
  EXPECT_FALSE(left.isOwn(goodMessage("right")));
  EXPECT_TRUE(any.isOwn(goodMessage("right")));
}

TEST(RadarInput, HeightsAreThoseAboveTheBaseFrame) {
  RadarInput input{RadarEntry()};
  ExtractionParams params;
  params.filter.max_height = 2.0;
  input.setExtractor(DopplerExtractor(params));
  EXPECT_EQ(readingOf(input, goodMessage()).returns.size(), 2U) << "its mount may still come";
  const auto atHeight = [](double height) {
    return [height](const std::string&, std::string&) {
      return std::optional<Eigen::Isometry3d>(Eigen::Translation3d(0.0, 0.0, height));
    };
  };
  EXPECT_EQ(readingOf(input, goodMessage(), atHeight(0.5)).returns.size(), 1U) << "0.5 m and 2.5 m";
  EXPECT_EQ(readingOf(input, goodMessage(), atHeight(-0.5)).returns.size(), 2U);
}

TEST(RadarInput, CountsMessagesThatHaveNotArrived) {
  RadarInput input{RadarEntry()};
  RadarMessage message = goodMessage();
  for (const std::uint32_t seq : {7U, 8U, 11U, 12U}) {
    message.header.seq = seq;
    readingOf(input, message);
  }
  EXPECT_EQ(input.lost(), 2U);
}

}  // namespace
}  // namespace radar_dot
