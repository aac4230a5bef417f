// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/simulation/mesh.h"

#include <cmath>
#include <stdexcept>
#include <utility>

#include "simulation/frames.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector3f;

constexpr float kTwoPi = 6.28318530718F;

std::uint32_t count(const std::vector<Vector3f>& positions) {
  return static_cast<std::uint32_t>(positions.size());
}

}  // namespace

std::uint32_t MeshBuilder::use(const Surface& surface) {
  mesh_.surfaces.push_back(surface);
  surface_ = static_cast<std::uint32_t>(mesh_.surfaces.size() - 1);
  return surface_;
}

void MeshBuilder::triangle(const Vector3f& a, const Vector3f& b, const Vector3f& c) {
  const std::uint32_t first = count(mesh_.positions);
  const Vector3f normal = (b - a).cross(c - a).normalized();
  for (const Vector3f& corner : {a, b, c}) {
    mesh_.positions.push_back(corner);
    mesh_.normals.push_back(normal);
  }
  mesh_.triangles.push_back({{first, first + 1, first + 2}, surface_});
}

void MeshBuilder::quad(const Vector3f& a, const Vector3f& b, const Vector3f& c, const Vector3f& d) {
  const std::uint32_t first = count(mesh_.positions);
  const Vector3f normal = (c - a).cross(d - b).normalized();
  for (const Vector3f& corner : {a, b, c, d}) {
    mesh_.positions.push_back(corner);
    mesh_.normals.push_back(normal);
  }
  mesh_.triangles.push_back({{first, first + 1, first + 2}, surface_});
  mesh_.triangles.push_back({{first, first + 2, first + 3}, surface_});
}

void MeshBuilder::box(const Vector3f& low, const Vector3f& high) {
  Eigen::Isometry3f T_mesh_from_box = Eigen::Isometry3f::Identity();
  T_mesh_from_box.translation() = 0.5F * (low + high);
  box(T_mesh_from_box, high - low);
}

void MeshBuilder::box(const Eigen::Isometry3f& T_mesh_from_box, const Vector3f& size) {
  const Vector3f half = 0.5F * size;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0F, 1.0F}) {
      const int u = (axis + 1) % 3;
      const int v = (axis + 2) % 3;
      const auto corner = [&](float along_u, float along_v) {
        Vector3f point;
        point[axis] = side * half[axis];
        point[u] = along_u * half[u];
        point[v] = along_v * half[v];
        return Vector3f(T_mesh_from_box * point);
      };
      if (side > 0.0F)
        quad(corner(-1, -1), corner(1, -1), corner(1, 1), corner(-1, 1));
      else
        quad(corner(-1, -1), corner(-1, 1), corner(1, 1), corner(1, -1));
    }
  }
}

void MeshBuilder::cone(const Vector3f& from, const Vector3f& to, float from_radius, float to_radius,
                       int sides, bool caps) {
  const Vector3f axis = (to - from).normalized();
  const auto [first, second] = acrossOf(axis);
  const auto rim = [&, u = first, v = second](int side) {
    const float angle = kTwoPi * static_cast<float>(side) / static_cast<float>(sides);
    return Vector3f(std::cos(angle) * u + std::sin(angle) * v);
  };
  std::vector<Vector3f> points;
  for (int side = 0; side < sides; ++side) points.emplace_back(from + from_radius * rim(side));
  for (int side = 0; side < sides; ++side) points.emplace_back(to + to_radius * rim(side));
  sheet(points, sides);
  if (!caps) return;
  for (int side = 0; side < sides; ++side) {
    if (from_radius > 0.0F)
      triangle(from, from + from_radius * rim(side + 1), from + from_radius * rim(side));
    if (to_radius > 0.0F) triangle(to, to + to_radius * rim(side), to + to_radius * rim(side + 1));
  }
}

void MeshBuilder::capsule(const Vector3f& from, const Vector3f& to, float from_radius, float to_radius,
                          int sides) {
  constexpr int kRings = 4;  // of each half sphere
  const Vector3f axis = (to - from).normalized();
  const auto [first, second] = acrossOf(axis);
  std::vector<Vector3f> points;
  const auto ring = [&, u = first, v = second](const Vector3f& centre, float radius, float latitude) {
    for (int side = 0; side < sides; ++side) {
      const float angle = kTwoPi * static_cast<float>(side) / static_cast<float>(sides);
      points.emplace_back(centre +
                          radius * (std::cos(latitude) * (std::cos(angle) * u + std::sin(angle) * v) +
                                    std::sin(latitude) * axis));
    }
  };
  for (int i = 0; i < kRings; ++i)
    ring(from, from_radius, 0.25F * kTwoPi * (static_cast<float>(i) / (kRings - 1) - 0.999F));
  for (int i = 0; i < kRings; ++i)
    ring(to, to_radius, 0.25F * kTwoPi * 0.999F * static_cast<float>(i) / (kRings - 1));
  sheet(points, sides);
}

