// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// Loads every nodelet of radar_dot as a nodelet manager would. Needs no master.
#include <nodelet/nodelet.h>

#include <cstdio>
#include <pluginlib/class_loader.hpp>

int main() {
  pluginlib::ClassLoader<nodelet::Nodelet> loader("nodelet", "nodelet::Nodelet");
  int loaded = 0;
  for (const std::string& name : loader.getDeclaredClasses()) {
    if (loader.getClassPackage(name) != "radar_dot") continue;
    try {
      loader.createInstance(name);
    } catch (const pluginlib::PluginlibException& error) {
      std::fprintf(stderr, "%s: %s\n", name.c_str(), error.what());
      return 1;
    }
    ++loaded;
  }
  std::printf("%d nodelets\n", loaded);
  return loaded > 0 ? 0 : 1;
}
