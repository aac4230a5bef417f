// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/motion_segmentation.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "exact_selection.h"
#include "motion_images.h"
#include "parallel_rows.h"
#include "parameter_checks.h"
#include "radar_dot/vision/motion_terms.h"

namespace radar_dot {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

// m of the footprint of a radar return, below and above it: radars look at bumpers and grilles.
constexpr float kFootprintBelow = 0.5F;
constexpr float kFootprintAbove = 1.5F;

// The loops over pixels exist twice, for processors with and without AVX2; the processor at hand chooses.
// Both round alike. Sanitizers start later than that choice.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__)
#define RADAR_DOT_VECTORISED __attribute__((target_clones("avx2", "default")))
#else
#define RADAR_DOT_VECTORISED
#endif

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

/// What the pass over the image needs, in single precision.
struct PassConstants {
  PassConstants(const MotionInput& input, const MotionParams& params, double median)
      : motion(input.camera, input.T_current_from_previous),
        pixel_scale(static_cast<float>(input.pixel_scale)),
        lambda(static_cast<float>(params.lambda)),
        min_depth(static_cast<float>(params.min_depth)),
        max_depth(static_cast<float>(params.max_depth)),
        occlusion_margin(static_cast<float>(params.occlusion_margin)),
        median_depth(static_cast<float>(median)),
        radar_factor(static_cast<float>(1.0 + params.radar_gain)),
        last_u(static_cast<float>(input.camera.width - 1)),
        last_v(static_cast<float>(input.camera.height - 1)),
        predicted_in_view(params.predicted_in_view) {
    const double grid_std = params.foe_std / input.pixel_scale;
    const auto inverse_two_variance = static_cast<float>(1.0 / (2.0 * grid_std * grid_std));
    const auto foe =
        motion_terms::focusOfExpansion(input.camera, input.T_current_from_previous.translation());
    const auto factors = [&](std::vector<float>& along, int size, double centre) {
      along.assign(static_cast<std::size_t>(size), 0.0F);  // at infinity nothing is near
      for (int i = 0; foe && i < size; ++i) {
        along[static_cast<std::size_t>(i)] =
            motion_terms::foeFactor(static_cast<float>(i) - static_cast<float>(centre), inverse_two_variance);
      }
    };
    factors(foe_columns, input.camera.width, foe ? foe->x() : 0.0);
    factors(foe_rows, input.camera.height, foe ? foe->y() : 0.0);
  }
  motion_terms::PixelMotion motion;
  float pixel_scale, lambda, min_depth, max_depth, occlusion_margin, median_depth, radar_factor;
  float last_u, last_v;
  bool predicted_in_view;
  std::vector<float> foe_columns, foe_rows;  // factors of the weight of the focus of expansion
};

bool isKnownDepth(float depth, float max_depth) { return depth > 0.0F && depth <= max_depth; }

constexpr int kBlock =
    256;  // pixels of a row that are worked on together, small enough for the nearest cache

/// A few pixels of a row on their way to a score. Arrays, and one simple loop for each step, so that the
/// compiler works on several pixels at once; constants are copied first, so that it knows they do not change
/// meanwhile.
struct PixelBlock {
  std::array<float, kBlock> u, v, depth_there, flow_part, tolerance, depth_part;
};

/// Prediction, flow residual and the tolerance for flow.
RADAR_DOT_VECTORISED void predictBlock(const PassConstants& pass, int row, int begin, int count,
                                       const float* depths, const float* flows, PixelBlock& block) {
  namespace terms = motion_terms;
  const terms::PixelMotion motion = pass.motion;
  const float pixel_scale = pass.pixel_scale;
  const float median_depth = pass.median_depth;
  const float min_depth = pass.min_depth;
  const auto v = static_cast<float>(row);
  const float foe_row = pass.foe_rows[static_cast<std::size_t>(row)];
  const float* foe_columns = pass.foe_columns.data() + begin;
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto u = static_cast<float>(begin + i);
    const terms::Prediction there = terms::predict(motion, u, v, depths[i]);
    block.u[k] = there.u;
    block.v[k] = there.v;
    block.depth_there[k] = there.depth;
    block.flow_part[k] =
        terms::flowResidual(flows[2 * i], flows[2 * i + 1], there.u - u, there.v - v, pixel_scale);
    block.tolerance[k] = terms::flowTolerance(median_depth, depths[i], min_depth, foe_columns[i] * foe_row);
  }
}

/// The depth residual, and what is excluded: flow_part becomes NaN.
void lookUpDepth(const PassConstants& pass, const motion_terms::FloatImage& next_depth, int row, int begin,
                 int count, const float* depths, const float* flows, const std::uint8_t* reliable,
                 PixelBlock& block) {
  namespace terms = motion_terms;
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    block.depth_part[k] = 0.0F;
    const float u = block.u[k];
    const float v = block.v[k];
    const float depth_there = block.depth_there[k];
    // The flow must lead into the second image, and where asked for, the prediction too.
    const float u_seen = static_cast<float>(begin + i) + flows[2 * i];
    const float v_seen = static_cast<float>(row) + flows[2 * i + 1];
    const bool in_view =
        depth_there > 0.0F && u_seen >= 0.0F && v_seen >= 0.0F && u_seen <= pass.last_u &&
        v_seen <= pass.last_v &&
        (!pass.predicted_in_view || (u >= 0.0F && v >= 0.0F && u <= pass.last_u && v <= pass.last_v));
    if (!in_view || !isKnownDepth(depths[i], pass.max_depth) || (reliable != nullptr && reliable[i] == 0)) {
      block.flow_part[k] = kNaN;
      continue;
    }
    if (next_depth.pixels == nullptr) continue;
    const float seen = terms::bilinear(next_depth, u, v);
    if (!isKnownDepth(seen, pass.max_depth)) continue;
    if (terms::isOccluded(seen, depth_there, pass.occlusion_margin)) block.flow_part[k] = kNaN;
    block.depth_part[k] = terms::depthResidual(seen, depth_there);
  }
}

