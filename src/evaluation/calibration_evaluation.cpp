// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/calibration_evaluation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "radar_dot/evaluation/pose_track.h"
#include "radar_scene.h"
#include "wheel_speed.h"

namespace radar_dot::evaluation {
namespace {

using Quantity = CalibrationQuantity;

constexpr double kReferenceInterval = 0.1;  // s
constexpr double kReferenceWindow = 0.2;    // s over which poses are compared

std::vector<ReferenceReading> referenceOf(const RadarScene& scene, CalibrationReference reference) {
  std::vector<ReferenceReading> readings;
  if (reference == CalibrationReference::kNone) return readings;
  const WheelSpeed wheels(scene.wheels);
  for (double time = scene.truth.begin() + 0.5 * kReferenceWindow;
       time < scene.truth.end() - 0.5 * kReferenceWindow; time += kReferenceInterval) {
    ReferenceReading reading;
    reading.time = time;
    if (reference == CalibrationReference::kWheels) {
      const std::optional<double> speed = wheels.at(time);
      if (!speed) continue;
      reading.velocity[0] = *speed;
    } else {
      const double begin = time - 0.5 * kReferenceWindow, end = time + 0.5 * kReferenceWindow;
      reading.velocity.head<2>() = scene.truth.meanVelocity(begin, end).head<2>();
      reading.velocity[2] = scene.truth.meanYawRate(begin, end);
    }
    readings.push_back(reading);
  }
  return readings;
}

std::size_t indexOf(const LoadedRadar& radar, const std::string& scene, CalibrationData& data) {
  const auto known = std::find_if(data.radars.begin(), data.radars.end(),
                                  [&](const CalibratedRadar& other) { return other.name == radar.channel; });
  if (known == data.radars.end()) {
    data.radars.push_back({radar.channel, radar.T_base_from_sensor});
    return data.radars.size() - 1;
  }
  if (!known->T_base_from_sensor.isApprox(radar.T_base_from_sensor, 1e-6)) {
    throw dataset::DatasetError(fmt::format(
        "{}: {} is mounted otherwise than in the scenes before: calibrate each vehicle by itself (--scenes)",
        scene, radar.channel));
  }
  return static_cast<std::size_t>(known - data.radars.begin());
}

std::string milli(const CalibratedValue& value, double nominal) {
  return value.observable() ? fmt::format("{:+.1f} +- {:.1f}", 1e3 * (value.value - nominal), 1e3 * value.std)
                            : "-";
}

double nominalOf(Quantity quantity) { return quantity == Quantity::kDopplerScale ? 1.0 : 0.0; }

/// Twice its sigma away from where it is configured.
bool isOff(const CalibratedValue& value, double nominal) {
  return value.observable() && std::abs(value.value - nominal) > 2.0 * value.std;
}

std::string yamlOf(const CalibrationData& data, const Calibration& calibration,
                   const EgoVelocityConfig& config) {
  std::string text = "ego_velocity:\n";
  if (isOff(calibration.bearing_delay, 0.0))
    text += fmt::format("  bearing_delay: {:.4f}\n", config.bearing_delay + calibration.bearing_delay.value);
  text += "  radars:\n";
  for (std::size_t i = 0; i < data.radars.size(); ++i) {
    const RadarCalibration& found = calibration.radars[i];
    const RadarEntry& entry = data.entries[i];
    std::string line;
    const auto add = [&line](const std::string& item) { line += (line.empty() ? "" : ", ") + item; };
    add("topic: " + entry.topic);
    if (!entry.preset.empty()) add("preset: " + entry.preset);
    const CalibratedValue& yaw = found[Quantity::kYaw];
    if (yaw.observable())
      add(fmt::format("mount_yaw_correction: {:.4f}", entry.mount_yaw_correction + yaw.value));
    const CalibratedValue& scale = found[Quantity::kDopplerScale];
    if (isOff(scale, 1.0) || found.doppler_sign < 0)
      add(fmt::format("doppler_scale: {:.4f}", extractionOf(config, entry).doppler_scale *
                                                   (scale.observable() ? scale.value : found.doppler_sign)));
    const CalibratedValue& offset = found[Quantity::kTimeOffset];
    if (isOff(offset, 0.0))
      add(fmt::format("time_offset: {:.4f}", entry.time_offset.value_or(0.0) + offset.value));
    text += fmt::format("    {}: {{{}}}\n", data.entry_names[i], line);
    if (isOff(found[Quantity::kX], 0.0) || isOff(found[Quantity::kY], 0.0)) {
      text += fmt::format(
          "    # {}: its mount is {:+.3f} m ahead and {:+.3f} m to the left of where it is said to be\n",
          data.entry_names[i], found[Quantity::kX].value, found[Quantity::kY].value);
    }
  }
  return text;
}

}  // namespace

CalibrationData calibrationData(const dataset::Tables& tables, const EgoVelocityConfig& config,
                                CalibrationReference reference) {
  CalibrationData data;
  for (std::size_t row = 0; row < tables.scenes.size(); ++row) {
    std::optional<RadarScene> loaded;
    const auto scene_row = static_cast<dataset::Index>(row);
    if (!tables.work(scene_row, [&] { loaded.emplace(loadRadarScene(tables, scene_row, {}, config)); }))
      continue;
    const RadarScene& scene = *loaded;
    CalibrationDrive drive;
    for (const LoadedRadar& radar : scene.radars) {
      const std::size_t index = indexOf(radar, tables.scenes[row].name, data);
      for (const LoadedScan& scan : radar.scans) drive.scans.push_back({index, scan.time, scan.returns});
    }
    drive.reference = referenceOf(scene, reference);
    if (!drive.scans.empty()) data.drives.push_back(std::move(drive));
  }
  if (data.radars.empty()) tables.failWithoutScenes();
  for (const CalibratedRadar& radar : data.radars) {
    const auto [name, entry] = entryOf(config, radar.name);
    data.entries.push_back(entry);
    data.entry_names.push_back(name);
  }
  return data;
}

CalibrationReport calibrate(const CalibrationData& data, const EgoVelocityConfig& config,
                            const CalibrationParams& params, double block) {
  CalibrationReport report;
  report.block = block;
  report.calibration = calibrateRadars(data.radars, data.drives, params);
  std::vector<CalibrationDrive> fitted, held_out;
  splitDrives(data.drives, block, fitted, held_out);
  if (!held_out.empty()) {
    report.before = calibrationResiduals(data.radars, held_out, params, {});
    report.after =
        calibrationResiduals(data.radars, held_out, params, calibrateRadars(data.radars, fitted, params));
  }
  report.yaml = yamlOf(data, report.calibration, config);
  return report;
}

bool CalibrationReport::isWorthIt() const { return !(after.all > before.all); }

void CalibrationReport::describe(Figures& figures) {
  const auto add = [&figures](const std::string& key, const CalibratedValue& value) {
    figures.figure(key, value.observable() ? value.value : std::numeric_limits<double>::quiet_NaN());
    figures.figure(key + "_std", value.std);
  };
  for (const RadarCalibration& radar : calibration.radars) {
    figures.object(radar.name, [&] {
      for (std::size_t i = 0; i < kCalibrationQuantities; ++i)
        add(EnumNames<Quantity>::kValues[i].name, radar.values[i]);
      figures.figure("doppler_sign", radar.doppler_sign);
      figures.count("scans", radar.scans);
      figures.count("static_returns", radar.used);
    });
  }
  add("bearing_delay", calibration.bearing_delay);
  figures.count("is_worth_it", isWorthIt() ? 1 : 0);
  for (const auto& [key, residuals] :
       {std::pair("held_out_before", &before), std::pair("held_out_after", &after)}) {
    figures.object(key, [&figures, r = residuals] {
      figures.figure("residual", r->all);
      figures.figure("vx_mae", r->motion[0]);
      figures.figure("vy_mae", r->motion[1]);
      figures.figure("yaw_rate_mae", r->motion[2]);
    });
  }
}

std::string formatTable(const CalibrationReport& report) {
  std::string text = fmt::format("{:<18} {:>15} {:>15} {:>15} {:>15} {:>15}  sign\n", "Radar", "yaw mrad",
                                 "x mm", "y mm", "scale 1e-3", "time ms");
  std::string reasons;
  for (const RadarCalibration& radar : report.calibration.radars) {
    text += fmt::format("{:<18}", radar.name);
    for (std::size_t i = 0; i < kCalibrationQuantities; ++i) {
      const auto quantity = static_cast<Quantity>(i);
      text += fmt::format(" {:>15}", milli(radar.values[i], nominalOf(quantity)));
      if (!radar.values[i].observable())
        reasons += fmt::format("  {} {}: {}\n", radar.name, EnumNames<Quantity>::kValues[i].name,
                               radar.values[i].reason);
    }
    text += fmt::format("  {}\n", radar.doppler_sign < 0 ? "reversed" : "right");
  }
  const CalibratedValue& delay = report.calibration.bearing_delay;
  text += fmt::format("bearing_delay, ms beyond the configured one: {}\n", milli(delay, 0.0));
  if (!delay.observable()) reasons += "  bearing_delay: " + delay.reason + "\n";
  if (!reasons.empty()) text += "Not observable in this drive:\n" + reasons;
  const auto row = [](const char* name, const CalibrationResiduals& residuals) {
    return fmt::format("{:<10} {:>14.4f} {:>9.4f} {:>9.4f} {:>15.5f}\n", name, residuals.all,
                       residuals.motion[0], residuals.motion[1], residuals.motion[2]);
  };
  if (!report.before.by_radar.empty()) {
    text += fmt::format(
        "\nHeld out, every other {:.0f} s; mean |radars - reference|:\n{:<10} {:>14} {:>9} {:>9} {:>15}\n",
        report.block, "", "residual m/s", "vx m/s", "vy m/s", "yaw rate rad/s");
    text += row("before", report.before) + row("after", report.after);
  }
  if (!report.isWorthIt())
    return text +
           "\nWhat was held out agrees less than before: nothing to paste. A drive with turns, or a "
           "reference, tells more.\n";
  return text + "\n" + report.yaml;
}

}  // namespace radar_dot::evaluation
