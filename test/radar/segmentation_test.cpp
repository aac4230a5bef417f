// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include "radar_dot/radar/ego_velocity.h"
#include "synthetic_sweep.h"

namespace radar_dot {
namespace {

/// A static planar sweep at standstill, to which chosen returns are added.
class Segmentation : public ::testing::Test {
 protected:
  Segmentation()
      : sweep_(test::makeSweep(test::carMounts(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero())) {}

  /// Adds a return of a radar, the front one, at (x, y) in the base frame with the given range rate.
  std::size_t add(double x, double y, double doppler, std::size_t radar = 0) {
    const Eigen::Isometry3d& mount = sweep_.mounts[radar];
    const Eigen::Vector3d p = mount.inverse() * Eigen::Vector3d(x, y, mount.translation().z());
    DopplerReturn measured;
    measured.bearing = p.normalized().cast<float>();
    measured.range = static_cast<float>(p.norm());
    measured.doppler = static_cast<float>(doppler);
    sweep_.returns[radar].push_back(measured);
    return sweep_.returns[radar].size() - 1;
  }

  EgoVelocityResult estimate(const SegmentationParams& segmentation, double bearing_rotation = 0.0) {
    EgoVelocityParams params;
    params.segmentation = segmentation;
    std::vector<RadarScan> scans = sweep_.scans();
    for (RadarScan& scan : scans) scan.bearing_rotation = bearing_rotation;
    return EgoVelocityEstimator(params).estimate(scans, 0.0);
  }

  test::Sweep sweep_;
};

TEST_F(Segmentation, ThePapersThresholdCutsAtTau) {
  const std::size_t below = add(30.0, 0.0, 0.79);
  const std::size_t above = add(30.0, 5.0, -0.81);
  SegmentationParams params;
  params.neighbourhood = false;
  params.threshold = 0.8;
  const EgoVelocityResult result = estimate(params);
  ASSERT_TRUE(result.valid());
  EXPECT_EQ(result.labels[below], ReturnLabel::kStatic);
  EXPECT_EQ(result.labels[above], ReturnLabel::kDynamic);
  EXPECT_EQ(result.dynamic_count, 1U);
  EXPECT_NEAR(result.residuals[above], -0.81, 0.01) << "approaching targets have negative residuals";
}

TEST_F(Segmentation, SlowReturnsCountOnlyInCompany) {
  const std::size_t lonely = add(30.0, -10.0, 0.9);
  const std::size_t first = add(40.0, 4.0, 0.9);
  const std::size_t second = add(41.0, 4.5, 0.8);
  const std::size_t far = add(44.5, 4.5, 0.9);
  const EgoVelocityResult result = estimate(SegmentationParams{});
  ASSERT_TRUE(result.valid());
  EXPECT_EQ(result.labels[lonely], ReturnLabel::kStatic);
  EXPECT_EQ(result.labels[first], ReturnLabel::kDynamic);
  EXPECT_EQ(result.labels[second], ReturnLabel::kDynamic);
  EXPECT_EQ(result.labels[far], ReturnLabel::kStatic);
}

TEST_F(Segmentation, CompanyMustMoveTheSameWay) {
  const std::size_t receding = add(40.0, 4.0, 0.9);
  const std::size_t approaching = add(40.5, 4.0, -0.9);
  const EgoVelocityResult result = estimate(SegmentationParams{});
  ASSERT_TRUE(result.valid());
  EXPECT_EQ(result.labels[receding], ReturnLabel::kStatic);
  EXPECT_EQ(result.labels[approaching], ReturnLabel::kStatic);
}

TEST_F(Segmentation, FastReturnsNeedNoCompany) {
  const std::size_t fast = add(30.0, -10.0, 1.3);
  const EgoVelocityResult result = estimate(SegmentationParams{});
  ASSERT_TRUE(result.valid());
  EXPECT_EQ(result.labels[fast], ReturnLabel::kDynamic);
}

// At 20 m/s a target seen 90 ms earlier lies 1.8 m nearer by now: neighbours are compared at one time.
// Turned about their radars, which stand 1.3 m apart, the two would be 0.25 m apart.
TEST_F(Segmentation, NeighboursAreWhereTheyWereMeasured) {
  const std::size_t of_front = add(30.0, 10.0, 0.9);
  const std::size_t of_left = add(30.0, 10.0, 0.9, 1);
  SegmentationParams params;
  params.neighbour_distance = 0.1;
  const EgoVelocityResult result = estimate(params, 0.2);
  ASSERT_TRUE(result.valid());
  EXPECT_EQ(result.labels[of_front], ReturnLabel::kDynamic);
  EXPECT_EQ(result.labels[result.offsets[1] + of_left], ReturnLabel::kDynamic);
}

TEST(SegmentationTime, NeighboursAreBroughtToOneTime) {
  const double speed = 20.0;
  test::Sweep sweep = test::makeSweep(test::carMounts(), {speed, 0.0, 0.0}, Eigen::Vector3d::Zero());
  sweep.times[1] = -0.09;
  const auto add = [&](std::size_t radar, double x, double y) {
    const Eigen::Vector3d p =
        sweep.mounts[radar].inverse() * Eigen::Vector3d(x, y, sweep.mounts[radar].translation().z());
    const Eigen::Vector3d u_base = sweep.mounts[radar].linear() * p.normalized();
    DopplerReturn measured;
    measured.bearing = p.normalized().cast<float>();
    measured.range = static_cast<float>(p.norm());
    measured.doppler = static_cast<float>(-speed * u_base.x() + 0.9);
    sweep.returns[radar].push_back(measured);
    return sweep.returns[radar].size() - 1;
  };
  const std::size_t now = add(0, 30.0, 10.0);
  const std::size_t before =
      add(1, 30.0 + 0.09 * speed + 1.0, 10.0);  // 2.8 m apart as measured, 1 m at one time
  EgoVelocityEstimator estimator;
  const EgoVelocityResult& result = estimator.estimate(sweep.scans(), 0.0);
  ASSERT_TRUE(result.valid());
  EXPECT_EQ(result.labels[result.offsets[0] + now], ReturnLabel::kDynamic);
  EXPECT_EQ(result.labels[result.offsets[1] + before], ReturnLabel::kDynamic);
}

TEST(SegmentationOrder, OffsetsDelimitTheScans) {
  const test::Sweep sweep = test::makeSweep(test::carMounts(), {5.0, 0.0, 0.0}, Eigen::Vector3d::Zero());
  EgoVelocityEstimator estimator;
  const EgoVelocityResult& result = estimator.estimate(sweep.scans(), 0.0);
  ASSERT_EQ(result.offsets.size(), 6U);
  EXPECT_EQ(result.offsets.front(), 0U);
  EXPECT_EQ(result.offsets.back(), result.labels.size());
  for (std::size_t i = 0; i < 5; ++i) EXPECT_EQ(result.offsets[i + 1] - result.offsets[i], 60U);
}

}  // namespace
}  // namespace radar_dot
