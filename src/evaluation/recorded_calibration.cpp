// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "evaluation/recorded_calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "evaluation/recorded_motion.h"
#include "evaluation/recorded_transforms.h"
#include "nodelets/inputs/extrinsics.h"
#include "nodelets/inputs/radar_input.h"

namespace radar_dot::evaluation {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kMaxGap = 1.0;             // s between two scans of a drive
constexpr double kReferenceInterval = 0.1;  // s, over which the reference is averaged
constexpr int kSamples = 10;                // in it

class RecordedRadar {
 public:
  RecordedRadar(const std::string& name, const EgoVelocityConfig& config, const bag::BagInput& input,
                const Transforms& transforms)
      : name_(name),
        place_("radars/" + name),
        base_(withoutSlash(config.base_frame)),
        transforms_(transforms),
        entry_(withPreset(config.radars.at(name))),
        input_(entry_) {
    std::vector<std::string> types;
    for (const auto& [topic, type] : input.topics())
      if (RadarMessage::takes(type)) types.push_back(type);
    if (types.empty()) types = {"sensor_msgs/PointCloud2"};
    std::sort(types.begin(), types.end());
    types.erase(std::unique(types.begin(), types.end()), types.end());
    topic_ = checkedTopic(input, place_ + "/topic", entry_.topic, types);
    const ExtractionParams extraction = extractionOf(config, entry_);
    input_.setExtractor(DopplerExtractor(extraction));
    ambiguity_ = unambiguousVelocityOf(entry_, extraction);
  }

  const std::string& topic() const { return topic_; }

  void add(const rosbag::MessageInstance& instance) {
    RadarMessage message;
    message.setType(instance.getDataType(), instance.getMD5Sum());
    std::vector<std::uint8_t> data(instance.size());
    ros::serialization::OStream stream(data.data(), instance.size());
    instance.write(stream);
    try {
      message.read(data.data(), instance.size());
      if (!input_.isOwn(message)) return;
      ++messages_;
      RadarReading reading;
      input_.read(
          message, instance.getTime(),
          [this](const std::string& frame, std::string& error) { return findMount(frame, error); }, reading);
      if (reading.view.size() == 0) return;
      frame_ = frame_.empty() ? reading.header.frame_id : frame_;
      if (reading.header.frame_id != frame_)
        throw std::invalid_argument(
            fmt::format("it is in the frame '{}', others are in '{}': radars that "
                        "share a topic need only_frame",
                        reading.header.frame_id, frame_));
      scans_.push_back({0, reading.header.stamp.toSec(), std::move(reading.returns)});
    } catch (const std::exception& error) {  // what the nodelet leaves out, with a warning
      ++left_out_;
      defect_ = error.what();
    }
  }

  /// @throws std::runtime_error where there is nothing to use, or no mount
  void moveTo(CalibrationData& data, std::vector<CalibrationScan>& scans,
              const std::function<void(const std::string&)>& warn) {
    if (scans_.empty())
      throw std::runtime_error(fmt::format("{}: {}", place_,
                                           left_out_ > 0   ? topic_ + ": " + defect_
                                           : messages_ > 0 ? "no return in the clouds on " + topic_
                                                           : "no message on " + topic_ + " is its own"));
    if (left_out_ > 0)
      warn(fmt::format("{}: {} of {} messages on {} are left out, such as: {}", place_, left_out_, messages_,
                       topic_, defect_));
    if (std::isfinite(ambiguity_))
      warn(fmt::format("{}: range rates are not unwrapped here: the drive must be slower than {:.1f} m/s",
                       place_, ambiguity_));
    std::string missing;
    const std::optional<Eigen::Isometry3d> mount = findMount(frame_, missing);
    if (!mount) throw std::runtime_error(place_ + ": " + missing);
    data.radars.push_back({name_, *mount});
    data.entries.push_back(entry_);
    data.entry_names.push_back(name_);
    data.frames.push_back(withoutSlash(frame_));
    for (CalibrationScan& scan : scans_) {
      scan.radar = data.radars.size() - 1;
      scans.push_back(std::move(scan));
    }
  }

 private:
  std::optional<Eigen::Isometry3d> findMount(const std::string& frame, std::string& error) const {
    std::optional<Eigen::Isometry3d> mount = mountOf(entry_);
    if (!mount) mount = transforms_.between(base_, withoutSlash(frame));
    if (mount) return corrected(*mount, entry_);
    error = transforms_.missing(base_, withoutSlash(frame)) + "; or set mount_xyz and mount_rpy";
    return std::nullopt;
  }

