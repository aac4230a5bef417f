// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>

#include "radar_dot/simulation/camera_sensor.h"
#include "simulation/frames.h"
#include "simulation/rendering/shader.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector3f;

constexpr float kOcclusionReach = 3.0F;  // m
constexpr int kBlock = 3;                // px, side of the squares that share an occlusion ray
constexpr int kPattern = 4;              // blocks, side of the pattern of ray directions
constexpr float kRayStart = 3e-3F;       // m
constexpr int kTileWidth = 4;            // px; rays of a tile are traced at once
constexpr int kTileHeight = 2;
constexpr int kPacket = kTileWidth * kTileHeight;

/// A few neighbouring pixels, numbered row by row.
struct Tile {
  int left = 0, top = 0;
  int width = 0, height = 0;  ///< px

  int count() const { return width * height; }
  int u(int number) const { return left + number % width; }
  int v(int number) const { return top + number / width; }
};

/// Calls `use(tile)` for the tiles of an image.
template <typename Use>
void forEachTile(int width, int height, const Use& use) {
  for (int top = 0; top < height; top += kTileHeight)
    for (int left = 0; left < width; left += kTileWidth)
      use(Tile{left, top, std::min(kTileWidth, width - left), std::min(kTileHeight, height - top)});
}

/// Rays of one camera, in single precision.
class RayFan {
 public:
  explicit RayFan(const PinholeCamera& camera)
      : origin_(camera.T_map_from_camera.translation().cast<float>()),
        R_map_from_camera_(camera.T_map_from_camera.linear().cast<float>()),
        focal_(static_cast<float>(camera.matrix(0, 0)), static_cast<float>(camera.matrix(1, 1))),
        centre_(static_cast<float>(camera.matrix(0, 2)), static_cast<float>(camera.matrix(1, 2))) {}

  const Vector3f& origin() const { return origin_; }
  float pixelAngle() const { return 1.0F / focal_.x(); }
  Vector3f direction(float u, float v) const {
    const Vector3f ray((u - centre_.x()) / focal_.x(), (v - centre_.y()) / focal_.y(), 1.0F);
    return (R_map_from_camera_ * ray).normalized();
  }
  void directions(const Tile& tile, std::array<Vector3f, kPacket>& directions) const {
    for (int i = 0; i < tile.count(); ++i)
      directions[static_cast<std::size_t>(i)] =
          direction(static_cast<float>(tile.u(i)), static_cast<float>(tile.v(i)));
  }

 private:
  Vector3f origin_;
  Eigen::Matrix3f R_map_from_camera_;
  Eigen::Vector2f focal_;
  Eigen::Vector2f centre_;
};

