// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "config/mounts_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "config/config_file.h"
#include "fixtures/files.h"
#include "fixtures/refusal.h"

namespace radar_dot {
namespace {

using Eigen::Vector3d;

class MountsFile : public testing::Test {
 protected:
  test::TemporaryFolder folder_;
  std::string file_ = (folder_.path() / "mounts.yaml").string();
};

TEST_F(MountsFile, AnglesAreThoseOfStaticTransforms) {
  test::writeFile(file_,
                  "- {parent: base_link, child: radar, x: 3.5, z: 0.5, roll: 3.14159265, yaw: 1.57079633}\n"
                  "- {parent: radar, child: chip, pitch: 0.1}\n");
  const std::vector<Mount> mounts = readMounts(file_);
  ASSERT_EQ(mounts.size(), 2U);
  EXPECT_EQ(mounts[0].parent, "base_link");
  EXPECT_EQ(mounts[1].child, "chip");
  // Upside down and to the left: its left is ahead.
  EXPECT_LT((mounts[0].isometry() * Vector3d(1.0, 2.0, 3.0) - Vector3d(5.5, 1.0, -2.5)).norm(), 1e-6);
  EXPECT_NEAR((mounts[1].isometry() * Vector3d::UnitX()).z(), -std::sin(0.1), 1e-12);
}

TEST_F(MountsFile, IsReadAsItWasWritten) {
  Mount mount;
  mount.parent = "base_link";
  mount.child = "radar";
  mount.x = -0.6, mount.y = 0.8, mount.z = 0.5, mount.roll = -2.9, mount.pitch = 0.3, mount.yaw = 2.5;
  writeMounts(file_, {Mount(mount.parent, mount.child, mount.isometry())});
  EXPECT_EQ(
      test::readFile(file_),
      "# m, rad about fixed axes\n- {parent: base_link, child: radar, x: -0.6, y: 0.8, z: 0.5, roll: -2.9, "
      "pitch: 0.3, yaw: 2.5}\n");
  EXPECT_TRUE(readMounts(file_).at(0).isometry().isApprox(mount.isometry(), 1e-12));
}

TEST_F(MountsFile, WhatIsWrongIsNamed) {
  const std::string good = "- {parent: base_link, child: radar}\n";
  for (const auto& [yaml, text] : std::vector<std::pair<std::string, std::string>>{
           {good + "- {parent: base_link, child: left, heading: 1}\n", ":2: unknown parameter heading"},
           {good + "- {parent: base_link, child: left, yaw: west}\n", ":2: yaw "},
           {good + "- {parent: base_link}\n", ": the mount of '' in 'base_link' has no child"},
           {good + "- left\n", ":2: an entry of the list is no dictionary"},
           {"parent: base_link\n", ":1: the file is no list"}}) {
    test::writeFile(file_, yaml);
    const std::string refusal = test::refusalOf<ConfigFileError>([&] { readMounts(file_); });
    EXPECT_EQ(refusal.rfind(file_, 0), 0U) << refusal;
    EXPECT_NE(refusal.find(text), std::string::npos) << refusal;
  }
}

}  // namespace
}  // namespace radar_dot
