// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
// How hard the simulated images are for optical flow: end-point error of OpenCV's DIS against the
// exact flow, per scene. Not a google-benchmark: it measures errors, not times.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>
#include <string>
#include <vector>

#include "radar_dot/dataset/tables.h"

namespace {

namespace fs = std::filesystem;
using radar_dot::dataset::Index;
using radar_dot::dataset::Tables;

constexpr int kWidth = 800;  // px
constexpr int kHeight = 450;

struct Errors {
  std::vector<float> of_static, of_movers;
};

cv::Mat read(const fs::path& file, int flags) {
  cv::Mat image = cv::imread(file.string(), flags);
  if (image.empty()) throw std::runtime_error(file.string() + ": cannot be read");
  return image;
}

cv::Mat greyImage(const fs::path& file) {
  cv::Mat grey;
  cv::resize(read(file, cv::IMREAD_GRAYSCALE), grey, cv::Size(kWidth, kHeight), 0.0, 0.0, cv::INTER_AREA);
  return grey;
}

/// Error of every visible pixel of the small image, against the truth at the same place of the full one.
void compare(const cv::Mat& flow, const fs::path& truth, const std::string& name, Errors& errors) {
  const cv::Mat true_flow = read(truth / "flow" / name, cv::IMREAD_UNCHANGED);
  const cv::Mat occlusion = read(truth / "occlusion" / name, cv::IMREAD_UNCHANGED);
  const cv::Mat motion = read(truth / "motion" / name, cv::IMREAD_UNCHANGED);
  const double scale_x = static_cast<double>(true_flow.cols) / kWidth;
  const double scale_y = static_cast<double>(true_flow.rows) / kHeight;
  for (int v = 0; v < kHeight; ++v) {
    for (int u = 0; u < kWidth; ++u) {
      // The pixel of the full image nearest to the centre of the small one.
      const int full_u =
          std::clamp(static_cast<int>(std::lround((u + 0.5) * scale_x - 0.5)), 0, true_flow.cols - 1);
      const int full_v =
          std::clamp(static_cast<int>(std::lround((v + 0.5) * scale_y - 0.5)), 0, true_flow.rows - 1);
      const auto& code = true_flow.at<cv::Vec3w>(full_v, full_u);
      if (code[0] == 0 || occlusion.at<std::uint8_t>(full_v, full_u) != 0) continue;
      const auto& found = flow.at<cv::Vec2f>(v, u);
      const double error = std::hypot(found[0] - (code[2] - 32768.0) / 64.0 / scale_x,
                                      found[1] - (code[1] - 32768.0) / 64.0 / scale_y);
      const bool moves = motion.at<std::uint8_t>(full_v, full_u) != 0;
      (moves ? errors.of_movers : errors.of_static).push_back(static_cast<float>(error));
    }
  }
}

std::string nameOf(const Tables& tables, Index reading) {
  return tables.path(tables.sample_data[static_cast<std::size_t>(reading)]).stem().string() + ".png";
}

Errors evaluateScene(const Tables& tables, Index scene, int most_pairs) {
  const cv::Ptr<cv::DISOpticalFlow> dis = cv::DISOpticalFlow::create(cv::DISOpticalFlow::PRESET_MEDIUM);
  const fs::path truth = tables.dataroot() / "ground_truth";
  const std::vector<Index> readings = tables.readingsOf(scene, "CAM_FRONT");
  std::vector<std::size_t> with_truth;
  for (std::size_t i = 0; i + 1 < readings.size(); ++i)
    if (fs::exists(truth / "flow" / nameOf(tables, readings[i]))) with_truth.push_back(i);
  const std::size_t step = std::max<std::size_t>(1, with_truth.size() / static_cast<std::size_t>(most_pairs));
  Errors errors;
  for (std::size_t k = 0; k < with_truth.size(); k += step) {
    const std::size_t i = with_truth[k];
    const auto path = [&](Index row) {
      return tables.path(tables.sample_data[static_cast<std::size_t>(row)]);
    };
    cv::Mat flow;
    dis->calc(greyImage(path(readings[i])), greyImage(path(readings[i + 1])), flow);
    compare(flow, truth, nameOf(tables, readings[i]), errors);
  }
  return errors;
}

double mean(const std::vector<float>& values) {
  double sum = 0.0;
  for (const float value : values) sum += static_cast<double>(value);
  return values.empty() ? 0.0 : sum / static_cast<double>(values.size());
}

double median(std::vector<float> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("End-point error of DIS (medium, 800x450) on simulated images, static and moving pixels.");
  std::string dataroot;
  std::string version = "v1.0-sim";
  int pairs = 20;
  app.add_option("--dataroot", dataroot, "Folder that simulate_drive made, with ground truth")->required();
  app.add_option("--version", version)->capture_default_str();
  app.add_option("--pairs", pairs, "Pairs of images per scene")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  try {
    radar_dot::dataset::LoadOptions options;
    options.version = version;
    const Tables tables = Tables::load(dataroot, options);
    fmt::print("{:12} {:>12} {:>12} {:>12} {:>12}\n", "px at 800x450", "static mean", "median", "movers mean",
               "median");
    for (std::size_t scene = 0; scene < tables.scenes.size(); ++scene) {
      const Errors errors = evaluateScene(tables, static_cast<Index>(scene), pairs);
      fmt::print("{:13} {:12.3f} {:12.3f} {:12.3f} {:12.3f}\n", tables.scenes[scene].name,
                 mean(errors.of_static), median(errors.of_static), mean(errors.of_movers),
                 median(errors.of_movers));
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "flow_difficulty: {}\n", error.what());
    return 1;
  }
  return 0;
}
