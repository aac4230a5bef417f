// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/motion_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "depth_backends.h"
#include "motion_images.h"
#include "parallel_rows.h"
#include "radar_dot/vision/motion_terms.h"
#include "radar_dot/vision/rigid_motion.h"
#include "vectorised.h"

namespace radar_dot {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kSmallest = 1e-4F;    // 1/m, of what is as good as infinitely far
constexpr float kUnknownRho = 0.01F;  // 1/m, of a pixel without prior, known to
constexpr float kUnknownStd = 0.03F;  // this, 1/m: until it is measured it has no depth
constexpr float kNearest = 0.05F;     // of w: a point that comes that much nearer is passed
constexpr double kMeasureStd = 0.02;  // of a measurement, share: what flows of consecutive images share

constexpr auto kPrior = static_cast<std::uint8_t>(DepthOrigin::kPrior);
constexpr auto kMotion = static_cast<std::uint8_t>(DepthOrigin::kMotion);
constexpr auto kRefused = static_cast<std::uint8_t>(DepthOrigin::kRefused);

struct Estimate {
  float rho = 0.0F, variance = 0.0F;
};

Estimate startOf(float depth, float relative_std) {
  if (!(depth > 0.0F)) return {kUnknownRho, kUnknownStd * kUnknownStd};
  const float rho = 1.0F / depth;
  const float sigma = rho * relative_std;
  return {rho, sigma * sigma};
}

/// The forward-backward error up to which a flow is taken.
struct GapLimit {
  explicit GapLimit(const MotionDepthParams& params)
      : absolute(static_cast<float>(params.max_fb_error)),
        relative(static_cast<float>(params.max_fb_error_relative)) {}
  bool allows(const cv::Vec2f& flow, float gap) const {
    return gap <= absolute + relative * std::sqrt(flow.dot(flow));  // false for NaN
  }
  float absolute, relative;
};

/// How the depth of a point changes from image to image, in single precision.
struct Carrier {
  Carrier(const CameraIntrinsics& camera, const MotionDepthInput::Step& step, double growth)
      : growth_squared(static_cast<float>(growth * growth)) {
    const Eigen::RowVector3d ahead = step.T_current_from_previous.linear().row(2) * camera.matrix().inverse();
    by_u = static_cast<float>(ahead[0]);
    by_v = static_cast<float>(ahead[1]);
    at_origin = static_cast<float>(ahead[2]);
    t_z = static_cast<float>(step.T_current_from_previous.translation().z());
  }

  /// @param u, v  px, where the pixel was  @return false where the camera has passed it
  bool carry(float u, float v, const Estimate& before, Estimate& now) const {
    const float ahead = by_u * u + by_v * v + at_origin;
    const float w = ahead + before.rho * t_z;
    if (!(w > kNearest)) return false;
    const float over_w = 1.0F / w;
    const float slope = ahead * over_w * over_w;
    now.rho = before.rho * over_w;
    now.variance = before.variance * slope * slope + growth_squared * now.rho * now.rho;
    return true;
  }

  float by_u = 0.0F, by_v = 0.0F, at_origin = 0.0F, t_z = 0.0F, growth_squared;
};

/// What measuring a pixel needs, in single precision.
struct Epipolar {
  Epipolar(const CameraIntrinsics& camera, const MotionDepthInput::Step& step,
           const MotionDepthParams& params)
      : back(camera, step.T_current_from_previous.inverse()),
        flow_std(static_cast<float>(params.flow_std)),
        flow_std_relative(static_cast<float>(params.flow_std_relative)),
        fb_weight_squared(static_cast<float>(params.fb_error_weight * params.fb_error_weight)),
        gate(static_cast<float>(params.max_deviation * params.max_deviation)) {
    const auto& covariance = step.motion_covariance;
    const double f_squared = camera.fx * camera.fy;
    turn_variance = static_cast<float>(f_squared * std::max(covariance(0, 0), covariance(1, 1)));
    shift_variance = static_cast<float>(f_squared * std::max(covariance(3, 3), covariance(4, 4)));
    const double baseline = step.T_current_from_previous.translation().squaredNorm();
    scale_variance = static_cast<float>(kMeasureStd * kMeasureStd + covariance(5, 5) / baseline);
  }

