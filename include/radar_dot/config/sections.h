// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "radar_dot/common/fields.h"
#include "radar_dot/config/section.h"
#include "radar_dot/objects/mask_regions.h"
#include "radar_dot/objects/object_detection.h"
#include "radar_dot/objects/object_tracker.h"
#include "radar_dot/radar/doppler_returns.h"
#include "radar_dot/radar/ego_velocity.h"
#include "radar_dot/radar/returns_over_ground.h"
#include "radar_dot/radar/sweep_assembler.h"
#include "radar_dot/radar/sweep_estimator.h"
#include "radar_dot/vision/depth_estimator.h"
#include "radar_dot/vision/mask_footprint.h"
#include "radar_dot/vision/mask_pipeline.h"
#include "radar_dot/vision/optical_flow.h"

// What the nodelets are configured with: one struct per nodelet, one section per nodelet in a YAML file. The
// evaluators read the same sections. A name has one meaning in all of them.
//
// Groups of fields flagged kAtStart are read once; those flagged kLiveOnly have no effect on evaluators.

namespace radar_dot {

/// What is taken for the time of a scan.
enum class StampSource { kHeader, kArrival };
template <>
struct EnumNames<StampSource> {
  static constexpr EnumName<StampSource> kValues[] = {
      {StampSource::kHeader, "header", "the stamp of the message"},
      {StampSource::kArrival, "arrival",
       "when it arrives: for drivers that leave the stamp empty or take it from a clock of the radar"}};
};

/// One radar of the parameter `radars`: what holds for it alone. Read what is effective with extractionOf,
/// rateOf and, of the members, withPreset.
struct RadarEntry {
  std::string topic;
  std::string preset;      ///< a file in config/radars, without .yaml, or a path with a slash
  std::string frame_id;    ///< taken instead of that of the messages
  std::string only_frame;  ///< messages of other frames are of other radars; empty: all are of this one
  std::optional<StampSource> stamp;                           ///< not set: of the header
  std::optional<double> time_offset;                          ///< s, added to the stamp
  std::optional<std::array<double, 3>> mount_xyz, mount_rpy;  ///< m, rad; see mountOf
  double mount_yaw_correction = 0.0;                          ///< rad
  std::optional<double> unambiguous_velocity;                 ///< m/s
  std::map<std::string, FieldValue> overrides;  ///< of ExtractionParams and RateParams, by their names

  void describe(FieldList& fields);
};

/// The entry with the values of its preset where it has none itself, and no preset.
/// @throws InvalidParameter where there is no such preset, or no valid one
RadarEntry withPreset(const RadarEntry& entry);
/// T_base_from_sensor of mount_xyz and mount_rpy (about fixed axes: roll, then pitch, then yaw, as in URDF
/// and static_transform_publisher), without mount_yaw_correction; none where they are not set.
std::optional<Eigen::Isometry3d> mountOf(const RadarEntry& entry);
/// The mount, as set or from elsewhere, with mount_yaw_correction.
Eigen::Isometry3d corrected(const Eigen::Isometry3d& T_base_from_sensor, const RadarEntry& entry);

/// What the diagnostics expect of the inputs of the radar half.
struct RateParams {
  double expected_rate = 13.0;
  double rate_tolerance = 0.3;
  double max_age = 0.5;

  void describe(FieldList& fields);
};

/// Where the rotation of the vehicle comes from.
enum class RotationSourceKind { kRadar, kOdometry, kImu, kTf };
template <>
struct EnumNames<RotationSourceKind> {
  static constexpr EnumName<RotationSourceKind> kValues[] = {
      {RotationSourceKind::kRadar, "radar", "the radars"},
      {RotationSourceKind::kOdometry, "odometry", "the orientation on rotation/odom"},
      {RotationSourceKind::kImu, "imu",
       "angular velocity, and for the attitude of the odometry gravity, on rotation/imu"},
      {RotationSourceKind::kTf, "tf",
       "the orientation of base_frame in rotation_fixed_frame, as something else than the "
       "radars tells it"}};
};

/// A source of rotation besides the radars.
struct RotationParams {
  RotationSourceKind source = RotationSourceKind::kRadar;
  std::string fixed_frame = "map";
  std::string odom_frame = "odom";

  void describe(FieldList& fields);
};

/// Nodelet EgoVelocity, section ego_velocity.
struct EgoVelocityConfig : SweepEstimatorParams {
  std::string base_frame = "base_link";
  std::map<std::string, RadarEntry> radars;
  SweepParams sweep;
  RotationParams rotation;
  int queue_size = 20;
  std::string mount_yaws_file;
  RateParams rate;

  ExtractionParams extraction;
  bool use_mask = false;
  // Keyframes are 0.5 s apart, give or take a tenth, and the mask of a pair belongs to its first image: it is
  // half a second old at the begin of the next pair and a second at its end. This is that second and the
  // tenth. Only the vehicle's own motion since the mask is accounted for: a mover that crosses the view has
  // left its place in an old mask, one that moves along the line of sight has not.
  double mask_max_age = 1.1;
  MaskFootprint footprint;

