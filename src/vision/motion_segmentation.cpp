// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/motion_segmentation.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "exact_selection.h"
#include "motion_images.h"
#include "motion_pass.h"
#include "parallel_rows.h"
#include "parameter_checks.h"
#include "radar_dot/vision/motion_terms.h"
#include "radar_dot/vision/uncertainty_terms.h"
#include "vectorised.h"

namespace radar_dot {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// m of the footprint of a radar return, below and above it: radars look at bumpers and grilles.
constexpr float kFootprintBelow = 0.5F;
constexpr float kFootprintAbove = 1.5F;

const ParameterChecks kChecks("motion segmentation");

/// An odd kernel of the grid for a diameter given in px of the full image.
int kernelSize(int diameter, double pixel_scale) {
  const int size = static_cast<int>(std::lround(diameter / pixel_scale));
  return size <= 1 ? 1 : size | 1;
}

void morphology(cv::Mat& mask, int operation, int size) {
  if (size <= 1) return;
  cv::morphologyEx(mask, mask, operation, cv::getStructuringElement(cv::MORPH_RECT, cv::Size(size, size)));
}

RADAR_DOT_VECTORISED void thresholdRow(const float* scores, int columns, float threshold, std::uint8_t* mask,
                                       std::uint8_t* valid) {
  for (int i = 0; i < columns; ++i) {
    mask[i] = scores[i] > threshold ? 255 : 0;
    valid[i] = scores[i] >= 0.0F ? 255 : 0;
  }
}

using Histograms = tbb::enumerable_thread_specific<FloatHistogram>;

/// Runs `row(index, histogram)` for every row, on all cores. @return the sum of the histograms.
template <typename Row>
const FloatHistogram& overRows(int rows, Histograms& locals, FloatHistogram& sum, const Row& row) {
  for (FloatHistogram& local : locals) local.clear();
  parallelRows(rows, [&](int i) { row(i, locals.local()); });
  sum.clear();
  for (const FloatHistogram& local : locals) sum += local;
  return sum;
}

/// The number of rank n/2 among the n finite `value(pixel)` of an image, whose histogram is given.
template <typename Value>
float medianOf(const cv::Mat& image, const FloatHistogram& histogram, std::size_t count,
               tbb::enumerable_thread_specific<std::vector<float>>& locals, std::vector<float>& candidates,
               const Value& value) {
  if (count == 0) return 0.0F;
  const FloatHistogram::Place place = histogram.placeOf(count / 2);
  for (std::vector<float>& local : locals) local.clear();
  parallelRows(image.rows, [&](int row) {
    std::vector<float>& local = locals.local();
    const float* pixels = image.ptr<float>(row);
    for (int column = 0; column < image.cols; ++column) {
      const float x = value(pixels[column]);
      if (FloatHistogram::binOf(x) == place.bin) local.push_back(x);
    }
  });
  candidates.clear();
  for (const std::vector<float>& local : locals)
    candidates.insert(candidates.end(), local.begin(), local.end());
  const auto wanted = candidates.begin() + static_cast<std::ptrdiff_t>(count / 2 - place.below);
  std::nth_element(candidates.begin(), wanted, candidates.end());
  return *wanted;
}

}  // namespace

void validate(const MotionParams& params) {
  kChecks.notNegative("k", params.k);
  kChecks.notNegative("lambda", params.lambda);
  kChecks.positive("min_depth", params.min_depth);
  kChecks.positive("foe_std", params.foe_std);
  kChecks.positive("max_depth", params.max_depth);
  kChecks.require(params.occlusion_margin >= 0.0 && params.occlusion_margin <= 1.0, "occlusion_margin",
                  params.occlusion_margin, "between 0 and 1");
  kChecks.require(params.opening >= 0 && params.opening <= 999, "opening", params.opening,
                  "between 0 and 999 px");
  kChecks.require(params.closing >= 0 && params.closing <= 999, "closing", params.closing,
                  "between 0 and 999 px");
  kChecks.notNegative("min_threshold", params.min_threshold);
  kChecks.notNegative("flow_std", params.flow_std);
  kChecks.notNegative("flow_std_relative", params.flow_std_relative);
  kChecks.require(params.flow_std + params.flow_std_relative > 0.0, "flow_std", params.flow_std,
                  "positive, or flow_std_relative");
  kChecks.notNegative("closure_weight", params.closure_weight);
  kChecks.notNegative("depth_std", params.depth_std);
  kChecks.positive("next_depth_std", params.next_depth_std);
  kChecks.require(params.false_alarm > 0.0 && params.false_alarm < 1.0, "false_alarm", params.false_alarm,
                  "between 0 and 1");
  kChecks.notNegative("radar_gain", params.radar_gain);
  kChecks.notNegative("static_gain", params.static_gain);
  kChecks.notNegative("radar_azimuth_std", params.radar_azimuth_std);
  kChecks.require(params.growth > 0.0 && params.growth <= 1.0, "growth", params.growth, "above 0, at most 1");
  kChecks.positive("radar_radius", params.radar_radius);
}