  /// No branches, so that the compiler works on several pixels at once.
  /// @param u, v  px  @param x, y  px, its flow  @param gap  px
  /// @return is it a static point? Else the estimate stays.
  bool update(float u, float v, float x, float y, float gap, Estimate& estimate) const {
    const auto& H = back.H;
    const float there_u = u + x;
    const float there_v = v + y;
    const float far_z = H[2][0] * u + (H[2][1] * v + H[2][2]);
    const float a_u = H[0][0] * u + (H[0][1] * v + H[0][2]) - there_u * far_z;
    const float a_v = H[1][0] * u + (H[1][1] * v + H[1][2]) - there_v * far_z;
    const float b_u = back.h[0] - there_u * back.h[2];
    const float b_v = back.h[1] - there_v * back.h[2];
    const float b_squared = b_u * b_u + b_v * b_v;
    const float over_b = 1.0F / b_squared;
    const float w = far_z + estimate.rho * back.h[2];
    const float parallax = std::sqrt(a_u * a_u + a_v * a_v) / far_z;
    const float noise = flow_std + flow_std_relative * parallax;
    const float s_squared = noise * noise + fb_weight_squared * gap * gap + turn_variance +
                            shift_variance * estimate.rho * estimate.rho;
    const float variance_there = s_squared * w * w;  // of a, across and along
    const float across = a_u * b_v - a_v * b_u;
    const float measured = -(a_u * b_u + a_v * b_v) * over_b;
    const float own_variance = variance_there * over_b;
    const float behind = measured < 0.0F ? measured : 0.0F;
    const bool is_static =
        (across * across <= gate * b_squared * variance_there) & (behind * behind <= 4.0F * own_variance);
    const float variance = own_variance + scale_variance * measured * measured;
    const float innovation = measured - estimate.rho;
    const float widened = innovation * innovation / gate - variance;
    const float before = widened > estimate.variance ? widened : estimate.variance;
    const float gain = before / (before + variance);
    const float rho = estimate.rho + gain * innovation;
    const float bounded = rho > kSmallest ? rho : kSmallest;
    estimate.rho = is_static ? bounded : estimate.rho;
    estimate.variance = is_static ? (1.0F - gain) * before : estimate.variance;
    return is_static;
  }

  motion_terms::PixelMotion back;
  float flow_std, flow_std_relative, fb_weight_squared, gate;
  float turn_variance = 0.0F, shift_variance = 0.0F;  // px^2, px^2 m^2
  float scale_variance = 0.0F;                        // share, squared
};

/// What a block of a row measures.
struct MeasuredBlock {
  static constexpr int kPixels = 256;
  std::array<float, kPixels> rho, variance;
  std::array<std::uint8_t, kPixels> is_static;
};

RADAR_DOT_VECTORISED void measureBlock(const Epipolar& epipolar, int row, int begin, int count,
                                       const float* flows, const float* gaps, const float* rho,
                                       const float* variance, MeasuredBlock& block) {
  const Epipolar constants = epipolar;
  const auto v = static_cast<float>(row);
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Estimate estimate{rho[i], variance[i]};
    const bool is_static =
        constants.update(static_cast<float>(begin + i), v, flows[2 * i], flows[2 * i + 1], gaps[i], estimate);
    block.rho[k] = estimate.rho;
    block.variance[k] = estimate.variance;
    block.is_static[k] = is_static ? 1 : 0;
  }
}

