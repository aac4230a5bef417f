// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "radar_dot/common/random_stream.h"
#include "radar_dot/simulation/camera_sensor.h"

namespace radar_dot::simulation {
namespace {

/// What white paper lying in the street reflects decides the exposure, as a light meter would.
float exposureOf(const Lighting& lighting) {
  constexpr float kGreyInSun = 0.30F;
  constexpr float kStreetLight = 0.20F;
  const Color light =
      lighting.sun * std::max(0.0F, lighting.to_sun.z()) + 0.55F * lighting.zenith + 0.45F * lighting.horizon;
  const float luminance = 0.2126F * light.x() + 0.7152F * light.y() + 0.0722F * light.z();
  return kGreyInSun / (0.18F * (luminance + (lighting.night ? kStreetLight : 0.0F)));
}

/// Sum of four uniforms out of the bits of one number: a normal deviate to about 3 sigma.
float normalOf(std::uint64_t bits) {
  constexpr float kScale = 1.0F / 37837.0F;  // sigma of the sum of four 16-bit uniforms
  const auto sum = static_cast<float>((bits & 0xffffU) + ((bits >> 16) & 0xffffU) + ((bits >> 32) & 0xffffU) +
                                      (bits >> 48));
  return (sum - 131070.0F) * kScale;
}

/// sRGB curve with a soft shoulder, as a table over [0, kTop).
class ToneCurve {
 public:
  ToneCurve() {
    for (std::size_t i = 0; i < table_.size(); ++i) {
      const float linear = kTop * static_cast<float>(i) / static_cast<float>(table_.size());
      const float shoulder =
          linear < 0.6F ? linear : 0.6F + 0.4F * (1.0F - std::exp(-(linear - 0.6F) / 0.4F));
      const float encoded =
          shoulder <= 0.0031308F ? 12.92F * shoulder : 1.055F * std::pow(shoulder, 1.0F / 2.4F) - 0.055F;
      table_[i] = static_cast<std::uint8_t>(std::lround(255.0F * std::clamp(encoded, 0.0F, 1.0F)));
    }
  }
  std::uint8_t operator()(float linear) const {
    const float place = std::clamp(linear / kTop, 0.0F, 0.99999F) * static_cast<float>(table_.size());
    return table_[static_cast<std::size_t>(place)];
  }

 private:
  static constexpr float kTop = 3.0F;
  std::array<std::uint8_t, 16384> table_;
};

}  // namespace

Eigen::Matrix3d scaledCameraMatrix(const CameraMount& mount, int width, int height) {
  const double scale_x = static_cast<double>(width) / kFullWidth;
  const double scale_y = static_cast<double>(height) / kFullHeight;
  Eigen::Matrix3d matrix = mount.camera_matrix;
  matrix(0, 0) *= scale_x;
  matrix(1, 1) *= scale_y;
  matrix(0, 2) = (matrix(0, 2) + 0.5) * scale_x - 0.5;
  matrix(1, 2) = (matrix(1, 2) + 0.5) * scale_y - 0.5;
  return matrix;
}

PinholeCamera cameraAt(const CameraMount& mount, const Trajectory& ego, double time_s, int width,
                       int height) {
  return {ego.at(time_s).T_map_from_body * mount.T_base_from_sensor, scaledCameraMatrix(mount, width, height),
          width, height};
}

cv::Mat takePicture(const cv::Mat& radiance, const Lighting& lighting, const ImageSensorParams& params,
                    std::uint64_t seed, std::uint64_t stream) {
  static const ToneCurve tone_curve;
  cv::Mat light;
  cv::GaussianBlur(radiance, light, cv::Size(3, 3), params.lens_blur);
  const float exposure = exposureOf(lighting);
  const auto full_well = static_cast<float>(lighting.night ? params.night_full_well : params.full_well);
  const float read_variance =
      static_cast<float>(params.read_noise * params.read_noise) / (full_well * full_well);
  const float centre_x = 0.5F * static_cast<float>(light.cols - 1);
  const float centre_y = 0.5F * static_cast<float>(light.rows - 1);
  const float corner = centre_x * centre_x + centre_y * centre_y;
  const std::uint64_t key = mixBits(mixBits(seed) ^ mixBits(stream + 0x5bd1e995U));

  cv::Mat picture(light.size(), CV_8UC3);
  for (int v = 0; v < light.rows; ++v) {
    const auto* from = light.ptr<cv::Vec3f>(v);
    auto* to = picture.ptr<cv::Vec3b>(v);
    const float dy = static_cast<float>(v) - centre_y;
    for (int u = 0; u < light.cols; ++u) {
      const float dx = static_cast<float>(u) - centre_x;
      const float gain =
          exposure * (1.0F - static_cast<float>(params.vignetting) * (dx * dx + dy * dy) / corner);
      const auto pixel = static_cast<std::uint64_t>(v) * static_cast<std::uint64_t>(light.cols) +
                         static_cast<std::uint64_t>(u);
      for (int channel = 0; channel < 3; ++channel) {
        const float signal = gain * from[u][channel];
        const float sigma = std::sqrt(signal / full_well + read_variance);
        const float noise = normalOf(mixBits(key + 3 * pixel + static_cast<std::uint64_t>(channel)));
        to[u][2 - channel] = tone_curve(signal + sigma * noise);
      }
    }
  }
  return picture;
}

}  // namespace radar_dot::simulation
