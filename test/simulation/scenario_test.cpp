// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/simulation/scenario.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>

#include "fixtures/refusal.h"
#include "radar_dot/simulation/ray_tracing.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::uint64_t kSeed = 5;

/// A box on the ground.
struct Box {
  Eigen::Isometry3d pose;
  Vector2d low, high;  // in its own frame

  Vector2d corner(int number) const {
    const Vector3d local((number == 0 || number == 3) ? low.x() : high.x(), number < 2 ? low.y() : high.y(),
                         0.0);
    return (pose * local).head<2>();
  }
};

Box boxOf(const Actor& actor, double time) {
  const Vector2d half = 0.5 * actor.model->size.head<2>();
  return {actor.trajectory->at(time).T_map_from_body, -half, half};
}

Box boxOfEgo(const Trajectory& ego, double time) {
  return {ego.at(time).T_map_from_body, Vector2d(-0.8, -0.865), Vector2d(3.28, 0.865)};
}

/// Convex shapes are apart if an edge of one of them separates them.
bool separatedByEdge(const Box& a, const Box& b) {
  for (int i = 0; i < 4; ++i) {
    const Vector2d from = a.corner(i);
    const Vector2d edge = a.corner((i + 1) % 4) - from;
    bool outside = true;
    for (int k = 0; k < 4; ++k) {
      const Vector2d point = b.corner(k) - from;
      outside = outside && edge.x() * point.y() - edge.y() * point.x() < 0.0;
    }
    if (outside) return true;
  }
  return false;
}

bool touch(const Box& a, const Box& b) {
  if ((a.pose.translation() - b.pose.translation()).head<2>().norm() > 14.0) return false;
  return !separatedByEdge(a, b) && !separatedByEdge(b, a);
}

int countAttribute(const Scenario& scenario, double time, const std::string& attribute,
                   const std::function<bool(const Vector3d&)>& where) {
  const Eigen::Isometry3d T_ego_from_map = scenario.ego->at(time).T_map_from_body.inverse();
  int count = 0;
  for (const Actor& actor : scenario.world.actors)
    if (attributeOf(actor, time) == attribute &&
        where(T_ego_from_map * actor.trajectory->at(time).T_map_from_body.translation()))
      ++count;
  return count;
}

bool inFront(const Vector3d& place) {
  return place.x() > 4.0 && place.x() < 62.0 && std::abs(place.y()) < 0.62 * place.x();
}

bool near(const Vector3d& place) { return place.norm() < 60.0; }

class EveryScenario : public testing::TestWithParam<std::string> {};

TEST_P(EveryScenario, IsBuiltQuickly) {
  for (const double duration : {1.0, 3.0, 20.0}) {
    const auto start = std::chrono::steady_clock::now();
    const Scenario scenario = makeScenario(GetParam(), duration, kSeed);
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(), 3.0);
    EXPECT_EQ(scenario.name, GetParam());
    EXPECT_FALSE(scenario.description.empty());
    EXPECT_GT(scenario.world.statics.size(), 100U);
    EXPECT_NEAR(scenario.world.lighting.to_sun.norm(), 1.0F, 1e-5F);
  }
}

TEST_P(EveryScenario, NobodyTouchesAnother) {
  for (const double duration : {3.0, 20.0}) {
    const Scenario scenario = makeScenario(GetParam(), duration, kSeed);
    const auto& actors = scenario.world.actors;
    for (double time = 0.0; time <= duration; time += 0.17) {
      std::vector<Box> boxes;
      for (const Actor& actor : actors) boxes.push_back(boxOf(actor, time));
      const Box ego = boxOfEgo(*scenario.ego, time);
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        ASSERT_FALSE(touch(boxes[i], ego))
            << actors[i].model->category << " " << i << " and the ego at " << time;
        for (std::size_t k = 0; k < i; ++k)
          ASSERT_FALSE(touch(boxes[i], boxes[k])) << actors[i].model->category << " " << i << " and "
                                                  << actors[k].model->category << " " << k << " at " << time;
      }
    }
  }
}

