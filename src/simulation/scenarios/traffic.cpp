// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/scenarios/traffic.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "simulation/street/street_builder.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector2d;

constexpr double kPi = 3.141592653589793;
constexpr double kSampling = 0.1;      // s
constexpr double kMargin = 0.12;       // m, around everybody
constexpr double kBefore = 0.6;        // s, before and after the drive
constexpr double kGap = 2.2;           // m, between vehicles that stand in a queue
constexpr double kQueueSpacing = 7.4;  // m, mean, in a queue
constexpr double kEgoLength = 4.1;     // m

/// The ego stands in a list of models as a null pointer.
double lengthOf(const std::shared_ptr<const Model>& model) {
  return model == nullptr ? kEgoLength : model->size.x();
}

double wheelbaseOf(const Model& model) { return -2.0 * model.rear_axle_x; }

/// Kerbs that a path crosses, for a walker.
std::vector<HeightStep> heightSteps(const StreetPlan& plan, const Path& path) {
  constexpr double kStep = 0.1;  // m
  std::vector<HeightStep> steps;
  double height = plan.groundHeight(path.at(0.0).position);
  for (double along = kStep; along < path.length(); along += kStep) {
    const double here = plan.groundHeight(path.at(along).position);
    if (here != height) steps.push_back({along - 0.5 * kStep, here - height});
    height = here;
  }
  return steps;
}

}  // namespace

bool overlap(const Footprint& a, const Footprint& b, double margin) {
  const Vector2d apart = b.centre - a.centre;
  const double reach = a.half.norm() + b.half.norm() + 2.0 * margin;
  if (apart.squaredNorm() > reach * reach) return false;
  const auto left = [](const Vector2d& v) { return Vector2d(-v.y(), v.x()); };
  const auto radius = [&](const Footprint& box, const Vector2d& axis) {
    return (box.half.x() + margin) * std::abs(box.forward.dot(axis)) +
           (box.half.y() + margin) * std::abs(left(box.forward).dot(axis));
  };
  for (const Vector2d& axis : {a.forward, left(a.forward), b.forward, left(b.forward)})
    if (std::abs(apart.dot(axis)) > radius(a, axis) + radius(b, axis)) return false;
  return true;
}

Footprint footprintOf(const Actor& actor, double time_s) {
  const Eigen::Isometry3d pose = actor.trajectory->at(time_s).T_map_from_body;
  return {pose.translation().head<2>(), pose.linear().col(0).head<2>().normalized(),
          0.5 * actor.model->size.head<2>()};
}

Footprint footprintOfEgo(const Trajectory& ego, double time_s) {
  const Eigen::Isometry3d pose = ego.at(time_s).T_map_from_body;
  const Vector2d forward = pose.linear().col(0).head<2>().normalized();
  return {pose.translation().head<2>() + kEgoMiddle * forward, forward, {0.5 * kEgoLength, 0.865}};
}

Traffic::Traffic(World& world, const StreetPlan& plan, const Stock& stock, const Trajectory& ego,
                 double duration_s, std::uint64_t seed)
    : world_(world), plan_(plan), stock_(stock), duration_s_(duration_s), random_(seed, 7) {
  for (double time = -kBefore; time < duration_s + kBefore + kSampling; time += kSampling)
    times_.push_back(time);
  Track ego_track;
  for (const double time : times_) {
    ego_track.footprints.push_back(footprintOfEgo(ego, time));
    ego_track.extent.extend(ego_track.footprints.back().centre);
  }
  tracks_.push_back(std::move(ego_track));
  for (const Actor& actor : world.actors) tracks_.push_back(trackOf(actor));
}

Traffic::Track Traffic::trackOf(const Actor& actor) const {
  Track track;
  for (const double time : times_) {
    track.footprints.push_back(footprintOf(actor, time));
    track.extent.extend(track.footprints.back().centre);
    if (dynamic_cast<const Standing*>(actor.trajectory.get()) != nullptr) break;
  }
  return track;
}

