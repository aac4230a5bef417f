// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/doppler_returns.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <stdexcept>

namespace radar_dot {
namespace {

constexpr double kFarthest = 1e5;  // m
constexpr double kFastest = 1e3;   // m/s

}  // namespace

void validate(const ExtractionParams& params) {
  const FieldList fields = fieldsOf(params);
  checkFields(fields);
  require(params.doppler_scale != 0.0, fields, {&params.doppler_scale}, "it must not be zero");
  const ReturnFilter& filter = params.filter;
  requireLess(fields, filter.min_range, filter.max_range);
  requireLess(fields, filter.min_azimuth, filter.max_azimuth);
  requireLess(fields, filter.min_elevation, filter.max_elevation);
  requireLess(fields, filter.min_height, filter.max_height);
  requireLess(fields, filter.min_rcs, filter.max_rcs);
  require(filter.accepted_flags.empty() || !filter.flag_field.empty(), fields,
          {&filter.accepted_flags, &filter.flag_field}, "the values need the name of their field");
}

/// Finds the columns of a layout by name, and collects what is wrong.
class DopplerExtractor::Resolver {
 public:
  Resolver(const ExtractionParams& params, Layout& layout) : params_(params), layout_(layout) {
    layout.x = required("x", "position, else by range and azimuth");
    layout.y = required("y", "position, else by range and azimuth");
    layout.z = column("z");
    resolveDoppler();
    const ReturnFilter& filter = params.filter;
    layout.rcs = column("rcs");
    if (!filter.snr_field.empty()) {
      layout.snr = required(filter.snr_field, "parameter snr_field");
    } else if (filter.min_snr > -ReturnFilter::kInfinity) {
      layout.snr = firstOf({"snr", "snr_db", "power", "amplitude"});
    }
    layout.invalid_state = column("invalid_state");
    layout.ambig_state = column("ambig_state");
    layout.pdh0 = column("pdh0");
    if (!filter.flag_field.empty()) layout.flag = required(filter.flag_field, "parameter flag_field");

    if (layout.faults.empty()) return;
    layout.faults.push_back("its fields are: " + fieldNames(layout.fields));
    layout.doppler_source.clear();
  }

 private:
  /// A field that cannot be read is a fault, and counts as present otherwise.
  Column column(std::string_view name) {
    found_ = findFieldAnyCase(layout_.fields, name);
    if (found_ == nullptr) return {};
    if (std::string defect = defectOf(*found_, layout_.point_step); !defect.empty())
      layout_.faults.push_back(std::move(defect));
    return {static_cast<std::ptrdiff_t>(found_->offset), found_->type};
  }

  Column required(std::string_view name, const char* use) {
    const Column result = column(name);
    if (!result.present())
      layout_.faults.push_back(fmt::format("the cloud has no field '{}' ({})", std::string(name), use));
    return result;
  }

  Column firstOf(std::initializer_list<const char*> names) {
    const PointField* field = findFirstField(layout_.fields, names);
    found_ = nullptr;
    return field != nullptr ? column(field->name) : Column{};
  }

  void resolveDoppler() {
    Layout& layout = layout_;
    if (!params_.doppler_field.empty()) {
      layout.doppler = required(params_.doppler_field, "parameter doppler_field");
    } else {
      layout.doppler = firstOf({"doppler", "doppler_velocity", "radial_velocity", "range_rate",
                                "radial_speed", "v_doppler_mps", "v_r", "vr", "vrad", "rdot",
                                "radar_relative_radial_velocity", "velocity"});
    }
    if (found_ == nullptr && params_.doppler_field.empty()) {
      layout.vx = column("vx");
      layout.vy = column("vy");
      if (layout.vx.present() && layout.vy.present()) {
        layout.vz = column("vz");
        layout.doppler_source = layout.vz.present() ? "(vx, vy, vz)" : "(vx, vy)";
        layout.doppler_source += " on the line of sight";
        return;
      }
      // Beside a vector these would be its length.
      layout.doppler = firstOf({"vel", "speed"});
      if (found_ == nullptr) {
        layout.faults.emplace_back(
            "none of its fields has the name of a range rate, nor are there 'vx' and 'vy': set "
            "doppler_field");
      }
    }
    if (found_ != nullptr) layout.doppler_source = "field '" + found_->name + "'";
  }

