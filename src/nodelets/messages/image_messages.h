// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sensor_msgs/CameraInfo.h>
#include <sensor_msgs/CompressedImage.h>
#include <sensor_msgs/Image.h>

#include <boost/make_shared.hpp>
#include <boost/shared_ptr.hpp>
#include <opencv2/core/mat.hpp>

#include "radar_dot/Flow.h"
#include "radar_dot/vision/camera_intrinsics.h"
#include "radar_dot/vision/optical_flow.h"

/// Between messages and images. Images that share memory with a message hold on to it by the pointer given
/// beside them. Everything throws std::invalid_argument that names the field and what was expected.
namespace radar_dot {

/// Channels of a picture.
constexpr int kGrey = 1, kColour = 3;

/// A picture and the message its pixels belong to (none where they are its own).
struct DecodedImage {
  std_msgs::Header header;
  cv::Mat pixels;  ///< CV_8UC3 (BGR) or CV_8UC1; not to be written to
  boost::shared_ptr<const void> owner;
};

/// A picture of 16 bits with 8, others as they are. Drivers put the 10 or 12 bits of a sensor into the lower
/// ones of the 16: what was the largest value of a stream tells how many there are.
/// @param bits  that the pixels of the stream have been seen to use, 8 before the first
sensor_msgs::ImageConstPtr withEightBits(const sensor_msgs::ImageConstPtr& message, int& bits);

/// Without a copy where the encoding is bgr8 or mono8 already, or 8UC3 or 8UC1, which are the same.
DecodedImage decodedImageOf(const sensor_msgs::ImageConstPtr& message);
/// Decoded. @param channels   kGrey, which is quicker, or kColour
///          @param reduction  1, 2, 4 or 8 times as small, rounded up; much quicker for JPEG
DecodedImage decodedImageOf(const sensor_msgs::CompressedImage& message, int channels, int reduction = 1);

/// Depth in m, CV_32FC1: of encoding 32FC1 (m, shared with the message) or 16UC1 (mm, 0 = unknown).
cv::Mat depthOf(const sensor_msgs::Image& message);

/// The same depth, byte for byte, unknown where `keep` is 0: NaN in 32FC1, 0 in 16UC1.
/// @param keep  CV_8UC1 of its size
sensor_msgs::ImagePtr keptDepth(const sensor_msgs::Image& message, const cv::Mat& keep);

/// Uncertainty of a depth, relative, of its inverse: CV_32FC1, of encoding 32FC1, shared with the message.
cv::Mat depthStdOf(const sensor_msgs::Image& message);

/// Flow without the rest, as on dynamic/expected_flow: CV_32FC2, shared with the message.
cv::Mat flowImageOf(const sensor_msgs::Image& message);

/// The flow's grid, shared with the message.
FlowField flowOf(const Flow& message);

/// @param field  on any grid of the image's shape   @param image  px, size of the images
FlowPtr flowMessage(const std_msgs::Header& header, const ros::Time& second_stamp, const FlowField& field,
                    const cv::Size& image);
sensor_msgs::ImagePtr imageMessage(const std_msgs::Header& header, const std::string& encoding,
                                   const cv::Mat& pixels);

/// The camera of rectified images: the projection matrix P where it is given, else K. Its size is that of the
/// images that are sent: of the region of interest, binned.
CameraIntrinsics cameraOf(const sensor_msgs::CameraInfo& message);
/// Why the images are probably not rectified: there is distortion, and P is not given, or K once more. Empty:
/// no doubt.
std::string distortionDoubt(const sensor_msgs::CameraInfo& message);

/// Of a raw image whose bytes are there. @throws std::invalid_argument that starts with `what`, if not
cv::Size imageSizeOf(const sensor_msgs::Image& message, const std::string& what);

/// True where a grid has the shape of an image, within the rounding of its sides.
bool isGridOf(const cv::Size& grid, const cv::Size& image);
/// "800 x 450"
std::string sizeText(const cv::Size& size);

}  // namespace radar_dot
