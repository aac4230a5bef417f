// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <nodelet/nodelet.h>
#include <ros/ros.h>
#include <sensor_msgs/CameraInfo.h>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "nodelets/common/background_thread.h"
#include "nodelets/common/log_throttle.h"
#include "nodelets/common/monitors.h"
#include "nodelets/common/process_clock.h"
#include "nodelets/common/reconfigure_server.h"
#include "nodelets/inputs/extrinsics.h"
#include "nodelets/messages/lazy_image.h"
#include "radar_dot/config/sections.h"

namespace radar_dot {

class EgoMotion;
class RecentClouds;

/// How an input differs from one that is always needed.
struct InputOptions {
  bool required = true;               ///< false: its silence is no error
  std::function<bool()> wanted = {};  ///< beside the audience of the nodelet; empty: always
  /// Forgets what has come, when it is not wanted any more or its stamps restart; empty: a restart of its
  /// stamps is one of the whole nodelet.
  std::function<void()> forget = {};
};

/// What all nodelets have in common: no message ends the process, every input has a diagnostic that names its
/// topic and what is wrong with it, and a step back of time resets everything.
///
/// All callbacks run one after the other in the nodelet's single-threaded queue, the set-up too: nothing is
/// served before it is complete, in whatever order its parts come. Inputs are declared in the set-up, and are
/// subscribed only while the outputs have an audience, so that lazy publishers upstream can stop as well.
class StreamNodelet : public nodelet::Nodelet {
 protected:
  /// Builds everything: see ConfiguredNodelet.
  virtual void setUpAll() = 0;
  /// Forgets everything that was received.
  virtual void clearHistory() = 0;
  /// Adds figures and the nodelet's own verdict to the diagnostic of describe(). Without an audience its
  /// level and summary are replaced.
  virtual void report(diagnostic_updater::DiagnosticStatusWrapper& status) = 0;
  /// Has an output subscribers?
  virtual bool hasAudience() const { return true; }
  /// Called some times a second while there is an audience: for what waits.
  virtual void tick() {}

  /// Diagnostics and mounts; first of all in the set-up. @param what  name of the diagnostic of report()
  void describe(const std::string& what, const std::string& base_frame, const StreamExpectation& expectation);
  /// Of those that work on images: with a low priority.
  void describe(const std::string& what, const StreamParams& params);
  /// Of streams with a rate; slower ones than usual are waited for accordingly. @param silent_after  s
  static StreamExpectation expectationOf(const RateParams& params, double silent_after);
  void addDiagnostic(const std::string& name,
                     const std::function<void(diagnostic_updater::DiagnosticStatusWrapper&)>& body) {
    diagnostics_->add(name, body);
  }

  template <typename Message>
  using Body = std::function<void(const boost::shared_ptr<const Message>&)>;
  enum class Stamps {
    kRising,
    kByBody,     ///< the same, but the body calls acceptStamp(): what it cannot read, or is not meant for it,
                 ///< moves no stamps
    kUnordered,  ///< as of a topic that several sensors share
    kAny,        ///< of what holds until the next one comes: its silence is no error either
  };
  /// Declares an input with a diagnostic of its own. Messages reach `body` only when their headers are in
  /// order; whatever it throws becomes a refusal.
  template <typename Message>
  InputMonitor& listen(const std::string& topic, std::uint32_t queue_size, Body<Message> body,
                       const InputOptions& options = {}, Stamps stamps = Stamps::kRising) {
    auto monitor = std::make_unique<InputMonitor>(topic, expectation_, options.required);
    return *listenAs<Message>("input " + topic, std::move(monitor), topic, queue_size, std::move(body),
                              options, stamps);
  }
  /// The same with a monitor of your own. @param title  of the diagnostic
  template <typename Message, typename Monitor>
  Monitor* listenAs(const std::string& title, std::unique_ptr<Monitor> monitor, const std::string& topic,
                    std::uint32_t queue_size, Body<Message> body, const InputOptions& options = {},
                    Stamps stamps = Stamps::kRising) {
    Monitor* result = monitor.get();
    Input& input = addInput(title, std::move(monitor), options, stamps);
    input.subscribe = [this, &input, topic, queue_size, body = std::move(body)] {
      return getNodeHandle().template subscribe<Message>(
          topic, queue_size, [this, &input, body](const boost::shared_ptr<const Message>& message) {
            take(input, message->header, [&] { body(message); });
          });
    };
    return result;
  }

  /// Takes a message of an input with Stamps::kByBody into its order; until then nothing was checked.
  /// @throws std::invalid_argument as InputMonitor::accept()
  void acceptStamp(const InputMonitor& monitor, const std_msgs::Header& header);

