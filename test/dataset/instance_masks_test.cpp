// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/dataset/instance_masks.h"

#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <random>
#include <stdexcept>
#include <string>

#include "fixtures/nuscenes_fixture.h"
#include "fixtures/refusal.h"

namespace radar_dot::dataset {
namespace {

using test::NuscenesFixture;

using Counts = std::vector<std::uint32_t>;

bool equal(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_L1) == 0.0;
}

struct KnownText {
  const char* text;
  int rows;
  int columns;
  Counts counts;
};

/// Worked by hand: groups of five bits, least first, +32 where more follow, +48 to print; from the
/// fourth run on the difference to the run two before.
const KnownText kKnownTexts[] = {
    {"327", 3, 4, {3, 2, 7}},         {"057", 3, 4, {0, 5, 7}},
    {"234NN", 3, 4, {2, 3, 4, 1, 2}},  // 1 - 3 = -2 = 11110b -> 30 + 48 = 'N'
    {"`0`0", 4, 8, {16, 16}},          // 16 has the sign bit, so a zero group follows
    {"o01", 4, 8, {31, 1}},            // 31 + 32 + 48 = 'o', '0'
    {"011a0", 4, 5, {0, 1, 1, 18}},    // 18 - 1 = 17 -> 17 + 32 + 48 = 'a', '0'
    {"0b01_O", 4, 5, {0, 18, 1, 1}},   // 18 -> 'b', '0'; 1 - 18 = -17 = ..1 01111b -> '_', 'O'
    {"PXn[1", 900, 1600, {1440000}}};  // the empty mask of nuInsSeg: 32,8<<5,30<<10,11<<15,1<<20

TEST(RunLengths, KnownTextsBothWays) {
  for (const KnownText& known : kKnownTexts) {
    SCOPED_TRACE(known.text);
    const RunLengthMask mask = parseRunLengths(known.text, known.rows, known.columns);
    EXPECT_EQ(mask.rows, known.rows);
    EXPECT_EQ(mask.columns, known.columns);
    EXPECT_EQ(mask.counts, known.counts);
    EXPECT_EQ(formatRunLengths(mask), known.text);
  }
}

TEST(RunLengths, RunsGoDownTheColumns) {
  const cv::Mat expected = (cv::Mat_<std::uint8_t>(3, 4) << 0, 255, 0, 0, 0, 255, 0, 0, 0, 0, 0, 0);
  EXPECT_TRUE(equal(decodeMask(parseRunLengths("327", 3, 4)), expected));
  EXPECT_EQ(encodeMask(expected).counts, (Counts{3, 2, 7}));
}

TEST(RunLengths, EmptyAndFullMasks) {
  EXPECT_EQ(cv::countNonZero(decodeMask(parseRunLengths("PXn[1", 900, 1600))), 0);
  const cv::Mat full(2, 3, CV_8UC1, cv::Scalar(1));
  EXPECT_EQ(encodeMask(full).counts, (Counts{0, 6}));
  EXPECT_EQ(cv::countNonZero(decodeMask(encodeMask(full)) == 255), 6)
      << "any nonzero pixel belongs to the mask";
}

TEST(RunLengths, AMaskWithoutPixelsIsEmpty) {
  for (const auto& [rows, columns] : {std::pair(0, 0), std::pair(5, 0), std::pair(0, 5)}) {
    const cv::Mat mask = decodeMask(parseRunLengths("", rows, columns));
    EXPECT_EQ(mask.size(), cv::Size(columns, rows));
    EXPECT_EQ(mask.type(), CV_8UC1);
  }
}

TEST(RunLengths, RandomMasksSurviveTheRoundTrip) {
  std::mt19937 random(20);
  for (int trial = 0; trial < 200; ++trial) {
    const int rows = 1 + static_cast<int>(random() % 40);
    const int columns = 1 + static_cast<int>(random() % 60);
    const std::uint_fast32_t stickiness = 1 + random() % 50;  // long and short runs
    cv::Mat mask(rows, columns, CV_8UC1);
    std::uint8_t value = 0;
    for (int column = 0; column < columns; ++column)
      for (int row = 0; row < rows; ++row) {
        if (random() % stickiness == 0) value = static_cast<std::uint8_t>(255 - value);
        mask.at<std::uint8_t>(row, column) = value;
      }
    // Most real masks leave a border free, on some sides or on all.
    if (trial % 2 == 1) {
      mask.rowRange(0, static_cast<int>(random() % 3) % rows) = 0;
      mask.rowRange(rows - static_cast<int>(random() % 3) % rows, rows) = 0;
      mask.colRange(0, static_cast<int>(random() % 3) % columns) = 0;
      mask.colRange(columns - static_cast<int>(random() % 3) % columns, columns) = 0;
    }
    const RunLengthMask encoded = encodeMask(mask);
    const RunLengthMask decoded = parseRunLengths(formatRunLengths(encoded), rows, columns);
    ASSERT_EQ(decoded.counts, encoded.counts) << "trial " << trial << ", seed 20";
    ASSERT_TRUE(equal(decodeMask(decoded), mask)) << "trial " << trial << ", seed 20";
  }
}

TEST(RunLengths, ASubImageIsEncodedLikeACopy) {
  cv::Mat image = cv::Mat::zeros(20, 30, CV_8UC1);
  image(cv::Rect(5, 5, 10, 10)) = 255;
  const cv::Mat part = image(cv::Rect(3, 4, 15, 9));
  EXPECT_EQ(encodeMask(part).counts, encodeMask(part.clone()).counts);
}

TEST(RunLengths, MalformedTextsAreRefused) {
  EXPECT_THROW(parseRunLengths("32", 3, 4), std::invalid_argument) << "adds up to 5, not 12";
  EXPECT_THROW(parseRunLengths("", 3, 4), std::invalid_argument) << "nothing at all";
  EXPECT_THROW(parseRunLengths("32W", 3, 4), std::invalid_argument) << "ends inside a number";
  EXPECT_THROW(parseRunLengths("3 7", 3, 4), std::invalid_argument) << "a letter outside of the alphabet";
  EXPECT_THROW(parseRunLengths("3O7", 3, 4), std::invalid_argument) << "a negative run";
  EXPECT_THROW(parseRunLengths("oooooooooo0", 3, 4), std::invalid_argument) << "a number without end";
  EXPECT_THROW(decodeMask(RunLengthMask{3, 4, {13}}), std::invalid_argument)
      << "would write behind the image";
  EXPECT_THROW(encodeMask(cv::Mat::zeros(3, 4, CV_32FC1)), std::invalid_argument);
}

TEST(InstanceMasks, PolygonsIncludeTheirBorder) {
  InstanceMask instance;
  instance.mask = std::vector<Polygon>{{10, 20, 30, 20, 30, 40, 10, 40}};
  const cv::Mat mask = decodeMask(instance);
  EXPECT_EQ(mask.size(), cv::Size(1600, 900));
  EXPECT_EQ(cv::countNonZero(mask), 21 * 21);
  EXPECT_EQ(cv::countNonZero(mask(cv::Rect(10, 20, 21, 21)) == 255), 21 * 21);
}

TEST(InstanceMasks, PartsAreUnited) {
  InstanceMask instance;
  // Two squares of 21 x 21 that share 11 x 21 pixels: their overlap is no hole.
  instance.mask = std::vector<Polygon>{{10, 20, 30, 20, 30, 40, 10, 40}, {20, 20, 40, 20, 40, 40, 20, 40}};
  EXPECT_EQ(cv::countNonZero(decodeMask(instance)), 31 * 21);
  instance.mask = std::vector<RunLengthMask>{{2, 3, {0, 2, 4}}, {2, 3, {1, 2, 3}}};
  EXPECT_EQ(cv::countNonZero(decodeMask(instance)), 3);
  instance.mask = std::vector<RunLengthMask>{{2, 3, {6}}, {3, 3, {9}}};
  EXPECT_THROW(decodeMask(instance), std::invalid_argument);
}

/// A fixture whose first mask can be replaced by other JSON.
class InstanceMaskFiles : public ::testing::Test {
 protected:
  std::vector<InstanceMask> read(const std::string& mask) {
    const std::string before = test::readFile(fixture_.table("nuinsseg"));
    const std::string key = "\"instance_mask\": ";
    const std::size_t start = before.find(key) + key.size();
    const std::size_t end = before.find(",\n\"attribute_tokens\"", start);
    const std::string after = before.substr(0, start) + mask + before.substr(end);
    const std::filesystem::path file = fixture_.dataroot() / "other.json";
    test::writeFile(file, after);
    return readInstanceMasks(tables_, file);
  }
  void expectError(const std::string& mask, const std::string& complaint) {
    test::expectRefusal<DatasetError>([&] { read(mask); },
                                      {"other.json record 0 (token ", "field 'instance_mask'", complaint});
  }
  /// Of all readings.
  void setImageSize(std::uint16_t rows, std::uint16_t columns) {
    for (SampleData& reading : tables_.sample_data) {
      reading.height = rows;
      reading.width = columns;
    }
  }
  NuscenesFixture fixture_{test::FixtureOptions::tablesOnly()};
  Tables tables_ = Tables::load(fixture_.dataroot());
};

TEST_F(InstanceMaskFiles, RowsReferToReadingsAndInstances) {
  ASSERT_TRUE(hasInstanceMasks(tables_));
  const std::vector<InstanceMask> rows = readInstanceMasks(tables_);
  ASSERT_EQ(rows.size(), 8U) << "two instances in two keyframes of two scenes";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Index reading = tables_.findReading(rows[i].sample_data_token);
    ASSERT_NE(reading, kNone);
    EXPECT_EQ(tables_.filename(tables_.sample_data[static_cast<std::size_t>(reading)]), rows[i].filename);
    EXPECT_EQ(rows[i].category_name, "vehicle.car");
    EXPECT_EQ(isMoving(tables_, rows[i]), i % 2 == 0);
  }
  EXPECT_EQ(rows[0].bounding_box, (std::array<double, 4>{700, 400, 900, 520}));
}

