// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/ego_velocity.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include "fixtures/refusal.h"
#include "radar/constraint_system.h"
#include "synthetic_sweep.h"

namespace radar_dot {
namespace {

using Eigen::Vector3d;
using test::carMounts;
using test::makeSweep;
using test::mount;
using test::Sweep;
using test::SweepOptions;

constexpr Solver kSolvers[] = {Solver::kLeastSquares, Solver::kRansac, Solver::kRansacRobust};

EgoVelocityParams paramsFor(MotionModel model, Solver solver = Solver::kRansacRobust, bool two_pass = true) {
  EgoVelocityParams params;
  params.model = model;
  params.solver = solver;
  params.two_pass = two_pass;
  return params;
}

EgoVelocityResult estimated(const Sweep& sweep, const EgoVelocityParams& params = {}) {
  return EgoVelocityEstimator(params).estimate(sweep.scans(), 0.0);
}

struct Motion {
  MotionModel model;
  Vector3d linear, angular;
};

TEST(EgoVelocity, RecoversEveryModelExactlyWithoutNoise) {
  const std::vector<Motion> motions = {{MotionModel::kPlanar, {8.0, -0.4, 0.0}, {0.0, 0.0, 0.0}},
                                       {MotionModel::kPlanarYaw, {6.0, 0.3, 0.0}, {0.0, 0.0, 0.35}},
                                       {MotionModel::kAckermann, {5.0, 0.0, 0.0}, {0.0, 0.0, -0.4}},
                                       {MotionModel::kSpatial, {7.0, 0.2, -0.5}, {0.0, 0.0, 0.3}}};
  for (const Motion& motion : motions) {
    SweepOptions options;
    options.max_elevation = motion.model == MotionModel::kSpatial ? 0.4 : 0.0;
    const Sweep sweep = makeSweep(carMounts(), motion.linear, motion.angular, options);
    for (const Solver solver : kSolvers) {
      for (const bool two_pass : {false, true}) {
        const EgoVelocityResult result = estimated(sweep, paramsFor(motion.model, solver, two_pass));
        ASSERT_TRUE(result.valid()) << toString(motion.model) << ' ' << toString(solver) << ": "
                                    << result.reason;
        EXPECT_LT((result.linear - motion.linear).norm(), 2e-5) << toString(motion.model) << toString(solver);
        EXPECT_LT((result.angular - motion.angular).norm(), 1e-5)
            << toString(motion.model) << toString(solver);
        EXPECT_EQ(result.inlier_count, result.return_count);
        EXPECT_EQ(result.dynamic_count, 0U);
        EXPECT_TRUE(result.fully_observed);
      }
    }
  }
}

TEST(EgoVelocity, RecoversMotionFromAnyMount) {
  for (int i = 0; i < 12; ++i) {
    const double angle = 0.5 * i;
    const Vector3d v(4.0, 1.0, 0.0);
    const std::vector<Eigen::Isometry3d> mounts = {mount(std::cos(angle), 2.0 * std::sin(angle), 0.3, angle),
                                                   mount(-1.0, -0.5, 0.3, angle + 2.0)};
    const Sweep sweep = makeSweep(mounts, v, {0.0, 0.0, 0.2});
    const EgoVelocityResult result = estimated(sweep, paramsFor(MotionModel::kPlanarYaw));
    ASSERT_TRUE(result.valid()) << angle << ": " << result.reason;
    EXPECT_LT((result.linear - v).norm(), 2e-4) << angle;
    EXPECT_NEAR(result.angular.z(), 0.2, 1e-4) << angle;
  }
}

// A point straight ahead closes in when the vehicle drives forward: its range rate is -v.
TEST(EgoVelocity, SignsFollowTheRangeRate) {
  std::vector<DopplerReturn> returns(3);
  for (std::size_t i = 0; i < 3; ++i) {
    const double azimuth = 0.5 * (static_cast<double>(i) - 1.0);
    returns[i].bearing = Vector3d(std::cos(azimuth), std::sin(azimuth), 0.0).cast<float>();
    returns[i].range = 20.F;
    returns[i].doppler = static_cast<float>(-10.0 * std::cos(azimuth));
  }
  std::vector<DopplerReturn> many;
  for (int i = 0; i < 4; ++i) many.insert(many.end(), returns.begin(), returns.end());
  EgoVelocityEstimator estimator(paramsFor(MotionModel::kPlanar, Solver::kLeastSquares));
  const EgoVelocityResult& result = estimator.estimate({{many, Eigen::Isometry3d::Identity(), 0.0}}, 0.0);
  ASSERT_TRUE(result.valid()) << result.reason;
  EXPECT_NEAR(result.linear.x(), 10.0, 1e-5);
  EXPECT_NEAR(result.linear.y(), 0.0, 1e-5);
}

// A vehicle turning on the spot to the left moves a front-mounted radar to the left.
TEST(EgoVelocity, LeverArmHasTheRightSign) {
  const Eigen::Isometry3d front = mount(3.0, 0.0, 0.0, 0.0);
  std::vector<DopplerReturn> left(12);  // straight left of the radar: the range shrinks by w * 3 m
  std::vector<DopplerReturn> rear(12);
  for (std::size_t i = 0; i < left.size(); ++i) {
    const double azimuth = M_PI / 2 + 0.05 * (static_cast<double>(i) - 5.5);
    left[i].bearing = Vector3d(std::cos(azimuth), std::sin(azimuth), 0.0).cast<float>();
    left[i].doppler = static_cast<float>(-0.2 * 3.0 * std::sin(azimuth));
    rear[i].bearing = left[i].bearing;
    rear[i].doppler = 0.F;  // at the rotation centre nothing moves
  }
  EgoVelocityEstimator estimator(paramsFor(MotionModel::kPlanarYaw, Solver::kLeastSquares));
  const EgoVelocityResult& result =
      estimator.estimate({{left, front, 0.0}, {rear, Eigen::Isometry3d::Identity(), 0.0}}, 0.0);
  ASSERT_TRUE(result.valid()) << result.reason;
  EXPECT_NEAR(result.angular.z(), 0.2, 1e-5);
  EXPECT_NEAR(result.linear.norm(), 0.0, 1e-5);
}

TEST(EgoVelocity, RotatingTheRigRotatesTheVelocity) {
  SweepOptions options;
  options.moving_share = 0.3;
  options.doppler_sigma = 0.05;
  const Vector3d v(7.0, 0.5, 0.0);
  const Sweep sweep = makeSweep(carMounts(), v, {0.0, 0.0, 0.2}, options);
  EgoVelocityParams params = paramsFor(MotionModel::kPlanarYaw);
  EgoVelocityEstimator estimator(params);
  const EgoVelocityResult reference = estimator.estimate(sweep.scans(), 0.0);
  for (const double angle : {0.7, 1.9, -2.4}) {
    Sweep turned = sweep;
    Eigen::Isometry3d R_turned_from_base = Eigen::Isometry3d::Identity();
    R_turned_from_base.linear() = Eigen::AngleAxisd(angle, Vector3d::UnitZ()).toRotationMatrix();
    for (auto& T : turned.mounts) T = R_turned_from_base * T;
    const EgoVelocityResult& result = estimator.estimate(turned.scans(), 0.0);
    ASSERT_TRUE(result.valid());
    EXPECT_LT((result.linear - R_turned_from_base.linear() * reference.linear).norm(), 2e-4);
    EXPECT_NEAR(result.angular.z(), reference.angular.z(), 1e-4);
    EXPECT_EQ(result.dynamic_count, reference.dynamic_count);
  }
}

TEST(EgoVelocity, SameSeedSameBits) {
  SweepOptions options;
  options.moving_share = 0.4;
  options.doppler_sigma = 0.1;
  const Sweep sweep = makeSweep(carMounts(), {9.0, 0.0, 0.0}, {0.0, 0.0, 0.1}, options);
  EgoVelocityEstimator first(paramsFor(MotionModel::kPlanarYaw));
  EgoVelocityEstimator second(paramsFor(MotionModel::kPlanarYaw));
  second.estimate(makeSweep(carMounts(), {1.0, 0.0, 0.0}, Vector3d::Zero()).scans(),
                  0.0);  // history has no effect
  const EgoVelocityResult& a = first.estimate(sweep.scans(), 0.0);
  const EgoVelocityResult& b = second.estimate(sweep.scans(), 0.0);
  EXPECT_EQ(a.linear, b.linear);
  EXPECT_EQ(a.angular, b.angular);
  EXPECT_EQ(a.residuals, b.residuals);
  EXPECT_EQ(a.labels, b.labels);
}

// The paper's finding on data where the answer is known: dropping movers (A1) improves on B1, and
// consensus (B2, A2) on both.
TEST(EgoVelocity, SegmentationImprovesLeastSquares) {
  SweepOptions options;
  options.moving_share = 0.3;
  options.doppler_sigma = 0.05;
  options.min_target_speed = 0.3;  // some movers stay below tau
  options.max_target_speed = 3.0;
  const Vector3d v(8.0, 0.0, 0.0);
  double error[2][2] = {{0.0, 0.0}, {0.0, 0.0}};
  for (std::uint32_t seed = 1; seed <= 50; ++seed) {
    options.seed = seed;
    const Sweep sweep = makeSweep(carMounts(), v, Vector3d::Zero(), options);
    for (const Solver solver : {Solver::kLeastSquares, Solver::kRansac}) {
      for (const bool two_pass : {false, true}) {
        EgoVelocityEstimator estimator(paramsFor(MotionModel::kPlanar, solver, two_pass));
        error[solver == Solver::kRansac][two_pass] +=
            (estimator.estimate(sweep.scans(), 0.0).linear - v).norm() / 50;
      }
    }
  }
  EXPECT_LT(error[0][1], 0.5 * error[0][0]) << "A1 against B1";
  EXPECT_LT(error[1][0], error[0][1]) << "B2 against A1";
  std::printf("B1 %.4f A1 %.4f B2 %.4f A2 %.4f m/s\n", error[0][0], error[0][1], error[1][0], error[1][1]);
  EXPECT_LT(error[1][1], error[0][1]) << "A2 against A1";
}

TEST(EgoVelocity, SpatialRadarWithMoversMeetsItsAccuracy) {
  SweepOptions options;
  options.returns_per_radar = 500;
  options.moving_share = 0.2;
  options.doppler_sigma = 0.05;
  options.azimuth_sigma = 0.3 * M_PI / 180;
  options.elevation_sigma = 0.5 * M_PI / 180;
  options.max_elevation = 0.26;
  options.half_field_of_view = 1.0;
  const Vector3d v(8.0, 0.3, -0.1);
  double error = 0.0;
  std::size_t static_found = 0;
  std::size_t static_total = 0;
  constexpr int kTrials = 100;
  for (int trial = 0; trial < kTrials; ++trial) {
    options.seed = static_cast<std::uint32_t>(trial + 1);
    const Sweep sweep = makeSweep({mount(3.4, 0.0, 0.5, 0.0)}, v, Vector3d::Zero(), options);
    const EgoVelocityResult result = estimated(sweep, paramsFor(MotionModel::kSpatial));
    ASSERT_TRUE(result.valid()) << "seed " << options.seed;
    error += (result.linear - v).norm() / kTrials;
    for (std::size_t i = 0; i < result.labels.size(); ++i) {
      if (sweep.moving[0][i]) continue;
      ++static_total;
      if (result.labels[i] == ReturnLabel::kStatic) ++static_found;
    }
  }
  const double recall = static_cast<double>(static_found) / static_cast<double>(static_total);
  std::printf("spatial: mean error %.4f m/s, static recall %.4f\n", error, recall);
  RecordProperty("mean_error_m_per_s", std::to_string(error));
  EXPECT_LE(error, 0.021);
  EXPECT_GE(recall, 0.98);
}

TEST(EgoVelocity, SixtyPercentMovingIsSolvedOrRefused) {
  SweepOptions options;
  options.moving_share = 0.6;
  options.doppler_sigma = 0.05;
  options.azimuth_sigma = 0.3 * M_PI / 180;
  options.elevation_sigma = 0.5 * M_PI / 180;
  const Vector3d v(8.0, 0.0, 0.0);
  for (const MotionModel model : {MotionModel::kPlanar, MotionModel::kPlanarYaw, MotionModel::kSpatial}) {
    const bool spatial = model == MotionModel::kSpatial;
    options.max_elevation = spatial ? 0.26 : 0.0;
    options.returns_per_radar = spatial ? 500 : 100;
    int solved = 0;
    double worst = 0.0;
    for (std::uint32_t seed = 1; seed <= 100; ++seed) {
      options.seed = seed;
      const std::vector<Eigen::Isometry3d> mounts =
          spatial ? std::vector<Eigen::Isometry3d>{mount(3.4, 0.0, 0.5, 0.0)} : carMounts();
      const Sweep sweep = makeSweep(mounts, v, Vector3d::Zero(), options);
      const EgoVelocityResult result = estimated(sweep, paramsFor(model));
      if (!result.valid()) continue;
      ++solved;
      worst = std::max(worst, (result.linear - v).norm());
    }
    std::printf("60 %% moving, %s: %d of 100 solved, worst error %.4f m/s\n", toString(model).data(), solved,
                worst);
    EXPECT_LT(worst, 0.1) << toString(model);
    EXPECT_GT(solved, 90) << toString(model) << ": refusing everything is no answer";
  }
}

TEST(EgoVelocity, SceneWhereEverythingMovesIsRefused) {
  SweepOptions options;
  options.moving_share = 1.0;
  options.max_target_speed = 15.0;
  options.min_target_speed = 0.0;
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    options.seed = seed;
    const Sweep sweep = makeSweep(carMounts(), {8.0, 0.0, 0.0}, Vector3d::Zero(), options);
    const EgoVelocityResult result = estimated(sweep, paramsFor(MotionModel::kPlanarYaw));
    EXPECT_EQ(result.status, EstimateStatus::kNoConsensus) << "seed " << seed;
    EXPECT_FALSE(result.reason.empty());
    EXPECT_TRUE(result.labels.empty());
  }
}

TEST(EgoVelocity, ReasonsCountTheReturnsThatAgree) {
  SweepOptions options;
  options.doppler_sigma = 0.3;
  EgoVelocityParams params = paramsFor(MotionModel::kPlanar);
  params.segmentation.threshold = 0.01;  // 2.7 % of a normal distribution of 0.3, of 300 returns
  params.min_returns = 25;
  const EgoVelocityResult result = EgoVelocityEstimator(params).estimate(
      makeSweep(carMounts(), {8.0, 0.0, 0.0}, Vector3d::Zero(), options).scans(), 0.0);
  EXPECT_EQ(result.status, EstimateStatus::kNoConsensus);
  EXPECT_GT(result.inlier_count, 0U);
  EXPECT_EQ(result.reason, "only " + std::to_string(result.inlier_count) +
                               " of 300 returns agree on one velocity within 0.01 m/s");
}

// All returns agree; but half of the samples of a single draw are of two parallel bearings.
TEST(EgoVelocity, ParallelSamplesAreNotDisagreement) {
  std::vector<DopplerReturn> returns(60);
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const double azimuth = i < 30 ? 0.0 : 0.5;
    returns[i].bearing = Vector3d(std::cos(azimuth), std::sin(azimuth), 0.0).cast<float>();
    returns[i].doppler = -5.F * returns[i].bearing.x();
  }
  EgoVelocityParams params = paramsFor(MotionModel::kPlanar);
  params.ransac_iterations = 1;
  int refused = 0;
  for (params.seed = 1; params.seed <= 20; ++params.seed) {
    const EgoVelocityResult result =
        EgoVelocityEstimator(params).estimate({{returns, Eigen::Isometry3d::Identity(), 0.0}}, 0.0);
    if (result.valid()) continue;
    ++refused;
    EXPECT_EQ(result.reason, "no velocity found for 60 returns: their bearings are too close to parallel");
  }
  EXPECT_GT(refused, 0);
  EXPECT_LT(refused, 20);
}

