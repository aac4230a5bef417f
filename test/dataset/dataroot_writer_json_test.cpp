// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// What DatarootWriter writes, seen without the package's own readers: field names and types of the
// official tables, every reference, the exact numbers.
#include <gtest/gtest.h>
#include <rapidjson/document.h>

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "dataset/small_scene.h"
#include "fixtures/files.h"
#include "radar_dot/dataset/dataroot_writer.h"

namespace radar_dot::dataset {
namespace {

namespace fs = std::filesystem;
using Fields = std::vector<std::pair<std::string, char>>;

/// Fields of a table in the official order; their types: t text, n whole number, b boolean, l list of
/// texts, 3 and 4 that many numbers, m matrix or empty list, i list of whole numbers, r run lengths.
const std::map<std::string, Fields> kTables = {
    {"category", {{"token", 't'}, {"name", 't'}, {"description", 't'}}},
    {"attribute", {{"token", 't'}, {"name", 't'}, {"description", 't'}}},
    {"visibility", {{"description", 't'}, {"token", 't'}, {"level", 't'}}},
    {"instance",
     {{"token", 't'},
      {"category_token", 't'},
      {"nbr_annotations", 'n'},
      {"first_annotation_token", 't'},
      {"last_annotation_token", 't'}}},
    {"sensor", {{"token", 't'}, {"channel", 't'}, {"modality", 't'}}},
    {"calibrated_sensor",
     {{"token", 't'},
      {"sensor_token", 't'},
      {"translation", '3'},
      {"rotation", '4'},
      {"camera_intrinsic", 'm'}}},
    {"ego_pose", {{"token", 't'}, {"timestamp", 'n'}, {"rotation", '4'}, {"translation", '3'}}},
    {"log", {{"token", 't'}, {"logfile", 't'}, {"vehicle", 't'}, {"date_captured", 't'}, {"location", 't'}}},
    {"scene",
     {{"token", 't'},
      {"log_token", 't'},
      {"nbr_samples", 'n'},
      {"first_sample_token", 't'},
      {"last_sample_token", 't'},
      {"name", 't'},
      {"description", 't'}}},
    {"sample", {{"token", 't'}, {"timestamp", 'n'}, {"prev", 't'}, {"next", 't'}, {"scene_token", 't'}}},
    {"sample_data",
     {{"token", 't'},
      {"sample_token", 't'},
      {"ego_pose_token", 't'},
      {"calibrated_sensor_token", 't'},
      {"timestamp", 'n'},
      {"fileformat", 't'},
      {"is_key_frame", 'b'},
      {"height", 'n'},
      {"width", 'n'},
      {"filename", 't'},
      {"prev", 't'},
      {"next", 't'}}},
    {"sample_annotation",
     {{"token", 't'},
      {"sample_token", 't'},
      {"instance_token", 't'},
      {"visibility_token", 't'},
      {"attribute_tokens", 'l'},
      {"translation", '3'},
      {"size", '3'},
      {"rotation", '4'},
      {"prev", 't'},
      {"next", 't'},
      {"num_lidar_pts", 'n'},
      {"num_radar_pts", 'n'}}},
    {"map", {{"category", 't'}, {"token", 't'}, {"filename", 't'}, {"log_tokens", 'l'}}},
    {"nuinsseg",
     {{"token", 't'},
      {"sample_data_token", 't'},
      {"filename", 't'},
      {"bbox_corners", 'i'},
      {"category_name", 't'},
      {"instance_mask", 'r'},
      {"attribute_tokens", 'l'},
      {"instance_token", 't'},
      {"visibility_token", 't'},
      {"num_lidar_pts", 'n'},
      {"num_radar_pts", 'n'},
      {"prev", 't'},
      {"next", 't'}}}};

/// The table that a field of tokens refers to.
std::string targetOf(const std::string& table, const std::string& field) {
  if (field == "prev" || field == "next") return table;
  if (field.find("first_") == 0 || field.find("last_") == 0)
    return field.find("sample") != std::string::npos ? "sample" : "sample_annotation";
  const std::size_t end = field.rfind("_token");
  return end == std::string::npos ? std::string() : field.substr(0, end);
}

bool isNumberList(const rapidjson::Value& value, std::size_t size) {
  if (!value.IsArray() || value.Size() != size) return false;
  for (const auto& item : value.GetArray())
    if (!item.IsDouble()) return false;
  return true;
}

bool isMatrix(const rapidjson::Value& value) {
  if (!value.IsArray() || (value.Size() != 0 && value.Size() != 3)) return false;
  for (const auto& row : value.GetArray())
    if (!isNumberList(row, 3)) return false;
  return true;
}

bool hasType(const rapidjson::Value& value, char type) {
  switch (type) {
    case 't': return value.IsString();
    case 'n': return value.IsInt64();
    case 'b': return value.IsBool();
    case 'l': return value.IsArray() && (value.Empty() || value[0].IsString());
    case '3': return isNumberList(value, 3);
    case '4': return isNumberList(value, 4);
    case 'm': return isMatrix(value);
    case 'i': return value.IsArray() && value.Size() == 4 && value[0].IsInt();
    case 'r': return value.IsObject() && value["size"].IsArray() && value["counts"].IsString();
    default: return false;
  }
}

class DatarootJsonTest : public ::testing::Test {
 protected:
  void SetUp() override {
    DatarootWriter writer(folder_.path() / "dataroot", "v1.0-sim", false);
    for (const NewScene& scene : scenes_) writer.add(scene);
    writer.finish();
    for (const auto& [table, fields] : kTables) {
      rapidjson::Document& document = documents_[table];
      const std::string text = test::readFile(folder_.path() / "dataroot/v1.0-sim" / (table + ".json"));
      document.Parse<rapidjson::kParseFullPrecisionFlag>(text.c_str(), text.size());
      ASSERT_FALSE(document.HasParseError()) << table;
      ASSERT_TRUE(document.IsArray()) << table;
      for (const auto& row : document.GetArray())
        EXPECT_TRUE(tokens_[table].insert(row["token"].GetString()).second) << table << " repeats a token";
    }
  }

