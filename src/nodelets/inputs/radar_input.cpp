// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/inputs/radar_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "nodelets/common/read_parameters.h"
#include "nodelets/inputs/extrinsics.h"
#include "nodelets/inputs/stamp_guard.h"
#include "nodelets/messages/cloud_conversion.h"

namespace radar_dot {
namespace {

const ros::Duration kLeastInterval(0.001);

/// All that keeps a header from being used, with the field of the entry that cures it.
void addHeaderFaults(const std_msgs::Header& header, const ros::Time& now, bool is_arrival,
                     std::vector<std::string>& faults) {
  const RadarEntry names;
  if (header.frame_id.empty())
    faults.push_back(fmt::format("its frame_id is empty: set {}", nameOf(names, names.frame_id)));
  const std::string defect = stampDefect(header.stamp, now);
  if (defect.empty()) return;
  faults.push_back(defect + (is_arrival ? fmt::format(": is {} right?", nameOf(names, names.time_offset))
                                        : fmt::format(": set {}: {}", nameOf(names, names.stamp),
                                                      std::string(toString(StampSource::kArrival)))));
}

}  // namespace

RadarInput::RadarInput(RadarEntry entry) : entry_(std::move(entry)) {}

bool RadarInput::isOwn(const RadarMessage& message) const {
  // A message that cannot be read has no frame: every radar of the topic reports it.
  return entry_.only_frame.empty() || !message.defect.empty() ||
         withoutSlash(message.header.frame_id) == withoutSlash(entry_.only_frame);
}

std_msgs::Header RadarInput::headerOf(const RadarMessage& message, const ros::Time& now) {
  std_msgs::Header header = message.header;
  if (!entry_.frame_id.empty()) header.frame_id = entry_.frame_id;
  if (entry_.stamp == StampSource::kArrival) {
    // Several may arrive at one time of a replay's clock.
    const double since = now.toSec() - arrival_.toSec();
    arrival_ = since <= 0.0 && since > -kTimeTolerance ? arrival_ + kLeastInterval : now;
    header.stamp = arrival_;
  }
  if (entry_.time_offset && !header.stamp.isZero())
    header.stamp.fromSec(std::max(0.0, header.stamp.toSec() + *entry_.time_offset));
  return header;
}

void RadarInput::read(const RadarMessage& message, const ros::Time& now, const FindMount& find_mount,
                      RadarReading& reading) {
  type_ = message.type;
  if (!message.defect.empty()) throw std::invalid_argument(message.defect);
  // Those of other radars on the topic are no loss.
  if (entry_.only_frame.empty()) lost_ += sequence_.lostBefore(message.header.seq);
  reading.header = headerOf(message, now);
  frame_ = reading.header.frame_id;

  std::vector<std::string> faults;
  addHeaderFaults(reading.header, now, entry_.stamp == StampSource::kArrival, faults);
  try {
    reading.cloud = withPositions(message.cloud, extraction().angle_unit, faults);
    reading.view = viewOf(*reading.cloud, reading.fields);
    if (reading.view.size() > 0) {
      const std::vector<std::string>& of_cloud = extractor_.faults(reading.view);
      faults.insert(faults.end(), of_cloud.begin(), of_cloud.end());
    }
  } catch (const std::invalid_argument& error) {
    faults.emplace_back(error.what());
  }
  const ReturnFilter& filter = extraction().filter;
  const bool limits_height = std::isfinite(filter.min_height) || std::isfinite(filter.max_height);
  std::string missing;
  std::optional<Eigen::Isometry3d> T_base_from_sensor;
  if (!frame_.empty() && (limits_height || !faults.empty())) T_base_from_sensor = find_mount(frame_, missing);
  // Alone it is no fault of the message: TF may know the mount when its sweep is complete.
  if (!faults.empty() && !missing.empty()) faults.push_back(missing);
  if (!faults.empty()) throw std::invalid_argument(fmt::format("{}", fmt::join(faults, "; ")));
  if (reading.view.size() > 0)
    reading.counts = extractor_.extract(reading.view, reading.returns,
                                        T_base_from_sensor ? &*T_base_from_sensor : nullptr);
}

std::string RadarInput::description() const {
  const std::string& source = dopplerSource();
  std::string stamps = entry_.stamp == StampSource::kArrival ? "time of arrival" : "stamps of the header";
  if (entry_.time_offset) stamps += fmt::format(" {:+} s", *entry_.time_offset);
  return fmt::format("{} in frame '{}', range rate from {} times {}, {}", type_, frame_,
                     source.empty() ? "no cloud with returns yet" : source,
                     toText(extraction().doppler_scale), stamps);
}

}  // namespace radar_dot
