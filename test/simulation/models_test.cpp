// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "radar_dot/simulation/ray_tracing.h"
#include "simulation/bodies/make_models.h"
#include "simulation/bodies/shapes.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kSeeds = 40;
constexpr double kLongestCycle = 5.3;  // m: a turn of a bicycle's cranks; everything else repeats sooner
constexpr double kPi = 3.14159265358979;

struct ModelKind {
  std::string name;
  std::function<std::shared_ptr<const Model>(RandomStream&)> make;
  std::string category;
  std::size_t most_triangles;
};
std::ostream& operator<<(std::ostream& out, const ModelKind& kind) { return out << kind.name; }

struct MeshKind {
  std::string name;
  std::function<std::shared_ptr<const Mesh>(RandomStream&)> make;
  std::size_t most_triangles;
};
std::ostream& operator<<(std::ostream& out, const MeshKind& kind) { return out << kind.name; }

std::vector<ModelKind> modelKinds() {
  return {{"car", makeCar, "vehicle.car", 6000},
          {"van", makeVan, "vehicle.car", 6000},
          {"truck", makeTruck, "vehicle.truck", 6000},
          {"bus", makeBus, "vehicle.bus.rigid", 6000},
          {"pedestrian", makePedestrian, "human.pedestrian.adult", 3000},
          {"cyclist", makeCyclist, "vehicle.bicycle", 6000},
          {"parked_bicycle", makeParkedBicycle, "vehicle.bicycle", 3100}};
}

std::shared_ptr<const Mesh> house(RandomStream& random) {
  Facade facade;
  facade.width = random.uniform(8.0, 20.0);
  facade.storeys = 2 + random.index(5);
  facade.shop = random.chance(0.5);
  return makeBuilding(facade, random);
}

std::vector<MeshKind> meshKinds() {
  return {{"tree", makeTree, 6000},
          {"bush", makeBush, 2000},
          {"street_lamp", [](RandomStream&) { return makeStreetLamp(7.0, 1.5); }, 1000},
          {"traffic_light", [](RandomStream&) { return makeTrafficLight(); }, 1500},
          {"traffic_sign", makeTrafficSign, 1000},
          {"bollard", [](RandomStream&) { return makeBollard(); }, 1000},
          {"bin", [](RandomStream&) { return makeBin(); }, 1000},
          {"bench", [](RandomStream&) { return makeBench(); }, 1000},
          {"railing", [](RandomStream&) { return makeRailing(6.0); }, 2000},
          {"building", house, 15000}};
}

std::vector<std::shared_ptr<const Mesh>> meshesOf(const Model& model) {
  std::vector<std::shared_ptr<const Mesh>> meshes;
  for (const Part& part : model.parts) meshes.push_back(part.mesh);
  return meshes;
}

Vector3f windingNormal(const Mesh& mesh, const Mesh::Triangle& triangle) {
  const Vector3f& a = mesh.positions[triangle.corners[0]];
  return (mesh.positions[triangle.corners[1]] - a).cross(mesh.positions[triangle.corners[2]] - a);
}

/// Normals are unit, and on the outside of the triangles they belong to.
void expectSoundMesh(const Mesh& mesh) {
  ASSERT_EQ(mesh.positions.size(), mesh.normals.size());
  for (const Vector3f& normal : mesh.normals) ASSERT_NEAR(normal.norm(), 1.0F, 1e-4F);
  std::size_t agreeing = 0;
  for (const Mesh::Triangle& triangle : mesh.triangles) {
    ASSERT_LT(triangle.surface, mesh.surfaces.size());
    Vector3f sum = Vector3f::Zero();
    for (const std::uint32_t corner : triangle.corners) {
      ASSERT_LT(corner, mesh.positions.size());
      sum += mesh.normals[corner];
    }
    if (sum.dot(windingNormal(mesh, triangle)) > 0.0F) ++agreeing;
  }
  EXPECT_GE(static_cast<double>(agreeing), 0.99 * static_cast<double>(mesh.triangles.size()));
}