/// Fraction of the hemisphere that is open, sampled by one ray per block. Neighbouring blocks look into
/// different directions of a fixed pattern; gathering a whole pattern averages all of them.
class SkyOpenness {
 public:
  SkyOpenness(const Snapshot& snapshot, const RayFan& fan, const VisibleSurfaces& surfaces)
      : columns_((surfaces.width + kBlock - 1) / kBlock), rows_((surfaces.height + kBlock - 1) / kBlock) {
    cells_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        const int u = std::min(surfaces.width - 1, column * kBlock + (row & 1));
        const int v = std::min(surfaces.height - 1, row * kBlock);
        const Hit& hit = surfaces.at(u, v);
        Cell& cell = cells_[cellOf(column, row)];
        if (!hit) continue;
        const Vector3f direction = fan.direction(static_cast<float>(u), static_cast<float>(v));
        cell.distance = hit.distance;
        cell.normal = hit.normal;
        cell.open = openAlong(snapshot, fan.origin() + hit.distance * direction, hit.normal,
                              (row % kPattern) * kPattern + column % kPattern);
      }
    }
    averages_.reserve(cells_.size());
    for (int row = 0; row < rows_; ++row)
      for (int column = 0; column < columns_; ++column) {
        const Cell& cell = cells_[cellOf(column, row)];
        averages_.push_back(average(column, row, cell.distance, cell.normal));
      }
  }

  /// Average over the pattern around a pixel, of what lies on the same surface.
  float at(int u, int v, const Hit& hit) const {
    const std::size_t cell = cellOf(u / kBlock, v / kBlock);
    return isSameSurface(cells_[cell], hit) ? averages_[cell]
                                            : average(u / kBlock, v / kBlock, hit.distance, hit.normal);
  }

 private:
  struct Cell {
    float distance = -1.0F;
    float open = 1.0F;
    Vector3f normal = Vector3f::Zero();
  };

  std::size_t cellOf(int column, int row) const { return static_cast<std::size_t>(row * columns_ + column); }

  static bool isSameSurface(const Cell& cell, float distance, const Vector3f& normal) {
    return std::abs(cell.distance - distance) < 0.04F * distance && cell.normal.dot(normal) > 0.8F;
  }
  static bool isSameSurface(const Cell& cell, const Hit& hit) {
    return isSameSurface(cell, hit.distance, hit.normal);
  }

  float average(int column, int row, float distance, const Vector3f& normal) const {
    float sum = 0.0F;
    float weight = 0.0F;
    const int last_column = std::min(columns_, column + kPattern / 2);
    const int last_row = std::min(rows_, row + kPattern / 2);
    for (int y = std::max(0, row - kPattern / 2); y < last_row; ++y) {
      for (int x = std::max(0, column - kPattern / 2); x < last_column; ++x) {
        const Cell& cell = cells_[cellOf(x, y)];
        if (!isSameSurface(cell, distance, normal)) continue;
        sum += cell.open;
        weight += 1.0F;
      }
    }
    return weight > 0.0F ? sum / weight : 0.75F;
  }

  static float openAlong(const Snapshot& snapshot, const Vector3f& point, const Vector3f& normal, int index) {
    // Cosine-weighted, stratified: 16 directions.
    const float radius = std::sqrt((static_cast<float>(index) + 0.5F) / (kPattern * kPattern));
    const float angle = 2.39996323F * static_cast<float>(index);
    const auto [x, y] = acrossOf(normal);
    const Vector3f direction =
        radius * (std::cos(angle) * x + std::sin(angle) * y) + std::sqrt(1.0F - radius * radius) * normal;
    const bool hidden =
        snapshot.blocked(point + kRayStart * normal, direction.normalized(), 0.0F, kOcclusionReach);
    return hidden ? 0.3F : 1.0F;
  }

  int columns_;
  int rows_;
  std::vector<Cell> cells_;
  std::vector<float> averages_;  ///< over the pattern around each cell
};

/// Where one sample per pixel is not enough: at edges of objects, materials and shadows. Patterns of a
/// material are smooth to a pixel by themselves.
class EdgeFinder {
 public:
  EdgeFinder(const Snapshot& snapshot, const VisibleSurfaces& surfaces, const cv::Mat& radiance,
             const cv::Mat& in_sun)
      : radiance_(radiance),
        keys_(radiance.size(), CV_32SC1),
        more_(cv::Mat::zeros(radiance.size(), CV_8UC1)) {
    // Surfaces numbered through all objects.
    std::vector<std::uint32_t> first_surface(snapshot.objects().size() + 1, 0);
    for (std::size_t i = 0; i < snapshot.objects().size(); ++i)
      first_surface[i + 1] =
          first_surface[i] + static_cast<std::uint32_t>(snapshot.objects()[i].mesh->surfaces.size());
    for (int v = 0; v < keys_.rows; ++v) {
      for (int u = 0; u < keys_.cols; ++u) {
        const Hit& hit = surfaces.at(u, v);
        if (!hit) {
          keys_.at<std::int32_t>(v, u) = -1;
          continue;
        }
        const std::uint32_t surface = snapshot.objects()[hit.object].mesh->triangles[hit.triangle].surface;
        keys_.at<std::int32_t>(v, u) = static_cast<std::int32_t>(2 * (first_surface[hit.object] + surface) +
                                                                 in_sun.at<std::uint8_t>(v, u));
      }
    }
    for (int v = 0; v < keys_.rows; ++v) {
      for (int u = 0; u < keys_.cols; ++u) {
        if (u + 1 < keys_.cols) compare(v, u, v, u + 1);
        if (v + 1 < keys_.rows) compare(v, u, v + 1, u);
      }
    }
  }

