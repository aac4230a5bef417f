// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/objects/object_detection.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace radar_dot {
namespace {

using Eigen::Vector2d;

ReturnOverGround seen(std::size_t radar, const Vector2d& sensor, const Vector2d& position,
                      const Vector2d& velocity) {
  ReturnOverGround over;
  over.radar = radar;
  over.sensor = sensor;
  over.position = position;
  over.covariance = 0.04 * Eigen::Matrix2d::Identity();
  over.velocity = over.bearing().dot(velocity);
  over.variance = 0.01;
  over.label = std::abs(over.velocity) > 0.8 ? ReturnLabel::kDynamic : ReturnLabel::kStatic;
  return over;
}

// Two radars 6 m apart see a car that crosses: neither knows its velocity, both together do.
TEST(ObjectDetection, TwoRadarsTellTheWholeVelocity) {
  const Vector2d position(4.0, 3.0), velocity(2.0, 6.0);
  const auto left = seen(0, {3.0, 0.8}, position, velocity);
  const auto back = seen(1, {-3.0, 0.8}, position + Vector2d(0.3, 0.0), velocity);
  const auto both = detectObjects(5.0, {left, back});
  ASSERT_EQ(both.size(), 1U);
  EXPECT_EQ(both[0].time, 5.0);
  EXPECT_EQ(both[0].return_count, 2U);
  EXPECT_LT((both[0].velocity - velocity).norm(), 0.05);
  EXPECT_LT(both[0].velocity_covariance.trace(), 0.5);

  const auto one = detectObjects(5.0, {left});
  ASSERT_EQ(one.size(), 1U);
  const Vector2d u = left.bearing(), across(-u.y(), u.x());
  EXPECT_NEAR(u.dot(one[0].velocity), u.dot(velocity), 1e-3);
  EXPECT_LT(u.dot(one[0].velocity_covariance * u), 0.05);
  EXPECT_NEAR(std::sqrt(across.dot(one[0].velocity_covariance * across)), 100.0, 0.1);
}

TEST(ObjectDetection, NeighboursInSpaceAndVelocityAreOneObject) {
  DetectionParams params;
  params.max_distance = 2.0;
  const Vector2d sensor(3.5, 0.0);
  const std::vector<ReturnOverGround> returns = {
      seen(0, sensor, {20.0, 0.0}, {5.0, 0.0}), seen(0, sensor, {21.5, 0.0}, {5.2, 0.0}),
      seen(0, sensor, {23.0, 0.0}, {5.4, 0.0}),   // a chain of neighbours
      seen(0, sensor, {21.0, 1.0}, {-5.0, 0.0}),  // comes the other way
      seen(0, sensor, {30.0, 0.0}, {5.0, 0.0})};
  const auto objects = detectObjects(0.0, returns, {}, params);
  ASSERT_EQ(objects.size(), 3U);
  EXPECT_EQ(objects[0].return_count, 3U);
  EXPECT_NEAR(objects[0].position.x(), 21.5, 1e-9);
  EXPECT_NEAR(objects[0].velocity.x(), 5.2, 1e-2) << "the median";
}

// More returns make a better position, but not better than where on the body they gather.
TEST(ObjectDetection, CovarianceShrinksTowardsTheExtent) {
  const auto one = seen(0, {0.0, 0.0}, {20.0, 0.0}, {5.0, 0.0});
  DetectionParams params;
  const double extent = params.extent_std * params.extent_std;
  EXPECT_NEAR(detectObjects(0.0, {one}, {}, params)[0].position_covariance(0, 0), 0.04 + extent, 1e-9);
  EXPECT_NEAR(detectObjects(0.0, {one, one, one, one}, {}, params)[0].position_covariance(0, 0),
              0.01 + extent, 1e-9);
}

TEST(ObjectDetection, SlowReturnsAreWeak) {
  const auto slow = seen(0, {0.0, 0.0}, {20.0, 0.0}, {0.5, 0.0});
  const auto still = seen(0, {0.0, 0.0}, {22.0, 0.0}, {0.1, 0.0});
  const auto objects = detectObjects(0.0, {slow, still});
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_FALSE(objects[0].moving);
  EXPECT_TRUE(detectObjects(0.0, {}).empty());
}

MaskRegion region(const Vector2d& position, const VelocityConstraint& lateral) {
  MaskRegion region;
  region.position = position;
  region.covariance << 4.0, 0.0, 0.0, 0.25;
  region.lateral = lateral;
  region.pixel_count = 900;
  region.box = {10, 20, 30, 40};
  return region;
}

TEST(ObjectDetection, TheImageTellsWhatOneRadarDoesNot) {
  const Vector2d velocity(3.0, 4.0);
  const auto ahead = seen(0, {3.5, 0.0}, {20.0, 0.0}, velocity);
  const MaskRegion on_it = region({22.0, 0.2}, {{0.0, -1.0}, -4.0, 0.04});
  const MaskRegion elsewhere = region({22.0, 8.0}, {{0.0, -1.0}, 1.0, 0.04});
  const auto objects = detectObjects(0.0, {ahead}, {on_it, elsewhere});
  ASSERT_EQ(objects.size(), 2U);
  EXPECT_LT((objects[0].velocity - velocity).norm(), 1e-2);
  EXPECT_NEAR(objects[0].velocity_covariance(1, 1), 0.04, 1e-3);
  EXPECT_EQ(objects[0].pixel_count, 900U);
  EXPECT_EQ(objects[0].return_count, 1U);
  EXPECT_EQ(objects[0].box.width, 30);
  EXPECT_LT(objects[0].position_covariance(0, 0), 0.3) << "better than either alone";
  EXPECT_EQ(objects[1].return_count, 0U);
  EXPECT_NEAR(objects[1].velocity.y(), -1.0, 1e-3);
  EXPECT_GT(objects[1].velocity_covariance(0, 0), 1e3) << "the image does not see what comes nearer";
}

TEST(ObjectDetection, ARegionWithoutFlowTellsThePlaceAlone) {
  const auto ahead = seen(0, {3.5, 0.0}, {20.0, 0.0}, {3.0, 4.0});
  const MaskRegion without_flow =
      region({22.0, 0.2}, {{0.0, -1.0}, 0.0, std::numeric_limits<double>::infinity()});
  const auto radar = detectObjects(0.0, {ahead});
  const auto both = detectObjects(0.0, {ahead}, {without_flow});
  ASSERT_EQ(both.size(), 1U);
  EXPECT_EQ(both[0].pixel_count, 900U);
  EXPECT_EQ(both[0].velocity, radar[0].velocity);
  EXPECT_EQ(both[0].velocity_covariance, radar[0].velocity_covariance);
  EXPECT_LT(both[0].position_covariance(1, 1), radar[0].position_covariance(1, 1));
  const auto alone = detectObjects(0.0, {}, {without_flow});
  ASSERT_EQ(alone.size(), 1U);
  EXPECT_TRUE(alone[0].velocity.isZero());
  EXPECT_NEAR(alone[0].velocity_covariance(1, 1), 1e4, 1e-6);
}

TEST(ObjectDetection, RefusesInvalidParameters) {
  DetectionParams params;
  params.unobserved_std = 0.0;
  EXPECT_THROW(detectObjects(0.0, {}, {}, params), std::invalid_argument);
}

}  // namespace
}  // namespace radar_dot