TEST_F(InstanceMaskFiles, TheDynamicMaskIsTheUnionOfTheMovingInstances) {
  const std::vector<InstanceMask> rows = readInstanceMasks(tables_);
  const cv::Rect moving(700, 400, 200, 120);
  const cv::Mat mask = dynamicMask(tables_, {&rows[0], &rows[1]});
  EXPECT_EQ(mask.size(), cv::Size(1600, 900));
  EXPECT_EQ(cv::countNonZero(mask), moving.area());
  EXPECT_EQ(cv::countNonZero(mask(moving) == 255), moving.area());
  EXPECT_EQ(cv::countNonZero(dynamicMask(tables_, {&rows[1]})), 0) << "a parked car is not dynamic";
  EXPECT_EQ(dynamicMask(tables_, {}).size(), cv::Size(1600, 900));
  EXPECT_EQ(cv::countNonZero(dynamicMask(tables_, {})), 0);
}

TEST_F(InstanceMaskFiles, RidersMoveAndEveryMovingAttributeCounts) {
  InstanceMask instance;
  EXPECT_FALSE(isMoving(tables_, instance));
  for (const Attribute& attribute : tables_.attributes) {
    instance.attribute_tokens = {attribute.token};
    EXPECT_EQ(isMoving(tables_, instance), attribute.name != "vehicle.parked") << attribute.name;
  }
}

