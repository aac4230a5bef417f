// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "motion_pass.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "vectorised.h"

namespace radar_dot {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

constexpr int kBlock = 256;  // pixels of a row that are worked on together,
                             // small enough for the nearest cache

/// A few pixels of a row on their way to a score. Arrays, and one simple loop for each step, so that the
/// compiler works on several pixels at once; constants are copied first, so that it knows they do not change
/// meanwhile.
struct PixelBlock {
  std::array<float, kBlock> u, v, depth_there, flow_part, tolerance, depth_part;
  // of the score by uncertainty
  std::array<float, kBlock> noise, depth_std, x, y, inverse_depth, uu, uv, vv;
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

/// Is a place in the image? Without branches; false for NaN.
inline bool isWithin(float u, float v, float last_u, float last_v) {
  return (static_cast<int>(u >= 0.0F) & static_cast<int>(v >= 0.0F) & static_cast<int>(u <= last_u) &
          static_cast<int>(v <= last_v)) != 0;
}

/// What is excluded: flow_part becomes NaN.
RADAR_DOT_VECTORISED void exclude(const PassConstants& pass, int row, int begin, int count,
                                  const float* depths, const float* flows, PixelBlock& block) {
  const float last_u = pass.last_u, last_v = pass.last_v, max_depth = pass.max_depth;
  const int anywhere = pass.predicted_in_view ? 0 : 1;
  const auto v = static_cast<float>(row);
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    // The flow must lead into the second image, and where asked for, the prediction too.
    const auto u = static_cast<float>(begin + i);
    const int counts = static_cast<int>(block.depth_there[k] > 0.0F) & static_cast<int>(depths[i] > 0.0F) &
                       static_cast<int>(depths[i] <= max_depth) &
                       static_cast<int>(isWithin(u + flows[2 * i], v + flows[2 * i + 1], last_u, last_v)) &
                       (anywhere | static_cast<int>(isWithin(block.u[k], block.v[k], last_u, last_v)));
    block.flow_part[k] = counts != 0 ? block.flow_part[k] : kNaN;
  }
}

/// The depth residual; what is hidden is excluded as well. As motion_terms::bilinear(), on many pixels at
/// once.
RADAR_DOT_VECTORISED void lookUpDepth(const PassConstants& pass, const motion_terms::FloatImage& next_depth,
                                      int count, PixelBlock& block) {
  namespace terms = motion_terms;
  const float* pixels = next_depth.pixels;
  const auto stride = static_cast<int>(next_depth.stride);
  const int last_column = next_depth.columns - 2, last_row = next_depth.rows - 2;
  const float last_u = pass.last_u, last_v = pass.last_v, max_depth = pass.max_depth;
  const float margin = pass.occlusion_margin;
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const bool inside = isWithin(block.u[k], block.v[k], last_u, last_v);
    const float u = inside ? block.u[k] : 0.0F;
    const float v = inside ? block.v[k] : 0.0F;
    const int x = std::min(static_cast<int>(u), last_column);
    const int y = std::min(static_cast<int>(v), last_row);
    const float a = u - static_cast<float>(x);
    const float b = v - static_cast<float>(y);
    const int above = y * stride + x, below = above + stride;
    const float top = pixels[above] + a * (pixels[above + 1] - pixels[above]);
    const float bottom = pixels[below] + a * (pixels[below + 1] - pixels[below]);
    const float seen = inside ? top + b * (bottom - top) : kNaN;
    const int known = static_cast<int>(seen > 0.0F) & static_cast<int>(seen <= max_depth);
    const float there = block.depth_there[k];
    const int hidden = known & static_cast<int>(terms::isOccluded(seen, there, margin));
    block.flow_part[k] = hidden != 0 ? kNaN : block.flow_part[k];
    block.depth_part[k] = known != 0 ? terms::depthResidual(seen, there) : 0.0F;
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

/// The optional images of the score by uncertainty, or their placeholders.
void readNoise(const PassConstants& pass, int count, const float* closures, const float* textures,
               const float* depth_stds, PixelBlock& block) {
  const auto end = [count](auto& values) { return values.begin() + count; };
  if (closures == nullptr) {
    std::fill(block.noise.begin(), end(block.noise), 0.0F);
  } else {
    std::transform(closures, closures + count, block.noise.begin(),
                   [weight = pass.fb_error_weight](float gap) {
                     return gap >= 0.0F ? weight * gap * weight * gap : 0.0F;
                   });
  }
  for (int i = 0; textures != nullptr && i < count; ++i)
    block.noise[static_cast<std::size_t>(i)] += textures[i] * textures[i];
  if (depth_stds == nullptr) {
    std::fill(block.depth_std.begin(), end(block.depth_std), pass.depth_std);
  } else {
    // In this order NaN becomes the default.
    std::transform(depth_stds, depth_stds + count, block.depth_std.begin(),
                   [fallback = pass.depth_std](float std) { return std >= 0.0F ? std : fallback; });
  }
}

/// What the errors of flow and depth add to the covariance.
RADAR_DOT_VECTORISED void spreadByInputs(const PassConstants& pass, int count, const float* depths,
                                         const float* flows, PixelBlock& block) {
  namespace terms = uncertainty_terms;
  const motion_terms::PixelMotion motion = pass.motion;
  const float flow_std = pass.flow_std;
  const float flow_std_relative = pass.flow_std_relative;
  const float cx = pass.cx, cy = pass.cy;
  const float x_by_u = 1.0F / pass.fx, y_by_v = 1.0F / pass.fy;
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const float flow_u = flows[2 * i];
    const float flow_v = flows[2 * i + 1];
    const float sigma = flow_std + flow_std_relative * std::sqrt(flow_u * flow_u + flow_v * flow_v);
    const float variance = sigma * sigma + block.noise[k];
    const terms::PixelShift shift =
        terms::byInverseDepth(motion, depths[i], {block.u[k], block.v[k], block.depth_there[k]});
    const float rho_std = block.depth_std[k] / depths[i];
    const float g_u = rho_std * shift.u;
    const float g_v = rho_std * shift.v;
    block.uu[k] = variance + g_u * g_u;
    block.uv[k] = g_u * g_v;
    block.vv[k] = variance + g_v * g_v;
    block.x[k] = (block.u[k] - cx) * x_by_u;
    block.y[k] = (block.v[k] - cy) * y_by_v;
    block.inverse_depth[k] = 1.0F / block.depth_there[k];
  }
}

/// What the error of the motion adds, in two of its directions: one pass over the block for both.
RADAR_DOT_VECTORISED void spreadByMotion(const PassConstants& pass,
                                         const uncertainty_terms::SmallMotion& direction,
                                         const uncertainty_terms::SmallMotion& other_direction, int count,
                                         PixelBlock& block) {
  namespace terms = uncertainty_terms;
  const terms::SmallMotion first = direction, second = other_direction;
  const float fx = pass.fx, fy = pass.fy;
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const float x = block.x[k], y = block.y[k], q = block.inverse_depth[k];
    const terms::PixelShift a = terms::byMotion(fx, fy, x, y, q, first);
    const terms::PixelShift b = terms::byMotion(fx, fy, x, y, q, second);
    block.uu[k] += a.u * a.u + b.u * b.u;
    block.uv[k] += a.u * a.v + b.u * b.v;
    block.vv[k] += a.v * a.v + b.v * b.v;
  }
}

