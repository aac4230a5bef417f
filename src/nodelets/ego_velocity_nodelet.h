// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nodelets/common/stream_nodelet.h"
#include "nodelets/inputs/mask_input.h"
#include "nodelets/inputs/velocity_chain.h"
#include "radar_dot/config/sections.h"
#include "radar_dot/radar/doppler_returns.h"
#include "radar_dot/radar/sweep_assembler.h"

namespace radar_dot {

/// One scan as it was received and read.
struct RadarReading {
  sensor_msgs::PointCloud2ConstPtr cloud;
  std::vector<PointField> fields;
  PointCloudView view;  ///< into `cloud` and `fields`
  std::vector<DopplerReturn> returns;
  ExtractionCounts counts;
};

/// Velocity of the vehicle, static and dynamic returns from any number of radars.
class EgoVelocityNodelet : public ConfiguredNodelet<EgoVelocityConfig> {
 private:
  struct Radar {
    std::string name;
    RadarEntry entry;  // with the resolved topic
    RadarMonitor& monitor;
    DopplerExtractor extractor;
  };
  /// A scan of a sweep whose mount is known.
  struct MountedScan {
    std::size_t radar = 0;
    std::shared_ptr<const RadarReading> reading;
    std::vector<std::uint8_t> in_mask;  // by return; empty: no mask tells
  };

  void setUp() override;
  void setUpMasks();
  void setUpRadars();
  void apply(const EgoVelocityConfig& config) override;
  void started() override;
  void clearHistory() override;
  void report(diagnostic_updater::DiagnosticStatusWrapper& status) override;
  /// Why nothing is estimated: the parameters cannot be used, or a velocity of the wrong sign might come of a
  /// default. Empty: it is.
  std::string disabledBy() const;

  void onCloud(std::size_t radar, const sensor_msgs::PointCloud2ConstPtr& cloud);
  void warnOfSilentRadars();

  void processSweep(const Sweep& sweep);
  std::vector<MountedScan> mountedScans(const Sweep& sweep, std::vector<RadarScan>& scans,
                                        std::string& error);
  void publishStatus(const ros::Time& stamp, const EgoVelocityResult& result,
                     const std::vector<MountedScan>& mounted, const std::string& reason,
                     double computation_time);
  void publishTwist(const ros::Time& stamp, double time, const std::vector<RadarScan>& scans,
                    const EgoVelocityResult& result);
  void publishClouds(const std::vector<MountedScan>& scans, const EgoVelocityResult& result);

  std::vector<std::unique_ptr<Radar>> radars_;
  StreamExpectation radar_expectation_;  // of radars and estimates
  std::optional<SweepAssembler> assembler_;
  std::vector<Sweep> completed_;  // kept between calls for its memory
  VelocityChain chain_;
  std::unique_ptr<MaskInput> mask_;
  std::map<std::string, ros::WallTime> mount_missing_since_;  // by frame

  ros::Publisher twist_publisher_, raw_twist_publisher_, status_publisher_, static_publisher_,
      dynamic_publisher_;
  std::unique_ptr<EstimatorMonitor> estimator_monitor_;
  ros::WallTimer silence_timer_;
};

}  // namespace radar_dot
