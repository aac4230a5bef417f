// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "recording/nodelet_graph.h"

#include <fmt/format.h>
#include <ros/master.h>
#include <ros/poll_manager.h>
#include <ros/publication.h>
#include <ros/serialization.h>
#include <ros/this_node.h>
#include <ros/topic_manager.h>

#include <algorithm>
#include <cstdint>
#include <stdexcept>

#include "nodelets/common/process_clock.h"

namespace radar_dot::recording {
namespace {

const ros::Duration kSetUp(1.0);  // s; nodelets look for their audience 20 times a second

/// A message as roscpp sends it: its length, and its bytes.
ros::SerializedMessage serialized(const rosbag::MessageInstance& message) {
  const std::uint32_t size = message.size();
  ros::SerializedMessage result;
  result.num_bytes = size + 4;
  result.buf.reset(new std::uint8_t[result.num_bytes]);
  ros::serialization::OStream stream(result.buf.get(), static_cast<std::uint32_t>(result.num_bytes));
  stream.next(size);
  result.message_start = stream.getData();
  message.write(stream);
  return result;
}

}  // namespace

NodeletGraph::NodeletGraph(const std::vector<NodeletEntry>& nodelets, const ros::Time& begin)
    : begin_(std::max(begin, ros::Time(0.001) + kSetUp + kSetUp)), loader_("nodelet", "nodelet::Nodelet") {
  ProcessClock::follow(begin_ - kSetUp - kSetUp);
  handle_.setCallbackQueue(&queue_);
  for (const NodeletEntry& entry : nodelets) {
    try {
      nodelets_.push_back(loader_.createInstance(entry.type));
    } catch (const pluginlib::PluginlibException& error) {
      throw std::runtime_error(
          fmt::format("nodelet {} of type {} cannot be loaded: {}", entry.name, entry.type, error.what()));
    }
    nodelets_.back()->init(entry.name, entry.remappings, {}, &queue_, &queue_);
  }
  advanceTo(begin_ - kSetUp);
  ros::master::V_TopicInfo topics;
  ros::master::getTopics(topics);
  for (const ros::master::TopicInfo& topic : topics) outputs_[topic.name] = topic.datatype;
}

NodeletGraph::~NodeletGraph() {
  queue_.disable();
  queue_.clear();
}

void NodeletGraph::record(const std::string& topic,
                          const std::function<void(const ros::MessageEvent<const Output>&)>& body) {
  ros::SubscribeOptions options;
  options.initByFullCallbackType<const ros::MessageEvent<const Output>&>(topic, 0, body);
  recorders_.push_back(handle_.subscribe(options));
}

std::vector<std::string> NodeletGraph::start() {
  advanceTo(begin_ - ros::Duration(0, 1));
  // Nothing outside this process takes part, and nothing is delivered but by drain().
  ros::PollManager::instance()->shutdown();
  ros::V_string topics;
  ros::this_node::getSubscribedTopics(topics);
  return topics;
}

bool NodeletGraph::isWanted(const std::string& topic) const {
  const auto known = inputs_.find(topic);
  return known != inputs_.end() && known->second.getNumSubscribers() > 0;
}

void NodeletGraph::advanceTo(const ros::Time& time) {
  ProcessClock::advanceTo(time, [this] { drain(); });
}

void NodeletGraph::take(const rosbag::MessageInstance& message, const ros::Time& time) {
  advanceTo(time);
  ros::Publisher& publisher = inputs_[message.getTopic()];
  if (!publisher) {
    ros::AdvertiseOptions options(message.getTopic(), 0, message.getMD5Sum(), message.getDataType(),
                                  message.getMessageDefinition());
    const boost::shared_ptr<ros::M_string> header = message.getConnectionHeader();
    options.latch = header && header->count("latching") > 0 && header->at("latching") == "1";
    publisher = handle_.advertise(options);
  }
  if (publisher.getNumSubscribers() == 0 && !publisher.isLatched()) return;
  if (const ros::PublicationPtr publication =
          ros::TopicManager::instance()->lookupPublication(publisher.getTopic()))
    publication->enqueueMessage(serialized(message));
  drain();
}

void NodeletGraph::drain() {
  ros::V_string topics;
  do {
    queue_.callAvailable();
    // What nodelets publish by value waits for the thread of roscpp, which has been stopped.
    ros::TopicManager::instance()->getAdvertisedTopics(topics);
    std::sort(topics.begin(), topics.end());
    for (const std::string& topic : topics)
      if (const ros::PublicationPtr publication = ros::TopicManager::instance()->lookupPublication(topic))
        publication->processPublishQueue();
  } while (!queue_.isEmpty());
}

}  // namespace radar_dot::recording
