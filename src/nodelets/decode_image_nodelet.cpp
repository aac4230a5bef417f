// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <pluginlib/class_list_macros.hpp>

#include "nodelets/common/stream_nodelet.h"

namespace radar_dot {

/// Decodes `image/compressed` once, so that everything in the manager shares one `image`.
class DecodeImageNodelet : public ConfiguredNodelet<StreamParams> {
 private:
  void setUp() override {
    describe("decoder", config_);
    publisher_ = getNodeHandle().advertise<sensor_msgs::Image>("image", 2);
    watchImages(*listenAs<sensor_msgs::CompressedImage>(
        "input image", std::make_unique<InputMonitor>("image", expectation(), true), "image/compressed", 1,
        [this](const sensor_msgs::CompressedImageConstPtr& image) { decode(*image); }));
  }
  bool hasAudience() const override { return publisher_.getNumSubscribers() > 0; }

  void decode(const sensor_msgs::CompressedImage& message) {
    const ros::WallTime start = ProcessClock::now();
    const DecodedImage picture = decodedImageOf(message, kColour);
    publisher_.publish(imageMessage(message.header, "bgr8", picture.pixels));
    computation_time_ = (ProcessClock::now() - start).toSec();
    ++decoded_;
  }

  void clearHistory() override {}
  void report(diagnostic_updater::DiagnosticStatusWrapper& status) override {
    status.summary(diagnostic_msgs::DiagnosticStatus::OK, "decoding");
    status.addf("computation time (ms)", "%.1f", 1e3 * computation_time_);
    status.addf("images decoded", "%zu", decoded_);
  }

  ros::Publisher publisher_;
  double computation_time_ = 0.0;  // s, of the latest image
  std::size_t decoded_ = 0;
};

}  // namespace radar_dot

PLUGINLIB_EXPORT_CLASS(radar_dot::DecodeImageNodelet, nodelet::Nodelet)
