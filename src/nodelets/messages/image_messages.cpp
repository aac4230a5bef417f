// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/messages/image_messages.h"

#include <cv_bridge/cv_bridge.h>
#include <sensor_msgs/image_encodings.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>
#include <string_view>

namespace radar_dot {
namespace {

namespace encodings = sensor_msgs::image_encodings;

/// cv_bridge multiplies the sizes in 32 bits, and takes the other byte order for other types.
void expectSoundBytes(const sensor_msgs::Image& message, const std::string& what) {
  const std::uint64_t bytes = static_cast<std::uint64_t>(message.step) * message.height;
  if (bytes != message.data.size()) {
    throw std::invalid_argument(what + ": it has " + std::to_string(message.data.size()) +
                                " bytes instead of " + std::to_string(bytes) + ", its step times its height");
  }
  if (message.step < message.width) {
    throw std::invalid_argument(what + ": its step of " + std::to_string(message.step) +
                                " bytes is shorter than a row of " + std::to_string(message.width) + " px");
  }
  bool deep = false;
  try {
    constexpr int kByte = 8;
    deep = encodings::bitDepth(message.encoding) > kByte;
  } catch (const std::exception&) {
    return;  // an unknown encoding is refused by its name further on
  }
  if (message.is_bigendian != 0 && deep) {
    throw std::invalid_argument(what + ": its pixels are in the other byte order (is_bigendian)");
  }
}

/// A view into the message. @throws std::invalid_argument where its sizes contradict each other.
cv::Mat viewOf(const sensor_msgs::Image& message, const std::string& what) {
  expectSoundBytes(message, what);
  try {
    // No owner: the caller keeps the message.
    return cv_bridge::toCvShare(message, boost::shared_ptr<const void>())->image;
  } catch (const std::exception& error) {
    throw std::invalid_argument(what + ": " + error.what());
  }
}

void expectEncoding(const sensor_msgs::Image& message, const std::string& encoding, const std::string& what) {
  if (message.encoding == encoding) return;
  throw std::invalid_argument(what + ": its encoding is '" + message.encoding + "', not " + encoding);
}

void expectSize(const sensor_msgs::Image& message, const std::string& what) {
  if (message.width == 0 || message.height == 0) throw std::invalid_argument(what + ": it is empty");
}

/// OpenCV tries its readers of medical and geographic images on anything else, and those end the process
/// where the file is damaged.
void expectPicture(const std::vector<std::uint8_t>& bytes, const std::string& what) {
  using namespace std::string_view_literals;
  const std::string_view begin(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (const std::string_view signature :
       {"\xff\xd8\xff"sv, "\x89PNG\r\n\x1a\n"sv, "BM"sv, "II*\0"sv, "MM\0*"sv})
    if (begin.substr(0, signature.size()) == signature) return;
  throw std::invalid_argument(what + ": its " + std::to_string(bytes.size()) +
                              " bytes cannot be decoded: they begin like no JPEG, PNG, BMP or TIFF file");
}

/// A depth as it is: CV_32FC1 in m or CV_16UC1 in mm.
cv::Mat depthViewOf(const sensor_msgs::Image& message) {
  expectSize(message, "depth");
  if (message.encoding != encodings::TYPE_32FC1 && message.encoding != encodings::TYPE_16UC1 &&
      message.encoding != encodings::MONO16) {
    throw std::invalid_argument("depth: its encoding is '" + message.encoding +
                                "', not 32FC1 (m) or 16UC1 (mm)");
  }
  return viewOf(message, "depth");
}

/// An image that goes with a flow, or nothing.
cv::Mat companionOf(const cv::Mat& flow, const sensor_msgs::Image& message, const std::string& encoding,
                    const std::string& what) {
  if (message.data.empty()) return {};
  expectEncoding(message, encoding, what);
  const cv::Mat image = viewOf(message, what);
  if (image.size() != flow.size()) {
    throw std::invalid_argument(what + " of " + sizeText(image.size()) + " px does not match the flow of " +
                                sizeText(flow.size()) + " px");
  }
  return image;
}

}  // namespace

std::string sizeText(const cv::Size& size) {
  return std::to_string(size.width) + " x " + std::to_string(size.height);
}

cv::Size imageSizeOf(const sensor_msgs::Image& message, const std::string& what) {
  expectSize(message, what);
  expectSoundBytes(message, what);
  return {static_cast<int>(message.width), static_cast<int>(message.height)};
}

bool isGridOf(const cv::Size& grid, const cv::Size& image) {
  if (grid.width <= 0 || grid.height <= 0 || image.width <= 0 || image.height <= 0) return false;
  const double height = static_cast<double>(image.height) * grid.width / image.width;
  // A side may have been rounded, or up to a multiple of 8 by a network.
  return std::abs(height - grid.height) <= std::max(1.0, 0.02 * height);
}

DecodedImage decodedImageOf(const sensor_msgs::ImageConstPtr& message) {
  imageSizeOf(*message, "image");
  const bool grey = message->encoding == encodings::MONO8 || message->encoding == encodings::MONO16;
  try {
    const cv_bridge::CvImageConstPtr converted =
        cv_bridge::toCvShare(message, grey ? encodings::MONO8 : encodings::BGR8);
    return {message->header, converted->image, converted};
  } catch (const std::exception& error) {
    throw std::invalid_argument("image of encoding '" + message->encoding + "': " + error.what());
  }
}

DecodedImage decodedImageOf(const sensor_msgs::CompressedImage& message, int channels) {
  const std::string what = "compressed image of format '" + message.format + "'";
  expectPicture(message.data, what);
  DecodedImage picture;
  picture.header = message.header;
  if (!message.data.empty()) {
    try {
      picture.pixels = cv::imdecode(message.data, channels == 1 ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR);
    } catch (const cv::Exception& error) {
      throw std::invalid_argument(what + ": " + error.what());
    }
  }
  if (picture.pixels.empty()) {
    throw std::invalid_argument(what + ": its " + std::to_string(message.data.size()) +
                                " bytes cannot be decoded");
  }
  return picture;
}

cv::Mat depthOf(const sensor_msgs::Image& message) {
  const cv::Mat depth = depthViewOf(message);
  if (depth.type() == CV_32FC1) return depth;
  cv::Mat metres;
  depth.convertTo(metres, CV_32FC1, 1e-3);
  return metres;
}

sensor_msgs::ImagePtr keptDepth(const sensor_msgs::Image& message, const cv::Mat& keep) {
  auto kept = boost::make_shared<sensor_msgs::Image>(message);
  cv::Mat depth = depthViewOf(*kept);
  depth.setTo(depth.type() == CV_32FC1 ? std::numeric_limits<double>::quiet_NaN() : 0.0, keep == 0);
  return kept;
}

cv::Mat depthStdOf(const sensor_msgs::Image& message) {
  expectSize(message, "depth uncertainty");
  expectEncoding(message, encodings::TYPE_32FC1, "depth uncertainty");
  return viewOf(message, "depth uncertainty");
}

cv::Mat flowImageOf(const sensor_msgs::Image& message) {
  expectSize(message, "flow");
  expectEncoding(message, encodings::TYPE_32FC2, "flow");
  return viewOf(message, "flow");
}

FlowField flowOf(const Flow& message) {
  const cv::Size image(static_cast<int>(message.image_width), static_cast<int>(message.image_height));
  FlowField field;
  field.flow = flowImageOf(message.flow);
  if (!isGridOf(field.flow.size(), image)) {
    throw std::invalid_argument("flow of " + sizeText(field.flow.size()) +
                                " px does not have the shape of its image of " + sizeText(image) + " px");
  }
  field.valid = companionOf(field.flow, message.valid, encodings::MONO8, "valid");
  field.fb_error = companionOf(field.flow, message.fb_error, encodings::TYPE_32FC1, "fb_error");
  return field;
}

sensor_msgs::ImagePtr imageMessage(const std_msgs::Header& header, const std::string& encoding,
                                   const cv::Mat& pixels) {
  return cv_bridge::CvImage(header, encoding, pixels).toImageMsg();
}

FlowPtr flowMessage(const std_msgs::Header& header, const ros::Time& second_stamp, const FlowField& field,
                    const cv::Size& image) {
  auto message = boost::make_shared<Flow>();
  message->header = header;
  message->second_stamp = second_stamp;
  message->image_width = static_cast<std::uint32_t>(image.width);
  message->image_height = static_cast<std::uint32_t>(image.height);
  cv_bridge::CvImage(header, encodings::TYPE_32FC2, field.flow).toImageMsg(message->flow);
  if (!field.valid.empty())
    cv_bridge::CvImage(header, encodings::MONO8, field.valid).toImageMsg(message->valid);
  if (!field.fb_error.empty())
    cv_bridge::CvImage(header, encodings::TYPE_32FC1, field.fb_error).toImageMsg(message->fb_error);
  return message;
}

CameraIntrinsics cameraOf(const sensor_msgs::CameraInfo& message) {
  Eigen::Matrix3d matrix = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(message.K.data());
  if (message.P[0] != 0.0) {
    matrix = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(message.P.data()).leftCols<3>();
  }
  // Pictures of this size are allocated: more than any camera has is a message that is damaged.
  constexpr std::uint32_t kLargest = 1U << 14U;
  if (std::max(message.width, message.height) > kLargest) {
    throw std::invalid_argument("camera_info: its size of " + std::to_string(message.width) + " x " +
                                std::to_string(message.height) + " px is beyond " + std::to_string(kLargest));
  }
  try {
    return CameraIntrinsics::fromMatrix(matrix, static_cast<int>(message.width),
                                        static_cast<int>(message.height));
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string("camera_info: ") + error.what());
  }
}

bool isDistorted(const sensor_msgs::CameraInfo& message) {
  return message.P[0] == 0.0 &&
         std::any_of(message.D.begin(), message.D.end(), [](double d) { return d != 0.0; });
}

}  // namespace radar_dot
