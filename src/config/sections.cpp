// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/config/sections.h"

#include "config/radars.h"

namespace radar_dot {
namespace {

constexpr unsigned kFixed = FieldList::kAtStart | FieldList::kLiveOnly;
constexpr Range kTimeout{0.0, 60.0};

// Parameters that several nodelets have in common, each declared once.

void describeBaseFrame(std::string& base_frame, FieldList& fields) {
  fields.add("base_frame", base_frame,
             "Frame of the vehicle; its origin belongs at the middle of the rear axle");
}

void describeMaxAge(double& max_age, FieldList& fields) {
  fields.add("max_age", max_age, "Age of a message at its arrival above which the diagnostics warn", "s",
             {0.001, 3600.0});
}

void describeRadarMaxAge(double& radar_max_age, FieldList& fields) {
  fields.add("radar_max_age", radar_max_age, "Largest time between the image and a radar scan", "s",
             {0.001, 10.0});
}

void describeRotationTimeout(double& rotation_timeout, FieldList& fields) {
  fields.add("rotation_timeout", rotation_timeout,
             "Longest wait for a rotation from rotation_source; then the rates of the twists are used", "s",
             kTimeout);
}

void describeMaskMaxAge(double& mask_max_age, FieldList& fields) {
  fields.add("mask_max_age", mask_max_age,
             "Largest time between the image of a mask and a scan, image or cloud that it is used for", "s",
             {0.0, 1000.0});
}

void describeUseMask(bool& use_mask, FieldList& fields) {
  fields.add("use_mask", use_mask, "Subscribe dynamic/mask, and use what it shows as moving");
}

}  // namespace

void RateParams::describe(FieldList& fields) {
  fields.add("expected_rate", expected_rate, "Rate of each input, for the diagnostics", "Hz",
             {0.001, 10000.0});
  fields.add("rate_tolerance", rate_tolerance,
             "Deviation from expected_rate above which the diagnostics warn, relative", "", {0.001, 10.0});
  describeMaxAge(max_age, fields);
}

void EgoVelocityConfig::describe(FieldList& fields) {
  fields.group("Radars", FieldList::kAtStart);
  fields.addDictionary(kRadars, radars, "The radars: name -> parameters of each");
  sweep.describe(fields);
  fields.group("Node", kFixed);
  describeBaseFrame(base_frame, fields);
  rotation.describe(fields);
  fields.add("queue_size", queue_size, "Clouds per radar that may wait", "", {1, 1000});
  fields.add("mount_yaws_file", mount_yaws_file,
             "YAML file of mount yaws: the filter starts from them, and writes what it has learnt when the "
             "nodelet ends; empty: none");
  rate.describe(fields);
  fields.group("Returns");
  extraction.describe(fields);
  fields.add("bearing_delay", bearing_delay,
             "Time by which the positions of returns are later than their velocities: in turns bearings are "
             "turned back accordingly",
             "s", {-1.0, 1.0});
  estimator.describe(fields);
  fields.group("Filter");
  fields.add("filter", filter,
             "ego/twist is filtered over the sweeps; ego/twist_raw is always the estimate of one sweep");
  filter_params.describe(fields);
  estimator.sensor.describe(fields);
  fields.group("Mask", FieldList::kLiveOnly);
  describeUseMask(use_mask, fields);
  fields.group("Mask");
  describeMaskMaxAge(mask_max_age, fields);
  footprint.describe(fields);
}

void validate(const EgoVelocityConfig& config) {
  validateFields(config);
  validate(config.extraction);
  validate(config.footprint);
  validateRadars(config);
}

void RotationParams::describe(FieldList& fields) {
  fields.add("rotation_source", source, "Where rotations come from");
  fields.add("rotation_fixed_frame", fixed_frame,
             "World-fixed frame of rotation_source tf, other than odom_frame");
  fields.add("odom_frame", odom_frame, "World-fixed frame of the odometry");
}

void OdometryConfig::describe(FieldList& fields) {
  fields.group("Node", kFixed);
  describeBaseFrame(base_frame, fields);
  rotation.describe(fields);
  fields.add("start_at_source", start_at_source,
             "Start at the first pose of the rotation source (odometry, tf) instead of at the origin");
  fields.add("publish_tf", publish_tf, "Publish the transform from odom_frame to base_frame");
  fields.add("publish_source_tf", publish_source_tf,
             "With start_at_source: publish that odom_frame coincides with the frame of the source");
  rate.describe(fields);
  fields.group("Odometry", FieldList::kLiveOnly);
  fields.add("max_gap", max_gap, "Longest gap between two twists that is integrated over", "s", {0.01, 60.0});
  describeRotationTimeout(rotation_timeout, fields);
  fields.add("path_length", path_length, "Poses kept in the path; the oldest ones are dropped first", "",
             {2, 1000000});
  fields.add("path_min_distance", path_min_distance, "Distance between two poses of the path", "m",
             {0.0, 1000.0});
}

void StreamParams::describe(FieldList& fields) {
  fields.group("Node", kFixed);
  describeBaseFrame(base_frame, fields);
  describeMaxAge(max_age, fields);
  SweepParams::describeSilentAfter(silent_after, fields);
}

void OpticalFlowConfig::describe(FieldList& fields) {
  stream.describe(fields);
  flow.describe(fields);
  fields.group("Pairing", FieldList::kLiveOnly);
  fields.add("direction", direction, "Which image of a pair the flow belongs to");
  fields.add(
      "pair_interval", pair_interval,
      "Least time between the two images of a pair; 0: consecutive images; 0.5: as the keyframes of nuScenes",
      "s", {0.0, 60.0});
  fields.add("max_pair_gap", max_pair_gap, "Images farther apart are no pair", "s", {0.001, 60.0});
  fields.add("expected_timeout", expected_timeout,
             "Longest wait for the depth and velocity that initialisation expected needs", "s", kTimeout);
}

void validate(const OpticalFlowConfig& config) {
  const FieldList fields = fieldsOf(config);
  checkFields(fields);
  requireLess(fields, config.pair_interval, config.max_pair_gap);
}

DepthConfig::DepthConfig() = default;

void DepthConfig::describe(FieldList& fields) {
  stream.describe(fields);
  fields.add("radar_topics", radar_topics, "Clouds of depth_backend radar_ground, remappable");
  fields.add("network_radar_topics", network_radar_topics,
             "Clouds of depth_backend torch: of the radars that its network was trained with, remappable");
  fields.group("Depth");
  describeWorkingWidth(working_width, fields);
  depth.describe(fields);
  fields.group("Pairing");
  describeRadarMaxAge(radar_max_age, fields);
  fields.add("lidar_max_age", lidar_max_age, "Largest time between the image and a lidar sweep", "s",
             {0.001, 10.0});
}

void DynamicSegmentationConfig::describe(FieldList& fields) {
  stream.describe(fields);
  rotation.describe(fields);
  MaskPipelineParams::describe(fields);
  fields.group("Timing", FieldList::kLiveOnly);
  fields.add("full_size", full_size,
             "Mask and valid in the size of the image; otherwise on the grid of the flow");
  fields.add("input_timeout", input_timeout, "Longest wait of a flow for the depth of its two images", "s",
             kTimeout);
  describeRotationTimeout(rotation_timeout, fields);
  fields.group("Timing");
  describeRadarMaxAge(radar_max_age, fields);
  fields.add("max_twist_age", max_twist_age, "Longest time that the latest twist is taken to hold", "s",
             kTimeout);
}

void validate(const DynamicSegmentationConfig& config) {
  validateFields(config);
  validate(config.motion);
}

void MovingObjectsConfig::describe(FieldList& fields) {
  stream.describe(fields);
  fields.add("frame", frame, "Frame of the objects");
  returns.describe(fields);
  detection.describe(fields);
  tracker.describe(fields);
  fields.group("Mask", FieldList::kLiveOnly);
  describeUseMask(use_mask, fields);
  fields.group("Mask");
  fields.add("mask_starts_tracks", mask_starts_tracks,
             "Regions of the mask start tracks; otherwise they only continue those of the radar");
  regions.describe(fields);
  fields.group("Timing");
  fields.add("max_pose_age", max_pose_age, "Longest time that the latest pose and velocity are extrapolated",
             "s", kTimeout);
  fields.group("Timing", FieldList::kLiveOnly);
  fields.add("image_max_age", image_max_age, "Time after which an object counts as not seen in an image", "s",
             kTimeout);
  fields.add("pairing_timeout", pairing_timeout,
             "Longest wait of a static cloud for the dynamic one of its scan, and the other way round", "s",
             kTimeout);
  fields.add("mask_timeout", mask_timeout, "Longest wait of a mask for depth and flow", "s", kTimeout);
  fields.add("marker_lifetime", marker_lifetime, "Time after which the marker of an object disappears", "s",
             kTimeout);
}

void validate(const MovingObjectsConfig& config) {
  validateFields(config);
  validate(config.tracker);
}

void OverlayConfig::describe(FieldList& fields) {
  stream.describe(fields);
  fields.group("Drawing", FieldList::kLiveOnly);
  fields.add("panel_width", panel_width,
             "Width of overlay/mask, if the image is not smaller, and of each of the six panels", "px",
             {64, 3840});
  fields.add("max_flow", max_flow, "Flow that is drawn in pure colour, px of the image; 0: from the image",
             "px", {0.0, 10000.0});
  fields.add("max_residual", max_residual,
             "End of the scale of the flow residual, px of the image; 0: from the image", "px",
             {0.0, 10000.0});
  fields.add("max_drawn_depth", max_drawn_depth, "End of the scale of depth", "m", {1.0, 10000.0});
  describeRadarMaxAge(radar_max_age, fields);
  fields.add("max_rate", max_rate, "Largest rate of each output; 0: one image for every mask", "Hz",
             {0.0, 1000.0});
}

void StaticWorldConfig::describe(FieldList& fields) {
  stream.describe(fields);
  fields.group("Mask", FieldList::kLiveOnly);
  fields.add("dilation", dilation, "What is this near to what moves goes with it", "px", {0.0, 1000.0});
  fields.add("dilation_rate", dilation_rate,
             "In addition, per second between the mask's image and what the mask is used for", "px/s",
             {0.0, 100000.0});
  describeMaskMaxAge(mask_max_age, fields);
  fields.add("mask_wait", mask_wait, "Longest wait of an image, depth or cloud for a mask that is not older",
             "s", kTimeout);
}

std::vector<Section> sectionsOf(Configuration& c) {
  return {{"ego_velocity", "EgoVelocity", fieldsOf(c.ego_velocity)},
          {"odometry", "Odometry", fieldsOf(c.odometry)},
          {"optical_flow", "OpticalFlow", fieldsOf(c.optical_flow)},
          {"depth", "Depth", fieldsOf(c.depth)},
          {"dynamic_segmentation", "DynamicSegmentation", fieldsOf(c.dynamic_segmentation)},
          {"moving_objects", "MovingObjects", fieldsOf(c.moving_objects)},
          {"overlay", "Overlay", fieldsOf(c.overlay)},
          {"static_world", "StaticWorld", fieldsOf(c.static_world)}};
}

void validate(const Configuration& c) {
  validate(c.ego_velocity);
  validate(c.odometry);
  validate(c.optical_flow);
  validate(c.depth);
  validate(c.dynamic_segmentation);
  validate(c.moving_objects);
  validate(c.overlay);
  validate(c.static_world);
}

}  // namespace radar_dot
