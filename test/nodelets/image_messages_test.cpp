// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/messages/image_messages.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <boost/weak_ptr.hpp>
#include <cmath>
#include <cstring>
#include <limits>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "fixtures/refusal.h"
#include "nodelets/messages/lazy_image.h"

namespace radar_dot {
namespace {

using test::expectRefusal;

// Rows are padded by 4 bytes, as some drivers do; byte i of the data is i.
sensor_msgs::ImagePtr imageOf(const std::string& encoding, std::uint32_t pixel_bytes, std::uint32_t width = 4,
                              std::uint32_t height = 3) {
  auto message = boost::make_shared<sensor_msgs::Image>();
  message->header.frame_id = "camera";
  message->header.stamp = ros::Time(12, 34);
  message->encoding = encoding;
  message->width = width;
  message->height = height;
  message->step = width * pixel_bytes + 4;
  message->data.resize(std::size_t{message->step} * height);
  for (std::size_t i = 0; i < message->data.size(); ++i) message->data[i] = static_cast<std::uint8_t>(i);
  return message;
}

template <typename Scalar>
void setPixel(sensor_msgs::Image& message, int row, int column, Scalar value) {
  const std::size_t offset =
      static_cast<std::size_t>(row) * message.step + static_cast<std::size_t>(column) * sizeof value;
  std::memcpy(&message.data[offset], &value, sizeof value);
}

// On the grid 16 x 9, every pixel different, one unknown.
FlowField flowField() {
  FlowField field;
  field.flow.create(9, 16, CV_32FC2);
  for (int row = 0; row < 9; ++row)
    for (int column = 0; column < 16; ++column)
      field.flow.at<cv::Vec2f>(row, column) = {0.25F * static_cast<float>(column),
                                               -1.5F * static_cast<float>(row)};
  field.flow.at<cv::Vec2f>(2, 3)[0] = std::numeric_limits<float>::quiet_NaN();
  return field;
}

bool equalBytes(const cv::Mat& a, const cv::Mat& b) {
  if (a.size() != b.size() || a.type() != b.type()) return false;
  for (int row = 0; row < a.rows; ++row)
    if (std::memcmp(a.ptr(row), b.ptr(row), static_cast<std::size_t>(a.cols) * a.elemSize()) != 0)
      return false;
  return true;
}

TEST(PictureOf, SharesBgrAndGreyWithTheMessageAndKeepsIt) {
  for (const auto& [encoding, channels] : {std::pair<const char*, int>{"bgr8", 3}, {"mono8", 1}}) {
    sensor_msgs::ImageConstPtr message = imageOf(encoding, static_cast<std::uint32_t>(channels));
    const boost::weak_ptr<const sensor_msgs::Image> watched = message;
    DecodedImage picture = decodedImageOf(message);
    EXPECT_EQ(picture.pixels.data, message->data.data()) << "it was copied";
    EXPECT_EQ(picture.pixels.type(), CV_8UC(channels));
    EXPECT_EQ(picture.pixels.size(), cv::Size(4, 3));
    EXPECT_EQ(picture.pixels.ptr(2)[1], static_cast<std::uint8_t>(2 * message->step + 1)) << "padded rows";
    EXPECT_EQ(picture.header.frame_id, "camera");
    EXPECT_EQ(picture.header.stamp, ros::Time(12, 34));
    message.reset();
    EXPECT_FALSE(watched.expired()) << "the pixels would dangle";
    picture = {};
    EXPECT_TRUE(watched.expired()) << "a picture let go must not keep its message";
  }
}

TEST(PictureOf, ConvertsOtherOrdersOfChannels) {
  const sensor_msgs::ImageConstPtr rgb = imageOf("rgb8", 3);
  const DecodedImage picture = decodedImageOf(rgb);
  ASSERT_EQ(picture.pixels.type(), CV_8UC3);
  EXPECT_EQ(picture.pixels.at<cv::Vec3b>(0, 0), cv::Vec3b(2, 1, 0));
  EXPECT_EQ(picture.pixels.at<cv::Vec3b>(1, 1), cv::Vec3b(16 + 5, 16 + 4, 16 + 3));
  EXPECT_EQ(rgb->data[0], 0) << "the message belongs to others as well";
  EXPECT_EQ(picture.header.stamp, ros::Time(12, 34));

  EXPECT_EQ(decodedImageOf(sensor_msgs::ImageConstPtr(imageOf("bgra8", 4))).pixels.at<cv::Vec3b>(0, 1),
            cv::Vec3b(4, 5, 6));
}

sensor_msgs::ImageConstPtr messageOf(const std::string& encoding, const cv::Mat& pixels) {
  return imageMessage({}, encoding, pixels);
}

TEST(PictureOf, TakesOpenCvsNamesForGreyAndBgr) {
  for (const auto& [encoding, channels] : {std::pair<const char*, int>{"8UC3", 3}, {"8UC1", 1}}) {
    const sensor_msgs::ImageConstPtr message = imageOf(encoding, static_cast<std::uint32_t>(channels));
    const DecodedImage picture = decodedImageOf(message);
    EXPECT_EQ(picture.pixels.type(), CV_8UC(channels));
    EXPECT_EQ(picture.pixels.data, message->data.data()) << "it was copied";
  }
}

TEST(PictureOf, ConvertsMosaicsAndLuminances) {
  cv::Mat red(8, 8, CV_8UC1, cv::Scalar(0));
  for (int row = 0; row < 8; row += 2)
    for (int column = 0; column < 8; column += 2) red.at<std::uint8_t>(row, column) = 200;
  EXPECT_EQ(decodedImageOf(messageOf("bayer_rggb8", red)).pixels.at<cv::Vec3b>(4, 4), cv::Vec3b(0, 0, 200));
  EXPECT_EQ(decodedImageOf(messageOf("bayer_bggr8", red)).pixels.at<cv::Vec3b>(4, 4), cv::Vec3b(200, 0, 0));
  // Without colour; luminance 16 is black, 235 is white.
  const cv::Mat yuv(4, 4, CV_8UC2, cv::Scalar(128, 126));
  const auto pixel = decodedImageOf(messageOf("yuv422", yuv)).pixels.at<cv::Vec3b>(1, 1);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(pixel[i], 255.0 * (126 - 16) / (235 - 16), 1.0);
}

TEST(WithEightBits, FindsThoseThatAreUsed) {
  cv::Mat ramp(1, 256, CV_16UC1);
  for (int i = 0; i < 256; ++i) ramp.at<std::uint16_t>(i) = static_cast<std::uint16_t>(i);
  for (const int used : {10, 12, 14, 16}) {
    int bits = 8;
    const cv::Mat shifted = ramp * (1 << (used - 8));
    const auto message = withEightBits(messageOf("mono16", shifted), bits);
    EXPECT_EQ(bits, used);
    const cv::Mat pixels = decodedImageOf(message).pixels;
    for (int i = 0; i < 256; ++i) ASSERT_EQ(pixels.at<std::uint8_t>(i), i) << used << " bits";
    // A dark image of the stream stays dark.
    const cv::Mat dark = shifted / 16;
    EXPECT_EQ(decodedImageOf(withEightBits(messageOf("mono16", dark), bits)).pixels.at<std::uint8_t>(255),
              16);
  }
}

TEST(WithEightBits, KeepsColours) {
  int bits = 8;
  const cv::Mat rgb(4, 4, CV_16UC3, cv::Scalar(4080, 1600, 160));
  EXPECT_EQ(decodedImageOf(withEightBits(messageOf("rgb16", rgb), bits)).pixels.at<cv::Vec3b>(0, 0),
            cv::Vec3b(10, 100, 255));
  const cv::Mat grey(8, 8, CV_16UC1, cv::Scalar(1600));
  EXPECT_EQ(decodedImageOf(withEightBits(messageOf("bayer_rggb16", grey), bits)).pixels.at<cv::Vec3b>(4, 4),
            cv::Vec3b(100, 100, 100));
  for (const char* encoding : {"mono8", "bgr8", "8UC3", "16UC1", "32FC1"}) {
    const sensor_msgs::ImageConstPtr message = imageOf(encoding, 4);
    EXPECT_EQ(withEightBits(message, bits), message) << encoding;
  }
}

TEST(PictureOf, DeepGreyStaysGreyOverTheWholeRange) {
  const sensor_msgs::ImagePtr message = imageOf("mono16", 2);
  setPixel<std::uint16_t>(*message, 0, 0, 0);
  setPixel<std::uint16_t>(*message, 0, 1, 65535);
  const DecodedImage picture = decodedImageOf(sensor_msgs::ImageConstPtr(message));
  ASSERT_EQ(picture.pixels.type(), CV_8UC1);
  EXPECT_EQ(picture.pixels.at<std::uint8_t>(0, 0), 0);
  EXPECT_EQ(picture.pixels.at<std::uint8_t>(0, 1), 255);
}

TEST(PictureOf, RefusesWhatIsNoPictureByItsEncoding) {
  for (const char* encoding : {"yuv9000", "", "32FC1", "16UC1"}) {
    expectRefusal([&] { decodedImageOf(sensor_msgs::ImageConstPtr(imageOf(encoding, 4))); },
                  {"encoding '" + std::string(encoding) + "'", "send mono8"});
  }
}

TEST(PictureOf, RefusesSizesThatContradictTheData) {
  const auto picture = [](auto change) {
    const sensor_msgs::ImagePtr message = imageOf("bgr8", 3);
    change(*message);
    return decodedImageOf(sensor_msgs::ImageConstPtr(message));
  };
  EXPECT_NO_THROW(picture([](auto&) {}));
  EXPECT_THROW(picture([](auto& message) { message.data.pop_back(); }), std::invalid_argument);
  EXPECT_THROW(picture([](auto& message) { message.data.clear(); }), std::invalid_argument);
  EXPECT_THROW(picture([](auto& message) { ++message.height; }), std::invalid_argument);
  EXPECT_THROW(picture([](auto& message) { message.width = 100; }), std::invalid_argument)
      << "its step is that of 5 pixels";
  expectRefusal([&] { picture([](auto& message) { message.width = 0; }); }, {"empty"});
  expectRefusal([&] { picture([](auto& message) { message.height = 0; }); }, {"empty"});
}

// In 32 bits, step times height is the 65536 bytes that are there.
TEST(PictureOf, RefusesSizesWhoseProductOverflows) {
  sensor_msgs::Image message;
  message.width = 100;
  message.step = 65536;
  message.height = 65537;
  message.data.resize(65536);
  message.encoding = "mono8";
  EXPECT_THROW(decodedImageOf(boost::make_shared<const sensor_msgs::Image>(message)), std::invalid_argument);
  message.encoding = "32FC1";
  EXPECT_THROW(depthOf(message), std::invalid_argument);
  message.encoding = "32FC2";
  EXPECT_THROW(flowImageOf(message), std::invalid_argument);
}

TEST(PictureOf, ByteOrderMattersOnlyToDeepPixels) {
  const sensor_msgs::ImagePtr shallow = imageOf("bgr8", 3), deep = imageOf("mono16", 2);
  shallow->is_bigendian = deep->is_bigendian = 1;
  const DecodedImage picture = decodedImageOf(sensor_msgs::ImageConstPtr(shallow));
  ASSERT_EQ(picture.pixels.type(), CV_8UC3);
  EXPECT_EQ(picture.pixels.at<cv::Vec3b>(1, 1), cv::Vec3b(16 + 3, 16 + 4, 16 + 5));
  expectRefusal([&] { decodedImageOf(sensor_msgs::ImageConstPtr(deep)); }, {"byte order"});
}

// Flat colours, so that JPEG leaves them nearly as they are.
sensor_msgs::CompressedImage compressed(const std::string& format, const cv::Scalar& colour) {
  sensor_msgs::CompressedImage message;
  message.header.frame_id = "camera";
  message.header.stamp = ros::Time(12, 34);
  message.format = format;
  cv::imencode("." + format, cv::Mat(24, 32, CV_8UC3, colour), message.data);
  return message;
}

TEST(PictureOf, DecodesInColourAndInGrey) {
  for (const char* format : {"jpg", "png"}) {
    const sensor_msgs::CompressedImage message = compressed(format, {200.0, 100.0, 50.0});
    const DecodedImage colour = decodedImageOf(message, kColour);
    ASSERT_EQ(colour.pixels.type(), CV_8UC3) << format;
    EXPECT_EQ(colour.pixels.size(), cv::Size(32, 24));
    EXPECT_EQ(colour.header.frame_id, "camera");
    EXPECT_EQ(colour.header.stamp, ros::Time(12, 34));
    const cv::Scalar mean = cv::mean(colour.pixels);
    EXPECT_NEAR(mean[0], 200.0, 3.0) << format << ": blue first";
    EXPECT_NEAR(mean[1], 100.0, 3.0) << format;
    EXPECT_NEAR(mean[2], 50.0, 3.0) << format;

    const DecodedImage grey = decodedImageOf(message, kGrey);
    ASSERT_EQ(grey.pixels.type(), CV_8UC1) << format;
    EXPECT_EQ(grey.pixels.size(), cv::Size(32, 24));
    // 0.114 * 200 + 0.587 * 100 + 0.299 * 50
    EXPECT_NEAR(cv::mean(grey.pixels)[0], 96.45, 3.0) << format;
  }
}

TEST(PictureOf, GreyFilesBecomeColourWhereColourIsWanted) {
  sensor_msgs::CompressedImage message;
  cv::imencode(".png", cv::Mat(24, 32, CV_8UC1, cv::Scalar(77)), message.data);
  const DecodedImage picture = decodedImageOf(message, kColour);
  ASSERT_EQ(picture.pixels.type(), CV_8UC3);
  EXPECT_EQ(picture.pixels.at<cv::Vec3b>(5, 5), cv::Vec3b(77, 77, 77));
}

TEST(PictureOf, RefusesBytesThatAreNoImage) {
  sensor_msgs::CompressedImage message = compressed("png", {1.0, 2.0, 3.0});
  message.format = "bgr8; png compressed bgr8";
  message.data.clear();
  expectRefusal([&] { decodedImageOf(message, kColour); }, {"bgr8; png compressed bgr8", "0 bytes"});
  message.data.assign(100, 0x5A);
  for (const int channels : {1, 3}) {
    expectRefusal([&] { decodedImageOf(message, channels); }, {"100 bytes"});
  }
  // OpenCV's reader of these ended the process.
  const std::string medical = std::string(128, '\0') + "DICM" + std::string(2, '\0');
  message.data.assign(medical.begin(), medical.end());
  for (const char* begin : {"", "\x89PNG", "\xff\xd8", "RIFF", "II*+"}) {
    std::copy_n(begin, std::strlen(begin), message.data.begin());
    expectRefusal([&] { decodedImageOf(message, kColour); }, {"134 bytes", "JPEG, PNG"});
  }
  for (const char* format : {"jpg", "png"}) {
    message = compressed(format, {1.0, 2.0, 3.0});
    for (const std::size_t part : {30, 2}) {
      message.data.resize(message.data.size() - message.data.size() / part);
      for (const int channels : {1, 3})
        expectRefusal([&] { decodedImageOf(message, channels); },
                      {std::to_string(message.data.size()) + " bytes"});
    }
    message.data.resize(12);
    EXPECT_THROW(decodedImageOf(message, kColour), std::invalid_argument)
        << format << " without more than its first bytes";
  }
}

/// A colour picture whose grey is the distance from its corner, over 10, in px: at the centre of any pixel of
/// any grid.
sensor_msgs::CompressedImage slope(const std::string& format, const cv::Size& size) {
  cv::Mat grey(size, CV_8UC1), colour;
  for (int row = 0; row < size.height; ++row)
    for (int column = 0; column < size.width; ++column)
      grey.at<std::uint8_t>(row, column) = cv::saturate_cast<std::uint8_t>((row + column + 1) / 10.0);
  cv::cvtColor(grey, colour, cv::COLOR_GRAY2BGR);
  sensor_msgs::CompressedImage message;
  cv::imencode("." + format, colour, message.data);
  return message;
}

LazyImage lazy(const sensor_msgs::CompressedImage& message) {
  return LazyImage(boost::make_shared<const sensor_msgs::CompressedImage>(message));
}

TEST(LazyImage, PicturesOnAGridAreThatOfTheWholeImage) {
  const cv::Size size(1401, 801);  // odd, so that half of it is not a whole number
  for (const char* format : {"jpg", "png"}) {
    // Decoded whole, at half, at a quarter, and at an eighth of its size.
    for (const int working_width : {0, 800, 640, 320, 160}) {
      for (const int channels : {1, 3}) {
        SCOPED_TRACE(fmt::format("{} {} {}", format, working_width, channels));
        LazyImage image = lazy(slope(format, size));
        const cv::Mat& picture = image.onGrid(working_width, channels);
        EXPECT_EQ(image.size(), size);
        ASSERT_EQ(picture.size(), workingGrid(size, working_width));
        ASSERT_EQ(picture.type(), CV_8UC(channels));
        const double across = 1401.0 / picture.cols, down = 801.0 / picture.rows;
        for (const cv::Point at :
             {cv::Point(3, 5), cv::Point(picture.cols / 2, 7), cv::Point(50, picture.rows - 4)})
          EXPECT_NEAR(picture.ptr(at.y)[at.x * channels],
                      ((at.x + 0.5) * across + (at.y + 0.5) * down) / 10.0, 1.5)
              << at;
      }
    }
  }
}

TEST(LazyImage, JpegsAreDecodedNoFinerThanAsked) {
  const sensor_msgs::CompressedImage message = slope("jpg", {1401, 801});
  EXPECT_EQ(decodedImageOf(message, kGrey, 2).pixels.size(), cv::Size(701, 401));
  EXPECT_EQ(decodedImageOf(message, kGrey, 4).pixels.size(), cv::Size(351, 201));
  EXPECT_EQ(decodedImageOf(message, kGrey, 8).pixels.size(), cv::Size(176, 101));
}

TEST(LazyImage, OtherGridsAndColourAreStillThere) {
  LazyImage image = lazy(slope("jpg", {640, 360}));
  EXPECT_EQ(image.onGrid(160, 1).size(), cv::Size(160, 90));
  EXPECT_EQ(image.onGrid(320, 1).size(), cv::Size(320, 180));
  EXPECT_EQ(image.pixels().size(), cv::Size(640, 360));
  EXPECT_EQ(image.pixels().type(), CV_8UC3);
}

TEST(LazyImage, RawImagesBecomeGreyOnAGridAsWell) {
  const auto message = boost::make_shared<sensor_msgs::Image>();
  message->encoding = "bgr8";
  message->width = 64;
  message->height = 36;
  message->step = 3 * 64;
  for (int i = 0; i < 64 * 36; ++i) message->data.insert(message->data.end(), {200, 100, 50});
  LazyImage image{sensor_msgs::ImageConstPtr(message)};
  const cv::Mat& grey = image.onGrid(32, 1);
  ASSERT_EQ(grey.size(), cv::Size(32, 18));
  EXPECT_EQ(image.size(), cv::Size(64, 36));
  EXPECT_EQ(grey.at<std::uint8_t>(9, 20), 96);  // 0.114 * 200 + 0.587 * 100 + 0.299 * 50
}

// A camera that was held upright: OpenCV turns the picture, whose header says the size before.
TEST(LazyImage, TurnedJpegsHaveTheSizeOfTheirPixels) {
  sensor_msgs::CompressedImage message = slope("jpg", {640, 360});
  const std::vector<std::uint8_t> turned = {0xFF, 0xE1, 0, 34, 'E', 'x', 'i', 'f', 0,    0,    'I', 'I',
                                            '*',  0,    8, 0,  0,   0,   1,   0,   0x12, 0x01, 3,   0,
                                            1,    0,    0, 0,  6,   0,   0,   0,   0,    0,    0,   0};
  message.data.insert(message.data.begin() + 2, turned.begin(), turned.end());
  LazyImage image = lazy(message);
  EXPECT_EQ(image.onGrid(90, 1).size(), cv::Size(90, 160));
  EXPECT_EQ(image.size(), cv::Size(360, 640));
}

TEST(LazyImage, RefusesJpegsThatBreakOff) {
  const sensor_msgs::CompressedImage whole = slope("jpg", {640, 360});
  for (const std::size_t bytes : {0, 1, 2, 3, 4, 20, 100}) {
    sensor_msgs::CompressedImage message = whole;
    message.data.resize(bytes);
    EXPECT_THROW(lazy(message).onGrid(160, 1), std::invalid_argument) << bytes;
  }
}

TEST(DepthOf, SharesMetres) {
  const sensor_msgs::ImagePtr message = imageOf("32FC1", 4);
  setPixel(*message, 2, 1, 12.5F);
  setPixel(*message, 1, 3, std::numeric_limits<float>::quiet_NaN());
  const cv::Mat depth = depthOf(*message);
  EXPECT_EQ(depth.data, message->data.data()) << "it was copied";
  ASSERT_EQ(depth.type(), CV_32FC1);
  ASSERT_EQ(depth.size(), cv::Size(4, 3));
  EXPECT_EQ(depth.at<float>(2, 1), 12.5F);
  EXPECT_TRUE(std::isnan(depth.at<float>(1, 3)));
}

TEST(DepthOf, MillimetresBecomeMetres) {
  for (const char* encoding : {"16UC1", "mono16"}) {
    const sensor_msgs::ImagePtr message = imageOf(encoding, 2);
    setPixel<std::uint16_t>(*message, 0, 0, 0);
    setPixel<std::uint16_t>(*message, 1, 2, 1500);
    setPixel<std::uint16_t>(*message, 2, 3, 65535);
    const cv::Mat depth = depthOf(*message);
    ASSERT_EQ(depth.type(), CV_32FC1) << encoding;
    ASSERT_EQ(depth.size(), cv::Size(4, 3));
    EXPECT_EQ(depth.at<float>(0, 0), 0.0F) << "unknown stays unknown";
    EXPECT_FLOAT_EQ(depth.at<float>(1, 2), 1.5F);
    EXPECT_FLOAT_EQ(depth.at<float>(2, 3), 65.535F);
  }
}

// cv_bridge does not swap bytes: it makes channels of them.
TEST(DepthOf, RefusesTheOtherByteOrder) {
  for (const auto& [encoding, bytes] : {std::pair<const char*, std::uint32_t>{"32FC1", 4U}, {"16UC1", 2U}}) {
    const sensor_msgs::ImagePtr message = imageOf(encoding, bytes);
    message->is_bigendian = 1;
    expectRefusal([&] { depthOf(*message); }, {"depth", "byte order"});
  }
}

TEST(DepthOf, RefusesOtherEncodingsAndSizes) {
  for (const char* encoding : {"mono8", "64FC1", "32FC2", "nonsense"}) {
    expectRefusal([&] { depthOf(*imageOf(encoding, 8)); },
                  {"depth", "'" + std::string(encoding) + "'", "32FC1", "16UC1"});
  }
  for (const auto& [encoding, bytes] : {std::pair<const char*, std::uint32_t>{"32FC1", 4U}, {"16UC1", 2U}}) {
    const sensor_msgs::ImagePtr message = imageOf(encoding, bytes);
    message->data.pop_back();
    expectRefusal([&] { depthOf(*message); }, {"depth"});
    message->width = 0;
    expectRefusal([&] { depthOf(*message); }, {"depth", "empty"});
  }
}

// All else stays byte for byte, the padding too.
TEST(KeptDepth, IsUnknownWhereNothingIsKept) {
  cv::Mat keep(3, 4, CV_8UC1, cv::Scalar(255));
  keep.at<std::uint8_t>(1, 2) = 0;
  const auto millimetres = imageOf("16UC1", 2), metres = imageOf("32FC1", 4);
  const auto holed = keptDepth(*millimetres, keep), torn = keptDepth(*metres, keep);
  setPixel(*millimetres, 1, 2, std::uint16_t{0});
  EXPECT_EQ(holed->data, millimetres->data);
  EXPECT_EQ(holed->header.stamp, millimetres->header.stamp);
  EXPECT_EQ(holed->encoding, "16UC1");
  float hole = 0.0F;
  std::memcpy(&hole, &torn->data[torn->step + 8], sizeof hole);
  EXPECT_TRUE(std::isnan(hole));
  setPixel(*metres, 1, 2, hole);
  EXPECT_EQ(torn->data, metres->data);
  EXPECT_EQ(torn->encoding, "32FC1");
  expectRefusal([&] { keptDepth(*imageOf("bgr8", 3), keep); }, {"depth", "bgr8", "16UC1"});
}

TEST(FlowMessage, RoundTripWithoutValid) {
  std_msgs::Header header;
  header.frame_id = "camera";
  header.stamp = ros::Time(12, 34);
  const FlowField field = flowField();
  const FlowPtr message = flowMessage(header, ros::Time(13, 56), field, {1600, 900});
  EXPECT_EQ(message->header.frame_id, "camera");
  EXPECT_EQ(message->header.stamp, ros::Time(12, 34));
  EXPECT_EQ(message->second_stamp, ros::Time(13, 56));
  EXPECT_EQ(message->image_width, 1600U);
  EXPECT_EQ(message->image_height, 900U);
  EXPECT_EQ(message->flow.encoding, "32FC2");
  EXPECT_EQ(message->flow.header.stamp, ros::Time(12, 34)) << "viewers show the image in it by itself";
  EXPECT_TRUE(message->valid.data.empty());

  const FlowField read = flowOf(*message);
  EXPECT_TRUE(equalBytes(read.flow, field.flow));
  EXPECT_EQ(read.flow.data, message->flow.data.data()) << "it was copied";
  EXPECT_TRUE(read.valid.empty()) << "everything is reliable";
}

TEST(FlowMessage, RoundTripWithValid) {
  FlowField field = flowField();
  field.valid = cv::Mat(field.flow.size(), CV_8UC1, cv::Scalar(255));
  field.valid.at<std::uint8_t>(4, 7) = 0;
  const FlowPtr message = flowMessage({}, {}, field, {1600, 900});
  EXPECT_EQ(message->valid.encoding, "mono8");
  const FlowField read = flowOf(*message);
  EXPECT_TRUE(equalBytes(read.flow, field.flow));
  EXPECT_TRUE(equalBytes(read.valid, field.valid));
  EXPECT_EQ(read.valid.data, message->valid.data.data()) << "it was copied";
}

TEST(FlowMessage, RoundTripWithClosure) {
  FlowField field = flowField();
  field.fb_error = cv::Mat(field.flow.size(), CV_32FC1, cv::Scalar(0.25));
  field.fb_error.at<float>(4, 7) = 3.5F;
  field.grey = cv::Mat(field.flow.size(), CV_8UC1, cv::Scalar(7));
  field.second_grey = cv::Mat(field.flow.size(), CV_8UC1, cv::Scalar(8));
  const FlowPtr message = flowMessage({}, {}, field, {1600, 900});
  EXPECT_EQ(message->fb_error.encoding, "32FC1");
  const FlowField read = flowOf(*message);
  EXPECT_TRUE(equalBytes(read.fb_error, field.fb_error));
  EXPECT_TRUE(equalBytes(read.grey, field.grey));
  EXPECT_TRUE(equalBytes(read.second_grey, field.second_grey));
  EXPECT_TRUE(read.valid.empty());
  EXPECT_TRUE(flowOf(*flowMessage({}, {}, flowField(), {1600, 900})).fb_error.empty());
}

TEST(FlowMessage, PartsOfLargerImagesAreSentWithoutTheRest) {
  cv::Mat large(20, 40, CV_32FC2, cv::Scalar::all(99.0));
  FlowField field = flowField();
  field.flow.copyTo(large(cv::Rect(5, 6, 16, 9)));
  field.flow = large(cv::Rect(5, 6, 16, 9));
  EXPECT_TRUE(equalBytes(flowOf(*flowMessage({}, {}, field, {1600, 900})).flow, flowField().flow));
}

TEST(FlowOf, RefusesWhatContradictsItself) {
  const auto expectRefused = [](auto change, const std::vector<std::string>& parts) {
    FlowField field = flowField();
    field.valid = cv::Mat(field.flow.size(), CV_8UC1, cv::Scalar(255));
    field.fb_error = cv::Mat(field.flow.size(), CV_32FC1, cv::Scalar(0.0));
    Flow message = *flowMessage({}, {}, field, {1600, 900});
    EXPECT_NO_THROW(flowOf(message));
    change(message);
    expectRefusal([&] { flowOf(message); }, parts);
  };
  expectRefused([](Flow& m) { m.flow.encoding = "32FC1"; }, {"flow", "'32FC1'", "32FC2"});
  expectRefused([](Flow& m) { m.flow.data.pop_back(); }, {"flow"});
  expectRefused([](Flow& m) { m.flow = {}; }, {"flow", "empty"});
  expectRefused([](Flow& m) { m.valid.encoding = "rgb8"; }, {"valid", "'rgb8'", "mono8"});
  expectRefused([](Flow& m) { m.valid.data.pop_back(); }, {"valid"});
  expectRefused([](Flow& m) { m.valid = *imageOf("mono8", 1, 16, 8); }, {"valid", "16 x 8", "16 x 9"});
  expectRefused([](Flow& m) { m.fb_error.encoding = "mono8"; }, {"fb_error", "'mono8'", "32FC1"});
  expectRefused([](Flow& m) { m.fb_error = *imageOf("32FC1", 4, 16, 8); }, {"fb_error", "16 x 8", "16 x 9"});
  expectRefused([](Flow& m) { m.grey = *imageOf("mono8", 1, 16, 8); }, {"grey", "16 x 8"});
  expectRefused([](Flow& m) { m.second_grey = *imageOf("mono8", 1, 16, 8); }, {"second_grey", "16 x 8"});
  expectRefused([](Flow& m) { m.image_height = 1200; }, {"16 x 9", "1600 x 1200"});
  expectRefused([](Flow& m) { m.image_width = m.image_height = 0; }, {"0 x 0"});
  expectRefused([](Flow& m) { m.image_width = m.image_height = 0xFFFFFFFF; }, {"16 x 9"});
}

TEST(DepthStdOf, SharesSharesOnly) {
  const sensor_msgs::ImagePtr message = imageOf("32FC1", 4);
  setPixel(*message, 2, 1, 0.25F);
  const cv::Mat stds = depthStdOf(*message);
  EXPECT_EQ(stds.data, message->data.data()) << "it was copied";
  EXPECT_EQ(stds.at<float>(2, 1), 0.25F);
  // Millimetres are no shares.
  expectRefusal([] { depthStdOf(*imageOf("16UC1", 2)); }, {"depth uncertainty", "'16UC1'", "32FC1"});
  message->width = 0;
  expectRefusal([&] { depthStdOf(*message); }, {"empty"});
}

TEST(FlowImageOf, SharesTheImageOfAnExpectedFlow) {
  const FlowField field = flowField();
  const sensor_msgs::ImagePtr message = imageMessage({}, "32FC2", field.flow);
  const cv::Mat flow = flowImageOf(*message);
  EXPECT_TRUE(equalBytes(flow, field.flow));
  EXPECT_EQ(flow.data, message->data.data()) << "it was copied";
  expectRefusal([] { flowImageOf(*imageOf("32FC1", 4)); }, {"'32FC1'", "32FC2"});
}

TEST(FlowImageOf, RefusesTheOtherByteOrder) {
  const sensor_msgs::ImagePtr message = imageMessage({}, "32FC2", flowField().flow);
  message->is_bigendian = 1;
  expectRefusal([&] { flowImageOf(*message); }, {"flow", "byte order"});
}

TEST(ImageMessage, HoldsHeaderEncodingAndPixels) {
  std_msgs::Header header;
  header.frame_id = "camera";
  header.stamp = ros::Time(12, 34);
  cv::Mat pixels(3, 4, CV_8UC1, cv::Scalar(0));
  pixels.at<std::uint8_t>(2, 1) = 255;
  const sensor_msgs::ImagePtr message = imageMessage(header, "mono8", pixels);
  EXPECT_EQ(message->header.frame_id, "camera");
  EXPECT_EQ(message->header.stamp, ros::Time(12, 34));
  EXPECT_EQ(message->encoding, "mono8");
  EXPECT_EQ(message->width, 4U);
  EXPECT_EQ(message->height, 3U);
  EXPECT_EQ(message->data[2 * message->step + 1], 255);
}

sensor_msgs::CameraInfo cameraInfo() {
  sensor_msgs::CameraInfo info;
  info.width = 1600;
  info.height = 900;
  info.K = {1260.0, 0.0, 816.0, 0.0, 1250.0, 491.0, 0.0, 0.0, 1.0};
  return info;
}

void expectCamera(const CameraIntrinsics& camera, double fx, double fy, double cx, double cy) {
  EXPECT_EQ(camera.fx, fx);
  EXPECT_EQ(camera.fy, fy);
  EXPECT_EQ(camera.cx, cx);
  EXPECT_EQ(camera.cy, cy);
  EXPECT_EQ(camera.width, 1600);
  EXPECT_EQ(camera.height, 900);
}

TEST(CameraOf, TakesTheProjectionElseTheCameraMatrix) {
  sensor_msgs::CameraInfo info = cameraInfo();
  expectCamera(cameraOf(info), 1260.0, 1250.0, 816.0, 491.0);
  // Of a rectified image, which P describes and K does not. Its last column is that of a stereo pair.
  info.P = {1100.0, 0.0, 800.0, -120.0, 0.0, 1105.0, 450.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  expectCamera(cameraOf(info), 1100.0, 1105.0, 800.0, 450.0);
}

TEST(CameraOf, RefusesCamerasThatSeeNothing) {
  const auto expectRefused = [](auto change) {
    sensor_msgs::CameraInfo info = cameraInfo();
    change(info);
    expectRefusal([&] { cameraOf(info); }, {"camera_info"});
  };
  expectRefused([](auto& info) { info.K[0] = 0.0; });
  expectRefused([](auto& info) { info.K[4] = 0.0; });
  expectRefused([](auto& info) { info.K.fill(0.0); });
  expectRefused([](auto& info) { info.P[0] = 1100.0; });  // and no focal length downwards
  expectRefused([](auto& info) { info.K[2] = std::numeric_limits<double>::quiet_NaN(); });
  expectRefused([](auto& info) { info.P[0] = std::numeric_limits<double>::quiet_NaN(); });
  for (const double damaged : {1e-200, 1e200}) expectRefused([&](auto& info) { info.K[0] = damaged; });
  expectRefused([](auto& info) { info.K[2] = -1e200; });
  expectRefused([](auto& info) { info.width = 0; });
  expectRefused([](auto& info) { info.height = 0; });
  expectRefused([](auto& info) { info.K[0] = 1e38; });
  expectRefused([](auto& info) { info.K[0] = 1e-300; });
  expectRefused([](auto& info) { info.K[2] = -1e300; });
  expectRefused([](auto& info) { info.binning_y = 901; });
  expectRefused([](auto& info) { info.roi.width = info.roi.height = 4'294'967'295U; });
  sensor_msgs::CameraInfo uncalibrated = cameraInfo();
  uncalibrated.K.fill(0.0);
  expectRefusal([&] { cameraOf(uncalibrated); }, {"camera_info", "no calibration"});
}

// A point is seen by the pixels of the sensor, and two by two of them, from column 401 and row 101 on, are
// one pixel of the image: column 401 and 402 make column 0.
TEST(CameraOf, IsThatOfTheRegionAndOfBinnedPixels) {
  sensor_msgs::CameraInfo info = cameraInfo();
  const CameraIntrinsics whole = cameraOf(info);
  info.binning_x = info.binning_y = 2;
  info.roi.x_offset = 401;
  info.roi.y_offset = 101;
  info.roi.width = 800;
  info.roi.height = 600;
  const CameraIntrinsics part = cameraOf(info);
  EXPECT_EQ(part.width, 400);
  EXPECT_EQ(part.height, 300);
  const Eigen::Vector3d point(0.3, -0.2, 4.0);
  const Eigen::Vector2d on_sensor = whole.project(point), in_image = part.project(point);
  EXPECT_NEAR(in_image.x(), (on_sensor.x() - 401.5) / 2.0, 1e-9);
  EXPECT_NEAR(in_image.y(), (on_sensor.y() - 101.5) / 2.0, 1e-9);
  info.binning_x = 4;
  EXPECT_EQ(cameraOf(info).width, 200);
  EXPECT_EQ(cameraOf(info).height, 300);
  info.roi.width = 1200;
  expectRefusal([&] { cameraOf(info); }, {"roi of 1200 x 600 px at 401, 101", "1600 x 900"});
  info.roi.width = info.roi.height = 0;
  EXPECT_EQ(cameraOf(info).width, 400) << "a region of no size is the whole";
}

TEST(DistortionDoubt, WhereThereIsDistortionAndNoProjectionOfItsOwn) {
  sensor_msgs::CameraInfo info = cameraInfo();
  EXPECT_EQ(distortionDoubt(info), "");
  info.D = {0.0, 0.0, 0.0, 0.0, 0.0};
  EXPECT_EQ(distortionDoubt(info), "");
  info.D[4] = -0.01;
  EXPECT_NE(distortionDoubt(info).find("no P"), std::string::npos);
  info.P = {1260.0, 0.0, 816.0, 0.0, 0.0, 1250.0, 491.0, 0.0, 0.0, 0.0, 1.0, 0.0};
  EXPECT_NE(distortionDoubt(info).find("a P that is K"), std::string::npos);
  info.P[0] = 1100.0;
  EXPECT_EQ(distortionDoubt(info), "") << "as a calibration of rectified images has it";
}

TEST(IsGridOf, ComparesShapes) {
  const cv::Size image(1600, 900);
  EXPECT_TRUE(isGridOf({1600, 900}, image));
  EXPECT_TRUE(isGridOf({800, 450}, image));
  EXPECT_TRUE(isGridOf({640, 360}, image));
  EXPECT_TRUE(isGridOf({640, 361}, image)) << "rounded";
  EXPECT_TRUE(isGridOf({33, 19}, image)) << "18.6 rows";
  EXPECT_FALSE(isGridOf({640, 384}, image)) << "cropped or padded: its pixels would be others";
  EXPECT_FALSE(isGridOf({900, 1600}, image)) << "turned";
  EXPECT_FALSE(isGridOf({0, 0}, image));
  EXPECT_FALSE(isGridOf({0, 1}, image));
  EXPECT_FALSE(isGridOf({16, 9}, {0, 900}));
  EXPECT_FALSE(isGridOf({16, 9}, {1600, 0}));
  EXPECT_FALSE(isGridOf({-16, -9}, image));
}

TEST(SizeText, IsForMessages) { EXPECT_EQ(sizeText({800, 450}), "800 x 450"); }

}  // namespace
}  // namespace radar_dot