void check(const MotionDepthInput& input) {
  requireImage(input.prior_depth, CV_32FC1, input.camera, "prior_depth", "CV_32FC1");
  requireImage(input.prior_std, CV_32FC1, input.camera, "prior_std", "CV_32FC1");
  if (!input.farthest.empty()) requireImage(input.farthest, CV_32FC1, input.camera, "farthest", "CV_32FC1");
  if (!input.step) return;
  requireImage(input.step->flow_back, CV_32FC2, input.camera, "flow_back", "CV_32FC2");
  requireImage(input.step->fb_error, CV_32FC1, input.camera, "fb_error", "CV_32FC1");
}

/// The backend.
class MotionDepthEstimator : public DepthEstimator {
 public:
  explicit MotionDepthEstimator(const DepthParams& params)
      : prior_(makeRadarGroundDepth(params)),
        filter_(params.motion),
        ground_(params.radar_ground.ground),
        max_depth_(params.max_depth) {}

  DepthNeeds needs() const override {
    DepthNeeds needs = prior_->needs();
    needs.motion = true;
    return needs;
  }

  cv::Mat estimate(const DepthInput& input) override {
    const cv::Mat prior = prior_->estimate(input);
    const cv::Mat prior_std = prior_->relativeStd(input, prior);
    MotionDepthResult result =
        filter_.update({input.camera, input.pixel_scale, input.time, prior, prior_std,
                        farthestGround(input.camera, input.T_base_from_camera, ground_), input.step});
    const cv::Mat refused = result.origin == kRefused;
    prior.copyTo(result.depth, refused);
    prior_std.copyTo(result.relative_std, refused);
    stds_ = result.relative_std;
    result.depth = cv::min(result.depth, max_depth_);
    return result.depth;
  }

  /// Of the latest depth.
  cv::Mat relativeStd(const DepthInput& /*input*/, const cv::Mat& depth) const override {
    if (depth.type() != CV_32FC1 || depth.size() != stds_.size())
      throw std::invalid_argument("depth 'motion': the depth must be the latest one");
    cv::Mat stds = stds_.clone();
    stds.setTo(std::numeric_limits<double>::quiet_NaN(), ~(depth == depth));
    return stds;
  }

 private:
  std::unique_ptr<DepthEstimator> prior_;
  MotionDepth filter_;
  GroundParams ground_;
  double max_depth_;  // m
  cv::Mat stds_;
};

}  // namespace

std::unique_ptr<DepthEstimator> makeMotionDepth(const DepthParams& params) {
  return std::make_unique<MotionDepthEstimator>(params);
}

void MotionDepthParams::describe(FieldList& fields) {
  fields.group("MotionDepth");
  fields.add("motion_max_interval", max_interval,
             "Longest time between two images whose flow measures depth; images farther apart show the prior",
             "s", {0.0, 10.0});
  fields.add("motion_min_baseline", min_baseline, "Way of the camera below which it stands", "m",
             {1e-6, 10.0});
  fields.add("motion_flow_std", flow_std, "1 sigma of each component of the optical flow, px of the grid",
             "px", {0.01, 100.0});
  fields.add("motion_flow_std_relative", flow_std_relative,
             "In addition, as a fraction of the parallax of the pixel", "", {0.0, 10.0});
  fields.add("motion_fb_error_weight", fb_error_weight,
             "In addition, as a fraction of the forward-backward error", "", {0.0, 10.0});
  fields.add("motion_max_fb_error", max_fb_error,
             "Forward-backward error from which on a pixel is reset, px of the grid", "px", {0.0, 1000.0});
  fields.add("motion_max_fb_error_relative", max_fb_error_relative,
             "In addition, as a fraction of the length of the flow", "", {0.0, 10.0});
  fields.add("motion_growth", growth,
             "1 sigma that the inverse depth of a pixel gains when it is carried to the next image, relative",
             "", {0.0, 10.0});
  fields.add("motion_max_deviation", max_deviation,
             "Sigmas across the epipolar line from which on a pixel is no static point", "", {0.1, 100.0});
  fields.add("motion_refine", refine, "Refine the motion by the image first");
}

MotionDepth::MotionDepth(const MotionDepthParams& params) : params_(params) { validateFields(params_); }

