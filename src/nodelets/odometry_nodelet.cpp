// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/odometry_nodelet.h"

#include <fmt/format.h>
#include <nav_msgs/Odometry.h>

#include <algorithm>
#include <array>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>
#include <utility>

#include "nodelets/common/process_clock.h"
#include "nodelets/messages/ego_messages.h"

namespace radar_dot {
namespace {

constexpr std::size_t kMaxPending = 50;  // twists waiting for a rotation
constexpr double kRivalMemory = 2.0;     // s
constexpr double kForever = 1e9;         // s
constexpr std::array<const char*, 6> kComponents = {"vx", "vy", "vz", "wx", "wy", "wz"};

}  // namespace

void OdometryNodelet::setUp() {
  ros::NodeHandle& handle = getNodeHandle();
  describe("odometry", config_.base_frame, expectationOf(config_.rate, StreamExpectation().silent_after));
  addDiagnostic("rotation",
                [this](diagnostic_updater::DiagnosticStatusWrapper& status) { reportRotation(status); });
  twist_input_ = listenAs<geometry_msgs::TwistWithCovarianceStamped>(
      "input ego/twist", std::make_unique<InputMonitor>("ego/twist", expectation(), true, "twist"),
      "ego/twist", 20,
      [this](const geometry_msgs::TwistWithCovarianceStampedConstPtr& twist) { onTwist(twist); }, {},
      Stamps::kByBody);
  setUpRotationSource();

  odometry_publisher_ = handle.advertise<nav_msgs::Odometry>("odom", 10);
  // Who joins late gets the path so far; it is sent again when it grows.
  path_publisher_ =
      handle.advertise<nav_msgs::Path>("path", 1, [this](const ros::SingleSubscriberPublisher& subscriber) {
        if (!path_.poses.empty()) subscriber.publish(path_);
      });
  odom_frame_ = withoutSlash(config_.rotation.odom_frame);
  if (odom_frame_ == extrinsics_->baseFrame()) {
    odom_frame_ = OdometryConfig().rotation.odom_frame;
    reportProblem(fmt::format("{} and {} are both '{}': the odometry is given in '{}'",
                              nameOf(config_, config_.rotation.odom_frame),
                              nameOf(config_, config_.base_frame), extrinsics_->baseFrame(), odom_frame_));
  }
  path_.header.frame_id = odom_frame_;
  for (const char* topic : {"/tf", "/tf_static"})
    tf_subscribers_.push_back(handle.subscribe(topic, 100, &OdometryNodelet::onTf, this));
  broadcaster_ = std::make_unique<tf2_ros::TransformBroadcaster>();
  static_broadcaster_ = std::make_unique<tf2_ros::StaticTransformBroadcaster>();
}

void OdometryNodelet::setUpRotationSource() {
  RotationSource::Callbacks callbacks;
  callbacks.sample = [this] {
    publishSourceTf();
    processQueue();
  };
  callbacks.arrival = [this] { checkClock(); };
  callbacks.restarted = [this] { R_odom_from_source_.reset(); };
  callbacks.warn = [this](const std::string& text) { warn({}, text); };
  try {
    const ros::NodeHandle& handle = getNodeHandle();
    if (config_.rotation.source == RotationSourceKind::kOdometry &&
        handle.resolveName("rotation/odom") == handle.resolveName("odom"))
      throw std::invalid_argument("rotation/odom is '" + handle.resolveName("odom") + "', its own output");
    rotation_source_ =
        makeRotationSource(config_.rotation, getNodeHandle(), *extrinsics_, std::move(callbacks));
  } catch (const std::invalid_argument& error) {
    reportProblem(std::string(error.what()) + "; using the yaw rate of the radars");
  }
  start_at_source_ = config_.start_at_source && rotation_source_ && rotation_source_->hasPosition();
  if (config_.start_at_source && !start_at_source_) {
    reportProblem(std::string(nameOf(config_, config_.start_at_source)) + " needs a " +
                  nameOf(config_, config_.rotation.source) +
                  " with a position (odometry, tf); starting at the origin");
  }
}

void OdometryNodelet::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  twist_input_->stream().report(ros::Time::now(), status);
  if (!unobserved_.empty()) {
    status.mergeSummary(DiagnosticStatus::WARN, "not observed, least sideslip assumed: " + unobserved_);
  }
  if (const std::string conflict = tfConflict(); !conflict.empty()) {
    status.mergeSummary(DiagnosticStatus::WARN, conflict);
    warn({}, conflict);
  }
  status.add("twist topic", twist_input_->topic());
  status.addf("distance (m)", "%.2f", distance_before_gap_ + integrator_.state().distance);
  status.addf("gaps", "%zu", gaps_);
  status.addf("twists refused", "%zu", twist_input_->refusedInAll());
}