/// Share of rays from all around, above the ground, that first meet a triangle from its outside.
double outsideShare(const World& world, const Eigen::AlignedBox3f& box, RandomStream& random) {
  constexpr int kRays = 4000;
  const RayGeometry geometry(world);
  const Snapshot snapshot(world, geometry, 0.0);
  int hits = 0, outside = 0;
  for (int ray = 0; ray < kRays; ++ray) {
    const double turn = random.uniform(0.0, 2.0 * kPi);
    const double rise = random.uniform(0.02, 1.2);
    const Vector3f direction =
        -Vector3d(std::cos(rise) * std::cos(turn), std::cos(rise) * std::sin(turn), std::sin(rise))
             .cast<float>();
    Vector3f target;
    for (int axis = 0; axis < 3; ++axis)
      target[axis] = static_cast<float>(
          random.uniform(static_cast<double>(box.min()[axis]), static_cast<double>(box.max()[axis])));
    const Hit hit = snapshot.trace(target - 60.0F * direction, direction);
    if (!hit) continue;
    const PlacedObject& object = snapshot.objects()[hit.object];
    if (snapshot.surfaceOf(hit).material == Material::kFoliage) continue;  // sheets, seen from both sides
    const Vector3f normal = object.T_map_from_object.linear().cast<float>() *
                            windingNormal(*object.mesh, object.mesh->triangles[hit.triangle]);
    ++hits;
    if (normal.dot(direction) < 0.0F) ++outside;
  }
  return hits > 0 ? static_cast<double>(outside) / hits : 1.0;
}

class Models : public testing::TestWithParam<ModelKind> {};
class StreetMeshes : public testing::TestWithParam<MeshKind> {};

TEST_P(Models, stayInsideTheirBoxAndOnTheGroundOverAWholeCycle) {
  constexpr double kTolerance = 0.12;  // m: mirrors
  constexpr double kGround = 0.03;     // m
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    RandomStream random(seed);
    const auto model = GetParam().make(random);
    EXPECT_EQ(model->category, GetParam().category);
    Eigen::AlignedBox3d cycle;
    for (double distance = 0.0; distance < kLongestCycle; distance += 0.1) {
      const Eigen::AlignedBox3d box = boundsOf(*model, distance);
      EXPECT_NEAR(box.min().z(), 0.0, kGround) << "seed " << seed << " distance " << distance;
      cycle.extend(box);
    }
    for (int axis = 0; axis < 2; ++axis) {
      EXPECT_LE(cycle.max()[axis], 0.5 * model->size[axis] + kTolerance) << "seed " << seed;
      EXPECT_GE(cycle.min()[axis], -0.5 * model->size[axis] - kTolerance) << "seed " << seed;
      EXPECT_GE(cycle.sizes()[axis], model->size[axis] - kTolerance) << "seed " << seed;
    }
    EXPECT_NEAR(cycle.max().z(), model->size.z(), 0.05) << "seed " << seed;
  }
}

TEST_P(Models, haveSoundMeshesWithinTheirBudget) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    RandomStream random(seed);
    const auto model = GetParam().make(random);
    std::size_t triangles = 0;
    for (const auto& mesh : meshesOf(*model)) {
      expectSoundMesh(*mesh);
      triangles += mesh->triangles.size();
    }
    EXPECT_LE(triangles, GetParam().most_triangles) << "seed " << seed;
  }
}

TEST_P(Models, areSeenFromOutside) {
  RandomStream random(3);
  World world;
  Actor actor;
  actor.model = GetParam().make(random);
  actor.trajectory = std::make_shared<Standing>(Eigen::Isometry3d::Identity());
  world.actors.push_back(actor);
  EXPECT_GE(outsideShare(world, boundsOf(*actor.model, 0.0).cast<float>(), random), 0.98);
}

TEST_P(Models, areTheSameForTheSameStream) {
  RandomStream first(5), second(5);
  const auto one = GetParam().make(first);
  const auto other = GetParam().make(second);
  EXPECT_EQ(first.bits(), second.bits());
  ASSERT_EQ(one->parts.size(), other->parts.size());
  for (std::size_t part = 0; part < one->parts.size(); ++part)
    EXPECT_EQ(one->parts[part].mesh->positions, other->parts[part].mesh->positions);
  const Palette palette = randomPalette(*one, first);
  const Palette same = randomPalette(*other, second);
  for (std::size_t slot = 0; slot < palette.size(); ++slot) {
    EXPECT_TRUE((palette[slot] == same[slot]).all());
    EXPECT_TRUE((palette[slot] > 0.0F).all() && (palette[slot] <= 0.9F).all());
  }
}

