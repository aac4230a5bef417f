// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// Plays a simulated drive through everything at its own speed: are the masks right, do they keep up, and how
// long do they take? The latency is printed and not judged: the machine may be busy.
#include <gtest/gtest.h>
#include <nav_msgs/Odometry.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <map>
#include <mutex>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "fixtures/files.h"
#include "live_graph.h"
#include "simulated_bag.h"
#include "vision_world.h"

namespace radar_dot::test {
namespace {

namespace fs = std::filesystem;
using sensor_msgs::CompressedImage;
using sensor_msgs::Image;

/// Arrival of every mask by its stamp, s of the replay's clock.
class Arrivals {
 public:
  explicit Arrivals(ros::NodeHandle& handle)
      : subscriber_(
            handle.subscribe<Image>("dynamic/mask", 100, [this](const sensor_msgs::ImageConstPtr& mask) {
              const std::lock_guard<std::mutex> lock(mutex_);
              arrivals_[mask->header.stamp] = ros::Time::now();
            })) {}
  std::map<ros::Time, ros::Time> all() const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return arrivals_;
  }

 private:
  mutable std::mutex mutex_;
  std::map<ros::Time, ros::Time> arrivals_;
  ros::Subscriber subscriber_;
};

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

/// Overlap of the masks with the annotated ones, over all pixels.
double overallIou(const std::vector<boost::shared_ptr<const Image>>& masks,
                  const std::vector<boost::shared_ptr<const CompressedImage>>& truths,
                  std::size_t& compared) {
  double both = 0.0, either = 0.0;
  compared = 0;
  for (const auto& truth : truths) {
    for (const auto& mask : masks) {
      if (mask->header.stamp != truth->header.stamp) continue;
      const cv::Mat actual = cv::imdecode(truth->data, cv::IMREAD_GRAYSCALE) != 0;
      const cv::Mat predicted = matOf(*mask, CV_8UC1) != 0;
      EXPECT_EQ(predicted.size(), actual.size());
      both += cv::countNonZero(predicted & actual);
      either += cv::countNonZero(predicted | actual);
      ++compared;
    }
  }
  return either > 0.0 ? both / either : 0.0;
}

TEST(SegmentationReplay, MasksAreRightAndKeepUp) {
  const TemporaryFolder folder;
  // The vehicle stands, traffic crosses: the largest masks of all scenarios.
  const fs::path bag = simulatedBag(folder.path(), "scene-0006", "--scenarios standing --duration 4");
  ASSERT_TRUE(fs::exists(bag));

  ros::NodeHandle handle;
  const Recorder<Image> masks(handle, "dynamic/mask");
  const Recorder<CompressedImage> truths(handle, "ground_truth/dynamic_mask/compressed");
  const Recorder<CompressedImage> images(handle, "cam_front/image/compressed");
  const Recorder<nav_msgs::Odometry> odometry(handle, "odom");
  const Arrivals arrivals(handle);
  Diagnostics diagnostics(handle);
  ASSERT_TRUE(waitUntil([&] { return masks.connected() && odometry.connected(); }));

  BagPlayer player({"--clock", "--delay=2", bag.string()});
  ASSERT_EQ(player.wait(120.0), 0);
  const std::size_t pairs = images.count() - 1;
  // The last pair may still be under way.
  waitUntil([&] { return masks.count() >= pairs; }, 3.0);

  // A pair is left out where the machine is busy, but the masks do not fall behind.
  EXPECT_GE(masks.count(), pairs / 2);
  EXPECT_LE(masks.count(), pairs);
  std::vector<double> latencies;
  std::map<ros::Time, ros::Time> next;  // stamp of the image after each one
  const auto sent = images.messages();
  for (std::size_t i = 0; i + 1 < sent.size(); ++i) next[sent[i]->header.stamp] = sent[i + 1]->header.stamp;
  for (const auto& [stamp, arrival] : arrivals.all()) {
    ASSERT_EQ(next.count(stamp), 1U) << "a mask without an image";
    latencies.push_back((arrival - next[stamp]).toSec());
  }
  ASSERT_FALSE(latencies.empty());
  std::cout << "masks: " << masks.count() << " of " << pairs
            << " pairs; latency from the stamp of the later image: median "
            << 1e3 * percentile(latencies, 0.5) << " ms, 95 % " << 1e3 * percentile(latencies, 0.95)
            << " ms\n";
  // Into the test's result file, where scripts/test finds it.
  RecordProperty("masks", static_cast<int>(masks.count()));
  RecordProperty("pairs", static_cast<int>(pairs));
  RecordProperty("latency_median_ms", static_cast<int>(1e3 * percentile(latencies, 0.5)));
  RecordProperty("latency_95_percent_ms", static_cast<int>(1e3 * percentile(latencies, 0.95)));
  const auto half = static_cast<std::ptrdiff_t>(latencies.size() / 2);
  const double early = percentile({latencies.begin(), latencies.begin() + half}, 0.5);
  const double late = percentile({latencies.begin() + half, latencies.end()}, 0.5);
  EXPECT_LT(late - early, 0.5) << "a queue grows";

  std::size_t compared = 0;
  const double iou = overallIou(masks.messages(), truths.messages(), compared);
  std::cout << "IoU over " << compared << " annotated images: " << iou << '\n';
  RecordProperty("iou_percent", static_cast<int>(100.0 * iou));
  EXPECT_GE(compared, truths.count() / 2);
  EXPECT_GT(iou, 0.38);  // 0.46, where no pair is dropped
  EXPECT_GT(odometry.count(), 30U);
  // Before the drive begins they rightly miss their input.
  EXPECT_FALSE(diagnostics.seen("decode_image: decoder", diagnostic_msgs::DiagnosticStatus::ERROR));
}

}  // namespace
}  // namespace radar_dot::test
