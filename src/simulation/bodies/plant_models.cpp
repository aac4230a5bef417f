// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <vector>

#include "simulation/bodies/make_models.h"
#include "simulation/bodies/shapes.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector3f;

constexpr float kTwoPi = 6.28318530718F;
constexpr int kShades = 4;

Vector3f randomDirection(RandomStream& random) {
  const float z = uniform(random, -1.0F, 1.0F);
  const float turn = uniform(random, 0.0F, kTwoPi);
  const float across = std::sqrt(1.0F - z * z);
  return {across * std::cos(turn), across * std::sin(turn), z};
}

/// Leaves as quads with the normals of a round crown, which shade like foliage rather than confetti.
class Foliage {
 public:
  explicit Foliage(RandomStream& random) : random_(random) {
    const float autumn = uniform(random, 0.0F, 1.0F);
    for (int shade = 0; shade < kShades; ++shade) {
      const float light = uniform(random, 0.75F, 1.35F);
      mesh_.surfaces.push_back(plain(Material::kFoliage, light * (0.045F + 0.04F * autumn), light * 0.11F,
                                     light * uniform(random, 0.02F, 0.035F)));
    }
  }

  /// Fills the shell of an ellipsoid.
  void clump(const Vector3f& centre, const Vector3f& radii, const Vector3f& crown_centre, int leaves,
             float leaf_size) {
    for (int leaf = 0; leaf < leaves; ++leaf) {
      const Vector3f direction = randomDirection(random_);
      const float depth = std::cbrt(uniform(random_, 0.05F, 1.0F)) * uniform(random_, 0.9F, 1.12F);
      const Vector3f place = centre + depth * radii.cwiseProduct(direction);
      const Vector3f outward =
          (0.6F * direction + 0.6F * (place - crown_centre).normalized() + Vector3f(0, 0, 0.25F))
              .normalized();
      const Vector3f facing = (outward + 0.9F * randomDirection(random_)).normalized();
      addLeaf(place, facing, outward, leaf_size * uniform(random_, 0.7F, 1.3F));
    }
  }
  const Mesh& mesh() const { return mesh_; }

 private:
  void addLeaf(const Vector3f& place, const Vector3f& facing, const Vector3f& outward, float size) {
    const Eigen::Isometry3f pose = poseAlong(place, facing);
    const float turn = uniform(random_, 0.0F, kTwoPi);
    const Vector3f along = pose.linear() * Vector3f(std::cos(turn), std::sin(turn), 0.0F) * size;
    const Vector3f across = facing.cross(along) * 0.75F;
    const auto first = static_cast<std::uint32_t>(mesh_.positions.size());
    Vector3f normal = (0.45F * facing + outward).normalized();
    if (normal.dot(facing) < 0.1F) normal = facing;
    for (const Vector3f& corner : {Vector3f(place + along), Vector3f(place - 0.6F * along + across),
                                   Vector3f(place - 0.6F * along - across)}) {
      mesh_.positions.push_back(corner);
      mesh_.normals.push_back(normal);
    }
    mesh_.triangles.push_back(
        {{first, first + 1, first + 2}, static_cast<std::uint32_t>(random_.index(kShades))});
  }

  RandomStream& random_;
  Mesh mesh_;
};

/// A slightly crooked trunk or branch as one smooth tube; returns its end.
Vector3f addBranch(MeshBuilder& builder, RandomStream& random, const Vector3f& from, const Vector3f& to,
                   float from_radius, float to_radius, int pieces, int sides) {
  const Eigen::Isometry3f across = poseAlong(Vector3f::Zero(), to - from);
  const float bend = 0.035F * (to - from).norm();
  std::vector<Vector3f> points;
  for (int piece = 0; piece <= pieces; ++piece) {
    const float share = static_cast<float>(piece) / static_cast<float>(pieces);
    Vector3f centre = from + share * (to - from);
    if (piece > 0 && piece < pieces)
      centre += across * Vector3f(bend * uniform(random, -1, 1), bend * uniform(random, -1, 1), 0.0F);
    const float radius = from_radius + share * (to_radius - from_radius);
    for (int side = 0; side < sides; ++side) {
      const float turn = kTwoPi * static_cast<float>(side) / static_cast<float>(sides);
      points.emplace_back(centre + radius * (across * Vector3f(std::cos(turn), std::sin(turn), 0.0F)));
    }
  }
  builder.sheet(points, sides);
  return to;
}

}  // namespace

