// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// Writes what the fuzzers start from: sound data as the tests make them, a folder for each target.
#include <rosbag/bag.h>
#include <sensor_msgs/PointCloud2.h>

#include <array>
#include <exception>
#include <iostream>
#include <opencv2/imgcodecs.hpp>

#include "fixtures/nuscenes_fixture.h"
#include "fuzz/fuzz_input.h"
#include "nodelets/float_cloud.h"
#include "radar_dot/dataset/instance_masks.h"

namespace radar_dot::test {
namespace {

namespace fs = std::filesystem;

/// The first of the files whose path holds `part`.
std::string anyFile(const fs::path& folder, const std::string& part) {
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && entry.path().string().find(part) != std::string::npos)
      return readFile(entry.path());
  throw std::runtime_error("the fixture has no " + part);
}

void writeDataset(const fs::path& corpus) {
  FixtureOptions options = FixtureOptions::tablesOnly();
  options.scan.points = 4;
  options.channels_on_disk = {"RADAR_FRONT", "LIDAR_TOP"};
  options.can_bus = true;
  const NuscenesFixture fixture(options);
  writeFile(corpus / "pcd/binary", anyFile(fixture.dataroot(), "RADAR_FRONT"));
  writeFile(corpus / "pcd/ascii",
            "VERSION 0.7\nFIELDS x y z vx vy\nSIZE 4 4 4 4 4\nTYPE F F F F F\nCOUNT 1 1 1 1 1\nWIDTH 1\n"
            "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\nDATA ascii\n1 2 3 -4.5 nan\n");
  writeFile(corpus / "pcd/compressed",
            std::string("VERSION 0.7\nFIELDS x v\nSIZE 4 1\nTYPE F I\nCOUNT 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS "
                        "2\nDATA binary_compressed\n") +
                ByteWriter().number(12U).number(10U).rest(std::string("\x09", 1)).rest("0123456789").bytes);
  writeFile(corpus / "lidar/points", anyFile(fixture.dataroot(), "LIDAR_TOP").substr(0, 400));
  constexpr const char* kTables[] = {
      "attribute", "calibrated_sensor", "category",    "ego_pose", "instance", "log",       "map",
      "sample",    "sample_annotation", "sample_data", "scene",    "sensor",   "visibility"};
  std::uint8_t number = 0;
  for (const char* table : kTables)
    writeFile(corpus / "tables" / table,
              ByteWriter().number(number++).rest(readFile(fixture.table(table))).bytes);
  number = 0;
  for (const char* part : {"_pose", "_ms_imu", "_zoe_veh_info"}) {
    // The first messages of many.
    const std::string text = anyFile(fixture.dataroot() / "can_bus", part);
    std::size_t end = 0;
    for (int i = 0; i < 3; ++i) end = text.find('}', end + 1);
    writeFile(corpus / "can_bus" / part,
              ByteWriter().number(number++).rest(text.substr(0, end + 1) + "]").bytes);
  }
  writeFile(corpus / "instance_masks/masks", readFile(fixture.table("nuinsseg")));
  cv::Mat mask = cv::Mat::zeros(9, 16, CV_8UC1);
  mask(cv::Rect(4, 2, 3, 5)) = 255;
  writeFile(corpus / "run_lengths/box", ByteWriter()
                                            .number(std::int16_t{9})
                                            .number(std::int16_t{16})
                                            .rest(formatRunLengths(dataset::encodeMask(mask)))
                                            .bytes);
}

void writeConfiguration(const fs::path& corpus) {
  for (const fs::directory_entry& entry : fs::directory_iterator(CONFIG_FOLDER))
    if (entry.path().extension() == ".yaml" && entry.path().filename() != "robot_localization.yaml")
      writeFile(corpus / "configuration" / entry.path().filename(), readFile(entry.path()));
  writeFile(corpus / "mounts/list", "- {parent: base_link, child: radar, x: 3.5, z: .5, yaw: 0.01}\n");
  writeFile(corpus / "mounts/yaws", "radar_front: {yaw: 0.012, std: 0.002}\n");
}

ByteWriter cloudBytes(const sensor_msgs::PointCloud2& cloud) {
  ByteWriter bytes;
  bytes.number(1U).number(cloud.height).number(cloud.width).number(cloud.point_step).number(cloud.row_step);
  bytes.number(cloud.is_bigendian).number(static_cast<std::uint8_t>(cloud.fields.size()));
  for (const sensor_msgs::PointField& field : cloud.fields)
    bytes.number(field.offset).number(field.count).number(field.datatype).text(field.name);
  return bytes.rest({reinterpret_cast<const char*>(cloud.data.data()), cloud.data.size()});
}

ByteWriter imageBytes(std::uint32_t height, std::uint32_t width, std::uint32_t step,
                      const std::string& encoding) {
  return ByteWriter().number(height).number(width).number(step).number(std::uint8_t{0}).text(encoding);
}

void writeMessages(const fs::path& corpus) {
  writeFile(corpus / "point_cloud/vector",
            cloudBytes(floatCloud({"x", "y", "z", "vx", "vy"}, {10, 2, 0, -8, 0, 20, -3, 1, 0, 0})).bytes);
  writeFile(
      corpus / "point_cloud/polar",
      cloudBytes(floatCloud({"range", "azimuth", "elevation", "doppler", "snr"}, {9, 1, 0, -8, 12})).bytes);
  writeFile(corpus / "point_cloud/residual",
            cloudBytes(floatCloud({"x", "y", "z", "residual"}, {9, 1, 0, 2})).bytes);
  const std::tuple<const char*, std::uint32_t> encodings[] = {
      {"mono8", 1}, {"mono16", 2}, {"bgr8", 3},   {"rgb8", 3}, {"bgra8", 4}, {"rgba8", 4},      {"32FC1", 4},
      {"16UC1", 2}, {"32FC2", 8},  {"yuv422", 2}, {"8UC1", 1}, {"8UC3", 3},  {"bayer_rggb8", 1}};
  for (const auto& [encoding, bytes] : encodings)
    writeFile(corpus / "image" / encoding,
              imageBytes(4, 6, 6 * bytes, encoding).rest(std::string(std::size_t{24} * bytes, '\7')).bytes);
  const cv::Mat picture(8, 12, CV_8UC3, cv::Scalar(10, 100, 200));
  for (const char* kind : {".jpg", ".png"}) {
    std::vector<unsigned char> file;
    cv::imencode(kind, picture, file);
    writeFile(
        corpus / "compressed_image" / (kind + 1),
        ByteWriter().text(kind + 1).rest({reinterpret_cast<const char*>(file.data()), file.size()}).bytes);
  }
  ByteWriter camera;
  camera.number(900U).number(1600U);
  for (const double value : {1266.0, 0.0, 816.0, 0.0, 1266.0, 491.0, 0.0, 0.0, 1.0}) camera.number(value);
  for (const double value : {1266.0, 0.0, 816.0, 0.0, 0.0, 1266.0, 491.0, 0.0, 0.0, 0.0, 1.0, 0.0})
    camera.number(value);
  writeFile(corpus / "camera_info/camera", camera.number(std::uint8_t{1}).number(0.1).bytes);
  ByteWriter flow;
  flow.number(6U).number(4U).rest(imageBytes(4, 6, 6, "mono8").bytes);
  flow.rest(imageBytes(4, 6, 24, "32FC1").bytes).rest(imageBytes(4, 6, 48, "32FC2").bytes);
  writeFile(corpus / "flow/whole", flow.rest(std::string(std::size_t{24} * 13, '\1')).bytes);
}

void writeBags(const fs::path& corpus) {
  using rosbag::CompressionType;
  for (const CompressionType compression :
       {CompressionType::Uncompressed, CompressionType::LZ4, CompressionType::BZ2}) {
    fs::create_directories(corpus / "bag");
    rosbag::Bag bag((corpus / "bag" / std::to_string(compression)).string(), rosbag::bagmode::Write);
    bag.setCompression(compression);
    for (int i = 0; i < 3; ++i)
      bag.write("/radar", ros::Time(10.0 + i), floatCloud({"x", "y", "vx"}, {10.F, 1.F, -8.F}));
  }
}

}  // namespace
}  // namespace radar_dot::test

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: write_corpus FOLDER\n";
    return 1;
  }
  try {
    radar_dot::test::writeDataset(argv[1]);
    radar_dot::test::writeConfiguration(argv[1]);
    radar_dot::test::writeMessages(argv[1]);
    radar_dot::test::writeBags(argv[1]);
  } catch (const std::exception& error) {
    std::cerr << "write_corpus: " << error.what() << '\n';
    return 1;
  }
  return 0;
}
