// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/common/stream_nodelet.h"

#include <algorithm>

#include "nodelets/inputs/cloud_points.h"
#include "nodelets/inputs/ego_motion.h"

namespace radar_dot {

using diagnostic_updater::DiagnosticStatusWrapper;

namespace {

constexpr double kAudiencePeriod = 0.05;  // s
constexpr std::uint32_t kTwistQueue = 20;
constexpr std::uint32_t kCloudQueue = 20;

}  // namespace

void StreamNodelet::setUp(const std::string& what, const StreamParams& params) {
  expectation_.rate = 0.0;  // cameras have all rates
  expectation_.max_age = params.max_age;
  expectation_.silent_after = params.silent_after;

  diagnostics_ =
      std::make_unique<diagnostic_updater::Updater>(getNodeHandle(), getPrivateNodeHandle(), getName());
  diagnostics_->setHardwareID("none");
  diagnostics_->add(what, [this](DiagnosticStatusWrapper& status) {
    report(status);
    reportConfiguration(status);
  });
  // Wall time: the updater's own timing stops when a bag starts again.
  diagnostics_timer_ =
      getNodeHandle().createWallTimer(ros::WallDuration(diagnostics_->getPeriod()),
                                      [this](const ros::WallTimerEvent&) { diagnostics_->force_update(); });
}

InputMonitor& StreamNodelet::addInput(const std::string& name, bool required) {
  inputs_.push_back(std::make_unique<InputMonitor>(name, expectation_, required));
  InputMonitor* input = inputs_.back().get();
  diagnostics_->add("input " + name,
                    [input](DiagnosticStatusWrapper& status) { input->report(ros::Time::now(), status); });
  return *input;
}

void StreamNodelet::connectWhile(const std::function<bool()>& wanted, const std::function<void()>& connect,
                                 const std::function<void()>& disconnect) {
  audience_timer_ = getNodeHandle().createWallTimer(
      ros::WallDuration(kAudiencePeriod), [this, wanted, connect, disconnect](const ros::WallTimerEvent&) {
        const bool now = wanted();
        if (now == connected_) return;
        connected_ = now;
        attempt(now ? connect : disconnect);
      });
}

void StreamNodelet::stop(InputMonitor& input, ros::Subscriber& subscriber) {
  subscriber.shutdown();
  subscriber = {};
  input.setTopic({});
  input.reset();
}

ros::Subscriber StreamNodelet::listenToTwists(InputMonitor& input, EgoMotion& motion) {
  return listen<geometry_msgs::TwistWithCovarianceStamped>(
      input, "ego/twist", kTwistQueue,
      [&motion](const geometry_msgs::TwistWithCovarianceStampedConstPtr& twist) { motion.add(*twist); });
}

ros::Subscriber StreamNodelet::listenToCamera(InputMonitor& input, sensor_msgs::CameraInfoConstPtr& camera) {
  return subscribeLatched<sensor_msgs::CameraInfo>(
      input, "camera_info", [&camera](const sensor_msgs::CameraInfoConstPtr& message) { camera = message; });
}

ros::Subscriber StreamNodelet::listenToClouds(InputMonitor& input, const std::string& topic,
                                              RecentClouds& clouds) {
  return listenUnordered<sensor_msgs::PointCloud2>(
      input, topic, kCloudQueue, [&clouds, &input](const sensor_msgs::PointCloud2ConstPtr& cloud) {
        clouds.add(input.topic(), *cloud);
      });
}

void StreamNodelet::attempt(const std::function<void()>& body) {
  try {
    body();
  } catch (const std::exception& error) {
    // A timer's exception would end the process that we share with others.
    reportProblem(error.what());
  }
}

void StreamNodelet::reportProblem(const std::string& problem) {
  NODELET_ERROR("%s: %s", getName().c_str(), problem.c_str());
  noteProblem(problem);
}

void StreamNodelet::noteProblem(const std::string& problem) {
  if (std::find(problems_.begin(), problems_.end(), problem) == problems_.end()) problems_.push_back(problem);
}

void StreamNodelet::reportConfiguration(DiagnosticStatusWrapper& status) const {
  using diagnostic_msgs::DiagnosticStatus;
  for (const std::string& problem : problems_) status.mergeSummary(DiagnosticStatus::ERROR, problem);
  if (!server_) return;
  if (!server_->refusal().empty())
    status.mergeSummary(DiagnosticStatus::WARN, "rejected: " + server_->refusal());
  if (!server_->error().empty()) status.mergeSummary(DiagnosticStatus::ERROR, server_->error());
}

void StreamNodelet::warn(const std::string& subject, const std::string& text) {
  if (throttle_.allow(subject, text)) NODELET_WARN("%s: %s", getName().c_str(), text.c_str());
}

void StreamNodelet::restart(const ros::Time& now) {
  NODELET_WARN("%s: time jumped back to %.3f s; resetting", getName().c_str(), now.toSec());
  for (const std::unique_ptr<InputMonitor>& input : inputs_) input->reset();
  clearHistory();
}

void StreamNodelet::guard(InputMonitor& input, const std::function<void()>& body) {
  try {
    const ros::Time now = ros::Time::now();
    if (clock_.wentBack(now)) restart(now);
    body();
  } catch (const std::exception& error) {
    // Whatever the data are: they must not end the process that we share with others.
    input.refuse(error.what());
    warn(input.name(), "message on '" + input.topic() + "' refused: " + error.what());
  }
}

void StreamNodelet::take(InputMonitor& input, const std_msgs::Header& header,
                         const std::function<void()>& body) {
  guard(input, [&] {
    const ros::Time now = ros::Time::now();
    if (!input.accept(header, now)) {
      restart(header.stamp);
      input.accept(header, now);
    }
    body();
  });
}

}  // namespace radar_dot
