// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/messages/image_messages.h"

#include <cv_bridge/cv_bridge.h>
#include <fmt/format.h>
#include <sensor_msgs/image_encodings.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <stdexcept>

#include "radar_dot/common/image_fault.h"

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

bool isGrey(const sensor_msgs::Image& message) {
  return message.encoding == encodings::MONO8 || message.encoding == encodings::MONO16;
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
  cv::Mat image = viewOf(message, what);
  if (image.size() != flow.size()) {
    throw std::invalid_argument(what + " of " + sizeText(image.size()) + " px does not match the flow of " +
                                sizeText(flow.size()) + " px");
  }
  return image;
}

/// As cv_bridge, which clears the bytes before it copies them.
void fill(sensor_msgs::Image& message, const std_msgs::Header& header, const std::string& encoding,
          const cv::Mat& pixels) {
  const cv::Mat packed = pixels.isContinuous() ? pixels : pixels.clone();
  message.header = header;
  message.height = static_cast<std::uint32_t>(packed.rows);
  message.width = static_cast<std::uint32_t>(packed.cols);
  message.encoding = encoding;
  const std::size_t step = packed.elemSize() * static_cast<std::size_t>(packed.cols);
  message.step = static_cast<std::uint32_t>(step);
  message.data.assign(packed.data, packed.data + step * message.height);
}

