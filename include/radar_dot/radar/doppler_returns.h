// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "radar_dot/common/enum_names.h"
#include "radar_dot/common/fields.h"
#include "radar_dot/radar/point_cloud.h"

namespace radar_dot {

/// One radar return in the frame of the sensor that measured it.
struct DopplerReturn {
  Eigen::Vector3f bearing = Eigen::Vector3f::UnitX();  ///< unit vector from the sensor to the return
  float range = 0.F;                                   ///< m
  float doppler = 0.F;                                 ///< range rate, m/s: positive when the range grows
  /// m/s, of the reported velocity vector across the bearing, positive to its left; 0 where the cloud gives
  /// a range rate alone.
  float tangential_speed = 0.F;
  std::uint32_t index = 0;  ///< record in the cloud it came from
};

/// Where a return lies, m, base frame.
inline Eigen::Vector3f positionOf(const DopplerReturn& seen, const Eigen::Isometry3d& T_base_from_sensor) {
  return T_base_from_sensor.cast<float>() * (seen.range * seen.bearing);
}

/// Which returns take part. A list that is empty accepts every value; a field that the cloud does
/// not have switches its filter off, unless a parameter names the field.
struct ReturnFilter {
  static constexpr double kInfinity = std::numeric_limits<double>::infinity();
  double min_range = 0.5;
  double max_range = 250.0;
  double min_azimuth = -kInfinity;
  double max_azimuth = kInfinity;
  double min_elevation = -kInfinity;
  double max_elevation = kInfinity;
  double min_height = -kInfinity;
  double max_height = kInfinity;
  double min_rcs = -kInfinity;
  double max_rcs = kInfinity;
  std::string snr_field;
  double min_snr = -kInfinity;
  std::vector<int> invalid_states = {0};
  std::vector<int> ambig_states = {3};
  std::vector<int> pdh0_states = {1};
  std::string flag_field;
  std::vector<int> accepted_flags;

  void describe(FieldList& fields) {
    fields.add("min_range", min_range, "Nearest return that is used", "m", {0.0, 1000.0});
    fields.add("max_range", max_range, "Farthest return that is used", "m", {0.0, 10000.0});
    fields.add("min_azimuth", min_azimuth, "Begin of the field of view in the sensor frame", "rad");
    fields.add("max_azimuth", max_azimuth,
               "End of the field of view in the sensor frame, which is not part of it", "rad");
    fields.add("min_elevation", min_elevation, "Lower end of the field of view in the sensor frame", "rad");
    fields.add("max_elevation", max_elevation, "Upper end of the field of view in the sensor frame", "rad");
    fields.add("min_height", min_height, "Lowest return that is used, above the origin of base_frame", "m");
    fields.add("max_height", max_height, "Highest return that is used, above the origin of base_frame", "m");
    fields.add("min_rcs", min_rcs, "Weakest return that is used, where the cloud has a field rcs", "dBsm");
    fields.add("max_rcs", max_rcs, "Strongest return that is used, where the cloud has a field rcs", "dBsm");
    fields.add("snr_field", snr_field,
               "Field that min_snr is compared with; empty: the first of snr, snr_db, power, amplitude that "
               "exists");
    fields.add("min_snr", min_snr,
               "Least signal-to-noise ratio, or power, of a return that is used, in the unit of its field",
               "dB");
    describeStates(fields);
  }
  void describeStates(FieldList& fields) {
    const Range byte{0, 255};
    fields.add("invalid_states", invalid_states,
               "Accepted values of the field invalid_state of Continental radars, as in 0, 4; empty: all. 0: "
               "valid; the others are mostly ghosts and noise",
               "", byte);
    fields.add("ambig_states", ambig_states,
               "Accepted values of the field ambig_state; empty: all. 3: unambiguous Doppler", "", byte);
    fields.add("pdh0_states", pdh0_states,
               "Accepted values of the field pdh0; empty: all. 1: false-alarm probability below 25 %", "",
               byte);
    fields.add("flag_field", flag_field, "Field of whole numbers that accepted_flags is about; empty: none");
    fields.add("accepted_flags", accepted_flags, "Accepted values of flag_field; empty: all");
  }
};

/// Of the angles of polar clouds.
enum class AngleUnit { kRadians, kDegrees };
template <>
struct EnumNames<AngleUnit> {
  static constexpr EnumName<AngleUnit> kValues[] = {{AngleUnit::kRadians, "radians"},
                                                    {AngleUnit::kDegrees, "degrees"}};
};

/// How to find range, bearing and Doppler in a cloud.
struct ExtractionParams {
  std::string doppler_field;
  // Sensors may read low: returns from above or below the antenna plane are foreshortened by the cosine of
  // their elevation, which a planar radar cannot see.
  double doppler_scale = 1.0;
  AngleUnit angle_unit = AngleUnit::kRadians;
  // Of two 4D radars on the road the Doppler follows v cos(azimuth) better than with the measured elevation
  // (inliers 98 against 93 %, 88 against 85 %).
  bool use_elevation = true;
  ReturnFilter filter;