struct MotionSegmenter::Workspace {
  MotionResult result;
  cv::Mat footprints;
  Histograms histograms;
  FloatHistogram sum;
  tbb::enumerable_thread_specific<std::vector<float>> local_candidates;
  std::vector<float> candidates;

  double medianDepth(const MotionInput& input, float max_depth);
  void drawFootprints(const MotionInput& input, const MotionParams& params);
  void drawFootprint(const CameraIntrinsics& camera, const Eigen::Vector3f& point, const MotionParams& params,
                     std::uint8_t value);
  std::size_t score(const MotionInput& input, const PassConstants& pass);
  void threshold(const MotionParams& params, const MotionInput& input);
  double paperThreshold(const MotionParams& params, float median);
  void grow(float low, int opening);
};

MotionSegmenter::MotionSegmenter(MotionParams params)
    : params_(params), workspace_(std::make_unique<Workspace>()) {
  validate(params_);
}
MotionSegmenter::~MotionSegmenter() = default;
MotionSegmenter::MotionSegmenter(MotionSegmenter&&) noexcept = default;
MotionSegmenter& MotionSegmenter::operator=(MotionSegmenter&&) noexcept = default;

double MotionSegmenter::Workspace::medianDepth(const MotionInput& input, float max_depth) {
  const auto known = [max_depth](float depth) { return isKnownDepth(depth, max_depth) ? depth : kNaN; };
  overRows(input.depth.rows, histograms, sum, [&](int row, FloatHistogram& histogram) {
    const float* depths = input.depth.ptr<float>(row);
    for (int column = 0; column < input.depth.cols; ++column) histogram.add(known(depths[column]));
  });
  return static_cast<double>(
      medianOf(input.depth, sum, sum.finiteCount(), local_candidates, candidates, known));
}

void MotionSegmenter::Workspace::drawFootprint(const CameraIntrinsics& camera, const Eigen::Vector3f& point,
                                               const MotionParams& params, std::uint8_t value) {
  if (!(point.z() > 0.1F) || !point.allFinite()) return;
  const auto half_width = static_cast<float>(
      std::max(params.radar_radius, params.radar_azimuth_std * static_cast<double>(point.norm())));
  const auto corner = [&](float right, float down) {
    const Eigen::Vector2d pixel = camera.project((point + Eigen::Vector3f(right, down, 0.0F)).cast<double>());
    // Far outside is outside; the conversion to int must not overflow.
    return cv::Point(static_cast<int>(std::lround(std::clamp(pixel.x(), -1e5, 1e5))),
                     static_cast<int>(std::lround(std::clamp(pixel.y(), -1e5, 1e5))));
  };
  cv::rectangle(footprints, corner(-half_width, -kFootprintAbove), corner(half_width, kFootprintBelow),
                cv::Scalar(value), cv::FILLED);
}

void MotionSegmenter::Workspace::drawFootprints(const MotionInput& input, const MotionParams& params) {
  footprints.create(input.camera.height, input.camera.width, CV_8UC1);
  footprints.setTo(0);
  if (params.static_gain > 0.0) {
    for (const Eigen::Vector3f& point : input.static_points)
      drawFootprint(input.camera, point, params, kStaticReturn);
  }
  if (params.radar_gain > 0.0) {  // over the others: one that moves before a wall counts
    for (const Eigen::Vector3f& point : input.dynamic_points)
      drawFootprint(input.camera, point, params, kDynamicReturn);
  }
}

std::size_t MotionSegmenter::Workspace::score(const MotionInput& input, const PassConstants& pass) {
  const int rows = input.camera.height;
  const int columns = input.camera.width;
  result.score.create(rows, columns, CV_32FC1);
  const motion_terms::FloatImage next_depth(input.next_depth);
  const bool with_radar = (pass.radar_factors[kDynamicReturn] != 1.0F && !input.dynamic_points.empty()) ||
                          (pass.radar_factors[kStaticReturn] != 1.0F && !input.static_points.empty());
  overRows(rows, histograms, sum, [&](int row, FloatHistogram& histogram) {
    InputRow in;
    in.depths = input.depth.ptr<float>(row);
    in.flows = input.flow.ptr<float>(row);
    if (!input.flow_valid.empty()) in.reliable = input.flow_valid.ptr<std::uint8_t>(row);
    if (!input.flow_closure.empty()) in.closures = input.flow_closure.ptr<float>(row);
    if (!input.depth_std.empty()) in.depth_stds = input.depth_std.ptr<float>(row);
    if (with_radar) in.footprint = footprints.ptr<std::uint8_t>(row);
    float* scores = result.score.ptr<float>(row);
    scoreRow(pass, next_depth, row, in, columns, scores);
    for (int column = 0; column < columns; ++column) histogram.add(scores[column]);
  });
  return sum.finiteCount();
}