RADAR_DOT_VECTORISED void scoreBlock(const PassConstants& pass, int count, const float* depths,
                                     const PixelBlock& block, float* scores) {
  namespace terms = motion_terms;
  const float min_depth = pass.min_depth;
  const float lambda = pass.lambda;
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    // A flow that is not a number makes a score that is none.
    scores[i] = terms::motionScore(block.flow_part[k], block.tolerance[k], block.depth_part[k],
                                   terms::depthTolerance(depths[i], min_depth), lambda);
  }
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
  kChecks.notNegative("radar_gain", params.radar_gain);
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
  void drawFootprints(const MotionInput& input, double radius);
  std::size_t score(const MotionInput& input, const PassConstants& pass);
  void threshold(const MotionParams& params, double pixel_scale);
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

void MotionSegmenter::Workspace::drawFootprints(const MotionInput& input, double radius) {
  const CameraIntrinsics& camera = input.camera;
  footprints.create(camera.height, camera.width, CV_8UC1);
  footprints.setTo(0);
  for (const Eigen::Vector3f& point : input.dynamic_points) {
    if (!(point.z() > 0.1F) || !point.allFinite()) continue;
    const auto r = static_cast<float>(radius);
    const auto corner = [&](float right, float down) {
      const Eigen::Vector2d pixel =
          camera.project((point + Eigen::Vector3f(right, down, 0.0F)).cast<double>());
      // Far outside is outside; the conversion to int must not overflow.
      return cv::Point(static_cast<int>(std::lround(std::clamp(pixel.x(), -1e5, 1e5))),
                       static_cast<int>(std::lround(std::clamp(pixel.y(), -1e5, 1e5))));
    };
    cv::rectangle(footprints, corner(-r, -kFootprintAbove), corner(r, kFootprintBelow), cv::Scalar(255),
                  cv::FILLED);
  }
}

std::size_t MotionSegmenter::Workspace::score(const MotionInput& input, const PassConstants& pass) {
  const int rows = input.camera.height;
  const int columns = input.camera.width;
  result.score.create(rows, columns, CV_32FC1);
  const motion_terms::FloatImage next_depth(input.next_depth);
  const bool with_radar = pass.radar_factor != 1.0F && !input.dynamic_points.empty();
  overRows(rows, histograms, sum, [&](int row, FloatHistogram& histogram) {
    const float* depths = input.depth.ptr<float>(row);
    const float* flows = input.flow.ptr<float>(row);
    const std::uint8_t* reliable =
        input.flow_valid.empty() ? nullptr : input.flow_valid.ptr<std::uint8_t>(row);
    const std::uint8_t* footprint = with_radar ? footprints.ptr<std::uint8_t>(row) : nullptr;
    float* scores = result.score.ptr<float>(row);
    PixelBlock block;
    for (int begin = 0; begin < columns; begin += kBlock) {
      const int count = std::min(kBlock, columns - begin);
      predictBlock(pass, row, begin, count, depths + begin, flows + 2 * begin, block);
      lookUpDepth(pass, next_depth, row, begin, count, depths + begin, flows + 2 * begin,
                  reliable == nullptr ? nullptr : reliable + begin, block);
      scoreBlock(pass, count, depths + begin, block, scores + begin);
    }
    for (int column = 0; footprint != nullptr && column < columns; ++column)
      if (footprint[column] != 0) scores[column] *= pass.radar_factor;
    for (int column = 0; column < columns; ++column) histogram.add(scores[column]);
  });
  return sum.finiteCount();
}

void MotionSegmenter::Workspace::threshold(const MotionParams& params, double pixel_scale) {
  const cv::Mat& scores = result.score;
  const auto same = [](float s) { return s; };
  const float median = medianOf(scores, sum, result.valid_count, local_candidates, candidates, same);
  const auto deviation = [median](float s) { return std::fabs(s - median); };
  overRows(scores.rows, histograms, sum, [&](int row, FloatHistogram& histogram) {
    const float* pixels = scores.ptr<float>(row);
    for (int column = 0; column < scores.cols; ++column) histogram.add(deviation(pixels[column]));
  });
  const float mad = medianOf(scores, sum, result.valid_count, local_candidates, candidates, deviation);
  const float tau = motion_terms::robustThreshold(median, mad, static_cast<float>(params.k),
                                                  static_cast<float>(params.min_threshold));
  result.median = static_cast<double>(median);
  result.mad = static_cast<double>(mad);
  result.threshold = static_cast<double>(tau);

  result.mask.create(scores.size(), CV_8UC1);
  result.valid.create(scores.size(), CV_8UC1);
  parallelRows(scores.rows, [&](int row) {
    thresholdRow(scores.ptr<float>(row), scores.cols, tau, result.mask.ptr<std::uint8_t>(row),
                 result.valid.ptr<std::uint8_t>(row));
  });
  morphology(result.mask, cv::MORPH_OPEN, kernelSize(params.opening, pixel_scale));
  morphology(result.mask, cv::MORPH_CLOSE, kernelSize(params.closing, pixel_scale));
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

  Workspace& work = *workspace_;
  work.result.median_depth = work.medianDepth(input, static_cast<float>(params_.max_depth));
  if (params_.radar_gain > 0.0 && !input.dynamic_points.empty())
    work.drawFootprints(input, params_.radar_radius);
  work.result.valid_count = work.score(input, PassConstants(input, params_, work.result.median_depth));
  work.threshold(params_, input.pixel_scale);
  return work.result;
}

}  // namespace radar_dot
