// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// Replays a drive with known truth through the nodelets and checks everything they publish.
#include <geometry_msgs/TwistWithCovarianceStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <nav_msgs/Path.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <cstring>
#include <memory>
#include <set>

#include "fixtures/files.h"
#include "live_graph.h"
#include "radar_dot/EgoStatus.h"
#include "synthetic_bag.h"

namespace radar_dot::test {
namespace {

using geometry_msgs::TwistWithCovarianceStamped;
using Covariance = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

constexpr double kSettled = 0.6;  // s of the drive after which the acceleration is known

double secondsOf(const ros::Time& stamp) { return stamp.toSec() - SyntheticDrive::kStart; }

double yawOf(const geometry_msgs::Quaternion& q) { return 2.0 * std::atan2(q.z, q.w); }

double angleBetween(double a, double b) { return std::remainder(a - b, 2.0 * M_PI); }

float floatAt(const sensor_msgs::PointCloud2& cloud, std::size_t point, const std::string& field) {
  float value = 0.F;
  std::memcpy(&value, &cloud.data[point * cloud.point_step + offsetOf(cloud, field)], sizeof value);
  return value;
}

int idAt(const sensor_msgs::PointCloud2& cloud, std::size_t point) {
  std::int16_t id = -1;
  std::memcpy(&id, &cloud.data[point * cloud.point_step + offsetOf(cloud, "id")], sizeof id);
  return id;
}

// What the nodelets said during one replay.
struct Recording {
  ros::NodeHandle handle;
  Recorder<TwistWithCovarianceStamped> twists{handle, "ego/twist"};
  Recorder<TwistWithCovarianceStamped> raw{handle, "ego/twist_raw"};
  Recorder<EgoStatus> statuses{handle, "ego/status"};
  Recorder<sensor_msgs::PointCloud2> still{handle, "radar/static"};
  Recorder<sensor_msgs::PointCloud2> moving{handle, "radar/dynamic"};
  Recorder<nav_msgs::Odometry> odometry{handle, "odom"};
  Recorder<nav_msgs::Path> path{handle, "path"};
  Recorder<nav_msgs::Odometry> by_imu{handle, "imu/odom"};
  Recorder<nav_msgs::Odometry> by_radar{handle, "radar_only/odom"};
  Recorder<nav_msgs::Odometry> by_tf{handle, "tf/odom"};
  Diagnostics diagnostics{handle};

  bool connected() const {
    return twists.connected() && raw.connected() && statuses.connected() && still.connected() &&
           moving.connected() && odometry.connected() && by_imu.connected() && by_radar.connected() &&
           by_tf.connected();
  }
};

class ReplayTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    recording_ = std::make_unique<Recording>();
    const TemporaryFolder folder;
    scans_ = writeSyntheticBag(drive_, folder.path() / "drive.bag");
    ASSERT_TRUE(waitUntil([] { return recording_->connected(); })) << "the nodelets did not come up";
    BagPlayer player({"--clock", "--rate=2", "--delay=1.5", (folder.path() / "drive.bag").string()});
    ASSERT_EQ(player.wait(60.0), 0);
    for (const auto* poses :
         {&recording_->odometry, &recording_->by_imu, &recording_->by_radar, &recording_->by_tf})
      EXPECT_TRUE(waitUntil([&] {
        return poses->count() > 0 && secondsOf(poses->latest()->header.stamp) > drive_.duration() - 0.3;
      }));
  }
  static void TearDownTestSuite() { recording_.reset(); }

  static const SyntheticDrive drive_;
  static std::map<ScanKey, sensor_msgs::PointCloud2> scans_;
  static inline std::unique_ptr<Recording> recording_;
};
const SyntheticDrive ReplayTest::drive_;
std::map<ScanKey, sensor_msgs::PointCloud2> ReplayTest::scans_;