// A model car at 1:256 that turns 256 times as fast: its radars measure the same, and its samples are as
// good.
TEST(EgoVelocity, TheSizeOfTheVehicleDoesNotMatterToConsensus) {
  constexpr float kScale = 1.F / 256.F;
  std::mt19937 random(5);
  std::uniform_real_distribution<float> unit(-1.F, 1.F);
  ConstraintSystem car;
  car.resize(3, 100);
  for (std::size_t i = 0; i < car.rows; ++i) {
    const float azimuth = 3.F * unit(random), lever_arm = 4.F * unit(random);
    car.columns[0][i] = std::cos(azimuth);
    car.columns[1][i] = std::sin(azimuth);
    car.columns[2][i] = lever_arm;
    car.right_hand_side[i] =
        6.F * std::cos(azimuth) + 0.2F * lever_arm + (i % 3 == 0 ? 5.F : 0.1F) * unit(random);
  }
  ConstraintSystem model = car;
  for (float& value : model.columns[2]) value *= kScale;
  SolverScratch scratch;
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    Parameters of_car = Parameters::Zero(), of_model = of_car;
    ASSERT_EQ(solveRansac(car, {seed, 1, 0.3, 4.0}, of_car, scratch),
              solveRansac(model, {seed, 1, 0.3, 4.0 * kScale}, of_model, scratch))
        << seed;
    of_model[2] *= kScale;
    EXPECT_LT((of_car - of_model).norm(), 1e-4) << seed;
  }
}

