// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "config/mounts_file.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <utility>

#include "common/replace_file.h"
#include "config/config_file.h"
#include "radar_dot/config/sections.h"

namespace radar_dot {

Mount::Mount(std::string parent_frame, std::string child_frame, const Eigen::Isometry3d& T_parent_from_child)
    : parent(std::move(parent_frame)), child(std::move(child_frame)) {
  const Eigen::Vector3d& t = T_parent_from_child.translation();
  const Eigen::Matrix3d R = T_parent_from_child.linear();
  x = t.x(), y = t.y(), z = t.z();
  roll = std::atan2(R(2, 1), R(2, 2));
  pitch = std::atan2(-R(2, 0), std::hypot(R(0, 0), R(1, 0)));
  yaw = std::atan2(R(1, 0), R(0, 0));
}

Eigen::Isometry3d Mount::isometry() const {
  RadarEntry entry;
  entry.mount_xyz = std::array<double, 3>{x, y, z};
  entry.mount_rpy = std::array<double, 3>{roll, pitch, yaw};
  return *mountOf(entry);
}

void Mount::describe(FieldList& fields) {
  const Range metres{-1000.0, 1000.0}, turns{-6.3, 6.3};
  fields.add("parent", parent, "Frame that it is given in");
  fields.add("child", child, "Frame that is mounted");
  fields.add("x", x, "Position", "m", metres);
  fields.add("y", y, "Position", "m", metres);
  fields.add("z", z, "Position", "m", metres);
  fields.add("roll", roll, "First rotation", "rad", turns);
  fields.add("pitch", pitch, "Second rotation", "rad", turns);
  fields.add("yaw", yaw, "Third rotation", "rad", turns);
}

std::vector<Mount> readMounts(const std::string& path) {
  std::vector<Mount> mounts;
  readListFile(path, [&mounts] { return fieldsOf(mounts.emplace_back()); });
  for (const Mount& mount : mounts)
    if (mount.parent.empty() || mount.child.empty())
      throw ConfigFileError(fmt::format("{}: the mount of '{}' in '{}' has no {}", path, mount.child,
                                        mount.parent, mount.parent.empty() ? "parent" : "child"));
  return mounts;
}

void writeMounts(const std::string& path, const std::vector<Mount>& mounts) {
  std::string text = "# m, rad about fixed axes\n";
  for (Mount mount : mounts) {
    std::string line;
    for (const Field& field : fieldsOf(mount)) {
      if (field.type == FieldType::kDouble)  // to 10 um and 10 urad, without a sign of zero
        field.put(std::round(1e5 * std::get<double>(field.get())) / 1e5 + 0.0);
      line += fmt::format("{}{}: {}", line.empty() ? "" : ", ", field.name, toText(field.get()));
    }
    text += fmt::format("- {{{}}}\n", line);
  }
  replaceFile(path, text);
}

}  // namespace radar_dot
