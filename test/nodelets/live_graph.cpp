// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "live_graph.h"

#include <dynamic_reconfigure/Reconfigure.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <sstream>
#include <stdexcept>

namespace radar_dot::test {

bool waitUntil(const std::function<bool()>& condition, double timeout) {
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(timeout);
  while (!condition()) {
    if (ros::WallTime::now() > end || !ros::ok()) return condition();
    ros::WallDuration(0.02).sleep();
  }
  return true;
}

namespace {

template <typename List, typename Value>
void append(List& list, const std::string& name, const Value& value) {
  auto& parameter = list.emplace_back();
  parameter.name = name;
  parameter.value = value;
}

struct Appender {
  dynamic_reconfigure::Config& config;
  const std::string& name;
  void operator()(bool value) const { append(config.bools, name, value); }
  void operator()(int value) const { append(config.ints, name, value); }
  void operator()(double value) const { append(config.doubles, name, value); }
  void operator()(const std::string& value) const { append(config.strs, name, value); }
};

}  // namespace

std::map<std::string, std::string> reconfigure(const std::string& nodelet,
                                               const std::vector<Setting>& settings) {
  dynamic_reconfigure::Reconfigure call;
  for (const Setting& setting : settings)
    std::visit(Appender{call.request.config, setting.name}, setting.value);
  const std::string service = nodelet + "/set_parameters";
  EXPECT_TRUE(ros::service::waitForService(service, ros::Duration(kPatience)));
  std::map<std::string, std::string> in_use;
  if (!ros::service::call(service, call)) return in_use;
  for (const auto& parameter : call.response.config.strs) in_use[parameter.name] = parameter.value;
  for (const auto& parameter : call.response.config.doubles) {
    std::ostringstream text;
    text << parameter.value;
    in_use[parameter.name] = text.str();
  }
  return in_use;
}

Ticker::Ticker(double rate, const std::function<void()>& tick)
    : thread_([this, rate, tick] {
        for (ros::WallRate pace(rate); !stop_ && ros::ok(); pace.sleep()) tick();
      }) {}

Ticker::~Ticker() {
  stop_ = true;
  thread_.join();
}

BagPlayer::BagPlayer(const std::vector<std::string>& arguments) {
  std::vector<std::string> command = {"rosbag", "play", "--quiet"};
  command.insert(command.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& argument : command) argv.push_back(argument.data());
  argv.push_back(nullptr);
  child_ = fork();
  if (child_ < 0) throw std::runtime_error("cannot start rosbag play");
  if (child_ == 0) {
    setpgid(0, 0);
    execvp(argv[0], argv.data());
    _exit(127);
  }
}

BagPlayer::~BagPlayer() {
  if (child_ <= 0) return;
  // rosbag starts the player itself: the whole group has to go.
  kill(-child_, SIGINT);
  if (wait(3.0) < 0) {
    kill(-child_, SIGKILL);
    wait(3.0);
  }
}

int BagPlayer::wait(double timeout) {
  int status = 0;
  const auto ended = [&] { return child_ <= 0 || waitpid(child_, &status, WNOHANG) == child_; };
  const ros::WallTime end = ros::WallTime::now() + ros::WallDuration(timeout);
  while (!ended()) {
    if (ros::WallTime::now() > end) return -1;
    ros::WallDuration(0.02).sleep();
  }
  child_ = -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

Diagnostics::Diagnostics(ros::NodeHandle& handle)
    : subscriber_(handle.subscribe<diagnostic_msgs::DiagnosticArray>(
          "/diagnostics", 1000, [this](const diagnostic_msgs::DiagnosticArrayConstPtr& array) {
            const std::lock_guard<std::mutex> lock(mutex_);
            for (const diagnostic_msgs::DiagnosticStatus& status : array->status) {
              Status entry;
              entry.level = static_cast<unsigned char>(status.level);
              entry.message = status.message;
              for (const diagnostic_msgs::KeyValue& value : status.values)
                entry.values[value.key] = value.value;
              history_[status.name].push_back(entry);
            }
          })) {}

Diagnostics::Status Diagnostics::latest(const std::string& name) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = history_.find(name);
  return found == history_.end() ? Status{} : found->second.back();
}

bool Diagnostics::renews(const std::string& name) const {
  const auto count = [&] {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto found = history_.find(name);
    return found == history_.end() ? 0 : found->second.size();
  };
  const std::size_t before = count();
  return waitUntil([&] { return count() >= before + 2; });
}

testing::AssertionResult Diagnostics::says(const std::string& name, int level,
                                           const std::string& words) const {
  Status status;
  const bool said = waitUntil([&] {
    status = latest(name);
    const bool as_bad =
        level == diagnostic_msgs::DiagnosticStatus::OK ? status.level == level : status.level >= level;
    return as_bad && status.message.find(words) != std::string::npos;
  });
  if (said) return testing::AssertionSuccess();
  return testing::AssertionFailure() << name << " is " << status.level << ": '" << status.message
                                     << "' and not " << level << ": '" << words << "'";
}

bool Diagnostics::seen(const std::string& name, int level) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const auto found = history_.find(name);
  return found != history_.end() &&
         std::any_of(found->second.begin(), found->second.end(),
                     [level](const Status& status) { return status.level == level; });
}

}  // namespace radar_dot::test