TEST(EgoVelocity, OneRadarAtTheRotationCentreCannotSeeTheYawRate) {
  const Vector3d v(5.0, 0.5, 0.0);
  const Sweep sweep = makeSweep({mount(0.0, 0.0, 0.5, 0.0)}, v, {0.0, 0.0, 0.4});
  EgoVelocityEstimator estimator(paramsFor(MotionModel::kPlanarYaw));
  const EgoVelocityResult& result = estimator.estimate(sweep.scans(), 0.0);
  ASSERT_TRUE(result.valid()) << result.reason;
  EXPECT_LT((result.linear - v).norm(), 1e-4);
  EXPECT_TRUE(result.observed[0]);
  EXPECT_TRUE(result.observed[1]);
  EXPECT_FALSE(result.observed[5]);
  EXPECT_FALSE(result.fully_observed);
  EXPECT_GE(result.covariance(5, 5), 0.99 * estimator.params().unobserved_variance);
  EXPECT_LT(result.covariance(0, 0), 0.01);
  EXPECT_NEAR(result.angular.z(), 0.0, 1e-6) << "nothing is invented";
}

// One radar ahead of the axle tells vx, but not sideslip and yaw rate apart: only their sum at the mount.
TEST(EgoVelocity, OneFrontRadarSeesOnlyTheSumOfSideslipAndYaw) {
  const double lever = 3.4;
  const Sweep sweep = makeSweep({mount(lever, 0.0, 0.5, 0.0)}, {5.0, 0.0, 0.0}, {0.0, 0.0, 0.3});
  const EgoVelocityResult result = estimated(sweep, paramsFor(MotionModel::kPlanarYaw));
  ASSERT_TRUE(result.valid()) << result.reason;
  EXPECT_NEAR(result.linear.x(), 5.0, 1e-4);
  EXPECT_NEAR(result.linear.y() + lever * result.angular.z(), 0.3 * lever, 1e-4);
  EXPECT_NEAR(result.linear.y(), 0.0, 5e-3) << "the member of the family with the least sideslip";
  EXPECT_TRUE(result.observed[0]);
  EXPECT_FALSE(result.observed[1]);
  EXPECT_FALSE(result.observed[5]);
  EXPECT_EQ(result.dynamic_count, 0U);
  // The covariance knows that the sum is well determined: Var(vy + l w) is small.
  const double sum_variance = result.covariance(1, 1) + 2.0 * lever * result.covariance(1, 5) +
                              lever * lever * result.covariance(5, 5);
  EXPECT_LT(sum_variance, 0.01);
  EXPECT_GE(result.covariance(1, 1), 0.99e6) << "unobserved_variance, whatever the lever arm";
  EXPECT_GE(result.covariance(5, 5), 0.99e6);

  // With the rear axle's constraint the same radar gives the yaw rate.
  EgoVelocityEstimator ackermann(paramsFor(MotionModel::kAckermann));
  const EgoVelocityResult& constrained = ackermann.estimate(sweep.scans(), 0.0);
  ASSERT_TRUE(constrained.valid());
  EXPECT_NEAR(constrained.angular.z(), 0.3, 1e-4);
  EXPECT_TRUE(constrained.fully_observed);
  EXPECT_FALSE(constrained.observed[1]) << "vy = 0 is the model's assumption";
  EXPECT_NEAR(constrained.covariance(1, 1), 0.01, 1e-12) << "with the variance of its sideslip_std";
  // A sideslip of 0.1 m/s would pass for a yaw rate of 0.1 / 3.4 rad/s.
  EXPECT_NEAR(constrained.covariance(1, 5), -0.01 / lever, 1e-5);
  EgoVelocityParams no_slip = paramsFor(MotionModel::kAckermann);
  no_slip.sideslip_std = 0.001;
  EXPECT_NEAR(constrained.covariance(5, 5) - estimated(sweep, no_slip).covariance(5, 5),
              (0.01 - 1e-6) / (lever * lever), 1e-6);
}

