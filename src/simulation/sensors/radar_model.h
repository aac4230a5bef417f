// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace radar_dot::simulation {

/// One of the two scans that a radar interleaves: a wide one and a narrow one that reaches far. Both go
/// into one list, the wide one first.
struct RadarScanModel {
  double traced_azimuth = 1.25;       ///< rad, half width of the ray fan; what lies outside is never seen
  double valid_azimuth = 1.045;       ///< rad, beyond it a return is "outside the field of view"
  double azimuth_step = 0.011;        ///< rad, between rays
  double elevation_low = -0.14;       ///< rad, of the lowest ray
  double elevation_high = 0.14;       ///< rad, of the highest
  double max_range = 130.0;           ///< m; largest real range 130 (wide), 258 (narrow)
  double range_cell = 0.65;           ///< m, two surfaces closer than this give one echo
  double azimuth_cell = 0.065;        ///< rad on boresight, grows as 1/cos; real neighbours: 1.9 m, median
  double azimuth_loss = 4.0;          ///< dB per rad^2, antenna pattern; real: 80 % within +-33 degrees
  double sensitive_range = 80.0;      ///< m; up to there the threshold is min_rcs, then +40 dB per decade
  double threshold_offset = 0.0;      ///< dB, on top of RadarModel::threshold_offset
  double near_loss = 0.0;             ///< dB per decade that the threshold rises from 50 m towards the radar
  double near_loss_range = 50.0;      ///< m
  double edge_azimuth = 0.94;         ///< rad, beyond it the antenna pattern falls by edge_loss
  double edge_loss = 30.0;            ///< dB per rad
  double range_deviation = 0.1;       ///< m
  double azimuth_deviation = 0.0045;  ///< rad on boresight, grows as 1/cos^2
};

/// Real returns of the narrow scan: within 12.7 degrees, "outside the field of view" beyond 9; from 18 to
/// 147 m (10 and 90 %), half beyond 48 m; 6 % (front), 10 % (back) and 17 % (side) of all.
inline RadarScanModel narrowScan() {
  RadarScanModel scan;
  scan.traced_azimuth = 0.2215;
  scan.valid_azimuth = 0.157;
  scan.azimuth_step = 0.0065;
  scan.elevation_low = -0.05;
  scan.elevation_high = 0.07;
  scan.max_range = 258.0;
  scan.range_cell = 1.8;
  scan.azimuth_cell = 0.024;
  scan.azimuth_loss = 20.0;
  scan.sensitive_range = 150.0;
  scan.threshold_offset = 3.0;
  scan.near_loss = 12.0;
  scan.edge_azimuth = 0.14;
  scan.range_deviation = 0.25;
  scan.azimuth_deviation = 0.0035;
  return scan;
}

/// What turns surfaces into returns: every number that was matched to real scans stands here, with the
/// real figure it was matched to (6 scenes, 7868 scans of the nuScenes car; "long" are the front and
/// the two back radars, "side" the two that look sideways).
struct RadarModel {
  RadarScanModel wide;
  RadarScanModel narrow = narrowScan();

  // How many. Real: 118 returns per scan (long), 46 (side), 89.5 overall; never more than 125, since
  // the list is cut there: of sorted ranges, so that the far ones go.
  int max_returns = 125;
  /// dB, the knob for the number of returns: higher gives fewer.
  double threshold_offset = 0.0;
  double min_rcs = -5.0;  ///< dBsm; smallest real value, range does not matter up to sensitive_range
  double threshold_softness = 1.0;  ///< dB, over which detection becomes certain
  /// Within so many cells of a stronger echo, others show with this probability only.
  double neighbour_ranges = 3.0;
  double neighbour_azimuths = 2.0;
  double neighbour_chance = 0.25;
  /// Multipath copies behind what reflects, per return.
  double multipath_rate = 0.35;
  double multipath_length = 14.0;  ///< m, mean extra range
  double multipath_loss = 4.0;     ///< dB
  /// Weak returns of detail that no world models (grates, hedges, rubbish) and of long ways around: they
  /// move like the static world. Real: also a radar that faces a wall lists returns at 40 to 90 m; 45 %
  /// (side) and 24 % (long) of all returns are of 0 dBsm or less.
  double detail_rate = 33.0;             ///< per scan, before detection
  double detail_range = 42.0;            ///< m, median
  double detail_range_deviation = 0.65;  ///< of its logarithm
  double detail_azimuth = 0.6;           ///< rad, deviation
  double detail_rcs = 3.5;               ///< dB, mean above min_rcs
  /// Returns of nothing, per scan, anywhere; real share of valid returns that fit neither the static
  /// world nor a road user is below 2 %.
  double clutter_rate = 1.5;
  /// Fraction of returns whose velocity is folded wrongly; real: 1.7 % (long), 2.1 % (side).
  double folded_share = 0.018;
  double folded_deviation = 6.0;  ///< m/s

  // How strong, dBsm. Real 10, 50, 90 %: -2.5, 5, 17.5 (long), -4, 0.5, 10.5 (side).
  double rcs_offset = -1.5;  ///< on every material
  /// On surfaces seen by radars that look sideways, else the houses beside the road would fill their lists.
  /// Real medians at 20 to 40 m: 1.5 (side), 4.5 (long).
  double sideways_rcs_offset = -10.0;
  double surface_deviation = 6.0;      ///< dB, between spots of a surface; stays with the spot
  double surface_spot = 0.6;           ///< m, size of such a spot
  double fluctuation_deviation = 3.0;  ///< dB, between scans
  double incidence_span = 12.0;        ///< dB, from grazing to normal incidence
  double specular_gain = 8.0;          ///< dB, within specular_cosine of the normal
  double specular_cosine = 0.985;
  /// dB per decade of range beyond and before 40 m: far cells hold more surface. Real: 3 % of the returns
  /// within 10 m, half beyond 45 m.
  double growth_with_range = 18.0;
  double near_range = 20.0;   ///< m, closer than this a target overfills the beam
  double near_growth = 15.0;  ///< dB per decade, more growth within near_range

  // How exact. Real sigma of static valid returns: 0.142 m/s overall; 0 while standing, 0.12 at 1 m/s,
  // 0.14 at 8 m/s, 0.18 where 10 m/s go across the bearing. Quantisation and bearing error make the rest.
  double doppler_deviation = 0.02;    ///< m/s, of a standing radar
  double doppler_spread = 0.105;      ///< m/s, added once the radar moves at spread_speed or more
  double spread_speed = 0.7;          ///< m/s
  double weak_doppler_factor = 1.5;   ///< for returns within a few dB of the threshold
  double yaw_rate_deviation = 0.004;  ///< rad/s, of the yaw rate the radar is told; real 0.005
  double speed_deviation = 0.02;      ///< m/s, of the speed it is told
  double velocity_step = 0.25;        ///< m/s, of vx and vy
  double position_step = 0.2;         ///< m, of x and y
  double rcs_step = 0.5;              ///< dBsm
  /// vy of a return taken for static is -yaw_rate (x + this): the radars believe that they sit there
  /// ahead of the rear axle and look ahead, wherever they are. Real: 3.3 for all five.
  double assumed_lever_arm = 3.3;  ///< m
  double stationary_speed = 0.8;   ///< m/s, over ground: slower is taken for static
};

}  // namespace radar_dot::simulation
