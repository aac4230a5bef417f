// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/dataset/point_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "fixtures/files.h"
#include "fixtures/pcd_writer.h"
#include "fixtures/refusal.h"
#include "radar_dot/dataset/tables.h"

namespace radar_dot::dataset {
namespace {

using test::PcdContent;
using test::PcdField;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class PointFiles : public ::testing::Test {
 protected:
  PointCloud read(const PcdContent& content) { return readText(test::formatPcd(content)); }
  PointCloud readText(const std::string& text) {
    test::writeFile(file_, text);
    return readPcd(file_);
  }
  void expectError(const std::string& text, const std::vector<std::string>& parts) {
    test::writeFile(file_, text);
    test::expectRefusal<DatasetError>([&] { readPcd(file_); }, parts);
    test::expectRefusal<DatasetError>([&] { readPcd(file_); }, {file_.string()});
  }
  test::TemporaryFolder folder_;
  std::filesystem::path file_ = folder_.path() / "points.pcd";
};

/// A field of one record.
double scalar(const PointCloud& cloud, std::size_t record, const std::string& name) {
  const PointField* field = findField(cloud.fields, name);
  if (field == nullptr) throw std::out_of_range("no field " + name);
  return readScalar(cloud.view().point(record) + field->offset, field->type);
}

void expectContent(const PointCloud& cloud, const PcdContent& content) {
  ASSERT_EQ(cloud.size, content.records.size());
  std::size_t step = 0;
  for (const PcdField& field : content.fields) step += static_cast<std::size_t>(field.size);
  ASSERT_EQ(cloud.point_step, step) << "no gaps";
  ASSERT_EQ(cloud.data.size(), step * cloud.size);
  ASSERT_EQ(cloud.fields.size(), content.fields.size());
  for (std::size_t record = 0; record < cloud.size; ++record) {
    for (std::size_t column = 0; column < content.fields.size(); ++column) {
      const PcdField& field = content.fields[column];
      const double given = content.records[record][column];
      const double expected =
          field.type == 'F' && field.size == 4 ? static_cast<double>(static_cast<float>(given)) : given;
      const double actual = scalar(cloud, record, field.name);
      EXPECT_TRUE(actual == expected || (std::isnan(actual) && std::isnan(expected)))
          << field.name << ": " << actual << ", not " << expected;
    }
  }
}

TEST_F(PointFiles, NuscenesLayoutWithPadding) {
  PcdContent content;
  content.fields = test::nuscenesRadarFields();
  content.padding = 4096;
  for (int i = 0; i < 125; ++i) {
    std::vector<double> record;
    for (int k = 0; k < 18; ++k) record.push_back((i * 18 + k) % 100);
    content.records.push_back(record);
  }
  const PointCloud cloud = read(content);
  EXPECT_EQ(cloud.point_step, 43U);
  EXPECT_EQ(std::filesystem::file_size(file_) % 4096, 0U);
  expectContent(cloud, content);
  EXPECT_EQ(findField(cloud.fields, "id")->type, ScalarType::kInt16);
  EXPECT_EQ(findField(cloud.fields, "vx_comp")->offset, 27U);
}

TEST_F(PointFiles, EveryType) {
  PcdContent content;
  content.fields = {{"i1", 'I', 1}, {"u1", 'U', 1}, {"i2", 'I', 2}, {"u2", 'U', 2},
                    {"i4", 'I', 4}, {"u4", 'U', 4}, {"f4", 'F', 4}, {"f8", 'F', 8}};
  content.records = {{-128, 255, -32768, 65535, -2147483648.0, 4294967295.0, 0.1, 1e300},
                     {127, 0, 32767, 0, 2147483647, 0, -1e-30, -0.5},
                     {0, 0, 0, 0, 0, 0, kNan, std::numeric_limits<double>::infinity()}};
  expectContent(read(content), content);
}

TEST_F(PointFiles, AnySubsetAndOrderOfTheFields) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 50; ++trial) {
    PcdContent content;
    content.fields = test::nuscenesRadarFields();
    std::shuffle(content.fields.begin(), content.fields.end(), random);
    content.fields.resize(1 + random() % content.fields.size());
    for (std::size_t record = 0; record < random() % 5; ++record) {
      content.records.emplace_back();
      for (std::size_t i = 0; i < content.fields.size(); ++i)
        content.records.back().push_back(static_cast<double>(random() % 128));
    }
    SCOPED_TRACE("trial " + std::to_string(trial) + ", seed 3");
    expectContent(read(content), content);
  }
}

