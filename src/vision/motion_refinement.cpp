// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/vision/motion_refinement.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "ground_ray.h"
#include "motion_images.h"
#include "radar_dot/common/quantile.h"
#include "radar_dot/common/stamped_twist.h"

namespace radar_dot {
namespace {

// omega, tau, and slope and height of the ground.
constexpr int kUnknowns = 8;
constexpr int kSlope = 6;
constexpr int kHeight = 7;
using Vector8 = Eigen::Matrix<double, kUnknowns, 1>;
using Matrix8 = Eigen::Matrix<double, kUnknowns, kUnknowns>;
using Jacobian = Eigen::Matrix<double, 2, kUnknowns>;

constexpr double kSameDepth = 0.01;  // fraction of the depth within which a pixel shows the plane
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kLeastPixels = 50;
constexpr double kMedianOfChiSquare = 1.3863;  // 2 degrees of freedom
constexpr double kExact = 1e-12;               // variances that stand for zero: a prior that holds
constexpr double kNegligible = 1e-4;           // change of the unknowns, squared, in units of their sigma
constexpr double kCredible = 11.34;            // squared sigmas that one of a hundred rotations exceeds
constexpr double kImpossible = 25.0;           // squared sigmas that no rotation has
constexpr double kTightestTurn = 4.0;          // m, radius

struct Pixel {
  double u = 0.0, v = 0.0;
  Eigen::Vector2d target = Eigen::Vector2d::Zero();  // where its flow leads
  double flow_variance = 0.0;                        // px^2 of the grid
  double rho = 0.0, rho_std = 0.0;                   // 1/m; relative
  bool is_ground = false;
};

class Refiner {
 public:
  Refiner(const MotionInput& input, const std::optional<GroundPlane>& ground, const FlowDepthNoise& noise,
          const RefinementParams& params)
      : input_(input),
        ground_(ground),
        noise_(noise),
        params_(params),
        motion_(input.T_current_from_previous) {
    Vector8 variances;
    variances.setConstant(kExact);
    Matrix8 prior = variances.asDiagonal();
    prior.topLeftCorner<6, 6>() += input.motion_covariance;
    if (ground) {
      prior(kSlope, kSlope) = std::max(std::pow(ground->params.uncertainty.pitch_std, 2), kExact);
      prior(kHeight, kHeight) = std::max(std::pow(ground->params.uncertainty.height_std, 2), kExact);
      slope_ = std::tan(ground->params.pitch);
      height_ = ground->params.height;
    }
    prior_information_ = information_ = prior.llt().solve(Matrix8::Identity());
    const Eigen::Matrix3d rotation = input.motion_covariance.topLeftCorner<3, 3>();
    if (Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(rotation).eigenvalues()[0] > kExact)
      rotation_information_ = (rotation + kExact * Eigen::Matrix3d::Identity()).inverse();
    collect();
  }

  RefinedMotion run() {
    RefinedMotion refined;
    refined.T_current_from_previous = motion_;
    refined.covariance = input_.motion_covariance;
    refined.ground = ground_;
    refined.pixels = pixels_.size();
    if (pixels_.size() < kLeastPixels) return refined;
    for (int i = 0; i < params_.iterations && step() > kNegligible; ++i) continue;
    if (!isPossible()) return refined;
    refined.T_current_from_previous = motion_;
    refined.correction = total_.head<6>();
    refined.rotation_weight = rotationWeight();
    const Matrix8 covariance = information_.llt().solve(Matrix8::Identity());
    refined.covariance = covariance.topLeftCorner<6, 6>();
    if (ground_) {
      const double slope = slope_ + total_[kSlope];
      GroundParams& plane = refined.ground->params;
      plane.pitch = std::atan(slope);
      plane.height = height_ + total_[kHeight];
      plane.uncertainty.pitch_std = std::sqrt(covariance(kSlope, kSlope)) / (1.0 + slope * slope);
      plane.uncertainty.height_std = std::sqrt(covariance(kHeight, kHeight));
    }
    return refined;
  }

 private:
  double rotationWeight() const;
  bool isPossible() const;
  void collect();
  bool residual(const Pixel& pixel, Eigen::Vector2d& r, Eigen::Matrix2d& information,
                Jacobian& jacobian) const;
  /// @return change of the unknowns, squared, in units of their sigma
  double step();

  const MotionInput& input_;
  const std::optional<GroundPlane>& ground_;
  const FlowDepthNoise& noise_;
  const RefinementParams& params_;
  Eigen::Isometry3d motion_;
  double slope_ = 0.0, height_ = 0.0;  // of the ground that was drawn
  std::vector<Pixel> pixels_;
  Matrix8 prior_information_, information_;
  Eigen::Matrix3d rotation_information_ = Eigen::Matrix3d::Zero();  // of the prior; zero: it holds
  Vector8 total_ = Vector8::Zero();

