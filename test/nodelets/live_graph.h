// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_msgs/DiagnosticArray.h>
#include <gtest/gtest.h>
#include <ros/ros.h>
#include <sys/types.h>

#include <atomic>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <type_traits>
#include <variant>
#include <vector>

namespace radar_dot::test {

constexpr double kPatience = 15.0;  ///< s; machines are slow at times

/// Waits (wall time) until `condition` holds. @return false after `timeout` seconds.
bool waitUntil(const std::function<bool()>& condition, double timeout = kPatience);

/// A parameter and its new value: a bool, a double or a text.
struct Setting {
  template <typename Value>
  Setting(const char* parameter, const Value& new_value)
      : name(parameter),
        value(std::conditional_t<std::is_arithmetic_v<Value>, Value, std::string>(new_value)) {}
  std::string name;
  std::variant<bool, int, double, std::string> value;
};

/// Changes parameters of a nodelet. @return the texts and numbers in use afterwards; none: rejected
std::map<std::string, std::string> reconfigure(const std::string& nodelet,
                                               const std::vector<Setting>& settings);

/// Calls a function at a rate (Hz, wall time) from a thread, until the end of its life.
class Ticker {
 public:
  Ticker(double rate, const std::function<void()>& tick);
  ~Ticker();

 private:
  std::atomic<bool> stop_{false};
  std::thread thread_;
};

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
  boost::shared_ptr<const Message> latest() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return messages_.back();
  }
  std::size_t count() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return messages_.size();
  }
  /// Waits for so many more messages.
  testing::AssertionResult grows(std::size_t more = 3) const {
    const std::size_t before = count();
    if (waitUntil([&] { return count() >= before + more; })) return testing::AssertionSuccess();
    return testing::AssertionFailure() << count() - before << " messages on " << subscriber_.getTopic();
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
  /// Waits for two more statuses `name`: the second is younger than the call.
  bool renews(const std::string& name) const;
  /// Waits until the latest status `name` is OK, or as bad as `level`, and contains these words.
  testing::AssertionResult says(const std::string& name, int level, const std::string& words) const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, std::vector<Status>> history_;
  ros::Subscriber subscriber_;
};

}  // namespace radar_dot::test
