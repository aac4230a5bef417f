// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <sensor_msgs/CameraInfo.h>

#include <boost/make_shared.hpp>
#include <cmath>
#include <opencv2/core.hpp>

#include "config/config_file.h"
#include "config/mount_yaws.h"
#include "config/mounts_file.h"
#include "fuzz/fuzz_input.h"
#include "fuzz/fuzz_targets.h"
#include "nodelets/inputs/cloud_points.h"
#include "nodelets/inputs/radar_input.h"
#include "nodelets/messages/cloud_conversion.h"
#include "nodelets/messages/image_messages.h"
#include "radar_dot/config/sections.h"

namespace radar_dot::test {
namespace {

std::string_view textOf(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// The first and the last byte of every row are where the image says.
void touch(const cv::Mat& image) {
  expect(image.rows > 0 && image.cols > 0);
  unsigned sum = 0;
  for (int row = 0; row < image.rows; ++row)
    sum += image.ptr(row)[0] + image.ptr(row)[static_cast<std::size_t>(image.cols) * image.elemSize() - 1];
  static volatile unsigned kept;
  kept = sum;
}

/// Without its pixels.
sensor_msgs::Image imageOf(FuzzInput& input) {
  sensor_msgs::Image image;
  image.height = input.number<std::uint32_t>();
  image.width = input.number<std::uint32_t>();
  image.step = input.number<std::uint32_t>();
  image.is_bigendian = input.number<std::uint8_t>();
  image.encoding = input.text();
  return image;
}

}  // namespace

void fuzzConfiguration(const std::uint8_t* data, std::size_t size) {
  static InputFile file;
  file.set(textOf(data, size));
  mayRefuse<ConfigFileError>([] {
    Configuration configuration;
    readConfigFile(file.path(), sectionsOf(configuration));
    mayRefuse<InvalidParameter>([&] { validate(configuration); });
  });
}

void fuzzMounts(const std::uint8_t* data, std::size_t size) {
  static InputFile file;
  file.set(textOf(data, size));
  mayRefuse<ConfigFileError>([] {
    for (const Mount& mount : readMounts(file.path())) expect(mount.isometry().matrix().allFinite());
  });
  mayRefuse<ConfigFileError>([] {
    for (const auto& [name, yaw] : readMountYaws(file.path())) expect(std::isfinite(yaw.yaw));
  });
}

void fuzzPointCloud(const std::uint8_t* data, std::size_t size) {
  FuzzInput input(data, size);
  sensor_msgs::PointCloud2 cloud;
  cloud.header.stamp.sec = input.number<std::uint32_t>();
  cloud.header.frame_id = "radar";
  cloud.height = input.number<std::uint32_t>();
  cloud.width = input.number<std::uint32_t>();
  cloud.point_step = input.number<std::uint32_t>();
  cloud.row_step = input.number<std::uint32_t>();
  cloud.is_bigendian = input.number<std::uint8_t>();
  cloud.fields.resize(input.number<std::uint8_t>() % 24);
  for (sensor_msgs::PointField& field : cloud.fields) {
    field.offset = input.number<std::uint32_t>();
    field.count = input.number<std::uint32_t>();
    field.datatype = input.number<std::uint8_t>();
    field.name = input.text();
  }
  const std::string_view points = input.rest();
  cloud.data.assign(points.begin(), points.end());

  RadarMessage message;
  message.type = "sensor_msgs/PointCloud2";
  message.header = cloud.header;
  message.cloud = boost::make_shared<sensor_msgs::PointCloud2>(cloud);
  mayRefuse<std::invalid_argument>([&] {
    RadarInput radar{RadarEntry()};
    RadarReading reading;
    radar.read(
        message, ros::Time(1.0),
        [](const std::string&, std::string&) { return Eigen::Isometry3d::Identity(); }, reading);
    for (const DopplerReturn& seen : reading.returns) {
      expect(std::isfinite(seen.range) && std::isfinite(seen.doppler) && seen.bearing.allFinite());
      expect(std::isfinite(seen.tangential_speed) && seen.index < reading.view.size());
    }
    const std::vector<float> residuals(reading.returns.size());
    const std::vector<ReturnLabel> labels(reading.returns.size(), ReturnLabel::kStatic);
    const sensor_msgs::PointCloud2 labelled = labelledCloud(
        *reading.cloud, reading.view, reading.returns, residuals.data(), labels.data(), ReturnLabel::kStatic);
    expect(labelled.width == reading.returns.size());
  });
  mayRefuse<std::invalid_argument>([&] {
    for (const CloudPoint& point : pointsOf(cloud)) expect(point.position.allFinite());
    keptCloud(cloud, std::vector<std::uint8_t>(positionsOf(cloud).size()));
  });
}

void fuzzImage(const std::uint8_t* data, std::size_t size) {
  FuzzInput input(data, size);
  const auto image = boost::make_shared<sensor_msgs::Image>(imageOf(input));
  const std::string_view pixels = input.rest();
  image->data.assign(pixels.begin(), pixels.end());
  mayRefuse<std::invalid_argument>([&] { touch(decodedImageOf(image).pixels); });
  mayRefuse<std::invalid_argument>([&] { touch(depthOf(*image)); });
  mayRefuse<std::invalid_argument>([&] { touch(depthStdOf(*image)); });
  mayRefuse<std::invalid_argument>([&] { touch(flowImageOf(*image)); });
  mayRefuse<std::invalid_argument>([&] {
    const cv::Mat depth = depthOf(*image);
    expect(keptDepth(*image, cv::Mat::ones(depth.size(), CV_8UC1))->data == image->data);
  });
}

void fuzzCompressedImage(const std::uint8_t* data, std::size_t size) {
  FuzzInput input(data, size);
  sensor_msgs::CompressedImage image;
  image.format = input.text();
  const std::string_view bytes = input.rest();
  image.data.assign(bytes.begin(), bytes.end());
  mayRefuse<std::invalid_argument>([&] { touch(decodedImageOf(image, 3).pixels); });
  mayRefuse<std::invalid_argument>([&] { touch(decodedImageOf(image, 1).pixels); });
}

void fuzzCameraInfo(const std::uint8_t* data, std::size_t size) {
  FuzzInput input(data, size);
  sensor_msgs::CameraInfo info;
  info.height = input.number<std::uint32_t>();
  info.width = input.number<std::uint32_t>();
  for (double& value : info.K) value = input.number<double>();
  for (double& value : info.P) value = input.number<double>();
  info.D.resize(input.number<std::uint8_t>() % 16);
  for (double& value : info.D) value = input.number<double>();
  for (std::uint32_t* value : {&info.binning_x, &info.binning_y, &info.roi.x_offset, &info.roi.y_offset,
                               &info.roi.width, &info.roi.height})
    *value = input.number<std::uint32_t>();
  info.roi.do_rectify = input.number<std::uint8_t>() % 2;
  distortionDoubt(info);
  mayRefuse<std::invalid_argument>([&] {
    const CameraIntrinsics camera = cameraOf(info);
    expect(camera.fx > 0.0 && camera.fy > 0.0 && std::isfinite(camera.fx * camera.fy));
    expect(std::isfinite(camera.cx) && std::isfinite(camera.cy));
    expect(camera.width > 0 && camera.height > 0);
  });
}

void fuzzFlow(const std::uint8_t* data, std::size_t size) {
  FuzzInput input(data, size);
  Flow flow;
  flow.image_width = input.number<std::uint32_t>();
  flow.image_height = input.number<std::uint32_t>();
  for (sensor_msgs::Image* image : {&flow.valid, &flow.fb_error, &flow.grey, &flow.second_grey, &flow.flow})
    *image = imageOf(input);
  // One after the other, each as long as it says, as far as the input goes.
  std::string_view rest = input.rest();
  for (sensor_msgs::Image* image : {&flow.valid, &flow.fb_error, &flow.grey, &flow.second_grey, &flow.flow}) {
    const std::string_view pixels = rest.substr(0, static_cast<std::uint64_t>(image->step) * image->height);
    image->data.assign(pixels.begin(), pixels.end());
    rest.remove_prefix(pixels.size());
  }
  mayRefuse<std::invalid_argument>([&] {
    const FlowField field = flowOf(flow);
    touch(field.flow);
    if (!field.valid.empty()) touch(field.valid);
    if (!field.fb_error.empty()) touch(field.fb_error);
  });
}

}  // namespace radar_dot::test
