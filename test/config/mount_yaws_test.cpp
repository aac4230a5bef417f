// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "config/mount_yaws.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "config/config_file.h"
#include "fixtures/files.h"
#include "fixtures/refusal.h"

namespace radar_dot {
namespace {

class MountYaws : public testing::Test {
 protected:
  std::string refusalOf(const std::string& yaml) {
    test::writeFile(file_, yaml);
    return test::refusalOf<ConfigFileError>([&] { readMountYaws(file_); });
  }

  test::TemporaryFolder folder_;
  std::string file_ = (folder_.path() / "yaws.yaml").string();
};

TEST_F(MountYaws, AreReadAsTheyWereWritten) {
  writeMountYaws(file_, {{"front", {0.1 / 3.0, 1e-3}}, {"rear: left", {-3.14, 0.0}}});
  writeMountYaws(file_, {{"front", {0.1 / 3.0, 2e-7}}, {"rear: left", {-3.14, 0.0}}});
  const std::map<std::string, MountYaw> yaws = readMountYaws(file_);
  ASSERT_EQ(yaws.size(), 2U);
  EXPECT_EQ(yaws.at("front").yaw, 0.1 / 3.0);
  EXPECT_EQ(yaws.at("front").std, 2e-7);
  EXPECT_EQ(yaws.at("rear: left").yaw, -3.14);
  EXPECT_EQ(yaws.at("rear: left").std, 0.0);

  test::writeFile(file_, "front: {yaw: 1, std: 5e-3}\n");
  EXPECT_EQ(readMountYaws(file_).at("front").std, 0.005);
  test::writeFile(file_, "");
  EXPECT_TRUE(readMountYaws(file_).empty());
}

TEST_F(MountYaws, WhatIsWrongInAFileIsNamed) {
  const std::string good = "front: {yaw: 0, std: 0}\n";
  for (const auto& [yaml, text] : std::vector<std::pair<std::string, std::string>>{
           {good + "rear: {yaw: 0.1}\n", ": rear has no std"},
           {good + "rear:\n", ": rear has no yaw"},
           {good + "rear: 0.1\n", ":2: rear is no dictionary of names and values"},
           {good + good, ":2: front is there twice"},
           {good + "rear: {yaw: 0.1, sd: 0.1}\n", ":2: unknown parameter rear/sd"},
           {good + "rear: {yaw: .nan, std: 0.1}\n", ":2: rear/yaw "},
           {good + "rear: {yaw: 4, std: 0.1}\n", ":2: rear/yaw "},
           {good + "rear: {yaw: 0, std: -0.1}\n", ":2: rear/std "},
           {good + "rear: {yaw: left, std: 0.1}\n", ":2: rear/yaw "},
           {"[1, 2]", ":1: the file is no dictionary"},
           {good + "rear: {yaw: 0\n", ": not valid YAML"}}) {
    const std::string refusal = refusalOf(yaml);
    EXPECT_EQ(refusal.rfind(file_, 0), 0U) << refusal;
    EXPECT_NE(refusal.find(text), std::string::npos) << refusal << "\n" << yaml;
  }
  EXPECT_EQ(test::refusalOf<ConfigFileError>([&] { readMountYaws(file_ + "x"); }),
            "cannot read " + file_ + "x: No such file or directory");
}

TEST_F(MountYaws, WhatCouldNotBeReadIsNotWritten) {
  writeMountYaws(file_, {{"front", {0.01, 0.001}}});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const MountYaw& mount : {MountYaw{nan, 0.1}, MountYaw{0.0, nan}, MountYaw{0.0, -0.1}})
    EXPECT_THROW(writeMountYaws(file_, {{"front", mount}}), std::runtime_error);
  EXPECT_THROW(writeMountYaws(file_ + "/below", {}), std::runtime_error);
  EXPECT_EQ(readMountYaws(file_).at("front").yaw, 0.01);
}

}  // namespace
}  // namespace radar_dot