void OdometryNodelet::onTf(const ros::MessageEvent<const tf2_msgs::TFMessage>& event) {
  if (!config_.publish_tf || event.getPublisherName() == ros::this_node::getName()) return;
  for (const geometry_msgs::TransformStamped& transform : event.getConstMessage()->transforms) {
    if (withoutSlash(transform.child_frame_id) != extrinsics_->baseFrame()) continue;
    const bool holds = event.getConnectionHeader().at("topic") == "/tf_static";
    tf_rival_ = event.getPublisherName();
    tf_rival_holds_until_ = ProcessClock::now() + ros::WallDuration(holds ? kForever : kRivalMemory);
  }
}

std::string OdometryNodelet::tfConflict() const {
  if (ProcessClock::now() > tf_rival_holds_until_) return "";
  return tf_rival_ + " publishes the transform to '" + extrinsics_->baseFrame() +
         "' as well: one of the two must not (" + nameOf(config_, config_.publish_tf) + ": false)";
}

std::string OdometryNodelet::contradictionOfSource() const {
  return rotation_source_->contradiction("'" + twist_input_->topic() + "'", "the range rates of the radars");
}

void OdometryNodelet::reportRotation(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  if (!rotation_source_) {
    status.summary(DiagnosticStatus::OK, "yaw rate of the radars");
    return;
  }
  const std::optional<double> latest = rotation_source_->latest();
  if (!latest) {
    status.summary(DiagnosticStatus::ERROR, "nothing from " + rotation_source_->describe());
  } else if (without_rotation_ > 0) {
    status.summaryf(DiagnosticStatus::WARN, "%zu twists without a rotation from %s", without_rotation_,
                    rotation_source_->describe().c_str());
  } else {
    status.summary(DiagnosticStatus::OK, rotation_source_->describe());
  }
  if (const std::string contradiction = contradictionOfSource(); !contradiction.empty()) {
    const bool is_speed = rotation_source_->contradictsSpeed();
    status.mergeSummary(is_speed ? DiagnosticStatus::ERROR : DiagnosticStatus::WARN, contradiction);
    warn("contradiction", contradiction);
  }
  if (latest) status.addf("age (s)", "%.3f", std::max(0.0, ros::Time::now().toSec() - *latest));
  status.addf("twists waiting", "%zu", pending_.size());
  without_rotation_ = 0;
}

void OdometryNodelet::clearHistory() {
  pending_.clear();
  integrator_.reset();
  started_ = false;
  R_odom_from_source_.reset();
  distance_before_gap_ = 0.0;
  covariance_before_gap_.setZero();
  path_.poses.clear();
  if (path_publisher_.getNumSubscribers() > 0) path_publisher_.publish(path_);
  if (rotation_source_) rotation_source_->reset();
}

