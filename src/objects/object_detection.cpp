// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/objects/object_detection.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "radar_dot/objects/assignment.h"

namespace radar_dot {
namespace {

using Group = std::vector<const ReturnOverGround*>;

/// Connected sets of neighbours.
std::vector<Group> groupsOf(const Group& returns, const DetectionParams& params) {
  std::vector<std::size_t> parent(returns.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  const auto rootOf = [&parent](std::size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
  };
  for (std::size_t i = 0; i < returns.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      if ((returns[i]->position - returns[j]->position).norm() > params.max_distance) continue;
      // Along different lines of sight one velocity has different components.
      if (returns[i]->radar == returns[j]->radar &&
          std::abs(returns[i]->velocity - returns[j]->velocity) > params.max_velocity_difference)
        continue;
      parent[rootOf(i)] = rootOf(j);
    }
  }
  std::map<std::size_t, Group> by_root;
  for (std::size_t i = 0; i < returns.size(); ++i) by_root[rootOf(i)].push_back(returns[i]);
  std::vector<Group> groups;
  for (auto& [root, group] : by_root) groups.push_back(std::move(group));
  return groups;
}

/// What the returns of each radar together say of the velocity.
std::vector<VelocityConstraint> radialConstraints(const Group& group, const DetectionParams& params) {
  std::map<std::size_t, Group> by_radar;
  for (const ReturnOverGround* seen : group) by_radar[seen->radar].push_back(seen);
  std::vector<VelocityConstraint> constraints;
  for (const auto& [radar, seen] : by_radar) {
    VelocityConstraint constraint;
    std::vector<double> velocities;
    double variance = 0.0;
    for (const ReturnOverGround* one : seen) {
      constraint.row += one->bearing();
      velocities.push_back(one->velocity);
      variance += one->variance;
    }
    constraint.row.normalize();
    const auto half = static_cast<std::ptrdiff_t>(velocities.size() / 2);
    std::nth_element(velocities.begin(), velocities.begin() + half, velocities.end());
    constraint.value = velocities[static_cast<std::size_t>(half)];
    if (velocities.size() % 2 == 0) {
      const double lower = *std::max_element(velocities.begin(), velocities.begin() + half);
      constraint.value = 0.5 * (constraint.value + lower);
    }
    const auto count = static_cast<double>(seen.size());
    constraint.variance =
        variance / (count * count) + params.shared_velocity_std * params.shared_velocity_std;
    constraints.push_back(constraint);
  }
  return constraints;
}

void setVelocity(const std::vector<VelocityConstraint>& constraints, double unobserved_std,
                 ObjectDetection& detection) {
  Eigen::Matrix2d information = Eigen::Matrix2d::Identity() / (unobserved_std * unobserved_std);
  Eigen::Vector2d weighted = Eigen::Vector2d::Zero();
  for (const VelocityConstraint& constraint : constraints) {
    information += constraint.row * constraint.row.transpose() / constraint.variance;
    weighted += constraint.row * constraint.value / constraint.variance;
  }
  detection.velocity_covariance = information.inverse();
  detection.velocity = detection.velocity_covariance * weighted;
}

ObjectDetection detectionOf(const Group& group, const DetectionParams& params) {
  ObjectDetection detection;
  detection.return_count = group.size();
  const auto count = static_cast<double>(group.size());
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (const ReturnOverGround* seen : group) {
    detection.position += seen->position / count;
    covariance += seen->covariance / count;
  }
  detection.position_covariance =
      covariance / count + params.extent_std * params.extent_std * Eigen::Matrix2d::Identity();
  setVelocity(radialConstraints(group, params), params.unobserved_std, detection);
  return detection;
}

/// The region's part in a detection: fuses the positions and adds the constraint.
void addRegion(const MaskRegion& region, const Group& group, const DetectionParams& params,
               ObjectDetection& detection) {
  if (group.empty()) {
    detection.position = region.position;
    detection.position_covariance = region.covariance;
  } else {
    const Eigen::Matrix2d gain =
        detection.position_covariance * (detection.position_covariance + region.covariance).inverse();
    detection.position += gain * (region.position - detection.position);
    detection.position_covariance -= gain * detection.position_covariance.eval();
  }
  std::vector<VelocityConstraint> constraints = radialConstraints(group, params);
  constraints.push_back(region.lateral);
  setVelocity(constraints, params.unobserved_std, detection);
  detection.pixel_count = region.pixel_count;
  detection.box = region.box;
}

/// For each region the group of returns that lies on it.
std::vector<int> groupOfRegion(const std::vector<MaskRegion>& regions,
                               const std::vector<ObjectDetection>& detections, double gate) {
  Eigen::MatrixXd distances(static_cast<Eigen::Index>(regions.size()),
                            static_cast<Eigen::Index>(detections.size()));
  for (std::size_t r = 0; r < regions.size(); ++r) {
    for (std::size_t d = 0; d < detections.size(); ++d) {
      const Eigen::Vector2d apart = detections[d].position - regions[r].position;
      const Eigen::Matrix2d covariance = detections[d].position_covariance + regions[r].covariance;
      distances(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(d)) =
          apart.dot(covariance.inverse() * apart);
    }
  }
  return assign(distances, gate * gate);
}

}  // namespace

std::vector<ObjectDetection> detectObjects(double time, const std::vector<ReturnOverGround>& returns,
                                           const std::vector<MaskRegion>& regions,
                                           const DetectionParams& params) {
  validate(params);
  Group moving, weak;
  for (const ReturnOverGround& seen : returns) {
    if (seen.label == ReturnLabel::kDynamic) {
      moving.push_back(&seen);
    } else if (std::abs(seen.velocity) >= params.weak_threshold) {
      weak.push_back(&seen);
    }
  }
  const std::vector<Group> groups = groupsOf(moving, params);
  std::vector<ObjectDetection> detections;
  for (const Group& group : groups) detections.push_back(detectionOf(group, params));
  const std::vector<int> partners = groupOfRegion(regions, detections, params.region_gate);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    if (partners[r] == kUnassigned) {
      addRegion(regions[r], {}, params, detections.emplace_back());
    } else {
      const auto d = static_cast<std::size_t>(partners[r]);
      addRegion(regions[r], groups[d], params, detections[d]);
    }
  }
  for (const ReturnOverGround* seen : weak) {
    detections.push_back(detectionOf({seen}, params));
    detections.back().moving = false;
  }
  for (ObjectDetection& detection : detections) detection.time = time;
  return detections;
}

}  // namespace radar_dot