  /// `ego/twist` into `motion`, `camera_info` into `camera`, clouds of any number of sensors into `clouds`:
  /// what several nodelets listen to.
  /// @param first  called with the first camera_info
  InputMonitor& listenToTwists(EgoMotion& motion, const InputOptions& options = {});
  InputMonitor& listenToCamera(sensor_msgs::CameraInfoConstPtr& camera, const InputOptions& options = {},
                               std::function<void()> first = {});
  InputMonitor& listenToClouds(const std::string& topic, RecentClouds& clouds,
                               const InputOptions& options = {});
  /// `image` as raw messages, or as compressed ones of `image/compressed`, by the private parameter
  /// image_transport (raw, compressed).
  InputMonitor& listenToImages(std::uint32_t queue_size, const std::function<void(LazyImage)>& body,
                               const InputOptions& options = {});
  /// Says so, once per process and topic, where these images stay silent while there are others.
  void watchImages(const InputMonitor& images);
  /// Can a topic of the parameter be subscribed? Reports it if not.
  bool isTopic(const std::string& topic, const std::string& parameter);

  /// Subscribes what is wanted now, and only that.
  void updateInputs();

  void noteOutput() { last_output_ = ProcessClock::now(); }
  /// s since the latest output, or since there is an audience.
  double withoutOutput() const { return (ProcessClock::now() - last_output_).toSec(); }
  const StreamExpectation& expectation() const noexcept { return expectation_; }  ///< of inputs
  /// s by the clock, which in a replay may still be a little before the stamp.
  static double since(const ros::Time& stamp) {
    return std::max(0.0, ros::Time::now().toSec() - stamp.toSec());
  }
  /// s without a message, after which something is wrong.
  double silentAfter() const noexcept { return expectation_.silent_after; }

  /// Runs `body`; whatever it throws becomes a refusal of the input. All work on messages passes here.
  void guard(InputMonitor& input, const std::function<void()>& body);
  /// Resets everything where the clock went back.
  void checkClock();
  /// What is wrong for as long as the nodelet runs: an error line, and the diagnostic.
  void reportProblem(const std::string& problem);
  /// One line per subject, kind and five seconds.
  void warn(const std::string& subject, const std::string& text);

  std::unique_ptr<Extrinsics> extrinsics_;         // of the base frame
  LogThrottle throttle_;                           // of warn()
  std::unique_ptr<ReconfigureServerBase> server_;  // of the parameters; none before the end of the set-up

 private:
  struct Input {
    std::unique_ptr<InputMonitor> monitor;
    InputOptions options;
    Stamps stamps;
    std::function<ros::Subscriber()> subscribe;
    bool is_on = false;
  };

  void onInit() final;
  void start();
  void look();
  Input& addInput(const std::string& title, std::unique_ptr<InputMonitor> monitor,
                  const InputOptions& options, Stamps stamps);
  void switchInput(Input& input, bool on);
  void take(Input& input, const std_msgs::Header& header, const std::function<void()>& body);
  void accept(Input& input, const std_msgs::Header& header);
  void restart(const ros::Time& now);
  bool warnedOfSilence(const InputMonitor& images);
  /// Runs `body`; whatever it throws becomes a reported problem. @return false: it has thrown
  bool attempt(const std::function<void()>& body);
  void reportConfiguration(diagnostic_updater::DiagnosticStatusWrapper& status) const;

  StreamExpectation expectation_;
  std::vector<std::unique_ptr<Input>> inputs_;
  ClockWatch clock_;
  std::vector<std::string> problems_;
  std::unique_ptr<diagnostic_updater::Updater> diagnostics_;
  ProcessTimer timer_, diagnostics_timer_, images_timer_;
  bool started_ = false, complete_ = false, connected_ = false;
  bool others_seen_ = false;  // images on other topics, while those of watchImages() are silent
  ros::WallTime last_output_;
  std::unique_ptr<BackgroundThread> background_;  // none: works in the thread of its queue
};

/// A nodelet with parameters, which are read before setUp(), and served after it.
template <typename Config>
class ConfiguredNodelet : public StreamNodelet {
 protected:
  /// Declares outputs and inputs, by what was given.
  virtual void setUp() = 0;
  /// Puts valid parameters into force, now and after each change; as of ReconfigureServer.
  virtual void apply(const Config& config) { config_ = config; }
  /// Comes last, before the first message: server_ is there.
  virtual void started() {}

  Config config_;  // in force

 private:
  void setUpAll() final {
    const GivenConfig<Config> given = readConfig<Config>(getPrivateNodeHandle());
    config_ = given.config;
    setUp();
    server_ = std::make_unique<ReconfigureServer<Config>>(getPrivateNodeHandle(), given,
                                                          [this](const Config& config) {
                                                            apply(config);
                                                            updateInputs();
                                                          });
    started();
  }
};

}  // namespace radar_dot