TEST_P(EveryScenario, NobodyPassesThroughWhatStands) {
  constexpr double kDuration = 20.0;
  Scenario scenario = makeScenario(GetParam(), kDuration, kSeed);
  std::vector<Actor> actors;
  std::swap(actors, scenario.world.actors);
  const RayGeometry geometry(scenario.world);
  const Snapshot snapshot(scenario.world, geometry, 0.0);
  const auto isFree = [&](const Box& box, double height) {
    for (int i = 0; i < 4; ++i) {
      const Vector2d from = i % 2 == 0 ? box.pose.translation().head<2>() : box.corner(i);
      const Vector2d to = i % 2 == 0 ? box.corner(i / 2) : box.corner((i + 1) % 4);
      const Vector2d way = to - from;
      const double z = box.pose.translation().z() + height;
      if (snapshot.blocked(Vector3d(from.x(), from.y(), z).cast<float>(),
                           Vector3d(way.x() / way.norm(), way.y() / way.norm(), 0.0).cast<float>(), 0.0F,
                           static_cast<float>(way.norm())))
        return false;
    }
    return true;
  };
  for (double time = 0.0; time <= kDuration; time += 0.5) {
    for (const double height : {0.45, 1.4}) {
      ASSERT_TRUE(isFree(boxOfEgo(*scenario.ego, time), height)) << "the ego at " << time;
      for (const Actor& actor : actors)
        ASSERT_TRUE(isFree(boxOf(actor, time), height))
            << actor.model->category << " at " << time << ", "
            << actor.trajectory->at(time).T_map_from_body.translation().transpose();
    }
  }
}

TEST_P(EveryScenario, SpeedsAndAccelerationsArePlausible) {
  constexpr double kDuration = 20.0;
  const Scenario scenario = makeScenario(GetParam(), kDuration, kSeed);
  const auto check = [](const Trajectory& body, double most_speed, double most_acceleration, double time) {
    const Vector3d acceleration = (body.velocity(time + 0.02) - body.velocity(time - 0.02)) / 0.04;
    ASSERT_LT(body.velocity(time).norm(), most_speed);
    ASSERT_LT(acceleration.head<2>().norm(), most_acceleration);
  };
  for (double time = 0.0; time <= kDuration; time += 0.5) {
    check(*scenario.ego, 15.0, 5.0, time);
    for (const Actor& actor : scenario.world.actors) {
      SCOPED_TRACE(actor.model->category + " at " + std::to_string(time));
      check(*actor.trajectory, actor.model->category.rfind("human", 0) == 0 ? 1.95 : 15.0, 6.0, time);
    }
  }
}

TEST_P(EveryScenario, SameSeedSameScenario) {
  const Scenario first = makeScenario(GetParam(), 4.0, kSeed);
  const Scenario second = makeScenario(GetParam(), 4.0, kSeed);
  const Scenario other = makeScenario(GetParam(), 4.0, kSeed + 1);
  ASSERT_EQ(first.world.statics.size(), second.world.statics.size());
  ASSERT_EQ(first.world.actors.size(), second.world.actors.size());
  for (std::size_t i = 0; i < first.world.statics.size(); ++i) {
    const StaticObject& a = first.world.statics[i];
    const StaticObject& b = second.world.statics[i];
    ASSERT_EQ(a.mesh->positions, b.mesh->positions);
    ASSERT_EQ(a.T_map_from_object.matrix(), b.T_map_from_object.matrix());
  }
  for (std::size_t i = 0; i < first.world.actors.size(); ++i) {
    const Actor& a = first.world.actors[i];
    const Actor& b = second.world.actors[i];
    ASSERT_EQ(a.trajectory->at(1.3).T_map_from_body.matrix(), b.trajectory->at(1.3).T_map_from_body.matrix());
    for (std::size_t slot = 0; slot < a.palette.size(); ++slot)
      ASSERT_TRUE((a.palette[slot] == b.palette[slot]).all());
  }
  EXPECT_EQ(first.ego->at(2.7).T_map_from_body.matrix(), second.ego->at(2.7).T_map_from_body.matrix());
  bool differs = first.world.statics.size() != other.world.statics.size();
  for (std::size_t i = 0; !differs && i < first.world.statics.size(); ++i)
    differs = first.world.statics[i].T_map_from_object.matrix() !=
              other.world.statics[i].T_map_from_object.matrix();
  EXPECT_TRUE(differs);
}