void MotionDepth::clear() { state_.reset(); }

bool MotionDepth::follows(const MotionDepthInput& input) const {
  return state_ && input.step && input.step->previous_time == state_->time &&
         std::abs(input.time - state_->time) <= params_.max_interval &&
         state_->rho.size() == input.prior_depth.size();
}

/// The state of the previous image at the pixels of this one; where it does not reach, the prior.
MotionDepth::State MotionDepth::predicted(const MotionDepthInput& input, bool moved) {
  const cv::Size size = input.prior_depth.size();
  State state = std::move(spare_);
  state.time = input.time;
  state.rho.create(size, CV_32FC1);
  state.variance.create(size, CV_32FC1);
  state.origin.create(size, CV_8UC1);
  const bool followed = follows(input);
  const Carrier carrier(input.camera, followed ? *input.step : MotionDepthInput::Step(),
                        moved ? params_.growth : 0.0);
  const GapLimit limit(params_);
  const float end_u = static_cast<float>(size.width) - 0.5F;
  const float end_v = static_cast<float>(size.height) - 0.5F;
  parallelRows(size.height, [&](int row) {
    const float* priors = input.prior_depth.ptr<float>(row);
    const float* stds = input.prior_std.ptr<float>(row);
    const cv::Vec2f* flow = followed ? input.step->flow_back.ptr<cv::Vec2f>(row) : nullptr;
    const float* gaps = followed ? input.step->fb_error.ptr<float>(row) : nullptr;
    float* rho = state.rho.ptr<float>(row);
    float* variance = state.variance.ptr<float>(row);
    auto* origin = state.origin.ptr<std::uint8_t>(row);
    for (int column = 0; column < size.width; ++column) {
      Estimate estimate = startOf(priors[column], stds[column]);
      origin[column] = kPrior;
      if (followed && limit.allows(flow[column], gaps[column])) {
        const float u = static_cast<float>(column) + flow[column][0];
        const float v = static_cast<float>(row) + flow[column][1];
        if (u > -0.5F && v > -0.5F && u < end_u && v < end_v) {
          const int before_u = static_cast<int>(u + 0.5F);
          const int before_v = static_cast<int>(v + 0.5F);
          const Estimate before{state_->rho.ptr<float>(before_v)[before_u],
                                state_->variance.ptr<float>(before_v)[before_u]};
          const std::uint8_t before_origin = state_->origin.ptr<std::uint8_t>(before_v)[before_u];
          // What was never measured follows the prior, which may have found something meanwhile.
          if (before_origin != kPrior && carrier.carry(u, v, before, estimate))
            origin[column] = before_origin;
        }
      }
      rho[column] = estimate.rho;
      variance[column] = estimate.variance;
    }
  });
  return state;
}

void MotionDepth::measure(const MotionDepthInput& input, const MotionDepthInput::Step& step,
                          State& state) const {
  const Epipolar epipolar(input.camera, step, params_);
  const GapLimit limit(params_);
  parallelRows(state.rho.rows, [&](int row) {
    const auto* flow = step.flow_back.ptr<cv::Vec2f>(row);
    const float* gaps = step.fb_error.ptr<float>(row);
    float* rho = state.rho.ptr<float>(row);
    float* variance = state.variance.ptr<float>(row);
    auto* origin = state.origin.ptr<std::uint8_t>(row);
    const float* farthest = input.farthest.empty() ? nullptr : input.farthest.ptr<float>(row);
    MeasuredBlock block;
    for (int begin = 0; begin < state.rho.cols; begin += MeasuredBlock::kPixels) {
      const int count = std::min(MeasuredBlock::kPixels, state.rho.cols - begin);
      measureBlock(epipolar, row, begin, count, flow[begin].val, gaps + begin, rho + begin, variance + begin,
                   block);
      for (int i = 0; i < count; ++i) {
        const auto k = static_cast<std::size_t>(i);
        const int column = begin + i;
        if (!limit.allows(flow[column], gaps[column])) continue;
        const bool is_static = block.is_static[k] != 0;
        if (is_static && farthest != nullptr && block.rho[k] * farthest[column] < 1.0F) {
          // It moves along: a fresh start, for when it has passed.
          const Estimate start =
              startOf(input.prior_depth.ptr<float>(row)[column], input.prior_std.ptr<float>(row)[column]);
          rho[column] = start.rho;
          variance[column] = start.variance;
          origin[column] = kRefused;
        } else if (is_static) {
          rho[column] = block.rho[k];
          variance[column] = block.variance[k];
          origin[column] = kMotion;
        } else if (origin[column] == kMotion) {
          origin[column] = kRefused;
        }
      }
    }
  });
}

