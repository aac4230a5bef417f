// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensors/radar_echoes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "simulation/sensors/radar_reflectivity.h"

namespace radar_dot::simulation {
namespace {

constexpr int kElevations = 8;              // rows of rays
constexpr int kPacket = 8;                  // rays traced together
constexpr int kMaxSurfacesBehind = 3;       // that a ray is followed through
constexpr float kSurfaceThickness = 0.05F;  // m
constexpr float kMinRange = 0.3F;           // m
constexpr double kSidewaysSine = 0.7;       // of the angle between the directions of radar and car

Eigen::Vector3d directionOf(double azimuth, double elevation) {
  return {std::cos(elevation) * std::cos(azimuth), std::cos(elevation) * std::sin(azimuth),
          std::sin(elevation)};
}

/// Follows rays and collects an echo for every surface they meet.
class EchoCollector {
 public:
  EchoCollector(const Snapshot& snapshot, const RadarMotion& motion, const RadarScanModel& scan,
                const RadarModel& model)
      : snapshot_(snapshot), motion_(motion), scan_(scan), model_(model) {
    origin_ = motion.T_map_from_sensor.translation().cast<float>();
  }

  /// Rays side by side go through the same parts of the world: a packet of them is quick.
  void block(double first_azimuth, RandomStream& random) {
    const double height = (scan_.elevation_high - scan_.elevation_low) / kElevations;
    for (int row = 0; row < kElevations; ++row) {
      std::array<double, kPacket> azimuths;
      std::array<Eigen::Vector3f, kPacket> directions;
      for (std::size_t i = 0; i < kPacket; ++i) {
        azimuths[i] = first_azimuth + (static_cast<double>(i) + random.uniform()) * scan_.azimuth_step;
        const double elevation = scan_.elevation_low + (row + random.uniform()) * height;
        directions[i] =
            (motion_.T_map_from_sensor.linear() * directionOf(azimuths[i], elevation)).cast<float>();
      }
      std::array<Hit, kPacket> hits;
      snapshot_.trace8(origin_, directions.data(), kPacket, hits.data());
      for (std::size_t i = 0; i < kPacket; ++i) follow(hits[i], directions[i], azimuths[i]);
    }
  }

  std::vector<Echo> take() { return std::move(echoes_); }

 private:
  void follow(Hit hit, const Eigen::Vector3f& direction, double azimuth) {
    double loss = 0.0;
    for (int surface = 0; hit && hit.distance < scan_.max_range; ++surface) {
      if (hit.distance > kMinRange) add(hit, direction, azimuth, loss);
      const double more = radarTransmissionLoss(snapshot_.surfaceOf(hit).material);
      if (more < 0.0 || surface == kMaxSurfacesBehind) return;
      loss += more;
      hit = snapshot_.trace(origin_, direction, hit.distance + kSurfaceThickness);
    }
  }

  void add(const Hit& hit, const Eigen::Vector3f& direction, double azimuth, double loss) {
    const Eigen::Vector3d toward = direction.cast<double>();
    const Eigen::Vector3d point = motion_.T_map_from_sensor.translation() + hit.distance * toward;
    Echo echo;
    echo.rcs = radarCrossSection(snapshot_, hit, direction, point, model_) - loss;
    if (motion_.sideways) echo.rcs += model_.sideways_rcs_offset;
    echo.range = hit.distance;
    echo.azimuth = azimuth;
    // Far below the threshold no fluctuation helps.
    if (echo.rcs + 4.0 * model_.fluctuation_deviation <
        detectionThreshold(echo.range, azimuth, scan_, model_))
      return;
    echo.range_rate = toward.dot(snapshot_.velocityAt(hit, point) - motion_.velocity);
    echo.object = static_cast<std::int32_t>(hit.object);
    echoes_.push_back(echo);
  }

