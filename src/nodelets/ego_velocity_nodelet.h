// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <nodelet/nodelet.h>
#include <ros/ros.h>
#include <sensor_msgs/PointCloud2.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nodelets/common/log_throttle.h"
#include "nodelets/common/monitors.h"
#include "nodelets/common/reconfigure_server.h"
#include "nodelets/inputs/extrinsics.h"
#include "nodelets/inputs/mask_input.h"
#include "nodelets/inputs/stamp_guard.h"
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
///
/// All callbacks run one after the other in the nodelet's single-threaded queue; only TF is
/// received beside it, in the thread of its listener.
class EgoVelocityNodelet : public nodelet::Nodelet {
 private:
  struct Radar {
    Radar(std::string radar_name, RadarEntry radar_entry, const StreamExpectation& expectation, double window)
        : name(std::move(radar_name)),
          entry(std::move(radar_entry)),
          monitor(entry.topic, expectation, window) {}
    std::string name;
    RadarEntry entry;  // with the resolved topic
    RadarMonitor monitor;
    StampGuard stamps;
    bool received = false;  // anything, refused or not
    DopplerExtractor extractor;
    ros::Subscriber subscriber;
  };
  using Assembler = SweepAssembler<std::shared_ptr<const RadarReading>>;
  using Sweep = Assembler::Sweep;
  using Readings = std::vector<std::shared_ptr<const RadarReading>>;

  void onInit() override;
  void setUpRadars(const std::map<std::string, RadarEntry>& entries);
  void subscribe();
  void setUpDiagnostics();
  void reportConfiguration(diagnostic_updater::DiagnosticStatusWrapper& status);
  void apply(const EgoVelocityConfig& config);
  /// Why nothing is estimated: the parameters cannot be used, or a velocity of the wrong sign might come of a
  /// default. Empty: it is.
  std::string disabledBy() const;

  void onCloud(std::size_t radar, const sensor_msgs::PointCloud2ConstPtr& cloud);
  std::shared_ptr<const RadarReading> read(Radar& radar, const sensor_msgs::PointCloud2ConstPtr& cloud);
  void addScan(std::size_t radar, const sensor_msgs::PointCloud2ConstPtr& cloud);
  void refuse(Radar& radar, const std::string& cause);
  void warnOfSilentRadars();
  void clearHistory(const ros::Time& stamp);

  void processSweep(const Sweep& sweep);
  /// The mount of a scan; none, with the reason in `error`, where it is not known.
  std::optional<Eigen::Isometry3d> mountOf(Radar& radar, const std::string& frame, std::string& error);
  void publishStatus(const ros::Time& stamp, const EgoVelocityResult& result, const Readings& readings,
                     const std::string& reason, double computation_time);
  void publishTwist(const ros::Time& stamp, const SweepEstimate& estimate);
  void publishClouds(const Readings& readings, const EgoVelocityResult& result);

  std::unique_ptr<Extrinsics> extrinsics_;
  std::vector<std::unique_ptr<Radar>> radars_;
  std::string configuration_error_;  // of the radars
  EgoVelocityConfig config_;         // in force
  StreamExpectation expectation_;
  std::optional<Assembler> assembler_;
  std::vector<Sweep> completed_;  // kept between calls for its memory
  SweepEstimator estimator_;
  std::unique_ptr<MaskInput> mask_;
  ClockWatch clock_;
  std::map<std::string, ros::WallTime> mount_missing_since_;  // by frame

  ros::Publisher twist_publisher_, raw_twist_publisher_, status_publisher_, static_publisher_,
      dynamic_publisher_;
  LogThrottle throttle_;
  std::unique_ptr<ReconfigureServer<EgoVelocityConfig>> server_;
  std::unique_ptr<EstimatorMonitor> estimator_monitor_;
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
  ros::WallTimer diagnostics_timer_, silence_timer_;
};

}  // namespace radar_dot
