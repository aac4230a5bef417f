// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// What all nodelets have in common, with nodelets in this process, and inputs that need topics.
#include "nodelets/common/stream_nodelet.h"

#include <XmlRpcClient.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <nodelet/loader.h>
#include <ros/callback_queue.h>
#include <ros/xmlrpc_manager.h>
#include <sensor_msgs/Imu.h>
#include <tf2_ros/static_transform_broadcaster.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "live_graph.h"
#include "nodelets/inputs/rotation_source.h"
#include "vision_world.h"

namespace radar_dot::test {
namespace {

using sensor_msgs::CameraInfo;
using sensor_msgs::Image;

// What was called of a nodelet, and of that what came before its set-up was complete.
struct Calls {
  std::atomic<bool> complete{false};
  std::atomic<int> messages{0}, extras{0}, ticks{0}, reports{0}, early{0};
  void note(std::atomic<int>& count) {
    ++count;
    if (!complete) ++early;
  }
};

// Needs longer for its set-up than the diagnostics wait, as with a network to load, and starts its inputs
// first.
class SlowNodelet : public ConfiguredNodelet<StreamParams> {
 public:
  SlowNodelet(Calls& calls, bool fails) : calls_(calls), fails_(fails) {}
  static std::atomic<bool> wants_extra;

 private:
  void setUp() override {
    describe("slow", config_);
    publisher_ = getNodeHandle().advertise<Image>("slow/output", 1);
    const auto listenTo = [this](const char* topic, std::atomic<int>& count, InputOptions options) {
      listen<CameraInfo>(
          topic, 1, [this, &count](const sensor_msgs::CameraInfoConstPtr&) { calls_.note(count); },
          std::move(options), Stamps::kAny);
    };
    listenTo("slow/input", calls_.messages, {});
    listenTo("slow/extra", calls_.extras,
             {false, [] { return wants_extra.load(); }, [this] { calls_.extras = 0; }});
    ros::WallDuration(1.2).sleep();
    if (fails_) throw std::runtime_error("no network");
    calls_.complete = true;
  }
  bool hasAudience() const override { return publisher_.getNumSubscribers() > 0; }
  void tick() override { calls_.note(calls_.ticks); }
  void clearHistory() override {}
  void report(diagnostic_updater::DiagnosticStatusWrapper& status) override {
    calls_.note(calls_.reports);
    status.summary(diagnostic_msgs::DiagnosticStatus::OK, "working");
  }

  Calls& calls_;
  bool fails_;
  ros::Publisher publisher_;
};
std::atomic<bool> SlowNodelet::wants_extra{false};

class SlowNodeletTest : public ::testing::Test {
 protected:
  SlowNodeletTest() {
    SlowNodelet::wants_extra = false;
    // Both wait before the nodelet is loaded.
    for (const char* topic : {"slow/input", "slow/extra"})
      inputs_.push_back(handle_.advertise<CameraInfo>(topic, 1, true));
    for (const ros::Publisher& input : inputs_) input.publish(CameraInfo());
  }
  void load(bool fails) {
    fails_ = fails;
    ASSERT_TRUE(loader_.load("/slow", "slow", {}, {}));
  }

