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
#include "radar_dot/config/sections.h"
#include "radar_dot/radar/doppler_returns.h"
#include "radar_dot/radar/sweep_assembler.h"
#include "radar_dot/radar/sweep_estimator.h"

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
  using Assembler = SweepAssembler<std::shared_ptr<const RadarReading>>;
  using Sweep = Assembler::Sweep;
  using Readings = std::vector<std::shared_ptr<const RadarReading>>;

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
  /// The mount of a scan; none, with the reason in `error`, where it is not known.
  std::optional<Eigen::Isometry3d> mountOf(Radar& radar, const std::string& frame, std::string& error);
  void publishStatus(const ros::Time& stamp, const EgoVelocityResult& result, const Readings& readings,
                     const std::string& reason, double computation_time);
  void publishTwist(const ros::Time& stamp, const SweepEstimate& estimate);
  void publishClouds(const Readings& readings, const EgoVelocityResult& result);

  std::vector<std::unique_ptr<Radar>> radars_;
  StreamExpectation radar_expectation_;  // of radars and estimates
  std::optional<Assembler> assembler_;
  std::vector<Sweep> completed_;  // kept between calls for its memory
  SweepEstimator estimator_;
  std::unique_ptr<MaskInput> mask_;
  std::map<std::string, ros::WallTime> mount_missing_since_;  // by frame

  ros::Publisher twist_publisher_, raw_twist_publisher_, status_publisher_, static_publisher_,
      dynamic_publisher_;
  std::unique_ptr<EstimatorMonitor> estimator_monitor_;
  ros::WallTimer silence_timer_;
};

}  // namespace radar_dot