  std::string name_, place_, base_, topic_, frame_, defect_;
  const Transforms& transforms_;
  RadarEntry entry_;
  RadarInput input_;
  double ambiguity_ = 0.0;
  std::size_t messages_ = 0, left_out_ = 0;
  std::vector<CalibrationScan> scans_;
};

/// Means of short stretches.
std::vector<ReferenceReading> readingsOf(const ReferenceMotion& reference, double begin, double end) {
  std::vector<ReferenceReading> readings;
  for (double time = begin; time < end; time += kReferenceInterval) {
    ReferenceReading reading;
    reading.velocity.setZero();
    for (int i = 0; i < kSamples; ++i) {
      const double at = time + kReferenceInterval * i / kSamples;
      const std::optional<StampedTwist> twist = reference.at(at);
      reading.time += at / kSamples;
      const auto add = [&](Eigen::Index axis, Eigen::Index of_twist, double value) {
        reading.velocity[axis] += twist && twist->observes(of_twist) ? value / kSamples : kNaN;
      };
      const StampedTwist known = twist.value_or(StampedTwist());
      add(0, 0, known.linear.x());
      add(1, 1, known.linear.y());
      add(2, 5, known.angular.z());
    }
    readings.push_back(reading);
  }
  return readings;
}

struct Reference {
  std::string name;
  ReferenceMotion motion;
  bool tells_rate;
};

void addReference(const Reference& reference, std::vector<CalibrationDrive>& drives) {
  std::vector<std::vector<ReferenceReading>> readings;
  Eigen::Array3d largest = Eigen::Array3d::Zero();
  for (const CalibrationDrive& drive : drives) {
    readings.push_back(readingsOf(reference.motion, drive.scans.front().time, drive.scans.back().time));
    for (const ReferenceReading& reading : readings.back())
      largest = reading.velocity.isNaN().select(largest, largest.max(reading.velocity.abs()));
  }
  if (!reference.tells_rate) largest[2] = 0.0;
  if ((largest == 0.0).all())
    throw InvalidParameter(
        {"reference"}, fmt::format("reference: {} tells no motion while the radars see any", reference.name));
  for (std::size_t i = 0; i < drives.size(); ++i) {
    for (ReferenceReading& reading : readings[i]) {
      reading.velocity = (largest == 0.0).select(kNaN, reading.velocity);
      drives[i].reference.push_back(reading);
    }
  }
}

/// @param data  gets rate_has_bias
std::vector<Reference> referencesOf(const bag::BagInput& input, std::vector<std::string> names,
                                    const std::string& base, const Transforms& transforms,
                                    const std::function<void(const std::string&)>& warn,
                                    CalibrationData& data) {
  if (names == std::vector<std::string>{"none"}) return {};
  if (names.empty()) names = {""};  // which tells what topics there are
  const auto isImu = [&](const std::string& topic) {
    const auto found = input.topics().find("/" + withoutSlash(topic));
    return found != input.topics().end() && found->second == kImuType;
  };
  data.rate_has_bias = std::any_of(names.begin(), names.end(), isImu);
  std::vector<Reference> references;
  for (const std::string& name : names) {
    const RecordedMotion motion = recordedReference(input, name, base, transforms, warn);
    references.push_back({name, ReferenceMotion(motion, {}), !data.rate_has_bias || isImu(name)});
  }
  return references;
}

std::vector<CalibrationDrive> drivesOf(std::vector<CalibrationScan> scans) {
  std::stable_sort(scans.begin(), scans.end(),
                   [](const CalibrationScan& a, const CalibrationScan& b) { return a.time < b.time; });
  std::vector<CalibrationDrive> drives;
  for (CalibrationScan& scan : scans) {
    if (drives.empty() || scan.time - drives.back().scans.back().time > kMaxGap) drives.emplace_back();
    drives.back().scans.push_back(std::move(scan));
  }
  return drives;
}

}  // namespace

CalibrationData recordedCalibrationData(const bag::BagInput& input, const EgoVelocityConfig& config,
                                        const std::vector<std::string>& references, const std::string& tf,
                                        const std::function<void(const std::string&)>& warn,
                                        const std::function<void(double)>& progress) {
  if (config.radars.empty())
    throw std::runtime_error(
        "no radars: --config FILE tells them, ego_velocity: {radars: {front: {topic: ...}}}");
  Transforms transforms;
  std::vector<RecordedRadar> radars;
  std::vector<std::string> topics;
  for (const auto& [name, entry] : config.radars) {
    radars.emplace_back(name, config, input, transforms);
    topics.push_back(radars.back().topic());
  }
  if (!tf.empty()) transforms.addFile(tf);
  // Mounts hold for all of the recording, whenever they were sent.
  input.read({"/tf", "/tf_static"}, [&](const rosbag::MessageInstance& message) { transforms.add(message); });
  CalibrationData data;
  const std::vector<Reference> known =
      referencesOf(input, references, withoutSlash(config.base_frame), transforms, warn, data);
  input.read(
      topics,
      [&](const rosbag::MessageInstance& message) {
        for (RecordedRadar& radar : radars)
          if (radar.topic() == message.getTopic()) radar.add(message);
      },
      progress);
  std::vector<CalibrationScan> scans;
  for (RecordedRadar& radar : radars) radar.moveTo(data, scans, warn);
  data.drives = drivesOf(std::move(scans));
  for (const Reference& reference : known) addReference(reference, data.drives);

  return data;
}

}  // namespace radar_dot::evaluation
