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
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <string>
#include <vector>

#include "evaluation/segmentation_images.h"
#include "radar_dot/dataset/tables.h"
#include "radar_dot/vision/optical_flow.h"

namespace {

namespace fs = std::filesystem;
using radar_dot::dataset::Index;
using radar_dot::dataset::Tables;
using radar_dot::evaluation::readFlow;
using radar_dot::evaluation::readGrey;

struct Errors {
  std::vector<float> of_static, of_movers;
};

cv::Mat greyImage(const fs::path& file) {
  const cv::Mat grey = cv::imread(file.string(), cv::IMREAD_GRAYSCALE);
  if (grey.empty()) throw std::runtime_error(file.string() + ": cannot be read");
  return grey;
}

/// Error of every visible pixel of the small image, against the truth at the same place of the full one.
void compare(const cv::Mat& flow, const fs::path& truth, const std::string& name, Errors& errors) {
  const radar_dot::FlowField true_flow = readFlow(truth / "flow" / name);
  const cv::Mat occlusion = readGrey(truth / "occlusion" / name);
  const cv::Mat motion = readGrey(truth / "motion" / name);
  const float scale_x = static_cast<float>(occlusion.cols) / static_cast<float>(flow.cols);
  const float scale_y = static_cast<float>(occlusion.rows) / static_cast<float>(flow.rows);
  // The pixel of the full image nearest to the centre of the small one.
  const auto nearest = [](int pixel, float scale, int size) {
    return std::clamp(static_cast<int>(std::lround((static_cast<float>(pixel) + 0.5F) * scale - 0.5F)), 0,
                      size - 1);
  };
  for (int v = 0; v < flow.rows; ++v) {
    for (int u = 0; u < flow.cols; ++u) {
      const cv::Point full(nearest(u, scale_x, occlusion.cols), nearest(v, scale_y, occlusion.rows));
      if (true_flow.valid.at<std::uint8_t>(full) == 0 || occlusion.at<std::uint8_t>(full) != 0) continue;
      const auto& found = flow.at<cv::Vec2f>(v, u);
      const auto& wanted = true_flow.flow.at<cv::Vec2f>(full);
      const bool moves = motion.at<std::uint8_t>(full) != 0;
      (moves ? errors.of_movers : errors.of_static)
          .push_back(std::hypot(found[0] - wanted[0] / scale_x, found[1] - wanted[1] / scale_y));
    }
  }
}

std::string nameOf(const Tables& tables, Index reading) {
  return tables.path(tables.sample_data[static_cast<std::size_t>(reading)]).stem().string() + ".png";
}

Errors evaluateScene(const Tables& tables, Index scene, int most_pairs) {
  const std::unique_ptr<radar_dot::OpticalFlow> dis = radar_dot::makeOpticalFlow();
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
    const radar_dot::FlowField field =
        dis->compute(greyImage(path(readings[i])), greyImage(path(readings[i + 1])));
    compare(field.flow, truth, nameOf(tables, readings[i]), errors);
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