/// Standard deviations from static. What is excluded, whose flow_part is NaN, stays so.
RADAR_DOT_VECTORISED void distanceBlock(const PassConstants& pass, int row, int begin, int count,
                                        const float* flows, const PixelBlock& block, float* scores) {
  const float next_depth_std = pass.next_depth_std;
  const auto v = static_cast<float>(row);
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto u = static_cast<float>(begin + i);
    const float squared = uncertainty_terms::squaredDistance(flows[2 * i] - (block.u[k] - u),
                                                             flows[2 * i + 1] - (block.v[k] - v),
                                                             {block.uu[k], block.uv[k], block.vv[k]});
    const float depth_distance = block.depth_part[k] / (next_depth_std * block.depth_there[k]);
    scores[i] = std::sqrt(squared + depth_distance * depth_distance) + 0.0F * block.flow_part[k];
  }
}

uncertainty_terms::PixelShift shiftBy(const PassConstants& pass, const motion_terms::Prediction& there,
                                      const uncertainty_terms::SmallMotion& motion) {
  return uncertainty_terms::byMotion(pass.fx, pass.fy, (there.u - pass.cx) / pass.fx,
                                     (there.v - pass.cy) / pass.fy, 1.0F / there.depth, motion);
}

Mover moverOf(const MotionInput& input, const CloudPoint& point) {
  constexpr double kAcross = 5.0;  // m/s, 1 sigma of what Doppler does not tell
  constexpr float kLength = 3.0F;  // m, 1 sigma of how far from its return a thing is seen
  const Eigen::Isometry3d& T = input.T_current_from_previous;
  const Eigen::Vector3d away = point.position.cast<double>().normalized();
  const Eigen::Vector3d across = away.cross(Eigen::Vector3d::UnitY()).normalized();
  Eigen::Isometry3d T_of_mover = T;
  T_of_mover.translation() += T.linear() * away * (static_cast<double>(point.residual) * input.duration);
  const Eigen::Vector3f spread = (T.linear() * across * (kAcross * input.duration)).cast<float>();
  return {motion_terms::PixelMotion(input.camera, T_of_mover),
          {0.0F, 0.0F, 0.0F, spread.x(), spread.y(), spread.z()},
          point.position.z(),
          kLength / (point.position.z() * point.position.z()),
          std::isfinite(point.residual)};
}

