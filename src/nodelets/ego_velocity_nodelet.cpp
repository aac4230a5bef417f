// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/ego_velocity_nodelet.h"

#include <geometry_msgs/TwistWithCovarianceStamped.h>

#include <algorithm>
#include <chrono>
#include <pluginlib/class_list_macros.hpp>
#include <utility>

#include "nodelets/messages/cloud_conversion.h"
#include "nodelets/messages/ego_messages.h"
#include "radar_dot/EgoStatus.h"

namespace radar_dot {
namespace {

// A mount may arrive a moment after the first scans; only then is its absence worth a warning.
constexpr double kMountTimeout = 1.0;  // s

// A radar without data after this time has probably the wrong topic name.
constexpr double kStartTimeout = 5.0;  // s, wall time

// Frames that wait for their mount; more are names that vary from message to message.
constexpr std::size_t kMaxMissingMounts = 100;

// A larger share of returns that are not finite is worth a warning.
constexpr double kMaxShareNotFinite = 0.5;

}  // namespace

void EgoVelocityNodelet::setUp() {
  ros::NodeHandle& handle = getNodeHandle();
  StreamExpectation images;
  images.rate = 0.0;  // cameras have all rates
  images.silent_after = 2.0;
  describe("configuration", config_.base_frame, images);
  radar_expectation_ = expectationOf(config_.rate, config_.sweep.silent_after);
  estimator_monitor_ = std::make_unique<EstimatorMonitor>(radar_expectation_);
  addDiagnostic("estimator", [this](diagnostic_updater::DiagnosticStatusWrapper& status) {
    estimator_monitor_->report(ros::Time::now(), status);
    mask_->report(status);
  });
  setUpMasks();
  setUpRadars();

  twist_publisher_ = handle.advertise<geometry_msgs::TwistWithCovarianceStamped>("ego/twist", 10);
  raw_twist_publisher_ = handle.advertise<geometry_msgs::TwistWithCovarianceStamped>("ego/twist_raw", 10);
  status_publisher_ = handle.advertise<EgoStatus>("ego/status", 10);
  static_publisher_ = handle.advertise<sensor_msgs::PointCloud2>("radar/static", 20);
  dynamic_publisher_ = handle.advertise<sensor_msgs::PointCloud2>("radar/dynamic", 20);
}

void EgoVelocityNodelet::started() {
  if (const std::string reason = disabledBy(); !reason.empty())
    NODELET_ERROR("%s: %s", getName().c_str(), reason.c_str());
  silence_timer_ = getNodeHandle().createWallTimer(
      ros::WallDuration(kStartTimeout), [this](const ros::WallTimerEvent&) { warnOfSilentRadars(); }, true);
}

void EgoVelocityNodelet::setUpMasks() {
  const InputOptions options = {true, [this] { return config_.use_mask; }, [this] { mask_->forget(); }};
  InputMonitor& masks = listen<sensor_msgs::Image>(
      "dynamic/mask", 2, [this](const sensor_msgs::ImageConstPtr& mask) { mask_->setMask(mask); }, options);
  InputMonitor& cameras = listen<sensor_msgs::CameraInfo>(
      "camera_info", 2, [this](const sensor_msgs::CameraInfoConstPtr& camera) { mask_->setCamera(camera); },
      options, Stamps::kAny);
  mask_ = std::make_unique<MaskInput>(*extrinsics_, masks, cameras);
}

void EgoVelocityNodelet::warnOfSilentRadars() {
  for (const std::unique_ptr<Radar>& radar : radars_) {
    if (radar->monitor.heard()) continue;
    NODELET_WARN("%s: nothing on '%s' yet (%u publishers)", getName().c_str(), radar->entry.topic.c_str(),
                 radar->monitor.publishers());
  }
}

void EgoVelocityNodelet::setUpRadars() {
  const std::string parameter = fieldsOf(config_).dictionaries().front().name;
  for (const auto& [name, given] : config_.radars) {
    const RadarEntry entry = withPreset(given);
    if (!isTopic(entry.topic, parameter + "/" + name + "/" + nameOf(entry, entry.topic))) continue;
    RadarMonitor* monitor = listenAs<sensor_msgs::PointCloud2>(
        "radar " + name, std::make_unique<RadarMonitor>(name, radar_expectation_, config_.sweep.window),
        entry.topic, static_cast<std::uint32_t>(config_.queue_size),
        [this, i = radars_.size()](const sensor_msgs::PointCloud2ConstPtr& cloud) { onCloud(i, cloud); }, {},
        Stamps::kByBody);
    radars_.push_back(std::make_unique<Radar>(Radar{name, entry, *monitor, DopplerExtractor()}));
    radars_.back()->entry.topic = getNodeHandle().resolveName(entry.topic);
  }
  if (radars_.empty()) {
    reportProblem("no radars: set " + getPrivateNodeHandle().resolveName(parameter) +
                  " to a dictionary, e.g. {radar_front: {topic: /radar_front}}");
  }
  assembler_.emplace(radars_.size(), config_.sweep);
}

std::string EgoVelocityNodelet::disabledBy() const {
  const std::string disabled = "estimation disabled until the parameters are corrected";
  if (!server_ || !server_->usable()) return disabled;
  static const char* const scale =
      nameOf(config_, config_.extraction.doppler_scale);  // asked for every cloud
  return server_->refusedAtStart(scale) ? disabled + ": " + scale : "";
}

void EgoVelocityNodelet::apply(const EgoVelocityConfig& config) {
  // Everything that can throw comes first: what is refused changes nothing.
  std::vector<std::pair<Radar*, DopplerExtractor>> extractors;
  for (const std::unique_ptr<Radar>& radar : radars_) {
    const ExtractionParams params = extractionOf(config, radar->entry);
    if (!sameFields(radar->extractor.params(), params))
      extractors.emplace_back(radar.get(), DopplerExtractor(params));
  }
  estimator_.configure(config);

  for (auto& [radar, extractor] : extractors) radar->extractor = std::move(extractor);
  mask_->configure(config);
  config_ = config;
}

void EgoVelocityNodelet::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  status.summaryf(DiagnosticStatus::OK, "%zu radars", radars_.size());
  if (const std::string reason = disabledBy(); !reason.empty())
    status.mergeSummary(DiagnosticStatus::ERROR, reason);
}

