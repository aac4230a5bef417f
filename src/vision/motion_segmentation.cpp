// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/motion_segmentation.h"

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <stdexcept>
#include <utility>

#include "exact_selection.h"
#include "ground_ray.h"
#include "mask_borders.h"
#include "motion_images.h"
#include "motion_pass.h"
#include "parallel_rows.h"
#include "radar_dot/common/quantile.h"
#include "radar_dot/vision/motion_terms.h"
#include "radar_dot/vision/return_reach.h"
#include "radar_dot/vision/uncertainty_terms.h"
#include "vectorised.h"

namespace radar_dot {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

void requireInput(bool good, const char* name, double value, const char* wanted) {
  if (!good)
    throw std::invalid_argument(
        fmt::format("motion segmentation: {} is {}, must be {}", name, value, wanted));
}

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

/// By how much scores with this median are larger than the model of static pixels says, `least` or more.
double scaleOf(double median, double least) {
  // A third component that is not known everywhere is as if it were zero: the median is that of two.
  return std::max(least, median / uncertainty_terms::chiMedian(2));
}

InputRow rowOf(const MotionInput& input, int row) {
  InputRow in;
  in.depths = input.depth.ptr<float>(row);
  in.flows = input.flow.ptr<float>(row);
  if (!input.flow_valid.empty()) in.reliable = input.flow_valid.ptr<std::uint8_t>(row);
  if (!input.fb_error.empty()) in.closures = input.fb_error.ptr<float>(row);
  if (!input.texture_std.empty()) in.textures = input.texture_std.ptr<float>(row);
  if (!input.depth_std.empty()) in.depth_stds = input.depth_std.ptr<float>(row);
  return in;
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

/// A pair of images and its scores, NaN where it does not judge a pixel.
struct ScoredPair {
  const MotionInput& input;
  const PassConstants& pass;
  const cv::Mat& scores;
};

/// How far the flow of a pair is from that of any static world, pixel by pixel: wherever before the ground it
/// may be.
class DistanceFromStaticWorld {
 public:
  /// The input must have a ground.
  DistanceFromStaticWorld(const ScoredPair& pair, const UncertaintyScoreParams& params)
      : pair_(pair), slope_(std::tan(pair.input.ground->params.pitch)) {
    // Where depth is drawn wrong, scores are large and distances are not.
    limit_ = static_cast<float>(params.hysteresis_ratio * scale(params.min_scale) *
                                uncertainty_terms::chiThreshold(2, params.false_alarm));
  }

  /// Adds the square of the distance over its limit, where the pair judges the pixel, and counts it.
  /// NaN where nothing can be told.
  void addTo(float& squares, float& count, const InputRow& in, int row, int column) const {
    if (!(pair_.scores.at<float>(row, column) >= 0.0F)) return;
    const float share = distance(in, row, column) / limit_;
    squares += share * share;
    count += 1.0F;
  }
  InputRow row(int index) const { return rowOf(pair_.input, index); }

 private:
  /// Standard deviations; NaN where nothing can be told.
  float distance(const InputRow& in, int row, int column) const {
    const GroundPlane& plane = *pair_.input.ground;
    const GroundRay ground =
        groundRay(pair_.input.camera, plane.T_base_from_camera, column, row, slope_, plane.params.height);
    return distanceFromStatic(
        pair_.pass, static_cast<float>(column), static_cast<float>(row), static_cast<float>(ground.rho),
        in.flows + 2 * static_cast<std::ptrdiff_t>(column), flowNoise(pair_.pass, in, column));
  }

  /// By how much they are larger than the model says, `least` or more; of a sample of what has a score.
  double scale(double least) const {
    constexpr int kSampling = 8;  // px
    std::vector<float> distances;
    for (int v = kSampling / 2; v < pair_.scores.rows; v += kSampling) {
      const InputRow in = row(v);
      for (int u = kSampling / 2; u < pair_.scores.cols; u += kSampling) {
        if (!(pair_.scores.at<float>(v, u) >= 0.0F)) continue;
        const float sample = distance(in, v, u);
        if (sample >= 0.0F) distances.push_back(sample);
      }
    }
    return scaleOf(static_cast<double>(quantileOf(distances)), least);
  }

  ScoredPair pair_;
  double slope_;
  float limit_;
};

}  // namespace

void validate(const MotionParams& params) {
  const FieldList fields = fieldsOf(params);
  checkFields(fields);
  const FlowDepthNoise& noise = params.uncertainty.noise;
  require(noise.flow_std + noise.flow_std_relative > 0.0, fields, {&noise.flow_std, &noise.flow_std_relative},
          "one of them must be positive");
}

struct MotionSegmenter::Workspace {
  MotionResult result;
  cv::Mat footprints, score_now, score_before, seeds, labels;
  Histograms histograms;
  FloatHistogram sum;
  tbb::enumerable_thread_specific<std::vector<float>> local_candidates;
  std::vector<float> candidates;