TEST_P(EveryScenario, FitsInAKilometreForAMinute) {
  constexpr double kDuration = 60.0;
  const Scenario scenario = makeScenario(GetParam(), kDuration, kSeed);
  for (double time = 0.0; time <= kDuration; time += 5.0) {
    EXPECT_LT(scenario.ego->at(time).T_map_from_body.translation().norm(), 1000.0);
    for (const Actor& actor : scenario.world.actors)
      ASSERT_LT(actor.trajectory->at(time).T_map_from_body.translation().norm(), 1000.0);
  }
}

TEST_P(EveryScenario, SomethingMovesInFrontOfTheEgo) {
  if (GetParam() == "car_park") GTEST_SKIP() << "nothing moves there";
  constexpr double kDuration = 20.0;
  const Scenario scenario = makeScenario(GetParam(), kDuration, kSeed);
  int times = 0;
  int with_movers = 0;
  for (double time = 0.0; time <= kDuration; time += 0.5, ++times)
    for (const char* attribute : {"vehicle.moving", "cycle.with_rider", "pedestrian.moving"})
      if (countAttribute(scenario, time, attribute, inFront) > 0) {
        ++with_movers;
        break;
      }
  EXPECT_GT(with_movers, 0.9 * times);
}

INSTANTIATE_TEST_SUITE_P(Suite, EveryScenario, testing::ValuesIn(scenarioNames()),
                         [](const auto& instance) { return instance.param; });

TEST(Scenario, TenInTheOrderOfTheSuite) {
  ASSERT_EQ(scenarioNames().size(), 10U);
  EXPECT_EQ(makeScenario("crossing", 2.0, 1).scene_name, "scene-0001");
  EXPECT_EQ(makeScenario("pedestrians", 2.0, 1).scene_name, "scene-0010");
}

TEST(Scenario, UnknownNamesAreAnsweredWithThoseThatExist) {
  test::expectRefusal([] { makeScenario("motorway", 5.0, 1); }, scenarioNames());
  EXPECT_THROW(makeScenario("crossing", 0.0, 1), std::invalid_argument);
}

TEST(Scenario, InTheCarParkNothingMovesButTheEgo) {
  const Scenario scenario = makeScenario("car_park", 20.0, kSeed);
  double travelled = 0.0;
  double turned = 0.0;
  for (double time = 0.0; time < 20.0; time += 0.1) {
    travelled += 0.1 * scenario.ego->velocity(time).norm();
    turned += 0.1 * scenario.ego->angularVelocity(time).z();
    for (const Actor& actor : scenario.world.actors) ASSERT_EQ(actor.trajectory->velocity(time).norm(), 0.0);
  }
  EXPECT_GT(travelled, 40.0);
  EXPECT_LT(travelled, 60.0);
  EXPECT_GT(turned, 1.4);
  EXPECT_GT(scenario.world.actors.size(), 80U);
  for (const Actor& actor : scenario.world.actors) EXPECT_EQ(attributeOf(actor, 1.0), "vehicle.parked");
}

TEST(Scenario, AtTheRedLightTheEgoStandsWhileTrafficCrosses) {
  const Scenario scenario = makeScenario("standing", 20.0, kSeed);
  int vehicles = 0;
  int people = 0;
  for (double time = 0.0; time <= 20.0; time += 1.0) {
    EXPECT_EQ(scenario.ego->velocity(time).norm(), 0.0);
    EXPECT_EQ(scenario.ego->angularVelocity(time).norm(), 0.0);
    vehicles += countAttribute(scenario, time, "vehicle.moving", inFront);
    people += countAttribute(scenario, time, "pedestrian.moving", inFront);
  }
  EXPECT_GT(vehicles, 21);
  EXPECT_GT(people, 40);
}

TEST(Scenario, TheEgoTurnsLeftBehindAVan) {
  const Scenario scenario = makeScenario("crossing", 20.0, kSeed);
  double turned = 0.0;
  for (double time = 0.0; time < 20.0; time += 0.01) turned += 0.01 * scenario.ego->angularVelocity(time).z();
  EXPECT_NEAR(turned, 1.5708, 0.02);
  EXPECT_GT(std::abs(scenario.ego->angularVelocity(4.5).z()), 0.15) << "within the first five seconds";
  EXPECT_GE(countAttribute(scenario, 0.5, "pedestrian.moving", inFront), 3);
  EXPECT_GE(countAttribute(scenario, 2.0, "vehicle.moving", inFront), 1);
}

