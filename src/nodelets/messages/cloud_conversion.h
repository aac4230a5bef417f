// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/PointCloud2.h>

#include <cstdint>
#include <string>
#include <vector>

#include "radar_dot/common/span.h"
#include "radar_dot/radar/doppler_returns.h"
#include "radar_dot/radar/ego_velocity.h"
#include "radar_dot/radar/point_cloud.h"

namespace radar_dot {

/// A view of a message's points, valid while message and `fields` live; `fields` is replaced.
/// @throws std::invalid_argument when the sizes in the message contradict each other or its data
///         are in the other byte order.
PointCloudView viewOf(const sensor_msgs::PointCloud2& cloud, std::vector<PointField>& fields);

/// A cloud with positions: the same one where it has x and y, or lacks the polar fields too. Else one row
/// with all its fields, and behind them x, y and z (float32, m, frame of the sensor) by range (or r), azimuth
/// (anticlockwise) and elevation above the x-y plane (0 where there is none), or azimuth_angle, AzimuthAngle
/// and so on, all without case.
/// @param faults  gets what keeps the polar fields from being used
/// @throws std::invalid_argument as viewOf()
sensor_msgs::PointCloud2ConstPtr withPositions(const sensor_msgs::PointCloud2ConstPtr& cloud, AngleUnit unit,
                                               std::vector<std::string>& faults);

/// The accepted returns of one scan that carry the label `wanted`: every field of the input, bit
/// for bit, and behind them `doppler` (range rate as used, m/s) and `residual` (signed, m/s), both
/// float32. Where the input has a field of that name already, ours is called ego_doppler or
/// ego_residual. Header copied.
/// @param residuals, labels  one for each of `returns`, in their order
sensor_msgs::PointCloud2 labelledCloud(const sensor_msgs::PointCloud2& cloud, const PointCloudView& view,
                                       Span<const DopplerReturn> returns, const float* residuals,
                                       const ReturnLabel* labels, ReturnLabel wanted);

/// The points of a cloud that are kept, every field bit for bit. One row becomes shorter; in an organised
/// cloud (several rows) the others stay in their places with x, y and z of NaN.
/// @param keep  one for each point, in the order of the view: 0 = not kept
/// @throws std::invalid_argument as viewOf(), and for an organised cloud whose x, y and z are no floats
sensor_msgs::PointCloud2Ptr keptCloud(const sensor_msgs::PointCloud2& cloud,
                                      const std::vector<std::uint8_t>& keep);

}  // namespace radar_dot
