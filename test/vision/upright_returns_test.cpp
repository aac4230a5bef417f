// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>

#include "radar_dot/vision/recent_scans.h"
#include "radar_dot/vision/return_reach.h"

namespace radar_dot {
namespace {

/// A sensor 0.7 m above the ground that looks ahead, unturned.
std::vector<CloudPoint> seen(const std::vector<std::vector<CloudPoint>>& scans, const GroundParams* ground) {
  RecentScans recent;
  double time = 0.0;
  for (const auto& scan : scans) recent.add({"radar", "points"}, time += 0.1, scan);
  const auto mount = [](const RecentScans::Sensor&) {
    return std::optional<Eigen::Isometry3d>(Eigen::Isometry3d(Eigen::Translation3d(0.0, 0.0, 0.7)));
  };
  const auto motion = [](double, double) {
    return std::optional<Eigen::Isometry3d>(Eigen::Isometry3d::Identity());
  };
  return recent.at(time, 0.05, mount, motion, ground);
}

CloudPoint at(float x, float z) { return {{x, 0.0F, z}}; }

TEST(UprightReturns, LeaveOutTheRoadAndWhatHangsOverItWhereHeightsAreTold) {
  const GroundParams ground;
  const std::vector<CloudPoint> scan = {at(5.0F, -0.5F), at(8.0F, 0.3F), at(10.0F, 5.0F)};
  EXPECT_EQ(seen({scan}, nullptr).size(), 3U);
  const auto upright = seen({scan}, &ground);
  ASSERT_EQ(upright.size(), 1U);
  EXPECT_FLOAT_EQ(upright[0].position.x(), 8.0F);
}

TEST(UprightReturns, FollowTheGroundPlane) {
  GroundParams ground;
  ground.height = -0.6;  // the base frame is above it: 0.2 m in the base frame are 0.8 m above ground
  EXPECT_EQ(seen({{at(5.0F, -0.5F), at(8.0F, 0.3F)}}, &ground).size(), 2U);
}

TEST(UprightReturns, FarHeightsErr) {
  const GroundParams ground;
  EXPECT_EQ(seen({{at(8.0F, 0.3F), at(60.0F, -0.7F)}}, &ground).size(), 2U);
}

TEST(UprightReturns, PlanarRadarsTellNoHeights) {
  const GroundParams ground;
  EXPECT_EQ(seen({{at(5.0F, -0.5F), at(8.0F, -0.5F)}}, &ground).size(), 2U);
}

TEST(UprightReturns, ScanOfOneReturnIsOfTheSameSensor) {
  const GroundParams ground;
  EXPECT_EQ(seen({{at(5.0F, -0.5F)}}, &ground).size(), 1U);
  EXPECT_TRUE(seen({{at(5.0F, -0.5F), at(8.0F, 0.3F)}, {at(5.0F, -0.5F)}}, &ground).empty());
}

/// Forty returns of a car 20 m ahead that recedes by 5 m/s, 0.5 to 1.5 m above ground.
std::vector<CloudPoint> car() {
  std::vector<CloudPoint> points;
  for (int i = 0; i < 40; ++i)
    points.push_back({{20.0F, 0.04F * static_cast<float>(i), -0.2F + 0.025F * static_cast<float>(i)}, 5.0F});
  return points;
}

TEST(MovingReturns, CountWhereAnotherScanShowsThemToo) {
  const GroundParams ground;
  const CloudPoint wall{{30.0F, -4.0F, 0.0F}, 0.1F}, clutter{{15.0F, 2.0F, 0.0F}, 8.0F};
  // A scan each 0.1 s. One recedes by 10 m/s; another is said to, by 40, and stays.
  std::vector<std::vector<CloudPoint>> scans;
  for (const float x : {20.0F, 21.0F, 22.0F})
    scans.push_back({{{x, 0.0F, 0.0F}, 10.0F}, {{40.0F, 3.0F, 0.0F}, 40.0F}});
  scans.front().push_back({clutter.position, -4.0F});  // something else in the same place
  scans.back().push_back(wall);
  scans.back().push_back(clutter);
  EXPECT_EQ(seen(scans, nullptr).size(), 4U);
  const auto confirmed = seen(scans, &ground);
  ASSERT_EQ(confirmed.size(), 2U);
  EXPECT_FLOAT_EQ(confirmed[0].position.x(), 22.0F);
  EXPECT_FLOAT_EQ(confirmed[1].position.x(), 30.0F);
  EXPECT_EQ(seen({scans.back()}, &ground).size(), 4U);  // nothing to compare with
}

TEST(UprightReturns, GhostsOfImagingRadarsStandAlone) {
  std::vector<CloudPoint> scan = car();
  scan.push_back({{10.0F, 3.0F, 0.3F}, 5.0F});   // nothing beside it
  scan.push_back({{20.5F, 0.5F, 0.3F}, -6.0F});  // beside the car, and moves another way
  scan.push_back({{std::nanf(""), 0.0F, 0.0F}, 5.0F});
  const std::vector<CloudPoint> kept = seen({scan}, nullptr);
  EXPECT_EQ(kept.size(), 40U);
  for (const CloudPoint& point : kept) EXPECT_FLOAT_EQ(point.residual, 5.0F);
}

TEST(UprightReturns, FewReturnsAreNoGhostsWhereAllAreFew) {
  std::vector<CloudPoint> scan = car();
  scan.resize(7);
  scan.push_back({{10.0F, 3.0F, 0.3F}, 1.0F});  // a pedestrian
  EXPECT_EQ(seen({scan}, nullptr).size(), 8U);
}

TEST(UprightReturns, PlanarRadarsHaveNoGhostsOfThisKind) {
  std::vector<CloudPoint> scan = car();
  scan.push_back({{10.0F, 3.0F, 0.3F}, 5.0F});
  for (CloudPoint& point : scan) point.position.z() = 0.0F;
  EXPECT_EQ(seen({scan}, nullptr).size(), 41U);
}

TEST(UprightReturns, LidarsHaveNone) {
  std::vector<CloudPoint> scan = car();
  scan.push_back({{10.0F, 3.0F, 0.3F}, 5.0F});
  for (CloudPoint& point : scan) point.residual = std::nanf("");
  const std::vector<CloudPoint> kept = seen({scan}, nullptr);
  ASSERT_EQ(kept.size(), 41U);
  EXPECT_FLOAT_EQ(kept.back().position.x(), 10.0F) << "the order has changed";
}

TEST(ReturnReach, IsSharedWhereReturnsAreDense) {
  std::vector<Eigen::Vector2f> places = {{50.0F, 0.0F}, {std::nanf(""), 0.0F}};
  for (int i = 0; i < 12; ++i) places.emplace_back(10.0F, 0.01F * static_cast<float>(i));
  const std::vector<float> reaches = reachesOf(places, 0.9F);
  EXPECT_FLOAT_EQ(reaches[0], 0.9F);
  EXPECT_FLOAT_EQ(reaches[1], 0.9F);
  EXPECT_FLOAT_EQ(reaches[7], 0.9F / 4.0F);  // 12 returns, 3 of which have it whole
}

TEST(ReturnReach, FewReturnsOfACarHaveItWhole) {
  const std::vector<float> reaches = reachesOf({{10.0F, -0.6F}, {10.1F, 0.0F}, {10.0F, 0.6F}}, 0.9F);
  for (const float reach : reaches) EXPECT_FLOAT_EQ(reach, 0.9F);
}

}  // namespace
}  // namespace radar_dot
