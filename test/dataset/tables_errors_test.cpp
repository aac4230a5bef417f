// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "fixtures/nuscenes_fixture.h"
#include "fixtures/refusal.h"
#include "radar_dot/dataset/tables.h"

namespace radar_dot::dataset {
namespace {

using test::readFile;
using test::replaceInFile;
using test::writeFile;

/// A dataroot of its own for every test, into which the test puts one defect.
class TablesErrors : public ::testing::Test {
 protected:
  void expectError(const std::vector<std::string>& parts, const LoadOptions& options = {}) const {
    test::expectRefusal<DatasetError>([&] { Tables::load(fixture_.dataroot(), options); }, parts);
  }
  std::string firstToken(std::string_view table) const {
    const std::string content = readFile(fixture_.table(table));
    return content.substr(content.find("\"token\": \"") + 10, 32);
  }
  test::NuscenesFixture fixture_{test::FixtureOptions::tablesOnly()};
};

const std::string kUnknown = "0123456789abcdef0123456789abcdef";

TEST_F(TablesErrors, SoundTablesLoad) { EXPECT_NO_THROW(Tables::load(fixture_.dataroot())); }

TEST_F(TablesErrors, MissingDataroot) {
  test::expectRefusal<DatasetError>([] { Tables::load("/nowhere/at/all"); },
                                    {"dataroot /nowhere/at/all does not exist"});
}

TEST_F(TablesErrors, MissingVersionListsTheOthers) {
  LoadOptions options;
  options.version = "v1.0-trainval";
  expectError({"no version 'v1.0-trainval'", "versions there: v1.0-mini"}, options);
}

TEST_F(TablesErrors, EachMissingTableIsNamed) {
  for (const char* table : {"attribute", "calibrated_sensor", "category", "ego_pose", "instance", "sample",
                            "sample_annotation", "sample_data", "scene", "sensor"}) {
    const std::filesystem::path file = fixture_.table(table);
    const std::string content = readFile(file);
    std::filesystem::remove(file);
    expectError({"v1.0-mini/" + std::string(table) + ".json is missing", "samples/, sweeps/"});
    writeFile(file, content);
  }
}

// As other data sets in this form have it: what nothing needs may be missing, and what is used is as before.
TEST_F(TablesErrors, WhatNothingNeedsMayBeMissing) {
  const Tables whole = Tables::load(fixture_.dataroot());
  for (const char* table : {"log", "map", "visibility"}) std::filesystem::remove(fixture_.table(table));
  const auto rename = [&](const char* table, const std::string& field, const std::string& value = "") {
    std::string text = readFile(fixture_.table(table));
    const std::string from = "\"" + field + "\": " + value;
    ASSERT_NE(text.find(from), std::string::npos) << field;
    for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos;)
      text.replace(at, from.size(), value.empty() ? "\"other\": " : "\"" + field + "\": null");
    writeFile(fixture_.table(table), text);
  };
  rename("sample_data", "height", "0");
  rename("sample_data", "width", "0");
  rename("calibrated_sensor", "camera_intrinsic", "[]");
  for (const char* field : {"num_lidar_pts", "num_radar_pts", "visibility_token"})
    rename("sample_annotation", field);
  for (const char* field : {"log_token", "description", "first_sample_token"}) rename("scene", field);
  for (const char* field : {"nbr_annotations", "first_annotation_token"}) rename("instance", field);
  const Tables tables = Tables::load(fixture_.dataroot());
  EXPECT_EQ(tables.sample_data.size(), whole.sample_data.size());
  EXPECT_EQ(tables.annotations.size(), whole.annotations.size());
  EXPECT_EQ(tables.scenes.at(1).log, kNone);
  for (std::size_t i = 0; i < whole.sample_data.size(); ++i) {
    EXPECT_EQ(tables.sample_data[i].height, whole.sample_data[i].height);
    EXPECT_EQ(
        at(tables.calibrated_sensors, tables.sample_data[i].calibrated_sensor).camera_matrix.has_value(),
        at(whole.calibrated_sensors, whole.sample_data[i].calibrated_sensor).camera_matrix.has_value());
  }
}

TEST_F(TablesErrors, UnknownSceneListsTheOthers) {
  LoadOptions options;
  options.scenes = {"scene-0001", "scene-9999"};
  expectError({"v1.0-mini/scene.json", "no scene 'scene-9999'", "scene-0001, scene-0002"}, options);
}

TEST_F(TablesErrors, EveryDanglingReferenceIsNamed) {
  struct Case {
    const char* table;
    const char* field;
    const char* target;
  };
  const Case cases[] = {{"calibrated_sensor", "sensor_token", "sensor"},
                        {"scene", "log_token", "log"},
                        {"sample", "scene_token", "scene"},
                        {"sample_data", "sample_token", "sample"},
                        {"sample_data", "ego_pose_token", "ego_pose"},
                        {"sample_data", "calibrated_sensor_token", "calibrated_sensor"},
                        {"sample_data", "prev", "sample_data"},
                        {"sample_annotation", "sample_token", "sample"},
                        {"sample_annotation", "instance_token", "instance"},
                        {"sample_annotation", "next", "sample_annotation"},
                        {"instance", "category_token", "category"}};
  for (const Case& item : cases) {
    SCOPED_TRACE(std::string(item.table) + "." + item.field);
    const std::filesystem::path file = fixture_.table(item.table);
    const std::string content = readFile(file);
    const std::string key = "\"" + std::string(item.field) + "\": \"";
    const std::size_t start = content.find(key) + key.size();
    std::string broken = content;
    broken.replace(start, content.find('"', start) - start, kUnknown);
    writeFile(file, broken);
    expectError(
        {"v1.0-mini/" + std::string(item.table) + ".json record 0 (token " + firstToken(item.table) + ")",
         "field '" + std::string(item.field) + "'", kUnknown,
         "v1.0-mini/" + std::string(item.target) + ".json"});
    writeFile(file, content);
  }
}

TEST_F(TablesErrors, DanglingAttribute) {
  replaceInFile(fixture_.table("sample_annotation"), "\"attribute_tokens\": [\n\"",
                "\"attribute_tokens\": [\n\"x");
  expectError({"v1.0-mini/sample_annotation.json record 0", "field 'attribute_tokens'", "attribute.json"});
}

TEST_F(TablesErrors, RecordsAreCountedInTheFileUnderASceneFilter) {
  // The last of the 8 records belongs to scene-0002.
  const std::string content = readFile(fixture_.table("sample_annotation"));
  const std::size_t last = content.rfind("\"prev\": \"") + 9;
  std::string broken = content;
  broken.replace(last, 32, kUnknown);
  writeFile(fixture_.table("sample_annotation"), broken);
  LoadOptions options;
  options.scenes = {"scene-0002"};
  expectError({"v1.0-mini/sample_annotation.json record 7", "field 'prev'", kUnknown}, options);
  options.scenes = {"scene-0001"};
  EXPECT_NO_THROW(Tables::load(fixture_.dataroot(), options)) << "rows of other scenes do not matter";
}

TEST_F(TablesErrors, EmptyReferences) {
  const std::string log = firstToken("log");
  replaceInFile(fixture_.table("scene"), "\"log_token\": \"" + log, "\"log_token\": \"");
  expectError({"v1.0-mini/scene.json record 0", "field 'log_token' is empty"});
}

TEST_F(TablesErrors, EmptyPoseReference) {
  const std::string pose = firstToken("ego_pose");
  replaceInFile(fixture_.table("sample_data"), "\"ego_pose_token\": \"" + pose, "\"ego_pose_token\": \"");
  expectError({"v1.0-mini/sample_data.json record 0", "field 'ego_pose_token' is empty"});
}

TEST_F(TablesErrors, DuplicateTokens) {
  const std::filesystem::path file = fixture_.table("sensor");
  const std::string first = firstToken("sensor");
  std::string content = readFile(file);
  content.replace(content.rfind("\"token\": \"") + 10, 32, first);
  writeFile(file, content);
  expectError({"v1.0-mini/sensor.json record 6 (token " + first + ")", "record 0"});
}

TEST_F(TablesErrors, MissingField) {
  replaceInFile(fixture_.table("sample_data"), "\"timestamp\"", "\"time\"");
  expectError({"v1.0-mini/sample_data.json record 0 (token " + firstToken("sample_data") + ")",
               "field 'timestamp' is missing"});
}

TEST_F(TablesErrors, MistypedFields) {
  struct Case {
    const char* table;
    const char* from;
    const char* to;
    const char* complaint;
  };
  const Case cases[] = {
      {"sample", "\"timestamp\": 15", "\"timestamp\": 0.15",
       "'timestamp' must be a whole number but is a number"},
      {"sample_data", "\"prev\": \"\"", "\"prev\": null", "'prev' must be a text but is null"},
      {"sample_data", "\"is_key_frame\": true", "\"is_key_frame\": 1",
       "'is_key_frame' must be true or false"},
      {"sample_data", "\"height\": 0", "\"height\": -1", "'height' must lie in 0..65535"},
      {"sample_data", "\"filename\": \"", "\"filename\": \"\", \"x\": \"", "'filename' must hold"},
      {"ego_pose", "\"translation\": [", "\"translation\": [1, ", "'translation' must hold 3 numbers"},
      {"ego_pose", "\"translation\": [", "\"translation\": [NaN, 0, 0], \"x\": [",
       "'translation' must hold finite numbers but value 0 is nan"},
      {"calibrated_sensor", "[[1260, 0, 800]", "[[1260, 0, Infinity]", "'camera_intrinsic' must hold finite"},
      {"ego_pose", "\"translation\": [", "\"translation\": [\"1\",", "'translation' must hold 3 numbers"},
      {"ego_pose", "\"rotation\": [", "\"rotation\": [1, 2, 3, 4], \"x\": [",
       "'rotation' must be a unit quaternion"},
      {"calibrated_sensor", "[[1260, 0, 800]", "[[1260, 0]", "'camera_intrinsic' must be empty or 3 lists"},
      {"calibrated_sensor", "\"camera_intrinsic\": []", "\"camera_intrinsic\": 5", "must be a list but is"},
      {"sample_annotation", "\"attribute_tokens\": [", "\"attribute_tokens\": [7, ",
       "'attribute_tokens' must be a list of texts"},
      {"sensor", "\"token\": \"", "\"token\": \"\", \"x\": \"", "'token' is empty"}};
  for (const Case& item : cases) {
    SCOPED_TRACE(std::string(item.table) + ": " + item.to);
    const std::string content = readFile(fixture_.table(item.table));
    replaceInFile(fixture_.table(item.table), item.from, item.to);
    expectError({"v1.0-mini/" + std::string(item.table) + ".json record ", item.complaint});
    writeFile(fixture_.table(item.table), content);
  }
}

TEST_F(TablesErrors, TruncatedJsonNamesFileAndByte) {
  const std::string content = readFile(fixture_.table("sample_data"));
  for (const std::size_t length : {content.size() - 3, content.size() / 2, std::size_t{10}, std::size_t{1}}) {
    writeFile(fixture_.table("sample_data"), content.substr(0, length));
    expectError({"v1.0-mini/sample_data.json: malformed JSON at byte "});
  }
  writeFile(fixture_.table("sample_data"), "");
  expectError({"v1.0-mini/sample_data.json: malformed JSON at byte 0"});
}

TEST_F(TablesErrors, MalformedJsonNamesTheByte) {
  writeFile(fixture_.table("log"), "[\n{\"token\" \"1\"}]");
  expectError({"v1.0-mini/log.json: malformed JSON at byte 11"});
}

TEST_F(TablesErrors, NotAListOfObjects) {
  writeFile(fixture_.table("log"), "{\"token\": \"1\"}");
  expectError({"v1.0-mini/log.json: must be a list of objects"});
  writeFile(fixture_.table("log"), "17");
  expectError({"v1.0-mini/log.json: must be a list of objects"});
  writeFile(fixture_.table("log"), "[3]");
  expectError({"v1.0-mini/log.json record 0: must be an object"});
  writeFile(fixture_.table("log"), "[[{\"token\": \"1\"}]]");
  expectError({"v1.0-mini/log.json record 0: must be an object"});
}

}  // namespace
}  // namespace radar_dot::dataset