  ros::NodeHandle handle_;
  Diagnostics diagnostics_{handle_};
  Calls calls_;
  bool fails_ = false;
  std::vector<ros::Publisher> inputs_;
  std::optional<Recorder<Image>> output_{std::in_place, handle_, "slow/output"};
  nodelet::Loader loader_{[this](const std::string&) {
    return boost::shared_ptr<nodelet::Nodelet>(new SlowNodelet(calls_, fails_));
  }};
};

TEST_F(SlowNodeletTest, NothingIsServedBeforeTheSetUpIsComplete) {
  load(false);
  EXPECT_TRUE(waitUntil([this] { return calls_.messages > 0 && calls_.ticks > 0 && calls_.reports > 0; }))
      << calls_.messages << " messages, " << calls_.ticks << " ticks, " << calls_.reports << " reports";
  EXPECT_EQ(calls_.early, 0);
  EXPECT_TRUE(diagnostics_.says("slow: slow", diagnostic_msgs::DiagnosticStatus::OK, "working"));
}

TEST_F(SlowNodeletTest, AnOptionalInputIsSubscribedWhileItIsWanted) {
  load(false);
  ASSERT_TRUE(waitUntil([this] { return calls_.messages > 0; }));
  EXPECT_EQ(calls_.extras, 0);
  EXPECT_EQ(inputs_[1].getNumSubscribers(), 0U);
  SlowNodelet::wants_extra = true;
  EXPECT_TRUE(waitUntil([this] { return calls_.extras > 0; }));
  SlowNodelet::wants_extra = false;
  EXPECT_TRUE(waitUntil([this] { return inputs_[1].getNumSubscribers() == 0; }));
  EXPECT_EQ(calls_.extras, 0) << "what came of it is forgotten";
  EXPECT_EQ(inputs_[0].getNumSubscribers(), 1U);
  output_.reset();
  EXPECT_TRUE(waitUntil([this] { return inputs_[0].getNumSubscribers() == 0; }));
  EXPECT_TRUE(diagnostics_.says("slow: slow", diagnostic_msgs::DiagnosticStatus::OK, "idle: no subscribers"));
}

TEST_F(SlowNodeletTest, ASetUpThatFailsIsReportedAndNothingIsServed) {
  load(true);
  EXPECT_TRUE(diagnostics_.says("slow: slow", diagnostic_msgs::DiagnosticStatus::ERROR, "no network"));
  EXPECT_EQ(calls_.messages + calls_.ticks + calls_.reports, 0);
}

TEST(StreamNodeletTest, DepthServesASubscriberThatWaited) {
  ros::NodeHandle handle;
  const Recorder<Image> depths(handle, "depth");
  tf2_ros::StaticTransformBroadcaster broadcaster;
  broadcaster.sendTransform(VisionWorld::mount());
  ros::Publisher camera = handle.advertise<CameraInfo>("camera_info", 1, true);
  camera.publish(VisionWorld::cameraInfo(ros::Time::now()));
  ros::Publisher images = handle.advertise<Image>("image", 1);
  nodelet::Loader loader(false);
  ASSERT_TRUE(loader.load("/depth", "radar_dot/Depth", {}, {}));
  EXPECT_TRUE(waitUntil([&] {
    images.publish(VisionWorld::image(ros::Time::now(), 0.0));
    return depths.count() > 0;
  }));
}

TEST(StreamNodeletTest, ATwistThatCannotBeReadMovesNoStamps) {
  ros::NodeHandle handle;
  const Recorder<nav_msgs::Odometry> odometry(handle, "odom");
  ros::Publisher twists = handle.advertise<geometry_msgs::TwistWithCovarianceStamped>("ego/twist", 10);
  nodelet::Loader loader(false);
  ASSERT_TRUE(loader.load("/odometry", "radar_dot/Odometry", {}, {}));
  ASSERT_TRUE(waitUntil([&] { return twists.getNumSubscribers() > 0 && odometry.connected(); }));
  const ros::Time start = ros::Time::now();
  for (const double seconds : {0.0, 0.1, 0.2, 0.3}) {
    geometry_msgs::TwistWithCovarianceStamped twist = VisionWorld::twist(start + ros::Duration(seconds));
    twists.publish(twist);
    twist.header.stamp += ros::Duration(0.5);
    twist.header.frame_id = "trailer";
    twists.publish(twist);
  }
  EXPECT_TRUE(waitUntil([&] { return odometry.count() == 4; })) << odometry.count() << " of 4";
}

// How often this process receives a topic from itself.
std::size_t connectionsOf(const std::string& topic) {
  XmlRpc::XmlRpcValue request, answer;
  request[0] = "/test";
  XmlRpc::XmlRpcClient self("localhost", ros::XMLRPCManager::instance()->getServerPort(), "/");
  if (!self.execute("getBusInfo", request, answer) || answer.size() < 3) return 0;
  XmlRpc::XmlRpcValue& connections = answer[2];
  const int size = connections.size();
  std::size_t count = 0;
  for (int i = 0; i < size; ++i) {
    XmlRpc::XmlRpcValue& one = connections[i];
    if (static_cast<std::string&>(one[2]) == "i" && static_cast<std::string&>(one[4]) == topic) ++count;
  }
  return count;
}

// roscpp connects both ends twice where one is made while the other is.
TEST(StreamNodeletTest, NoTwistComesTwice) {
  ros::NodeHandle handle;
  const Recorder<nav_msgs::Odometry> odometry(handle, "odom");
  for (int round = 0; round < 8; ++round) {
    nodelet::Loader loader(false);
    ASSERT_TRUE(loader.load("/ego_velocity", "radar_dot/EgoVelocity", {}, {}));
    ASSERT_TRUE(loader.load("/odometry", "radar_dot/Odometry", {}, {}));
    ASSERT_TRUE(waitUntil([] { return connectionsOf("/ego/twist") > 0; }));
    EXPECT_EQ(connectionsOf("/ego/twist"), 1U) << "in round " << round;
  }
}

class Inputs : public testing::Test {
 protected:
  void SetUp() override {
    handle_.setCallbackQueue(&queue_);
    extrinsics_.buffer().setTransform(VisionWorld::mount(), "test", true);
  }
  /// A source that has heard `count` messages, made by `message` for 50 a second.
  template <typename Message>
  std::unique_ptr<RotationSource> sourceOf(RotationSourceKind kind, const std::string& topic, int count,
                                           const std::function<void(Message&, double)>& message) {
    RotationParams params;
    params.source = kind;
    int samples = 0;
    RotationSource::Callbacks callbacks{[] {}, [&] { ++samples; }, [] {},
                                        [](const std::string& text) { ADD_FAILURE() << text; }};
    auto source = makeRotationSource(params, handle_, extrinsics_, callbacks);
    source->start();
    ros::Publisher publisher = handle_.advertise<Message>(topic, 100);
    EXPECT_TRUE(serveUntil([&] { return publisher.getNumSubscribers() > 0; }));
    for (int i = 0; i < count; ++i) {
      Message made;
      made.header.stamp = start_ + ros::Duration(0.02 * i);
      message(made, 0.02 * i);
      publisher.publish(made);
    }
    EXPECT_TRUE(serveUntil([&] { return samples == count; })) << samples;
    return source;
  }
  /// Serves messages until the condition holds.
  bool serveUntil(const std::function<bool()>& condition) {
    return waitUntil([&] { return queue_.callAvailable(), condition(); });
  }

