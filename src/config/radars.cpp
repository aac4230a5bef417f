// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "config/radars.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <system_error>

#include "config/config_file.h"
#include "radar_dot/common/did_you_mean.h"

namespace radar_dot {
namespace {

namespace fs = std::filesystem;

/// With the library where that is installed; in the devel space it is still in the source.
fs::path presetFolder() {
  Dl_info library;
  if (dladdr(reinterpret_cast<const void*>(&validateRadars), &library) != 0) {
    fs::path installed = fs::path(library.dli_fname).parent_path() / INSTALLED_PRESETS;
    if (fs::exists(installed)) return installed;
  }
  return SOURCE_PRESETS;
}

[[noreturn]] void refusePreset(const std::string& preset, const std::string& what) {
  throw InvalidParameter({"preset"}, fmt::format("preset is '{}'{}", preset, what));
}

fs::path presetFile(const std::string& preset) {
  if (preset.find('/') != std::string::npos) return preset;
  std::vector<std::string> names;
  std::error_code none;
  for (const fs::directory_entry& file : fs::directory_iterator(presetFolder(), none))
    if (file.path().extension() == ".yaml") names.push_back(file.path().stem().string());
  std::sort(names.begin(), names.end());
  if (!std::binary_search(names.begin(), names.end(), preset)) {
    refusePreset(preset, fmt::format(", must be one of {}, or the path of a file{}", fmt::join(names, ", "),
                                     didYouMean(nearestName(preset, names))));
  }
  return presetFolder() / (preset + ".yaml");
}

template <typename Params>
Params overridden(Params params, const RadarEntry& entry) {
  const FieldList fields = fieldsOf(params);
  for (const auto& [name, value] : entry.overrides)
    if (const Field* field = fields.find(name)) field->set(value);
  return params;
}

/// @throws InvalidParameter
RadarEntry validEntry(const EgoVelocityConfig& config, const RadarEntry& given) {
  validateFields(given);
  RadarEntry entry = withPreset(given);
  const FieldList fields = fieldsOf(entry);
  if (entry.topic.empty()) {
    const std::string topic = fields.of(&entry.topic).name;
    throw InvalidParameter({topic}, topic + " is empty, must be the name of a topic");
  }
  if (entry.mount_xyz.has_value() != entry.mount_rpy.has_value()) {
    const std::string xyz = fields.of(&entry.mount_xyz).name, rpy = fields.of(&entry.mount_rpy).name;
    throw InvalidParameter({xyz, rpy}, fmt::format("{} is not set; a mount needs {} and {}",
                                                   entry.mount_xyz ? rpy : xyz, xyz, rpy));
  }
  validate(extractionOf(config, entry));
  return entry;
}

/// A name with or without the slash of the root: mostly one topic, and always one frame.
std::string_view withoutRoot(std::string_view name) {
  return name.substr(!name.empty() && name.front() == '/' ? 1 : 0);
}

/// @throws InvalidParameter where one of the two stands for the same returns, or the same mount, as the other
void requireOther(const std::pair<std::string, RadarEntry>& one,
                  const std::pair<std::string, RadarEntry>& other) {
  const RadarEntry &a = one.second, &b = other.second;
  const std::string_view frame = withoutRoot(a.only_frame), other_frame = withoutRoot(b.only_frame);
  const bool apart = !frame.empty() && !other_frame.empty() && frame != other_frame;
  if (withoutRoot(a.topic) == withoutRoot(b.topic) && !apart) {
    throw InvalidParameter({one.first}, fmt::format("{} has the topic of {}: its returns would count twice; "
                                                    "radars that share a topic need different only_frame",
                                                    one.first, other.first));
  }
  const std::optional<Eigen::Isometry3d> mount = mountOf(a), other_mount = mountOf(b);
  if (a.frame_id.empty() || withoutRoot(a.frame_id) != withoutRoot(b.frame_id) || !mount || !other_mount ||
      mount->isApprox(*other_mount, 1e-6))
    return;
  throw InvalidParameter(
      {one.first},
      fmt::format("{} has the frame_id of {}, and another mount: a frame has one", one.first, other.first));
}

}  // namespace

void RadarEntry::describe(FieldList& fields) {
  fields.add("topic", topic, "Topic of its scans, remappable");
  fields.add("preset", preset,
             "Values for a kind of radar, which hold where they are not set here: the name of a file in "
             "config/radars without .yaml, or the path of one");
  fields.group("", FieldList::kLiveOnly);
  fields.add("only_frame", only_frame,
             "Messages of other frames are not of this radar; needed where several share a topic");
  fields.add("frame_id", frame_id, "Frame of the radar instead of that of the messages");
  fields.add("stamp", stamp, "Time of a scan");
  fields.add("unambiguous_velocity", unambiguous_velocity,
             "Range rates are known up to multiples of twice this velocity; not set: as they are", "m/s",
             {1.0, 1000.0});
  fields.group("");
  fields.add("time_offset", time_offset, "Added to the time of a scan: negative where the stamps are late",
             "s", {-10.0, 10.0});
  fields.add("mount_xyz", mount_xyz, "Position of the radar in base_frame, with mount_rpy instead of TF", "m",
             {-1000.0, 1000.0});
  fields.add("mount_rpy", mount_rpy,
             "Roll, pitch and yaw of the radar in base_frame, about fixed axes as for "
             "static_transform_publisher",
             "rad", {-6.3, 6.3});
  fields.add("mount_yaw_correction", mount_yaw_correction, "Added to the yaw of the mount", "rad",
             {-3.2, 3.2});
  ExtractionParams extraction;
  fields.addOverrides(fieldsOf(extraction), overrides);
  fields.group("", FieldList::kLiveOnly);
  RateParams rate;
  fields.addOverrides(fieldsOf(rate), overrides);
}

RadarEntry withPreset(const RadarEntry& entry) {
  if (entry.preset.empty()) return entry;
  RadarEntry whole = entry, preset, untouched;
  const FieldList fields = fieldsOf(whole), presets = fieldsOf(preset), defaults = fieldsOf(untouched);
  try {
    readFieldsFile(presetFile(entry.preset).string(), presets);
  } catch (const ConfigFileError& error) {
    refusePreset(entry.preset, std::string(": ") + error.what());
  }
  if (!preset.preset.empty()) refusePreset(entry.preset, ", which names another one");
  for (const Field& field : fields) {
    if (field.get() == defaults.find(field.name)->get()) field.put(presets.find(field.name)->get());
  }
  whole.preset.clear();
  return whole;
}

ExtractionParams extractionOf(const EgoVelocityConfig& config, const RadarEntry& entry) {
  return overridden(config.extraction, withPreset(entry));
}

RateParams rateOf(const EgoVelocityConfig& config, const RadarEntry& entry) {
  return overridden(config.rate, withPreset(entry));
}

double unambiguousVelocityOf(const RadarEntry& entry, const ExtractionParams& extraction) {
  constexpr double kNotAmbiguous = std::numeric_limits<double>::infinity();
  return std::abs(extraction.doppler_scale) * entry.unambiguous_velocity.value_or(kNotAmbiguous);
}

std::optional<Eigen::Isometry3d> mountOf(const RadarEntry& entry) {
  if (!entry.mount_xyz || !entry.mount_rpy) return std::nullopt;
  const auto& [roll, pitch, yaw] = *entry.mount_rpy;
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  return Eigen::Translation3d(Vector3d(entry.mount_xyz->data())) * AngleAxisd(yaw, Vector3d::UnitZ()) *
         AngleAxisd(pitch, Vector3d::UnitY()) * AngleAxisd(roll, Vector3d::UnitX());
}

Eigen::Isometry3d corrected(const Eigen::Isometry3d& T_base_from_sensor, const RadarEntry& entry) {
  Eigen::Isometry3d mount = T_base_from_sensor;
  mount.linear() = Eigen::AngleAxisd(entry.mount_yaw_correction, Eigen::Vector3d::UnitZ()) * mount.linear();
  return mount;
}

void validateRadars(const EgoVelocityConfig& config) {
  std::vector<std::pair<std::string, RadarEntry>> earlier;
  for (const auto& [name, given] : config.radars) {
    const std::string place = std::string(kRadars) + "/" + name;
    try {
      earlier.emplace_back(place, validEntry(config, given));
    } catch (const InvalidParameter& error) {
      throw InvalidParameter({place}, place + "/" + error.what());
    }
    for (auto other = earlier.begin(); other != earlier.end() - 1; ++other)
      requireOther(earlier.back(), *other);
  }
}

}  // namespace radar_dot