void OdometryNodelet::onTwist(const geometry_msgs::TwistWithCovarianceStampedConstPtr& twist) {
  twist_input_->arrived();
  const std::string defect = twistDefect(*twist, extrinsics_->baseFrame());
  if (!defect.empty()) throw std::invalid_argument(defect);
  acceptStamp(*twist_input_, twist->header);
  pending_.push_back({twist, Moment::now()});
  processQueue();
}

void OdometryNodelet::processQueue() {
  const Moment now = Moment::now();
  while (!pending_.empty()) {
    const geometry_msgs::TwistWithCovarianceStampedConstPtr twist = pending_.front().message;
    std::optional<StampedPose> pose;
    if (rotation_source_) {
      pose = rotation_source_->at(twist->header.stamp);
      if (!pose && pending_.front().arrival.waits(config_.rotation_timeout, now) &&
          pending_.size() <= kMaxPending)
        return;
      if (!pose) {
        ++without_rotation_;
        warn({}, "no rotation at the stamp of a twist from " + rotation_source_->describe());
      } else {
        rotation_source_->addVelocity(onWheels(twistOf(*twist)));
        rotation_source_->compare(twistOf(*twist));
      }
    }
    pending_.pop_front();
    integrate(*twist, pose);
  }
}

bool OdometryNodelet::start(const std::optional<StampedPose>& pose) {
  Eigen::Isometry3d T_odom_from_base = Eigen::Isometry3d::Identity();
  if (start_at_source_) {
    if (!pose) return false;
    T_odom_from_base.linear() = pose->rotation.toRotationMatrix();
    T_odom_from_base.translation() = pose->position;
    R_odom_from_source_ = Eigen::Quaterniond::Identity();
    publishSourceTf();
  }
  integrator_.reset(T_odom_from_base);
  started_ = true;
  return true;
}

void OdometryNodelet::publishSourceTf() {
  const std::string frame = rotation_source_->frame();
  if (!config_.publish_source_tf || !start_at_source_ || frame == tied_frame_ || frame == odom_frame_) return;
  tied_frame_ = frame;
  // We start at the source's own pose: the two frames coincide.
  geometry_msgs::TransformStamped transform;
  transform.header.stamp = ros::Time::now();
  transform.header.frame_id = frame;
  transform.child_frame_id = odom_frame_;
  transform.transform.rotation.w = 1.0;
  static_broadcaster_->sendTransform(transform);
}

std::optional<Eigen::Quaterniond> OdometryNodelet::rotationFrom(const std::optional<StampedPose>& pose) {
  if (!pose) {
    // A relative source knows nothing of the turn it slept through.
    if (rotation_source_ && !rotation_source_->isAbsolute()) R_odom_from_source_.reset();
    return std::nullopt;
  }
  if (!R_odom_from_source_) {
    const Eigen::Quaterniond current(integrator_.state().T_odom_from_base.linear());
    R_odom_from_source_ = headingOf(current) * headingOf(pose->rotation).inverse();
  }
  return *R_odom_from_source_ * pose->rotation;
}

StampedTwist OdometryNodelet::usableTwist(const geometry_msgs::TwistWithCovarianceStamped& message,
                                          bool rotation_known) {
  const StampedTwist twist = twistOf(message);
  unobserved_.clear();
  // vx, vy and wz stay as given: together they are what the returns allow with the least sideslip.
  for (const Eigen::Index i : {0, 1, 5}) {
    if (twist.observes(i) || (i == 5 && rotation_known)) continue;
    unobserved_ += (unobserved_.empty() ? "" : ", ") + std::string(kComponents[static_cast<std::size_t>(i)]);
  }
  if (!unobserved_.empty())
    warn({}, "the twist does not observe " + unobserved_ + ": least sideslip assumed");
  StampedTwist usable = onWheels(twist);
  // Rates of roll and pitch that nothing levels would tilt the pose by the bias of the gyro.
  if (!rotation_known) usable.angular.head<2>().setZero();
  return usable;
}

