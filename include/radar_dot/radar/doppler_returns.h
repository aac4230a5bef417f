// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

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
/// not have switches its filter off.
struct ReturnFilter {
  double min_range = 0.5;
  double max_range = 250.0;
  double min_azimuth = -std::numeric_limits<double>::infinity();
  double max_azimuth = std::numeric_limits<double>::infinity();
  double min_rcs = -std::numeric_limits<double>::infinity();
  double max_rcs = std::numeric_limits<double>::infinity();
  std::vector<int> invalid_states = {0};
  std::vector<int> ambig_states = {3};
  std::vector<int> pdh0_states = {1};

  void describe(FieldList& fields) {
    fields.add("min_range", min_range, "Nearest return that is used", "m", {0.0, 1000.0});
    fields.add("max_range", max_range, "Farthest return that is used", "m", {0.0, 10000.0});
    fields.add("min_azimuth", min_azimuth, "Begin of the field of view in the sensor frame", "rad");
    fields.add("max_azimuth", max_azimuth, "End of the field of view in the sensor frame, which is not part of it",
               "rad");
    fields.add("min_rcs", min_rcs, "Weakest return that is used, where the cloud has a field rcs", "dBsm");
    fields.add("max_rcs", max_rcs, "Strongest return that is used, where the cloud has a field rcs", "dBsm");
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
               "Accepted values of the field pdh0; empty: all. 1: false-alarm probability below 25 %", "", byte);
  }
};

/// How to find range, bearing and Doppler in a cloud.
struct ExtractionParams {
  std::string doppler_field;
  // Sensors may read low: returns from above or below the antenna plane are foreshortened by the cosine of
  // their elevation, which a planar radar cannot see.
  double doppler_scale = 1.0;
  ReturnFilter filter;

  void describe(FieldList& fields) {
    fields.add("doppler_field", doppler_field,
               "Field of the cloud with the range rate, m/s; empty: the first of doppler, doppler_velocity, "
               "radial_velocity, range_rate, velocity that exists, else the projection of (vx, vy)");
    fields.add("doppler_scale", doppler_scale,
               "Factor on the range rate of every radar without a doppler_scale of its own; -1 where the driver "
               "counts approaching targets as positive",
               "", {-10.0, 10.0});
    filter.describe(fields);
  }
};
/// @throws InvalidParameter, also for limits in the wrong order and a scale of zero
void validate(const ExtractionParams& params);

/// Why returns were left out, counted per scan; `accepted` and all others add up to `total`.
struct ExtractionCounts {
  std::size_t total = 0;
  std::size_t accepted = 0;
  std::size_t not_finite = 0;
  std::size_t out_of_range = 0;
  std::size_t out_of_azimuth = 0;
  std::size_t rcs = 0;
  std::size_t invalid_state = 0;
  std::size_t ambig_state = 0;
  std::size_t pdh0 = 0;
};

/// Reads Doppler returns out of clouds by field name; resolves the names once per layout, so that a
/// stream of equal clouds costs no look-ups and no allocation.
///
/// From a cloud with (vx, vy) the range rate is (x vx + y vy) / hypot(x, y): in nuScenes (vx, vy)
/// is not radial, so its norm is not the Doppler velocity. Compensated fields (vx_comp, vy_comp)
/// are never used: they hold the vehicle's own odometry.
class DopplerExtractor {
 public:
  explicit DopplerExtractor(ExtractionParams params = {});

  /// Replaces `returns` by the accepted returns of `cloud`. A cloud without z is planar.
  /// @throws std::invalid_argument naming the missing field and the fields at hand.
  ExtractionCounts extract(const PointCloudView& cloud, std::vector<DopplerReturn>& returns);

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
    Column x, y, z, vx, vy, doppler, rcs, invalid_state, ambig_state, pdh0;
    bool resolved = false;
  };
  void resolve(const PointCloudView& cloud);

  ExtractionParams params_;
  Layout layout_;
  std::array<bool, 256> invalid_allowed_{}, ambig_allowed_{}, pdh0_allowed_{};
};

}  // namespace radar_dot