void EgoVelocityNodelet::onCloud(std::size_t index, const sensor_msgs::PointCloud2ConstPtr& cloud) {
  Radar& radar = *radars_[index];
  if (!disabledBy().empty()) return;
  auto reading = std::make_shared<RadarReading>();
  reading->cloud = cloud;
  reading->view = viewOf(*cloud, reading->fields);
  if (reading->view.size() > 0) reading->counts = radar.extractor.extract(reading->view, reading->returns);

  acceptStamp(radar.monitor, cloud->header);

  const ExtractionCounts& counts = reading->counts;
  // One point of NaN is how some radars say "nothing seen".
  if (counts.total > 1 &&
      static_cast<double>(counts.not_finite) > kMaxShareNotFinite * static_cast<double>(counts.total)) {
    warn(radar.name, std::to_string(counts.not_finite) + " of " + std::to_string(counts.total) +
                         " returns on '" + radar.entry.topic + "' are not finite");
  }

  // Only later stamps reach this: the assembler neither rejects them nor resets.
  assembler_->add({index, cloud->header.stamp.toSec(), reading}, completed_);
  radar.monitor.scan(cloud->header.frame_id, counts);
  for (const Sweep& sweep : completed_) processSweep(sweep);
  completed_.clear();
}

void EgoVelocityNodelet::clearHistory() {
  assembler_->reset();
  estimator_.reset();
  mask_->forget();
  estimator_monitor_->reset();
}

