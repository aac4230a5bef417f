// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// A node with parameters of every type, for reconfigure_test.py. It tells its state on ~state.
#include <ros/ros.h>
#include <std_msgs/String.h>

#include <stdexcept>

#include "nodelets/common/reconfigure_server.h"
#include "nodelets/toy_config.h"

int main(int argc, char** argv) {
  using radar_dot::ToyConfig;
  ros::init(argc, argv, "toy");
  const ros::NodeHandle handle("~");
  ToyConfig applied;
  int applications = 0;
  const auto given = radar_dot::readConfig<ToyConfig>(handle);
  radar_dot::ReconfigureServer<ToyConfig> server(handle, given, [&](const ToyConfig& config) {
    if (config.label == "broken") throw std::runtime_error("label cannot be applied");
    if (config.label == "with 3 lanes" && config.lanes != 3)
      throw radar_dot::InvalidParameter({"label"}, "label is 'with 3 lanes', there are others");
    if (handle.param("hopeless", false)) throw std::runtime_error("nothing can be applied");
    applied = config;
    ++applications;
  });
  ros::NodeHandle public_handle(handle);
  ros::Publisher publisher = public_handle.advertise<std_msgs::String>("state", 1, true);
  const ros::WallTimer timer =
      public_handle.createWallTimer(ros::WallDuration(0.05), [&](const ros::WallTimerEvent&) {
        std_msgs::String state;
        state.data = std::string(server.usable() ? "usable" : "unusable") + "|" + server.error() + "|" +
                     server.refusal() + "|" + (server.refusedAtStart("lanes") ? "lanes refused" : "") + "|" +
                     std::to_string(applications) + "|" +
                     (sameFields(applied, server.config()) ? "applied" : "not applied") + "|" + applied.frame;
        for (const auto& [name, lamp] : applied.lamps) state.data += "|" + name + " at " + lamp.topic;
        publisher.publish(state);
      });
  ros::spin();
}
