// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// Where DatarootWriter puts its files, what it leaves behind, and what it refuses to replace.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <stdexcept>
#include <string>

#include "dataset/small_scene.h"
#include "fixtures/files.h"
#include "fixtures/refusal.h"
#include "radar_dot/dataset/dataroot_writer.h"
#include "radar_dot/dataset/tables.h"

namespace radar_dot::dataset {
namespace {

namespace fs = std::filesystem;

constexpr const char* kVersion = "v1.0-sim";

/// Path below the folder -> content.
std::map<std::string, std::string> contentOf(const fs::path& folder) {
  std::map<std::string, std::string> content;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
    content[fs::relative(entry.path(), folder).string()] =
        entry.is_regular_file() ? test::readFile(entry.path()) : "";
  return content;
}

class DatarootFilesTest : public ::testing::Test {
 protected:
  fs::path output() const { return folder_.path() / "drive"; }

  void write(const fs::path& output, int number, bool overwrite = false) const {
    DatarootWriter writer(output, kVersion, overwrite);
    const NewScene scene = test::smallScene(number);
    test::writeReadingFiles(scene, writer.workFolder());
    writer.add(scene);
    writer.finish();
  }
  std::string sceneIn(const fs::path& dataroot) const {
    return Tables::load(dataroot, {kVersion, {}}).scenes.at(0).name;
  }
  /// Overwriting is refused and changes nothing.
  void expectRefusal(const std::vector<std::string>& parts) const {
    const auto before = contentOf(folder_.path());
    test::expectRefusal<DatasetError>([&] { write(output(), 2, true); }, parts);
    EXPECT_EQ(contentOf(folder_.path()), before);
  }

