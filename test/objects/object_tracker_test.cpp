// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/objects/object_tracker.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>

#include "objects/object_world.h"

namespace radar_dot {
namespace {

using Eigen::Vector2d;
using test::Mover;
using test::ObjectWorld;

/// The track nearest to a mover.
ObjectTrack nearest(const std::vector<ObjectTrack>& tracks, const Vector2d& position) {
  return *std::min_element(tracks.begin(), tracks.end(), [&](const ObjectTrack& a, const ObjectTrack& b) {
    return (a.position() - position).norm() < (b.position() - position).norm();
  });
}

TEST(ObjectTracker, RecoversTheVelocityOfACrossingCar) {
  ObjectWorld world;
  world.speed = 0.0;
  world.yaw_rate = 0.0;
  world.radars = {{3.4, 0.8}, {3.4, -0.8}};
  world.movers = {{{12.0, -8.0}, {-1.0, 8.0}}};
  world.range_std = world.azimuth_std = 1e-3;
  world.doppler_std = 1e-2;
  ObjectTracker tracker;
  world.run(tracker, 0.0, 1.5);
  const auto tracks = tracker.moving(1.5);
  ASSERT_EQ(tracks.size(), 1U);
  EXPECT_LT((tracks[0].velocity() - Vector2d(-1.0, 8.0)).norm(), 0.1);
  EXPECT_LT((tracks[0].position() - world.movers[0].at(1.5)).norm(), 0.1);
}

// The vehicle drives and turns; the track is in the world.
TEST(ObjectTracker, FollowsFromAMovingVehicle) {
  ObjectWorld world;
  world.movers = {{{30.0, 4.0}, {6.0, 0.5}}, {{50.0, -10.0}, {-7.0, 2.0}}};
  ObjectTracker tracker;
  world.run(tracker, 0.0, 2.0);
  const auto tracks = tracker.moving(2.0);
  ASSERT_EQ(tracks.size(), 2U);
  for (const Mover& mover : world.movers) {
    const ObjectTrack track = nearest(tracks, mover.at(2.0));
    EXPECT_LT((track.position() - mover.at(2.0)).norm(), 0.7);
    EXPECT_LT((track.velocity() - mover.velocity).norm(), 0.8);
  }
}

// The errors are as large as the covariance says: a mean squared Mahalanobis distance near 4. The tracker
// also provides for the extent of bodies, for what returns share and for accelerations, so it lies below.
TEST(ObjectTracker, TheCovarianceIsConsistent) {
  double sum = 0.0;
  int count = 0;
  for (unsigned seed = 1; seed <= 30; ++seed) {
    ObjectWorld world;
    world.random.seed(seed);
    world.movers = {{{30.0, 5.0}, {5.0, -2.0}}};
    ObjectTracker tracker;
    world.run(tracker, 0.0, 1.5);
    const auto tracks = tracker.moving(1.5);
    if (tracks.size() != 1) continue;
    Eigen::Vector4d error = tracks[0].state;
    error.head<2>() -= world.movers[0].at(1.5);
    error.tail<2>() -= world.movers[0].velocity;
    sum += error.dot(tracks[0].covariance.inverse() * error);
    ++count;
    EXPECT_LT((tracks[0].covariance - tracks[0].covariance.transpose()).norm(), 1e-9);
  }
  EXPECT_GE(count, 29);
  EXPECT_LT(sum / count, 5.0);
  EXPECT_GT(sum / count, 0.4);
}

// Two cars meet side by side: each keeps its track, as their velocities tell them apart.
TEST(ObjectTracker, KeepsTracksApartThroughACrossing) {
  ObjectWorld world;
  world.speed = 0.0;
  world.yaw_rate = 0.0;
  world.movers = {{{20.0, 1.0}, {5.0, 0.0}}, {{40.0, -1.0}, {-5.0, 0.0}}};
  ObjectTracker tracker;
  world.run(tracker, 0.0, 1.0);
  const auto before = tracker.moving(1.0);
  ASSERT_EQ(before.size(), 2U);
  world.run(tracker, 1.0, 3.0);
  const auto after = tracker.moving(3.0);
  ASSERT_EQ(after.size(), 2U);
  for (const Mover& mover : world.movers)
    EXPECT_EQ(nearest(before, mover.at(1.0)).id, nearest(after, mover.at(3.0)).id);
}

TEST(ObjectTracker, TracksAreBornConfirmedAndDie) {
  ObjectTrackerParams params;
  ObjectTracker tracker(params);
  ObjectWorld world;
  world.movers = {{{30.0, 0.0}, {6.0, 0.0}}};
  const double period = 1.0 / 13.0;
  for (int scan = 1; scan <= params.confirm_hits; ++scan) {
    EXPECT_TRUE(tracker.moving(scan * period).empty()) << scan;
    const double time = scan * period;
    tracker.update(time, 0, detectObjects(time, world.scan(0, time)), world.poseAt(time));
    EXPECT_EQ(tracker.all().size(), 1U);
  }
  ASSERT_EQ(tracker.moving(0.3).size(), 1U);
  EXPECT_EQ(tracker.moving(0.3)[0].id, 1U);
  double time = params.confirm_hits * period;
  const double last_hit = time;
  for (; time - last_hit <= params.max_coast; time += period) tracker.update(time, 0, {}, world.poseAt(time));
  tracker.update(time, 0, {}, world.poseAt(time));
  EXPECT_TRUE(tracker.all().empty());
}

// Two detections, then none: given up after N scans of that radar at the latest.
TEST(ObjectTracker, AnUnconfirmedTrackIsGivenUp) {
  ObjectTrackerParams params;
  params.min_coast = params.max_coast = 10.0;
  params.max_weak_time = 10.0;
  ObjectTracker tracker(params);
  ObjectWorld world;
  world.movers = {{{30.0, 0.0}, {6.0, 0.0}}};
  for (int scan = 1; scan <= params.confirm_scans; ++scan) {
    const double time = scan / 13.0;
    const bool sees = scan <= params.confirm_hits - 1;
    tracker.update(time, 0, detectObjects(time, sees ? world.scan(0, time) : std::vector<ReturnOverGround>{}),
                   world.poseAt(time));
    EXPECT_EQ(tracker.all().size(), scan < params.confirm_scans ? 1U : 0U) << scan;
  }
}

TEST(ObjectTracker, WhereNothingMovesThereAreNoTracks) {
  ObjectWorld world;
  world.movers = {{{30.0, 3.0}, {0.0, 0.0}}, {{20.0, -6.0}, {0.0, 0.0}}};
  ObjectTracker tracker;
  world.run(tracker, 0.0, 3.0);
  EXPECT_TRUE(tracker.moving(3.0).empty());
  EXPECT_TRUE(tracker.all().empty());
}

// Two false returns in every scan of five radars, 130 in a second: hardly any becomes a track, and the car
// keeps its own.
TEST(ObjectTracker, ClutterGivesFewTracks) {
  ObjectWorld world;
  world.clutter = 2.0;
  world.detection = 0.8;
  world.movers = {{{25.0, 3.0}, {8.0, 0.0}}};
  ObjectTracker tracker;
  std::set<std::uint64_t> false_tracks, true_tracks;
  for (int step = 1; step <= 40; ++step) {
    const double time = 0.1 * step;
    world.run(tracker, time - 0.1, time);
    if (step < 6) continue;
    for (const ObjectTrack& track : tracker.moving(time)) {
      const bool on_car = (track.position() - world.movers[0].at(time)).norm() < 3.0;
      (on_car ? true_tracks : false_tracks).insert(track.id);
    }
  }
  EXPECT_EQ(true_tracks.size(), 1U);
  EXPECT_LE(false_tracks.size(), 12U) << "of some 500 false returns";
}

// A scan that comes late, by less than max_lag, ends in nearly the same state as in order.
TEST(ObjectTracker, UsesScansOutOfOrder) {
  ObjectWorld world;
  world.movers = {{{30.0, 2.0}, {6.0, 1.0}}};
  std::vector<std::pair<double, std::vector<ObjectDetection>>> scans;
  for (int k = 0; k < 20; ++k) {
    const double time = 0.05 * k;
    scans.emplace_back(time, detectObjects(time, world.scan(0, time)));
  }
  ObjectTracker in_order, swapped;
  for (const auto& [time, detections] : scans)
    EXPECT_TRUE(in_order.update(time, 0, detections, world.poseAt(time)));
  for (std::size_t k = 0; k + 1 < scans.size(); k += 2)
    for (const std::size_t i : {k + 1, k})
      EXPECT_TRUE(swapped.update(scans[i].first, 0, scans[i].second, world.poseAt(scans[i].first)));
  ASSERT_EQ(in_order.moving(1.0).size(), 1U);
  ASSERT_EQ(swapped.moving(1.0).size(), 1U);
  const Eigen::Vector4d apart = in_order.moving(1.0)[0].state - swapped.moving(1.0)[0].state;
  EXPECT_LT(apart.norm(), 0.2);
  EXPECT_FALSE(swapped.update(0.5, 0, {}, world.poseAt(0.5))) << "too late";
  EXPECT_FALSE(swapped.update(std::numeric_limits<double>::quiet_NaN(), 0, {}, world.poseAt(0.5)));
}

TEST(ObjectTracker, OneLongBodyIsOneTrack) {
  ObjectWorld world;
  for (const double along : {0.0, 4.5}) world.movers.push_back({{30.0 + along, 0.0}, {8.0, 0.0}});
  DetectionParams params;
  ObjectTracker tracker;
  world.run(tracker, 0.0, 2.0);
  EXPECT_EQ(tracker.moving(2.0).size(), 1U);
}

TEST(ObjectTracker, ResetForgetsButNeverUsesAnIdTwice) {
  ObjectWorld world;
  world.movers = {{{30.0, 2.0}, {6.0, 1.0}}};
  ObjectTracker tracker;
  world.run(tracker, 0.0, 1.0);
  ASSERT_EQ(tracker.moving(1.0).size(), 1U);
  const auto id = tracker.moving(1.0)[0].id;
  tracker.reset();
  EXPECT_TRUE(tracker.all().empty());
  world.run(tracker, 0.0, 1.0);
  ASSERT_EQ(tracker.moving(1.0).size(), 1U);
  EXPECT_GT(tracker.moving(1.0)[0].id, id);
}

TEST(ObjectTracker, RefusesParametersWithoutSense) {
  ObjectTrackerParams params;
  params.confirm_hits = 0;
  EXPECT_THROW(ObjectTracker{params}, std::invalid_argument);
  params = {};
  params.gate = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ObjectTracker{params}, std::invalid_argument);
}

TEST(ObjectTracker, OtherParametersKeepTheTracks) {
  ObjectWorld world;
  world.movers = {{{30.0, 4.0}, {6.0, 0.5}}};
  ObjectTracker tracker;
  world.run(tracker, 0.0, 1.0);
  ASSERT_EQ(tracker.moving(1.0).size(), 1U);
  const std::uint64_t id = tracker.moving(1.0)[0].id;
  ObjectTrackerParams params;
  params.acceleration_std = 1.0;
  tracker.configure(params);
  EXPECT_EQ(tracker.params().acceleration_std, 1.0);
  world.run(tracker, 1.0, 1.5);
  ASSERT_EQ(tracker.moving(1.5).size(), 1U);
  EXPECT_EQ(tracker.moving(1.5)[0].id, id);
  params.gate = -1.0;
  EXPECT_THROW(tracker.configure(params), std::invalid_argument);
  EXPECT_EQ(tracker.params().gate, ObjectTrackerParams{}.gate) << "what is refused changes nothing";
}

// Radars see more often than images: they must not make the box forgotten, nor a box the returns.
TEST(ObjectTracker, RemembersTheLatestImageAndTheLatestReturns) {
  ObjectDetection seen;
  seen.position = {20.0, 0.0};
  seen.position_covariance = 0.25 * Eigen::Matrix2d::Identity();
  seen.velocity = {5.0, 0.0};
  seen.velocity_covariance = 0.1 * Eigen::Matrix2d::Identity();
  seen.return_count = 4;
  ObjectTracker tracker;
  const auto update = [&](double time) {
    seen.position.x() = 20.0 + 5.0 * time;
    ASSERT_TRUE(tracker.update(time, 0, {seen}, Eigen::Isometry3d::Identity()));
  };
  update(0.0);
  ASSERT_EQ(tracker.all().size(), 1U);
  EXPECT_FALSE(std::isfinite(tracker.all()[0].last_image));
  seen.return_count = 0;
  seen.box = {10, 20, 30, 40};
  seen.pixel_count = 700;
  update(0.1);
  seen.return_count = 2;
  seen.box = {};
  seen.pixel_count = 0;
  update(0.2);
  ASSERT_EQ(tracker.all().size(), 1U);
  const ObjectTrack track = tracker.all()[0];
  EXPECT_EQ(track.last_image, 0.1);
  EXPECT_EQ(track.box.width, 30);
  EXPECT_EQ(track.pixel_count, 700U);
  EXPECT_EQ(track.return_count, 2U);
}

}  // namespace
}  // namespace radar_dot