  double medianDepth(const MotionInput& input, float max_depth);
  void drawFootprints(const MotionInput& input, const RadarEvidenceParams& params);
  double score(const MotionInput& input, const PassConstants& pass, cv::Mat& scores);
  void addPairBefore(double scale_ratio);
  void addBelief(const cv::Mat& belief);
  double paperThreshold(const MotionParams& params);
  void makeMask(const std::vector<ScoredPair>& pairs, const MotionParams& params);
  void keepSeeded(const std::vector<ScoredPair>& pairs, const UncertaintyScoreParams& params);
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

void MotionSegmenter::Workspace::drawFootprints(const MotionInput& input, const RadarEvidenceParams& params) {
  footprints.create(input.camera.height, input.camera.width, CV_16UC1);
  footprints.setTo(kNoReturn);
  if (params.static_gain > 0.0) {
    drawReturns(input.camera, input.static_points, params, kStaticReturn, footprints);
    footprints.setTo(kStaticReturn, footprints != kNoReturn);
  }
  // Over the others: one that moves before a wall counts.
  if (params.dynamic_gain > 0.0)
    drawReturns(input.camera, input.dynamic_points, params, kDynamicReturn, footprints);
}

/// Fills `scores`, and `sum`. @return their median; 0 where all pixels are excluded
double MotionSegmenter::Workspace::score(const MotionInput& input, const PassConstants& pass,
                                         cv::Mat& scores) {
  const int rows = input.camera.height;
  const int columns = input.camera.width;
  scores.create(rows, columns, CV_32FC1);
  const motion_terms::FloatImage next_depth(input.next_depth);
  const bool with_radar = (pass.dynamic_factor != 1.0F && !input.dynamic_points.empty()) ||
                          (pass.static_factor != 1.0F && !input.static_points.empty());
  overRows(rows, histograms, sum, [&](int row, FloatHistogram& histogram) {
    InputRow in = rowOf(input, row);
    if (with_radar) in.footprint = footprints.ptr<std::uint16_t>(row);
    float* out = scores.ptr<float>(row);
    scoreRow(pass, next_depth, row, in, columns, out);
    for (int column = 0; column < columns; ++column) histogram.add(out[column]);
  });
  const auto same = [](float s) { return s; };
  return static_cast<double>(medianOf(scores, sum, sum.finiteCount(), local_candidates, candidates, same));
}

/// Root mean square with score_before. @param scale_ratio  of the scores over those before
void MotionSegmenter::Workspace::addPairBefore(double scale_ratio) {
  const auto ratio = static_cast<float>(scale_ratio);
  parallelRows(result.score.rows, [&](int row) {
    float* scores = result.score.ptr<float>(row);
    const float* others = score_before.ptr<float>(row);
    for (int column = 0; column < result.score.cols; ++column) {
      const float here = scores[column];
      const float before = ratio * others[column];
      const float both = std::sqrt(0.5F * (here * here + before * before));
      const float one = here >= 0.0F ? here : before;
      scores[column] = both >= 0.0F ? both : one;
    }
  });
}

/// Adds what is believed from before to the scores; what is excluded counts where enough of it is left.
void MotionSegmenter::Workspace::addBelief(const cv::Mat& belief) {
  constexpr float kForgotten = 1.0F;  // odds of e to 1
  const auto tau = static_cast<float>(result.threshold);
  const auto scale = static_cast<float>(result.scale);
  parallelRows(result.score.rows, [&](int row) {
    float* scores = result.score.ptr<float>(row);
    const float* beliefs = belief.ptr<float>(row);
    for (int column = 0; column < result.score.cols; ++column) {
      const float believed = std::fabs(beliefs[column]);  // false below for NaN
      const bool is_excluded = !(scores[column] >= 0.0F);
      if (!(believed >= (is_excluded ? kForgotten : 0.0F))) continue;
      scores[column] = std::max(0.0F, (is_excluded ? tau : scores[column]) + scale * beliefs[column]);
    }
  });
}

double MotionSegmenter::Workspace::paperThreshold(const MotionParams& params) {
  const auto median = static_cast<float>(result.median);
  const auto deviation = [median](float s) { return std::fabs(s - median); };
  const cv::Mat& scores = result.score;
  const std::size_t count = sum.finiteCount();
  overRows(scores.rows, histograms, sum, [&](int row, FloatHistogram& histogram) {
    const float* pixels = scores.ptr<float>(row);
    for (int column = 0; column < scores.cols; ++column) histogram.add(deviation(pixels[column]));
  });
  const float mad = medianOf(scores, sum, count, local_candidates, candidates, deviation);
  result.mad = static_cast<double>(mad);
  return static_cast<double>(motion_terms::robustThreshold(median, mad, static_cast<float>(params.paper.k),
                                                           static_cast<float>(params.paper.min_threshold)));
}

/// Removes the regions of the mask of which too little is dynamic whatever the depth.
void MotionSegmenter::Workspace::keepSeeded(const std::vector<ScoredPair>& pairs,
                                            const UncertaintyScoreParams& params) {
  const MotionInput& input = pairs.front().input;
  const auto high = static_cast<float>(params.hysteresis_ratio * result.threshold);
  std::vector<DistanceFromStaticWorld> worlds;
  for (const ScoredPair& pair : pairs)
    if (pair.input.ground) worlds.emplace_back(pair, params);
  const bool with_radar = !input.dynamic_points.empty();
  seeds.create(result.score.size(), CV_8UC1);
  parallelRows(seeds.rows, [&](int row) {
    std::vector<InputRow> rows;
    for (const DistanceFromStaticWorld& world : worlds) rows.push_back(world.row(row));
    const float* scores = result.score.ptr<float>(row);
    const auto* mask = result.mask.ptr<std::uint8_t>(row);
    auto* is_seed = seeds.ptr<std::uint8_t>(row);
    for (int column = 0; column < seeds.cols; ++column) {
      is_seed[column] = static_cast<std::uint8_t>(mask[column] != 0 && scores[column] > high);
      if (is_seed[column] == 0 || worlds.empty()) continue;
      if (with_radar && footprints.at<std::uint16_t>(row, column) >= kDynamicReturn) continue;
      float squares = 0.0F, count = 0.0F;
      for (std::size_t i = 0; i < worlds.size(); ++i) worlds[i].addTo(squares, count, rows[i], row, column);
      // The root mean square, as of the scores. What the past alone says does not decide.
      if (squares <= count) is_seed[column] = 0;
    }
  });
  const int regions = cv::connectedComponents(result.mask, labels, 8, CV_32S);
  std::vector<int> areas(static_cast<std::size_t>(regions)), votes(areas);
  for (int row = 0; row < seeds.rows; ++row) {
    const int* label = labels.ptr<int>(row);
    const auto* is_seed = seeds.ptr<std::uint8_t>(row);
    for (int column = 0; column < seeds.cols; ++column) {
      ++areas[static_cast<std::size_t>(label[column])];
      votes[static_cast<std::size_t>(label[column])] += is_seed[column];
    }
  }
  parallelRows(result.mask.rows, [&](int row) {
    const int* label = labels.ptr<int>(row);
    std::uint8_t* mask = result.mask.ptr<std::uint8_t>(row);
    for (int column = 0; column < result.mask.cols; ++column) {
      const auto region = static_cast<std::size_t>(label[column]);
      if (!(votes[region] > params.seed_share * areas[region])) mask[column] = 0;
    }
  });
}

void MotionSegmenter::Workspace::makeMask(const std::vector<ScoredPair>& pairs, const MotionParams& params) {
  const MotionInput& input = pairs.front().input;
  const cv::Mat& scores = result.score;
  const auto tau = static_cast<float>(result.threshold);
  const bool by_uncertainty = params.score == MotionScore::kUncertainty;
  result.mask.create(scores.size(), CV_8UC1);
  result.valid.create(scores.size(), CV_8UC1);
  parallelRows(scores.rows, [&](int row) {
    thresholdRow(scores.ptr<float>(row), scores.cols, tau, result.mask.ptr<std::uint8_t>(row),
                 result.valid.ptr<std::uint8_t>(row));
  });
  result.valid_count = static_cast<std::size_t>(cv::countNonZero(result.valid));
  morphology(result.mask, cv::MORPH_OPEN, kernelSize(params.cleanup.opening, input.pixel_scale));
  if (by_uncertainty && params.uncertainty.hysteresis_ratio > 1.0) keepSeeded(pairs, params.uncertainty);
  morphology(result.mask, cv::MORPH_CLOSE, kernelSize(params.cleanup.closing, input.pixel_scale));
  if (params.cleanup.border > 0 && !input.grey.empty())
    moveBordersToEdges(result.mask, input, params.cleanup.border / input.pixel_scale,
                       pairs.size() > 1 ? &pairs.back().input : nullptr);
  // Closing reaches over excluded pixels, of which nothing is known.
  cv::bitwise_and(result.mask, result.valid, result.mask);
}

namespace {

void requireImages(const MotionInput& input) {
  const CameraIntrinsics& camera = input.camera;
  if (!input.T_current_from_previous.matrix().allFinite()) {
    throw std::invalid_argument("motion segmentation: the motion is not finite");
  }
  requireImage(input.flow, CV_32FC2, camera, "flow", "CV_32FC2");
  requireImage(input.depth, CV_32FC1, camera, "depth", "CV_32FC1");
  if (!input.flow_valid.empty()) requireImage(input.flow_valid, CV_8UC1, camera, "flow_valid", "CV_8UC1");
  if (!input.grey.empty()) requireImage(input.grey, CV_8UC1, camera, "grey", "CV_8UC1");
  if (!input.second_grey.empty()) requireImage(input.second_grey, CV_8UC1, camera, "second_grey", "CV_8UC1");
  for (const auto& [image, name] :
       {std::pair(&input.next_depth, "next_depth"), std::pair(&input.fb_error, "fb_error"),
        std::pair(&input.texture_std, "texture_std"), std::pair(&input.depth_std, "depth_std"),
        std::pair(&input.belief, "belief")})
    if (!image->empty()) requireImage(*image, CV_32FC1, camera, name, "CV_32FC1");
}

}  // namespace

MotionResult MotionSegmenter::segment(const MotionInput& input, const MotionInput* before) {
  const CameraIntrinsics& camera = input.camera;
  requireInput(camera.width >= 2 && camera.height >= 2, "width of the camera's grid", camera.width,
               "2 px or more");
  requireInput(input.pixel_scale > 0.0 && std::isfinite(input.pixel_scale), "pixel_scale", input.pixel_scale,
               "positive");
  requireImages(input);
  const bool by_uncertainty = params_.score == MotionScore::kUncertainty;
  if (!by_uncertainty && (before != nullptr || !input.belief.empty()))
    throw std::invalid_argument("motion segmentation: the paper's score knows nothing of images before");
  if (before != nullptr) {
    requireInput(before->camera.width == camera.width && before->camera.height == camera.height,
                 "width of the grid of the previous pair", before->camera.width, "that of the pair");
    requireImages(*before);
  }

  Workspace& work = *workspace_;
  MotionResult& result = work.result;
  result.median_depth = work.medianDepth(input, static_cast<float>(params_.max_depth));
  if (!input.dynamic_points.empty() || !input.static_points.empty())
    work.drawFootprints(input, params_.radar);
  const PassConstants pass(input, params_, result.median_depth);
  result.median = work.score(input, pass, result.score);
  if (!by_uncertainty) {
    result.threshold = work.paperThreshold(params_);
    work.makeMask({{input, pass, result.score}}, params_);
    return std::exchange(result, {});
  }
  result.scale = scaleOf(result.median, params_.uncertainty.min_scale);
  // Regions ask who judged a pixel.
  result.score.copyTo(work.score_now);
  std::vector<ScoredPair> pairs{{input, pass, work.score_now}};
  std::optional<PassConstants> pass_before;
  if (before != nullptr) {
    pass_before.emplace(*before, params_, result.median_depth);
    pairs.push_back({*before, *pass_before, work.score_before});
    const double scale_before =
        scaleOf(work.score(*before, *pass_before, work.score_before), params_.uncertainty.min_scale);
    work.addPairBefore(result.scale / scale_before);
  }
  const int degrees = input.next_depth.empty() ? 2 : 3;
  result.threshold = result.scale * uncertainty_terms::chiThreshold(degrees, params_.uncertainty.false_alarm);
  if (!input.belief.empty()) work.addBelief(input.belief);
  work.makeMask(pairs, params_);
  return std::exchange(result, {});
}

}  // namespace radar_dot