  const Snapshot& snapshot_;
  const RadarMotion& motion_;
  const RadarScanModel& scan_;
  const RadarModel& model_;
  Eigen::Vector3f origin_;
  std::vector<Echo> echoes_;
};

/// The weakest that are detected are so by chance.
bool detected(const Echo& echo, const RadarScanModel& scan, const RadarModel& model, RandomStream& random) {
  if (echo.range >= scan.max_range || echo.rcs < model.min_rcs) return false;
  const double excess = echo.rcs - detectionThreshold(echo.range, echo.azimuth, scan, model);
  return random.chance(1.0 / (1.0 + std::exp(-excess / model.threshold_softness)));
}

bool stronger(const Echo& a, const Echo& b) {
  if (a.rcs != b.rcs) return a.rcs > b.rcs;
  return a.range != b.range ? a.range < b.range : a.azimuth < b.azimuth;
}

/// The strongest echo of a cell hides the others; few of those beside it stand out. @param all sorted.
std::vector<Echo> strongestOfNeighbourhoods(const std::vector<Echo>& all, const RadarScanModel& scan,
                                            const RadarModel& model, RandomStream& random) {
  const double bin_width = model.neighbour_ranges * scan.range_cell;
  std::vector<std::vector<std::size_t>> bins(static_cast<std::size_t>(scan.max_range / bin_width) + 3);
  std::vector<Echo> echoes;
  for (Echo echo : all) {
    const auto bin = static_cast<std::size_t>(echo.range / bin_width) + 1;
    bool hidden = false;
    for (std::size_t beside = bin - 1; beside <= bin + 1; ++beside) {
      for (const std::size_t number : bins[beside]) {
        const Echo& other = echoes[number];
        const double ranges = std::abs(other.range - echo.range) / scan.range_cell;
        const double azimuths =
            std::abs(other.azimuth - echo.azimuth) * std::cos(echo.azimuth) / scan.azimuth_cell;
        hidden = hidden || (ranges < 1.0 && azimuths < 1.0);
        if (ranges < model.neighbour_ranges && azimuths < model.neighbour_azimuths) echo.isolated = false;
      }
    }
    if (hidden || (!echo.isolated && !random.chance(model.neighbour_chance))) continue;
    bins[bin].push_back(echoes.size());
    echoes.push_back(echo);
  }
  return echoes;
}

}  // namespace

RadarMotion::RadarMotion(const SensorMount& mount, const Trajectory& ego, double time_s) {
  const Eigen::Isometry3d T_map_from_base = ego.at(time_s).T_map_from_body;
  const Eigen::Vector3d turn_rate = ego.angularVelocity(time_s);
  T_map_from_sensor = T_map_from_base * mount.T_base_from_sensor;
  velocity = ego.velocity(time_s) +
             turn_rate.cross(T_map_from_base.linear() * mount.T_base_from_sensor.translation());
  sideways = std::abs(mount.T_base_from_sensor.linear()(1, 0)) > kSidewaysSine;
  yaw_rate = turn_rate.dot(T_map_from_base.linear().col(2));
}

double RadarMotion::staticRangeRate(double azimuth) const {
  return -velocity.dot(T_map_from_sensor.linear() * directionOf(azimuth, 0.0));
}

double detectionThreshold(double range, double azimuth, const RadarScanModel& scan, const RadarModel& model) {
  const double distance_loss = std::max(0.0, 40.0 * std::log10(range / scan.sensitive_range));
  const double near_loss =
      scan.near_loss * std::max(0.0, std::log10(scan.near_loss_range / std::max(1.0, range)));
  const double edge_loss = scan.edge_loss * std::max(0.0, std::abs(azimuth) - scan.edge_azimuth);
  return model.min_rcs + scan.threshold_offset + model.threshold_offset + distance_loss + near_loss +
         edge_loss + scan.azimuth_loss * azimuth * azimuth;
}

std::vector<Echo> surfaceEchoes(const Snapshot& snapshot, const RadarMotion& motion,
                                const RadarScanModel& scan, const RadarModel& model, RandomStream& random) {
  EchoCollector collector(snapshot, motion, scan, model);
  const double block_width = kPacket * scan.azimuth_step;
  const int blocks = static_cast<int>(std::ceil(2.0 * scan.traced_azimuth / block_width));
  for (int block = 0; block < blocks; ++block) collector.block(block_width * (block - 0.5 * blocks), random);
  std::vector<Echo> all = collector.take();
  std::sort(all.begin(), all.end(), stronger);

  std::vector<Echo> echoes = strongestOfNeighbourhoods(all, scan, model, random);
  for (Echo& echo : echoes) echo.rcs += model.fluctuation_deviation * random.normal();
  const auto missed = [&](const Echo& echo) { return !detected(echo, scan, model, random); };
  echoes.erase(std::remove_if(echoes.begin(), echoes.end(), missed), echoes.end());
  return echoes;
}

void addGhosts(std::vector<Echo>& echoes, const RadarMotion& motion, const RadarScanModel& scan,
               const RadarModel& model, RandomStream& random) {
  const int sources = static_cast<int>(echoes.size());
  const int copies = sources > 0 ? random.poisson(model.multipath_rate * sources) : 0;
  for (int i = 0; i < copies; ++i) {
    Echo ghost = echoes[static_cast<std::size_t>(random.index(sources))];
    ghost.object = -1;
    ghost.isolated = false;
    ghost.range -= model.multipath_length * std::log(1.0 - random.uniform());
    ghost.rcs += model.fluctuation_deviation * random.normal() - model.multipath_loss;
    if (detected(ghost, scan, model, random)) echoes.push_back(ghost);
  }
  const int details = random.poisson(model.detail_rate);
  for (int i = 0; i < details; ++i) {
    Echo ghost;
    ghost.range = model.detail_range * std::exp(model.detail_range_deviation * random.normal());
    ghost.azimuth = model.detail_azimuth * random.normal();
    ghost.rcs = model.min_rcs - model.detail_rcs * std::log(1.0 - random.uniform());
    ghost.range_rate = motion.staticRangeRate(ghost.azimuth);
    const bool inside = std::abs(ghost.azimuth) < scan.traced_azimuth;
    if (inside && detected(ghost, scan, model, random)) echoes.push_back(ghost);
  }
  const int clutter = random.poisson(model.clutter_rate);
  for (int i = 0; i < clutter; ++i) {
    Echo ghost;
    const double outward = std::sqrt(random.uniform());
    ghost.range = scan.max_range * outward * random.uniform();
    ghost.azimuth = random.uniform(-scan.valid_azimuth, scan.valid_azimuth);
    ghost.rcs = model.min_rcs - model.surface_deviation * std::log(1.0 - random.uniform());
    ghost.range_rate = motion.staticRangeRate(ghost.azimuth) + model.folded_deviation * random.normal();
    if (ghost.range > 1.0 && detected(ghost, scan, model, random)) echoes.push_back(ghost);
  }
}

}  // namespace radar_dot::simulation
