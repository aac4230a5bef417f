// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "nodelets/common/stream_nodelet.h"
#include "nodelets/messages/image_messages.h"

namespace radar_dot {

/// A picture that is decoded or converted only when its pixels are asked for.
class LazyImage {
 public:
  explicit LazyImage(sensor_msgs::ImageConstPtr raw) : raw_(std::move(raw)) {}
  explicit LazyImage(sensor_msgs::CompressedImageConstPtr compressed) : compressed_(std::move(compressed)) {}

  const std_msgs::Header& header() const { return raw_ ? raw_->header : compressed_->header; }
  /// @throws std::invalid_argument as decodedImageOf()
  const cv::Mat& pixels() {
    if (!picture_.pixels.empty()) return picture_.pixels;
    constexpr int kColour = 3;
    picture_ = raw_ ? decodedImageOf(raw_) : decodedImageOf(*compressed_, kColour);
    return picture_.pixels;
  }

 private:
  sensor_msgs::ImageConstPtr raw_;
  sensor_msgs::CompressedImageConstPtr compressed_;
  DecodedImage picture_;
};

/// `image` as raw messages, or as compressed ones of `image/compressed`, by the private parameter
/// image_transport (raw, compressed).
class ImageSubscriber : public StreamNodelet {
 protected:
  /// Reports an image_transport that there is not; raw ones are taken then.
  void checkTransport() {
    const auto transport = getPrivateNodeHandle().param<std::string>("image_transport", "raw");
    if (transport != "raw" && transport != "compressed") {
      reportProblem("image_transport '" + transport + "' is not one of raw, compressed; using raw");
    }
  }
  ros::Subscriber listenToImages(InputMonitor& input, std::uint32_t queue_size,
                                 const std::function<void(LazyImage)>& body) {
    const auto transport = getPrivateNodeHandle().param<std::string>("image_transport", "raw");
    if (transport == "compressed") {
      return listen<sensor_msgs::CompressedImage>(
          input, "image/compressed", queue_size,
          [body](const sensor_msgs::CompressedImageConstPtr& image) { body(LazyImage(image)); });
    }
    return listen<sensor_msgs::Image>(
        input, "image", queue_size,
        [body](const sensor_msgs::ImageConstPtr& image) { body(LazyImage(image)); });
  }
};

}  // namespace radar_dot