TEST_F(PointFiles, ZeroPointsAreACloud) {
  PcdContent content;
  content.fields = test::nuscenesRadarFields();
  for (const std::size_t padding : {0U, 4096U}) {
    content.padding = padding;
    const PointCloud cloud = read(content);
    EXPECT_EQ(cloud.size, 0U);
    EXPECT_EQ(cloud.fields.size(), 18U);
    EXPECT_TRUE(cloud.data.empty());
  }
}

TEST_F(PointFiles, LinesMayEndAsOnWindows) {
  const PointCloud cloud = readText(
      "FIELDS x\r\nSIZE 4\r\nTYPE F\r\nCOUNT 1\r\nWIDTH 0\r\nHEIGHT 1\r\nPOINTS 0\r\nDATA binary\r\n");
  EXPECT_EQ(fieldNames(cloud.fields), "x");
}

TEST_F(PointFiles, TruncationNamesTheRecord) {
  PcdContent content;
  content.fields = test::nuscenesRadarFields();
  content.records.assign(10, std::vector<double>(18, 1.0));
  const std::string binary = test::formatPcd(content);
  const std::size_t start = binary.size() - 430;
  expectError(binary.substr(0, start + 7 * 43), {"record 7 of 10", "incomplete"});
  expectError(binary.substr(0, start + 8 * 43 - 1), {"record 7 of 10"});
  expectError(binary.substr(0, start), {"record 0 of 10"});
}

TEST_F(PointFiles, WhatFollowsTheRecordsMustBePadding) {
  PcdContent content;
  content.fields = test::nuscenesRadarFields();
  content.records.assign(10, std::vector<double>(18, 1.0));
  std::string text = test::formatPcd(content);
  for (const auto& [from, to] : {std::pair("WIDTH 10", "WIDTH 9"), {"POINTS 10", "POINTS 9"}})
    text.replace(text.find(from), std::string(from).size(), to);
  expectError(text, {"behind the last of 9 records of 43 bytes"});
}

// A lidar scan, a radar list without range rates, and a radar scan of another data set.
TEST_F(PointFiles, ARadarScanHasAVelocity) {
  PcdContent content;
  for (const auto& [names, is_radar] : {std::pair(std::vector{"x", "y", "z", "intensity"}, false),
                                        {std::vector{"x", "y", "z", "rcs"}, false},
                                        {std::vector{"x", "y", "z", "vrel_x"}, true},
                                        {std::vector{"x", "y", "z", "Doppler"}, true}}) {
    content.fields.clear();
    for (const char* name : names) content.fields.push_back({name});
    content.records = {{1, 2, 3, 4}};
    test::writeFile(file_, test::formatPcd(content));
    if (is_radar)
      EXPECT_EQ(readRadarPcd(file_).size, 1U);
    else
      test::expectRefusal<DatasetError>([&] { readRadarPcd(file_); },
                                        {file_.string(), "is no radar scan", names[3]});
  }
}