bool Traffic::meet(const Track& a, const Track& b) {
  const double reach = a.footprints[0].half.norm() + b.footprints[0].half.norm() + 2.0 * kMargin;
  if (a.extent.exteriorDistance(b.extent) > reach) return false;
  const std::size_t count = std::max(a.footprints.size(), b.footprints.size());
  for (std::size_t i = 0; i < count; ++i)
    if (overlap(a.footprints[std::min(i, a.footprints.size() - 1)],
                b.footprints[std::min(i, b.footprints.size() - 1)], kMargin))
      return true;
  return false;
}

bool Traffic::add(Actor actor) {
  Track track = trackOf(actor);
  for (const Track& other : tracks_)
    if (meet(track, other)) return false;
  tracks_.push_back(std::move(track));
  world_.actors.push_back(std::move(actor));
  return true;
}

bool Traffic::addVehicle(const std::shared_ptr<const Model>& model, const std::shared_ptr<const Path>& path,
                         const SpeedProfile& profile, double start) {
  const Palette palette = randomPalette(*model, random_);
  PathTrajectory::Options options;
  options.start = start + model->rear_axle_x;
  options.rear_axle_x = model->rear_axle_x;
  options.wheelbase = wheelbaseOf(*model);
  options.odometer = random_.uniform(0.0, 5.0);
  return add({model, std::make_shared<PathTrajectory>(path, profile, options), palette});
}

bool Traffic::addWalker(const std::shared_ptr<const Path>& path, const SpeedProfile& profile, double start,
                        double odometer) {
  const std::shared_ptr<const Model>& model = pick(stock_.pedestrians, random_);
  const PathTrajectory::Options options{
      start, 0.0, 0.0, plan_.groundHeight(path->at(0.0).position), heightSteps(plan_, *path), odometer};
  return add(
      {model, std::make_shared<PathTrajectory>(path, profile, options), randomPalette(*model, random_)});
}

bool Traffic::addStandingPerson(const Vector2d& place, double yaw) {
  const std::shared_ptr<const Model>& model = pick(stock_.pedestrians, random_);
  const Eigen::Isometry3d pose = poseAt(place.x(), place.y(), plan_.groundHeight(place), yaw);
  return add({model, std::make_shared<Standing>(pose), randomPalette(*model, random_)});
}

void Traffic::addPlatoon(const Stock::Models& models, const std::shared_ptr<const Path>& path,
                         const SpeedProfile& leader, double start, double headway) {
  double place = start;  // of the middle of the vehicle, before the delay
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (i > 0) place -= 0.5 * (lengthOf(models[i - 1]) + lengthOf(models[i])) + kGap;
    if (models[i] == nullptr) continue;
    const double delay = headway * static_cast<double>(i);
    // At time 0 it has yet to make up for the delay.
    addVehicle(models[i], path, leader.delayed(delay), place + leader.distance(-delay));
  }
}

void Traffic::addPlatoonWithEgo(const Stock::Models& ahead, const Stock::Models& behind,
                                const std::shared_ptr<const Path>& path, const SprungTrajectory& ego,
                                double headway) {
  Stock::Models models = ahead;
  models.push_back(nullptr);
  models.insert(models.end(), behind.begin(), behind.end());
  double start = ego.along(0.0) + kEgoMiddle;
  for (std::size_t i = 0; i < ahead.size(); ++i)
    start += 0.5 * (lengthOf(models[i]) + lengthOf(models[i + 1])) + kGap;
  const double advance = headway * static_cast<double>(ahead.size());
  const SpeedProfile leader = ego.profile().delayed(-advance);
  addPlatoon(models, path, leader, start - leader.distance(-advance), headway);
}

const std::shared_ptr<const Model>& Traffic::anyVehicle() {
  const double kind = random_.uniform();
  if (kind < 0.82) return pick(stock_.cars, random_);
  if (kind < 0.92) return pick(stock_.vans, random_);
  return kind < 0.97 ? pick(stock_.trucks, random_) : pick(stock_.buses, random_);
}

double Traffic::queueLength(double duration_s, double speed, double headway) {
  constexpr double kRoomy = 1.15;  // a truck or a bus may be among them
  return 8.0 + kRoomy * kQueueSpacing * (3.0 + (duration_s + 2.0) / (headway + kQueueSpacing / speed));
}

