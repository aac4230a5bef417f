// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/ego_velocity_nodelet.h"

#include <fmt/format.h>
#include <geometry_msgs/TwistWithCovarianceStamped.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <pluginlib/class_list_macros.hpp>
#include <set>
#include <system_error>
#include <utility>

#include "config/mount_yaws.h"
#include "nodelets/common/process_clock.h"
#include "nodelets/messages/cloud_conversion.h"
#include "nodelets/messages/ego_messages.h"
#include "radar_dot/EgoStatus.h"
#include "radar_dot/radar/mount_geometry.h"

namespace radar_dot {
namespace {

// A mount may arrive a moment after the first scans; only then is its absence worth a warning.
constexpr double kMountTimeout = 1.0;  // s

// A radar without data after this time has probably the wrong topic name.
constexpr double kStartTimeout = 5.0;  // s, wall time

// Frames that wait for their mount; more are names that vary from message to message.
constexpr std::size_t kMaxMissingMounts = 100;

// A larger fraction of returns that are not finite is worth a warning.
constexpr double kMaxShareNotFinite = 0.5;

constexpr std::size_t kSweepsBeforeAssessment = 20;
constexpr std::size_t kComparisonInterval = 4;  // sweeps
constexpr double kTwinMemory = 3.0;             // s, wall time

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
  setUpRotation();
  readMountYawsFile();