TEST_F(PointFiles, HeaderErrorsNameTheLine) {
  const std::string tail = "WIDTH 0\nHEIGHT 1\nPOINTS 0\nDATA binary\n";
  const std::string head = "FIELDS x y\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\n";
  const std::string size = "WIDTH 0\nHEIGHT 1\n";
  expectError(head + "WIDTH 5\nHEIGHT 1\nPOINTS 4\nDATA binary\n",
              {"header line 7", "POINTS is 4", "WIDTH x HEIGHT is 5"});
  for (const char* data : {"zip", "", "binary 1"})
    expectError(head + size + "POINTS 0\nDATA " + data + "\n",
                {"header line 8", "DATA must be ascii, binary or binary_compressed"});
  expectError(head + size + "POINTS many\nDATA binary\n",
              {"header line 7", "POINTS must be one whole number"});
  expectError(head + size + "POINTS -1\nDATA binary\n", {"header line 7", "POINTS must be one whole number"});
  expectError(head + size + "DATA binary\n", {"no POINTS"});
  expectError("SIZE 4\nTYPE F\n" + tail, {"no FIELDS"});
  expectError("FIELDS x y\nTYPE F F\nCOUNT 1 1\n" + tail, {"no SIZE"});
  expectError("FIELDS x y\nSIZE 4\nTYPE F F\nCOUNT 1 1\n" + tail,
              {"header line 2", "SIZE has 1 values for 2 FIELDS"});
  expectError("FIELDS x y\nSIZE 4 4\nTYPE F\nCOUNT 1 1\n" + tail, {"header line 3", "TYPE has 1 values"});
  expectError("FIELDS x y\nSIZE 4 4\nTYPE F F\nCOUNT 1\n" + tail, {"header line 4", "COUNT has 1 values"});
  expectError("FIELDS x y\nSIZE 4 4\nTYPE F F\nCOUNT 1 3\n" + tail,
              {"header line 4", "field 'y' has COUNT 3, must be 1"});
  expectError("FIELDS x y\nSIZE 4 8\nTYPE F I\nCOUNT 1 1\n" + tail,
              {"header line 3", "field 'y' has TYPE I of SIZE 8"});
  expectError("FIELDS x y\nSIZE 4 0\nTYPE F F\nCOUNT 1 1\n" + tail,
              {"header line 3", "field 'y' has TYPE F of SIZE 0"});
  expectError("FIELDS x _\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\n" + tail,
              {"header line 1", "field '_' is padding"});
  expectError("FIELDS x x\nSIZE 4 4\nTYPE F F\nCOUNT 1 1\n" + tail,
              {"header line 1", "field 'x' appears twice"});
  expectError("FIELDS\nSIZE\nTYPE\nCOUNT\n" + tail, {"header line 1", "no fields"});
  expectError("hello\n", {"header line 1", "'hello' is no entry"});
  expectError(head, {"no DATA line"});
  expectError("", {"no DATA line"});
}

TEST_F(PointFiles, HugeCountsAreTruncationsNotAllocations) {
  const std::string head = "FIELDS x\nSIZE 4\nTYPE F\nCOUNT 1\nHEIGHT 1\n";
  expectError(head + "WIDTH 400000000\nPOINTS 400000000\nDATA binary\n", {"record 0 of 400000000"});
  expectError(head + "WIDTH 0\nPOINTS 99999999999999999999\nDATA binary\n", {"POINTS must be"});
}

/// A file of three fields.
std::string asciiFile(int points, const std::string& records) {
  const std::string count = std::to_string(points);
  return "FIELDS x n big\nSIZE 4 1 8\nTYPE F I F\nCOUNT 1 1 1\nWIDTH " + count + "\nHEIGHT 1\nPOINTS " +
         count + "\nDATA ascii\n" + records;
}

TEST_F(PointFiles, RecordsMayBeAscii) {
  PcdContent content;
  content.fields = {{"x"}, {"n", 'I', 1}, {"big", 'F', 8}};
  content.records = {{0.1, -128, 1e300}, {kNan, 127, -std::numeric_limits<double>::infinity()}};
  const std::string records = "0.1 -128 1e300\n\r\n \tnan\t127 -inf\r\n";
  expectContent(readText(asciiFile(2, records)), content);
  expectContent(readText(asciiFile(2, records + "what follows\n")), content);
  content.records.pop_back();
  expectContent(readText(asciiFile(1, "0.1 -128 1e300")), content);
  EXPECT_EQ(readText(asciiFile(0, "")).size, 0U);
}

