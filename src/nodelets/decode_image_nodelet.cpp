// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <pluginlib/class_list_macros.hpp>

#include "nodelets/common/stream_nodelet.h"
#include "nodelets/messages/image_messages.h"

namespace radar_dot {

/// Decodes `image/compressed` once, so that everything in the manager shares one `image`.
class DecodeImageNodelet : public StreamNodelet {
 private:
  void onInit() override {
    const GivenConfig<StreamParams> given = readConfig<StreamParams>(getPrivateNodeHandle());
    setUp("decoder", given.config);
    for (const std::string& line : given.problems.lines) noteProblem(line);
    publisher_ = getNodeHandle().advertise<sensor_msgs::Image>("image", 2);
    input_ = &addInput("image");
    connectWhile([this] { return publisher_.getNumSubscribers() > 0; },
                 [this] {
                   subscriber_ = listen<sensor_msgs::CompressedImage>(
                       *input_, "image/compressed", 1,
                       [this](const sensor_msgs::CompressedImageConstPtr& image) { decode(*image); });
                 },
                 [this] { stop(*input_, subscriber_); });
  }

  void decode(const sensor_msgs::CompressedImage& message) {
    constexpr int kColour = 3;
    const DecodedImage picture = decodedImageOf(message, kColour);
    publisher_.publish(imageMessage(message.header, "bgr8", picture.pixels));
    ++decoded_;
  }

  void clearHistory() override {}
  void report(diagnostic_updater::DiagnosticStatusWrapper& status) override {
    status.summary(diagnostic_msgs::DiagnosticStatus::OK, connected() ? "decoding" : "idle: no subscribers");
    status.addf("images decoded", "%zu", decoded_);
  }

  ros::Publisher publisher_;
  ros::Subscriber subscriber_;
  InputMonitor* input_ = nullptr;
  std::size_t decoded_ = 0;
};

}  // namespace radar_dot

PLUGINLIB_EXPORT_CLASS(radar_dot::DecodeImageNodelet, nodelet::Nodelet)
