// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>
#include <sensor_msgs/PointCloud2.h>
#include <std_msgs/Header.h>

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "nodelets/messages/radar_message.h"
#include "radar_dot/config/sections.h"
#include "radar_dot/radar/doppler_returns.h"
#include "radar_dot/radar/sequence_watch.h"

namespace radar_dot {

/// One scan as it was received and read.
struct RadarReading {
  std_msgs::Header header;  ///< with the frame and the time that the radar's entry gives it
  sensor_msgs::PointCloud2ConstPtr cloud;
  std::vector<PointField> fields;
  PointCloudView view;  ///< into `cloud` and `fields`
  std::vector<DopplerReturn> returns;
  ExtractionCounts counts;
};

/// The messages of one radar, read as its entry in the parameter `radars` says.
class RadarInput {
 public:
  /// The mount of a frame, T_base_from_sensor; none, and why, where it is not known.
  using FindMount = std::function<std::optional<Eigen::Isometry3d>(const std::string& frame, std::string&)>;

  /// @param entry  with its preset
  explicit RadarInput(RadarEntry entry);

  const RadarEntry& entry() const noexcept { return entry_; }
  const ExtractionParams& extraction() const noexcept { return extractor_.params(); }
  void setExtractor(DopplerExtractor extractor) { extractor_ = std::move(extractor); }

  /// False where several radars share a topic, and this is a message of another one.
  bool isOwn(const RadarMessage& message) const;
  /// Limits on height hold where the mount is known.
  /// @throws std::invalid_argument with everything that is wrong with the message, and its mount then, and
  /// what cures it
  void read(const RadarMessage& message, const ros::Time& now, const FindMount& find_mount,
            RadarReading& reading);
  /// "sensor_msgs/PointCloud2 in frame 'radar', range rate from field 'doppler', times 1, stamps of the
  /// header": of the messages so far.
  std::string description() const;
  /// "field 'doppler'"; empty: no cloud with returns yet.
  const std::string& dopplerSource() const noexcept { return extractor_.dopplerSource(); }
  /// Messages that were lost before the latest of those that came.
  std::size_t lost() const noexcept { return lost_; }

 private:
  std_msgs::Header headerOf(const RadarMessage& message, const ros::Time& now);

  RadarEntry entry_;
  DopplerExtractor extractor_;
  SequenceWatch sequence_;
  std::size_t lost_ = 0;
  ros::Time arrival_;         // of the latest message
  std::string type_, frame_;  // of the latest message
};

}  // namespace radar_dot
