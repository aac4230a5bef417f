// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensors/annotations.h"

#include <algorithm>

#include "radar_dot/common/random_stream.h"
#include "radar_dot/simulation/camera_sensor.h"
#include "simulation/sensors/pose_arrays.h"

namespace radar_dot::simulation {
namespace {

constexpr double kFarthest = 100.0;      // m
constexpr int kSurfaceSamples = 48;      // points looked at per actor
constexpr double kSurfaceMargin = 0.05;  // m
constexpr std::uint64_t kSampleStream = 0xa5507;

/// Some corners of the actor's meshes, map frame.
std::vector<Eigen::Vector3d> surfacePoints(const Snapshot& snapshot, const std::vector<std::size_t>& parts,
                                           RandomStream& random) {
  std::vector<Eigen::Vector3d> points;
  std::size_t corners = 0;
  for (const std::size_t part : parts) corners += snapshot.objects()[part].mesh->positions.size();
  if (corners == 0) return points;
  for (int i = 0; i < kSurfaceSamples; ++i) {
    auto number = static_cast<std::size_t>(random.uniform() * static_cast<double>(corners));
    for (const std::size_t part : parts) {
      const PlacedObject& object = snapshot.objects()[part];
      if (number < object.mesh->positions.size()) {
        points.push_back(object.T_map_from_object * object.mesh->positions[number].cast<double>());
        break;
      }
      number -= object.mesh->positions.size();
    }
  }
  return points;
}

bool inView(const PinholeCamera& camera, const Eigen::Vector3d& point) {
  const Eigen::Vector3d in_camera = camera.T_map_from_camera.inverse() * point;
  if (in_camera.z() < 0.2) return false;
  const Eigen::Vector2d pixel = camera.project(in_camera);
  return pixel.x() > -0.5 && pixel.y() > -0.5 && pixel.x() < camera.width - 0.5 &&
         pixel.y() < camera.height - 0.5;
}

/// Nothing but the actor itself is in the way.
bool isSeen(const Snapshot& snapshot, const PinholeCamera& camera, const Eigen::Vector3d& point, int actor) {
  const Eigen::Vector3d origin = camera.T_map_from_camera.translation();
  const Eigen::Vector3d ray = point - origin;
  const double distance = ray.norm();
  const Hit hit = snapshot.trace(origin.cast<float>(), (ray / distance).cast<float>());
  return !hit || hit.distance > distance - kSurfaceMargin || snapshot.objects()[hit.object].actor == actor;
}

Eigen::Vector3d centreOf(const Actor& actor, const Eigen::Isometry3d& T_map_from_body) {
  return T_map_from_body * Eigen::Vector3d(0.0, 0.0, 0.5 * actor.model->size.z());
}

}  // namespace

std::vector<double> visibleShares(const World& world, const Snapshot& snapshot, const Trajectory& ego) {
  std::vector<PinholeCamera> cameras;
  for (const CameraMount& mount : cameraMounts())
    cameras.push_back(cameraAt(mount, ego, snapshot.time(), kFullWidth, kFullHeight));
  std::vector<std::vector<std::size_t>> parts(world.actors.size());
  for (std::size_t i = 0; i < snapshot.objects().size(); ++i)
    if (snapshot.objects()[i].actor >= 0)
      parts[static_cast<std::size_t>(snapshot.objects()[i].actor)].push_back(i);

  const Eigen::Vector3d here = ego.at(snapshot.time()).T_map_from_body.translation();
  std::vector<double> shares(world.actors.size(), 0.0);
  for (std::size_t actor = 0; actor < shares.size(); ++actor) {
    const Eigen::Isometry3d body = world.actors[actor].trajectory->at(snapshot.time()).T_map_from_body;
    if ((body.translation() - here).norm() > kFarthest) continue;
    RandomStream random(actor, kSampleStream);
    const auto points = surfacePoints(snapshot, parts[actor], random);
    const auto seen = std::count_if(points.begin(), points.end(), [&](const Eigen::Vector3d& point) {
      return std::any_of(cameras.begin(), cameras.end(), [&](const PinholeCamera& camera) {
        return inView(camera, point) && isSeen(snapshot, camera, point, static_cast<int>(actor));
      });
    });
    if (!points.empty()) shares[actor] = static_cast<double>(seen) / static_cast<double>(points.size());
  }
  return shares;
}

std::vector<dataset::NewAnnotation> annotate(const World& world, const Trajectory& ego, double time_s,
                                             std::size_t sample, const Findings& found,
                                             const std::vector<double>& visible_shares) {
  const Eigen::Vector3d here = ego.at(time_s).T_map_from_body.translation();
  std::vector<dataset::NewAnnotation> annotations;
  for (std::size_t number = 0; number < world.actors.size(); ++number) {
    const Actor& actor = world.actors[number];
    if (actor.model->category.empty()) continue;
    const Eigen::Isometry3d body = actor.trajectory->at(time_s).T_map_from_body;
    const bool is_near = (body.translation() - here).norm() <= kFarthest;
    const bool has_returns = found.lidar[number] + found.radar[number] > 0;
    if (!(is_near && has_returns) && found.masks[number] == 0) continue;
    const Eigen::Vector3d& size = actor.model->size;
    dataset::NewAnnotation annotation;
    annotation.sample = sample;
    annotation.instance = number;
    annotation.translation = asArray(centreOf(actor, body));
    annotation.size = {size.y(), size.x(), size.z()};
    annotation.rotation = quaternionOf(body);
    const std::string attribute = attributeOf(actor, time_s);
    if (!attribute.empty()) annotation.attributes.push_back(attribute);
    annotation.visibility = visibilityLevel(visible_shares[number]);
    annotation.lidar_points = found.lidar[number];
    annotation.radar_points = found.radar[number];
    annotations.push_back(std::move(annotation));
  }
  return annotations;
}

int visibilityLevel(double visible_share) {
  return visible_share < 0.4 ? 1 : visible_share < 0.6 ? 2 : visible_share < 0.8 ? 3 : 4;
}

}  // namespace radar_dot::simulation