// A 3D radar ahead of the origin sees the vertical velocity too; sideslip and yaw rate only together.
TEST(EgoVelocity, OneSpatialRadarSeesItsOwnVelocity) {
  SweepOptions options;
  options.max_elevation = 0.4;
  const auto seen = [&options](double x) {
    return estimated(makeSweep({mount(x, 0.0, 0.5, 0.0)}, {5.0, 0.2, -0.3}, {0.0, 0.0, 0.3}, options),
                     paramsFor(MotionModel::kSpatial));
  };
  const double lever = 3.6;
  const EgoVelocityResult ahead = seen(lever);
  ASSERT_TRUE(ahead.valid()) << ahead.reason;
  EXPECT_EQ(ahead.observed, (std::array<bool, 6>{true, false, true, false, false, false}));
  EXPECT_FALSE(ahead.fully_observed);
  EXPECT_NEAR(ahead.linear.x(), 5.0, 1e-3);
  EXPECT_NEAR(ahead.linear.z(), -0.3, 1e-3);
  EXPECT_NEAR(ahead.linear.y() + lever * ahead.angular.z(), 0.2 + lever * 0.3, 1e-3);
  EXPECT_NEAR(ahead.angular.z(), 0.0, 1e-3) << "the member of the family with the least yaw rate";
  EXPECT_GE(ahead.covariance(1, 1), 0.99e6);
  EXPECT_GE(ahead.covariance(5, 5), 0.99e6);
  EXPECT_LT(
      ahead.covariance(1, 1) + 2.0 * lever * ahead.covariance(1, 5) + lever * lever * ahead.covariance(5, 5),
      0.02);

  const EgoVelocityResult at_origin = seen(0.0);
  ASSERT_TRUE(at_origin.valid()) << at_origin.reason;
  EXPECT_EQ(at_origin.observed, (std::array<bool, 6>{true, true, true, false, false, false}));
  EXPECT_LT((at_origin.linear - Vector3d(5.0, 0.2, -0.3)).norm(), 1e-3);
}