void add(const uncertainty_terms::PixelShift& shift, uncertainty_terms::Covariance& covariance) {
  covariance.uu += shift.u * shift.u;
  covariance.uv += shift.u * shift.v;
  covariance.vv += shift.v * shift.v;
}

/// What the errors of flow and of the motion add up to, where a pixel is predicted.
/// @param noise  px^2, besides that of all flow
uncertainty_terms::Covariance spreadAt(const PassConstants& pass, const motion_terms::Prediction& there,
                                       const float* flow, float noise) {
  const float sigma = pass.flow_std + pass.flow_std_relative * std::hypot(flow[0], flow[1]);
  uncertainty_terms::Covariance covariance{sigma * sigma + noise, 0.0F, sigma * sigma + noise};
  for (const uncertainty_terms::SmallMotion& direction : pass.spread)
    add(shiftBy(pass, there, direction), covariance);
  return covariance;
}

/// Squared standard deviations of the flow of a pixel from that of the thing that a return is of.
float squaredFromMover(const PassConstants& pass, const Mover& mover, float u, float v, const float* flow,
                       float noise) {
  const motion_terms::Prediction there = motion_terms::predict(mover.motion, u, v, mover.depth);
  if (!(there.depth > 0.0F)) return kNaN;
  uncertainty_terms::Covariance covariance = spreadAt(pass, there, flow, noise);
  const uncertainty_terms::PixelShift by_depth =
      uncertainty_terms::byInverseDepth(mover.motion, mover.depth, there);
  add({mover.inverse_depth_std * by_depth.u, mover.inverse_depth_std * by_depth.v}, covariance);
  add(shiftBy(pass, there, mover.across), covariance);
  return uncertainty_terms::squaredDistance(u + flow[0] - there.u, v + flow[1] - there.v, covariance);
}

constexpr float kExplained = 1.5F;  // standard deviations from static that need no mover