  /// Samples to take besides the centre: none, one where the contrast is low, else two.
  int moreSamples(int u, int v) const { return more_.at<std::uint8_t>(v, u); }

 private:
  void compare(int v, int u, int other_v, int other_u) {
    if (keys_.at<std::int32_t>(v, u) == keys_.at<std::int32_t>(other_v, other_u)) return;
    const float light = radiance_.at<cv::Vec3f>(v, u)[1];
    const float other = radiance_.at<cv::Vec3f>(other_v, other_u)[1];
    const float contrast = std::max(light, other) / (std::min(light, other) + 1e-4F);
    const std::uint8_t more = contrast < kLowContrast ? 0 : contrast < kHighContrast ? 1 : 2;
    for (std::uint8_t* wanted : {&more_.at<std::uint8_t>(v, u), &more_.at<std::uint8_t>(other_v, other_u)})
      *wanted = std::max(*wanted, more);
  }

  static constexpr float kLowContrast = 1.2F;
  static constexpr float kHighContrast = 2.2F;
  const cv::Mat& radiance_;
  cv::Mat keys_;  ///< CV_32SC1, differ where the object, its surface or the light does
  cv::Mat more_;  ///< CV_8UC1
};

/// One image in the making.
class Picture {
 public:
  Picture(const World& world, const Snapshot& snapshot, const PinholeCamera& camera,
          const VisibleSurfaces& surfaces, const Eigen::Isometry3d& T_map_from_base)
      : lighting_(world.lighting),
        snapshot_(snapshot),
        surfaces_(surfaces),
        fan_(camera),
        shader_(snapshot, world.lighting, shiningLamps(world, T_map_from_base, snapshot.time())),
        openness_(snapshot, fan_, surfaces),
        radiance_(camera.height, camera.width, CV_32FC3),
        in_sun_(camera.height, camera.width, CV_8UC1) {}

  cv::Mat render() {
    shadeCentres();
    return smoothEdges();
  }

 private:
  void shadeCentres() {
    std::array<Hit, kPacket> hits;
    forEachTile(radiance_.cols, radiance_.rows, [&](const Tile& tile) {
      fan_.directions(tile, directions_);
      for (int i = 0; i < tile.count(); ++i)
        hits[static_cast<std::size_t>(i)] = surfaces_.at(tile.u(i), tile.v(i));
      lookAtSun(hits.data(), tile.count());
      for (int i = 0; i < tile.count(); ++i) {
        const auto k = static_cast<std::size_t>(i);
        const SurfaceLight seen = light(k, hits[k], tile.u(i), tile.v(i), Mirrors::kTraced);
        radiance_.at<cv::Vec3f>(tile.v(i), tile.u(i)) = asVector(seen.radiance);
        in_sun_.at<std::uint8_t>(tile.v(i), tile.u(i)) = seen.in_sun ? 1 : 0;
      }
    });
  }

  /// Adds samples at edges, on both sides of the centre.
  cv::Mat smoothEdges() {
    constexpr float kOffsets[2][2] = {{-0.33F, -0.17F}, {0.29F, 0.31F}};
    struct Sample {
      int u;
      std::size_t offset;
    };
    const EdgeFinder edges(snapshot_, surfaces_, radiance_, in_sun_);
    cv::Mat smooth = radiance_.clone();
    std::vector<Sample> samples;
    std::vector<float> weights(static_cast<std::size_t>(radiance_.cols));
    std::array<Hit, kPacket> hits;
    for (int v = 0; v < radiance_.rows; ++v) {
      samples.clear();
      for (int u = 0; u < radiance_.cols; ++u) {
        const int more = edges.moreSamples(u, v);
        weights[static_cast<std::size_t>(u)] = 1.0F / static_cast<float>(1 + more);
        // A single one goes to either side in turn, so that edges do not shift.
        if (more == 1) samples.push_back({u, static_cast<std::size_t>((u + v) & 1)});
        if (more == 2) samples.insert(samples.end(), {{u, 0}, {u, 1}});
      }
      for (std::size_t first = 0; first < samples.size(); first += kPacket) {
        const std::size_t count = std::min<std::size_t>(kPacket, samples.size() - first);
        for (std::size_t k = 0; k < count; ++k) {
          const auto& offset = kOffsets[samples[first + k].offset];
          directions_[k] = fan_.direction(static_cast<float>(samples[first + k].u) + offset[0],
                                          static_cast<float>(v) + offset[1]);
        }
        snapshot_.trace8(fan_.origin(), directions_.data(), static_cast<int>(count), hits.data());
        lookAtSun(hits.data(), static_cast<int>(count));
        for (std::size_t k = 0; k < count; ++k) {
          const int u = samples[first + k].u;
          smooth.at<cv::Vec3f>(v, u) += asVector(light(k, hits[k], u, v, Mirrors::kVague).radiance);
        }
      }
      for (const Sample& sample : samples) {
        float& weight = weights[static_cast<std::size_t>(sample.u)];
        smooth.at<cv::Vec3f>(v, sample.u) *= weight;
        weight = 1.0F;  // once per pixel
      }
    }
    return smooth;
  }

