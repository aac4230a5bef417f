// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/mask_pipeline.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "radar_dot/vision/motion_history.h"
#include "radar_dot/vision/return_reach.h"
#include "radar_dot/vision/rigid_motion.h"

namespace radar_dot {
namespace {

// Those of pairs that wait elsewhere for the rest of their inputs. A pair that was processed drops its own.
constexpr std::size_t kMaxBackward = 6;
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Do pairs score the same with both? How the past is used, and which inputs are taken, does not matter.
bool sameScores(MaskPipelineParams a, const MaskPipelineParams& b) {
  a.look_back = b.look_back;
  a.memory = b.memory;
  a.radar_min_residual = b.radar_min_residual;
  return sameFields(a, b);
}

/// The motion is refined by the pairs themselves.
MotionDepthParams followed() {
  MotionDepthParams params;
  params.refine = false;
  return params;
}

/// The only place that says which dynamic returns may raise a score: those that a mask alone called dynamic
/// must not confirm that mask.
bool showsOwnMotion(const CloudPoint& point, double min_residual) {
  return std::isnan(point.residual) || std::abs(point.residual) >= static_cast<float>(min_residual);
}

/// 255 where a file is white; empty without one.
cv::Mat readIgnoreMask(const std::string& file) {
  if (file.empty()) return {};
  const cv::Mat image = cv::imread(file, cv::IMREAD_GRAYSCALE);
  if (image.empty())
    throw InvalidParameter({"ignore_mask"}, "ignore_mask: " + file + ": cannot be read as an image");
  constexpr int kWhite = 128;
  return image >= kWhite;
}

}  // namespace

void MaskPipelineParams::describe(FieldList& fields) {
  motion.describe(fields);
  fields.group("Radar");
  fields.add(
      "radar_min_residual", radar_min_residual,
      "Dynamic returns whose own Doppler residual is smaller are ignored: a mask must not confirm itself",
      "m/s", {0.0, 100.0});
  fields.group("Uncertainty");
  fields.add("use_depth_uncertainty", use_depth_uncertainty,
             "Take the uncertainty of depth from depth/uncertainty, pixel by pixel, where available; for the "
             "refinement as well");
  motion_uncertainty.describe(fields);
  fields.group("Refinement");
  fields.add("refine", refine,
             "Refine the motion, pitch and roll above all, by the image; published on ego/twist_refined");
  fields.add("refine_ground", refine_ground,
             "The depth shows the ground plane below, as depth_backend radar_ground draws it: refine its "
             "pitch and height as well");
  ground.describe(fields);
  refinement.describe(fields);
  fields.group("History");
  fields.add(
      "motion_depth", motion_depth,
      "Where nothing speaks for a mover, depth is followed from image to image and measured by the parallax "
      "of the vehicle's motion; needs the backward flow (score uncertainty)");
  fields.add("look_back", look_back,
             "Score the first image against the previous image as well; needs the backward flow "
             "(forward_backward; score uncertainty)");
  fields.add(
      "memory", memory,
      "Time constant with which the previous mask, warped with the flow as log-odds, decays; 0: off (score "
      "uncertainty)",
      "s", {0.0, 60.0});
  fields.group("Vehicle in its image");
  fields.add("ignore_mask", ignore_mask,
             "Image file of the camera's shape that is white where bonnet, mirrors or wipers are seen: these "
             "pixels are not valid");
}

void validate(const MaskPipelineParams& params) {
  validateFields(params);
  validate(params.motion);
  readIgnoreMask(params.ignore_mask);
}

MaskPipeline::MaskPipeline(const MaskPipelineParams& params)
    : params_(params),
      segmenter_(params.motion),
      ignored_(readIgnoreMask(params.ignore_mask)),
      depth_(followed()) {}

void MaskPipeline::configure(const MaskPipelineParams& params) {
  if (params.ignore_mask != params_.ignore_mask) {
    ignored_ = readIgnoreMask(params.ignore_mask);
    ignored_on_grid_.release();
  }
  if (!sameFields(params_.motion, params.motion)) segmenter_ = MotionSegmenter(params.motion);
  if (!sameScores(params_, params)) clear();
  params_ = params;
}

void MaskPipeline::clear() {
  backward_.clear();
  previous_.reset();
  depth_.clear();
}

void MaskPipeline::addBackward(double from, double to, const FlowField& flow) {
  backward_.push_back({from, to, {flow.flow.clone(), {}, flow.fb_error.clone()}});
  if (backward_.size() > kMaxBackward) backward_.pop_front();
}

MotionInput MaskPipeline::inputOf(const MaskPair& pair) const {
  MotionInput input;
  input.camera = pair.camera;
  input.pixel_scale = pair.pixel_scale;
  input.T_current_from_previous = staticPointMotion(pair.T_base_from_camera, pair.T_first_from_second);
  input.duration = pair.second_time - pair.first_time;
  input.flow = pair.flow.flow;
  // The forward-backward error is noise to the score by uncertainty, and no reason to leave a pixel out.
  if (params_.byUncertainty() && !pair.flow.fb_error.empty()) {
    input.fb_error = pair.flow.fb_error;
    if (!pair.flow.grey.empty()) input.texture_std = textureStd(pair.flow.grey);
  } else {
    input.flow_valid = pair.flow.valid;
  }
  input.grey = pair.flow.grey;
  input.second_grey = pair.flow.second_grey;
  input.depth = pair.depth;
  if (!ignored_on_grid_.empty()) {
    input.depth = pair.depth.clone();
    input.depth.setTo(kUnknown, ignored_on_grid_);
  }
  input.next_depth = pair.next_depth;
  if (params_.refine_ground) input.ground = GroundPlane{pair.T_base_from_camera, params_.ground};
  if (params_.usesDepthUncertainty()) input.depth_std = pair.depth_std;
  if (params_.byUncertainty() || params_.refine || pair.wants_motion_depth) {
    const double dt = std::abs(pair.second_time - pair.first_time);
    input.motion_covariance =
        cameraCovariance(pair.T_base_from_camera, baseMotionCovariance(pair.motion_uncertainty, dt));
  }
  const Eigen::Isometry3f T_camera_from_base = pair.T_base_from_camera.inverse().cast<float>();
  if (params_.motion.radar.dynamic_gain > 0.0) {
    for (const CloudPoint& point : pair.dynamic_points) {
      if (showsOwnMotion(point, params_.radar_min_residual))
        input.dynamic_points.push_back({T_camera_from_base * point.position, point.residual});
    }
  }
  if (params_.motion.radar.static_gain > 0.0) {
    for (const CloudPoint& point : pair.static_points)
      input.static_points.push_back({T_camera_from_base * point.position, point.residual});
  }
  return input;
}

const cv::Mat& MaskPipeline::ignoredOn(const cv::Size& grid) {
  if (ignored_.empty() || ignored_on_grid_.size() == grid) return ignored_on_grid_;
  const double rows = static_cast<double>(ignored_.rows) * grid.width / ignored_.cols;
  constexpr double kRounding = 0.02;
  if (std::abs(rows - grid.height) > std::max(1.0, kRounding * rows))
    throw std::invalid_argument(
        fmt::format("ignore_mask {} of {} x {} px does not have the shape of {} x {} px", params_.ignore_mask,
                    ignored_.cols, ignored_.rows, grid.width, grid.height));
  // Not 0 where a part of a pixel is ignored.
  cv::resize(ignored_, ignored_on_grid_, grid, 0.0, 0.0, cv::INTER_AREA);
  return ignored_on_grid_;
}

/// Motion, its covariance, and where depth shows the ground, both depths, by the image.
/// @return RefinedMotion::rotation_weight
double MaskPipeline::refine(MotionInput& input) const {
  return refineInput(input, input.ground, params_.motion.max_depth, params_.motion.uncertainty.noise,
                     params_.refinement);
}

/// From the first image of a pair to that of the previous one; null where there is none.
const FlowField* MaskPipeline::backwardTo(const MaskPair& pair) const {
  if (!previous_ || previous_->second_time != pair.first_time) return nullptr;
  const cv::Size grid = pair.flow.flow.size();
  for (const Backward& backward : backward_) {
    if (backward.from != pair.first_time || backward.to != previous_->first_time) continue;
    // Where the grid was changed meanwhile, there is no past.
    const bool same_grid = backward.field.flow.size() == grid && previous_->log_odds.size() == grid;
    return same_grid ? &backward.field : nullptr;
  }
  return nullptr;
}

/// What is believed of the pixels of the first image; empty where the previous mask does not reach it.
cv::Mat MaskPipeline::beliefFor(const MaskPair& pair, const FlowField* backward) const {
  if (!previous_ || previous_->log_odds.size() != pair.flow.flow.size()) return {};
  // Flow that runs back in time leads from the first image of a pair to that of the previous pair by itself.
  const bool runs_back = pair.second_time == previous_->first_time && previous_->first_time < pair.first_time;
  if (runs_back) backward = &pair.flow;
  if (backward == nullptr) return {};
  return carriedBelief(previous_->log_odds, backward->flow,
                       forgetting(pair.first_time - previous_->first_time, params_.memory));
}

/// Of the inverse depth, relative; a copy.
cv::Mat MaskPipeline::priorStd(const MotionInput& input) const {
  return input.depth_std.empty()
             ? cv::Mat(input.depth.size(), CV_32FC1, cv::Scalar(params_.motion.uncertainty.noise.depth_std))
             : input.depth_std.clone();
}

MotionDepthResult MaskPipeline::followDepth(const MaskPair& pair, const FlowField* backward,
                                            const MotionInput& input) {
  MotionDepthInput seen{
      pair.camera, pair.pixel_scale, pair.first_time,
      input.depth, priorStd(input),  farthestGround(pair.camera, pair.T_base_from_camera, params_.ground),
      {}};
  if (backward != nullptr && !backward->fb_error.empty()) {
    seen.step =
        MotionDepthInput::Step{previous_->first_time, previous_->input.T_current_from_previous,
                               previous_->input.motion_covariance, backward->flow, backward->fb_error};
  }
  MotionDepthResult followed = depth_.update(seen);
  if (ignored_on_grid_.empty()) return followed;
  followed.origin.setTo(static_cast<int>(DepthOrigin::kPrior), ignored_on_grid_);
  followed.depth.setTo(kUnknown, ignored_on_grid_);
  followed.relative_std.setTo(kUnknown, ignored_on_grid_);
  return followed;
}

/// Takes the followed depth where it was measured, and neither radar nor an earlier mask speaks for a mover:
/// on what moves along with the epipolar line it is wrong, and sure of itself.
void MaskPipeline::takeDepth(const MotionDepthResult& followed, MotionInput& input) const {
  if (!followed.followed) return;
  cv::Mat is_static = followed.origin == static_cast<int>(DepthOrigin::kMotion);
  cv::Mat returns = cv::Mat::zeros(is_static.size(), CV_16UC1);
  drawReturns(input.camera, input.dynamic_points, params_.motion.radar, 1, returns);
  is_static.setTo(0, returns > 0);
  if (!input.belief.empty()) is_static.setTo(0, input.belief > 0.0);
  input.depth = input.depth.clone();
  followed.depth.copyTo(input.depth, is_static);
  input.depth_std = priorStd(input);
  followed.relative_std.copyTo(input.depth_std, is_static);
}

void MaskPipeline::remember(const MaskPair& pair, const MaskOutcome& outcome) {
  previous_ = Previous{pair.first_time, pair.second_time, outcome.input, logOdds(outcome.result)};
  MotionInput& input = previous_->input;
  static_cast<MotionEvidence&>(input) = {};
  input.flow = input.second_grey = input.flow_valid = input.fb_error = input.texture_std = input.depth_std =
      cv::Mat();
  input.grey = input.grey.clone();
  input.depth = input.depth.clone();
  input.next_depth = input.next_depth.clone();
  const auto is_used = [&pair](const Backward& backward) { return backward.from <= pair.first_time; };
  backward_.erase(std::remove_if(backward_.begin(), backward_.end(), is_used), backward_.end());
}

MaskOutcome MaskPipeline::process(const MaskPair& pair) {
  const cv::Mat& ignored = ignoredOn(pair.depth.size());
  MaskOutcome outcome;
  MotionInput& input = outcome.input;
  input = inputOf(pair);
  if (params_.refine) {
    const auto begin = std::chrono::steady_clock::now();
    outcome.rotation_weight = refine(input);
    outcome.refinement_seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }
  const FlowField* backward = backwardTo(pair);
  if (params_.remembers()) input.belief = beliefFor(pair, backward);
  if (!ignored.empty() && !input.belief.empty()) input.belief.setTo(kUnknown, ignored);
  if (params_.followsDepth() || pair.wants_motion_depth)
    outcome.motion_depth = followDepth(pair, backward, input);
  if (params_.followsDepth()) takeDepth(*outcome.motion_depth, input);
  std::optional<MotionInput> before;
  if (params_.looksBack() && backward != nullptr) {
    before = previousPairFromFirst(input, previous_->input, backward->flow, backward->fb_error);
    const cv::Mat uncovered = uncoveredPixels(*before, previous_->log_odds, previous_->input.depth,
                                              params_.motion.uncertainty.noise);
    if (!uncovered.empty()) before->flow_valid = ~uncovered;
  }
  outcome.looked_back = before.has_value();
  outcome.result = segmenter_.segment(input, before ? &*before : nullptr);
  if (params_.usesBackwardFlow() || pair.wants_motion_depth) remember(pair, outcome);
  return outcome;
}

}  // namespace radar_dot