std::shared_ptr<const Mesh> makeTree(RandomStream& random) {
  const float height = uniform(random, 5.5F, 9.0F);
  const float crown_low = height * uniform(random, 0.28F, 0.38F);
  const float spread = height * uniform(random, 0.24F, 0.34F);
  const Vector3f crown_centre(0, 0, 0.5F * (crown_low + height));
  const float half_crown = 0.5F * (height - crown_low);
  MeshBuilder builder;
  const float bark = uniform(random, 0.8F, 1.2F);
  builder.use(plain(Material::kBark, 0.11F * bark, 0.085F * bark, 0.065F * bark));
  const float girth = 0.016F * height + 0.03F;
  builder.cone(Vector3f::Zero(), {0, 0, 0.3F}, 1.45F * girth, girth, 10, false);
  const Vector3f fork =
      addBranch(builder, random, Vector3f(0, 0, 0.3F),
                Vector3f(uniform(random, -0.2F, 0.2F), uniform(random, -0.2F, 0.2F), crown_low), girth,
                0.75F * girth, 5, 10);
  addBranch(builder, random, fork, crown_centre + Vector3f(0, 0, 0.6F * half_crown), 0.7F * girth, 0.02F, 4,
            8);
  Foliage foliage(random);
  const int clumps = 11 + random.index(5);
  for (int clump = 0; clump < clumps; ++clump) {
    const float turn = 2.39996F * static_cast<float>(clump) + uniform(random, -0.4F, 0.4F);
    const float up = -0.8F + 1.7F * (static_cast<float>(clump) + 0.5F) / static_cast<float>(clumps);
    const float reach = spread * std::sqrt(std::max(0.05F, 1.0F - up * up)) * uniform(random, 0.6F, 0.85F);
    const Vector3f centre =
        crown_centre + Vector3f(reach * std::cos(turn), reach * std::sin(turn), 0.78F * half_crown * up);
    const float size = spread * uniform(random, 0.36F, 0.55F);
    foliage.clump(centre, Vector3f(size, size, 0.8F * size), crown_centre, 5250 / clumps,
                  0.07F + 0.008F * height);
    if (clump % 2 == 0) addBranch(builder, random, fork, centre, 0.42F * girth, 0.015F, 3, 6);
  }
  builder.add(foliage.mesh());
  return share(std::move(builder));
}

std::shared_ptr<const Mesh> makeBush(RandomStream& random) {
  const float size = uniform(random, 0.45F, 0.8F);
  const Vector3f middle(0, 0, 0.8F * size);
  MeshBuilder builder;
  builder.use(plain(Material::kBark, 0.08F, 0.06F, 0.045F));
  Foliage foliage(random);
  for (int clump = 0; clump < 5; ++clump) {
    const float turn = kTwoPi * static_cast<float>(clump) / 5.0F + uniform(random, -0.3F, 0.3F);
    const float up = uniform(random, 0.65F, 1.1F) * size;
    const Vector3f centre(0.5F * size * std::cos(turn), 0.5F * size * std::sin(turn), up);
    builder.cone({0.05F * std::cos(turn), 0.05F * std::sin(turn), 0}, centre, 0.02F, 0.01F, 5);
    foliage.clump(centre, Vector3f(0.6F, 0.6F, 0.55F) * size, middle, 260, 0.06F);
  }
  builder.add(foliage.mesh());
  return share(std::move(builder));
}

}  // namespace radar_dot::simulation