  void expectToken(const std::string& table, const std::string& field, const std::string& token) const {
    if (token.empty() && (field == "prev" || field == "next")) return;
    EXPECT_EQ(tokens_.at(targetOf(table, field)).count(token), 1U) << table << " " << field << " " << token;
  }

  test::TemporaryFolder folder_;
  const std::vector<NewScene> scenes_ = {test::smallScene(1), test::smallScene(2)};
  std::map<std::string, rapidjson::Document> documents_;
  std::map<std::string, std::set<std::string>> tokens_;
};

TEST_F(DatarootJsonTest, EveryFieldHasItsOfficialNamePlaceAndType) {
  for (const auto& [table, fields] : kTables) {
    EXPECT_FALSE(documents_[table].Empty()) << table;
    for (const auto& row : documents_[table].GetArray()) {
      ASSERT_EQ(row.MemberCount(), fields.size()) << table;
      std::size_t i = 0;
      for (const auto& member : row.GetObject()) {
        EXPECT_EQ(member.name.GetString(), fields[i].first) << table;
        EXPECT_TRUE(hasType(member.value, fields[i].second)) << table << " " << fields[i].first;
        ++i;
      }
    }
  }
}

TEST_F(DatarootJsonTest, EveryTokenIsFoundInTheTableItNames) {
  std::size_t checked = 0;
  for (const auto& [table, document] : documents_) {
    for (const auto& row : document.GetArray()) {
      for (const auto& member : row.GetObject()) {
        const std::string field = member.name.GetString();
        if (targetOf(table, field).empty()) continue;
        if (member.value.IsString()) expectToken(table, field, member.value.GetString());
        if (member.value.IsArray())
          for (const auto& token : member.value.GetArray()) expectToken(table, field, token.GetString());
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 300U);
}

TEST_F(DatarootJsonTest, TokensAre32LowerCaseHexadecimalDigitsAndUniqueAcrossTables) {
  std::set<std::string> all;
  for (const auto& [table, tokens] : tokens_) {
    // A pose has the token of its reading, and levels of visibility have official numbers.
    if (table == "ego_pose" || table == "visibility") continue;
    for (const std::string& token : tokens) {
      EXPECT_EQ(token.size(), 32U);
      EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos) << token;
      EXPECT_TRUE(all.insert(token).second) << table << " " << token;
    }
  }
  EXPECT_EQ(tokens_["ego_pose"], tokens_["sample_data"]);
  EXPECT_EQ(tokens_["visibility"], (std::set<std::string>{"1", "2", "3", "4"}));
}

TEST_F(DatarootJsonTest, NextIsTheInverseOfPrevious) {
  for (const char* table : {"sample", "sample_data", "sample_annotation"}) {
    std::map<std::string, std::string> next_of;
    std::size_t first = 0, last = 0;
    for (const auto& row : documents_[table].GetArray())
      next_of[row["token"].GetString()] = row["next"].GetString();
    for (const auto& row : documents_[table].GetArray()) {
      const std::string previous = row["prev"].GetString();
      first += previous.empty() ? 1 : 0;
      last += row["next"].GetStringLength() == 0 ? 1 : 0;
      if (!previous.empty()) {
        EXPECT_EQ(next_of[previous], row["token"].GetString()) << table;
      }
    }
    EXPECT_EQ(first, last) << table;
    const std::map<std::string, std::size_t> chains = {
        {"sample", 2U}, {"sample_data", 6U}, {"sample_annotation", 4U}};
    EXPECT_EQ(first, chains.at(table)) << table;
  }
}

TEST_F(DatarootJsonTest, ChainsAreNamedByTheirEndsAndLength) {
  const auto expect_chains = [this](const std::string& owner, const std::string& table,
                                    const std::string& link) {
    std::map<std::string, const rapidjson::Value*> rows;
    for (const auto& row : documents_[table].GetArray()) rows[row["token"].GetString()] = &row;
    for (const auto& row : documents_[owner].GetArray()) {
      int count = 1;
      const rapidjson::Value* one = rows.at(row[("first_" + link + "_token").c_str()].GetString());
      EXPECT_STREQ((*one)["prev"].GetString(), "") << owner;
      for (; (*one)["next"].GetStringLength() != 0; ++count) one = rows.at((*one)["next"].GetString());
      EXPECT_STREQ((*one)["token"].GetString(), row[("last_" + link + "_token").c_str()].GetString())
          << owner;
      EXPECT_EQ(count, row[("nbr_" + link + "s").c_str()].GetInt()) << owner;
    }
  };
  expect_chains("scene", "sample", "sample");
  expect_chains("instance", "sample_annotation", "annotation");
}

TEST_F(DatarootJsonTest, ALocationHasOneMap) {
  ASSERT_EQ(documents_["map"].Size(), 1U);
  EXPECT_EQ(documents_["map"][0]["log_tokens"].Size(), 2U);
  const std::string map =
      test::readFile(folder_.path() / "dataroot" / documents_["map"][0]["filename"].GetString());
  EXPECT_EQ(map.substr(1, 3), "PNG");
}

TEST_F(DatarootJsonTest, NumbersKeepAllTheirBits) {
  std::map<std::int64_t, const NewReading*> written;
  for (const NewScene& scene : scenes_)
    for (const NewReading& reading : scene.readings) written[reading.timestamp_us] = &reading;
  ASSERT_FALSE(documents_["ego_pose"].Empty());
  for (const auto& row : documents_["ego_pose"].GetArray()) {
    const NewPose& pose = written.at(row["timestamp"].GetInt64())->ego_pose;
    for (rapidjson::SizeType i = 0; i < 3; ++i)
      EXPECT_EQ(row["translation"][i].GetDouble(), pose.translation[i]);
    for (rapidjson::SizeType i = 0; i < 4; ++i) EXPECT_EQ(row["rotation"][i].GetDouble(), pose.rotation[i]);
  }
}

TEST_F(DatarootJsonTest, MasksKnowThePointsOfTheirAnnotation) {
  ASSERT_FALSE(documents_["nuinsseg"].Empty());
  for (const auto& row : documents_["nuinsseg"].GetArray()) {
    EXPECT_GE(row["num_lidar_pts"].GetInt(), 31);
    EXPECT_EQ(row["instance_mask"]["size"][0].GetInt(), 12);
    EXPECT_EQ(row["instance_mask"]["size"][1].GetInt(), 16);
  }
}

TEST_F(DatarootJsonTest, TheLayoutIsThatOfTheOfficialTables) {
  const std::string text = test::readFile(folder_.path() / "dataroot/v1.0-sim/sensor.json");
  EXPECT_EQ(text.find("[\n{\n\"token\": \""), 0U) << text;
  EXPECT_NE(text.find("\",\n\"channel\": \"CAM_FRONT\",\n\"modality\": \"camera\"\n},\n{\n"),
            std::string::npos)
      << text;
}

}  // namespace
}  // namespace radar_dot::dataset