TEST_F(ReplayTest, TwistIsTheTruthAtTheStampOfAScan) {
  const auto twists = recording_->twists.messages();
  ASSERT_GT(twists.size(), static_cast<std::size_t>(0.9 * 13.0 * drive_.duration()));
  std::set<ros::Time> stamps;
  for (const auto& [key, scan] : scans_) stamps.insert(key.second);

  ros::Time previous;
  for (const auto& twist : twists) {
    EXPECT_EQ(twist->header.frame_id, "base_link");
    EXPECT_EQ(stamps.count(twist->header.stamp), 1U) << "a stamp that no scan has";
    EXPECT_GT(twist->header.stamp, previous);
    previous = twist->header.stamp;
    const double seconds = secondsOf(twist->header.stamp);
    if (seconds < kSettled) continue;
    const TrueState truth = drive_.at(seconds);
    EXPECT_NEAR(twist->twist.twist.linear.x, truth.speed, 0.05) << "at " << seconds << " s";
    EXPECT_NEAR(twist->twist.twist.linear.y, 0.0, 0.05) << "at " << seconds << " s";
    EXPECT_NEAR(twist->twist.twist.angular.z, truth.yaw_rate, 0.03) << "at " << seconds << " s";
    EXPECT_EQ(twist->twist.twist.linear.z, 0.0);
  }
}

TEST_F(ReplayTest, TheRawTwistIsThatOfTheSweepAlone) {
  const auto raw = recording_->raw.messages();
  const auto filtered = recording_->twists.messages();
  ASSERT_EQ(raw.size(), filtered.size());
  std::size_t different = 0;
  for (std::size_t i = 0; i < raw.size(); ++i) {
    EXPECT_EQ(raw[i]->header.stamp, filtered[i]->header.stamp);
    EXPECT_EQ(raw[i]->header.frame_id, filtered[i]->header.frame_id);
    if (secondsOf(raw[i]->header.stamp) < kSettled) continue;
    const TrueState truth = drive_.at(secondsOf(raw[i]->header.stamp));
    EXPECT_NEAR(raw[i]->twist.twist.linear.x, truth.speed, 0.05);
    EXPECT_NEAR(raw[i]->twist.twist.angular.z, truth.yaw_rate, 0.03);
    if (raw[i]->twist.twist.angular.z != filtered[i]->twist.twist.angular.z) ++different;
  }
  EXPECT_GT(different, 100U);
}

TEST_F(ReplayTest, CovarianceIsSymmetricPositiveAndHonest) {
  ASSERT_GT(recording_->twists.count(), 100U);
  for (const auto& twist : recording_->twists.messages()) {
    if (secondsOf(twist->header.stamp) < kSettled) continue;
    const Covariance covariance = Eigen::Map<const Covariance>(twist->twist.covariance.data());
    EXPECT_TRUE(covariance.isApprox(covariance.transpose(), 1e-9));
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Covariance>(covariance).eigenvalues().minCoeff(), 0.0);
    for (const int axis : {0, 1, 5}) EXPECT_LT(covariance(axis, axis), 0.1) << "observed axis " << axis;
    for (const int axis : {2, 3, 4}) EXPECT_GE(covariance(axis, axis), 1e5) << "unobserved axis " << axis;
  }
}

TEST_F(ReplayTest, StatusAccountsForEveryReturn) {
  // A machine that stalls for a scan's period gets its clouds out of turn: that sweep is of fewer radars.
  std::size_t settled = 0, complete = 0;
  for (const auto& status : recording_->statuses.messages()) {
    if (secondsOf(status->header.stamp) < kSettled) continue;
    ++settled;
    if (status->radar_count == 5) ++complete;
    EXPECT_EQ(status->status, EgoStatus::OK);
    EXPECT_EQ(status->reason, "");
    EXPECT_EQ(status->model, "planar_yaw");
    EXPECT_EQ(status->solver, "ransac_robust");
    EXPECT_EQ(status->total_count, 50U * status->radar_count);
    EXPECT_EQ(status->return_count, 45U * status->radar_count) << "every tenth return is invalid";
    EXPECT_EQ(status->dynamic_count, 9U * status->radar_count);
    EXPECT_LT(status->rms, 0.1);
    EXPECT_TRUE(status->observed[0] && status->observed[1] && status->observed[5]);
    EXPECT_FALSE(status->observed[2] || status->observed[3] || status->observed[4]);
  }
  EXPECT_GT(settled, 100U);
  EXPECT_GE(complete, settled * 8 / 10);
}

