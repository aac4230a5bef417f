// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/waiting_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <boost/weak_ptr.hpp>
#include <cmath>

namespace radar_dot {
namespace {

constexpr double kTimeout = 0.5;  // s

ros::Time stampOf(double seconds) { return ros::Time(100.0 + seconds); }

sensor_msgs::ImageConstPtr depthAt(double seconds) {
  auto depth = boost::make_shared<sensor_msgs::Image>();
  depth->header.stamp = stampOf(seconds);
  return depth;
}

FlowConstPtr flowAt(double first, double second) {
  auto flow = boost::make_shared<Flow>();
  flow->header.stamp = stampOf(first);
  flow->second_stamp = stampOf(second);
  return flow;
}

std::string nothing(const WaitingPairs::Pair&, double) { return {}; }

class WaitingPairsTest : public testing::Test {
 protected:
  /// `ros` and `wall` s after the arrival of the flows, which is at zero.
  std::optional<WaitingPairs::Taken> takeAt(double ros, double wall,
                                            const WaitingPairs::Rest& rest = nothing) {
    return pairs_.take(needs_, {ros, wall}, rest);
  }

  WaitingPairs pairs_;
  WaitingPairs::Needs needs_{true, false, kTimeout, "depth"};
};

TEST_F(WaitingPairsTest, APairWaitsForTheDepthsOfItsTwoStamps) {
  pairs_.addFlow(flowAt(0.0, 0.1), {});
  EXPECT_FALSE(takeAt(0.0, 0.0));
  const sensor_msgs::ImageConstPtr first = depthAt(0.0), second = depthAt(0.1);
  pairs_.addDepth(first);
  EXPECT_FALSE(takeAt(0.1, 0.1));
  pairs_.addDepth(second);
  const auto taken = takeAt(0.1, 0.1);
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->missing, "");
  EXPECT_EQ(taken->item.depth, first);
  EXPECT_EQ(taken->item.next_depth, second);
  EXPECT_FALSE(takeAt(0.1, 0.1)) << "a flow is used once";
}

TEST_F(WaitingPairsTest, WhatCannotComeAnyMoreIsNotWaitedFor) {
  pairs_.addFlow(flowAt(0.0, 0.1), {});
  pairs_.addDepth(depthAt(0.05));
  const auto without_first = takeAt(0.0, 0.0);
  ASSERT_TRUE(without_first);
  EXPECT_EQ(without_first->missing, "no depth on 'depth' at the time of the flow's first image");
  pairs_.addFlow(flowAt(0.05, 0.1), {});
  pairs_.addDepth(depthAt(0.2));
  const auto without_second = takeAt(0.0, 0.0);
  ASSERT_TRUE(without_second);
  EXPECT_EQ(without_second->missing, "") << "the flow alone can tell as well";
  EXPECT_FALSE(without_second->item.next_depth);
}

// A bag at a tenth of its rate, at five times its rate, and one that has ended.
TEST_F(WaitingPairsTest, TheTimeoutCountsTheSlowerClock) {
  for (const double rate : {0.1, 1.0, 5.0}) {
    SCOPED_TRACE(rate);
    pairs_.addFlow(flowAt(0.0, 0.1), {});
    const double ros = kTimeout * std::max(1.0, rate), wall = ros / rate;
    EXPECT_FALSE(takeAt(0.9 * ros, 0.9 * wall));
    const auto taken = takeAt(1.1 * ros, 1.1 * wall);
    ASSERT_TRUE(taken);
    EXPECT_NE(taken->missing, "");
  }
  pairs_.addFlow(flowAt(0.0, 0.1), {});
  EXPECT_FALSE(takeAt(0.0, 10.0 * kTimeout));
  EXPECT_TRUE(takeAt(0.0, 21.0 * kTimeout)) << "nothing waits for a clock that stands";
}

TEST_F(WaitingPairsTest, AfterTheTimeoutTheRestHearsThatThereIsNoMoreTime) {
  pairs_.addFlow(flowAt(0.0, 0.1), {});
  pairs_.addDepth(depthAt(0.0));
  pairs_.addDepth(depthAt(0.1));
  double heard = -1.0;
  const auto rest = [&heard](const WaitingPairs::Pair&, double waited) {
    heard = waited;
    return std::isfinite(waited) ? "a rotation" : "";
  };
  EXPECT_FALSE(takeAt(0.2, 0.2, rest));
  EXPECT_NEAR(heard, 0.2, 1e-12);
  const auto taken = takeAt(kTimeout, kTimeout, rest);
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->missing, "");
  pairs_.addFlow(flowAt(0.1, 0.2), {});
  pairs_.addDepth(depthAt(0.2));
  const auto refused = takeAt(1.0, 1.0, [](const WaitingPairs::Pair&, double) { return "no motion"; });
  ASSERT_TRUE(refused);
  EXPECT_EQ(refused->missing, "no motion");
}

TEST_F(WaitingPairsTest, AFullQueueGivesUpItsFirst) {
  for (int i = 0; i < 5; ++i) pairs_.addFlow(flowAt(0.1 * i, 0.1 * i + 0.1), {});
  const auto taken = takeAt(0.0, 0.0);
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->item.flow->header.stamp, stampOf(0.0));
  EXPECT_FALSE(takeAt(0.0, 0.0));
  EXPECT_EQ(pairs_.size(), 4U);
}

TEST(WaitingQueue, MayBeLonger) {
  WaitingQueue<int> queue(6);
  const auto lackOf = [](int, double) { return WaitingQueue<int>::Lack{"everything"}; };
  for (int i = 0; i < 6; ++i) queue.add(i, {});
  EXPECT_FALSE(queue.take(kTimeout, {}, lackOf));
  queue.add(6, {});
  const auto taken = queue.take(kTimeout, {}, lackOf);
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->item, 0);
}

// Also where flow runs backward. A later pair may begin at the same image.
TEST_F(WaitingPairsTest, DepthsThatNobodyCanNeedAnyMoreAreDropped) {
  needs_.depth_std = true;
  for (const bool backward : {false, true}) {
    WaitingPairs pairs;
    boost::weak_ptr<const sensor_msgs::Image> early, late, early_std;
    {
      const auto first = depthAt(0.0), second = depthAt(0.1), std = depthAt(0.0);
      early = first, late = second, early_std = std;
      pairs.addDepthStd(std);
      pairs.addDepthStd(depthAt(0.1));
      pairs.addDepth(first);
      pairs.addDepth(second);
    }
    const auto take = [&](double begin, double end) {
      pairs.addFlow(backward ? flowAt(end, begin) : flowAt(begin, end), {});
      const auto taken = pairs.take(needs_, {}, nothing);
      ASSERT_TRUE(taken);
      EXPECT_TRUE(taken->item.depth_std);
    };
    take(0.0, 0.1);
    EXPECT_FALSE(early.expired());
    pairs.addDepthStd(depthAt(0.2));
    pairs.addDepth(depthAt(0.2));
    take(0.1, 0.2);
    EXPECT_TRUE(early.expired());
    EXPECT_TRUE(early_std.expired());
    EXPECT_FALSE(late.expired());
  }
}

}  // namespace
}  // namespace radar_dot