  /// Light along a ray of the packet.
  SurfaceLight light(std::size_t number, const Hit& hit, int u, int v, Mirrors mirrors) const {
    const Vector3f& direction = directions_[number];
    if (!hit) return {shader_.sky(direction), false};
    return shader_.surface(fan_.origin(), direction, hit, fan_.pixelAngle(), openness_.at(u, v, hit),
                           suns_[number], mirrors);
  }

  /// Which surfaces of the packet are in the sun.
  void lookAtSun(const Hit* hits, int count) {
    std::array<Vector3f, kPacket> starts;
    std::array<Vector3f, kPacket> to_sun;
    std::array<float, kPacket> reach{};
    std::array<bool, kPacket> blocked{};
    to_sun.fill(lighting_.to_sun);
    for (int i = 0; i < count; ++i) {
      const auto k = static_cast<std::size_t>(i);
      starts[k] = fan_.origin();
      const bool asked =
          hits[i] && shader_.canSeeSun(fan_.origin() + hits[i].distance * directions_[k], hits[i], starts[k]);
      reach[k] = asked ? Shader::kShadowReach : 0.0F;
    }
    snapshot_.blocked8(starts.data(), to_sun.data(), reach.data(), count, blocked.data());
    for (std::size_t k = 0; k < suns_.size(); ++k)
      suns_[k] = reach[k] > 0.0F && !blocked[k] ? Sun::kShines : Sun::kHidden;
  }

  static cv::Vec3f asVector(const Color& color) { return {color.x(), color.y(), color.z()}; }

  const Lighting& lighting_;
  const Snapshot& snapshot_;
  const VisibleSurfaces& surfaces_;
  RayFan fan_;
  Shader shader_;
  SkyOpenness openness_;
  cv::Mat radiance_;
  cv::Mat in_sun_;
  std::array<Vector3f, kPacket> directions_;  ///< of the packet at hand
  std::array<Sun, kPacket> suns_{};
};

}  // namespace

VisibleSurfaces traceSurfaces(const Snapshot& snapshot, const PinholeCamera& camera) {
  const RayFan fan(camera);
  VisibleSurfaces surfaces;
  surfaces.width = camera.width;
  surfaces.height = camera.height;
  surfaces.hits.resize(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  std::array<Vector3f, kPacket> directions;
  std::array<Hit, kPacket> hits;
  forEachTile(camera.width, camera.height, [&](const Tile& tile) {
    fan.directions(tile, directions);
    snapshot.trace8(fan.origin(), directions.data(), tile.count(), hits.data());
    for (int i = 0; i < tile.count(); ++i)
      surfaces.hits[static_cast<std::size_t>(tile.v(i)) * static_cast<std::size_t>(camera.width) +
                    static_cast<std::size_t>(tile.u(i))] = hits[static_cast<std::size_t>(i)];
  });
  return surfaces;
}

cv::Mat renderRadiance(const World& world, const Snapshot& snapshot, const PinholeCamera& camera,
                       const VisibleSurfaces& surfaces, const Eigen::Isometry3d& T_map_from_base) {
  return Picture(world, snapshot, camera, surfaces, T_map_from_base).render();
}

}  // namespace radar_dot::simulation