// Every accepted return appears once, in the cloud of its label, with its bytes as they were.
TEST_F(ReplayTest, StaticAndDynamicPartitionTheAcceptedReturns) {
  struct Parts {
    sensor_msgs::PointCloud2ConstPtr still, moving;
  };
  std::map<ScanKey, Parts> parts;
  for (const auto& cloud : recording_->still.messages()) {
    Parts& part = parts[{cloud->header.frame_id, cloud->header.stamp}];
    EXPECT_FALSE(part.still) << "a scan published twice";
    part.still = cloud;
  }
  for (const auto& cloud : recording_->moving.messages()) {
    parts[{cloud->header.frame_id, cloud->header.stamp}].moving = cloud;
  }
  EXPECT_GT(parts.size(), static_cast<std::size_t>(0.9 * static_cast<double>(scans_.size())));

  for (const auto& [key, part] : parts) {
    ASSERT_TRUE(part.still && part.moving) << key.first << " at " << secondsOf(key.second) << " s";
    const sensor_msgs::PointCloud2& scan = scans_.at(key);
    std::set<int> seen;
    for (const bool moving : {false, true}) {
      const sensor_msgs::PointCloud2& cloud = moving ? *part.moving : *part.still;
      ASSERT_EQ(cloud.point_step, scan.point_step + 8);
      ASSERT_EQ(cloud.fields.size(), 20U);
      for (std::size_t k = 0; k < scan.fields.size(); ++k) {
        EXPECT_EQ(cloud.fields[k].name, scan.fields[k].name);
        EXPECT_EQ(cloud.fields[k].offset, scan.fields[k].offset);
        EXPECT_EQ(cloud.fields[k].datatype, scan.fields[k].datatype);
      }
      ASSERT_EQ(cloud.data.size(), cloud.point_step * cloud.width);
      const auto scale = static_cast<float>(ros::param::param("ego_velocity/doppler_scale", 1.0));
      for (std::size_t i = 0; i < cloud.width; ++i) {
        const int id = idAt(cloud, i);
        ASSERT_TRUE(seen.insert(id).second) << "return " << id << " appears twice";
        const auto source = static_cast<std::size_t>(id);
        EXPECT_EQ(std::memcmp(&cloud.data[i * cloud.point_step], &scan.data[source * scan.point_step],
                              scan.point_step),
                  0)
            << "return " << id << " was changed";
        const float x = floatAt(scan, source, "x"), y = floatAt(scan, source, "y");
        const float doppler =
            scale * (x * floatAt(scan, source, "vx") + y * floatAt(scan, source, "vy")) / std::hypot(x, y);
        EXPECT_NEAR(floatAt(cloud, i, "doppler"), doppler, 1e-4F);
        if (secondsOf(key.second) < kSettled) continue;
        EXPECT_EQ(moving, isMoving(id)) << "return " << id << " at " << secondsOf(key.second) << " s";
        const float residual = std::abs(floatAt(cloud, i, "residual"));
        EXPECT_TRUE(moving ? residual > 2.5F : residual < 0.3F) << residual;
      }
    }
    EXPECT_EQ(seen.size(), 45U);
    for (const int id : seen) EXPECT_FALSE(isRefused(id));
  }
}