/// Moves the scores of a row by the returns whose footprints they lie in.
void weighByReturns(const PassConstants& pass, int row, const InputRow& input, int columns, float* scores) {
  for (int column = 0; column < columns; ++column) {
    const std::uint16_t footprint = input.footprint[column];
    if (footprint == kNoReturn) continue;
    if (footprint == kStaticReturn) {
      scores[column] *= pass.static_factor;
      continue;
    }
    const Mover& mover = pass.movers[static_cast<std::size_t>(footprint - kDynamicReturn)];
    const float score = scores[column];
    const float* flow = input.flows + 2 * static_cast<std::ptrdiff_t>(column);
    // The road beside a car, or below a ghost, moves as the road does.
    const bool is_contradicted =
        pass.by_uncertainty && mover.has_speed && score < kExplained &&
        squaredFromMover(pass, mover, static_cast<float>(column), static_cast<float>(row), flow,
                         flowNoise(pass, input, column)) > score * score;
    if (!is_contradicted) scores[column] *= pass.dynamic_factor;
  }
}

}  // namespace

PassConstants::PassConstants(const MotionInput& input, const MotionParams& params, double median)
    : motion(input.camera, input.T_current_from_previous),
      pixel_scale(static_cast<float>(input.pixel_scale)),
      lambda(static_cast<float>(params.paper.lambda)),
      min_depth(static_cast<float>(params.paper.min_depth)),
      max_depth(static_cast<float>(params.max_depth)),
      occlusion_margin(static_cast<float>(params.occlusion_margin)),
      median_depth(static_cast<float>(median)),
      flow_std(static_cast<float>(params.uncertainty.noise.flow_std / input.pixel_scale)),
      flow_std_relative(static_cast<float>(params.uncertainty.noise.flow_std_relative)),
      fb_error_weight(static_cast<float>(params.uncertainty.noise.fb_error_weight)),
      depth_std(static_cast<float>(params.uncertainty.noise.depth_std)),
      next_depth_std(static_cast<float>(params.uncertainty.next_depth_std)),
      fx(static_cast<float>(input.camera.fx)),
      fy(static_cast<float>(input.camera.fy)),
      cx(static_cast<float>(input.camera.cx)),
      cy(static_cast<float>(input.camera.cy)),
      spread(uncertainty_terms::spreadOf(input.motion_covariance)),
      by_uncertainty(params.score == MotionScore::kUncertainty),
      static_factor(static_cast<float>(1.0 / (1.0 + params.radar.static_gain))),
      dynamic_factor(static_cast<float>(1.0 + params.radar.dynamic_gain)),
      last_u(static_cast<float>(input.camera.width - 1)),
      last_v(static_cast<float>(input.camera.height - 1)),
      predicted_in_view(params.predicted_in_view) {
  const double grid_std = params.paper.foe_std / input.pixel_scale;
  const auto inverse_two_variance = static_cast<float>(1.0 / (2.0 * grid_std * grid_std));
  const auto foe = motion_terms::focusOfExpansion(input.camera, input.T_current_from_previous.translation());
  const auto factors = [&](std::vector<float>& along, int size, double centre) {
    along.assign(static_cast<std::size_t>(size),
                 0.0F);  // at infinity nothing is near
    for (int i = 0; foe && i < size; ++i) {
      along[static_cast<std::size_t>(i)] =
          motion_terms::foeFactor(static_cast<float>(i) - static_cast<float>(centre), inverse_two_variance);
    }
  };
  factors(foe_columns, input.camera.width, foe ? foe->x() : 0.0);
  factors(foe_rows, input.camera.height, foe ? foe->y() : 0.0);
  for (const CloudPoint& point : input.dynamic_points) movers.push_back(moverOf(input, point));
}

