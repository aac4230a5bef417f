// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "recorded_motion.h"

#include <fmt/format.h>
#include <geometry_msgs/TwistStamped.h>
#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>
#include <sensor_msgs/Imu.h>
#include <sensor_msgs/NavSatFix.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <set>
#include <stdexcept>
#include <vector>

#include "common/transform_messages.h"
#include "recorded_objects.h"

namespace radar_dot::evaluation {
namespace {

constexpr char kTwist[] = "geometry_msgs/TwistStamped", kOdometry[] = "nav_msgs/Odometry",
               kTwistCovariance[] = "geometry_msgs/TwistWithCovarianceStamped",
               kFix[] = "sensor_msgs/NavSatFix", kImage[] = "sensor_msgs/Image",
               kCompressed[] = "sensor_msgs/CompressedImage", kCloud[] = "sensor_msgs/PointCloud2",
               kObjects[] = "radar_dot/MovingObjects", kBoxes[] = "visualization_msgs/MarkerArray";
constexpr char kTfPrefix[] = "tf:";

Eigen::Vector3d vectorOf(const geometry_msgs::Vector3& v) { return {v.x, v.y, v.z}; }

/// What arrived on one topic, in the frame of the source.
struct Stream {
  std::string topic, frame;
  std::string fixed_frame;  // of the poses; empty: it has none of a name
  RecordedMotion motion;
  std::vector<std::pair<double, Eigen::Vector3d>> fixes;  // latitude, longitude rad, height m
  std::set<std::string> frames;

  double timeOf(const std_msgs::Header& header, const rosbag::MessageInstance& message) {
    ++motion.counts.messages;
    if (!header.stamp.isZero()) return header.stamp.toSec();
    ++motion.counts.zero_stamps;
    return message.getTime().toSec();
  }

  void addTwist(double time, const geometry_msgs::Twist& twist, const boost::array<double, 36>* covariance) {
    StampedTwist sample;
    sample.time = time;
    sample.linear = vectorOf(twist.linear);
    sample.angular = vectorOf(twist.angular);
    if (covariance != nullptr)
      sample.covariance = Eigen::Map<const Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(covariance->data());
    if (!sample.linear.allFinite() || !sample.angular.allFinite() || !sample.covariance.allFinite()) {
      ++motion.counts.not_finite;
      return;
    }
    motion.twists.push_back(sample);
  }

  void add(const rosbag::MessageInstance& message) {
    const std::string& type = message.getDataType();
    if (type == kOdometry) {
      const auto odometry = message.instantiate<nav_msgs::Odometry>();
      const double time = timeOf(odometry->header, message);
      frames.insert(withoutSlash(odometry->child_frame_id));
      fixed_frame = withoutSlash(odometry->header.frame_id);
      const geometry_msgs::Pose& pose = odometry->pose.pose;
      const Eigen::Vector3d position(pose.position.x, pose.position.y, pose.position.z);
      const geometry_msgs::Quaternion& q = pose.orientation;
      const Eigen::Vector4d quaternion(q.w, q.x, q.y, q.z);
      if (!position.allFinite() || !quaternion.allFinite() || quaternion.norm() < 0.5) {
        ++motion.counts.not_finite;
        return;
      }
      motion.poses.emplace_back(time, isometryOf(pose));
      addTwist(time, odometry->twist.twist, &odometry->twist.covariance);
    } else if (type == kTwistCovariance) {
      const auto twist = message.instantiate<geometry_msgs::TwistWithCovarianceStamped>();
      frames.insert(withoutSlash(twist->header.frame_id));
      addTwist(timeOf(twist->header, message), twist->twist.twist, &twist->twist.covariance);
    } else if (type == kTwist) {
      const auto twist = message.instantiate<geometry_msgs::TwistStamped>();
      frames.insert(withoutSlash(twist->header.frame_id));
      addTwist(timeOf(twist->header, message), twist->twist, nullptr);
    } else if (type == kImuType) {
      addImu(*message.instantiate<sensor_msgs::Imu>(), message);
    } else {
      addFix(*message.instantiate<sensor_msgs::NavSatFix>(), message);
    }
  }

  void addImu(const sensor_msgs::Imu& imu, const rosbag::MessageInstance& message) {
    const double time = timeOf(imu.header, message);
    frames.insert(withoutSlash(imu.header.frame_id));
    geometry_msgs::Twist twist;
    twist.angular = imu.angular_velocity;
    boost::array<double, 36> covariance{};
    for (std::size_t axis = 0; axis < 3; ++axis) covariance[7 * axis] = 10.0 * kUnobservedVariance;
    // -1 is how it says "not measured".
    if (imu.angular_velocity_covariance[0] == -1.0)
      ++motion.counts.not_finite;
    else
      addTwist(time, twist, &covariance);
  }