/// Depth and its uncertainty: unknown where nothing was measured and there is no prior. Only the rows that a
/// refinement with this stride looks at; 1: all.
void MotionDepth::show(const State& state, const cv::Mat& prior, int stride, MotionDepthResult& result) {
  result.depth.create(state.rho.size(), CV_32FC1);
  result.relative_std.create(state.rho.size(), CV_32FC1);
  parallelRows((state.rho.rows - stride / 2 + stride - 1) / stride, [&](int index) {
    const int row = stride / 2 + index * stride;
    const float* priors = prior.ptr<float>(row);
    const float* rho = state.rho.ptr<float>(row);
    const float* variance = state.variance.ptr<float>(row);
    const auto* origin = state.origin.ptr<std::uint8_t>(row);
    float* depths = result.depth.ptr<float>(row);
    float* stds = result.relative_std.ptr<float>(row);
    for (int column = 0; column < state.rho.cols; ++column) {
      const bool is_known = origin[column] != kPrior || priors[column] > 0.0F;
      depths[column] = is_known ? 1.0F / rho[column] : kNaN;
      stds[column] = is_known ? std::sqrt(variance[column]) / rho[column] : kNaN;
    }
  });
}

/// Motion and covariance of a step by the image, whose predicted depth is given.
void MotionDepth::refine(const MotionDepthInput& input, const MotionDepthResult& predicted,
                         MotionDepthInput::Step& step) const {
  MotionInput seen;  // from this image
  seen.camera = input.camera;
  seen.pixel_scale = input.pixel_scale;
  seen.T_current_from_previous = step.T_current_from_previous.inverse();
  seen.motion_covariance = cameraCovariance(step.T_current_from_previous, step.motion_covariance);
  seen.flow = step.flow_back;
  seen.fb_error = step.fb_error;
  seen.depth = predicted.depth;
  seen.depth_std = predicted.relative_std;
  FlowDepthNoise noise;
  noise.flow_std = params_.flow_std * input.pixel_scale;
  noise.flow_std_relative = params_.flow_std_relative;
  noise.fb_error_weight = params_.fb_error_weight;
  const RefinedMotion refined = refineMotion(seen, std::nullopt, noise, params_.refinement);
  step.T_current_from_previous = refined.T_current_from_previous.inverse();
  step.motion_covariance = cameraCovariance(refined.T_current_from_previous, refined.covariance);
}

MotionDepthResult MotionDepth::update(const MotionDepthInput& input) {
  check(input);
  MotionDepthResult result;
  MotionDepthInput::Step step = input.step.value_or(MotionDepthInput::Step());
  result.followed = follows(input);
  result.measured =
      result.followed && step.T_current_from_previous.translation().norm() >= params_.min_baseline;
  State state = predicted(input, result.measured);
  if (result.measured) {
    if (params_.refine) {
      show(state, input.prior_depth, strideOf(params_.refinement, input.pixel_scale), result);
      refine(input, result, step);
    }
    measure(input, step, state);
  }
  result.T_current_from_previous = step.T_current_from_previous;
  show(state, input.prior_depth, 1, result);
  result.origin = state.origin.clone();
  if (state_) spare_ = std::move(*state_);
  state_ = std::move(state);
  return result;
}

}  // namespace radar_dot
