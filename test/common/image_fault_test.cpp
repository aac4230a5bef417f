// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/common/image_fault.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <initializer_list>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

namespace radar_dot {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// As a camera's: a JPEG of it has some kB without a pattern.
Bytes encoded(const char* extension, const std::vector<int>& parameters = {}, int type = CV_8UC3) {
  cv::Mat image(180, 320, type);
  cv::theRNG().state = 7;
  cv::randu(image, 0, 255);
  cv::GaussianBlur(image, image, {}, 2.0);
  Bytes bytes;
  cv::imencode(extension, image, bytes, parameters);
  return bytes;
}

std::vector<std::pair<const char*, Bytes>> jpegs() {
  return {{"plain", encoded(".jpg")},
          {"grey", encoded(".jpg", {}, CV_8UC1)},
          {"progressive", encoded(".jpg", {cv::IMWRITE_JPEG_PROGRESSIVE, 1})},
          {"with restarts", encoded(".jpg", {cv::IMWRITE_JPEG_RST_INTERVAL, 4})}};
}

Bytes inserted(Bytes bytes, std::size_t at, const Bytes& more) {
  bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), more.begin(), more.end());
  return bytes;
}

/// Behind the first marker: Exif data with a whole JPEG in it, as of cameras that add a small picture.
Bytes withThumbnail(const Bytes& jpeg) {
  Bytes small;
  cv::imencode(".jpg", cv::Mat(12, 16, CV_8UC3, cv::Scalar(20, 100, 50)), small);
  const std::size_t length = 2 + 6 + small.size();
  Bytes segment = {0xFF,
                   0xE1,
                   static_cast<std::uint8_t>(length >> 8U),
                   static_cast<std::uint8_t>(length),
                   'E',
                   'x',
                   'i',
                   'f',
                   0,
                   0};
  segment.insert(segment.end(), small.begin(), small.end());
  return inserted(jpeg, 2, segment);
}

TEST(ImageFault, WholeImagesHaveNone) {
  for (const auto& [name, bytes] : jpegs()) {
    EXPECT_EQ(imageFault(bytes), "") << name;
    EXPECT_EQ(imageFault(withThumbnail(bytes)), "") << name;
    EXPECT_EQ(imageFault(inserted(bytes, bytes.size(), Bytes(1000, 0x5A))), "") << name << ", more behind it";
    EXPECT_EQ(imageFault(inserted(bytes, bytes.size() - 2, Bytes(16, 0))), "") << name << ", padded";
  }
  EXPECT_EQ(imageFault(encoded(".png")), "");
  EXPECT_EQ(imageFault(encoded(".bmp")), "") << "is not looked at";
}

TEST(ImageFault, ImagesThatEndEarlyHaveOne) {
  for (auto [name, bytes] : jpegs()) {
    for (const Bytes& whole : {bytes, withThumbnail(bytes)}) {
      for (const std::size_t size : {std::size_t{2}, std::size_t{30}, whole.size() / 4, whole.size() / 2,
                                     whole.size() * 9 / 10, whole.size() - 2}) {
        const Bytes cut(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_NE(imageFault(cut), "") << name << ": " << size << " of " << whole.size();
      }
    }
  }
  Bytes png = encoded(".png");
  png.resize(png.size() - 12);
  EXPECT_NE(imageFault(png), "");
  EXPECT_NE(imageFault({}), "");
  EXPECT_NE(imageFault(Bytes(200, 0x5A)), "") << "no image";
}

TEST(ImageFault, ImagesThatLackAPartOfTheirMiddleHaveOne) {
  for (const auto& [name, bytes] : jpegs()) {
    const auto begin = static_cast<std::ptrdiff_t>(bytes.size() / 2);
    const auto end = static_cast<std::ptrdiff_t>(bytes.size() * 6 / 10);
    Bytes lost = bytes;
    lost.erase(lost.begin() + begin, lost.begin() + end);
    EXPECT_NE(imageFault(lost), "") << name;
    Bytes zeros = bytes;
    std::fill(zeros.begin() + begin, zeros.begin() + end, 0);
    EXPECT_NE(imageFault(zeros), "") << name;
  }
}

}  // namespace
}  // namespace radar_dot