TEST(Scenario, HeavyOncomingTraffic) {
  const Scenario scenario = makeScenario("oncoming", 20.0, kSeed);
  for (double time = 1.0; time <= 20.0; time += 2.0) {
    int oncoming = 0;
    for (const Actor& actor : scenario.world.actors) {
      const Eigen::Isometry3d T_ego_from_map = scenario.ego->at(time).T_map_from_body.inverse();
      const Vector3d place = T_ego_from_map * actor.trajectory->at(time).T_map_from_body.translation();
      const double speed = -(T_ego_from_map.linear() * actor.trajectory->velocity(time)).x();
      if (inFront(place) && speed > 9.9 && speed < 14.1) ++oncoming;
    }
    EXPECT_GE(oncoming, 2) << time;
  }
}

TEST(Scenario, StopsAndGoes) {
  const Scenario scenario = makeScenario("stop_and_go", 20.0, kSeed);
  EXPECT_GT(scenario.ego->at(0.0).speed, 4.0);
  EXPECT_EQ(scenario.ego->at(3.6).speed, 0.0);
  int stops = 0;
  for (double time = 0.0; time < 20.0; time += 0.1)
    if (scenario.ego->at(time).speed > 0.0 && scenario.ego->at(time + 0.1).speed == 0.0) ++stops;
  EXPECT_GE(stops, 2);
}

TEST(Scenario, TheBusOvertakesAndIsOvertaken) {
  const Scenario scenario = makeScenario("bus_overtaking", 25.0, kSeed);
  const auto busAhead = [&](double time) {
    double nearest = 1e9;
    for (const Actor& actor : scenario.world.actors) {
      if (actor.model->category.rfind("vehicle.bus", 0) != 0) continue;
      const Vector3d place = scenario.ego->at(time).T_map_from_body.inverse() *
                             actor.trajectory->at(time).T_map_from_body.translation();
      if (std::abs(place.x()) < std::abs(nearest)) nearest = place.x();
    }
    return nearest;
  };
  EXPECT_LT(busAhead(0.0), 5.0);
  EXPECT_GT(busAhead(5.0), 12.0);
  EXPECT_LT(busAhead(24.0), 0.0);
}

TEST(Scenario, CyclistsArePassed) {
  const Scenario scenario = makeScenario("cyclists", 20.0, kSeed);
  for (double time = 0.0; time <= 20.0; time += 2.0)
    EXPECT_GE(countAttribute(scenario, time, "cycle.with_rider", inFront), 2) << time;
}

TEST(Scenario, ManyPedestrians) {
  const Scenario scenario = makeScenario("pedestrians", 20.0, kSeed);
  for (double time = 0.0; time <= 20.0; time += 2.0)
    EXPECT_GE(countAttribute(scenario, time, "pedestrian.moving", near), 25) << time;
  EXPECT_EQ(scenario.ego->at(6.0).speed, 0.0);
  int crossing = 0;
  for (const Actor& actor : scenario.world.actors) {
    const Vector3d place = scenario.ego->at(6.0).T_map_from_body.inverse() *
                           actor.trajectory->at(6.0).T_map_from_body.translation();
    if (attributeOf(actor, 6.0) == "pedestrian.moving" && place.x() > 4.0 && place.x() < 12.0 &&
        std::abs(place.y() - 1.6) < 5.0)
      ++crossing;
  }
  EXPECT_GE(crossing, 3);
}

TEST(Scenario, TheNightHasLampsAboveTheStreet) {
  const Scenario scenario = makeScenario("night", 10.0, kSeed);
  EXPECT_TRUE(scenario.world.lighting.night);
  EXPECT_GT(scenario.world.lighting.lamps.size(), 20U);
  for (const Lamp& lamp : scenario.world.lighting.lamps) EXPECT_GT(lamp.position.z(), 5.0F);
}

}  // namespace
}  // namespace radar_dot::simulation