/// The camera of the pixels that are sent: those of the region of interest, `binning` of them in one.
/// A region of no size is the whole image, a binning of 0 is 1. Rectified images keep the region of the raw
/// ones, as image_proc does, whatever do_rectify says.
/// @throws std::invalid_argument for a region beyond the image, or one that leaves no pixel
CameraIntrinsics takenPartOf(CameraIntrinsics camera, const sensor_msgs::CameraInfo& message) {
  const sensor_msgs::RegionOfInterest& roi = message.roi;
  if (roi.width > 0 && roi.height > 0) {
    if (std::uint64_t{roi.x_offset} + roi.width > message.width ||
        std::uint64_t{roi.y_offset} + roi.height > message.height) {
      throw std::invalid_argument(
          fmt::format("its roi of {} x {} px at {}, {} reaches beyond its image of {} x {} px", roi.width,
                      roi.height, roi.x_offset, roi.y_offset, message.width, message.height));
    }
    camera.cx -= roi.x_offset;
    camera.cy -= roi.y_offset;
    camera.width = static_cast<int>(roi.width);
    camera.height = static_cast<int>(roi.height);
  }
  const double across = std::max(1U, message.binning_x), down = std::max(1U, message.binning_y);
  camera = {camera.fx / across,
            camera.fy / down,
            (camera.cx + 0.5) / across - 0.5,
            (camera.cy + 0.5) / down - 0.5,
            static_cast<int>(camera.width / across),
            static_cast<int>(camera.height / down)};
  if (camera.width == 0 || camera.height == 0)
    throw std::invalid_argument(fmt::format("its binning of {:g} x {:g} leaves no pixel", across, down));
  return camera;
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

sensor_msgs::ImageConstPtr withEightBits(const sensor_msgs::ImageConstPtr& message, int& bits) {
  constexpr int kByte = 8, kWord = 16;
  const std::string& encoding = message->encoding;
  const bool is_deep = encoding.find("16") != std::string::npos && encoding != encodings::TYPE_16UC1;
  if (!is_deep) return message;
  imageSizeOf(*message, "image");
  const bool is_grey = isGrey(*message);
  cv::Mat pixels, narrow;
  try {
    pixels = cv_bridge::toCvShare(message, is_grey ? encodings::MONO16 : encodings::BGR16)->image;
  } catch (const std::exception&) {
    return message;  // refused by whoever asks for its pixels
  }
  double most = 0.0;
  cv::minMaxLoc(pixels.reshape(1), nullptr, &most);
  while (bits < kWord && most >= 1 << bits) bits += 2;
  pixels.convertTo(narrow, CV_8U, 1.0 / (1 << (bits - kByte)));
  return imageMessage(message->header, is_grey ? encodings::MONO8 : encodings::BGR8, narrow);
}

DecodedImage decodedImageOf(const sensor_msgs::ImageConstPtr& message) {
  imageSizeOf(*message, "image");
  const std::string& encoding = message->encoding;
  const std::string& wanted = isGrey(*message) ? encodings::MONO8 : encodings::BGR8;
  // OpenCV's own names say nothing of colours: theirs are grey, and blue first.
  const bool is_plain = encoding == encodings::TYPE_8UC1 || encoding == encodings::TYPE_8UC3;
  try {
    const cv_bridge::CvImageConstPtr converted =
        is_plain ? cv_bridge::toCvShare(message) : cv_bridge::toCvShare(message, wanted);
    return {message->header, converted->image, converted};
  } catch (const std::exception& error) {
    throw std::invalid_argument("image of encoding '" + encoding + "': " + error.what() +
                                "; send mono8, mono16, rgb8, bgr8, bayer_* or yuv422");
  }
}

DecodedImage decodedImageOf(const sensor_msgs::CompressedImage& message, int channels, int reduction) {
  const std::string what = "compressed image of format '" + message.format + "'";
  DecodedImage picture;
  picture.header = message.header;
  const std::string fault = imageFault(message.data);
  if (fault.empty()) {
    try {
      // The flags of the reductions are powers of two as well.
      const int reduced = reduction > 1 ? cv::IMREAD_REDUCED_GRAYSCALE_2 * reduction / 2 : 0;
      picture.pixels =
          cv::imdecode(message.data, reduced | (channels == 1 ? cv::IMREAD_GRAYSCALE : cv::IMREAD_COLOR));
    } catch (const cv::Exception& error) {
      throw std::invalid_argument(what + ": " + error.what());
    }
  }
  if (picture.pixels.empty()) {
    throw std::invalid_argument(what + ": its " + std::to_string(message.data.size()) +
                                " bytes cannot be decoded" + (fault.empty() ? "" : ": " + fault));
  }
  return picture;
}

cv::Mat depthOf(const sensor_msgs::Image& message) {
  cv::Mat depth = depthViewOf(message);
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
  field.grey = companionOf(field.flow, message.grey, encodings::MONO8, "grey");
  field.second_grey = companionOf(field.flow, message.second_grey, encodings::MONO8, "second_grey");
  return field;
}

sensor_msgs::ImagePtr imageMessage(const std_msgs::Header& header, const std::string& encoding,
                                   const cv::Mat& pixels) {
  auto message = boost::make_shared<sensor_msgs::Image>();
  fill(*message, header, encoding, pixels);
  return message;
}

FlowPtr flowMessage(const std_msgs::Header& header, const ros::Time& second_stamp, const FlowField& field,
                    const cv::Size& image) {
  auto message = boost::make_shared<Flow>();
  message->header = header;
  message->second_stamp = second_stamp;
  message->image_width = static_cast<std::uint32_t>(image.width);
  message->image_height = static_cast<std::uint32_t>(image.height);
  fill(message->flow, header, encodings::TYPE_32FC2, field.flow);
  if (!field.valid.empty()) fill(message->valid, header, encodings::MONO8, field.valid);
  if (!field.fb_error.empty()) fill(message->fb_error, header, encodings::TYPE_32FC1, field.fb_error);
  if (!field.grey.empty()) fill(message->grey, header, encodings::MONO8, field.grey);
  if (!field.second_grey.empty()) fill(message->second_grey, header, encodings::MONO8, field.second_grey);
  return message;
}

CameraIntrinsics cameraOf(const sensor_msgs::CameraInfo& message) {
  Eigen::Matrix3d matrix = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(message.K.data());
  if (message.P[0] != 0.0) {
    matrix = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(message.P.data()).leftCols<3>();
  }
  // Pictures of this size are allocated: more than any camera has is a message that is damaged.
  constexpr std::uint32_t kLargest = 1U << 14U;
  constexpr double kNarrowest = 1e4, kWidest = 1e-2;  // focal lengths over the larger side
  constexpr double kFarthest = 1e2;                   // of the principal point, of the larger side
  if (std::max(message.width, message.height) > kLargest) {
    throw std::invalid_argument("camera_info: its size of " + std::to_string(message.width) + " x " +
                                std::to_string(message.height) + " px is beyond " + std::to_string(kLargest));
  }
  try {
    const CameraIntrinsics whole = CameraIntrinsics::fromMatrix(matrix, static_cast<int>(message.width),
                                                                static_cast<int>(message.height));
    const double side = std::max(whole.width, whole.height);
    if (std::min(whole.fx, whole.fy) < kWidest * side || std::max(whole.fx, whole.fy) > kNarrowest * side ||
        std::max(std::abs(whole.cx), std::abs(whole.cy)) > kFarthest * side) {
      throw std::invalid_argument(fmt::format(
          "focal lengths of {:g} and {:g} px and a principal point at {:g}, {:g} px are of no image of "
          "{} x {} px",
          whole.fx, whole.fy, whole.cx, whole.cy, whole.width, whole.height));
    }
    return takenPartOf(whole, message);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(std::string("camera_info: ") + error.what() +
                                (matrix.isZero() ? ": its driver has no calibration" : ""));
  }
}

std::string distortionDoubt(const sensor_msgs::CameraInfo& message) {
  if (std::all_of(message.D.begin(), message.D.end(), [](double d) { return d == 0.0; })) return {};
  const auto& K = message.K;
  const auto& P = message.P;
  const bool same = P[0] == K[0] && P[2] == K[2] && P[5] == K[4] && P[6] == K[5];
  if (P[0] != 0.0 && !same) return {};
  return std::string("it has distortion (D) and ") + (same ? "a P that is K" : "no P") +
         ", as drivers send it with raw images: the images must be rectified (image_proc); of images that "
         "are, D is zero";
}

}  // namespace radar_dot
