// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "ego_velocity_nodelet.h"

#include <geometry_msgs/TwistWithCovarianceStamped.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>
#include <utility>

#include "cloud_conversion.h"
#include "ego_messages.h"
#include "radar_dot/EgoStatus.h"

namespace radar_dot {
namespace {

// A mount may arrive a moment after the first scans; only then is its absence worth a warning.
constexpr double kMountTimeout = 1.0;  // s

// A radar without data after this time has probably the wrong topic name.
constexpr double kStartTimeout = 5.0;  // s, wall time

// Frames that wait for their mount; more are names that vary from message to message.
constexpr std::size_t kMaxMissingMounts = 100;

// A yaw rate older than this does not tell how far the bearings have turned.
constexpr double kMaxTurningAge = 1.0;  // s

// A larger share of returns that are not finite is worth a warning.
constexpr double kMaxShareNotFinite = 0.5;

std::shared_ptr<const RadarReading> readingOf(const SweepScan& scan) {
  return std::static_pointer_cast<const RadarReading>(scan.reading);
}

}  // namespace

void EgoVelocityNodelet::onInit() {
  ros::NodeHandle& handle = getNodeHandle();
  ros::NodeHandle& private_handle = getPrivateNodeHandle();

  extrinsics_ =
      std::make_unique<Extrinsics>(private_handle.param<std::string>("base_frame", "base_link"), handle);
  sweep_params_.window = positiveParameter(private_handle, "window", sweep_params_.window);
  sweep_params_.silent_after = positiveParameter(private_handle, "silent_after", sweep_params_.silent_after);
  expectation_.rate = positiveParameter(private_handle, "expected_rate", expectation_.rate);
  expectation_.rate_tolerance =
      positiveParameter(private_handle, "rate_tolerance", expectation_.rate_tolerance);
  expectation_.max_age = positiveParameter(private_handle, "max_age", expectation_.max_age);
  // Slower radars than usual are waited for accordingly.
  expectation_.silent_after = std::max(sweep_params_.silent_after, 3.0 / expectation_.rate);
  estimator_monitor_ = std::make_unique<EstimatorMonitor>(expectation_);

  twist_publisher_ = handle.advertise<geometry_msgs::TwistWithCovarianceStamped>("ego/twist", 10);
  raw_twist_publisher_ = handle.advertise<geometry_msgs::TwistWithCovarianceStamped>("ego/twist_raw", 10);
  status_publisher_ = handle.advertise<EgoStatus>("ego/status", 10);
  static_publisher_ = handle.advertise<sensor_msgs::PointCloud2>("radar/static", 20);
  dynamic_publisher_ = handle.advertise<sensor_msgs::PointCloud2>("radar/dynamic", 20);

  mask_ = std::make_unique<MaskInput>(handle, *extrinsics_, [this](const std::string& text) {
    if (throttle_.allow("mask", text)) NODELET_WARN("%s: %s", getName().c_str(), text.c_str());
  });
  setUpRadars();
  setUpReconfigure();
  setUpDiagnostics();

  const int queue_size = std::max(1, private_handle.param("queue_size", 5));
  for (std::size_t i = 0; i < radars_.size(); ++i) {
    radars_[i]->subscriber = handle.subscribe<sensor_msgs::PointCloud2>(
        radars_[i]->config.topic, static_cast<std::uint32_t>(queue_size),
        [this, i](const sensor_msgs::PointCloud2ConstPtr& cloud) { onCloud(i, cloud); });
  }
  silence_timer_ = handle.createWallTimer(
      ros::WallDuration(kStartTimeout), [this](const ros::WallTimerEvent&) { warnOfSilentRadars(); }, true);
}

void EgoVelocityNodelet::warnOfSilentRadars() {
  for (const std::unique_ptr<Radar>& radar : radars_) {
    if (radar->received) continue;
    NODELET_WARN("%s: nothing on '%s' yet (%u publishers)", getName().c_str(), radar->config.topic.c_str(),
                 radar->subscriber.getNumPublishers());
  }
}

void EgoVelocityNodelet::setUpRadars() {
  const ros::NodeHandle& private_handle = getPrivateNodeHandle();
  XmlRpc::XmlRpcValue value;
  std::vector<RadarConfig> configs;
  std::vector<std::string> problems;
  if (private_handle.getParam("radars", value)) configs = radarsFromParameter(value, problems);
  for (const std::string& problem : problems) {
    NODELET_ERROR("%s: %s", getName().c_str(), problem.c_str());
    configuration_error_ = problem;
  }
  for (RadarConfig& config : configs) {
    config.topic = getNodeHandle().resolveName(config.topic);
    radars_.push_back(std::make_unique<Radar>(std::move(config), expectation_, sweep_params_.window));
  }
  if (radars_.empty()) {
    configuration_error_ = "no radars: set " + private_handle.resolveName("radars") +
                           " to a dictionary, e.g. {radar_front: {topic: /radar_front}}";
    NODELET_FATAL("%s", configuration_error_.c_str());
  }
  assembler_.emplace(radars_.size(), sweep_params_);
}

void EgoVelocityNodelet::setUpReconfigure() {
  const ros::NodeHandle& private_handle = getPrivateNodeHandle();
  for (const char* name : {"invalid_states", "ambig_states", "pdh0_states"}) {
    XmlRpc::XmlRpcValue value;
    if (!private_handle.getParam(name, value)) continue;
    if (const std::optional<std::string> text = stateListText(value)) private_handle.setParam(name, *text);
  }
  reconfigure_server_ = std::make_unique<dynamic_reconfigure::Server<EgoVelocityConfig>>(private_handle);
  reconfigure_server_->setCallback(
      [this](EgoVelocityConfig& config, std::uint32_t level) { reconfigure(config, level); });
}

void EgoVelocityNodelet::applyConfig(const EgoVelocityConfig& config) {
  // Everything that can refuse comes first: what is refused changes nothing.
  const ExtractionParams common = extractionParams(config);
  const DopplerExtractor check(common);
  EgoVelocityEstimator estimator(estimatorParams(config));
  const MaskFootprint footprint = maskFootprint(config);
  VelocityFilter filter(filterParams(config));

  estimator_ = std::move(estimator);
  filter_ = std::move(filter);
  filters_ = config.filter;
  bearing_delay_ = config.bearing_delay;
  mask_->configure(config.use_mask, config.mask_max_age, footprint);
  for (const std::unique_ptr<Radar>& radar : radars_) {
    ExtractionParams params = common;
    params.doppler_scale = radar->config.doppler_scale.value_or(common.doppler_scale);
    radar->extractor = DopplerExtractor(params);
  }
}

void EgoVelocityNodelet::reconfigure(EgoVelocityConfig& config, std::uint32_t /*level*/) {
  if (!config_) {
    configureAtStart(config);
  } else {
    try {
      applyConfig(config);
      parameter_error_.clear();
      can_estimate_ = true;
    } catch (const std::invalid_argument& error) {
      NODELET_ERROR("%s: %s; keeping the parameters as they were", getName().c_str(), error.what());
      config = *config_;
    }
  }
  config_ = config;
}

// One bad value must not take the good ones with it.
void EgoVelocityNodelet::configureAtStart(EgoVelocityConfig& config) {
  const MendedConfig mended = mendedConfig(config);
  config = mended.config;
  can_estimate_ = mended.usable;
  for (const std::string& problem : mended.problems) {
    NODELET_ERROR("%s: %s", getName().c_str(), problem.c_str());
    parameter_error_ += (parameter_error_.empty() ? "" : "; ") + problem;
  }
  if (!can_estimate_) {
    parameter_error_ += "; estimation disabled until the parameters are corrected";
    NODELET_ERROR("%s: estimation disabled until the parameters are corrected", getName().c_str());
  }
  applyConfig(mended.valid ? config : EgoVelocityConfig::__getDefault__());
}

void EgoVelocityNodelet::setUpDiagnostics() {
  diagnostics_ =
      std::make_unique<diagnostic_updater::Updater>(getNodeHandle(), getPrivateNodeHandle(), getName());
  diagnostics_->setHardwareID(extrinsics_->baseFrame());
  diagnostics_->add("configuration", [this](diagnostic_updater::DiagnosticStatusWrapper& status) {
    using diagnostic_msgs::DiagnosticStatus;
    status.summaryf(DiagnosticStatus::OK, "%zu radars", radars_.size());
    for (const std::string& error : {configuration_error_, parameter_error_}) {
      if (!error.empty()) status.mergeSummary(DiagnosticStatus::ERROR, error);
    }
  });
  diagnostics_->add("estimator", [this](diagnostic_updater::DiagnosticStatusWrapper& status) {
    estimator_monitor_->report(ros::Time::now(), status);
    mask_->report(status);
  });
  for (InputMonitor* monitor : {&mask_->maskMonitor(), &mask_->cameraMonitor()}) {
    diagnostics_->add("input " + monitor->name(),
                      [monitor](diagnostic_updater::DiagnosticStatusWrapper& status) {
                        monitor->report(ros::Time::now(), status);
                      });
  }
  for (const std::unique_ptr<Radar>& radar : radars_) {
    diagnostics_->add("radar " + radar->config.name,
                      [monitor = &radar->monitor](diagnostic_updater::DiagnosticStatusWrapper& status) {
                        monitor->report(ros::Time::now(), status);
                      });
  }
  // Wall time: the updater's own timing stops when a bag starts again.
  diagnostics_timer_ = getNodeHandle().createWallTimer(
      ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { diagnostics_->force_update(); });
}

void EgoVelocityNodelet::refuse(Radar& radar, const std::string& cause) {
  radar.monitor.refuse(cause);
  if (throttle_.allow(radar.config.name, cause)) {
    NODELET_WARN("%s: cloud on '%s' refused: %s", getName().c_str(), radar.config.topic.c_str(),
                 cause.c_str());
  }
}

std::shared_ptr<const RadarReading> EgoVelocityNodelet::read(Radar& radar,
                                                             const sensor_msgs::PointCloud2ConstPtr& cloud) {
  checkHeader(cloud->header, ros::Time::now());
  auto reading = std::make_shared<RadarReading>();
  reading->cloud = cloud;
  reading->view = viewOf(*cloud, reading->fields);
  if (reading->view.size() > 0) reading->counts = radar.extractor.extract(reading->view, reading->returns);
  return reading;
}

void EgoVelocityNodelet::onCloud(std::size_t index, const sensor_msgs::PointCloud2ConstPtr& cloud) {
  radars_[index]->received = true;
  try {
    addScan(index, cloud);
  } catch (const std::exception& error) {
    // Whatever the data are: they must not end the process that we share with others.
    refuse(*radars_[index], error.what());
  }
}

void EgoVelocityNodelet::addScan(std::size_t index, const sensor_msgs::PointCloud2ConstPtr& cloud) {
  Radar& radar = *radars_[index];
  if (!can_estimate_) return;
  if (clock_.wentBack(ros::Time::now())) clearHistory(cloud->header.stamp);
  const std::shared_ptr<const RadarReading> reading = read(radar, cloud);
  switch (radar.stamps.check(cloud->header.stamp)) {
    case StampGuard::Verdict::kGood: break;
    case StampGuard::Verdict::kStale:
      throw std::invalid_argument("stamp not newer than the previous cloud's");
    case StampGuard::Verdict::kRestart:
      clearHistory(cloud->header.stamp);
      radar.stamps.check(cloud->header.stamp);
      break;
  }

  const ExtractionCounts& counts = reading->counts;
  // One point of NaN is how some radars say "nothing seen".
  if (counts.total > 1 &&
      static_cast<double>(counts.not_finite) > kMaxShareNotFinite * static_cast<double>(counts.total) &&
      throttle_.allow(radar.config.name, "not finite")) {
    NODELET_WARN("%s: %zu of %zu returns on '%s' are not finite", getName().c_str(), counts.not_finite,
                 counts.total, radar.config.topic.c_str());
  }

  // The guard let only later stamps through: the assembler neither rejects them nor resets.
  assembler_->add({index, cloud->header.stamp.toSec(), reading}, completed_);
  radar.monitor.scan(cloud->header.stamp, ros::Time::now(), cloud->header.frame_id, counts);
  for (const Sweep& sweep : completed_) processSweep(sweep);
  completed_.clear();
}

void EgoVelocityNodelet::clearHistory(const ros::Time& stamp) {
  NODELET_WARN("%s: time jumped back to %.3f s; resetting", getName().c_str(), stamp.toSec());
  assembler_->reset();
  tracker_.reset();
  filter_.reset();
  turning_.reset();
  mask_->forget();
  estimator_monitor_->reset();
  for (const std::unique_ptr<Radar>& radar : radars_) {
    radar->monitor.reset();
    radar->stamps.reset();
  }
}

std::vector<EgoVelocityNodelet::MountedScan> EgoVelocityNodelet::mountedScans(const Sweep& sweep,
                                                                              std::vector<RadarScan>& scans,
                                                                              std::string& error) {
  std::vector<MountedScan> mounted;
  for (const SweepScan& scan : sweep.scans) {
    Radar& radar = *radars_[scan.radar];
    radar.monitor.used();
    const std::shared_ptr<const RadarReading> reading = readingOf(scan);
    const std::string& frame = reading->cloud->header.frame_id;
    std::string cause;
    const std::optional<Eigen::Isometry3d> mount = extrinsics_->lookup(frame, cause);
    radar.monitor.mount(cause);
    if (!mount) {
      const ros::WallTime now = ros::WallTime::now();
      if (mount_missing_since_.size() > kMaxMissingMounts) mount_missing_since_.clear();
      const ros::WallTime since = mount_missing_since_.try_emplace(frame, now).first->second;
      if ((now - since).toSec() > kMountTimeout && throttle_.allow(radar.config.name, cause)) {
        NODELET_WARN("%s: the scans on '%s' are skipped: %s", getName().c_str(), radar.config.topic.c_str(),
                     cause.c_str());
      }
      error = cause;
      continue;
    }
    mount_missing_since_.erase(frame);
    RadarScan& estimated = scans.emplace_back();
    estimated.returns = &reading->returns;
    estimated.T_base_from_sensor = *mount;
    estimated.T_base_from_sensor.linear() =
        Eigen::AngleAxisd(radar.config.mount_yaw_correction, Eigen::Vector3d::UnitZ()) * mount->linear();
    estimated.time = scan.time;
    estimated.radar = scan.radar;
    if (turning_ && std::abs(scan.time - turning_->time) < kMaxTurningAge)
      estimated.bearing_rotation = bearing_delay_ * turning_->angular.z();
    mounted.push_back(
        {scan.radar, reading,
         mask_->marked(reading->returns, estimated.T_base_from_sensor, reading->cloud->header.stamp)});
  }
  // Only now: the vector above no longer moves.
  for (std::size_t i = 0; i < mounted.size(); ++i)
    if (!mounted[i].in_mask.empty()) scans[i].known_dynamic = &mounted[i].in_mask;
  return mounted;
}

void EgoVelocityNodelet::processSweep(const Sweep& sweep) {
  std::vector<RadarScan> scans;
  std::string mount_error;
  const std::vector<MountedScan> mounted = mountedScans(sweep, scans, mount_error);

  const ros::Time stamp = readingOf(sweep.scans[sweep.newest])->cloud->header.stamp;
  const auto start = std::chrono::steady_clock::now();
  const EgoVelocityResult& result =
      estimator_.estimate(scans, sweep.time(), tracker_.acceleration(sweep.time()));
  const double computation_time =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  estimator_monitor_->estimate(stamp, ros::Time::now(), result, sweep.left_out, computation_time);

  std::string reason = result.reason;
  if (!result.valid() && !mount_error.empty()) reason += "; " + mount_error;
  publishStatus(stamp, result, mounted, reason, computation_time);
  if (!result.valid()) {
    if (throttle_.allow("estimate", "refused"))
      NODELET_WARN("%s: no estimate: %s", getName().c_str(), reason.c_str());
    return;
  }
  turning_ = StampedVelocity{sweep.time(), result.linear, result.angular};
  if (result.observed[0]) tracker_.add(sweep.time(), result.linear);
  if (result.observed[0]) mask_->add(*turning_);
  publishTwist(stamp, sweep.time(), scans, result);
  publishClouds(mounted, result);
}

void EgoVelocityNodelet::publishTwist(const ros::Time& stamp, double time,
                                      const std::vector<RadarScan>& scans, const EgoVelocityResult& result) {
  const auto raw = twistMessage(stamp, extrinsics_->baseFrame(), result);
  raw_twist_publisher_.publish(raw);
  if (!filters_) {
    twist_publisher_.publish(raw);
    return;
  }
  const bool was_started = filter_.started();
  const VelocityFilter::Outcome outcome = filter_.update(time, result, sensorVelocities(scans, result));
  if (outcome == VelocityFilter::Outcome::kStarted && was_started && throttle_.allow("filter", "anew"))
    NODELET_WARN("%s: velocity filter reset: gap in the input, or repeated estimates outside its gate", getName().c_str());
  if (outcome == VelocityFilter::Outcome::kStale) return;
  twist_publisher_.publish(
      twistMessage(stamp, extrinsics_->baseFrame(), filteredResult(filter_.at(time), result)));
}

void EgoVelocityNodelet::publishStatus(const ros::Time& stamp, const EgoVelocityResult& result,
                                       const std::vector<MountedScan>& mounted, const std::string& reason,
                                       double computation_time) {
  if (status_publisher_.getNumSubscribers() == 0) return;
  EgoStatus message = statusMessage(stamp, extrinsics_->baseFrame(), estimator_.params(), result);
  message.reason = reason;
  for (const MountedScan& scan : mounted) {
    message.total_count += static_cast<std::uint32_t>(scan.reading->counts.total);
  }
  message.radar_count = static_cast<std::uint32_t>(mounted.size());
  message.computation_time = computation_time;
  status_publisher_.publish(message);
}

void EgoVelocityNodelet::publishClouds(const std::vector<MountedScan>& scans,
                                       const EgoVelocityResult& result) {
  const auto publish = [&](const ros::Publisher& publisher, ReturnLabel wanted) {
    if (publisher.getNumSubscribers() == 0) return;
    for (std::size_t i = 0; i < scans.size(); ++i) {
      const RadarReading& reading = *scans[i].reading;
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
