// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "mask_folder.h"

#include <fmt/format.h>

#include <algorithm>

#include "radar_scene.h"
#include "scene_depths.h"
#include "segmentation_images.h"

namespace radar_dot::evaluation {

using dataset::DatasetError;
using dataset::Index;

MaskFolder::MaskFolder(const dataset::Tables& tables, Index scene, const std::filesystem::path& folder,
                       const std::string& channel, double delay)
    : tables_(tables), delay_(delay) {
  const std::vector<Index> readings = tables.readingsOf(scene, channel);
  const std::string& name = tables.scenes[at(scene)].name;
  if (readings.empty()) throw DatasetError(fmt::format("{}: no readings of {}", name, channel));
  for (const Index row : readings) {
    const std::filesystem::path file = folder / pngNameOf(tables, row);
    if (std::filesystem::exists(file))
      entries_.push_back({secondsOf(tables.sample_data[at(row)]), row, file});
  }
  if (entries_.empty()) {
    throw DatasetError(
        fmt::format("{}: holds no mask of the {} images of {}; evaluate_segmentation "
                    "--save-masks writes them",
                    folder.string(), channel, name));
  }
}

const StampedMask* MaskFolder::before(double time) {
  const auto after = std::upper_bound(entries_.begin(), entries_.end(), time - delay_,
                                      [](double latest, const Entry& entry) { return latest < entry.time; });
  if (after == entries_.begin()) return nullptr;
  return &load(static_cast<std::size_t>(after - entries_.begin()) - 1);
}

const StampedMask& MaskFolder::load(std::size_t index) {
  if (loaded_ == index) return mask_;
  const Entry& entry = entries_[index];
  const dataset::SampleData& reading = tables_.sample_data[at(entry.row)];
  mask_.time = entry.time;
  mask_.mask = readGrey(entry.file);
  mask_.camera = cameraOf(tables_, entry.row).scaledTo(mask_.mask.cols, mask_.mask.rows);
  mask_.T_camera_from_base =
      tables_.calibrated_sensors[at(reading.calibrated_sensor)].T_base_from_sensor.inverse();
  loaded_ = index;
  return mask_;
}

}  // namespace radar_dot::evaluation