TEST_P(Models, rollWithoutSlipping) {
  constexpr double kStep = 1e-5;  // m
  RandomStream random(2);
  const auto model = GetParam().make(random);
  const auto posesAt = [&](double distance) {
    BodyState state;
    state.distance = distance;
    return model->T_body_from_parts(state);
  };
  int wheels = 0;
  double rear_most = 0.0;
  for (std::size_t part = 0; part < model->parts.size(); ++part) {
    const JointKind joint = model->parts[part].joint;
    if (joint != JointKind::kWheel && joint != JointKind::kSteeredWheel) continue;
    ++wheels;
    for (const double distance : {0.0, 0.7, 13.0}) {
      const Eigen::Isometry3d T_body_from_wheel = posesAt(distance)[part];
      const Vector3d axle = T_body_from_wheel.translation();
      rear_most = std::min(rear_most, axle.x());
      const auto velocityAt = [&](const Vector3d& point) {  // per metre of the body's way, over ground
        const Vector3d in_wheel = T_body_from_wheel.inverse() * point;
        return Vector3d(
            (posesAt(distance + kStep)[part] * in_wheel - posesAt(distance - kStep)[part] * in_wheel) /
                (2.0 * kStep) +
            Vector3d::UnitX());
      };
      EXPECT_LT(velocityAt(Vector3d(axle.x(), axle.y(), 0.0)).norm(), 1e-6);
      EXPECT_LT((velocityAt(Vector3d(axle.x(), axle.y(), 2.0 * axle.z())) - Vector3d(2, 0, 0)).norm(), 1e-6);
    }
  }
  if (GetParam().category.rfind("human", 0) == 0) return;
  EXPECT_GE(wheels, 2);
  EXPECT_NEAR(model->rear_axle_x, rear_most, 1e-6);
}

INSTANTIATE_TEST_SUITE_P(All, Models, testing::ValuesIn(modelKinds()),
                         [](const auto& kind) { return kind.param.name; });

TEST_P(StreetMeshes, areSoundStandOnTheGroundAndStayWithinTheirBudget) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    RandomStream random(seed);
    const auto mesh = GetParam().make(random);
    expectSoundMesh(*mesh);
    EXPECT_LE(mesh->triangles.size(), GetParam().most_triangles);
    float lowest = 1e9F;
    for (const Vector3f& position : mesh->positions) lowest = std::min(lowest, position.z());
    EXPECT_NEAR(lowest, 0.0F, 0.03F) << "seed " << seed;
  }
}

TEST_P(StreetMeshes, areSeenFromOutside) {
  for (std::uint64_t seed = 0; seed < 3; ++seed) {
    RandomStream random(seed);
    World world;
    world.statics.push_back({GetParam().make(random), Eigen::Isometry3d::Identity(), {}});
    Eigen::AlignedBox3f box;
    for (const Vector3f& position : world.statics.front().mesh->positions) box.extend(position);
    EXPECT_GE(outsideShare(world, box, random), 0.985) << "seed " << seed;
  }
}

TEST_P(StreetMeshes, areTheSameForTheSameStream) {
  RandomStream first(5), second(5);
  EXPECT_EQ(GetParam().make(first)->positions, GetParam().make(second)->positions);
}

INSTANTIATE_TEST_SUITE_P(All, StreetMeshes, testing::ValuesIn(meshKinds()),
                         [](const auto& kind) { return kind.param.name; });

/// Turn of a part about the y axis of its parent, rad, positive backwards for a limb that hangs.
double turnInParent(const Model& model, std::size_t part, double distance) {
  BodyState state;
  state.distance = distance;
  const auto poses = model.T_body_from_parts(state);
  const Part& limb = model.parts[part];
  const Eigen::Matrix3d turn =
      (poses[static_cast<std::size_t>(limb.parent)] * limb.T_parent_from_joint).linear().transpose() *
      poses[part].linear();
  return std::atan2(turn(0, 2), turn(2, 2));
}