void MeshBuilder::ellipsoid(const Vector3f& centre, const Vector3f& radii, int sides, int rings) {
  std::vector<Vector3f> points;
  for (int ring = 0; ring <= rings; ++ring) {
    const float latitude = 0.4995F * kTwoPi * (static_cast<float>(ring) / static_cast<float>(rings) - 0.5F);
    for (int side = 0; side < sides; ++side) {
      const float angle = kTwoPi * static_cast<float>(side) / static_cast<float>(sides);
      points.emplace_back(
          centre + radii.cwiseProduct(Vector3f(std::cos(latitude) * std::cos(angle),
                                               std::cos(latitude) * std::sin(angle), std::sin(latitude))));
    }
  }
  sheet(points, sides);
}

void MeshBuilder::torus(const Vector3f& centre, const Vector3f& axis, float radius, float tube_radius,
                        int sides, int tube_sides) {
  const Vector3f unit = axis.normalized();
  const auto [first, second] = acrossOf(unit);
  std::vector<Vector3f> points;
  for (int side = 0; side <= sides; ++side) {
    const float angle = kTwoPi * static_cast<float>(side % sides) / static_cast<float>(sides);
    const Vector3f outward = std::cos(angle) * first + std::sin(angle) * second;
    for (int tube = 0; tube < tube_sides; ++tube) {
      const float turn = -kTwoPi * static_cast<float>(tube) / static_cast<float>(tube_sides);
      points.emplace_back(centre + radius * outward +
                          tube_radius * (std::cos(turn) * outward + std::sin(turn) * unit));
    }
  }
  sheet(points, tube_sides);
}

void MeshBuilder::add(const Mesh& mesh, const Eigen::Isometry3f& T_this_from_mesh) {
  const std::uint32_t first = count(mesh_.positions);
  const auto first_surface = static_cast<std::uint32_t>(mesh_.surfaces.size());
  for (const Vector3f& position : mesh.positions) mesh_.positions.push_back(T_this_from_mesh * position);
  for (const Vector3f& normal : mesh.normals) mesh_.normals.emplace_back(T_this_from_mesh.linear() * normal);
  for (Mesh::Triangle triangle : mesh.triangles) {
    for (std::uint32_t& corner : triangle.corners) corner += first;
    triangle.surface += first_surface;
    mesh_.triangles.push_back(triangle);
  }
  mesh_.surfaces.insert(mesh_.surfaces.end(), mesh.surfaces.begin(), mesh.surfaces.end());
}

void MeshBuilder::sheet(const std::vector<Vector3f>& points, int columns, bool closed_columns) {
  grid(
      points, static_cast<int>(points.size()) / columns, columns, [&](int, int) { return surface_; },
      closed_columns);
}

Mesh MeshBuilder::build() && { return std::move(mesh_); }

void MeshBuilder::addGrid(const std::vector<Vector3f>& points, int rows, int columns,
                          const std::vector<std::uint32_t>& surfaces, bool closed_columns) {
  if (points.size() != static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns))
    throw std::invalid_argument("MeshBuilder::grid: points must be rows x columns");
  const std::uint32_t first = count(mesh_.positions);
  const int cells = closed_columns ? columns : columns - 1;
  const auto number = [&](int row, int column) {
    return static_cast<std::uint32_t>(row * columns + column % columns);
  };
  std::vector<Vector3f> normals(points.size(), Vector3f::Zero());
  std::size_t cell = 0;
  for (int row = 0; row + 1 < rows; ++row) {
    for (int column = 0; column < cells; ++column, ++cell) {
      const std::array<std::uint32_t, 4> corners = {number(row, column), number(row, column + 1),
                                                    number(row + 1, column + 1), number(row + 1, column)};
      const Vector3f normal =
          (points[corners[2]] - points[corners[0]]).cross(points[corners[3]] - points[corners[1]]);
      for (const std::uint32_t corner : corners) normals[corner] += normal;
      for (const auto& [a, b, c] : {std::array<int, 3>{0, 1, 2}, std::array<int, 3>{0, 2, 3}}) {
        const auto corner = [&](int i) { return corners[static_cast<std::size_t>(i)]; };
        const Vector3f& origin = points[corner(a)];
        if ((points[corner(b)] - origin).cross(points[corner(c)] - origin).squaredNorm() < 1e-20F) continue;
        mesh_.triangles.push_back(
            {{first + corner(a), first + corner(b), first + corner(c)}, surfaces[cell]});
      }
    }
  }
  mesh_.positions.insert(mesh_.positions.end(), points.begin(), points.end());
  for (const Vector3f& normal : normals)
    mesh_.normals.push_back(normal.squaredNorm() > 0.0F ? Vector3f(normal.normalized()) : Vector3f::UnitZ());
}

}  // namespace radar_dot::simulation