/// Returns of static points all around, as a radar with this velocity over ground (axes of the base frame)
/// sees them.
std::vector<DopplerReturn> returnsAt(const Vector3d& velocity, double max_elevation) {
  std::vector<DopplerReturn> returns;
  for (int i = 0; i < 100; ++i) {
    const double azimuth = -1.0 + 0.02 * i;
    const double elevation = max_elevation * std::sin(1.7 * i);
    const Vector3d u(std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
                     std::sin(elevation));
    returns.emplace_back();
    returns.back().bearing = u.cast<float>();
    returns.back().range = 20.F;
    returns.back().doppler = static_cast<float>(-u.dot(velocity));
  }
  return returns;
}

// 10 m/s in a curve of 0.15 rad/s, which moves a radar 3.6 m ahead sideways by 0.54 m/s.
TEST(EgoVelocity, AKnownYawRateTellsTheVelocityOfTheOriginFromOneRadar) {
  const std::vector<DopplerReturn> returns = returnsAt({10.0, 0.54, 0.0}, 0.0);
  const std::vector<RadarScan> scans = {{returns, mount(3.6, 0.0, 0.5, 0.0), 0.0}};
  for (const MotionModel model : {MotionModel::kPlanar, MotionModel::kPlanarYaw, MotionModel::kAckermann}) {
    EgoVelocityEstimator estimator(paramsFor(model));
    const auto with = [&](double std) {
      const AngularVelocity known{{0.0, 0.0, 0.15}, std * std * Eigen::Matrix3d::Identity()};
      return estimator.estimate(scans, 0.0, Vector3d::Zero(), known);
    };
    const EgoVelocityResult result = with(0.02);
    ASSERT_TRUE(result.valid()) << toString(model) << result.reason;
    EXPECT_LT((result.linear - Vector3d(10.0, 0.0, 0.0)).norm(), 1e-4) << toString(model);
    EXPECT_EQ(result.angular, Vector3d(0.0, 0.0, 0.15)) << toString(model);
    EXPECT_TRUE(result.observed[5] && result.fully_observed) << toString(model);
    EXPECT_EQ(result.sources[5], AxisSource::kGiven);
    EXPECT_NEAR(result.covariance(5, 5), 4e-4, 1e-12);
    EXPECT_LT(*std::max_element(result.residuals.begin(), result.residuals.end()), 1e-4F);
    if (model == MotionModel::kAckermann) continue;  // whose vy is assumed
    EXPECT_TRUE(result.observed[1]) << toString(model);
    EXPECT_NEAR(result.covariance(1, 5), -3.6 * 4e-4, 1e-6) << toString(model);
    // An error of the roll rate moves the radar at 0.5 m as well.
    EXPECT_NEAR(result.covariance(1, 1) - with(0.0).covariance(1, 1), (3.6 * 3.6 + 0.5 * 0.5) * 4e-4, 1e-6);
  }
  EgoVelocityEstimator planar(paramsFor(MotionModel::kPlanar));
  AngularVelocity lost;
  lost.rate.z() = std::nan("");
  EXPECT_NEAR(planar.estimate(scans, 0.0, Vector3d::Zero(), lost).linear.y(), 0.54, 1e-4) << "as without";
}