  ros::CallbackQueue queue_;
  ros::NodeHandle handle_{"inputs"};
  Extrinsics extrinsics_{"base_link", handle_};
  const ros::Time start_ = ros::Time::now() - ros::Duration(2.0);
};

// A message that is served before its owner holds the source would find a null pointer.
TEST_F(Inputs, ARotationSourceListensOnceItIsStarted) {
  const auto listens = [] {
    ros::V_string topics;
    ros::this_node::getSubscribedTopics(topics);
    return std::count(topics.begin(), topics.end(), "/inputs/rotation/odom") > 0;
  };
  std::unique_ptr<RotationSource> source;
  std::size_t samples = 0;
  RotationSource::Callbacks callbacks{[] {}, [&] { ++samples; }, [] {}, [](const std::string&) {}};
  RotationParams params;
  params.source = RotationSourceKind::kOdometry;
  source = makeRotationSource(params, handle_, extrinsics_, callbacks);
  EXPECT_FALSE(listens());
  EXPECT_EQ(source->describe(), "odometry on '/inputs/rotation/odom'");
  source->start();
  EXPECT_TRUE(listens());

  nav_msgs::Odometry odometry;
  odometry.header.stamp = ros::Time::now();
  odometry.pose.pose.orientation.w = 1.0;
  ros::Publisher publisher = handle_.advertise<nav_msgs::Odometry>("rotation/odom", 1, true);
  publisher.publish(odometry);
  EXPECT_TRUE(serveUntil([&] { return samples == 1; }));
  EXPECT_EQ(source->latest(), odometry.header.stamp.toSec());
}

// An IMU whose x axis points to the left of the vehicle.
TEST_F(Inputs, AnImuTellsTheAngularVelocityOfTheBase) {
  geometry_msgs::TransformStamped mount;
  mount.header.frame_id = "base_link";
  mount.child_frame_id = "imu";
  mount.transform.rotation.z = mount.transform.rotation.w = std::sqrt(0.5);
  extrinsics_.buffer().setTransform(mount, "test", true);
  const auto source = sourceOf<sensor_msgs::Imu>(RotationSourceKind::kImu, "rotation/imu", 10,
                                                 [](sensor_msgs::Imu& imu, double time) {
                                                   imu.header.frame_id = "imu";
                                                   imu.angular_velocity.x = 0.1 + time;
                                                   imu.angular_velocity.z = 0.3;
                                                   imu.angular_velocity_covariance[0] = 4e-4;
                                                 });
  const auto rate = source->rateAt(start_ + ros::Duration(0.11));
  ASSERT_TRUE(rate);
  EXPECT_NEAR((rate->rate - Eigen::Vector3d(0.0, 0.2, 0.3)).norm(), 0.0, 1e-6) << "of the sample at 0.10 s";
  EXPECT_NEAR(rate->covariance(1, 1) - rate->covariance(0, 0), 4e-4, 1e-9);
  EXPECT_GT(rate->covariance(2, 2), 0.0) << "what is not stated is not exact";
  EXPECT_TRUE(source->rateAt(start_ + ros::Duration(0.25)));
  EXPECT_FALSE(source->rateAt(start_ + ros::Duration(0.35))) << "too old";
  EXPECT_FALSE(source->rateAt(start_ - ros::Duration(0.01))) << "before the first";
}

TEST_F(Inputs, AnOdometryTellsTheAngularVelocityOfTheBase) {
  const auto source = sourceOf<nav_msgs::Odometry>(RotationSourceKind::kOdometry, "rotation/odom", 20,
                                                   [](nav_msgs::Odometry& odometry, double time) {
                                                     odometry.pose.pose.orientation.z = std::sin(0.25 * time);
                                                     odometry.pose.pose.orientation.w = std::cos(0.25 * time);
                                                   });
  for (const double time : {0.30, 0.42}) {
    const auto rate = source->rateAt(start_ + ros::Duration(time));
    ASSERT_TRUE(rate) << time;
    EXPECT_NEAR((rate->rate - Eigen::Vector3d(0.0, 0.0, 0.5)).norm(), 0.0, 1e-4);
  }
  EXPECT_FALSE(source->rateAt(start_ + ros::Duration(0.6)));
}

TEST(Extrinsics, NodeletsOfAProcessShareOneBuffer) {
  const ros::NodeHandle handle, other("other"), renamed("", {{"/tf", "/elsewhere/tf"}});
  Extrinsics first("base_link", handle), second("rear_axle", other), third("base_link", renamed);
  EXPECT_EQ(&first.buffer(), &second.buffer());
  EXPECT_NE(&first.buffer(), &third.buffer()) << "it listens to another topic";
}

}  // namespace
}  // namespace radar_dot::test
