// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/common/stream_nodelet.h"

#include <malloc.h>

#include <algorithm>
#include <limits>
#include <map>
#include <mutex>

#include "nodelets/inputs/cloud_points.h"
#include "nodelets/inputs/ego_motion.h"

namespace radar_dot {

using diagnostic_msgs::DiagnosticStatus;
using diagnostic_updater::DiagnosticStatusWrapper;

namespace {

constexpr double kPeriod = 0.05;  // s, how often the audience and what waits are looked at
constexpr std::uint32_t kTwistQueue = 20;
constexpr std::uint32_t kCloudQueue = 20;
constexpr double kImagePeriod = 3.0;    // s, how often silent images are looked for
constexpr double kMemoryPeriod = 10.0;  // s, how often unused memory goes back to the system

/// Nodelets start side by side, but what plugins and parameters are read with is not made for that; and
/// roscpp connects a publisher and a subscriber of one process twice where one is made while the other is.
std::recursive_mutex& oneAtATime() {
  static std::recursive_mutex mutex;
  return mutex;
}

/// What concerns several nodelets of a process is said by the first of them. @param period  s until it is
/// news again
bool isNews(const std::string& what, double period) {
  static std::map<std::string, ros::WallTime> said;
  const std::lock_guard<std::recursive_mutex> lock(oneAtATime());
  const ros::WallTime now = ProcessClock::now();
  const auto [entry, is_new] = said.try_emplace(what, now);
  if (!is_new && (now - entry->second).toSec() < period) return false;
  entry->second = now;
  return true;
}

/// A larger grid for a while, or messages that come all at once, leave holes between what is kept, which the
/// heap would never give back: the process would grow for hours. Takes some milliseconds.
void giveBackMemory() {
#ifdef __GLIBC__
  if (isNews("memory", kMemoryPeriod)) malloc_trim(0);
#endif
}

}  // namespace

void StreamNodelet::onInit() {
  // This is the loader's thread, while the queue is served already: the set-up goes there.
  timer_ = ProcessTimer(getNodeHandle(), kPeriod, [this] { started_ ? look() : start(); });
}

void StreamNodelet::start() {
  started_ = true;
  {
    const std::lock_guard<std::recursive_mutex> lock(oneAtATime());
    complete_ = attempt([this] { setUpAll(); });
  }
  if (!diagnostics_) return;
  // Not by the updater's own timing, which stops when a bag starts again.
  diagnostics_timer_ = ProcessTimer(getNodeHandle(), std::max(kPeriod, diagnostics_->getPeriod()), [this] {
    diagnostics_->force_update();
    giveBackMemory();
  });
  look();
}

void StreamNodelet::look() {
  updateInputs();
  if (connected_) attempt([this] { tick(); });
}

void StreamNodelet::describe(const std::string& what, const std::string& base_frame,
                             const StreamExpectation& expectation) {
  expectation_ = expectation;
  extrinsics_ = std::make_unique<Extrinsics>(base_frame, getNodeHandle());
  diagnostics_ =
      std::make_unique<diagnostic_updater::Updater>(getNodeHandle(), getPrivateNodeHandle(), getName());
  diagnostics_->setHardwareID(extrinsics_->baseFrame());
  addDiagnostic(what, [this](DiagnosticStatusWrapper& status) {
    if (complete_) report(status);
    if (complete_ && !connected_) status.summary(DiagnosticStatus::OK, "idle: no subscribers");
    reportConfiguration(status);
  });
}

void StreamNodelet::describe(const std::string& what, const StreamParams& params) {
  StreamExpectation expectation;
  expectation.rate = 0.0;  // cameras have all rates
  expectation.max_age = params.max_age;
  expectation.silent_after = params.silent_after;
  describe(what, params.base_frame, expectation);
  if (!ProcessClock::isRecorded()) background_ = std::make_unique<BackgroundThread>();
}

StreamExpectation StreamNodelet::expectationOf(const RateParams& params, double silent_after) {
  return {params.expected_rate, params.rate_tolerance, params.max_age,
          std::max(silent_after, 3.0 / params.expected_rate)};
}

StreamNodelet::Input& StreamNodelet::addInput(const std::string& title, std::unique_ptr<InputMonitor> monitor,
                                              const InputOptions& options, Stamps stamps) {
  inputs_.push_back(std::make_unique<Input>());
  Input& input = *inputs_.back();
  input.monitor = std::move(monitor);
  input.options = options;
  input.stamps = stamps;
  addDiagnostic(
      title, [&input](DiagnosticStatusWrapper& status) { input.monitor->report(ros::Time::now(), status); });
  return input;
}

void StreamNodelet::updateInputs() {
  if (!complete_) return;
  const bool audience = hasAudience();
  const bool left = connected_ && !audience;
  if (audience && !connected_) noteOutput();
  connected_ = audience;
  for (const std::unique_ptr<Input>& input : inputs_) {
    const bool wanted = audience && (!input->options.wanted || input->options.wanted());
    if (wanted != input->is_on) attempt([&] { switchInput(*input, wanted); });
  }
  if (left) clearHistory();
}

void StreamNodelet::switchInput(Input& input, bool on) {
  input.is_on = on;
  const std::lock_guard<std::recursive_mutex> lock(oneAtATime());
  if (on) {
    input.monitor->connect(input.subscribe());
    return;
  }
  input.monitor->disconnect();
  if (input.options.forget) input.options.forget();
}

InputMonitor& StreamNodelet::listenToTwists(EgoMotion& motion, const InputOptions& options) {
  return listen<geometry_msgs::TwistWithCovarianceStamped>(
      "ego/twist", kTwistQueue,
      [&motion](const geometry_msgs::TwistWithCovarianceStampedConstPtr& twist) { motion.add(*twist); },
      options);
}

InputMonitor& StreamNodelet::listenToCamera(sensor_msgs::CameraInfoConstPtr& camera,
                                            const InputOptions& options, std::function<void()> first) {
  auto monitor = std::make_unique<InputMonitor>("camera_info", expectation_, options.required);
  InputMonitor* const input = monitor.get();
  return *listenAs<sensor_msgs::CameraInfo>(
      "input camera_info", std::move(monitor), "camera_info", 2,
      [this, &camera, input, first = std::move(first)](const sensor_msgs::CameraInfoConstPtr& message) {
        const bool is_first = !camera;
        camera = message;
        const std::string doubt = distortionDoubt(*message);
        input->doubt(doubt);
        if (!doubt.empty()) warn("camera", "camera_info on '" + input->topic() + "': " + doubt);
        if (is_first && first) first();
      },
      options, Stamps::kAny);
}

InputMonitor& StreamNodelet::listenToClouds(const std::string& topic, RecentClouds& clouds,
                                            const InputOptions& options) {
  const std::string name = getNodeHandle().resolveName(topic);
  return listen<sensor_msgs::PointCloud2>(
      topic, kCloudQueue,
      [&clouds, name](const sensor_msgs::PointCloud2ConstPtr& cloud) { clouds.add(name, *cloud); }, options,
      Stamps::kUnordered);
}

InputMonitor& StreamNodelet::listenToImages(std::uint32_t queue_size,
                                            const std::function<void(LazyImage)>& body,
                                            const InputOptions& options) {
  auto monitor = std::make_unique<InputMonitor>("image", expectation_, options.required);
  watchImages(*monitor);
  const auto transport = getPrivateNodeHandle().param<std::string>("image_transport", "raw");
  if (transport == "compressed") {
    return *listenAs<sensor_msgs::CompressedImage>(
        "input image", std::move(monitor), "image/compressed", queue_size,
        [body](const sensor_msgs::CompressedImageConstPtr& image) { body(LazyImage(image)); }, options);
  }
  if (transport != "raw")
    reportProblem("image_transport '" + transport + "' is not one of raw, compressed; using raw");
  return *listenAs<sensor_msgs::Image>(
      "input image", std::move(monitor), "image", queue_size,
      [body, bits = std::make_shared<int>(8)](const sensor_msgs::ImageConstPtr& image) {
        body(LazyImage(withEightBits(image, *bits)));
      },
      options);
}

void StreamNodelet::watchImages(const InputMonitor& images) {
  images_timer_ = ProcessTimer(getNodeHandle(), kImagePeriod, [this, &images] {
    if (images.heard() || warnedOfSilence(images)) images_timer_.stop();
  });
}

bool StreamNodelet::warnedOfSilence(const InputMonitor& images) {
  // Before the clock of a replay runs, or the drivers, silence says nothing of the names.
  if (images.topic().empty() || ros::Time::now().isZero()) return false;
  ros::V_string ours;
  ros::this_node::getAdvertisedTopics(ours);
  const auto isOurs = [&ours](const std::string& topic) {
    return std::find(ours.begin(), ours.end(), topic) != ours.end();
  };
  if (isOurs(images.topic())) return true;  // who publishes it knows why
  ros::master::V_TopicInfo topics;
  ros::master::getTopics(topics);
  std::string others;
  for (const ros::master::TopicInfo& topic : topics) {
    const bool is_image =
        topic.datatype == "sensor_msgs/Image" || topic.datatype == "sensor_msgs/CompressedImage";
    if (is_image && topic.name != images.topic() && !isOurs(topic.name))
      others += (others.empty() ? "; images at hand: " : ", ") + topic.name;
  }
  const bool may_be_new = !std::exchange(others_seen_, images.publishers() > 0 || !others.empty());
  if (may_be_new || !others_seen_) return false;
  if (isNews(images.topic(), std::numeric_limits<double>::infinity()))
    NODELET_WARN("%s: nothing on '%s' yet (%u publishers)%s", getName().c_str(), images.topic().c_str(),
                 images.publishers(), others.c_str());
  return true;
}

bool StreamNodelet::isTopic(const std::string& topic, const std::string& parameter) {
  const std::string defect = topicDefect(getNodeHandle(), topic);
  if (!defect.empty()) {
    reportProblem(getPrivateNodeHandle().getNamespace() + "/" + parameter + " has '" + topic +
                  "': " + defect + "; it is left out");
  }
  return defect.empty();
}

bool StreamNodelet::attempt(const std::function<void()>& body) {
  try {
    body();
    return true;
  } catch (const std::exception& error) {
    // A timer's exception would end the process that we share with others.
    reportProblem(error.what());
    return false;
  }
}

void StreamNodelet::reportProblem(const std::string& problem) {
  if (std::find(problems_.begin(), problems_.end(), problem) != problems_.end()) return;
  problems_.push_back(problem);
  NODELET_ERROR("%s: %s", getName().c_str(), problem.c_str());
}

void StreamNodelet::reportConfiguration(DiagnosticStatusWrapper& status) const {
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
  if (isNews("time", 1.0))
    NODELET_WARN("%s: time jumped back to %.3f s; resetting", getName().c_str(), now.toSec());
  for (const std::unique_ptr<Input>& input : inputs_) input->monitor->reset();
  clearHistory();
}

void StreamNodelet::checkClock() {
  const ros::Time now = ros::Time::now();
  if (clock_.wentBack(now)) restart(now);
}

void StreamNodelet::guard(InputMonitor& input, const std::function<void()>& body) {
  const auto guarded = [&] {
    try {
      checkClock();
      body();
    } catch (const std::exception& error) {
      // Whatever the data are: they must not end the process that we share with others.
      input.refuse(error.what());
      warn(input.name(), input.noun() + " on '" + input.topic() + "' refused: " + error.what());
    }
  };
  if (background_)
    background_->run(guarded);
  else
    guarded();
}

void StreamNodelet::take(Input& input, const std_msgs::Header& header, const std::function<void()>& body) {
  guard(*input.monitor, [&] {
    if (input.stamps != Stamps::kByBody) accept(input, header);
    body();
  });
}

void StreamNodelet::acceptStamp(const InputMonitor& monitor, const std_msgs::Header& header) {
  for (const std::unique_ptr<Input>& input : inputs_)
    if (input->monitor.get() == &monitor) accept(*input, header);
}

void StreamNodelet::accept(Input& input, const std_msgs::Header& header) {
  InputMonitor& monitor = *input.monitor;
  const ros::Time now = ros::Time::now();
  switch (input.stamps) {
    case Stamps::kAny: monitor.acceptLatched(now); break;
    case Stamps::kUnordered: monitor.acceptUnordered(header, now); break;
    case Stamps::kRising:
    case Stamps::kByBody:
      if (monitor.accept(header, now)) break;
      if (input.options.forget) {
        NODELET_WARN("%s: the stamps of '%s' jumped back to %.3f s; resetting what came of it",
                     getName().c_str(), monitor.topic().c_str(), header.stamp.toSec());
        monitor.reset();
        input.options.forget();
      } else {
        restart(header.stamp);
      }
      monitor.accept(header, now);
      break;
  }
}

}  // namespace radar_dot