  void addFix(const sensor_msgs::NavSatFix& fix, const rosbag::MessageInstance& message) {
    constexpr double kDegree = M_PI / 180.0;
    const double time = timeOf(fix.header, message);
    frames.insert(withoutSlash(fix.header.frame_id));
    const Eigen::Vector3d place(fix.latitude * kDegree, fix.longitude * kDegree,
                                std::isfinite(fix.altitude) ? fix.altitude : 0.0);
    if (fix.status.status < sensor_msgs::NavSatStatus::STATUS_FIX) {
      ++motion.counts.no_fix;
    } else if (!place.allFinite()) {
      ++motion.counts.not_finite;
    } else {
      fixes.emplace_back(time, place);
    }
  }
};

/// East, north and up of fixes from the first one: by the radii of curvature of WGS 84 there, which is exact
/// to 1e-4 of the distance over some kilometres.
std::vector<StampedPose> localPoses(const std::vector<std::pair<double, Eigen::Vector3d>>& fixes) {
  constexpr double kMajor = 6378137.0, kEccentricity = 6.69437999014e-3;  // m; squared
  std::vector<StampedPose> poses;
  for (const auto& [time, place] : fixes) {
    const Eigen::Vector3d& origin = fixes.front().second;
    const double s = std::sin(origin.x());
    const double normal = kMajor / std::sqrt(1.0 - kEccentricity * s * s);
    const double meridian = normal * (1.0 - kEccentricity) / (1.0 - kEccentricity * s * s);
    const Eigen::Vector3d d = place - origin;
    StampedPose pose;
    pose.time = time;
    pose.position = {(normal + origin.z()) * std::cos(origin.x()) * std::remainder(d.y(), 2.0 * M_PI),
                     (meridian + origin.z()) * d.x(), d.z()};
    poses.push_back(pose);
  }
  return poses;
}

/// Speed and course of pairs of fixes at least `interval` (s) apart, as twists at their middle, and the
/// course as the heading of the poses. A vehicle that hardly moves has no course.
void addCourse(RecordedMotion& motion, double interval) {
  constexpr double kMinSpeed = 1.0;  // m/s
  std::vector<StampedPose>& poses = motion.poses;
  std::vector<double> courses;
  for (std::size_t from = 0, to = 0; from < poses.size(); ++from) {
    while (to < poses.size() && poses[to].time - poses[from].time < interval - 1e-6) ++to;
    if (to == poses.size()) break;
    const double duration = poses[to].time - poses[from].time;
    const Eigen::Vector2d velocity = (poses[to].position - poses[from].position).head<2>() / duration;
    StampedTwist twist;
    twist.time = poses[from].time + 0.5 * duration;
    twist.linear.x() = velocity.norm();
    const bool has_course = velocity.norm() >= kMinSpeed;
    courses.push_back(has_course        ? std::atan2(velocity.y(), velocity.x())
                      : courses.empty() ? 0.0
                                        : courses.back());
    twist.covariance(1, 1) = kUnobservedVariance;
    twist.covariance(5, 5) = has_course ? 0.0 : kUnobservedVariance;
    motion.twists.push_back(twist);
  }
  std::vector<StampedTwist>& twists = motion.twists;
  for (std::size_t i = 0; i < twists.size(); ++i) {
    const std::size_t before = i > 0 ? i - 1 : i, after = std::min(i + 1, twists.size() - 1);
    if (before == after) twists[i].covariance(5, 5) = kUnobservedVariance;
    if (before == after || !twists[before].observes(5) || !twists[after].observes(5)) continue;
    twists[i].angular.z() = std::remainder(courses[after] - courses[before], 2.0 * M_PI) /
                            (twists[after].time - twists[before].time);
  }
  std::size_t nearest = 0;
  for (StampedPose& pose : poses) {
    if (twists.empty()) break;
    while (nearest + 1 < twists.size() &&
           std::abs(twists[nearest + 1].time - pose.time) <= std::abs(twists[nearest].time - pose.time))
      ++nearest;
    const double course = courses[nearest] + (pose.time - twists[nearest].time) * twists[nearest].angular.z();
    pose.rotation = Eigen::AngleAxisd(course, Eigen::Vector3d::UnitZ());
  }
}

/// Brings the motion of a frame to that of the base, which is fixed to it.
void moveToBase(RecordedMotion& motion, const Eigen::Isometry3d& T_base_from_frame) {
  const Eigen::Matrix3d R = T_base_from_frame.linear();
  Eigen::Matrix<double, 6, 6> turn = Eigen::Matrix<double, 6, 6>::Zero();
  turn.topLeftCorner<3, 3>() = R;
  turn.bottomRightCorner<3, 3>() = R;
  // v_base = v_frame - w x t
  const Eigen::Vector3d t = T_base_from_frame.translation();
  Eigen::Matrix3d lever;
  lever << 0.0, -t.z(), t.y(), t.z(), 0.0, -t.x(), -t.y(), t.x(), 0.0;
  turn.topRightCorner<3, 3>() = lever * R;
  for (StampedTwist& twist : motion.twists) {
    twist = onWheels(twist);
    for (const Eigen::Index vertical : {2, 3, 4}) {
      twist.covariance.row(vertical).setZero();
      twist.covariance.col(vertical).setZero();
    }
    twist.covariance = (turn * twist.covariance * turn.transpose()).eval();
    twist.angular = R * twist.angular;
    twist.linear = R * twist.linear - twist.angular.cross(t);
  }
  for (StampedPose& pose : motion.poses)
    pose = StampedPose(pose.time, pose.isometry() * T_base_from_frame.inverse());
}

/// The topic of an option. @throws InvalidParameter where it is not there or of no such type
std::string checkedTopic(const bag::BagInput& input, const RecordingOptions& options,
                         const std::string& topic, const std::vector<std::string>& types) {
  return evaluation::checkedTopic(input, fieldsOf(options).of(&topic).name, topic, types);
}

/// Frames of tf:FIXED:FRAME; none for a topic.
std::optional<std::pair<std::string, std::string>> framesOf(const RecordingOptions& options) {
  const std::string& text = options.reference;
  if (text.rfind(kTfPrefix, 0) != 0) return std::nullopt;
  const std::size_t begin = std::string(kTfPrefix).size(), colon = text.find(':', begin);
  const std::string fixed = withoutSlash(text.substr(begin, colon - begin));
  const std::string frame = colon == std::string::npos ? "" : withoutSlash(text.substr(colon + 1));
  if (fixed.empty() || frame.empty())
    throw InvalidParameter({"reference"}, "reference: '" + text + "' is not tf:FIXED_FRAME:FRAME");
  return std::make_pair(fixed, frame);
}

/// Makes transforms the reference.
void takePoses(const Transforms& transforms, const std::pair<std::string, std::string>& frames,
               Stream& reference) {
  transforms.addPoses(frames.first, frames.second, reference.motion);
  reference.fixed_frame = frames.first;
  reference.frames = {frames.second};
  if (reference.motion.poses.size() > 1) return;
  throw InvalidParameter(
      {"reference"}, fmt::format("reference: the transforms of the recording do not tell {}; they are: {}",
                                 reference.topic, transforms.text()));
}

/// Topics that are there by default are no must.
bool isWanted(const bag::BagInput& input, const std::string& topic, const std::string& by_default) {
  return !topic.empty() && (topic != by_default || input.topics().count(topic) > 0);
}

/// See RecordedObjects. @param missing  why there are none
std::vector<std::string> objectTopics(const bag::BagInput& input, const RecordingOptions& options,
                                      const std::function<void(const std::string&)>& warn,
                                      std::string& missing) {
  const RecordingOptions defaults;
  if (options.objects.empty() || options.object_truth.empty()) return {};
  if (!isWanted(input, options.objects, defaults.objects)) missing = options.objects;
  if (!isWanted(input, options.object_truth, defaults.object_truth))
    missing += (missing.empty() ? "" : " and no ") + options.object_truth;
  if (!missing.empty()) {
    missing = "the recording has no " + missing;
    return {};
  }
  std::vector<std::string> topics = {checkedTopic(input, options, options.objects, {kObjects}),
                                     checkedTopic(input, options, options.object_truth, {kBoxes})};
  if (isWanted(input, options.static_returns, defaults.static_returns) &&
      isWanted(input, options.dynamic_returns, defaults.dynamic_returns)) {
    topics.push_back(checkedTopic(input, options, options.static_returns, {kCloud}));
    topics.push_back(checkedTopic(input, options, options.dynamic_returns, {kCloud}));
  } else {
    warn(fmt::format("without {} and {} all movers count as seen by a radar", defaults.static_returns,
                     defaults.dynamic_returns));
  }
  return topics;
}

/// In the frame of the poses of the reference.
void compareObjects(RecordedObjects& objects, const Stream& reference, const Stream& odometry,
                    const std::string& base, const Transforms& transforms, const ObjectMatching& matching,
                    MotionReport& report) {
  if (reference.motion.poses.size() < 2 || reference.fixed_frame != objects.frame()) {
    report.objects_missing =
        fmt::format("{} has no poses in '{}', the frame of the boxes", reference.topic, objects.frame());
    return;
  }
  std::optional<PoseTrack> path;
  if (odometry.motion.poses.size() > 1) path.emplace(odometry.motion.poses);
  const auto T_base_from = [&](const std::string& frame, double time) -> std::optional<Eigen::Isometry3d> {
    if (frame == base) return Eigen::Isometry3d::Identity();
    if (!path || frame != odometry.fixed_frame) return transforms.between(base, frame, ros::Time(time));
    if (!path->covers(time)) return std::nullopt;
    return path->at(time).inverse();
  };
  objects.compare(PoseTrack(reference.motion.poses), T_base_from, report.applied_offset, matching, report);
}

/// Masks with the truth of the same stamp.
class MaskComparison {
 public:
  void addMask(const sensor_msgs::Image& message) {
    if (message.encoding != "mono8" && message.encoding != "8UC1")
      throw std::runtime_error("masks: the encoding is " + message.encoding + ", not mono8");
    if (message.step < message.width || message.data.size() < std::size_t{message.step} * message.height)
      throw std::runtime_error("masks: an image is cut short");
    const cv::Mat image(static_cast<int>(message.height), static_cast<int>(message.width), CV_8UC1,
                        const_cast<std::uint8_t*>(message.data.data()), message.step);
    add(message.header.stamp, image, masks_, truths_, false);
  }
  void addTruth(const sensor_msgs::CompressedImage& message) {
    const cv::Mat image = cv::imdecode(message.data, cv::IMREAD_GRAYSCALE);
    if (image.empty()) throw std::runtime_error("mask_truth: an image cannot be decoded");
    add(message.header.stamp, image, truths_, masks_, true);
  }
  std::uint64_t masks() const { return count_; }
  const SegmentationReport& report() const { return report_; }