  void describe(FieldList& fields);
};
/// @throws InvalidParameter of fields, of rules between them, or of one radar as "radars/front"
void validate(const EgoVelocityConfig& config);
/// The common parameters with what the entry and its preset set otherwise. @throws InvalidParameter
ExtractionParams extractionOf(const EgoVelocityConfig& config, const RadarEntry& entry);
RateParams rateOf(const EgoVelocityConfig& config, const RadarEntry& entry);
/// For RadarScan, m/s of range rates as they are scaled: infinite where they are not ambiguous.
double unambiguousVelocityOf(const RadarEntry& entry, const ExtractionParams& extraction);

/// Nodelet Odometry, section odometry.
struct OdometryConfig {
  std::string base_frame = "base_link";
  RotationParams rotation;
  bool start_at_source = false;
  bool publish_tf = true;
  bool publish_source_tf = false;
  RateParams rate;

  double max_gap = 1.0;
  double rotation_timeout = 0.25;
  int path_length = 5000;
  double path_min_distance = 0.5;

  void describe(FieldList& fields);
};

/// Which image of a pair the flow, and with it the mask, belongs to.
enum class FlowDirection { kForward, kBackward };
template <>
struct EnumNames<FlowDirection> {
  static constexpr EnumName<FlowDirection> kValues[] = {
      {FlowDirection::kForward, "forward",
       "from the earlier image to the later: masks at t-1, as in the paper"},
      {FlowDirection::kBackward, "backward",
       "from the later image to the earlier: masks at t, for live use"}};
};

/// What the nodelets of the image half have in common.
struct StreamParams {
  std::string base_frame = "base_link";
  double max_age = 1.0;
  double silent_after = 2.0;

  void describe(FieldList& fields);
};

/// Nodelet OpticalFlow, section optical_flow.
struct OpticalFlowConfig {
  StreamParams stream;
  OpticalFlowParams flow;
  FlowDirection direction = FlowDirection::kForward;
  double pair_interval = 0.0;
  double max_pair_gap = 1.0;
  double expected_timeout = 0.1;

  void describe(FieldList& fields);
};
void validate(const OpticalFlowConfig& config);

/// depth_backend of an external depth on depth/input.
inline constexpr const char* kTopicBackend = "topic";

/// Nodelet Depth, section depth.
struct DepthConfig {
  StreamParams stream;
  std::vector<std::string> radar_topics = {"radar/static"};
  std::vector<std::string> network_radar_topics = {"radar_front"};
  int working_width = 800;
  DepthParams depth;
  double radar_max_age = 0.25;
  double lidar_max_age = 0.1;

  DepthConfig();  // out of line: inlined, GCC 12 takes the lists above for uninitialised
  bool isExternal() const { return depth.backend == kTopicBackend; }
  void describe(FieldList& fields);
};

/// Nodelet DynamicSegmentation, section dynamic_segmentation.
struct DynamicSegmentationConfig : MaskPipelineParams {
  StreamParams stream;
  RotationParams rotation;
  bool full_size = true;
  double radar_max_age = 0.25;
  double input_timeout = 0.5;
  double rotation_timeout = 0.25;
  double max_twist_age = 0.3;

  void describe(FieldList& fields);
};
void validate(const DynamicSegmentationConfig& config);

/// Frame of the objects that are published.
enum class ObjectFrame { kOdom, kBase };
template <>
struct EnumNames<ObjectFrame> {
  static constexpr EnumName<ObjectFrame> kValues[] = {
      {ObjectFrame::kOdom, "odom", "the frame of the messages on odom"},
      {ObjectFrame::kBase, "base", "base_frame at the time of the message"}};
};

/// Nodelet MovingObjects, section moving_objects.
struct MovingObjectsConfig {
  StreamParams stream;
  ObjectFrame frame = ObjectFrame::kOdom;
  OverGroundParams returns;
  DetectionParams detection;
  ObjectTrackerParams tracker;
  bool use_mask = false;
  bool mask_starts_tracks = false;
  MaskRegionParams regions;
  double image_max_age = 1.0;
  double pairing_timeout = 0.2;
  double mask_timeout = 0.5;
  double max_pose_age = 0.5;
  double marker_lifetime = 0.5;

  void describe(FieldList& fields);
};
void validate(const MovingObjectsConfig& config);

/// Nodelet Overlay, section overlay.
struct OverlayConfig {
  StreamParams stream;
  int panel_width = 640;
  double max_flow = 0.0;
  double max_residual = 0.0;
  double max_drawn_depth = 120.0;
  double radar_max_age = 0.25;
  double max_rate = 0.0;

  void describe(FieldList& fields);
};

/// Nodelet StaticWorld, section static_world.
struct StaticWorldConfig {
  StreamParams stream;
  double dilation = 10.0;
  double dilation_rate = 200.0;
  double mask_max_age = 0.5;
  double mask_wait = 1.0;

  void describe(FieldList& fields);
};

/// All nodelets: a whole configuration file.
struct Configuration {
  EgoVelocityConfig ego_velocity;
  OdometryConfig odometry;
  OpticalFlowConfig optical_flow;
  DepthConfig depth;
  DynamicSegmentationConfig dynamic_segmentation;
  MovingObjectsConfig moving_objects;
  OverlayConfig overlay;
  StaticWorldConfig static_world;
};

/// The sections of a configuration, which must outlive them, in the order of the data flow.
std::vector<Section> sectionsOf(Configuration& configuration);

/// Fields and rules of all sections. @throws InvalidParameter
void validate(const Configuration& configuration);

}  // namespace radar_dot
