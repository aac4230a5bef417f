// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// A 4D radar that the defaults were not made for, with its preset: a recorded drive, read and estimated as by
// the nodelet.
#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "bag/bag_reading.h"
#include "nodelets/inputs/radar_input.h"
#include "nodelets/messages/cloud_conversion.h"
#include "radar_dot/common/quantile.h"
#include "radar_dot/radar/sweep_estimator.h"

namespace radar_dot::test {
namespace {

const std::filesystem::path kBag =
    std::filesystem::path(RADAR_DOT_SHARED_DATA) / "msc_rad4r" / "urban_0_231.bag";

// The radar's own ego speed, which it has added to every range rate: recoveredSpeed = v + doppler /
// cos(azimuth).
double ownSpeed(const sensor_msgs::PointCloud2& cloud) {
  std::vector<PointField> fields;
  const PointCloudView view = viewOf(cloud, fields);
  const auto read = [&](const char* name, std::size_t i) {
    const PointField& field = *findField(fields, name);
    return readScalar(view.point(i) + field.offset, field.type);
  };
  std::vector<double> speeds;
  for (std::size_t i = 0; i < view.size(); ++i) {
    const double azimuth = std::atan2(read("y", i), read("x", i));
    if (std::abs(azimuth) < 1.0)
      speeds.push_back(read("recoveredSpeed", i) - read("doppler", i) / std::cos(azimuth));
  }
  return quantileOf(speeds);
}

struct MeanError {
  double sum = 0.0;
  std::size_t count = 0;
  void add(double error) { sum += std::abs(error), ++count; }
  double value() const { return sum / static_cast<double>(count); }
};

TEST(ForeignRadar, ForwardSpeedOfAnOculiiEagle) {
  if (!std::filesystem::exists(kBag)) GTEST_SKIP() << kBag << " is not there";
  EgoVelocityConfig config;
  config.filter = false;
  config.estimator.model = MotionModel::kAckermann;
  RadarEntry& entry = config.radars["front"];
  entry.topic = "radar/points";
  entry.preset = "oculii_eagle";
  entry = withPreset(entry);
  RadarInput input(entry);
  input.setExtractor(DopplerExtractor(extractionOf(config, entry)));
  SweepEstimator estimator(config);
  Eigen::Isometry3d T_base_from_sensor = Eigen::Isometry3d::Identity();
  T_base_from_sensor.translation() << 3.55, 0.0, 0.69;

  MeanError all, straight, standing;
  std::size_t frame = 0;
  BagReader bag(kBag);
  for (const auto& cloud : bag.messages<sensor_msgs::PointCloud2>("/radar/points")) {
    RadarMessage message;
    message.header = cloud->header;
    message.cloud = cloud;
    RadarReading reading;
    input.read(
        message, cloud->header.stamp, [](const std::string&, std::string&) { return std::nullopt; }, reading);
    std::vector<RadarScan> scans = {{reading.returns, T_base_from_sensor, cloud->header.stamp.toSec(), 0}};
    const auto output = estimator.estimate(scans, scans.front().time).output();
    ASSERT_TRUE(output) << "frame " << frame << " is refused";
    const double error = output->linear.x() - ownSpeed(*cloud);
    all.add(error);
    const bool turns = frame >= 82 && frame <= 182;
    if (frame <= 6) standing.add(error);
    if (frame > 6 && !turns) straight.add(error);
    ++frame;
  }
  EXPECT_EQ(frame, 232U);
  EXPECT_LT(all.value(), 0.05);
  EXPECT_LT(straight.value(), 0.02);
  EXPECT_LT(standing.value(), 0.02);
  RecordProperty("mean_absolute_error_mm_per_s", static_cast<int>(1e3 * all.value()));
}

}  // namespace
}  // namespace radar_dot::test