  void describe(FieldList& fields) {
    fields.add("doppler_field", doppler_field,
               "Field of the cloud with the range rate, m/s; empty: the first of doppler, doppler_velocity, "
               "radial_velocity, range_rate, radial_speed, v_doppler_mps, v_r, vr, vrad, rdot, "
               "radar_relative_radial_velocity, velocity that exists, else the projection of (vx, vy, vz) or "
               "(vx, vy), else vel or speed. Names are compared without case");
    fields.add(
        "doppler_scale", doppler_scale,
        "Factor on the range rate of every radar without a doppler_scale of its own; -1 where the driver "
        "counts approaching targets as positive",
        "", {-10.0, 10.0});
    fields.add("angle_unit", angle_unit,
               "Of azimuth and elevation in clouds without x and y, which have range, azimuth and elevation");
    fields.add("use_elevation", use_elevation,
               "Use the measured elevation of returns; without it their bearings lie in the x-y plane of the "
               "sensor, which is better where elevations are poor");
    filter.describe(fields);
  }
};
/// @throws InvalidParameter, also for limits in the wrong order and a scale of zero
void validate(const ExtractionParams& params);

/// Why returns were left out, counted per scan; `accepted` and all others add up to `total`.
struct ExtractionCounts {
  std::size_t total = 0;
  std::size_t accepted = 0;
  std::size_t not_finite = 0;  ///< NaN, infinite, or farther or faster than any radar measures
  std::size_t out_of_range = 0;
  std::size_t out_of_azimuth = 0;
  std::size_t out_of_elevation = 0;
  std::size_t out_of_height = 0;
  std::size_t rcs = 0;
  std::size_t snr = 0;
  std::size_t invalid_state = 0;
  std::size_t ambig_state = 0;
  std::size_t pdh0 = 0;
  std::size_t flag = 0;
};

/// Reads Doppler returns out of clouds by field name, without case; resolves the names once per layout, so
/// that a stream of equal clouds costs no look-ups and no allocation.
///
/// A velocity vector is projected on the line of sight: in nuScenes (vx, vy) is not radial, so its norm is
/// not the Doppler velocity. Without vz it is taken as the horizontal velocity that it is in lists of
/// clusters and objects. Compensated fields (vx_comp, v_r_compensated, ground_relative_radial_velocity,
/// recoveredSpeed) are never chosen: they hold the vehicle's own odometry. Nor are v and h, which are the
/// range rate of one radar and something else of another: doppler_field names them.
class DopplerExtractor {
 public:
  explicit DopplerExtractor(ExtractionParams params = {});

  /// Replaces `returns` by the accepted returns of `cloud`. A cloud without z is planar.
  /// @param T_base_from_sensor  for the limits on height, which are not applied without it
  /// @throws std::invalid_argument with all of faults()
  ExtractionCounts extract(const PointCloudView& cloud, std::vector<DopplerReturn>& returns,
                           const Eigen::Isometry3d* T_base_from_sensor = nullptr);

  /// All that clouds of this layout lack, each with the parameter that cures it where there is one, and last
  /// the fields at hand. Empty: they can be read.
  const std::vector<std::string>& faults(const PointCloudView& cloud);

  /// Where the range rates of the latest layout come from, as in "field 'vr'"; empty: no cloud yet, or
  /// faults.
  const std::string& dopplerSource() const noexcept { return layout_.doppler_source; }

  const ExtractionParams& params() const noexcept { return params_; }

 private:
  struct Column {
    std::ptrdiff_t offset = -1;  ///< -1: not in the cloud
    ScalarType type = ScalarType::kFloat32;
    bool present() const noexcept { return offset >= 0; }
    double read(const std::uint8_t* point) const noexcept { return readScalar(point + offset, type); }
  };
  struct Layout {
    std::vector<PointField> fields;
    std::size_t point_step = 0;
    Column x, y, z, vx, vy, vz, doppler, rcs, snr, invalid_state, ambig_state, pdh0, flag;
    std::string doppler_source;
    std::vector<std::string> faults;
  };
  class Resolver;
  using Count = std::size_t ExtractionCounts::*;
  /// @return accepted, or why it is not
  Count readReturn(const std::uint8_t* point, const Eigen::Isometry3d* T_base_from_sensor,
                   DopplerReturn& seen) const;
  Count checkStates(const std::uint8_t* point) const;

  ExtractionParams params_;
  Layout layout_;
};

}  // namespace radar_dot
