// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

namespace radar_dot::simulation {

/// Linear RGB, 0..1 for a reflectance, unbounded for a radiance.
using Color = Eigen::Array3f;

/// What a surface is made of: decides its texture, gloss and radar reflectivity.
enum class Material : std::uint8_t {
  kAsphalt,
  kLanePaint,
  kPavement,  ///< slabs
  kKerb,
  kConcrete,
  kBrick,
  kPlaster,
  kRoof,
  kWindowPane,  ///< of a building: reflects, shows a dark room or a curtain, may be lit at night
  kShopWindow,
  kWood,
  kFoliage,
  kBark,
  kGrass,
  kSoil,
  kCarPaint,
  kCarGlass,
  kPlastic,  ///< matt trim
  kTyre,
  kRim,
  kChrome,
  kHeadLamp,
  kTailLamp,
  kNumberPlate,
  kPaintedMetal,  ///< poles, rails, street furniture
  kSign,          ///< retro-reflecting face
  kStreetLamp,    ///< shines at night
  kSkin,
  kHair,
  kCloth,
  kLeather,
};
inline constexpr int kMaterials = static_cast<int>(Material::kLeather) + 1;

/// A material with its colour. An object may bring a palette of its own, so that one mesh serves
/// cars of every colour.
struct Surface {
  Material material = Material::kPlastic;
  Color color = Color::Constant(0.5F);  ///< reflectance
  int palette_slot = -1;                ///< >= 0: take the colour from the object's palette
};

inline constexpr int kPaletteSlots = 4;
using Palette = std::array<Color, kPaletteSlots>;
/// All slots grey.
inline Palette plainPalette() {
  Palette palette;
  palette.fill(Color::Constant(0.5F));
  return palette;
}

/// Triangles in a frame of their own, m.
struct Mesh {
  struct Triangle {
    std::array<std::uint32_t, 3> corners{};  ///< counter-clockwise seen from outside
    std::uint32_t surface = 0;
  };
  std::vector<Eigen::Vector3f> positions;
  std::vector<Eigen::Vector3f> normals;  ///< one per position, unit, for shading
  std::vector<Triangle> triangles;
  std::vector<Surface> surfaces;
};

/// Builds meshes out of simple solids. Everything is given in the mesh's own frame.
class MeshBuilder {
 public:
  /// Surface that the following shapes have. Returns its number.
  std::uint32_t use(const Surface& surface);

  /// Corners counter-clockwise seen from outside; flat normal.
  void triangle(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c);
  void quad(const Eigen::Vector3f& a, const Eigen::Vector3f& b, const Eigen::Vector3f& c,
            const Eigen::Vector3f& d);
  void box(const Eigen::Vector3f& low, const Eigen::Vector3f& high);
  /// A box in a pose of its own, centred there.
  void box(const Eigen::Isometry3f& T_mesh_from_box, const Eigen::Vector3f& size);
  /// Tapered cylinder from `from` to `to`, smooth; caps on demand.
  void cone(const Eigen::Vector3f& from, const Eigen::Vector3f& to, float from_radius, float to_radius,
            int sides = 12, bool caps = true);
  /// Tapered cylinder with half spheres at both ends: a limb.
  void capsule(const Eigen::Vector3f& from, const Eigen::Vector3f& to, float from_radius, float to_radius,
               int sides = 10);
  void ellipsoid(const Eigen::Vector3f& centre, const Eigen::Vector3f& radii, int sides = 14, int rings = 8);
  /// Ring around `axis`.
  void torus(const Eigen::Vector3f& centre, const Eigen::Vector3f& axis, float radius, float tube_radius,
             int sides = 24, int tube_sides = 8);
  /// Smooth sheet through a grid of points, rows x columns, row-major; `surface_of(row, column)` picks
  /// the surface of each cell by number. The outside is where (along a row) x (along a column) points.
  template <typename SurfaceOf>
  void grid(const std::vector<Eigen::Vector3f>& points, int rows, int columns, const SurfaceOf& surface_of,
            bool closed_columns = false) {
    std::vector<std::uint32_t> surfaces;
    for (int row = 0; row + 1 < rows; ++row)
      for (int column = 0; column < (closed_columns ? columns : columns - 1); ++column)
        surfaces.push_back(surface_of(row, column));
    addGrid(points, rows, columns, surfaces, closed_columns);
  }
  /// The same of one surface, the one in use. The number of rows is that of the points.
  void sheet(const std::vector<Eigen::Vector3f>& points, int columns, bool closed_columns = true);
  /// Everything of another mesh, moved.
  void add(const Mesh& mesh, const Eigen::Isometry3f& T_this_from_mesh = Eigen::Isometry3f::Identity());

  Mesh build() &&;
  const Mesh& mesh() const noexcept { return mesh_; }

 private:
  void addGrid(const std::vector<Eigen::Vector3f>& points, int rows, int columns,
               const std::vector<std::uint32_t>& surfaces, bool closed_columns);

  Mesh mesh_;
  std::uint32_t surface_ = 0;
};

}  // namespace radar_dot::simulation
