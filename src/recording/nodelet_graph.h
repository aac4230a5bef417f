// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nodelet/nodelet.h>
#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <rosbag/message_instance.h>
#include <topic_tools/shape_shifter.h>

#include <boost/shared_ptr.hpp>
#include <functional>
#include <map>
#include <pluginlib/class_loader.hpp>
#include <string>
#include <vector>

namespace radar_dot::recording {

/// A nodelet as a launch file names it.
struct NodeletEntry {
  std::string name;  ///< with its namespace
  std::string type;  ///< "radar_dot/EgoVelocity"
  ros::M_string remappings;
};

/// Nodelets that process a recording as in a manager, but in one thread and in the time of the recording: a
/// message goes in, and everything that follows from it is done before the next one. A master, with the
/// parameters, is needed for this process alone; the node must be set up without a handler of signals.
class NodeletGraph {
 public:
  using Output = topic_tools::ShapeShifter;

  /// Loads the nodelets and lets them start, in the 2 s before `begin`.
  /// @throws std::runtime_error naming a nodelet that cannot be loaded
  NodeletGraph(const std::vector<NodeletEntry>& nodelets, const ros::Time& begin);
  ~NodeletGraph();
  NodeletGraph(const NodeletGraph&) = delete;
  NodeletGraph& operator=(const NodeletGraph&) = delete;

  /// Topics that the nodelets publish, with their types.
  const std::map<std::string, std::string>& outputs() const noexcept { return outputs_; }
  /// Has the messages of an output given to `body`; without subscribers nothing is computed.
  void record(const std::string& topic,
              const std::function<void(const ros::MessageEvent<const Output>&)>& body);
  /// Ends the set-up, in the time until `begin`. @return topics that the nodelets listen to
  std::vector<std::string> start();
  /// Whether something listens to the topic now.
  bool isWanted(const std::string& topic) const;

  /// Lets time pass until `time`, then gives the message to the nodelets.
  void take(const rosbag::MessageInstance& message, const ros::Time& time);
  void advanceTo(const ros::Time& time);

 private:
  /// Does what waits in the queues, until nothing does.
  void drain();

  ros::Time begin_;
  ros::NodeHandle handle_;
  ros::CallbackQueue queue_;
  pluginlib::ClassLoader<nodelet::Nodelet> loader_;
  std::vector<boost::shared_ptr<nodelet::Nodelet>> nodelets_;
  std::map<std::string, std::string> outputs_;
  std::vector<ros::Subscriber> recorders_;
  std::map<std::string, ros::Publisher> inputs_;
};

}  // namespace radar_dot::recording
