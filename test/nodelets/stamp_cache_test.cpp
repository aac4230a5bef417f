// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/stamp_cache.h"

#include <gtest/gtest.h>
#include <std_msgs/Header.h>

#include <boost/make_shared.hpp>
#include <boost/weak_ptr.hpp>
#include <cstdint>
#include <utility>

namespace radar_dot {
namespace {

struct Message {
  std_msgs::Header header;
};
using Cache = StampCache<Message>;

Cache::Pointer messageAt(const ros::Time& stamp) {
  const auto message = boost::make_shared<Message>();
  message->header.stamp = stamp;
  return message;
}

TEST(StampCache, FindsByTheExactStamp) {
  Cache cache;
  EXPECT_TRUE(cache.empty());
  EXPECT_EQ(cache.find(ros::Time(1, 0)), nullptr);
  const Cache::Pointer first = messageAt(ros::Time(1, 500)), second = messageAt(ros::Time(2, 0));
  cache.add(first);
  cache.add(second);
  EXPECT_FALSE(cache.empty());
  EXPECT_EQ(cache.find(ros::Time(1, 500)), first);
  EXPECT_EQ(cache.find(ros::Time(2, 0)), second);
  EXPECT_EQ(cache.find(ros::Time(1, 499)), nullptr) << "a nanosecond is another image";
  EXPECT_EQ(cache.find(ros::Time()), nullptr);
}

TEST(StampCache, KnowsTheNearest) {
  Cache cache;
  EXPECT_EQ(cache.nearest(ros::Time(1, 0)), nullptr);
  const Cache::Pointer first = messageAt(ros::Time(1, 0)), second = messageAt(ros::Time(2, 0));
  cache.add(first);
  cache.add(second);
  EXPECT_EQ(cache.nearest(ros::Time(0, 1)), first);
  EXPECT_EQ(cache.nearest(ros::Time(1, 400'000'000)), first);
  EXPECT_EQ(cache.nearest(ros::Time(1, 600'000'000)), second);
  EXPECT_EQ(cache.nearest(ros::Time(4'000'000'000U, 0)), second) << "differences of ros::Time would throw";
}

TEST(StampCache, KeepsTheLatestOfItsSpan) {
  Cache cache(2.5);
  for (std::uint32_t i = 1; i <= 4; ++i) cache.add(messageAt(ros::Time(i, 0)));
  EXPECT_EQ(cache.find(ros::Time(1, 0)), nullptr);
  for (std::uint32_t i = 2; i <= 4; ++i) EXPECT_NE(cache.find(ros::Time(i, 0)), nullptr) << i;
}

TEST(StampCache, KeepsNoMoreThanItsCapacity) {
  Cache cache(100.0, 3);
  for (std::uint32_t i = 1; i <= 4; ++i) cache.add(messageAt(ros::Time(i, 0)));
  EXPECT_EQ(cache.find(ros::Time(1, 0)), nullptr);
  EXPECT_NE(cache.find(ros::Time(2, 0)), nullptr);
}

TEST(StampCache, KnowsWhatWillNotComeAnyMore) {
  Cache cache;
  EXPECT_FALSE(cache.isPast(ros::Time(1, 0)));
  cache.add(messageAt(ros::Time(2, 0)));
  EXPECT_TRUE(cache.isPast(ros::Time(1, 0)));
  EXPECT_FALSE(cache.isPast(ros::Time(2, 0)));
  EXPECT_FALSE(cache.isPast(ros::Time(3, 0)));
}

TEST(StampCache, DoesNotHoldOnToWhatItDropped) {
  Cache cache(100.0, 1);
  Cache::Pointer message = messageAt(ros::Time(1, 0));
  const boost::weak_ptr<const Message> watched = message;
  cache.add(std::move(message));
  EXPECT_FALSE(watched.expired());
  cache.add(messageAt(ros::Time(2, 0)));
  EXPECT_TRUE(watched.expired());
}

TEST(StampCache, OfTheSameStampTheLatestCounts) {
  Cache cache;
  const Cache::Pointer before = messageAt(ros::Time(1, 0)), after = messageAt(ros::Time(1, 0));
  cache.add(before);
  cache.add(after);
  EXPECT_EQ(cache.find(ros::Time(1, 0)), after);
}

TEST(StampCache, ForgetsWhenCleared) {
  Cache cache;
  cache.add(messageAt(ros::Time(1, 0)));
  cache.clear();
  EXPECT_TRUE(cache.empty());
  EXPECT_EQ(cache.find(ros::Time(1, 0)), nullptr);
}

}  // namespace
}  // namespace radar_dot
