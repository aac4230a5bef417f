// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensors/radar_sensor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "radar_dot/common/quantile.h"

namespace radar_dot::simulation {
namespace {

constexpr double kSpeed = 8.0;    // m/s
constexpr double kYawRate = 0.2;  // rad/s
constexpr double kRingRadius = 30.0;

/// Round a circle at constant speed, through the origin at time 0 in the direction of x.
class Circling final : public Trajectory {
 public:
  BodyState at(double time_s) const override {
    const double angle = kYawRate * time_s;
    const double radius = kSpeed / kYawRate;
    BodyState state;
    state.T_map_from_body.translation() << radius * std::sin(angle), radius * (1.0 - std::cos(angle)), 0.0;
    state.T_map_from_body.linear() = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return state;
  }
};

/// Along x at constant speed.
class Straight final : public Trajectory {
 public:
  Straight(const Eigen::Vector3d& start, double speed) : start_(start), speed_(speed) {}
  BodyState at(double time_s) const override {
    BodyState state;
    state.T_map_from_body.translation() = start_ + Eigen::Vector3d(speed_ * time_s, 0.0, 0.0);
    return state;
  }

 private:
  Eigen::Vector3d start_;
  double speed_;
};

std::shared_ptr<const Mesh> boxMesh(Material material, const Eigen::Vector3f& size) {
  MeshBuilder builder;
  Surface surface;
  surface.material = material;
  builder.use(surface);
  builder.box(Eigen::Vector3f(-size.x() / 2, -size.y() / 2, 0.0F),
              Eigen::Vector3f(size.x() / 2, size.y() / 2, size.z()));
  return std::make_shared<Mesh>(std::move(builder).build());
}

void addBox(World& world, Material material, const Eigen::Vector3d& centre, const Eigen::Vector3f& size,
            double yaw = 0.0) {
  StaticObject object;
  object.mesh = boxMesh(material, size);
  object.T_map_from_object.translation() = centre;
  object.T_map_from_object.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  world.statics.push_back(object);
}

void addCar(World& world, const Eigen::Vector3d& position, double speed) {
  auto model = std::make_shared<Model>();
  model->category = "vehicle.car";
  Part body;
  body.mesh = boxMesh(Material::kCarPaint, Eigen::Vector3f(4.4F, 1.8F, 1.5F));
  model->parts.push_back(body);
  Actor actor;
  actor.model = model;
  actor.trajectory = std::make_shared<Straight>(position, speed);
  world.actors.push_back(actor);
}

/// Metal boxes all around the origin.
World ringWorld() {
  World world;
  constexpr int kBoxes = 60;
  for (int i = 0; i < kBoxes; ++i) {
    const double angle = 2.0 * M_PI * i / kBoxes;
    addBox(world, Material::kPaintedMetal,
           {kRingRadius * std::cos(angle), kRingRadius * std::sin(angle), 0.0},
           Eigen::Vector3f(0.4F, 3.2F, 4.0F), angle);
  }
  return world;
}

/// Without errors of position and in the plane, so that the reported bearing is the true one.
RadarModel exactModel() {
  RadarModel model;
  for (RadarScanModel* scan : {&model.wide, &model.narrow}) {
    scan->elevation_low = scan->elevation_high = 0.0;
    scan->range_deviation = scan->azimuth_deviation = 0.0;
  }
  model.position_step = 1e-4;
  return model;
}

std::vector<RadarReturn> scanOf(const World& world, const SensorMount& mount, const Trajectory& ego,
                                std::uint64_t stream = 0, const RadarModel& model = RadarModel(),
                                std::uint64_t seed = 1) {
  const RayGeometry geometry(world);
  const Snapshot snapshot(world, geometry, 0.0);
  return simulateRadarScan(snapshot, mount, ego, seed, stream, model);
}

double range(const RadarReturn& radar_return) { return std::hypot(radar_return.x, radar_return.y); }

double doppler(const RadarReturn& radar_return) {
  return (radar_return.x * radar_return.vx + radar_return.y * radar_return.vy) / range(radar_return);
}

/// d = -u (v + w x t), all in the base frame, of a car that circles.
double staticDoppler(const RadarReturn& radar_return, const SensorMount& mount) {
  const double x = static_cast<double>(radar_return.x);
  const double y = static_cast<double>(radar_return.y);
  const Eigen::Matrix3d turn = mount.T_base_from_sensor.linear();
  const double u_x = (turn(0, 0) * x + turn(0, 1) * y) / std::hypot(x, y);
  const double u_y = (turn(1, 0) * x + turn(1, 1) * y) / std::hypot(x, y);
  const Eigen::Vector3d lever = mount.T_base_from_sensor.translation();
  return -(u_x * (kSpeed - kYawRate * lever.y()) + u_y * kYawRate * lever.x());
}

int countOf(const std::vector<RadarReturn>& returns, std::int32_t object) {
  return static_cast<int>(std::count_if(returns.begin(), returns.end(),
                                        [&](const RadarReturn& r) { return r.object == object; }));
}

TEST(RadarSensor, StaticWallsMoveLikeTheProjectedEgoMotion) {
  const World world = ringWorld();
  const Circling ego;
  for (const SensorMount& mount : radarMounts()) {
    int checked = 0;
    for (const RadarReturn& r : scanOf(world, mount, ego, 0, exactModel())) {
      if (r.object < 0) continue;
      EXPECT_NEAR(static_cast<double>(r.true_range_rate), staticDoppler(r, mount), 2e-3) << mount.channel;
      ++checked;
    }
    EXPECT_GT(checked, 15) << mount.channel;
  }
}

TEST(RadarSensor, MeasuredDopplerScattersAsStated) {
  const World world = ringWorld();
  const Circling ego;
  std::vector<double> residuals;
  std::uint64_t stream = 0;
  for (const SensorMount& mount : radarMounts())
    for (int scan = 0; scan < 10; ++scan)
      for (const RadarReturn& r : scanOf(world, mount, ego, ++stream))
        if (r.object >= 0 && r.invalid_state == 0 && r.ambig_state == 3)
          residuals.push_back(std::abs(doppler(r) - staticDoppler(r, mount)));
  ASSERT_GT(residuals.size(), 500U);
  const double sigma = 1.4826 * quantileOf(residuals);
  EXPECT_GT(sigma, 0.08);
  EXPECT_LT(sigma, 0.20);
  EXPECT_LT(quantileOf(residuals, 0.95), 0.6);  // folded velocities lie in the rest
}

TEST(RadarSensor, ApproachingIsNegativeRecedingPositive) {
  for (const double speed : {-6.0, 6.0}) {
    World world;
    addCar(world, {20.0, 0.0, 0.0}, speed);
    const Standing ego{Eigen::Isometry3d::Identity()};
    int seen = 0;
    for (std::uint64_t stream = 0; stream < 5; ++stream)
      for (const RadarReturn& r : scanOf(world, radarMounts()[0], ego, stream)) {
        if (r.object != 0) continue;
        EXPECT_NEAR(static_cast<double>(r.true_range_rate), speed, 0.2);
        if (r.ambig_state == 3 && r.invalid_state == 0) {
          seen += std::abs(doppler(r) - speed) < 0.6;
        }
      }
    EXPECT_GT(seen, 2);
  }
}

TEST(RadarSensor, SeedDecidesEverything) {
  const World world = ringWorld();
  const Circling ego;
  const auto same = [](const std::vector<RadarReturn>& a, const std::vector<RadarReturn>& b) {
    return a.size() == b.size() &&
           std::equal(a.begin(), a.end(), b.begin(), [](const auto& p, const auto& q) {
             return p.x == q.x && p.y == q.y && p.rcs == q.rcs && p.vx == q.vx && p.vy == q.vy &&
                    p.vx_comp == q.vx_comp && p.vy_comp == q.vy_comp && p.dyn_prop == q.dyn_prop &&
                    p.id == q.id && p.ambig_state == q.ambig_state && p.invalid_state == q.invalid_state &&
                    p.pdh0 == q.pdh0 && p.x_rms == q.x_rms && p.y_rms == q.y_rms && p.vx_rms == q.vx_rms &&
                    p.vy_rms == q.vy_rms && p.object == q.object && p.true_range_rate == q.true_range_rate;
           });
  };
  const auto first = scanOf(world, radarMounts()[1], ego, 7);
  EXPECT_TRUE(same(first, scanOf(world, radarMounts()[1], ego, 7)));
  EXPECT_FALSE(same(first, scanOf(world, radarMounts()[1], ego, 8)));
  EXPECT_FALSE(same(first, scanOf(world, radarMounts()[1], ego, 7, RadarModel(), 2)));
}

TEST(RadarSensor, StaysWithinFieldOfViewAndListLength) {
  const World world = ringWorld();
  const Circling ego;
  const RadarModel model;
  for (const SensorMount& mount : radarMounts()) {
    const auto returns = scanOf(world, mount, ego);
    EXPECT_LE(returns.size(), 125U);
    for (const RadarReturn& r : returns) {
      const double azimuth = std::abs(std::atan2(r.y, r.x));
      EXPECT_LT(azimuth, 1.4);
      EXPECT_LE(range(r), model.narrow.max_range + 1.0);
      if (r.invalid_state == 0) {
        EXPECT_LE(azimuth, model.wide.valid_azimuth + 0.01);
      }
    }
  }
}

TEST(RadarSensor, WallHidesWhatIsBehindIt) {
  const Straight ego({0.0, 0.0, 0.0}, kSpeed);
  for (const bool wall : {false, true}) {
    World world;
    addCar(world, {28.0, 0.0, 0.0}, 0.0);
    if (wall) addBox(world, Material::kBrick, {18.0, 0.0, 0.0}, Eigen::Vector3f(0.5F, 60.0F, 8.0F));
    const auto car = static_cast<std::int32_t>(world.statics.size());  // actors come after the statics
    int seen = 0;
    for (std::uint64_t stream = 0; stream < 8; ++stream)
      seen += countOf(scanOf(world, radarMounts()[0], ego, stream), car);
    if (wall) {
      EXPECT_EQ(seen, 0);
    } else {
      EXPECT_GT(seen, 3);
    }
  }
}

TEST(RadarSensor, GhostsAreNoObjects) {
  const World world = ringWorld();
  const Standing ego{Eigen::Isometry3d::Identity()};
  int objects = 0, ghosts_behind = 0;
  for (std::uint64_t stream = 0; stream < 10; ++stream)
    for (const RadarReturn& r : scanOf(world, radarMounts()[0], ego, stream)) {
      const Eigen::Vector3d point = radarMounts()[0].T_base_from_sensor *
                                    Eigen::Vector3d(static_cast<double>(r.x), static_cast<double>(r.y), 0.0);
      const double off_the_ring = std::abs(point.head<2>().norm() - kRingRadius);
      if (r.object >= 0) {
        EXPECT_LT(off_the_ring, 1.5);
        EXPECT_LT(static_cast<std::size_t>(r.object), world.statics.size());
        ++objects;
      } else {
        ghosts_behind += off_the_ring > 3.0;
      }
    }
  EXPECT_GT(objects, 100);
  EXPECT_GT(ghosts_behind, 20);
}

TEST(RadarSensor, NothingToSeeGivesOnlyGhosts) {
  const World world;
  const Circling ego;
  for (const RadarReturn& r : scanOf(world, radarMounts()[0], ego)) EXPECT_EQ(r.object, -1);
  RadarModel silent;
  silent.detail_rate = silent.clutter_rate = 0.0;
  EXPECT_TRUE(scanOf(world, radarMounts()[0], ego, 0, silent).empty());
}

bool isMultiple(float value, double step) {
  const double steps = static_cast<double>(value) / step;
  return std::abs(steps - std::round(steps)) < 1e-3;
}

TEST(RadarSensor, FieldsAreThoseOfRealFiles) {
  const World world = ringWorld();
  const Circling ego;
  for (const SensorMount& mount : radarMounts()) {
    const auto returns = scanOf(world, mount, ego);
    int falls = 0;  // of the range: the narrow scan follows the wide one
    for (std::size_t i = 0; i < returns.size(); ++i) {
      const RadarReturn& r = returns[i];
      EXPECT_EQ(r.id, static_cast<std::int16_t>(i));
      EXPECT_TRUE(isMultiple(r.x, 0.2) && isMultiple(r.y - 0.1F, 0.2) && isMultiple(r.rcs, 0.5));
      EXPECT_TRUE(isMultiple(r.vx, 0.25) && isMultiple(r.vy, 0.25));
      EXPECT_EQ(r.z, 0.0F);
      EXPECT_GE(r.rcs, -5.0F);
      EXPECT_NEAR(r.x * r.vy_comp - r.y * r.vx_comp, 0.0F, 1e-3F * static_cast<float>(range(r)));
      if (r.dyn_prop == 4) {
        EXPECT_EQ(r.vx_rms, 0);
      }
      if (i > 0) falls += range(r) < range(returns[i - 1]) - 1.5;
    }
    EXPECT_LE(falls, 1) << mount.channel;
  }
}

TEST(RadarSensor, VelocityAcrossTheBearingComesFromTheCarsTurning) {
  const World world = ringWorld();
  const Circling ego;
  RadarModel model;
  model.yaw_rate_deviation = 0.0;
  int checked = 0;
  for (const RadarReturn& r : scanOf(world, radarMounts()[0], ego, 0, model)) {
    if (r.dyn_prop != 1 || r.ambig_state != 3) continue;
    // Half a step of vy.
    EXPECT_NEAR(static_cast<double>(r.vy), -kYawRate * (static_cast<double>(r.x) + 3.3), 0.1251);
    EXPECT_LT(r.vy, -0.5F);
    ++checked;
  }
  EXPECT_GT(checked, 10);
}

}  // namespace
}  // namespace radar_dot::simulation
