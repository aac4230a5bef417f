// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/calibration_evaluation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "radar_dot/evaluation/pose_track.h"
#include "radar_scene.h"
#include "wheel_speed.h"

namespace radar_dot::evaluation {
namespace {

using Quantity = CalibrationQuantity;

constexpr double kReferenceInterval = 0.1;  // s
constexpr double kReferenceWindow = 0.2;    // s over which poses are compared
constexpr std::size_t kMaxFolds = 5;

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

double rounded(double value) { return std::round(1e4 * value) / 1e4; }

/// "topic: radar, time_offset: 0.04": what is not as by default.
std::string setFields(const RadarEntry& entry) {
  const RadarEntry untouched;
  const FieldList defaults = fieldsOf(untouched);
  std::string text;
  for (const Field& field : fieldsOf(entry)) {
    if (field.get() == defaults.find(field.name)->get()) continue;
    const bool is_list = field.type == FieldType::kIntList || field.type == FieldType::kTextList ||
                         field.type == FieldType::kDoubleList;
    text += fmt::format(is_list ? "{}{}: [{}]" : "{}{}: {}", text.empty() ? "" : ", ", field.name,
                        toText(field.get()));
  }
  return text;
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
    // What is configured beside stays, but for the values of the preset.
    const auto given = config.radars.find(data.entry_names[i]);
    RadarEntry changed;
    changed.topic = entry.topic;
    if (given != config.radars.end()) changed = given->second;
    const CalibratedValue& yaw = found[Quantity::kYaw];
    if (yaw.observable()) changed.mount_yaw_correction = rounded(entry.mount_yaw_correction + yaw.value);
    const CalibratedValue& scale = found[Quantity::kDopplerScale];
    if (isOff(scale, 1.0) || found.doppler_sign < 0)
      changed.overrides["doppler_scale"] = rounded(extractionOf(config, entry).doppler_scale *
                                                   (scale.observable() ? scale.value : found.doppler_sign));
    const CalibratedValue& offset = found[Quantity::kTimeOffset];
    if (isOff(offset, 0.0)) changed.time_offset = rounded(entry.time_offset.value_or(0.0) + offset.value);
    text += fmt::format("    {}: {{{}}}\n", data.entry_names[i], setFields(changed));
    if (isOff(found[Quantity::kX], 0.0) || isOff(found[Quantity::kY], 0.0)) {
      text += fmt::format(
          "    # {}: its mount is {:+.3f} m ahead and {:+.3f} m to the left of where it is said to be\n",
          data.entry_names[i], found[Quantity::kX].value, found[Quantity::kY].value);
    }
  }
  return text;
}

using Drives = std::vector<CalibrationDrive>;

/// Parts to fit and to hold out: each drive in turn, in groups where there are many; of one drive stretches.
std::vector<std::pair<Drives, Drives>> foldsOf(const Drives& drives, double block) {
  std::vector<std::pair<Drives, Drives>> folds(std::min(kMaxFolds, drives.size()));
  if (drives.size() == 1) {
    splitDrives(drives, block, folds[0].first, folds[0].second);
    if (folds[0].second.empty()) folds.clear();
    return folds;
  }
  for (std::size_t fold = 0; fold < folds.size(); ++fold)
    for (std::size_t drive = 0; drive < drives.size(); ++drive)
      (drive % folds.size() == fold ? folds[fold].second : folds[fold].first).push_back(drives[drive]);
  return folds;
}

CalibrationResiduals meanOf(const std::vector<CalibrationResiduals>& folds) {
  CalibrationResiduals mean = folds.front();
  mean.all = 0.0;
  mean.motion.setZero();
  for (const CalibrationResiduals& fold : folds) {
    mean.all += fold.all / static_cast<double>(folds.size());
    mean.motion += fold.motion / static_cast<double>(folds.size());
  }
  return mean;
}

/// Mean ratio of what is left to what was there: of the residuals, and of the motion where it has a
/// reference.
double disagreement(const CalibrationResiduals& after, const CalibrationResiduals& before) {
  double sum = after.all / before.all, count = 1.0;
  for (const double ratio : (after.motion / before.motion).eval()) {
    if (!std::isfinite(ratio)) continue;
    sum += ratio;
    count += 1.0;
  }
  return sum / count;
}

/// Of the other quantities nothing is left but the reason.
void keepYaws(const Calibration& yaws, Calibration& calibration) {
  const auto drop = [](CalibratedValue& value) {
    if (value.observable()) value.reason = "what was held out agrees better without it";
  };
  for (std::size_t radar = 0; radar < calibration.radars.size(); ++radar) {
    auto& values = calibration.radars[radar].values;
    std::for_each(values.begin(), values.end(), drop);
    values[0] = yaws.radars[radar][Quantity::kYaw];
  }
  drop(calibration.bearing_delay);
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
    data.frames.push_back(entry.frame_id.empty() ? entryOf({}, radar.name).first : entry.frame_id);
  }
  return data;
}