  test::TemporaryFolder folder_;
};

TEST_F(DatarootFilesTest, TheSameScenesGiveTheSameBytes) {
  write(folder_.path() / "a", 1);
  write(folder_.path() / "b", 1);
  const auto first = contentOf(folder_.path() / "a");
  EXPECT_EQ(first, contentOf(folder_.path() / "b"));
  EXPECT_GT(first.size(), 40U);
}

TEST_F(DatarootFilesTest, TheOutputAppearsWithFinish) {
  DatarootWriter writer(output(), kVersion, false);
  writer.add(test::smallScene(1));
  EXPECT_FALSE(fs::exists(output()));
  EXPECT_EQ(writer.workFolder().parent_path(), fs::canonical(folder_.path()));
  EXPECT_EQ(writer.workFolder().filename().string().find(".drive.partial-"), 0U);
  writer.finish();
  EXPECT_EQ(sceneIn(output()), "scene-0001");
  EXPECT_FALSE(fs::exists(writer.workFolder()));
}

TEST_F(DatarootFilesTest, WithoutFinishNothingStaysBehind) {
  {
    DatarootWriter writer(output(), kVersion, false);
    test::writeReadingFiles(test::smallScene(1), writer.workFolder());
    writer.add(test::smallScene(1));
  }
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

TEST_F(DatarootFilesTest, WithoutFinishAnOldOutputStaysAsItWas) {
  write(output(), 1);
  const auto before = contentOf(folder_.path());
  { DatarootWriter(output(), kVersion, true).add(test::smallScene(2)); }
  EXPECT_EQ(contentOf(folder_.path()), before);
}

TEST_F(DatarootFilesTest, FoldersAboveTheOutputAreMade) {
  write(folder_.path() / "new/folders/drive/", 1);
  EXPECT_EQ(sceneIn(folder_.path() / "new/folders/drive"), "scene-0001");
}

TEST_F(DatarootFilesTest, AnEmptyFolderIsFilled) {
  fs::create_directory(output());
  write(output(), 1);
  EXPECT_EQ(sceneIn(output()), "scene-0001");
}

TEST_F(DatarootFilesTest, AnExistingOutputIsKeptWithoutForce) {
  write(output(), 1);
  const auto before = contentOf(folder_.path());
  test::expectRefusal<DatasetError>([&] { write(output(), 2); }, {output().string(), "not empty", "--force"});
  EXPECT_EQ(contentOf(folder_.path()), before);
}

TEST_F(DatarootFilesTest, OverwritingReplacesTheWholeOutput) {
  write(output(), 1);
  test::writeFile(output() / "ground_truth/depth/old.png", "old");
  write(output(), 2, true);
  EXPECT_EQ(sceneIn(output()), "scene-0002");
  EXPECT_FALSE(fs::exists(output() / "ground_truth"));
  write(folder_.path() / "fresh", 2);
  EXPECT_EQ(contentOf(output()), contentOf(folder_.path() / "fresh"));
  fs::remove_all(folder_.path() / "fresh");
  fs::remove_all(output());
  EXPECT_TRUE(fs::is_empty(folder_.path())) << "the old folder is deleted";
}

TEST_F(DatarootFilesTest, ALinkToAFolderStaysALink) {
  fs::create_directory(folder_.path() / "elsewhere");
  fs::create_directory_symlink(folder_.path() / "elsewhere", output());
  write(output(), 1);
  write(output(), 2, true);
  EXPECT_TRUE(fs::is_symlink(output()));
  EXPECT_EQ(sceneIn(folder_.path() / "elsewhere"), "scene-0002");
}

TEST_F(DatarootFilesTest, AFolderWithOtherThingsIsNeverReplaced) {
  write(output(), 1);
  test::writeFile(output() / "thesis.tex", "years of work");
  expectRefusal({output().string(), "'thesis.tex'", "is not replaced"});
}

TEST_F(DatarootFilesTest, ADatarootOfAnotherVersionIsNeverReplaced) {
  write(output(), 1);
  fs::rename(output() / kVersion, output() / "v1.0-mini");
  expectRefusal({"'v1.0-mini'", "is not replaced"});
  fs::remove_all(output() / "v1.0-mini");
  expectRefusal({"no simulated dataroot of version 'v1.0-sim'"});
}

TEST_F(DatarootFilesTest, ADatarootThatOthersMadeIsNeverReplaced) {
  write(output(), 1);
  test::writeFile(output() / kVersion / "category.json",
                  R"([{"token": "fd69059b62a3469fbaef25340c0eab7f", "name": "vehicle.car"}])");
  expectRefusal({"no simulated dataroot of version 'v1.0-sim'", "is not replaced"});
}

TEST_F(DatarootFilesTest, ALinkInsideIsNeverReplaced) {
  write(output(), 1);
  fs::rename(output() / "samples", folder_.path() / "big_disk");
  fs::create_directory_symlink(folder_.path() / "big_disk", output() / "samples");
  expectRefusal({"'samples'", "is not replaced"});
}

TEST_F(DatarootFilesTest, AnOutputThatBecomesForeignMeanwhileIsNotReplaced) {
  write(output(), 1);
  DatarootWriter writer(output(), kVersion, true);
  writer.add(test::smallScene(2));
  test::writeFile(output() / "notes.txt", "new");
  test::expectRefusal<DatasetError>([&] { writer.finish(); }, {"'notes.txt'", "is not replaced"});
  EXPECT_EQ(sceneIn(output()), "scene-0001");
}

TEST_F(DatarootFilesTest, ClearsUpAfterAKilledRun) {
  write(output(), 1);
  // Between moving the old folder out of the way and the new one in: the old one is all there is.
  fs::rename(output(), folder_.path() / ".drive.replaced-1");
  test::writeFile(folder_.path() / ".drive.partial-1/samples/half", "a scene");
  test::expectRefusal<DatasetError>([&] { write(output(), 2); }, {output().string(), "--force"});
  EXPECT_EQ(sceneIn(output()), "scene-0001");
  const auto entries = fs::directory_iterator(folder_.path());
  EXPECT_EQ(std::distance(begin(entries), end(entries)), 1);
}

TEST_F(DatarootFilesTest, AFileInTheWayIsNeverReplaced) {
  test::writeFile(output(), "a file");
  expectRefusal({output().string(), "in the way"});
}

TEST_F(DatarootFilesTest, AnUnwritableParentIsNamed) {
  test::writeFile(folder_.path() / "file", "no folder");
  test::expectRefusal<DatasetError>([&] { write(folder_.path() / "file/drive", 1); }, {"/file", "cannot"});
  test::expectRefusal<DatasetError>([&] { write("/proc/drive", 1); },
                                    {"/proc/.drive.partial-", "cannot make this folder"});
  test::expectRefusal<DatasetError>([&] { write("/", 1); }, {"/: no name"});
}

TEST_F(DatarootFilesTest, AFileThatCannotBeWrittenEndsTheWriter) {
  DatarootWriter writer(output(), kVersion, false);
  fs::remove_all(writer.workFolder() / "can_bus");
  test::expectRefusal<DatasetError>([&] { writer.add(test::smallScene(1)); },
                                    {"can_bus/scene-0001_pose.json: cannot write", "No such file"});
  EXPECT_THROW(writer.add(test::smallScene(2)), std::logic_error);
  EXPECT_THROW(writer.finish(), std::logic_error);
  EXPECT_FALSE(fs::exists(output()));
}

TEST_F(DatarootFilesTest, AVersionThatIsNoPlainNameIsRefused) {
  for (const char* version : {"", ".", "..", "a/b", "/tmp", "samples", "maps"})
    EXPECT_THROW(DatarootWriter(output(), version, false), std::invalid_argument) << version;
  EXPECT_TRUE(fs::is_empty(folder_.path()));
}

}  // namespace
}  // namespace radar_dot::dataset
