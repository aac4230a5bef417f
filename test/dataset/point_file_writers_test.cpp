// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <pcl/io/pcd_io.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "fixtures/files.h"
#include "fixtures/pcd_writer.h"
#include "fixtures/refusal.h"
#include "radar_dot/dataset/point_files.h"
#include "radar_dot/dataset/tables.h"

namespace radar_dot::dataset {
namespace {

constexpr const char* kFields[] = {"x",
                                   "y",
                                   "z",
                                   "dyn_prop",
                                   "id",
                                   "rcs",
                                   "vx",
                                   "vy",
                                   "vx_comp",
                                   "vy_comp",
                                   "is_quality_valid",
                                   "ambig_state",
                                   "x_rms",
                                   "y_rms",
                                   "invalid_state",
                                   "pdh0",
                                   "vx_rms",
                                   "vy_rms"};

/// Field k of record i is i + 1.25 k, cut to whole numbers where the field holds those.
std::vector<RadarRecord> someRecords(int count) {
  std::vector<RadarRecord> records;
  for (int i = 0; i < count; ++i) {
    const auto real = [i](int k) { return static_cast<float>(i) + 1.25F * static_cast<float>(k); };
    const auto whole = [&](int k) { return static_cast<std::int8_t>(real(k)); };
    records.push_back({real(0), real(1), real(2), whole(3), whole(4), real(5), real(6), real(7), real(8),
                       real(9), whole(10), whole(11), whole(12), whole(13), whole(14), whole(15), whole(16),
                       whole(17)});
  }
  return records;
}

class PointFileWriters : public ::testing::Test {
 protected:
  std::filesystem::path file() const { return folder_.path() / "points"; }
  test::TemporaryFolder folder_;
};

TEST_F(PointFileWriters, RadarRecordsComeBack) {
  writeRadarPcd(file(), someRecords(100));
  const PointCloud cloud = readPcd(file());
  ASSERT_EQ(cloud.size, 100U);
  EXPECT_EQ(cloud.point_step, 43U);
  ASSERT_EQ(cloud.fields.size(), 18U);
  for (std::size_t k = 0; k < cloud.fields.size(); ++k) {
    const PointField& field = cloud.fields[k];
    EXPECT_EQ(field.name, kFields[k]);
    for (std::size_t i = 0; i < cloud.size; ++i) {
      const double exact = static_cast<double>(i) + 1.25 * static_cast<double>(k);
      const double value = readScalar(cloud.data.data() + 43 * i + field.offset, field.type);
      EXPECT_EQ(value, field.type == ScalarType::kFloat32 ? exact : std::floor(exact))
          << field.name << " " << i;
    }
  }
}

TEST_F(PointFileWriters, RadarFilesHaveTheHeaderOfNuscenesAndNoPadding) {
  for (const int count : {1, 125}) {
    writeRadarPcd(file(), std::vector<RadarRecord>(static_cast<std::size_t>(count)));
    test::PcdContent content;
    content.fields = test::nuscenesRadarFields();
    content.records.assign(static_cast<std::size_t>(count), std::vector<double>(18, 0.0));
    EXPECT_EQ(test::readFile(file()), test::formatPcd(content));
    EXPECT_EQ(readPcd(file()).size, static_cast<std::size_t>(count));
  }
}

TEST_F(PointFileWriters, AScanWithoutReturnsIsOneRecordOfNan) {
  writeRadarPcd(file(), {});
  const PointCloud cloud = readPcd(file());
  ASSERT_EQ(cloud.size, 1U);
  for (const PointField& field : cloud.fields) {
    const double value = readScalar(cloud.data.data() + field.offset, field.type);
    EXPECT_EQ(std::isnan(value), field.type == ScalarType::kFloat32) << field.name;
  }
}

TEST_F(PointFileWriters, ExtremeRadarValuesComeBack) {
  RadarRecord record;
  record.x = -1e30F;
  record.id = -32768;
  record.dyn_prop = 127;
  record.vy_rms = -128;
  writeRadarPcd(file(), {record});
  const PointCloud cloud = readPcd(file());
  const auto value = [&](const char* name) {
    const PointField* field = findField(cloud.fields, name);
    return readScalar(cloud.data.data() + field->offset, field->type);
  };
  EXPECT_EQ(value("x"), static_cast<double>(-1e30F));
  EXPECT_EQ(value("id"), -32768.0);
  EXPECT_EQ(value("dyn_prop"), 127.0);
  EXPECT_EQ(value("vy_rms"), -128.0);
}

TEST_F(PointFileWriters, WhatPclMakesOfAFileIsTheSame) {
  std::vector<RadarRecord> records = someRecords(100);
  records[7].vx = std::nanf("");
  writeRadarPcd(file(), records);
  const PointCloud cloud = readPcd(file());
  pcl::PCLPointCloud2 blob;
  ASSERT_EQ(pcl::PCDReader().read(file(), blob), 0);
  const Eigen::Vector4f origin = Eigen::Vector4f::Zero();
  const Eigen::Quaternionf orientation = Eigen::Quaternionf::Identity();
  const auto expect_same = [&] {
    const PointCloud read = readPcd(file());
    EXPECT_EQ(read.fields, cloud.fields);
    EXPECT_EQ(read.data, cloud.data);
  };
  ASSERT_EQ(pcl::PCDWriter().writeASCII(file(), blob, origin, orientation, 9), 0);
  expect_same();
  ASSERT_EQ(pcl::PCDWriter().writeBinaryCompressed(file(), blob, origin, orientation), 0);
  expect_same();
}

TEST_F(PointFileWriters, DamagedCompressedDataAreNeitherReadNorTrusted) {
  writeRadarPcd(file(), someRecords(100));
  pcl::PCLPointCloud2 blob;
  ASSERT_EQ(pcl::PCDReader().read(file(), blob), 0);
  ASSERT_EQ(pcl::PCDWriter().writeBinaryCompressed(file(), blob), 0);
  std::string whole = test::readFile(file());
  const std::size_t body = whole.find("compressed\n") + 11;
  std::uint32_t packed = 0;
  std::memcpy(&packed, &whole[body], sizeof packed);
  whole.resize(body + 8 + packed);  // PCL fills the page
  const auto expect_refusal = [&](const std::string& text) {
    test::writeFile(file(), text);
    ::testing::internal::CaptureStderr();
    test::expectRefusal<DatasetError>([&] { readPcd(file()); }, {file().string(), "compressed data"});
    EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  };
  for (std::size_t size = body; size < whole.size(); size += 7) expect_refusal(whole.substr(0, size));
  expect_refusal(std::string(whole).replace(body, 4, "\xFF\xFF\xFF\xFF"));
  expect_refusal(std::string(whole).replace(body + 4, 4, "\xFF\xFF\xFF\xFF"));
  expect_refusal(std::string(whole).replace(body + 8, whole.size(), whole.size() - body - 8, '\xFF'));
  // 4 GB out of 20 bytes.
  expect_refusal(
      "FIELDS x\nSIZE 4\nTYPE U\nCOUNT 1\nWIDTH 999999999\nHEIGHT 1\nPOINTS 999999999\n"
      "DATA binary_compressed\n" +
      std::string("\x14\0\0\0\xFC\x27\x6B\xEE", 8) + std::string(20, '\0'));
}

TEST_F(PointFileWriters, LidarRecordsComeBack) {
  std::vector<LidarRecord> records;
  for (int i = 0; i < 20000; ++i) {
    const auto n = static_cast<float>(i);
    records.push_back({n / 3.0F, -n, 0.5F * n, static_cast<float>(i % 256), static_cast<float>(i % 32)});
  }
  writeLidarBin(file(), records);
  const PointCloud cloud = readLidarBin(file());
  ASSERT_EQ(cloud.size, records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    LidarRecord read;
    std::memcpy(&read, cloud.data.data() + i * cloud.point_step, sizeof read);
    EXPECT_EQ(read.x, records[i].x);
    EXPECT_EQ(read.y, records[i].y);
    EXPECT_EQ(read.z, records[i].z);
    EXPECT_EQ(read.intensity, records[i].intensity);
    EXPECT_EQ(read.ring, records[i].ring);
  }
  writeLidarBin(file(), {});
  EXPECT_EQ(readLidarBin(file()).size, 0U);
}

TEST_F(PointFileWriters, FilesThatCannotBeWrittenAreNamed) {
  const std::filesystem::path nowhere = folder_.path() / "missing/points";
  test::expectRefusal<DatasetError>([&] { writeRadarPcd(nowhere, {}); },
                                    {nowhere.string(), "cannot write", "No such file"});
  test::expectRefusal<DatasetError>([&] { writeLidarBin(nowhere, {}); },
                                    {nowhere.string(), "cannot write", "No such file"});
  // A device that is always full.
  test::expectRefusal<DatasetError>([] { writeRadarPcd("/dev/full", someRecords(1)); },
                                    {"/dev/full", "No space left"});
  test::expectRefusal<DatasetError>([] { writeLidarBin("/dev/full", std::vector<LidarRecord>(50000)); },
                                    {"/dev/full", "No space left"});
}

}  // namespace
}  // namespace radar_dot::dataset