  twist_publisher_ = handle.advertise<geometry_msgs::TwistWithCovarianceStamped>("ego/twist", 10);
  raw_twist_publisher_ = handle.advertise<geometry_msgs::TwistWithCovarianceStamped>("ego/twist_raw", 10);
  status_publisher_ = handle.advertise<EgoStatus>("ego/status", 10);
  static_publisher_ = handle.advertise<sensor_msgs::PointCloud2>("radar/static", 20);
  dynamic_publisher_ = handle.advertise<sensor_msgs::PointCloud2>("radar/dynamic", 20);
}

void EgoVelocityNodelet::started() {
  if (const std::string reason = disabledBy(); !reason.empty())
    NODELET_ERROR("%s: %s", getName().c_str(), reason.c_str());
  if (rotation_source_) rotation_source_->start();
  silence_timer_ = ProcessTimer(getNodeHandle(), kStartTimeout, [this] {
    if (warnOfSilentRadars()) silence_timer_.stop();
  });
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

bool EgoVelocityNodelet::warnOfSilentRadars() {
  const auto heard = [](const std::unique_ptr<Radar>& radar) { return radar->monitor.heard(); };
  if (std::all_of(radars_.begin(), radars_.end(), heard)) return true;
  const std::string others = otherClouds();
  // Before a bag plays, or the drivers run, silence says nothing of the names.
  const bool others_last = std::exchange(other_clouds_seen_, !others.empty());
  if (!(others_last && other_clouds_seen_) && std::none_of(radars_.begin(), radars_.end(), heard))
    return false;
  for (const std::unique_ptr<Radar>& radar : radars_) {
    if (heard(radar)) continue;
    NODELET_WARN("%s: nothing on '%s' yet (%u publishers)%s%s", getName().c_str(), radar->topic.c_str(),
                 radar->monitor.publishers(), others.empty() ? "" : "; clouds at hand: ", others.c_str());
  }
  return true;
}

std::string EgoVelocityNodelet::otherClouds() const {
  ros::master::V_TopicInfo topics;
  ros::master::getTopics(topics);
  std::vector<std::string> names;
  std::set<std::string> known;
  for (const char* name : {"radar/static", "radar/dynamic"}) known.insert(getNodeHandle().resolveName(name));
  for (const std::unique_ptr<Radar>& radar : radars_) known.insert(radar->topic);
  for (const ros::master::TopicInfo& topic : topics)
    if (RadarMessage::takes(topic.datatype) && known.count(topic.name) == 0) names.push_back(topic.name);
  std::sort(names.begin(), names.end());
  return fmt::format("{}", fmt::join(names, ", "));
}

void EgoVelocityNodelet::setUpRadars() {
  const std::string parameter = fieldsOf(config_).dictionaries().front().name;
  for (const auto& [name, given] : config_.radars) {
    const RadarEntry entry = withPreset(given);
    if (!isTopic(entry.topic, fmt::format("{}/{}/{}", parameter, name, nameOf(entry, entry.topic)))) continue;
    if (const std::string other = sameSourceAs(entry); !other.empty()) {
      reportProblem(
          fmt::format("{}/{} has the topic of {}, '{}': its returns would count twice; it is left out",
                      parameter, name, other, getNodeHandle().resolveName(entry.topic)));
      continue;
    }
    const StreamExpectation expectation = expectationOf(rateOf(config_, entry), config_.sweep.silent_after);
    RadarMonitor* monitor = listenAs<RadarMessage>(
        "radar " + name, std::make_unique<RadarMonitor>(name, expectation, config_.sweep.window), entry.topic,
        static_cast<std::uint32_t>(config_.queue_size),
        [this, i = radars_.size()](const RadarMessageConstPtr& message) { onMessage(i, *message); }, {},
        Stamps::kByBody);
    radars_.push_back(std::make_unique<Radar>(Radar{name,
                                                    getNodeHandle().resolveName(entry.topic),
                                                    *monitor,
                                                    RadarInput(entry),
                                                    mountOf(entry),
                                                    {},
                                                    {},
                                                    {},
                                                    {},
                                                    {}}));
  }
  if (radars_.empty()) {
    reportProblem("no radars: set " + getPrivateNodeHandle().resolveName(parameter) +
                  " to a dictionary, e.g. {radar_front: {topic: /radar_front}}");
  }
  assembler_.emplace(radars_.size(), config_.sweep);
  mount_broadcaster_ = std::make_unique<tf2_ros::StaticTransformBroadcaster>();
}

std::string EgoVelocityNodelet::sameSourceAs(const RadarEntry& entry) const {
  const std::string topic = getNodeHandle().resolveName(entry.topic);
  for (const std::unique_ptr<Radar>& radar : radars_) {
    const std::string& frame = radar->input.entry().only_frame;
    const bool apart =
        !frame.empty() && !entry.only_frame.empty();  // of one name: refused with the parameters
    if (radar->topic == topic && !apart) return radar->name;
  }
  return {};
}

void EgoVelocityNodelet::lookForTwin(Radar& radar, const RadarReading& reading) {
  constexpr std::size_t kLeastReturns = 8;  // fewer may be alike by chance
  if (reading.returns.size() < kLeastReturns) return;
  radar.earlier = std::exchange(radar.latest, reading.cloud);
  for (const std::unique_ptr<Radar>& other : radars_) {
    if (other.get() == &radar) continue;
    for (const sensor_msgs::PointCloud2ConstPtr& cloud : {other->latest, other->earlier}) {
      if (!cloud || cloud->data != reading.cloud->data) continue;
      twins_until_ = ProcessClock::now() + ros::WallDuration(kTwinMemory);
      twins_ = fmt::format(
          "{} and {} send the same returns, which count twice: is one radar there under two topics?",
          std::min(other->name, radar.name), std::max(other->name, radar.name));
    }
  }
}

void EgoVelocityNodelet::setUpRotation() {
  RotationSource::Callbacks callbacks;
  callbacks.arrival = [this] { checkClock(); };
  callbacks.sample = callbacks.restarted = [] {};
  callbacks.warn = [this](const std::string& text) { warn("rotation", text); };
  try {
    rotation_source_ =
        makeRotationSource(config_.rotation, getNodeHandle(), *extrinsics_, std::move(callbacks));
  } catch (const std::invalid_argument& error) {
    reportProblem(std::string(error.what()) + "; the returns alone tell the velocity");
  }
}

void EgoVelocityNodelet::readMountYawsFile() {
  const std::string& file = config_.mount_yaws_file;
  if (file.empty()) return;
  std::error_code error;
  if (!std::filesystem::exists(file, error) && !error) {
    NODELET_INFO("%s: %s is not there yet: mounts start as configured", getName().c_str(), file.c_str());
    mount_yaws_file_ = file;
    return;
  }
  try {
    mount_yaws_ = readMountYaws(file);
  } catch (const std::exception& defect) {
    reportProblem(fmt::format("{}: {}; mounts start as configured, and the file stays as it is",
                              nameOf(config_, config_.mount_yaws_file), defect.what()));
    return;
  }
  mount_yaws_file_ = file;
  std::vector<std::optional<MountYaw>> start;
  std::size_t known = 0;
  for (const std::unique_ptr<Radar>& radar : radars_) {
    const auto saved = mount_yaws_.find(radar->name);
    start.push_back(saved == mount_yaws_.end() ? std::nullopt : std::optional<MountYaw>(saved->second));
    known += saved != mount_yaws_.end();
  }
  estimator_.startFrom(std::move(start));
  NODELET_INFO("%s: the yaws of %zu of %zu mounts start as in %s", getName().c_str(), known, radars_.size(),
               file.c_str());
  if (known < mount_yaws_.size()) {
    NODELET_WARN("%s: %s names %zu radars that are not here", getName().c_str(), file.c_str(),
                 mount_yaws_.size() - known);
  }
}

void EgoVelocityNodelet::writeMountYawsFile() const {
  std::map<std::string, MountYaw> yaws = mount_yaws_;
  bool learnt = false;
  for (std::size_t i = 0; i < radars_.size(); ++i) {
    const MountYaw mount = estimator_.mountYaw(i);
    if (!estimator_.hasLearnt(i) || !std::isfinite(mount.yaw)) continue;
    yaws[radars_[i]->name] = mount;
    learnt = true;
  }
  if (mount_yaws_file_.empty() || !learnt) return;
  try {
    writeMountYaws(mount_yaws_file_, yaws);
  } catch (const std::exception& defect) {
    NODELET_ERROR("%s: the mount yaws learnt are lost: %s", getName().c_str(), defect.what());
  }
}

std::string EgoVelocityNodelet::disabledBy() const {
  std::string disabled = "estimation disabled until the parameters are corrected";
  if (!server_ || !server_->usable()) return disabled;
  static const char* const scale =
      nameOf(config_, config_.extraction.doppler_scale);  // asked for every cloud
  return server_->refusedAtStart(scale) ? disabled + ": " + scale : "";
}

void EgoVelocityNodelet::apply(const EgoVelocityConfig& config) {
  // Everything that can throw comes first: what is refused changes nothing.
  std::vector<std::pair<Radar*, DopplerExtractor>> extractors;
  std::vector<RadarAgreement::Radar> compared;
  for (const std::unique_ptr<Radar>& radar : radars_) {
    const RadarEntry& entry = radar->input.entry();
    const ExtractionParams params = extractionOf(config, entry);
    compared.push_back({radar->name, entry.mount_yaw_correction, params.doppler_scale});
    if (!sameFields(radar->input.extraction(), params))
      extractors.emplace_back(radar.get(), DopplerExtractor(params));
  }
  std::optional<EgoVelocityEstimator> own_yaw_rate;
  if (rotation_source_) {
    EgoVelocityParams own = config.estimator;
    // A single radar cannot tell a turn from a sideslip.
    if (radars_.size() == 1 && own.model == MotionModel::kPlanarYaw) own.model = MotionModel::kAckermann;
    own_yaw_rate.emplace(own);
  }
  estimator_.configure(config);

  for (auto& [radar, extractor] : extractors) radar->input.setExtractor(std::move(extractor));
  agreement_.configure(std::move(compared));
  own_yaw_rate_ = std::move(own_yaw_rate);
  mounts_assessed_ = mounts_assessed_ && config.estimator.model == config_.estimator.model;
  mask_->configure(config);
  config_ = config;
}

void EgoVelocityNodelet::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  status.summaryf(DiagnosticStatus::OK, "%zu radars", radars_.size());
  if (!mount_advice_.empty()) status.mergeSummary(DiagnosticStatus::WARN, mount_advice_);
  if (const std::string reason = disabledBy(); !reason.empty())
    status.mergeSummary(DiagnosticStatus::ERROR, reason);
}

void EgoVelocityNodelet::onMessage(std::size_t index, const RadarMessage& message) {
  Radar& radar = *radars_[index];
  if (!radar.input.isOwn(message)) {
    radar.monitor.other(message.header.frame_id);
    return;
  }
  radar.monitor.arrived();
  if (!disabledBy().empty()) return;
  auto reading = std::make_shared<RadarReading>();
  radar.input.read(
      message, ros::Time::now(),
      [&](const std::string& frame, std::string& error) { return findMount(radar, frame, error); }, *reading);
  acceptStamp(radar.monitor, reading->header);
  if (!radar.monitor.scan(reading->header.frame_id, reading->counts, radar.input.lost())) {
    const RadarEntry names;
    warn(radar.name, "clouds of several frames on '" + radar.topic + "': radars that share a topic need " +
                         nameOf(names, names.only_frame));
  }
  lookForTwin(radar, *reading);
  const std::string description = reading->view.size() > 0 ? radar.input.description() : "";
  if (!description.empty() && radar.monitor.describe(description) && throttle_.allow(radar.name, "reads")) {
    NODELET_INFO("%s: radar %s on '%s': %s", getName().c_str(), radar.name.c_str(), radar.topic.c_str(),
                 description.c_str());
  }

  const ExtractionCounts& counts = reading->counts;
  // One point of NaN is how some radars say "nothing seen".
  if (counts.total > 1 &&
      static_cast<double>(counts.not_finite) > kMaxShareNotFinite * static_cast<double>(counts.total)) {
    warn(radar.name, std::to_string(counts.not_finite) + " of " + std::to_string(counts.total) +
                         " returns on '" + radar.topic + "' are not finite");
  }

  // Only later stamps reach this: the assembler neither rejects them nor resets.
  assembler_->add({index, reading->header.stamp.toSec(), reading}, completed_);
  for (const Sweep& sweep : completed_) processSweep(sweep);
  completed_.clear();
}

void EgoVelocityNodelet::clearHistory() {
  assembler_->reset();
  estimator_.reset();
  agreement_.reset();
  for (const std::unique_ptr<Radar>& radar : radars_) radar->range_rates.reset();
  if (rotation_source_) rotation_source_->reset();
  mask_->forget();
  estimator_monitor_->reset();
}

std::optional<Eigen::Isometry3d> EgoVelocityNodelet::findMount(Radar& radar, const std::string& frame,
                                                               std::string& error) {
  if (radar.T_base_from_sensor) {
    publishMount(radar, frame);
    return radar.mount = corrected(*radar.T_base_from_sensor, radar.input.entry());
  }
  std::string cause;
  const std::optional<Eigen::Isometry3d> mount = extrinsics_->lookup(frame, cause);
  if (!mount) {
    const RadarEntry names;
    cause +=
        fmt::format(" (TF, or {} and {})", nameOf(names, names.mount_xyz), nameOf(names, names.mount_rpy));
  }
  radar.monitor.mount(cause);
  if (mount) {
    mount_missing_since_.erase(frame);
    return radar.mount = corrected(*mount, radar.input.entry());
  }
  if (missingFor(frame) > kMountTimeout && throttle_.allow(radar.name, cause)) {
    NODELET_WARN("%s: the scans on '%s' are skipped: %s", getName().c_str(), radar.topic.c_str(),
                 cause.c_str());
  }
  error = cause;
  return std::nullopt;
}

double EgoVelocityNodelet::missingFor(const std::string& frame) {
  const ros::WallTime now = ProcessClock::now();
  if (mount_missing_since_.size() > kMaxMissingMounts) mount_missing_since_.clear();
  return (now - mount_missing_since_.try_emplace(frame, now).first->second).toSec();
}

void EgoVelocityNodelet::publishMount(Radar& radar, const std::string& frame) {
  if (radar.published_frame == frame || frame.empty()) return;
  std::string missing;
  if (const std::optional<Eigen::Isometry3d> known = extrinsics_->lookup(frame, missing)) {
    radar.published_frame = frame;
    if (!known->isApprox(*radar.T_base_from_sensor, 1e-3))
      warn(radar.name,
           "the mount of '" + frame + "' on TF is not that of the parameters, which is used here");
    return;
  }
  // TF may have it from elsewhere in a moment.
  if (missingFor(frame) < kMountTimeout) return;
  radar.published_frame = frame;
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = ros::Time::now();
  transform.header.frame_id = extrinsics_->baseFrame();
  transform.child_frame_id = withoutSlash(frame);
  transform.transform = transformOf(*radar.T_base_from_sensor);
  mount_broadcaster_->sendTransform(transform);
}

void EgoVelocityNodelet::assessMountsOnce() {
  if (mounts_assessed_ || config_.rotation.source != RotationSourceKind::kRadar) return;
  std::vector<Eigen::Isometry3d> mounts;
  for (const std::unique_ptr<Radar>& radar : radars_)
    if (radar->mount) mounts.push_back(*radar->mount);
  // Radars that stay silent are no reason to wait forever: those at hand are assessed after a second.
  if (mounts.size() < radars_.size() && sweeps_ < kSweepsBeforeAssessment) return;
  mounts_assessed_ = true;
  mount_advice_ = assessMounts(mounts, config_.estimator).advice;
  if (!mount_advice_.empty()) NODELET_WARN("%s: %s", getName().c_str(), mount_advice_.c_str());
}

void EgoVelocityNodelet::processSweep(const Sweep& sweep) {
  std::vector<RadarScan> scans;
  Readings readings;
  std::string mount_error;
  for (const Assembler::Scan& scan : sweep.scans) {
    Radar& radar = *radars_[scan.radar];
    radar.monitor.used();
    const auto mount = findMount(radar, scan.reading->header.frame_id, mount_error);
    if (!mount) continue;
    scans.push_back({scan.reading->returns, *mount, scan.time, scan.radar});
    scans.back().unambiguous_velocity = unambiguousVelocityOf(radar.input.entry(), radar.input.extraction());
    mask_->mark(scans.back());
    readings.push_back(scan.reading);
  }
  ++sweeps_;
  assessMountsOnce();

  const ros::Time stamp = sweep.scans[sweep.newest].reading->header.stamp;
  const std::optional<AngularVelocity> rotation =
      rotation_source_ ? rotation_source_->rateAt(stamp) : std::nullopt;
  const ros::WallTime start = ProcessClock::now();
  const SweepEstimate estimate = estimator_.estimate(scans, sweep.time(), rotation);
  const double computation_time = (ProcessClock::now() - start).toSec();
  const EgoVelocityResult& result = estimate.single;
  estimator_monitor_->estimate(stamp, ros::Time::now(), result, computation_time);
  compare(sweep, scans, result, rotation);

  std::string reason = result.reason;
  if (!result.valid() && !mount_error.empty()) reason += "; " + mount_error;
  publishStatus(stamp, result, readings, reason, computation_time);
  if (!result.valid()) {
    if (throttle_.allow("estimate", "refused"))
      NODELET_WARN("%s: no estimate: %s", getName().c_str(), reason.c_str());
    return;
  }
  if (!estimate.assumption.empty()) warn("estimate", estimate.assumption);
  if (result.observed[0]) mask_->add({sweep.time(), result.linear, result.angular});
  publishTwist(stamp, estimate);
  publishClouds(readings, scans, result);
}

void EgoVelocityNodelet::compare(const Sweep& sweep, const std::vector<RadarScan>& scans,
                                 const EgoVelocityResult& result,
                                 const std::optional<AngularVelocity>& rotation) {
  agreement_.add(sweep.time(), scans, result, estimator_.params());
  for (std::size_t i = 0; i < radars_.size(); ++i) {
    const RadarAgreement::Figures& figures = agreement_.figures(i);
    const MountYaw mount = estimator_.mountYaw(i);
    radars_[i]->monitor.agreement(figures, assembler_->losses()[i], mount.yaw, mount.std);
    if (!figures.warning.empty()) warn(radars_[i]->name, figures.warning);
  }
  for (const RadarScan& scan : scans) {
    Radar& radar = *radars_[scan.radar];
    radar.range_rates.add(scan.time, scan.returns, scan.T_base_from_sensor);
    const std::string error = radar.range_rates.warning(radar.input.dopplerSource());
    radar.monitor.rangeRates(error);
    if (!error.empty()) warn(radar.name, radar.name + ": " + error);
  }
  std::vector<std::string> warnings = {agreement_.warning()};
  if (ProcessClock::now() < twins_until_) warnings.push_back(twins_);
  bool no_range_rates = false;
  if (rotation_source_) {
    compareWithSource(sweep.time(), scans, result, rotation.has_value());
    if (!rotation) {
      warnings.push_back("no angular velocity at the time of a sweep from " + rotation_source_->describe());
    }
    warnings.push_back(rotation_source_->contradiction("the motion by the radars",
                                                       "the range rates (" + dopplerSources() + ")"));
    no_range_rates = rotation_source_->contradictsSpeed();
  }
  std::string warning;
  for (const std::string& one : warnings) warning += (warning.empty() || one.empty() ? "" : "; ") + one;
  if (!warning.empty()) warn("agreement", warning);
  estimator_monitor_->warn(std::move(warning), no_range_rates);
}

void EgoVelocityNodelet::compareWithSource(double time, const std::vector<RadarScan>& scans,
                                           const EgoVelocityResult& result, bool has_rotation) {
  rotation_source_->expireComparisons(time);
  if (!result.valid()) return;
  if (result.observed[0]) rotation_source_->compareSpeed(time, result.linear.x());
  if (!has_rotation || sweeps_ % kComparisonInterval != 0) return;
  const EgoVelocityResult own = own_yaw_rate_->estimate(scans, time, estimator_.acceleration(time));
  if (own.valid() && own.observed[5])
    rotation_source_->compareRate(time, own.angular.z(), own.covariance(5, 5));
}

std::string EgoVelocityNodelet::dopplerSources() const {
  std::map<std::string, std::vector<std::string>> radars;
  for (const std::unique_ptr<Radar>& radar : radars_)
    if (!radar->input.dopplerSource().empty()) radars[radar->input.dopplerSource()].push_back(radar->name);
  std::vector<std::string> texts;
  for (const auto& [source, names] : radars)
    texts.push_back(fmt::format("{} of {}", source, fmt::join(names, ", ")));
  return fmt::format("{}", fmt::join(texts, "; "));
}

void EgoVelocityNodelet::publishTwist(const ros::Time& stamp, const SweepEstimate& estimate) {
  raw_twist_publisher_.publish(twistMessage(stamp, extrinsics_->baseFrame(), estimate.single));
  if (const std::optional<EgoVelocityResult> output = estimate.output())
    twist_publisher_.publish(twistMessage(stamp, extrinsics_->baseFrame(), *output));
  if (estimate.filtered && estimate.filtered->was_reset && throttle_.allow("filter", "reset")) {
    NODELET_WARN(
        "%s: velocity filter reset: gap in the input, repeated estimates outside its gate, or a source of "
        "rotation that came or went",
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

void EgoVelocityNodelet::publishClouds(const Readings& readings, const std::vector<RadarScan>& scans,
                                       const EgoVelocityResult& result) {
  const auto publish = [&](const ros::Publisher& publisher, ReturnLabel wanted) {
    if (publisher.getNumSubscribers() == 0) return;
    for (std::size_t i = 0; i < readings.size(); ++i) {
      const RadarReading& reading = *readings[i];
      sensor_msgs::PointCloud2 cloud = labelledCloud(*reading.cloud, reading.view, scans[i].returns,
                                                     result.residuals.data() + result.offsets[i],
                                                     result.labels.data() + result.offsets[i], wanted);
      cloud.header = reading.header;
      publisher.publish(cloud);
    }
  };
  publish(static_publisher_, ReturnLabel::kStatic);
  publish(dynamic_publisher_, ReturnLabel::kDynamic);
}

}  // namespace radar_dot

PLUGINLIB_EXPORT_CLASS(radar_dot::EgoVelocityNodelet, nodelet::Nodelet)
