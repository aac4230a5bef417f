// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/PointCloud2.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "nodelets/common/stream_nodelet.h"
#include "nodelets/inputs/mask_input.h"
#include "nodelets/inputs/radar_input.h"
#include "nodelets/inputs/rotation_source.h"
#include "radar_dot/config/sections.h"
#include "radar_dot/radar/radar_agreement.h"
#include "radar_dot/radar/range_rate_watch.h"
#include "radar_dot/radar/sweep_assembler.h"
#include "radar_dot/radar/sweep_estimator.h"

namespace radar_dot {

/// Velocity of the vehicle, static and dynamic returns from any number of radars.
class EgoVelocityNodelet : public ConfiguredNodelet<EgoVelocityConfig> {
 public:
  ~EgoVelocityNodelet() override { writeMountYawsFile(); }

 private:
  struct Radar {
    std::string name;
    std::string topic;  // resolved
    RadarMonitor& monitor;
    RadarInput input;
    std::optional<Eigen::Isometry3d> T_base_from_sensor;  // as configured; none: of TF
    std::string published_frame;                          // whose configured mount is on TF
    std::optional<Eigen::Isometry3d> mount;               // the latest, corrected
    RangeRateWatch range_rates;
    sensor_msgs::PointCloud2ConstPtr latest, earlier;
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

  /// The radar with the same topic, in another spelling or by a remapping; empty: there is none.
  std::string sameSourceAs(const RadarEntry& entry) const;
  /// Notes where another radar has sent the same data.
  void lookForTwin(Radar& radar, const RadarReading& reading);
  void setUpRotation();
  /// Starts from the mount yaws of the file, where there is one.
  void readMountYawsFile();
  void writeMountYawsFile() const;
  void onMessage(std::size_t index, const RadarMessage& message);
  /// @return true when there is nothing more to wait for
  bool warnOfSilentRadars();
  /// Topics with messages of radars that are not those of a radar here, for a text.
  std::string otherClouds() const;

  void processSweep(const Sweep& sweep);
  /// The mount of a scan; none, with the reason in `error`, where it is not known.
  std::optional<Eigen::Isometry3d> findMount(Radar& radar, const std::string& frame, std::string& error);
  /// s since TF was asked in vain for the mount of this frame first.
  double missingFor(const std::string& frame);
  /// Puts a configured mount on TF, for all others that use the clouds.
  void publishMount(Radar& radar, const std::string& frame);
  /// Once, when all mounts are known: warns of a model that they do not suit.
  void assessMountsOnce();
  /// Compares the radars with each other, and with the source of rotation.
  void compare(const Sweep& sweep, const std::vector<RadarScan>& scans, const EgoVelocityResult& result,
               const std::optional<AngularVelocity>& rotation);
  void compareWithSource(double time, const std::vector<RadarScan>& scans, const EgoVelocityResult& result,
                         bool has_rotation);
  /// Where the range rates come from, as in "field 'vr' of front, left".
  std::string dopplerSources() const;
  void publishStatus(const ros::Time& stamp, const EgoVelocityResult& result, const Readings& readings,
                     const std::string& reason, double computation_time);
  void publishTwist(const ros::Time& stamp, const SweepEstimate& estimate);
  void publishClouds(const Readings& readings, const std::vector<RadarScan>& scans,
                     const EgoVelocityResult& result);

  std::vector<std::unique_ptr<Radar>> radars_;
  StreamExpectation radar_expectation_;  // of radars and estimates
  std::optional<Assembler> assembler_;
  std::vector<Sweep> completed_;  // kept between calls for its memory
  SweepEstimator estimator_;
  std::string mount_yaws_file_;                 // empty: none, or one that is not understood
  std::map<std::string, MountYaw> mount_yaws_;  // as read, also of radars that are not here
  RadarAgreement agreement_;
  std::string twins_;  // what lookForTwin() has found, for some time
  ros::WallTime twins_until_;
  bool mounts_assessed_ = false;
  std::string mount_advice_;
  std::unique_ptr<RotationSource> rotation_source_;   // none: the returns tell the yaw rate
  std::optional<EgoVelocityEstimator> own_yaw_rate_;  // of the returns alone, beside the source
  std::size_t sweeps_ = 0;
  bool other_clouds_seen_ = false;  // when the silence was looked at last
  std::unique_ptr<MaskInput> mask_;
  std::map<std::string, ros::WallTime> mount_missing_since_;  // by frame

  ros::Publisher twist_publisher_, raw_twist_publisher_, status_publisher_, static_publisher_,
      dynamic_publisher_;
  std::unique_ptr<EstimatorMonitor> estimator_monitor_;
  std::unique_ptr<tf2_ros::StaticTransformBroadcaster> mount_broadcaster_;
  ProcessTimer silence_timer_;
};

}  // namespace radar_dot