 private:
  using Images = std::map<ros::Time, cv::Mat>;
  void add(const ros::Time& stamp, const cv::Mat& image, Images& own, Images& others, bool is_truth) {
    if (!is_truth) ++count_;
    const auto other = others.find(stamp);
    if (other == others.end()) {
      own[stamp] = image.clone();
      // A partner that is that much later does not come any more.
      constexpr std::size_t kKept = 100;
      if (own.size() > kKept) own.erase(own.begin());
      return;
    }
    const cv::Mat& mask = is_truth ? other->second : image;
    const cv::Mat& truth = is_truth ? image : other->second;
    if (mask.size() != truth.size())
      throw std::runtime_error(fmt::format("masks of {} x {} px and truth of {} x {} px do not go together",
                                           mask.cols, mask.rows, truth.cols, truth.rows));
    for (int row = 0; row < mask.rows; ++row)
      for (int column = 0; column < mask.cols; ++column)
        report_.pixels.add(mask.at<std::uint8_t>(row, column) != 0, truth.at<std::uint8_t>(row, column) != 0);
    ++report_.frames;
    others.erase(other);
  }

  Images masks_, truths_;
  std::uint64_t count_ = 0;
  SegmentationReport report_;
};

/// Names the frame of a stream, or says what is doubtful.
void setFrame(Stream& stream, const std::string& wanted,
              const std::function<void(const std::string&)>& warn) {
  stream.frames.erase("");
  stream.frame = withoutSlash(wanted);
  if (!wanted.empty()) return;
  if (!stream.frames.empty()) stream.frame = *stream.frames.begin();
  if (stream.frames.size() > 1)
    warn(fmt::format("{} has several frames; took {}", stream.topic, stream.frame));
}

/// Brings a stream to the base frame.
void bringToBase(Stream& stream, const std::string& base, const Transforms& transforms,
                 const std::function<void(const std::string&)>& warn) {
  if (stream.frame == base && !base.empty()) return;
  std::optional<Eigen::Isometry3d> T_base_from_frame;
  if (!stream.frame.empty() && !base.empty()) T_base_from_frame = transforms.between(base, stream.frame);
  if (!T_base_from_frame) {
    warn(fmt::format(
        "where the frame of {} ('{}') lies in the base frame ('{}') is not known; took it for the same",
        stream.topic, stream.frame, base));
    return;
  }
  if (!stream.fixes.empty()) T_base_from_frame->linear().setIdentity();  // an antenna has no axes
  moveToBase(stream.motion, *T_base_from_frame);
}

/// Brings all to the order of time and to the frame of the estimate.
void prepare(Stream& twist, Stream& odometry, Stream& reference, const RecordingOptions& options,
             const Transforms& transforms, const std::function<void(const std::string&)>& warn) {
  if (!reference.fixes.empty()) {
    reference.motion.poses = localPoses(reference.fixes);
    reference.motion.putInOrder();
    addCourse(reference.motion, options.comparison.interval);
  }
  setFrame(twist, options.estimate_frame, warn);
  setFrame(odometry, "", warn);
  setFrame(reference, options.reference_frame, warn);
  for (Stream* stream : {&twist, &odometry, &reference}) {
    if (stream->topic.empty()) continue;
    const StreamCounts before = stream->motion.counts;
    stream->motion.putInOrder();
    if (!stream->fixes.empty()) {
      stream->motion.counts.unordered = before.unordered;
      stream->motion.counts.repeated = before.repeated;
    }
    if (stream != &twist) bringToBase(*stream, twist.frame, transforms, warn);
  }
}

}  // namespace

void RecordingOptions::describe(FieldList& fields) {
  fields.group("Topics");
  fields.add("twist", twist, "Estimated velocity: TwistWithCovarianceStamped, TwistStamped or Odometry");
  fields.add("odometry", odometry, "Estimated path: Odometry; empty: none");
  fields.add("reference", reference,
             "Odometry, TwistStamped, TwistWithCovarianceStamped or NavSatFix; or tf:FIXED_FRAME:FRAME");
  fields.add("estimate_frame", estimate_frame, "Frame of the estimated velocity; empty: as its messages say");
  fields.add("reference_frame", reference_frame, "Frame of the reference; empty: as its messages say");
  fields.add("keyframes", keyframes,
             "Compare velocities once between every two messages of this topic, at their middle, and with "
             "the poses at both for reference_velocity pose, e.g. "
             "/ground_truth/boxes; empty: at every estimate");
  fields.add("masks", masks, "Estimated masks: Image; empty: none");
  fields.add("mask_truth", mask_truth, "True masks: CompressedImage");
  fields.add("objects", objects, "Tracked objects: MovingObjects; empty: none");
  fields.add("object_truth", object_truth, "True boxes: MarkerArray of nuscenes_to_bag");
  fields.add("static_returns", static_returns, "Returns that tell which movers the radars saw: PointCloud2");
  fields.add("dynamic_returns", dynamic_returns, "The same of those that move: PointCloud2");
  fields.group("Objects");
  matching.describe(fields);
  comparison.describe(fields);
}

MotionReport evaluateRecording(const bag::BagInput& input, const RecordingOptions& options,
                               const std::function<void(const std::string&)>& warn,
                               const std::function<void(double)>& progress) {
  validateFields(options);
  const RecordingOptions defaults;
  Stream twist, odometry, reference;
  twist.topic = checkedTopic(input, options, options.twist, {kTwistCovariance, kTwist, kOdometry});
  if (isWanted(input, options.odometry, defaults.odometry))
    odometry.topic = checkedTopic(input, options, options.odometry, {kOdometry});
  const auto tf_frames = framesOf(options);
  reference.topic = options.reference;
  if (!tf_frames)
    reference.topic =
        checkedTopic(input, options, options.reference, {kOdometry, kTwistCovariance, kTwist, kFix});
  std::string masks, mask_truth;
  if (isWanted(input, options.masks, defaults.masks) &&
      isWanted(input, options.mask_truth, defaults.mask_truth)) {
    masks = checkedTopic(input, options, options.masks, {kImage});
    mask_truth = checkedTopic(input, options, options.mask_truth, {kCompressed});
  }
  std::string keyframes;
  std::set<double> keyframe_times;  // once each, although recording and output may both have them
  if (!options.keyframes.empty()) {
    keyframes = "/" + withoutSlash(options.keyframes);
    if (input.topics().count(keyframes) == 0)
      throw InvalidParameter({"keyframes"}, "keyframes: " + keyframes + " is not in the recording");
  }
  std::string no_objects;
  RecordedObjects objects(objectTopics(input, options, warn, no_objects));

  Transforms transforms;
  MaskComparison mask_comparison;
  std::vector<std::string> topics = {"/tf", "/tf_static", twist.topic};
  for (const std::string& topic : {odometry.topic, reference.topic, masks, mask_truth, keyframes})
    if (!topic.empty()) topics.push_back(topic);
  topics.insert(topics.end(), objects.topics().begin(), objects.topics().end());
  input.read(
      topics,
      [&](const rosbag::MessageInstance& message) {
        const std::string& topic = message.getTopic();
        if (topic == "/tf" || topic == "/tf_static") transforms.add(message);
        for (Stream* stream : {&twist, &odometry, &reference})
          if (topic == stream->topic) stream->add(message);
        if (topic == keyframes) keyframe_times.insert(message.getTime().toSec());
        if (topic == masks) mask_comparison.addMask(*message.instantiate<sensor_msgs::Image>());
        if (topic == mask_truth)
          mask_comparison.addTruth(*message.instantiate<sensor_msgs::CompressedImage>());
        objects.add(message);
      },
      progress);

  if (tf_frames) takePoses(transforms, *tf_frames, reference);
  prepare(twist, odometry, reference, options, transforms, warn);
  MotionReport report = compareMotion(twist.motion, odometry.motion, reference.motion, options.comparison,
                                      {keyframe_times.begin(), keyframe_times.end()});
  if (mask_comparison.masks() > 0) {
    report.masks = mask_comparison.report();
    report.masks_without_truth = mask_comparison.masks() - report.masks->frames;
  }
  report.objects_missing = no_objects;
  if (!objects.topics().empty())
    compareObjects(objects, reference, odometry, twist.frame, transforms, options.matching, report);
  return report;
}

std::string checkedTopic(const bag::BagInput& input, const std::string& option, const std::string& topic,
                         const std::vector<std::string>& types) {
  std::string name = topic.empty() ? "it" : "/" + withoutSlash(topic);
  const auto found = input.topics().find(name);
  const auto fits = [&](const std::string& type) {
    return std::find(types.begin(), types.end(), type) != types.end();
  };
  if (found != input.topics().end() && fits(found->second)) return name;
  std::string text, known;
  for (const auto& [other, type] : input.topics())
    if (fits(type)) known += fmt::format("{}{} ({})", known.empty() ? "" : ", ", other, type);
  for (const std::string& type : types) text += (text.empty() ? "" : ", ") + type;
  throw InvalidParameter({option},
                         fmt::format("{}: {} {}; of the types that serve ({}) there are: {}", option, name,
                                     topic.empty()                   ? "must be given"
                                     : found == input.topics().end() ? "is not in the recording"
                                                                     : "is of the type " + found->second,
                                     text, known.empty() ? "none" : known));
}

RecordedMotion recordedReference(const bag::BagInput& input, const std::string& name, const std::string& base,
                                 const Transforms& transforms,
                                 const std::function<void(const std::string&)>& warn) {
  RecordingOptions options;
  options.reference = name;
  Stream reference;
  reference.topic = name;
  std::string type;
  if (const auto tf_frames = framesOf(options)) {
    transforms.addPoses(tf_frames->first, tf_frames->second, reference.motion);
    reference.frames = {tf_frames->second};
  } else {
    reference.topic = checkedTopic(input, options, options.reference,
                                   {kOdometry, kTwistCovariance, kTwist, kImuType, kFix});
    type = input.topics().at(reference.topic);
    input.read({reference.topic}, [&](const rosbag::MessageInstance& message) { reference.add(message); });
  }
  if (type == kFix) reference.motion.poses = localPoses(reference.fixes);
  reference.motion.putInOrder();
  if (type == kFix) addCourse(reference.motion, options.comparison.interval);
  setFrame(reference, "", warn);
  // A gyroscope may be mounted upside down.
  if (type == kImuType && reference.frame != base && !transforms.between(base, reference.frame))
    throw std::runtime_error(reference.topic + ": " + transforms.missing(base, reference.frame));
  bringToBase(reference, base, transforms, warn);
  if (reference.motion.twists.empty() && reference.motion.poses.size() < 2)
    throw InvalidParameter({"reference"},
                           fmt::format("reference: {} tells nothing; the transforms of the recording are: {}",
                                       name, transforms.text()));
  return reference.motion;
}

}  // namespace radar_dot::evaluation