TEST_F(PointFiles, AsciiErrorsNameTheRecord) {
  expectError(asciiFile(2, "0 0 0\n"), {"record 1 of 2", "incomplete"});
  expectError(asciiFile(400000000, "0 0 0\n"), {"record 1 of 400000000"});
  expectError(asciiFile(2, "0 0 0\n0 0\n"), {"record 1", "2 values for 3 FIELDS"});
  for (const char* word : {"-", "0x", "1.5", "128", "-129", "nan", "2e9"})
    expectError(asciiFile(2, std::string("0 0 0\n0 ") + word + " 0\n"),
                {"record 1", "'" + std::string(word) + "' is no value for the field 'n'"});
  expectError(asciiFile(1, "zero 0 0\n"), {"record 0", "'zero' is no value for the field 'x'"});
}

TEST_F(PointFiles, MissingFilesAreNamed) {
  test::expectRefusal<DatasetError>([&] { readPcd(folder_.path() / "absent.pcd"); },
                                    {"absent.pcd", "cannot open"});
  test::expectRefusal<DatasetError>([&] { readLidarBin(folder_.path() / "absent.bin"); },
                                    {"absent.bin", "cannot open"});
  test::expectRefusal<DatasetError>([&] { readPcd(folder_.path()); }, {folder_.path().string()});
}

TEST_F(PointFiles, LidarRecordsOfFiveFloats) {
  const float values[10] = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10};
  const std::string bytes(reinterpret_cast<const char*>(values), sizeof values);
  test::writeFile(file_, bytes);
  const PointCloud cloud = readLidarBin(file_);
  ASSERT_EQ(cloud.size, 2U);
  EXPECT_EQ(cloud.point_step, 20U);
  EXPECT_EQ(fieldNames(cloud.fields), "x, y, z, intensity, ring");
  EXPECT_EQ(scalar(cloud, 0, "x"), 1.0);
  EXPECT_EQ(scalar(cloud, 1, "intensity"), 9.0);
  EXPECT_EQ(scalar(cloud, 1, "ring"), 10.0);
  test::writeFile(file_, bytes.substr(0, 39));
  test::expectRefusal<DatasetError>([&] { readLidarBin(file_); },
                                    {"39 bytes are no multiple", file_.string()});
  test::writeFile(file_, "");
  EXPECT_EQ(readLidarBin(file_).size, 0U);
}

// Each file has a whole number of 20 byte records.
TEST_F(PointFiles, OtherFilesAreNoLidarScans) {
  const auto expectRefused = [this](const std::string& bytes, const std::string& part) {
    ASSERT_EQ(bytes.size() % 20, 0U);
    test::writeFile(file_, bytes);
    test::expectRefusal<DatasetError>([&] { readLidarBin(file_); }, {file_.string(), part});
  };
  // A ring of 32 beams of 40 points: x y z intensity [ring [time]], as float or double.
  const auto scan = [](std::size_t columns, auto zero) {
    std::string bytes;
    for (int i = 0; i < 1280; ++i) {
      const int column = i / 32;
      const double angle = 0.1571 * column;
      const double values[6] = {20.5 * std::cos(angle), 20.5 * std::sin(angle), 0.1 * (i % 32) - 1.84,
                                i % 256 * 1.0,          i % 32 * 1.0,           1e-4 * i};
      for (std::size_t k = 0; k < columns; ++k) {
        const auto value = static_cast<decltype(zero)>(values[k]);
        bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
      }
    }
    return bytes;
  };
  test::writeFile(file_, scan(5, 0.0F));
  EXPECT_EQ(readLidarBin(file_).size, 1280U);
  for (const std::size_t columns : {3U, 4U, 6U})
    expectRefused(scan(columns, 0.0F), "no x y z intensity ring");
  for (const std::size_t columns : {3U, 5U}) expectRefused(scan(columns, 0.0), "no x y z intensity ring");
  expectRefused("# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\n12345", "record 0");
  expectRefused(std::string(2000, '\0'), "zeros alone");
  std::string infinite = scan(5, 0.0F);
  const float infinity = std::numeric_limits<float>::infinity();
  std::memcpy(&infinite[60], &infinity, sizeof infinity);
  expectRefused(infinite, "record 3");
}

}  // namespace
}  // namespace radar_dot::dataset