double MotionSegmenter::Workspace::paperThreshold(const MotionParams& params, float median) {
  const auto deviation = [median](float s) { return std::fabs(s - median); };
  const cv::Mat& scores = result.score;
  overRows(scores.rows, histograms, sum, [&](int row, FloatHistogram& histogram) {
    const float* pixels = scores.ptr<float>(row);
    for (int column = 0; column < scores.cols; ++column) histogram.add(deviation(pixels[column]));
  });
  const float mad = medianOf(scores, sum, result.valid_count, local_candidates, candidates, deviation);
  result.mad = static_cast<double>(mad);
  return static_cast<double>(motion_terms::robustThreshold(median, mad, static_cast<float>(params.k),
                                                           static_cast<float>(params.min_threshold)));
}

/// Adds to the mask what is above `low` and connected with it.
void MotionSegmenter::Workspace::grow(float low, int opening) {
  cv::Mat candidates_mask = result.score > low;
  morphology(candidates_mask, cv::MORPH_OPEN, opening);
  cv::bitwise_or(candidates_mask, result.mask, candidates_mask);
  cv::Mat labels;
  const int count = cv::connectedComponents(candidates_mask, labels, 8, CV_32S);
  std::vector<std::uint8_t> holds_seed(static_cast<std::size_t>(count), 0);
  for (int row = 0; row < labels.rows; ++row) {
    const int* label = labels.ptr<int>(row);
    const std::uint8_t* seed = result.mask.ptr<std::uint8_t>(row);
    for (int column = 0; column < labels.cols; ++column)
      if (seed[column] != 0) holds_seed[static_cast<std::size_t>(label[column])] = 255;
  }
  holds_seed[0] = 0;  // the background
  parallelRows(labels.rows, [&](int row) {
    const int* label = labels.ptr<int>(row);
    std::uint8_t* mask = result.mask.ptr<std::uint8_t>(row);
    for (int column = 0; column < labels.cols; ++column)
      mask[column] = holds_seed[static_cast<std::size_t>(label[column])];
  });
}

void MotionSegmenter::Workspace::threshold(const MotionParams& params, const MotionInput& input) {
  const cv::Mat& scores = result.score;
  const auto same = [](float s) { return s; };
  const float median = medianOf(scores, sum, result.valid_count, local_candidates, candidates, same);
  result.median = static_cast<double>(median);
  result.mad = 0.0;
  if (params.score == MotionScore::kPaper) {
    result.threshold = paperThreshold(params, median);
  } else {
    namespace terms = uncertainty_terms;
    const int degrees = input.next_depth.empty() ? 2 : 3;
    // A third component that is not known everywhere is as if it were zero: the median is that of two.
    const double scale = std::max(1.0, result.median / terms::chiMedian(2));
    result.threshold = scale * terms::chiThreshold(degrees, params.false_alarm);
  }
  const auto tau = static_cast<float>(result.threshold);

  result.mask.create(scores.size(), CV_8UC1);
  result.valid.create(scores.size(), CV_8UC1);
  parallelRows(scores.rows, [&](int row) {
    thresholdRow(scores.ptr<float>(row), scores.cols, tau, result.mask.ptr<std::uint8_t>(row),
                 result.valid.ptr<std::uint8_t>(row));
  });
  const int opening = kernelSize(params.opening, input.pixel_scale);
  morphology(result.mask, cv::MORPH_OPEN, opening);
  if (params.growth < 1.0) grow(static_cast<float>(params.growth) * tau, opening);
  morphology(result.mask, cv::MORPH_CLOSE, kernelSize(params.closing, input.pixel_scale));
  // Closing reaches over excluded pixels, of which nothing is known.
  cv::bitwise_and(result.mask, result.valid, result.mask);
}

const MotionResult& MotionSegmenter::segment(const MotionInput& input) {
  const CameraIntrinsics& camera = input.camera;
  kChecks.require(camera.width >= 2 && camera.height >= 2, "width of the camera's grid", camera.width,
                  "2 px or more");
  kChecks.require(input.pixel_scale > 0.0 && std::isfinite(input.pixel_scale), "pixel_scale",
                  input.pixel_scale, "positive");
  if (!input.T_current_from_previous.matrix().allFinite()) {
    throw std::invalid_argument("motion segmentation: the motion is not finite");
  }
  requireImage(input.flow, CV_32FC2, camera, "flow", "CV_32FC2");
  requireImage(input.depth, CV_32FC1, camera, "depth", "CV_32FC1");
  if (!input.flow_valid.empty()) requireImage(input.flow_valid, CV_8UC1, camera, "flow_valid", "CV_8UC1");
  if (!input.next_depth.empty()) requireImage(input.next_depth, CV_32FC1, camera, "next_depth", "CV_32FC1");
  if (!input.flow_closure.empty())
    requireImage(input.flow_closure, CV_32FC1, camera, "flow_closure", "CV_32FC1");
  if (!input.depth_std.empty()) requireImage(input.depth_std, CV_32FC1, camera, "depth_std", "CV_32FC1");

  Workspace& work = *workspace_;
  work.result.median_depth = work.medianDepth(input, static_cast<float>(params_.max_depth));
  if (!input.dynamic_points.empty() || !input.static_points.empty()) work.drawFootprints(input, params_);
  work.result.valid_count = work.score(input, PassConstants(input, params_, work.result.median_depth));
  work.threshold(params_, input);
  return work.result;
}

}  // namespace radar_dot