CalibrationReport calibrate(const CalibrationData& data, const EgoVelocityConfig& config,
                            const CalibrationParams& params, double block) {
  CalibrationReport report;
  report.block = data.drives.size() > 1 ? 0.0 : block;
  report.calibration = calibrateRadars(data.radars, data.drives, params);
  CalibrationParams yaws = params;
  yaws.positions = yaws.scales = yaws.time_offsets = yaws.common_delay = false;
  std::vector<CalibrationResiduals> before, after, after_yaws;
  for (const auto& [fitted, held_out] : foldsOf(data.drives, block)) {
    const auto residuals = [&, &rest = held_out](const Calibration& found) {
      return calibrationResiduals(data.radars, rest, params, found);
    };
    before.push_back(residuals({}));
    after.push_back(residuals(calibrateRadars(data.radars, fitted, params)));
    after_yaws.push_back(residuals(calibrateRadars(data.radars, fitted, yaws)));
  }
  if (!before.empty()) {
    report.before = meanOf(before);
    report.after = meanOf(after);
    const CalibrationResiduals by_yaws = meanOf(after_yaws);
    if (disagreement(by_yaws, report.before) < disagreement(report.after, report.before)) {
      report.after = by_yaws;
      keepYaws(calibrateRadars(data.radars, data.drives, yaws), report.calibration);
    }
  }
  report.yaml = yamlOf(data, report.calibration, config);
  for (std::size_t i = 0; i < data.radars.size(); ++i) {
    const RadarCalibration& found = report.calibration.radars[i];
    const CalibratedValue& yaw = found[Quantity::kYaw];
    Eigen::Isometry3d& mount = report.mounts[data.frames[i]] = data.radars[i].T_base_from_sensor;
    if (yaw.observable()) {
      report.mount_yaws[data.entry_names[i]] = {yaw.value, yaw.std};
      mount.linear() = Eigen::AngleAxisd(yaw.value, Eigen::Vector3d::UnitZ()) * mount.linear();
    }
    if (isOff(found[Quantity::kX], 0.0)) mount.translation().x() += found[Quantity::kX].value;
    if (isOff(found[Quantity::kY], 0.0)) mount.translation().y() += found[Quantity::kY].value;
  }
  return report;
}

bool CalibrationReport::isWorthIt() const {
  return before.by_radar.empty() || disagreement(after, before) <= 1.0;
}

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
    std::map<std::string, std::string> names_by_reason;
    for (std::size_t i = 0; i < kCalibrationQuantities; ++i) {
      const auto quantity = static_cast<Quantity>(i);
      text += fmt::format(" {:>15}", milli(radar.values[i], nominalOf(quantity)));
      if (radar.values[i].observable()) continue;
      std::string& names = names_by_reason[radar.values[i].reason];
      names += (names.empty() ? "" : ", ") + std::string(EnumNames<Quantity>::kValues[i].name);
    }
    for (const auto& [reason, names] : names_by_reason)
      reasons += fmt::format("  {} {}: {}\n", radar.name, names, reason);
    text += fmt::format("  {}\n", radar.doppler_sign < 0 ? "reversed" : "right");
  }
  const CalibratedValue& delay = report.calibration.bearing_delay;
  text += fmt::format("bearing_delay, ms beyond the configured one: {}\n", milli(delay, 0.0));
  if (!delay.observable()) reasons += "  bearing_delay: " + delay.reason + "\n";
  if (!reasons.empty()) text += "Not found:\n" + reasons;
  const auto row = [](const char* name, const CalibrationResiduals& residuals) {
    const auto cell = [](double value, int width, int digits) {
      return std::isfinite(value) ? fmt::format(" {:>{}.{}f}", value, width, digits)
                                  : fmt::format(" {:>{}}", "-", width);
    };
    return fmt::format("{:<10}", name) + cell(residuals.all, 14, 4) + cell(residuals.motion[0], 9, 4) +
           cell(residuals.motion[1], 9, 4) + cell(residuals.motion[2], 15, 5) + "\n";
  };
  if (!report.before.by_radar.empty()) {
    text += fmt::format(
        "\nHeld out, {}; mean |radars - reference|:\n{:<10} {:>14} {:>9} {:>9} {:>15}\n",
        report.block > 0.0 ? fmt::format("every other {:.0f} s", report.block) : "each drive in turn", "",
        "residual m/s", "vx m/s", "vy m/s", "yaw rate rad/s");
    text += row("before", report.before) + row("after", report.after);
  }
  if (!report.isWorthIt())
    return text +
           "\nWhat was held out agrees less than before: nothing to paste. A drive with turns, or a "
           "reference, tells more.\n";
  return text + "\n" + report.yaml;
}

}  // namespace radar_dot::evaluation