std::optional<Eigen::Isometry3d> EgoVelocityNodelet::mountOf(Radar& radar, const std::string& frame,
                                                             std::string& error) {
  std::string cause;
  std::optional<Eigen::Isometry3d> mount = extrinsics_->lookup(frame, cause);
  radar.monitor.mount(cause);
  if (mount) {
    mount_missing_since_.erase(frame);
    return corrected(*mount, radar.entry);
  }
  const ros::WallTime now = ros::WallTime::now();
  if (mount_missing_since_.size() > kMaxMissingMounts) mount_missing_since_.clear();
  const ros::WallTime since = mount_missing_since_.try_emplace(frame, now).first->second;
  if ((now - since).toSec() > kMountTimeout && throttle_.allow(radar.name, cause)) {
    NODELET_WARN("%s: the scans on '%s' are skipped: %s", getName().c_str(), radar.entry.topic.c_str(),
                 cause.c_str());
  }
  error = cause;
  return std::nullopt;
}

void EgoVelocityNodelet::processSweep(const Sweep& sweep) {
  std::vector<RadarScan> scans;
  Readings readings;
  std::string mount_error;
  for (const Assembler::Scan& scan : sweep.scans) {
    Radar& radar = *radars_[scan.radar];
    radar.monitor.used();
    const auto mount = mountOf(radar, scan.reading->cloud->header.frame_id, mount_error);
    if (!mount) continue;
    scans.push_back({scan.reading->returns, *mount, scan.time, scan.radar});
    mask_->mark(scans.back());
    readings.push_back(scan.reading);
  }

  const ros::Time stamp = sweep.scans[sweep.newest].reading->cloud->header.stamp;
  const auto start = std::chrono::steady_clock::now();
  const SweepEstimate estimate = estimator_.estimate(scans, sweep.time());
  const double computation_time =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const EgoVelocityResult& result = estimate.single;
  estimator_monitor_->estimate(stamp, ros::Time::now(), result, sweep.left_out, computation_time);

  std::string reason = result.reason;
  if (!result.valid() && !mount_error.empty()) reason += "; " + mount_error;
  publishStatus(stamp, result, readings, reason, computation_time);
  if (!result.valid()) {
    if (throttle_.allow("estimate", "refused"))
      NODELET_WARN("%s: no estimate: %s", getName().c_str(), reason.c_str());
    return;
  }
  if (result.observed[0]) mask_->add({sweep.time(), result.linear, result.angular});
  publishTwist(stamp, estimate);
  publishClouds(readings, result);
}

void EgoVelocityNodelet::publishTwist(const ros::Time& stamp, const SweepEstimate& estimate) {
  raw_twist_publisher_.publish(twistMessage(stamp, extrinsics_->baseFrame(), estimate.single));
  if (const std::optional<EgoVelocityResult> output = estimate.output())
    twist_publisher_.publish(twistMessage(stamp, extrinsics_->baseFrame(), *output));
  if (estimate.filtered && estimate.filtered->was_reset && throttle_.allow("filter", "reset")) {
    NODELET_WARN("%s: velocity filter reset: gap in the input, or repeated estimates outside its gate",
                 getName().c_str());
  }
}

void EgoVelocityNodelet::publishStatus(const ros::Time& stamp, const EgoVelocityResult& result,
                                       const Readings& readings, const std::string& reason,
                                       double computation_time) {
  if (status_publisher_.getNumSubscribers() == 0) return;
  EgoStatus message = statusMessage(stamp, extrinsics_->baseFrame(), estimator_.params(), result);
  message.reason = reason;
  for (const auto& reading : readings)
    message.total_count += static_cast<std::uint32_t>(reading->counts.total);
  message.radar_count = static_cast<std::uint32_t>(readings.size());
  message.computation_time = computation_time;
  status_publisher_.publish(message);
}

void EgoVelocityNodelet::publishClouds(const Readings& readings, const EgoVelocityResult& result) {
  const auto publish = [&](const ros::Publisher& publisher, ReturnLabel wanted) {
    if (publisher.getNumSubscribers() == 0) return;
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const RadarReading& reading = *readings[i];
      publisher.publish(labelledCloud(*reading.cloud, reading.view, reading.returns,
                                      result.residuals.data() + result.offsets[i],
                                      result.labels.data() + result.offsets[i], wanted));
    }
  };
  publish(static_publisher_, ReturnLabel::kStatic);
  publish(dynamic_publisher_, ReturnLabel::kDynamic);
}

}  // namespace radar_dot

PLUGINLIB_EXPORT_CLASS(radar_dot::EgoVelocityNodelet, nodelet::Nodelet)
