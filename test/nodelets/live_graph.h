// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <ros/ros.h>
#include <sys/types.h>

#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <vector>

namespace radar_dot::test {

/// Waits (wall time) until `condition` holds. @return false after `timeout` seconds.
bool waitUntil(const std::function<bool()>& condition, double timeout);

/// `rosbag play` as a child process, ended with the object.
class BagPlayer {
 public:
  explicit BagPlayer(const std::vector<std::string>& arguments);
  ~BagPlayer();
  BagPlayer(const BagPlayer&) = delete;
  BagPlayer& operator=(const BagPlayer&) = delete;
  /// Waits for its end. @return its exit status, or -1 after `timeout` seconds (wall time).
  int wait(double timeout);

 private:
  pid_t child_ = -1;
};

/// Everything that arrived on one topic, in order.
template <typename Message>
class Recorder {
 public:
  Recorder(ros::NodeHandle& handle, const std::string& topic)
      : subscriber_(
            handle.subscribe<Message>(topic, 1000, [this](const boost::shared_ptr<const Message>& message) {
              const std::lock_guard<std::mutex> lock(mutex_);
              messages_.push_back(message);
            })) {}
  bool connected() const { return subscriber_.getNumPublishers() > 0; }
  std::vector<boost::shared_ptr<const Message>> messages() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return messages_;
  }
  std::size_t count() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return messages_.size();
  }

 private:
  mutable std::mutex mutex_;
  std::vector<boost::shared_ptr<const Message>> messages_;
  ros::Subscriber subscriber_;
};

/// The statuses on /diagnostics, by name.
class Diagnostics {
 public:
  explicit Diagnostics(ros::NodeHandle& handle);
  /// Latest status whose name is `name`; level -1 when there is none.
  struct Status {
    int level = -1;
    std::string message;
    std::map<std::string, std::string> values;
  };
  Status latest(const std::string& name) const;
  /// True when a status `name` of this level ever arrived.
  bool seen(const std::string& name, int level) const;
  bool received(const std::string& name) const { return latest(name).level >= 0; }

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::vector<Status>> history_;
  ros::Subscriber subscriber_;
};

}  // namespace radar_dot::test
