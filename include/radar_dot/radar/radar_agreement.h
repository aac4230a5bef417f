// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "radar_dot/radar/ego_velocity.h"

namespace radar_dot {

/// Tells which radar contradicts the others, over about the last ten seconds of driving.
///
/// With the yaw errors psi of the mounts, returns obey  r = d + u.(v + w x t) + psi (z x u).(v + w x t).
/// Velocity and yaw rate are eliminated from the normal equations of every sweep that is looked at; what is
/// left, S psi = h, is summed over the sweeps. h_i / S_ii is the yaw by which radar i alone must be turned to
/// fit the motion that the others see, and h_i^2 / S_ii says how much better all returns fit then: the mount
/// that is off is the one that gains the most (data snooping; Baarda, A testing procedure for use in
/// geodetic networks, 1968). The others are taken as known to half a degree. Radars whose gains are alike
/// cannot be told apart.
///
/// Where the returns of a radar do not fit, its yaw is searched over the full circle; half a turn is a range
/// rate of the opposite sign.
///
/// One sweep in 0.3 s is looked at, and of it at most 48 returns per radar.
class RadarAgreement {
 public:
  /// How a radar is configured, for the texts.
  struct Radar {
    std::string name;
    double mount_yaw_correction = 0.0;  ///< rad
    double doppler_scale = 1.0;
  };
  /// What a radar is found to be.
  enum class Verdict : std::uint8_t {
    kGood,       ///< fits, or not known
    kTurned,     ///< its mount is turned
    kReversed,   ///< its range rates have the opposite sign
    kDisagrees,  ///< it contradicts another radar, and nothing tells which of the two is wrong
  };
  /// Figures of one radar; all but the yaw also where it is the only one.
  struct Figures {
    double returns = 0.0;          ///< per scan
    double inlier_share = 0.0;     ///< of the returns, with a residual below inlier_threshold
    double median_residual = 0.0;  ///< m/s, absolute
    /// rad, to be added to the yaw of its mount (as mount_yaw_correction is), and 1 sigma; infinite sigma
    /// where nothing is known.
    double yaw_correction = 0.0, yaw_std = std::numeric_limits<double>::infinity();
    Verdict verdict = Verdict::kGood;
    std::string warning;  ///< what is wrong with figure and remedy, beginning with the radar's name; empty
                          ///< for kGood
  };

  /// @param radars  by RadarScan::radar; others configured than before forget what was seen
  explicit RadarAgreement(std::vector<Radar> radars = {}) { configure(std::move(radars)); }
  void configure(std::vector<Radar> radars);
  void reset();

  /// A sweep with the estimate of EgoVelocityEstimator, valid or not. @param time  s; after a step back
  /// everything is forgotten.
  void add(double time, const std::vector<RadarScan>& scans, const EgoVelocityResult& result,
           const EgoVelocityParams& params);

  const Figures& figures(std::size_t radar) const { return tracks_.at(radar).figures; }
  /// What concerns the whole vehicle: it has driven backwards for long. Empty: nothing.
  const std::string& warning() const noexcept { return warning_; }

 private:
  static constexpr int kReturns = 48;  // of a scan
  static constexpr int kCells = 120;   // of the full circle
  using Column = Eigen::Array<float, kReturns, 1>;

  /// Returns of one scan at the velocity v of its radar: with the bearings turned by psi the residual is
  /// doppler + along cos psi + across sin psi.
  struct Rows {
    Eigen::Index count = 0;
    Column x, y;           // bearing
    Column doppler;        // m/s, less what the vertical velocity adds
    Column along, across;  // m/s, u.v and (z x u).v in the plane
  };
  struct Track {
    Figures figures;
    double weight = 0.0, described = 0.0;  // of the running means: scans, scans with returns
    Eigen::Array<float, kCells, 1> consensus = Eigen::Array<float, kCells, 1>::Zero();
    double searched = 0.0;                // searches in `consensus`
    int cell = 0;                         // where the equations are linearised
    double hh = 0.0, hs = 0.0, ss = 0.0;  // sums of h_i^2, h_i S_ii, S_ii^2 over the sweeps
    std::size_t other = 0;                // whom it disagrees with
    Verdict pending = Verdict::kGood;
    double pending_for = 0.0;  // s of driving
  };
  struct Equations;
  /// Yaw of a radar where those in `turned` are free as well.
  struct Yaw {
    double value = 0.0, std = std::numeric_limits<double>::infinity();  // rad
    double gain = 0.0;                                                  // chi-square
    double widening = 1.0;                                              // variance over that of the model
  };

  void watchDirection(double time, const EgoVelocityResult& result);
  void look(double dt, const std::vector<RadarScan>& scans, const EgoVelocityResult& result,
            const EgoVelocityParams& params);
  void fill(const RadarScan& scan, const float* residuals, const EgoVelocityResult& result);
  void describe(Track& track, std::size_t returns, double inlier_threshold, double decay);
  void search(Track& track, double speed, double decay);
  static bool isGross(const Track& track);
  void addTo(Equations& equations, const RadarScan& scan, const EgoVelocityParams& params,
             double speed) const;
  void learnYaws(const Equations& equations, double decay);
  Yaw yawOf(std::size_t radar, const std::vector<std::size_t>& turned) const;
  void judge(double dt);
  void judgeYaws(const std::vector<std::size_t>& radars, std::vector<Verdict>& verdicts);
  void conclude(std::size_t radar, Verdict verdict, double dt);
  std::string textOf(std::size_t radar) const;

  std::vector<Radar> radars_;
  std::vector<Track> tracks_;
  Eigen::MatrixXd information_;  // S
  Eigen::VectorXd vector_;       // h of the whole yaws, not of what they differ from the cells
  Rows rows_;
  std::vector<float> absolute_;  // m/s, residuals of the rows
  std::size_t phase_ = 0;
  double time_ = -std::numeric_limits<double>::infinity();    // s, of the latest sweep
  double looked_ = -std::numeric_limits<double>::infinity();  // s, of the latest that was looked at
  double backwards_for_ = 0.0;                                // s
  std::string warning_;
};

}  // namespace radar_dot