// w x t = (-0.1 x 1.5 - 0.3 x 0.5, 0.3 x 2 - 0.2 x 1.5, 0.2 x 0.5 + 0.1 x 2) = (-0.3, 0.3, 0.3) m/s.
TEST(EgoVelocity, AKnownAngularVelocityCountsWithTheWholeLeverArm) {
  const std::vector<DopplerReturn> returns = returnsAt({5.7, 0.1, 0.7}, 0.4);
  const AngularVelocity known{{0.2, -0.1, 0.3}, Vector3d(1e-4, 4e-4, 9e-4).asDiagonal()};
  const EgoVelocityResult result =
      EgoVelocityEstimator(paramsFor(MotionModel::kSpatial))
          .estimate({{returns, mount(2.0, 0.5, 1.5, 0.0), 0.0}}, 0.0, Vector3d::Zero(), known);
  ASSERT_TRUE(result.valid()) << result.reason;
  EXPECT_LT((result.linear - Vector3d(6.0, -0.2, 0.4)).norm(), 1e-4);
  EXPECT_EQ(result.angular, known.rate);
  EXPECT_EQ(result.observed, (std::array<bool, 6>{true, true, true, true, true, true}));
  EXPECT_NEAR(result.covariance(0, 4), -1.5 * 4e-4, 1e-6) << "an error of the pitch rate is one of vx";
  EXPECT_NEAR(result.covariance(2, 3), -0.5 * 1e-4, 1e-6);
  EXPECT_GT(result.covariance.ldlt().vectorD().minCoeff(), 0.0);
}

// A corner radar off the centre line determines none of the three alone, yet labels its returns.
TEST(EgoVelocity, OneCornerRadarDeterminesOnlyItsOwnVelocity) {
  SweepOptions options;
  options.moving_share = 0.2;
  const Sweep sweep = makeSweep({mount(2.4, 0.8, 0.8, 1.54)}, {5.0, 0.0, 0.0}, {0.0, 0.0, 0.3}, options);
  const EgoVelocityResult result = estimated(sweep, paramsFor(MotionModel::kPlanarYaw));
  ASSERT_TRUE(result.valid()) << result.reason;
  for (const std::size_t axis : {0U, 1U, 5U}) EXPECT_FALSE(result.observed[axis]) << axis;
  EXPECT_NEAR(result.linear.x() - 0.8 * result.angular.z(), 5.0 - 0.8 * 0.3, 1e-3);
  EXPECT_NEAR(result.linear.y() + 2.4 * result.angular.z(), 2.4 * 0.3, 1e-3);
  EXPECT_NEAR(result.angular.z(), 0.3, 5e-3);
  for (std::size_t i = 0; i < result.labels.size(); ++i) {
    EXPECT_EQ(result.labels[i] == ReturnLabel::kDynamic, sweep.moving[0][i]) << i;
  }
}

TEST(EgoVelocity, PlanarBearingsCannotSeeTheVerticalVelocity) {
  const Sweep sweep = makeSweep(carMounts(), {6.0, 0.0, 0.0}, Vector3d::Zero());
  const EgoVelocityResult result = estimated(sweep, paramsFor(MotionModel::kSpatial));
  ASSERT_TRUE(result.valid()) << result.reason;
  EXPECT_NEAR(result.linear.x(), 6.0, 1e-4);
  EXPECT_FALSE(result.observed[2]);
  EXPECT_NEAR(result.linear.z(), 0.0, 1e-6);
}

TEST(EgoVelocity, ParallelBearingsAreRefused) {
  SweepOptions options;
  options.half_field_of_view = 1e-4;
  const Sweep sweep = makeSweep({mount(3.0, 0.0, 0.0, 0.4)}, {6.0, 0.0, 0.0}, Vector3d::Zero(), options);
  for (const MotionModel model : {MotionModel::kPlanar, MotionModel::kPlanarYaw, MotionModel::kSpatial}) {
    EgoVelocityEstimator estimator(paramsFor(model));
    const EgoVelocityResult& result = estimator.estimate(sweep.scans(), 0.0);
    EXPECT_EQ(result.status, EstimateStatus::kDegenerateBearings) << toString(model);
    EXPECT_NE(result.reason.find("bearings"), std::string::npos);
    EXPECT_GE(result.covariance(0, 0), estimator.params().unobserved_variance);
  }
}

