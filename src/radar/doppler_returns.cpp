// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/doppler_returns.h"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace radar_dot {
namespace {

// The state fields of a radar are bytes; values outside cannot occur and are never accepted.
std::array<bool, 256> acceptTable(const std::vector<int>& states) {
  std::array<bool, 256> accepted{};
  accepted.fill(states.empty());
  for (const int state : states) accepted[static_cast<std::size_t>(state)] = true;
  return accepted;
}

bool acceptsState(const std::array<bool, 256>& accepted, double state) noexcept {
  return state >= 0.0 && state <= 255.0 && accepted[static_cast<std::size_t>(state)];
}

}  // namespace

void validate(const ExtractionParams& params) {
  const FieldList fields = fieldsOf(params);
  checkFields(fields);
  require(params.doppler_scale != 0.0, fields, {&params.doppler_scale}, "it must not be zero");
  const ReturnFilter& filter = params.filter;
  requireLess(fields, filter.min_range, filter.max_range);
  requireLess(fields, filter.min_azimuth, filter.max_azimuth);
  requireLess(fields, filter.min_rcs, filter.max_rcs);
}

DopplerExtractor::DopplerExtractor(ExtractionParams params) : params_(std::move(params)) {
  validate(params_);
  invalid_allowed_ = acceptTable(params_.filter.invalid_states);
  ambig_allowed_ = acceptTable(params_.filter.ambig_states);
  pdh0_allowed_ = acceptTable(params_.filter.pdh0_states);
}

void DopplerExtractor::resolve(const PointCloudView& cloud) {
  layout_.resolved = false;
  layout_.fields = *cloud.fields;
  layout_.point_step = cloud.point_step;
  const auto column = [this, &cloud](std::string_view name) {
    Column result;
    const PointField* field = findField(layout_.fields, name);
    if (field == nullptr) return result;
    if (scalarSize(field->type) == 0 || field->offset + scalarSize(field->type) > cloud.point_step) {
      throw std::invalid_argument(
          fmt::format("field '{}' (offset {}, type {}) does not fit into points of {} bytes", field->name,
                      field->offset, static_cast<int>(field->type), cloud.point_step));
    }
    result.offset = static_cast<std::ptrdiff_t>(field->offset);
    result.type = field->type;
    return result;
  };
  const auto required = [&](std::string_view name, std::string_view use) {
    const Column result = column(name);
    if (!result.present()) {
      throw std::invalid_argument(fmt::format("the cloud has no field '{}' ({}); its fields are: {}",
                                              std::string(name), std::string(use),
                                              fieldNames(layout_.fields)));
    }
    return result;
  };

  layout_.x = required("x", "position");
  layout_.y = required("y", "position");
  layout_.z = column("z");
  layout_.doppler = layout_.vx = layout_.vy = Column{};
  if (!params_.doppler_field.empty()) {
    layout_.doppler = required(params_.doppler_field, "parameter doppler_field");
  } else {
    for (const char* name : {"doppler", "doppler_velocity", "radial_velocity", "range_rate", "velocity"}) {
      layout_.doppler = column(name);
      if (layout_.doppler.present()) break;
    }
    if (!layout_.doppler.present()) {
      layout_.vx = required("vx", "Doppler velocity; name another one with doppler_field");
      layout_.vy = required("vy", "Doppler velocity; name another one with doppler_field");
    }
  }
  layout_.rcs = column("rcs");
  layout_.invalid_state = column("invalid_state");
  layout_.ambig_state = column("ambig_state");
  layout_.pdh0 = column("pdh0");
  layout_.resolved = true;
}

ExtractionCounts DopplerExtractor::extract(const PointCloudView& cloud, std::vector<DopplerReturn>& returns) {
  returns.clear();
  if (cloud.fields == nullptr) throw std::invalid_argument("the cloud has no fields");
  if (!layout_.resolved || layout_.point_step != cloud.point_step || layout_.fields != *cloud.fields)
    resolve(cloud);

  const ReturnFilter& filter = params_.filter;
  const bool limits_azimuth = std::isfinite(filter.min_azimuth) || std::isfinite(filter.max_azimuth);
  ExtractionCounts counts;
  counts.total = cloud.size();
  for (std::size_t i = 0; i < counts.total; ++i) {
    const std::uint8_t* point = cloud.point(i);
    if (layout_.invalid_state.present() &&
        !acceptsState(invalid_allowed_, layout_.invalid_state.read(point))) {
      ++counts.invalid_state;
      continue;
    }
    if (layout_.ambig_state.present() && !acceptsState(ambig_allowed_, layout_.ambig_state.read(point))) {
      ++counts.ambig_state;
      continue;
    }
    if (layout_.pdh0.present() && !acceptsState(pdh0_allowed_, layout_.pdh0.read(point))) {
      ++counts.pdh0;
      continue;
    }
    const double x = layout_.x.read(point);
    const double y = layout_.y.read(point);
    const double z = layout_.z.present() ? layout_.z.read(point) : 0.0;
    const double range = std::sqrt(x * x + y * y + z * z);
    double doppler = 0.0;
    double tangential_speed = 0.0;
    if (layout_.doppler.present()) {
      doppler = params_.doppler_scale * layout_.doppler.read(point);
    } else {
      const double vx = layout_.vx.read(point);
      const double vy = layout_.vy.read(point);
      const double scale = params_.doppler_scale / std::hypot(x, y);
      doppler = scale * (x * vx + y * vy);
      tangential_speed = scale * (x * vy - y * vx);
    }
    if (!std::isfinite(range) || range <= 0.0 || !std::isfinite(doppler)) {
      ++counts.not_finite;
      continue;
    }
    if (range < filter.min_range || range > filter.max_range) {
      ++counts.out_of_range;
      continue;
    }
    if (limits_azimuth) {
      const double azimuth = std::atan2(y, x);
      if (azimuth < filter.min_azimuth || azimuth >= filter.max_azimuth) {
        ++counts.out_of_azimuth;
        continue;
      }
    }
    if (layout_.rcs.present()) {
      const double rcs = layout_.rcs.read(point);
      if (rcs < filter.min_rcs || rcs > filter.max_rcs) {
        ++counts.rcs;
        continue;
      }
    }
    DopplerReturn& accepted = returns.emplace_back();
    accepted.bearing = Eigen::Vector3d(x / range, y / range, z / range).cast<float>();
    accepted.range = static_cast<float>(range);
    accepted.doppler = static_cast<float>(doppler);
    accepted.tangential_speed = static_cast<float>(tangential_speed);
    accepted.index = static_cast<std::uint32_t>(i);
  }
  counts.accepted = returns.size();
  return counts;
}

}  // namespace radar_dot
