// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <nodelet/nodelet.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>

#include <exception>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "nodelets/common/input_monitor.h"
#include "nodelets/common/log_throttle.h"
#include "nodelets/common/reconfigure_server.h"
#include "radar_dot/config/sections.h"

namespace radar_dot {

class EgoMotion;
class RecentClouds;

/// What the nodelets of the image half have in common: no message ends the process, every input has a
/// diagnostic that names its topic and what is wrong with it, and a step back of time resets everything.
///
/// All callbacks run one after the other in the nodelet's single-threaded queue.
class StreamNodelet : public nodelet::Nodelet {
 protected:
  /// Forgets everything that was received.
  virtual void clearHistory() = 0;
  /// Adds figures and the nodelet's own verdict to the diagnostic called `what`.
  virtual void report(diagnostic_updater::DiagnosticStatusWrapper& status) = 0;

  /// Diagnostics, first of all. @param what  name of the diagnostic of report()
  void setUp(const std::string& what, const StreamParams& params);
  /// An input with a diagnostic of its own.
  InputMonitor& addInput(const std::string& name, bool required = true);

  /// Subscribes an input; messages reach `body` only when their headers are in order. Whatever `body` throws
  /// becomes a refusal.
  template <typename Message>
  ros::Subscriber listen(InputMonitor& input, const std::string& topic, std::uint32_t queue_size,
                         std::function<void(const boost::shared_ptr<const Message>&)> body) {
    ros::Subscriber subscriber = getNodeHandle().template subscribe<Message>(
        topic, queue_size, [this, &input, body](const boost::shared_ptr<const Message>& message) {
          take(input, message->header, [&] { body(message); });
        });
    input.setTopic(subscriber.getTopic());
    return subscriber;
  }
  /// Stamps in any order, as of a topic that several sensors share.
  template <typename Message>
  ros::Subscriber listenUnordered(InputMonitor& input, const std::string& topic, std::uint32_t queue_size,
                                  std::function<void(const boost::shared_ptr<const Message>&)> body) {
    ros::Subscriber subscriber = getNodeHandle().template subscribe<Message>(
        topic, queue_size, [this, &input, body](const boost::shared_ptr<const Message>& message) {
          guard(input, [&] {
            input.acceptUnordered(message->header, ros::Time::now());
            body(message);
          });
        });
    input.setTopic(subscriber.getTopic());
    return subscriber;
  }

  /// What holds until the next one comes: no order of stamps, no silence.
  template <typename Message>
  ros::Subscriber subscribeLatched(InputMonitor& input, const std::string& topic,
                                   std::function<void(const boost::shared_ptr<const Message>&)> body) {
    ros::Subscriber subscriber = getNodeHandle().template subscribe<Message>(
        topic, 2, [this, &input, body](const boost::shared_ptr<const Message>& message) {
          guard(input, [&] {
            input.acceptLatched(ros::Time::now());
            body(message);
          });
        });
    input.setTopic(subscriber.getTopic());
    return subscriber;
  }

  /// `ego/twist` into `motion`, `camera_info` into `camera`, clouds of any number of sensors into `clouds`:
  /// what several nodelets listen to.
  ros::Subscriber listenToTwists(InputMonitor& input, EgoMotion& motion);
  ros::Subscriber listenToCamera(InputMonitor& input, sensor_msgs::CameraInfoConstPtr& camera);
  ros::Subscriber listenToClouds(InputMonitor& input, const std::string& topic, RecentClouds& clouds);

  /// Serves the parameters that can change. @param apply  as of ReconfigureServer
  template <typename Config>
  void serve(const GivenConfig<Config>& given, std::function<void(const Config&)> apply) {
    server_ = std::make_unique<ReconfigureServer<Config>>(getPrivateNodeHandle(), given, std::move(apply));
  }

  /// What is wrong with the parameters that can change, for refusals.
  std::string configurationError() const { return server_ ? server_->error() : std::string(); }

  /// Calls `connect` when `wanted` begins to hold and `disconnect` when it ends, looking some times a second:
  /// without subscribers the nodelet unsubscribes from its inputs, so that lazy publishers upstream can stop
  /// too. Comes last in onInit(): both may be called at once. What they throw becomes a reported problem.
  void connectWhile(const std::function<bool()>& wanted, const std::function<void()>& connect,
                    const std::function<void()>& disconnect);
  bool connected() const noexcept { return connected_; }
  /// Ends a subscription of an input.
  static void stop(InputMonitor& input, ros::Subscriber& subscriber);

  /// s without a message, after which something is wrong.
  double silentAfter() const noexcept { return expectation_.silent_after; }

  /// Runs `body`; whatever it throws becomes a refusal of the input.
  void guard(InputMonitor& input, const std::function<void()>& body);
  /// Runs `body`; whatever it throws becomes a reported problem.
  void attempt(const std::function<void()>& body);
  /// What is wrong for as long as the nodelet runs: an error line, and the diagnostic.
  void reportProblem(const std::string& problem);
  /// The diagnostic alone, of what has been logged already.
  void noteProblem(const std::string& problem);
  /// One line per subject, kind and five seconds.
  void warn(const std::string& subject, const std::string& text);

 private:
  void take(InputMonitor& input, const std_msgs::Header& header, const std::function<void()>& body);
  void restart(const ros::Time& now);
  void reportConfiguration(diagnostic_updater::DiagnosticStatusWrapper& status) const;

  StreamExpectation expectation_;
  std::vector<std::unique_ptr<InputMonitor>> inputs_;
  ClockWatch clock_;
  LogThrottle throttle_;
  std::vector<std::string> problems_;
  std::unique_ptr<ReconfigureServerBase> server_;  // none: nothing can change
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
  ros::WallTimer diagnostics_timer_, audience_timer_;
  bool connected_ = false;
};

}  // namespace radar_dot