TEST(EgoVelocity, FewReturnsAreRefusedWithTheirNumber) {
  EgoVelocityEstimator estimator;
  EXPECT_EQ(estimator.estimate({}, 0.0).status, EstimateStatus::kTooFewReturns);
  std::vector<DopplerReturn> none;
  EXPECT_EQ(estimator.estimate({{none, Eigen::Isometry3d::Identity(), 0.0}}, 0.0).status,
            EstimateStatus::kTooFewReturns);
  std::vector<DopplerReturn> one(1);
  const EgoVelocityResult& result = estimator.estimate({{one, Eigen::Isometry3d::Identity(), 0.0}}, 0.0);
  EXPECT_EQ(result.status, EstimateStatus::kTooFewReturns);
  EXPECT_NE(result.reason.find("1 accepted"), std::string::npos) << result.reason;
}

// Copies of one return constrain one direction only; copies of a good sweep change nothing.
TEST(EgoVelocity, DuplicatesDoNotFoolTheGeometry) {
  std::vector<DopplerReturn> copies(50);
  for (auto& copy : copies) copy.doppler = -5.F;
  EgoVelocityEstimator estimator;
  EXPECT_EQ(estimator.estimate({{copies, mount(3.0, 0.0, 0.0, 0.3), 0.0}}, 0.0).status,
            EstimateStatus::kDegenerateBearings);

  Sweep sweep = makeSweep(carMounts(), {6.0, 0.1, 0.0}, {0.0, 0.0, 0.1});
  for (auto& scan : sweep.returns) {
    const auto once = scan;
    scan.insert(scan.end(), once.begin(), once.end());
  }
  const EgoVelocityResult& result = estimator.estimate(sweep.scans(), 0.0);
  ASSERT_TRUE(result.valid());
  EXPECT_NEAR(result.linear.x(), 6.0, 1e-4);
}

/// Mean normalised squared error over many sweeps with independent errors (doppler_std) and errors that
/// the returns of a scan share (scan_std). For a correct covariance it is the number of parameters, 3.
double normalisedError(const EgoVelocityParams& params, SweepOptions options = {}) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0.0, 1.0);
  options.doppler_sigma = params.noise.doppler_std;
  const Vector3d v(8.0, 0.0, 0.0);
  constexpr int kTrials = 400;
  double squared = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    options.seed = static_cast<std::uint32_t>(trial + 1);
    Sweep sweep = makeSweep(carMounts(), v, {0.0, 0.0, 0.2}, options);
    for (auto& scan : sweep.returns) {
      const auto shared = static_cast<float>(params.scan_std * normal(random));
      for (DopplerReturn& measured : scan) measured.doppler += shared;
    }
    EgoVelocityEstimator estimator(params);
    const EgoVelocityResult& result = estimator.estimate(sweep.scans(), 0.0);
    EXPECT_TRUE(result.valid());
    const int axes[] = {0, 1, 5};
    Eigen::Matrix3d covariance;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) covariance(i, j) = result.covariance(axes[i], axes[j]);
    }
    const Vector3d error(result.linear.x() - v.x(), result.linear.y() - v.y(), result.angular.z() - 0.2);
    squared += error.dot(covariance.inverse() * error) / kTrials;
  }
  return squared;
}

TEST(EgoVelocity, CovarianceIsConsistentWithTheErrors) {
  EgoVelocityParams params = paramsFor(MotionModel::kPlanarYaw);
  params.noise.doppler_std = 0.1;
  params.noise.azimuth_std = 0.0;
  for (const double scan_std : {0.0, 0.05}) {
    params.scan_std = scan_std;
    const double error = normalisedError(params);
    EXPECT_GT(error, 2.3) << "scan_std " << scan_std;
    EXPECT_LT(error, 4.0) << "scan_std " << scan_std << ": the robust weights cost some efficiency, no more";
  }
}

TEST(EgoVelocity, ScansOfOtherTimesAreBroughtToTheReferenceTime) {
  const Vector3d a(2.0, 0.0, 0.0);
  const Vector3d v_reference(8.0, 0.0, 0.0);
  Sweep sweep = makeSweep(carMounts(), v_reference, Vector3d::Zero());
  for (std::size_t i = 0; i < sweep.mounts.size(); ++i) {
    const double time = -0.015 * static_cast<double>(i);
    const Sweep single = makeSweep({sweep.mounts[i]}, v_reference + a * time, Vector3d::Zero());
    sweep.returns[i] = single.returns[0];
    sweep.times[i] = time;
  }
  EgoVelocityEstimator estimator(paramsFor(MotionModel::kPlanarYaw));
  const double without = (estimator.estimate(sweep.scans(), 0.0).linear - v_reference).norm();
  const double with = (estimator.estimate(sweep.scans(), 0.0, a).linear - v_reference).norm();
  EXPECT_GT(without, 0.02);
  EXPECT_LT(with, 1e-4);
}