  // Of one step, kept for their memory.
  struct Term {
    Eigen::Vector2d r;
    Eigen::Matrix2d information;
    Jacobian jacobian;
    double distance;
  };
  std::vector<Term> terms_;
  std::vector<double> distances_;
};

/// A rotation that the image contradicts, wrong or late, loses its weight as pixels do.
double Refiner::rotationWeight() const {
  const Eigen::Vector3d omega = total_.head<3>();
  const double closeness = 1.0 / (1.0 + omega.dot(rotation_information_ * omega) / kCredible);
  return closeness * closeness;
}

/// A vehicle that stands does not turn, whatever fills its image: a lorry that passes. But it may be told
/// that it turns, and not do so.
bool Refiner::isPossible() const {
  const double turn = input_.T_current_from_previous.translation().norm() / kTightestTurn;
  Eigen::Matrix3d spread = input_.motion_covariance.topLeftCorner<3, 3>();
  spread.diagonal().array() += turn * turn / kImpossible + kExact;
  const auto is_possible = [llt = spread.llt()](const Eigen::Vector3d& omega) {
    return omega.dot(llt.solve(omega)) < kImpossible;
  };
  const Eigen::AngleAxisd whole(motion_.linear());
  return is_possible(total_.head<3>()) || is_possible(whole.angle() * whole.axis());
}

void Refiner::collect() {
  const CameraIntrinsics& camera = input_.camera;
  const int stride = strideOf(params_, input_.pixel_scale);
  const double flow_std = noise_.flow_std / input_.pixel_scale;
  for (int v = stride / 2; v < camera.height; v += stride) {
    for (int u = stride / 2; u < camera.width; u += stride) {
      if (!input_.flow_valid.empty() && input_.flow_valid.at<std::uint8_t>(v, u) == 0) continue;
      const auto depth = static_cast<double>(input_.depth.at<float>(v, u));
      const auto& seen = input_.flow.at<cv::Vec2f>(v, u);
      const Eigen::Vector2d flow(static_cast<double>(seen[0]), static_cast<double>(seen[1]));
      Pixel pixel;
      pixel.u = u;
      pixel.v = v;
      pixel.target = Eigen::Vector2d(u, v) + flow;
      const bool is_known = depth > 0.0 && std::isfinite(depth) && pixel.target.x() >= 0.0 &&
                            pixel.target.y() >= 0.0 && pixel.target.x() <= camera.width - 1 &&
                            pixel.target.y() <= camera.height - 1;  // false for NaN
      if (!is_known) continue;
      const double sigma = flow_std + noise_.flow_std_relative * flow.norm();
      pixel.flow_variance = sigma * sigma;
      if (!input_.fb_error.empty()) {
        const auto gap = static_cast<double>(input_.fb_error.at<float>(v, u));
        if (gap > 0.0) pixel.flow_variance += std::pow(noise_.fb_error_weight * gap, 2);
      }
      if (!input_.texture_std.empty()) {
        const auto texture = static_cast<double>(input_.texture_std.at<float>(v, u));
        if (texture > 0.0) pixel.flow_variance += texture * texture;
      }
      pixel.rho = 1.0 / depth;
      const double declared =
          input_.depth_std.empty() ? kUnknown : static_cast<double>(input_.depth_std.at<float>(v, u));
      pixel.rho_std = declared >= 0.0 ? declared : noise_.depth_std;  // also for NaN
      if (ground_) {
        const GroundRay ray = groundRay(camera, ground_->T_base_from_camera, u, v, slope_, height_);
        pixel.is_ground = std::abs(ray.rho * depth - 1.0) < kSameDepth;
        // The errors that all of the ground shares are unknowns here, not noise.
        if (pixel.is_ground) pixel.rho_std = ground_->params.uncertainty.relative_std;
      }
      pixels_.push_back(pixel);
    }
  }
}

/// @return false for a point that the motion brings behind the camera
bool Refiner::residual(const Pixel& pixel, Eigen::Vector2d& r, Eigen::Matrix2d& information,
                       Jacobian& jacobian) const {
  const CameraIntrinsics& camera = input_.camera;
  double rho = pixel.rho;
  GroundRay ray;
  if (pixel.is_ground) {
    ray = groundRay(camera, ground_->T_base_from_camera, pixel.u, pixel.v, slope_ + total_[kSlope],
                    height_ + total_[kHeight]);
    rho = std::max(ray.rho, 1e-3);
  }
  // X_t over D: only its direction counts.
  const Eigen::Vector3d t = motion_.translation();
  const Eigen::Vector3d seen = motion_.linear() * camera.rayOf(pixel.u, pixel.v) + rho * t;
  if (!(seen.z() > 1e-6)) return false;
  const double x = seen.x() / seen.z();
  const double y = seen.y() / seen.z();
  r = pixel.target - Eigen::Vector2d(camera.fx * x + camera.cx, camera.fy * y + camera.cy);
  const Eigen::Vector2d by_rho(camera.fx * (t.x() - x * t.z()) / seen.z(),
                               camera.fy * (t.y() - y * t.z()) / seen.z());
  const double q = rho / seen.z();  // 1 / Z_t
  jacobian.row(0) << -x * y, 1.0 + x * x, -y, q, 0.0, -x * q, 0.0, 0.0;
  jacobian.row(1) << -1.0 - y * y, x * y, x, 0.0, q, -y * q, 0.0, 0.0;
  jacobian.row(0) *= camera.fx;
  jacobian.row(1) *= camera.fy;
  if (pixel.is_ground) {
    jacobian.col(kSlope) = by_rho * ray.by_slope;
    jacobian.col(kHeight) = by_rho * ray.by_height;
  }
  const Eigen::Vector2d g = by_rho * (pixel.rho_std * rho);
  // Sherman and Morrison's inverse of flow_variance I + g g^T: no cancellation, however near the point is.
  information = (Eigen::Matrix2d::Identity() - g * g.transpose() / (pixel.flow_variance + g.squaredNorm())) /
                pixel.flow_variance;
  return true;
}

double Refiner::step() {
  terms_.clear();
  distances_.clear();
  for (const Pixel& pixel : pixels_) {
    Term term;
    if (!residual(pixel, term.r, term.information, term.jacobian)) continue;
    term.distance = term.r.dot(term.information * term.r);
    terms_.push_back(term);
    distances_.push_back(term.distance);
  }
  if (distances_.size() < kLeastPixels) return 0.0;
  // What the noise does not explain is in all pixels alike.
  const double scale = std::max(1.0, quantileOf(distances_) / kMedianOfChiSquare);
  const double width = 2.0 * params_.kernel_width * scale;  // the expectation of chi-square is 2
  const double share = std::min(1.0, params_.independent_pixels / static_cast<double>(terms_.size())) / scale;
  information_ = prior_information_;
  // The translation keeps its prior given the rotation: with a turn goes the way of the lever arm.
  information_.topLeftCorner<3, 3>() -= (1.0 - rotationWeight()) * rotation_information_;
  Vector8 gradient = -information_ * total_;
  for (const Term& term : terms_) {
    const double closeness = 1.0 / (1.0 + term.distance / width);
    const double weight = share * closeness * closeness;
    const Eigen::Matrix<double, kUnknowns, 2> weighted =
        weight * term.jacobian.transpose() * term.information;
    information_.noalias() += weighted * term.jacobian;
    gradient.noalias() += weighted * term.r;
  }
  const Vector8 change = information_.llt().solve(gradient);
  if (!change.allFinite()) return 0.0;
  total_ += change;
  const Eigen::Vector3d omega = change.head<3>();
  Eigen::Isometry3d small = Eigen::Isometry3d::Identity();
  if (omega.norm() > 0.0)
    small.linear() = Eigen::AngleAxisd(omega.norm(), omega.normalized()).toRotationMatrix();
  small.translation() = change.segment<3>(3);
  motion_ = small * motion_;
  return change.dot(information_ * change);
}

/// The values with those of `ground` where the depth shows the drawn one.
cv::Mat withGround(const cv::Mat& values, const cv::Mat& depth, const CameraIntrinsics& camera,
                   const GroundPlane& drawn, const cv::Mat& ground) {
  constexpr double kEverywhere = std::numeric_limits<double>::infinity();
  const cv::Mat before =
      groundDepth(camera, drawn.T_base_from_camera, drawn.params.height, drawn.params.pitch, kEverywhere);
  cv::Mat exchanged = values.clone();
  for (int row = 0; row < depth.rows; ++row) {
    const auto* depths = depth.ptr<float>(row);
    const auto* old_ground = before.ptr<float>(row);
    const auto* new_values = ground.ptr<float>(row);
    auto* pixels = exchanged.ptr<float>(row);
    for (int column = 0; column < depth.cols; ++column) {
      if (std::fabs(depths[column] / old_ground[column] - 1.0F) < static_cast<float>(kSameDepth))
        pixels[column] = new_values[column];
    }
  }
  return exchanged;
}

}  // namespace

Eigen::Matrix<double, 6, 6> baseMotionCovariance(const MotionUncertainty& uncertainty, double dt) {
  validate(uncertainty);
  const double tilt = uncertainty.tilt_std * std::sqrt(std::abs(dt));
  Eigen::Matrix<double, 6, 1> deviations;
  deviations << tilt, tilt, uncertainty.yaw_rate_std * dt, uncertainty.forward_velocity_std * dt,
      uncertainty.lateral_velocity_std * dt, uncertainty.vertical_velocity_std * dt;
  return deviations.cwiseAbs2().asDiagonal();
}

MotionUncertainty motionUncertainty(const MotionUncertainty& configured,
                                    const Eigen::Matrix<double, 6, 6>& twist, bool has_rotation) {
  MotionUncertainty uncertainty = configured;
  const auto widen = [&twist](Eigen::Index axis, double& deviation) {
    const double variance = twist(axis, axis);
    if (variance < kUnobservedVariance) deviation = std::max(deviation, std::sqrt(std::max(variance, 0.0)));
  };
  constexpr Eigen::Index kForward = 0, kLateral = 1, kVertical = 2, kYaw = 5;
  widen(kForward, uncertainty.forward_velocity_std);
  widen(kLateral, uncertainty.lateral_velocity_std);
  widen(kVertical, uncertainty.vertical_velocity_std);
  if (!has_rotation) widen(kYaw, uncertainty.yaw_rate_std);
  return uncertainty;
}

int strideOf(const RefinementParams& params, double pixel_scale) {
  return std::max(1, static_cast<int>(std::lround(params.stride / pixel_scale)));
}

RefinedMotion refineMotion(const MotionInput& input, const std::optional<GroundPlane>& ground,
                           const FlowDepthNoise& noise, const RefinementParams& params) {
  validate(noise);
  validate(params);
  requireImage(input.flow, CV_32FC2, input.camera, "flow", "CV_32FC2");
  requireImage(input.depth, CV_32FC1, input.camera, "depth", "CV_32FC1");
  if (!input.flow_valid.empty())
    requireImage(input.flow_valid, CV_8UC1, input.camera, "flow_valid", "CV_8UC1");
  if (!input.fb_error.empty()) requireImage(input.fb_error, CV_32FC1, input.camera, "fb_error", "CV_32FC1");
  for (const auto& [image, name] :
       {std::pair(&input.depth_std, "depth_std"), {&input.texture_std, "texture_std"}})
    if (!image->empty()) requireImage(*image, CV_32FC1, input.camera, name, "CV_32FC1");
  return Refiner(input, ground, noise, params).run();
}

cv::Mat replaceGroundDepth(const cv::Mat& depth, const CameraIntrinsics& camera, const GroundPlane& drawn,
                           const GroundPlane& refined, double max_depth) {
  requireImage(depth, CV_32FC1, camera, "depth", "CV_32FC1");
  return withGround(depth, depth, camera, drawn,
                    groundDepth(camera, refined.T_base_from_camera, refined.params.height,
                                refined.params.pitch, max_depth));
}

cv::Mat replaceGroundStd(const cv::Mat& relative_std, const cv::Mat& depth, const CameraIntrinsics& camera,
                         const GroundPlane& drawn, const RefinedMotion& refined) {
  requireImage(depth, CV_32FC1, camera, "depth", "CV_32FC1");
  requireImage(relative_std, CV_32FC1, camera, "relative_std", "CV_32FC1");
  if (!refined.ground) return relative_std;
  return withGround(relative_std, depth, camera, drawn,
                    groundRelativeStd(camera, drawn.T_base_from_camera, refined.ground->params));
}

double refineInput(MotionInput& input, const std::optional<GroundPlane>& ground, double max_depth,
                   const FlowDepthNoise& noise, const RefinementParams& params) {
  const RefinedMotion refined = refineMotion(input, ground, noise, params);
  input.T_current_from_previous = refined.T_current_from_previous;
  input.motion_covariance = refined.covariance;
  if (!ground) return refined.rotation_weight;
  if (!input.depth_std.empty())
    input.depth_std = replaceGroundStd(input.depth_std, input.depth, input.camera, *ground, refined);
  input.depth = replaceGroundDepth(input.depth, input.camera, *ground, *refined.ground, max_depth);
  if (input.next_depth.empty()) return refined.rotation_weight;
  // The backend draws the same plane in the base frame of both images. The ground does not turn with the
  // base: at t it is the plane found at t-1, seen from a base that has turned and stands on it as before.
  const Eigen::Isometry3d& mount = ground->T_base_from_camera;
  Eigen::Isometry3d turned = Eigen::Isometry3d::Identity();
  turned.linear() = (mount * input.T_current_from_previous.inverse() * mount.inverse()).linear();
  const GroundPlane next{turned * mount, refined.ground->params};
  input.next_depth = replaceGroundDepth(input.next_depth, input.camera, *ground, next, max_depth);
  return refined.rotation_weight;
}

}  // namespace radar_dot