void OdometryNodelet::bridgeGap(double gap, double speed) {
  const VelocityIntegrator::State state = integrator_.state();
  distance_before_gap_ += state.distance;
  covariance_before_gap_ += state.covariance;
  covariance_before_gap_.topLeftCorner<3, 3>().diagonal().array() += speed * speed * gap * gap;
  integrator_.reset(state.T_odom_from_base);
  ++gaps_;
  NODELET_WARN("%s: no twist for %.2f s (%s %.2f s): not integrated over", getName().c_str(), gap,
               nameOf(config_, config_.max_gap), config_.max_gap);
}

void OdometryNodelet::integrate(const geometry_msgs::TwistWithCovarianceStamped& twist,
                                const std::optional<StampedPose>& pose) {
  if (!started_ && !start(pose)) {
    warn({}, "waiting for a first pose from " + rotation_source_->describe());
    return;
  }
  const std::optional<Eigen::Quaterniond> rotation = rotationFrom(pose);
  const StampedTwist velocity = usableTwist(twist, rotation.has_value());
  const double gap = integrator_.started() ? velocity.time - integrator_.state().time : 0.0;
  if (gap > config_.max_gap) bridgeGap(gap, velocity.linear.norm());
  if (integrator_.add(velocity, rotation)) publish(twist);
}

void OdometryNodelet::publish(const geometry_msgs::TwistWithCovarianceStamped& twist) {
  const VelocityIntegrator::State& state = integrator_.state();
  const Eigen::Quaterniond rotation(state.T_odom_from_base.linear());
  const Eigen::Vector3d position = state.T_odom_from_base.translation();

  nav_msgs::Odometry odometry;
  odometry.header.stamp = twist.header.stamp;
  odometry.header.frame_id = odom_frame_;
  odometry.child_frame_id = extrinsics_->baseFrame();
  odometry.pose.pose.position.x = position.x();
  odometry.pose.pose.position.y = position.y();
  odometry.pose.pose.position.z = position.z();
  odometry.pose.pose.orientation.w = rotation.w();
  odometry.pose.pose.orientation.x = rotation.x();
  odometry.pose.pose.orientation.y = rotation.y();
  odometry.pose.pose.orientation.z = rotation.z();
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(odometry.pose.covariance.data()) =
      covariance_before_gap_ + state.covariance;
  odometry.twist = twist.twist;
  odometry_publisher_.publish(odometry);

  if (config_.publish_tf) {
    geometry_msgs::TransformStamped transform;
    transform.header = odometry.header;
    transform.child_frame_id = odometry.child_frame_id;
    transform.transform = transformOf(state.T_odom_from_base);
    broadcaster_->sendTransform(transform);
  }

  geometry_msgs::PoseStamped pose;
  pose.header = odometry.header;
  pose.pose = odometry.pose.pose;
  extendPath(pose);
}

void OdometryNodelet::extendPath(const geometry_msgs::PoseStamped& pose) {
  if (!path_.poses.empty()) {
    const geometry_msgs::Point& last = path_.poses.back().pose.position;
    const Eigen::Vector3d step(pose.pose.position.x - last.x, pose.pose.position.y - last.y,
                               pose.pose.position.z - last.z);
    if (step.norm() < config_.path_min_distance) return;
  }
  path_.header = pose.header;
  path_.poses.push_back(pose);
  const auto length = static_cast<std::size_t>(config_.path_length);
  if (path_.poses.size() > length) {
    // A tenth at a time, so that a full path is not moved by one pose again and again.
    const std::size_t surplus = path_.poses.size() - length + length / 10;
    path_.poses.erase(path_.poses.begin(), path_.poses.begin() + static_cast<std::ptrdiff_t>(surplus));
  }
  if (path_publisher_.getNumSubscribers() > 0) path_publisher_.publish(path_);
}

}  // namespace radar_dot

PLUGINLIB_EXPORT_CLASS(radar_dot::OdometryNodelet, nodelet::Nodelet)
