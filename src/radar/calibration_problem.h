// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <array>
#include <cstddef>
#include <map>
#include <tuple>
#include <vector>

#include "drive_spline.h"
#include "radar_dot/radar/radar_calibration.h"

namespace radar_dot {

/// The least-squares problem of calibrateRadars: quantities of the radars, and the motion of each drive.
class CalibrationProblem {
 public:
  using Index = Eigen::Index;
  /// Number of a quantity of a radar in `quantities`.
  static Index at(std::size_t radar, CalibrationQuantity quantity) {
    return static_cast<Index>(radar * kCalibrationQuantities + static_cast<std::size_t>(quantity));
  }
  Index delay() const { return static_cast<Index>(radars_.size() * kCalibrationQuantities); }
  Index bias() const { return delay() + 1; }

  /// @param use_reference  otherwise the radars alone tell the motion
  CalibrationProblem(const std::vector<CalibratedRadar>& radars, const std::vector<CalibrationDrive>& drives,
                     const CalibrationParams& params, bool use_reference);

  Eigen::VectorXd quantities;  ///< as they are: of a scale its value, of the delay all of it
  std::vector<bool> free;      ///< by quantity: estimated

  /// The motion alone, from the returns that are static within their scan.
  void start();
  /// One reweighted step. @return its largest part, in limits of use
  double step();
  /// Of the quantities, at the present ones.
  Eigen::MatrixXd covariance();

  bool references(int axis) const { return has_reference_[static_cast<std::size_t>(axis)]; }
  /// By radar: squares of the residuals of static returns, and how many those are.
  std::vector<std::pair<double, std::size_t>> residuals();
  /// Mean absolute difference of the motion from the reference.
  Eigen::Array3d differences() const;
  Eigen::Array3d excitation() const;  ///< root mean squares: yaw rate, acceleration, yaw acceleration
  /// By radar: scans whose own velocity is that of the motion, and those where it is reversed.
  std::vector<std::pair<std::size_t, std::size_t>> votes() const { return votes_; }

  static double limit(Index quantity, Index delay);

 private:
  struct Seen {
    std::size_t radar = 0;
    double time = 0.0;                       // s
    Eigen::Vector2d bearing;                 // base frame, in the plane
    double doppler = 0.0, tangential = 0.0;  // m/s
    bool starts = false;                     // static within its scan
  };
  struct Drive {
    DriveSpline spline;
    std::vector<Seen> seen;
    std::vector<ReferenceReading> reference;
  };
  /// A residual, its derivatives and its information.
  struct Row {
    DriveSpline::Place place;
    Eigen::Vector3d motion = Eigen::Vector3d::Zero();  // by vx, vy, yaw rate
    Eigen::Matrix<double, 6, 1> local = Eigen::Matrix<double, 6, 1>::Zero();
    double residual = 0.0, variance = 1.0, weight = 0.0;
    Index first = 0, last = 0;  // columns of local: five from `first`, and `last`
    std::size_t source = 0;     // radar; their number: reference
  };
  struct Equations {
    Eigen::SparseMatrix<double> motion;
    Eigen::MatrixXd mixed, common;
    Eigen::VectorXd motion_right, common_right;
    std::vector<Eigen::Matrix<double, 12, 12>> pieces;
  };

  void addDrive(const CalibrationDrive& drive);
  void addScan(const CalibrationScan& scan, Drive& drive, class EgoVelocityEstimator& estimator);
  void vote(const CalibrationDrive& drive);
  Row rowOf(const Drive& drive, const Seen& seen) const;
  template <typename Body>
  void forEachRow(const Drive& drive, const Body& body) const;
  template <typename Body>
  void forEachReference(const Drive& drive, const Body& body) const;
  template <typename Body>
  void forEachAssumption(const Drive& drive, const Body& body) const;
  void learnScales();
  static void add(const Row& row, Equations& equations);
  Equations equationsOf(const Drive& drive) const;
  void addPriors(Eigen::MatrixXd& common, Eigen::VectorXd& right) const;
  double prior(Index quantity) const;

  std::vector<CalibratedRadar> radars_;
  CalibrationParams params_;
  bool use_reference_;
  bool is_start_ = true;
  std::vector<Drive> drives_;
  std::array<bool, 3> has_reference_{};
  Eigen::VectorXd configured_;
  std::vector<double> spread_;                              // by radar: of residuals in their sigmas
  Eigen::Array3d reference_std_{0.05, 0.05, 0.005};         // m/s, rad/s
  std::vector<std::pair<std::size_t, std::size_t>> votes_;  // by radar
  std::vector<std::vector<std::tuple<double, Eigen::Vector2d>>> scan_velocities_;  // by radar, of a drive
};

}  // namespace radar_dot