TEST_F(InstanceMaskFiles, EveryFormOfAMaskIsRead) {
  const auto area = [&](const std::string& mask) { return cv::countNonZero(decodeMask(read(mask).at(0))); };
  EXPECT_EQ(area("[[10, 20, 30.4, 20, 30, 40, 10, 39.6], [50, 60, 51, 60, 51, 61]]"), 21 * 21 + 3);
  EXPECT_EQ(area("[[10, 20, 30.4, 20, 30, 40, 10, 39.6], [50, 60, 51, 60], []]"), 21 * 21);
  EXPECT_EQ(area(R"({"size": [900, 1600], "counts": "PXn[1"})"), 0);
  setImageSize(3, 4);
  EXPECT_EQ(area(R"({"size": [3, 4], "counts": "327"})"), 2);
  EXPECT_EQ(area(R"({"counts": [3, 2, 7], "size": [3, 4]})"), 2);
  EXPECT_EQ(area(R"([{"size": [3, 4], "counts": "327"}, {"size": [3, 4], "counts": [4, 2, 6]}])"), 3);
  const cv::Mat mask = decodeMask(read("[[0, 0, 9, 0, 9, 1, 0, 1]]").at(0));
  EXPECT_EQ(mask.size(), cv::Size(4, 3)) << "polygons are of the size of their image";
  EXPECT_EQ(cv::countNonZero(mask), 4 * 2);
  setImageSize(0, 0);
  EXPECT_EQ(area(R"({"size": [3, 4], "counts": "327"})"), 2) << "the dataset does not say";
}

// The first of the eight instances is left out each time, whatever else the file holds.
TEST_F(InstanceMaskFiles, MasksWithoutAreaOrOfAnotherSizeAreLeftOutAndCounted) {
  for (const auto& [mask, reason] :
       {std::pair("null", "is null"),
        {"[]", "encloses nothing"},
        {"[[]]", "encloses nothing"},
        {"[null]", "encloses nothing"},
        {"[[1, 2, 3, 4]]", "encloses nothing"},
        {R"({"size": [3, 4], "counts": "327"})", "is of 4 x 3 pixels, its image of 1600 x 900"}}) {
    SCOPED_TRACE(mask);
    tables_.left_out = {};
    EXPECT_EQ(read(mask).size(), 7U);
    const auto entries = tables_.left_out.entries();
    ASSERT_EQ(entries.size(), 1U);
    const auto& [what, why] = *entries.begin();
    EXPECT_NE(what.find("other.json"), std::string::npos) << what;
    EXPECT_EQ(why.rfind("1 of 8 instances, the first because: ", 0), 0U) << why;
    EXPECT_NE(why.find(reason), std::string::npos) << why;
  }
}

TEST_F(InstanceMaskFiles, BrokenMasksAreNamed) {
  setImageSize(3, 4);
  expectError(R"({"size": [3, 4], "counts": "32"})", "add up to 5, not to 3 x 4");
  expectError(R"({"size": [3, 4], "counts": [3, 2]})", "add up to 5, not to 3 x 4");
  expectError(R"({"size": [3, 4], "counts": [3, -2, 11]})", "run length that does not fit");
  expectError(R"({"size": [3], "counts": "327"})", "size of two numbers");
  expectError(R"({"size": [3, 1e9], "counts": "327"})", "size of two numbers in 1..");
  expectError(R"({"size": [3, 4]})", "without size or counts");
  expectError(R"({"size": [3, 4], "counts": null})", "counts that are a text or a list");
  expectError(R"([[1, 2, 3, 4, 5, 6, 7]])", "polygon of 7 numbers");
  expectError(R"([[1, 2, 3, 4, "5", 6]])", "no number");
  expectError(R"([[1, 2, 3, 4, 5, 6], {"size": [3, 4], "counts": "327"}])", "mixes run lengths and polygons");
  expectError("[7]", "must hold run lengths");
  expectError("\"327\"", "must be run lengths");
}

TEST_F(InstanceMaskFiles, RowsOfOtherScenesAreLeftOut) {
  LoadOptions options;
  options.scenes = {NuscenesFixture::kTurningScene};
  Tables part = Tables::load(fixture_.dataroot(), options);
  const std::vector<InstanceMask> rows = readInstanceMasks(part);
  ASSERT_EQ(rows.size(), 4U);
  for (const InstanceMask& row : rows) EXPECT_NE(part.findReading(row.sample_data_token), kNone);
}

TEST_F(InstanceMaskFiles, AMissingFileIsNamed) {
  std::filesystem::remove(fixture_.table("nuinsseg"));
  EXPECT_FALSE(hasInstanceMasks(tables_));
  test::expectRefusal<DatasetError>([&] { readInstanceMasks(tables_); },
                                    {"v1.0-mini/nuinsseg.json", "cannot open"});
}

}  // namespace
}  // namespace radar_dot::dataset