void Traffic::addStream(const std::shared_ptr<const Path>& path, const Stream& stream) {
  constexpr double kRampTime = 4.0;  // s, from a standstill and to it
  const double spacing = stream.speed * stream.headway;
  // The wave in which the waiting ones set off runs against the traffic and reaches `begin` at time 0.
  const double ahead = stream.speed * stream.arrival;
  const double travelled = std::max(0.0, stream.end - ahead - stream.begin) / (1.0 + kQueueSpacing / spacing);
  const double way = travelled + ahead;
  const double time = way / stream.speed + kRampTime;
  const int count = static_cast<int>(travelled / spacing) + 2 +
                    static_cast<int>((duration_s_ + 2.0) / (stream.headway + kQueueSpacing / stream.speed));
  Stock::Models models;
  for (int i = 0; i < count; ++i) models.push_back(anyVehicle());
  SpeedProfileBuilder leader(stream.arrival - time, 0.0);
  leader.change(stream.speed, kRampTime).keep(time - 2.0 * kRampTime).change(0.0, kRampTime);
  const SpeedProfile profile = leader.build();
  addPlatoon(models, path, profile, stream.end - profile.distance(stream.arrival), stream.headway);
}

bool Traffic::addPavementWalker(const Street& street, double side, double x) {
  // Who comes towards one walks on another track, as people do.
  constexpr double kTracks[] = {1.3, 2.05, 2.8};  // m behind the kerb
  const int track = random_.index(3);
  const double y = side * (street.profile.halfRoad() + kTracks[track] + random_.uniform(-0.06, 0.06));
  const double direction = track == 1 ? (random_.chance(0.5) ? 1.0 : -1.0) : (track == 0 ? side : -side);
  const double speed = random_.uniform(0.9, 1.7);
  // Not through the buildings at the ends of the street.
  const double goal = x + direction * (speed * (duration_s_ + 1.0) + 1.0);
  if (goal < 2.0 || goal > street.length - 2.0) return false;
  const double start = x - 2.0 * direction;
  const auto path =
      std::make_shared<Path>(Path::through({street.place(start, y), street.place(goal, y)}, 1.0));
  return addWalker(path, SpeedProfile::constant(speed), 2.0, random_.uniform(0.0, 5.0));
}

void Traffic::populatePavements(const Street& street, double low, double high, double spacing) {
  constexpr int kAttempts = 8;
  for (const double side : {-1.0, 1.0}) {
    for (double x = low + random_.uniform(0.0, spacing); x < high; x += spacing * random_.uniform(0.4, 1.6)) {
      if (random_.chance(0.1)) {
        const double y = side * (street.profile.halfRoad() + random_.uniform(1.3, 2.8));
        addStandingPerson(street.place(x, y), random_.uniform(-kPi, kPi));
        continue;
      }
      for (int i = 0; i < kAttempts; ++i)
        if (addPavementWalker(street, side, x + random_.uniform(-0.5, 0.5) * spacing)) break;
    }
  }
}

bool Traffic::addCrossing(const Street& street, double x, bool from_right, double start_time, double speed) {
  const double outer = street.profile.halfRoad() + random_.uniform(0.7, 1.0);
  const double track = street.profile.halfRoad() + random_.uniform(1.3, 2.8);
  const double side = from_right ? -1.0 : 1.0;
  const double direction = random_.chance(0.5) ? 1.0 : -1.0;
  const double onward = speed * (duration_s_ + 2.0);
  const double last = std::clamp(x + direction * onward, 2.0, street.length - 2.0);
  const auto path = std::make_shared<Path>(Path::through(
      {street.place(x, side * outer), street.place(x, -side * track), street.place(last, -side * track)},
      0.8));
  SpeedProfileBuilder profile(start_time, 0.0);
  profile.change(speed, 0.7);
  if (path->length() > 6.0 + speed) profile.stopAfter(path->length() - 1.0 - profile.travelled(), 1.0);
  const SpeedProfile walk = profile.build();
  // Begins to walk with its legs together.
  const double walked = -walk.distance(start_time);
  return addWalker(path, walk, walked, walked);
}

}  // namespace radar_dot::simulation