TEST(Pedestrian, swingsLeftAndRightLimbsInAntiphase) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    RandomStream random(seed);
    const auto model = makePedestrian(random);
    // Legs hang lower than arms; left has positive y.
    std::vector<std::size_t> legs, arms;
    for (std::size_t part = 1; part < model->parts.size(); ++part) {
      const Part& limb = model->parts[part];
      if (limb.parent != 0) continue;
      (limb.T_parent_from_joint.translation().z() < 0.6 * model->size.z() ? legs : arms).push_back(part);
    }
    ASSERT_EQ(legs.size(), 2U);
    ASSERT_EQ(arms.size(), 2U);
    for (const auto& pair : {legs, arms})
      EXPECT_LT(model->parts[pair[0]].T_parent_from_joint.translation().y() *
                    model->parts[pair[1]].T_parent_from_joint.translation().y(),
                0.0);
    const double stride = model->parts[legs[0]].stride;
    for (double share = 0.05; share < 1.0; share += 0.1) {
      const double distance = share * stride;
      const double left_leg = turnInParent(*model, legs[0], distance);
      EXPECT_NEAR(left_leg, -turnInParent(*model, legs[1], distance), 1e-9);
      EXPECT_NEAR(left_leg, turnInParent(*model, legs[1], distance + 0.5 * stride), 1e-9);
      EXPECT_LT(left_leg * turnInParent(*model, arms[0], distance), 0.0) << "an arm goes against its leg";
    }
    EXPECT_NEAR(turnInParent(*model, legs[0], 0.0), 0.0, 1e-9) << "stands at distance 0";
  }
}

TEST(Cyclist, keepsTheFeetOnThePedals) {
  for (std::uint64_t seed = 0; seed < kSeeds; ++seed) {
    RandomStream random(seed);
    const auto model = makeCyclist(random);
    std::size_t crank = 0;
    std::vector<std::size_t> feet;
    for (std::size_t part = 0; part < model->parts.size(); ++part) {
      if (model->parts[part].joint == JointKind::kCrank) crank = part;
      const int parent = model->parts[part].parent;
      if (parent > 0 && model->parts[static_cast<std::size_t>(parent)].parent > 0) feet.push_back(part);
    }
    ASSERT_EQ(feet.size(), 2U);
    for (double distance = 0.0; distance < kLongestCycle; distance += 0.1) {
      BodyState state;
      state.distance = distance;
      const auto poses = model->T_body_from_parts(state);
      for (std::size_t i = 0; i < 2; ++i) {
        const double side = poses[feet[i]].translation().y() > 0.0 ? 1.0 : -1.0;
        const Vector3d pedal = poses[crank] * Vector3d(0.0, side * 0.13, -side * 0.17);
        double nearest = 1e9;
        for (const Vector3f& position : model->parts[feet[i]].mesh->positions) {
          const Vector3d apart = poses[feet[i]] * position.cast<double>() - pedal;
          nearest = std::min(nearest, std::hypot(apart.x(), apart.z()));
        }
        EXPECT_LT(nearest, 0.08) << "seed " << seed << " distance " << distance;
      }
    }
  }
}

TEST(StreetLamp, hangsItsHeadWhereItWasAsked) {
  const auto mesh = makeStreetLamp(6.5, 1.8);
  Vector3f sum = Vector3f::Zero();
  float count = 0.0F;
  for (const Mesh::Triangle& triangle : mesh->triangles)
    if (mesh->surfaces[triangle.surface].material == Material::kStreetLamp)
      for (const std::uint32_t corner : triangle.corners) {
        sum += mesh->positions[corner];
        count += 1.0F;
      }
  ASSERT_GT(count, 0.0F);
  EXPECT_LT((sum / count - Vector3f(1.8F, 0.0F, 6.5F)).norm(), 0.05F);
}

TEST(Building, fillsItsPlotAndHasWindowsOnTheStreet) {
  RandomStream random(4);
  Facade facade;
  facade.width = 16.0;
  facade.depth = 9.0;
  facade.storeys = 5;
  const auto mesh = makeBuilding(facade, random);
  Eigen::AlignedBox3f box;
  int panes = 0;
  for (const Vector3f& position : mesh->positions) box.extend(position);
  for (const Mesh::Triangle& triangle : mesh->triangles) {
    if (mesh->surfaces[triangle.surface].material != Material::kWindowPane) continue;
    const Vector3f normal = windingNormal(*mesh, triangle).normalized();
    if (normal.y() < 0.99F) continue;
    ++panes;
    EXPECT_LT(mesh->positions[triangle.corners[0]].y(), -0.09F) << "set back into the wall";
  }
  EXPECT_NEAR(box.min().x(), 0.0F, 0.1F);
  EXPECT_NEAR(box.max().x(), 16.0F, 0.1F);
  EXPECT_NEAR(box.min().y(), -9.0F, 0.5F);
  EXPECT_LT(box.max().y(), 1.3F);
  EXPECT_GT(box.max().z(), 15.0F);
  EXPECT_GE(panes, 2 * 5 * 4);
}

}  // namespace
}  // namespace radar_dot::simulation
