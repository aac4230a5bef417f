// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensors/ground_truth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "radar_dot/dataset/instance_masks.h"

namespace radar_dot::simulation {
namespace {

constexpr double kDepthScale = 256.0;
constexpr double kFlowScale = 64.0;
constexpr double kFlowZero = 32768.0;
constexpr double kMaxFlow = 511.0;  // px

/// Points of a row of pixels, asked in packets whether something stands between them and a camera.
class HiddenPoints {
 public:
  HiddenPoints(const Snapshot& snapshot, const Eigen::Vector3d& camera)
      : snapshot_(snapshot), camera_(camera) {
    origins_.fill(camera.cast<float>());
  }

  /// @param answer  becomes kOccludedInOther or kVisibleInOther, by finish() at the latest
  void ask(const Eigen::Vector3d& point, std::uint8_t* answer) {
    const Eigen::Vector3d ray = point - camera_;
    const double distance = ray.norm();
    // The end is left out a little, so that the point's own surface does not count.
    const double margin = std::max(0.01, 0.002 * distance);
    directions_[count_] = (ray / distance).cast<float>();
    far_m_[count_] = static_cast<float>(distance - margin);
    answers_[count_] = answer;
    if (++count_ == kPacket) finish();
  }

  void finish() {
    if (count_ == 0) return;
    std::array<bool, kPacket> blocked{};
    snapshot_.blocked8(origins_.data(), directions_.data(), far_m_.data(), static_cast<int>(count_),
                       blocked.data());
    for (std::size_t i = 0; i < count_; ++i) *answers_[i] = blocked[i] ? kOccludedInOther : kVisibleInOther;
    count_ = 0;
  }

 private:
  static constexpr std::size_t kPacket = 8;
  const Snapshot& snapshot_;
  Eigen::Vector3d camera_;
  std::array<Eigen::Vector3f, kPacket> origins_;
  std::array<Eigen::Vector3f, kPacket> directions_;
  std::array<float, kPacket> far_m_{};
  std::array<std::uint8_t*, kPacket> answers_{};
  std::size_t count_ = 0;
};

}  // namespace

cv::Mat depthTruth(const VisibleSurfaces& surfaces, const PinholeCamera& camera) {
  cv::Mat depth(surfaces.height, surfaces.width, CV_32FC1);
  for (int v = 0; v < surfaces.height; ++v) {
    auto* row = depth.ptr<float>(v);
    for (int u = 0; u < surfaces.width; ++u) {
      const Hit& hit = surfaces.at(u, v);
      row[u] = hit ? static_cast<float>(hit.distance / camera.rayOf(u, v).norm()) : 0.0F;
    }
  }
  return depth;
}

cv::Mat actorTruth(const VisibleSurfaces& surfaces, const Snapshot& snapshot) {
  cv::Mat actors(surfaces.height, surfaces.width, CV_16UC1);
  for (int v = 0; v < surfaces.height; ++v) {
    auto* row = actors.ptr<std::uint16_t>(v);
    for (int u = 0; u < surfaces.width; ++u) {
      const Hit& hit = surfaces.at(u, v);
      row[u] = hit ? static_cast<std::uint16_t>(snapshot.objects()[hit.object].actor + 1) : std::uint16_t{0};
    }
  }
  return actors;
}

cv::Mat motionTruth(const cv::Mat& actors, const World& world, double time_s) {
  std::vector<std::uint8_t> value(world.actors.size() + 1, 0);
  for (std::size_t i = 0; i < world.actors.size(); ++i)
    if (dataset::isMovingAttribute(attributeOf(world.actors[i], time_s))) value[i + 1] = 255;
  cv::Mat motion(actors.size(), CV_8UC1);
  std::transform(actors.begin<std::uint16_t>(), actors.end<std::uint16_t>(), motion.begin<std::uint8_t>(),
                 [&](std::uint16_t actor) { return value[actor]; });
  return motion;
}

FlowTruth flowTruth(const VisibleSurfaces& surfaces, const Snapshot& snapshot, const PinholeCamera& camera,
                    const Snapshot& other, const PinholeCamera& other_camera) {
  // Where the surface under a pixel is in the other camera's frame, for each object.
  std::vector<Eigen::Isometry3d> T_other_from_camera;
  const Eigen::Isometry3d T_other_from_map = other_camera.T_map_from_camera.inverse();
  for (std::size_t i = 0; i < snapshot.objects().size(); ++i)
    T_other_from_camera.push_back(T_other_from_map * other.objects()[i].T_map_from_object *
                                  snapshot.objects()[i].T_map_from_object.inverse() *
                                  camera.T_map_from_camera);

  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  FlowTruth truth;
  truth.flow = cv::Mat(surfaces.height, surfaces.width, CV_32FC2, cv::Scalar(kNone, kNone));
  truth.occlusion = cv::Mat(surfaces.height, surfaces.width, CV_8UC1, cv::Scalar(kOutsideOther));
  HiddenPoints points(other, other_camera.T_map_from_camera.translation());
  for (int v = 0; v < surfaces.height; ++v) {
    for (int u = 0; u < surfaces.width; ++u) {
      const Hit& hit = surfaces.at(u, v);
      if (!hit) continue;
      const Eigen::Vector3d point = hit.distance * camera.rayOf(u, v).normalized();
      const Eigen::Vector3d moved = T_other_from_camera[hit.object] * point;
      if (moved.z() < 0.05) continue;
      const Eigen::Vector2d pixel = other_camera.project(moved);
      truth.flow.at<cv::Vec2f>(v, u) = {static_cast<float>(pixel.x() - u), static_cast<float>(pixel.y() - v)};
      if (pixel.x() < 0.0 || pixel.y() < 0.0 || pixel.x() > other_camera.width - 1 ||
          pixel.y() > other_camera.height - 1)
        continue;
      points.ask(other_camera.T_map_from_camera * moved, &truth.occlusion.at<std::uint8_t>(v, u));
    }
    points.finish();
  }
  return truth;
}

cv::Mat encodeDepth(const cv::Mat& depth) {
  cv::Mat encoded(depth.size(), CV_16UC1);
  std::transform(depth.begin<float>(), depth.end<float>(), encoded.begin<std::uint16_t>(), [](float metres) {
    const double value = std::round(kDepthScale * metres);
    return value < 65536.0 ? static_cast<std::uint16_t>(value) : std::uint16_t{0};
  });
  return encoded;
}

cv::Mat encodeFlow(const cv::Mat& flow) {
  cv::Mat encoded(flow.size(), CV_16UC3);
  std::transform(flow.begin<cv::Vec2f>(), flow.end<cv::Vec2f>(), encoded.begin<cv::Vec3w>(),
                 [](const cv::Vec2f& vector) {
                   if (!(std::abs(vector[0]) <= kMaxFlow && std::abs(vector[1]) <= kMaxFlow))
                     return cv::Vec3w(0, 0, 0);
                   const auto code = [](float value) {
                     return static_cast<std::uint16_t>(std::lround(kFlowScale * value + kFlowZero));
                   };
                   return cv::Vec3w(1, code(vector[1]), code(vector[0]));
                 });
  return encoded;
}

}  // namespace radar_dot::simulation