float flowNoise(const PassConstants& pass, const InputRow& input, int column) {
  const float error = input.closures == nullptr ? 0.0F : pass.fb_error_weight * input.closures[column];
  const float texture = input.textures == nullptr ? 0.0F : input.textures[column];
  return (error >= 0.0F ? error * error : 0.0F) + texture * texture;
}

float distanceFromStatic(const PassConstants& pass, float u, float v, float farthest, const float* flow,
                         float noise) {
  constexpr float kFarthest = 1e-3F;  // 1/m
  constexpr float kNearest = 0.25F;   // 1/m; what is nearer is seldom static
  constexpr float kDepthStd = 0.1F;   // of the inverse depth, share
  constexpr float kStanding = 1e-6F;  // px^2 m^2: all depths look alike
  const motion_terms::PixelMotion& motion = pass.motion;
  const auto rotated = [&](int i) { return motion.H[i][0] * u + motion.H[i][1] * v + motion.H[i][2]; };
  // H p + rho h is parallel to the pixel that the flow leads to, as far as it can be.
  const float to_u = u + flow[0], to_v = v + flow[1];
  const float a_u = rotated(0) - to_u * rotated(2), a_v = rotated(1) - to_v * rotated(2);
  const float b_u = motion.h[0] - to_u * motion.h[2], b_v = motion.h[1] - to_v * motion.h[2];
  const float squared = b_u * b_u + b_v * b_v;
  farthest = std::max(farthest, kFarthest);
  const float measured = squared > kStanding ? -(a_u * b_u + a_v * b_v) / squared : farthest;
  const float depth = 1.0F / std::clamp(measured, farthest, std::max(farthest, kNearest));
  const motion_terms::Prediction there = motion_terms::predict(motion, u, v, depth);
  if (!(there.depth > 0.0F)) return kNaN;
  uncertainty_terms::Covariance covariance = spreadAt(pass, there, flow, noise);
  const uncertainty_terms::PixelShift by_depth = uncertainty_terms::byInverseDepth(motion, depth, there);
  add({kDepthStd / depth * by_depth.u, kDepthStd / depth * by_depth.v}, covariance);
  return std::sqrt(uncertainty_terms::squaredDistance(to_u - there.u, to_v - there.v, covariance));
}

void scoreRow(const PassConstants& pass, const motion_terms::FloatImage& next_depth, int row,
              const InputRow& input, int columns, float* scores) {
  const auto from = [](auto* pixels, int begin) { return pixels == nullptr ? nullptr : pixels + begin; };
  PixelBlock block;
  for (int begin = 0; begin < columns; begin += kBlock) {
    const int count = std::min(kBlock, columns - begin);
    const float* depths = input.depths + begin;
    const float* flows = input.flows + 2 * begin;
    predictBlock(pass, row, begin, count, depths, flows, block);
    exclude(pass, row, begin, count, depths, flows, block);
    for (int i = 0; input.reliable != nullptr && i < count; ++i)
      if (input.reliable[begin + i] == 0) block.flow_part[static_cast<std::size_t>(i)] = kNaN;
    if (next_depth.pixels == nullptr) {
      block.depth_part.fill(0.0F);
    } else {
      lookUpDepth(pass, next_depth, count, block);
    }
    if (pass.by_uncertainty) {
      readNoise(pass, count, from(input.closures, begin), from(input.textures, begin),
                from(input.depth_stds, begin), block);
      spreadByInputs(pass, count, depths, flows, block);
      for (std::size_t i = 0; i < pass.spread.size(); i += 2) {
        const bool is_last = i + 1 == pass.spread.size();
        spreadByMotion(pass, pass.spread[i], is_last ? uncertainty_terms::SmallMotion{} : pass.spread[i + 1],
                       count, block);
      }
      distanceBlock(pass, row, begin, count, flows, block, scores + begin);
    } else {
      scoreBlock(pass, count, depths, block, scores + begin);
    }
  }
  if (input.footprint != nullptr) weighByReturns(pass, row, input, columns, scores);
}

}  // namespace radar_dot