  const ExtractionParams& params_;
  Layout& layout_;
  const PointField* found_ = nullptr;  // by the latest look-up
};

DopplerExtractor::DopplerExtractor(ExtractionParams params) : params_(std::move(params)) {
  validate(params_);
}

const std::vector<std::string>& DopplerExtractor::faults(const PointCloudView& cloud) {
  if (cloud.fields == nullptr) throw std::invalid_argument("the cloud has no fields");
  if (layout_.fields.empty() || layout_.point_step != cloud.point_step || layout_.fields != *cloud.fields) {
    layout_ = Layout{};
    layout_.fields = *cloud.fields;
    layout_.point_step = cloud.point_step;
    Resolver(params_, layout_);
  }
  return layout_.faults;
}

ExtractionCounts DopplerExtractor::extract(const PointCloudView& cloud, std::vector<DopplerReturn>& returns,
                                           const Eigen::Isometry3d* T_base_from_sensor) {
  returns.clear();
  if (!faults(cloud).empty()) throw std::invalid_argument(fmt::format("{}", fmt::join(layout_.faults, "; ")));
  ExtractionCounts counts;
  counts.total = cloud.size();
  DopplerReturn seen;
  for (std::size_t i = 0; i < counts.total; ++i) {
    seen.index = static_cast<std::uint32_t>(i);
    const Count count = readReturn(cloud.point(i), T_base_from_sensor, seen);
    ++(counts.*count);
    if (count == &ExtractionCounts::accepted) returns.push_back(seen);
  }
  return counts;
}

DopplerExtractor::Count DopplerExtractor::checkStates(const std::uint8_t* point) const {
  const auto refuses = [point](const Column& column, const std::vector<int>& accepted) {
    return column.present() && !accepted.empty() &&
           std::find(accepted.begin(), accepted.end(), column.read(point)) == accepted.end();
  };
  const ReturnFilter& filter = params_.filter;
  if (refuses(layout_.invalid_state, filter.invalid_states)) return &ExtractionCounts::invalid_state;
  if (refuses(layout_.ambig_state, filter.ambig_states)) return &ExtractionCounts::ambig_state;
  if (refuses(layout_.pdh0, filter.pdh0_states)) return &ExtractionCounts::pdh0;
  if (refuses(layout_.flag, filter.accepted_flags)) return &ExtractionCounts::flag;
  return &ExtractionCounts::accepted;
}

DopplerExtractor::Count DopplerExtractor::readReturn(const std::uint8_t* point,
                                                     const Eigen::Isometry3d* T_base_from_sensor,
                                                     DopplerReturn& seen) const {
  if (const Count refusal = checkStates(point); refusal != &ExtractionCounts::accepted) return refusal;
  const Layout& layout = layout_;
  const double x = layout.x.read(point);
  const double y = layout.y.read(point);
  const double z = layout.z.present() ? layout.z.read(point) : 0.0;
  const double range = std::sqrt(x * x + y * y + z * z);
  const bool is_flat = z == 0.0 || !params_.use_elevation;
  const double distance = std::hypot(x, y);                      // in the x-y plane
  const double norm = params_.use_elevation ? range : distance;  // of the bearing
  double doppler = 0.0;
  double tangential_speed = 0.0;
  if (layout.doppler.present()) {
    doppler = params_.doppler_scale * layout.doppler.read(point);
  } else {
    const double vx = layout.vx.read(point);
    const double vy = layout.vy.read(point);
    double product = x * vx + y * vy;
    if (layout.vz.present() && !is_flat) product += z * layout.vz.read(point);
    doppler = params_.doppler_scale / (is_flat ? distance : range) * product;
    if (distance > 0.0) tangential_speed = params_.doppler_scale / distance * (x * vy - y * vx);
  }
  // NaN fails every comparison; values that no radar measures would overflow further on.
  if (!(range < kFarthest) || !(norm > 0.0) || !(std::abs(doppler) < kFastest) ||
      !(std::abs(tangential_speed) < kFastest))
    return &ExtractionCounts::not_finite;

  const auto outside = [](double value, double low, double high) { return value < low || value > high; };
  const auto is_limit = [](double low, double high) { return std::isfinite(low) || std::isfinite(high); };
  const ReturnFilter& filter = params_.filter;
  if (outside(range, filter.min_range, filter.max_range)) return &ExtractionCounts::out_of_range;
  if (is_limit(filter.min_azimuth, filter.max_azimuth)) {
    const double azimuth = std::atan2(y, x);
    if (azimuth < filter.min_azimuth || azimuth >= filter.max_azimuth)
      return &ExtractionCounts::out_of_azimuth;
  }
  if (is_limit(filter.min_elevation, filter.max_elevation) &&
      outside(std::atan2(z, distance), filter.min_elevation, filter.max_elevation))
    return &ExtractionCounts::out_of_elevation;
  if (T_base_from_sensor != nullptr && is_limit(filter.min_height, filter.max_height)) {
    const Eigen::Matrix4d& T = T_base_from_sensor->matrix();
    if (outside(T(2, 0) * x + T(2, 1) * y + T(2, 2) * z + T(2, 3), filter.min_height, filter.max_height))
      return &ExtractionCounts::out_of_height;
  }
  if (layout.rcs.present() && outside(layout.rcs.read(point), filter.min_rcs, filter.max_rcs))
    return &ExtractionCounts::rcs;
  if (layout.snr.present() && layout.snr.read(point) < filter.min_snr) return &ExtractionCounts::snr;

  seen.bearing = Eigen::Vector3d(x / norm, y / norm, params_.use_elevation ? z / norm : 0.0).cast<float>();
  seen.range = static_cast<float>(range);
  seen.doppler = static_cast<float>(doppler);
  seen.tangential_speed = static_cast<float>(tangential_speed);
  return &ExtractionCounts::accepted;
}

}  // namespace radar_dot