TEST(EgoVelocity, ReturnsKnownToMoveDoNotTakePart) {
  Sweep sweep = makeSweep(carMounts(), {3.0, 0.0, 0.0}, Vector3d::Zero());
  // A convoy around the vehicle: most returns agree on a wrong velocity.
  std::vector<std::vector<std::uint8_t>> known(sweep.returns.size());
  for (std::size_t r = 0; r < sweep.returns.size(); ++r) {
    known[r].assign(sweep.returns[r].size(), 0);
    for (std::size_t i = 0; i < sweep.returns[r].size(); ++i) {
      if (i % 3 == 0) continue;
      const Vector3d u = sweep.mounts[r].linear() * sweep.returns[r][i].bearing.cast<double>();
      sweep.returns[r][i].doppler += static_cast<float>(3.0 * u.x());
      known[r][i] = 1;
    }
  }
  EgoVelocityEstimator estimator;
  std::vector<RadarScan> scans = sweep.scans();
  EXPECT_NEAR(estimator.estimate(scans, 0.0).linear.x(), 0.0, 1e-3) << "the convoy wins without the mask";
  for (std::size_t r = 0; r < scans.size(); ++r) scans[r].known_dynamic = known[r];
  const EgoVelocityResult& result = estimator.estimate(scans, 0.0);
  EXPECT_NEAR(result.linear.x(), 3.0, 1e-4);
  EXPECT_EQ(result.return_count, 100U);
  EXPECT_EQ(result.dynamic_count, 200U);
}

TEST(EgoVelocity, WhatIsNotFiniteTakesNoPart) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Vector3d v(6.0, 0.2, 0.0);
  const Sweep good = makeSweep(carMounts(), v, {0.0, 0.0, 0.1});
  Sweep sweep = good;
  sweep.returns[0][3].doppler = std::numeric_limits<float>::quiet_NaN();
  sweep.returns[1][5].range = std::numeric_limits<float>::infinity();
  sweep.mounts[3].translation().x() = nan;
  sweep.times[4] = nan;
  const EgoVelocityResult result = estimated(sweep);
  ASSERT_TRUE(result.valid()) << result.reason;
  EXPECT_LT((result.linear - v).norm(), 1e-4);
  EXPECT_EQ(result.return_count, 3U * 60U - 2U);
  EXPECT_EQ(result.labels.size(), 300U) << "one label per return all the same";
  EXPECT_EQ(result.dynamic_count, 0U);
}

// A millimetre or a centimetre off the centre line changes nothing that matters.
TEST(EgoVelocity, ObservabilityDoesNotHangOnMillimetres) {
  for (const double y : {0.0, 0.001, 0.01, 0.05}) {
    const Sweep sweep = makeSweep({mount(3.4, y, 0.5, 0.0)}, {5.0, 0.0, 0.0}, {0.0, 0.0, 0.3});
    const EgoVelocityResult result = estimated(sweep, paramsFor(MotionModel::kPlanarYaw));
    ASSERT_TRUE(result.valid());
    EXPECT_TRUE(result.observed[0]) << y;
    EXPECT_LT(result.covariance(0, 0), 0.01) << y;
    EXPECT_NEAR(result.linear.x(), 5.0, 5e-3) << y;
    EXPECT_FALSE(result.observed[5]) << y;
  }
}

// Bearings that are off make errors that grow with the speed across the line of sight.
TEST(EgoVelocity, CovarianceCountsBearingErrors) {
  EgoVelocityParams params = paramsFor(MotionModel::kPlanarYaw);
  params.noise.doppler_std = 0.02;
  params.noise.azimuth_std = 0.02;
  params.scan_std = 0.0;
  SweepOptions options;
  options.azimuth_sigma = params.noise.azimuth_std;
  const double with = normalisedError(params, options);
  params.noise.azimuth_std = 0.0;
  const double without = normalisedError(params, options);
  EXPECT_LT(with, 5.0);
  EXPECT_GT(with, 1.5);
  EXPECT_GT(without, with) << "blind to the bearings, the estimate is worse than it claims";
}

// Noise above the model widens the covariance.
TEST(EgoVelocity, CovarianceWidensWithTheResiduals) {
  EgoVelocityParams params = paramsFor(MotionModel::kPlanarYaw);
  params.noise.azimuth_std = params.scan_std = 0.0;
  params.noise.doppler_std = 0.05;
  SweepOptions options;
  options.doppler_sigma = 0.1;
  const Sweep sweep = makeSweep(carMounts(), {8.0, 0.0, 0.0}, Vector3d::Zero(), options);
  EgoVelocityEstimator optimistic(params);
  const double claimed = optimistic.estimate(sweep.scans(), 0.0).covariance(0, 0);
  params.noise.doppler_std = 0.1;
  EgoVelocityEstimator honest(params);
  const double fair = honest.estimate(sweep.scans(), 0.0).covariance(0, 0);
  EXPECT_NEAR(claimed / fair, 1.0, 0.3) << "unwidened it would claim a quarter";
}

TEST(EgoVelocity, SenselessParametersAreNamed) {
  EgoVelocityParams params;
  params.inlier_threshold = std::nan("");
  test::expectRefusal([&] { EgoVelocityEstimator estimator(params); }, {"inlier_threshold"});
  EXPECT_THROW(fromString<MotionModel>("bicycle"), std::invalid_argument);
  EXPECT_THROW(fromString<Solver>("magic"), std::invalid_argument);
  EXPECT_EQ(fromString<MotionModel>("ackermann"), MotionModel::kAckermann);
  EXPECT_EQ(fromString<Solver>("ransac"), Solver::kRansac);
}

}  // namespace
}  // namespace radar_dot
