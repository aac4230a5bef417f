// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <vector>

#include "radar_dot/common/random_stream.h"
#include "radar_dot/simulation/world.h"
#include "simulation/bodies/stock.h"
#include "simulation/scenarios/path_trajectory.h"
#include "simulation/street/street_plan.h"

namespace radar_dot::simulation {

inline constexpr double kEgoMiddle = 1.25;  ///< m, of the ego ahead of base_link

/// Rectangle of a body on the ground at one time.
struct Footprint {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  Eigen::Vector2d forward = Eigen::Vector2d::UnitX();
  Eigen::Vector2d half = Eigen::Vector2d::Zero();  ///< m, along and across
};
/// @param margin m, that both keep around themselves.
bool overlap(const Footprint& a, const Footprint& b, double margin);
Footprint footprintOf(const Actor& actor, double time_s);
Footprint footprintOfEgo(const Trajectory& ego, double time_s);

/// Puts actors into a world, none of which ever touches another or the ego during the drive.
class Traffic {
 public:
  /// All must outlive it. Parked actors that are in the world already are obstacles.
  Traffic(World& world, const StreetPlan& plan, const Stock& stock, const Trajectory& ego, double duration_s,
          std::uint64_t seed);

  /// Adds the actor unless it would meet another. Says whether it did.
  bool add(Actor actor);
  bool addVehicle(const std::shared_ptr<const Model>& model, const std::shared_ptr<const Path>& path,
                  const SpeedProfile& profile, double start);
  /// Steps on and off the kerbs on its way.
  bool addWalker(const std::shared_ptr<const Path>& path, const SpeedProfile& profile, double start,
                 double odometer);
  bool addStandingPerson(const Eigen::Vector2d& place, double yaw);

  /// A platoon: every vehicle does what the one ahead did, `headway` s later and a vehicle's length behind
  /// (Newell's car-following). The middle of the leader is at `start` m of the path at time 0. A null
  /// pointer leaves a place for the ego.
  void addPlatoon(const Stock::Models& models, const std::shared_ptr<const Path>& path,
                  const SpeedProfile& leader, double start, double headway);
  /// The same around the ego, which follows the same path; the foremost comes first.
  void addPlatoonWithEgo(const Stock::Models& ahead, const Stock::Models& behind,
                         const std::shared_ptr<const Path>& path, const SprungTrajectory& ego,
                         double headway);
  /// Vehicles that fill a way at time 0; more come out of a queue that waits before it, and those that
  /// arrive at its end queue there.
  struct Stream {
    double begin = 0.0;    ///< m along the path
    double end = 0.0;      ///< m along the path, where the first one comes to rest
    double speed = 10.0;   ///< m/s
    double headway = 2.0;  ///< s, of the start from the queue; on the way 7 m more
    double arrival = 0.0;  ///< s, of the first one at the end
  };
  void addStream(const std::shared_ptr<const Path>& path, const Stream& stream);
  /// m, that each of the queues of a stream takes at most.
  static double queueLength(double duration_s, double speed, double headway);
  /// Walkers on both pavements between two places of a street, both ways. @param spacing m, mean.
  void populatePavements(const Street& street, double low, double high, double spacing);
  /// Crosses the street at `x`, from right to left or back, starting to walk at a time; goes on along
  /// the pavement.
  bool addCrossing(const Street& street, double x, bool from_right, double start_time, double speed);

  RandomStream& random() noexcept { return random_; }
  const std::shared_ptr<const Model>& anyVehicle();

 private:
  struct Track {
    std::vector<Footprint> footprints;  ///< at sample times, or one if it stands
    Eigen::AlignedBox2d extent;
  };
  Track trackOf(const Actor& actor) const;
  bool addPavementWalker(const Street& street, double side, double x);
  static bool meet(const Track& a, const Track& b);

  World& world_;
  const StreetPlan& plan_;
  const Stock& stock_;
  double duration_s_;
  RandomStream random_;
  std::vector<double> times_;
  std::vector<Track> tracks_;
};

}  // namespace radar_dot::simulation