// Start and end of an odometry that begins at the origin, compared with the truth's displacement.
void expectTrueDisplacement(const std::vector<nav_msgs::OdometryConstPtr>& odometry,
                            const SyntheticDrive& drive, double position_tolerance,
                            double heading_tolerance) {
  ASSERT_GT(odometry.size(), 100U);
  const TrueState start = drive.at(secondsOf(odometry.front()->header.stamp));
  const TrueState end = drive.at(secondsOf(odometry.back()->header.stamp));
  EXPECT_NEAR(yawOf(odometry.front()->pose.pose.orientation), 0.0, 1e-6);
  EXPECT_NEAR(odometry.front()->pose.pose.position.x, 0.0, 1e-6);
  const double dx = end.x - start.x, dy = end.y - start.y;
  EXPECT_NEAR(odometry.back()->pose.pose.position.x, dx * std::cos(start.yaw) + dy * std::sin(start.yaw),
              position_tolerance);
  EXPECT_NEAR(odometry.back()->pose.pose.position.y, dy * std::cos(start.yaw) - dx * std::sin(start.yaw),
              position_tolerance);
  EXPECT_NEAR(angleBetween(yawOf(odometry.back()->pose.pose.orientation), end.yaw - start.yaw), 0.0,
              heading_tolerance);
}

TEST_F(ReplayTest, OdometryFollowsTheTruthInItsFrame) {
  const auto odometry = recording_->odometry.messages();
  ASSERT_GT(odometry.size(), 100U);
  for (const auto& pose : odometry) {
    EXPECT_EQ(pose->header.frame_id, "odom");
    EXPECT_EQ(pose->child_frame_id, "base_link");
    const TrueState truth = drive_.at(secondsOf(pose->header.stamp));
    EXPECT_NEAR(pose->pose.pose.position.x, truth.x, 0.25);
    EXPECT_NEAR(pose->pose.pose.position.y, truth.y, 0.25);
    EXPECT_NEAR(angleBetween(yawOf(pose->pose.pose.orientation), truth.yaw), 0.0, 0.002);
    EXPECT_NEAR(pose->twist.twist.linear.x, truth.speed,
                secondsOf(pose->header.stamp) < kSettled ? 0.3 : 0.05);
  }
}

TEST_F(ReplayTest, OdometryWithTheGyroOfAnImu) {
  expectTrueDisplacement(recording_->by_imu.messages(), drive_, 0.25, 0.005);
}

TEST_F(ReplayTest, OdometryWithTheRotationFromTf) {
  expectTrueDisplacement(recording_->by_tf.messages(), drive_, 0.25, 0.002);
}

TEST_F(ReplayTest, OdometryWithTheYawRateOfTheRadars) {
  expectTrueDisplacement(recording_->by_radar.messages(), drive_, 2.0, 0.03);
}

TEST_F(ReplayTest, PathIsThinnedByDistance) {
  const auto paths = recording_->path.messages();
  ASSERT_FALSE(paths.empty());
  const auto& poses = paths.back()->poses;
  EXPECT_EQ(paths.back()->header.frame_id, "odom");
  ASSERT_GT(poses.size(), 50U);
  EXPECT_LT(poses.size(), recording_->odometry.count() + 1);
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const double step = std::hypot(poses[i].pose.position.x - poses[i - 1].pose.position.x,
                                   poses[i].pose.position.y - poses[i - 1].pose.position.y);
    EXPECT_GE(step, 0.5);
    EXPECT_LT(step, 2.0);
  }
}

TEST_F(ReplayTest, DiagnosticsNameEveryPartAndFindItWell) {
  for (const char* name :
       {"ego_velocity: configuration", "ego_velocity: estimator", "ego_velocity: radar front",
        "ego_velocity: radar front_left", "ego_velocity: radar front_right", "ego_velocity: radar back_left",
        "ego_velocity: radar back_right", "odometry: odometry", "odometry: rotation"}) {
    EXPECT_TRUE(recording_->diagnostics.seen(name, diagnostic_msgs::DiagnosticStatus::OK)) << name;
  }
  const Diagnostics::Status radar = recording_->diagnostics.latest("ego_velocity: radar back_left");
  EXPECT_EQ(radar.values.at("topic"), "/radar_back_left");
  EXPECT_EQ(radar.values.at("frame"), "radar_back_left");
  EXPECT_NEAR(std::stod(radar.values.at("rate (Hz)")), 13.0, 0.5);
  EXPECT_GT(std::stod(recording_->diagnostics.latest("odometry: odometry").values.at("distance (m)")), 70.0);
}

}  // namespace
}  // namespace radar_dot::test
