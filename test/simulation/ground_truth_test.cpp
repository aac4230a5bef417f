// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "simulation/sensors/ground_truth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "radar_dot/common/quantile.h"
#include "radar_dot/simulation/camera_sensor.h"
#include "radar_dot/simulation/lidar_sensor.h"
#include "radar_dot/simulation/scenario.h"

namespace radar_dot::simulation {
namespace {

constexpr double kFrame = 1.0 / 12.0;  // s

/// Goes along the map's x axis, looking along it.
class Gliding final : public Trajectory {
 public:
  Gliding(Eigen::Vector3d start, Eigen::Vector3d velocity)
      : start_(std::move(start)), velocity_(std::move(velocity)) {}
  BodyState at(double time_s) const override {
    BodyState state;
    state.T_map_from_body.translation() = start_ + time_s * velocity_;
    state.speed = velocity_.norm();
    state.distance = time_s * state.speed;
    return state;
  }

 private:
  Eigen::Vector3d start_, velocity_;
};

std::shared_ptr<const Mesh> boxMesh(const Eigen::Vector3f& size) {
  MeshBuilder builder;
  builder.use({Material::kPlaster, Color(0.5F, 0.5F, 0.5F), -1});
  builder.box({-0.5F * size.x(), -0.5F * size.y(), 0.0F}, {0.5F * size.x(), 0.5F * size.y(), size.z()});
  return std::make_shared<Mesh>(std::move(builder).build());
}

/// A wall 20 m ahead, and a moving plate 10 m ahead.
World wallAndPlate(const Eigen::Vector3d& plate_velocity) {
  World world;
  StaticObject wall;
  wall.mesh = boxMesh({1.0F, 100.0F, 100.0F});
  wall.T_map_from_object.translation() << 20.5, 0.0, -50.0;
  world.statics.push_back(wall);
  auto model = std::make_shared<Model>();
  model->category = "vehicle.car";
  model->size = {0.2, 2.0, 2.0};
  model->parts.push_back({boxMesh({0.2F, 2.0F, 2.0F})});
  Actor plate;
  plate.model = model;
  plate.trajectory = std::make_shared<Gliding>(Eigen::Vector3d(10.1, 0.0, -1.0), plate_velocity);
  world.actors.push_back(plate);
  return world;
}

/// At the map's origin, looking along x: 1000 px focal length, centre (100, 60).
PinholeCamera forwardCamera(double x = 0.0) {
  PinholeCamera camera;
  camera.T_map_from_camera.linear() =
      (Eigen::Matrix3d() << 0, 0, 1, -1, 0, 0, 0, -1, 0).finished();  // z ahead, x right, y down
  camera.T_map_from_camera.translation() << x, 0.0, 0.0;
  camera.matrix << 1000, 0, 100, 0, 1000, 60, 0, 0, 1;
  camera.width = 201;
  camera.height = 121;
  return camera;
}

TEST(CameraSensor, CamFrontLooksAheadAndLeftIsLeft) {
  const Standing ego{Eigen::Isometry3d::Identity()};
  const PinholeCamera camera = cameraAt(cameraMounts().front(), ego, 0.0, kFullWidth, kFullHeight);
  const auto pixelOf = [&](double x, double y, double z) {
    return camera.project(camera.T_map_from_camera.inverse() * Eigen::Vector3d(x, y, z));
  };
  const Eigen::Vector2d ahead = pixelOf(60.0, 0.0, 1.5);
  EXPECT_NEAR(ahead.x(), 816.0, 20.0);
  EXPECT_NEAR(ahead.y(), 491.0, 20.0);
  EXPECT_LT(pixelOf(60.0, 5.0, 1.5).x(), ahead.x() - 80.0) << "what lies to the left";
  EXPECT_GT(pixelOf(60.0, 0.0, 0.0).y(), ahead.y() + 20.0) << "what lies on the road";
}

TEST(CameraSensor, ScaledMatrixKeepsTheBorders) {
  const CameraMount& mount = cameraMounts().front();
  const Eigen::Matrix3d half = scaledCameraMatrix(mount, 800, 450);
  // The left border of the image is half a pixel left of the first centre, in both sizes.
  const double full_border = (-0.5 - mount.camera_matrix(0, 2)) / mount.camera_matrix(0, 0);
  EXPECT_NEAR((-0.5 - half(0, 2)) / half(0, 0), full_border, 1e-12);
  EXPECT_NEAR((799.5 - half(0, 2)) / half(0, 0),
              (1599.5 - mount.camera_matrix(0, 2)) / mount.camera_matrix(0, 0), 1e-12);
}

TEST(GroundTruth, DepthIsAlongTheAxis) {
  const World world = wallAndPlate(Eigen::Vector3d::Zero());
  const RayGeometry geometry(world);
  const Snapshot snapshot(world, geometry, 0.0);
  const PinholeCamera camera = forwardCamera();
  const cv::Mat depth = depthTruth(traceSurfaces(snapshot, camera), camera);
  EXPECT_NEAR(depth.at<float>(60, 100), 10.0F, 1e-3F);
  EXPECT_NEAR(depth.at<float>(0, 0), 10.0F, 1e-3F) << "2 m at 10 m span 200 px";
  EXPECT_NEAR(depth.at<float>(60, 195), 10.0F, 1e-3F);
  const PinholeCamera far_right = forwardCamera(-10.0);
  EXPECT_NEAR(depthTruth(traceSurfaces(snapshot, far_right), far_right).at<float>(60, 199), 30.0F, 1e-3F)
      << "flat wall: the same depth in every pixel";
}

TEST(GroundTruth, MovingPlateAndStandingWallByHand) {
  // The plate goes 0.6 m to the left (+y) and 2 m closer within the second; the camera stands.
  const World world = wallAndPlate({-2.0, 0.6, 0.0});
  const RayGeometry geometry(world);
  const Snapshot now(world, geometry, 0.0);
  const Snapshot later(world, geometry, 1.0);
  const PinholeCamera camera = forwardCamera(-5.0);
  const VisibleSurfaces surfaces = traceSurfaces(now, camera);
  const FlowTruth truth = flowTruth(surfaces, now, camera, later, camera);
  // Pixel (120, 70): ray (0.02, 0.01), plate's face at depth 15: x = 0.3, y = 0.15. Then x = -0.3, depth 13.
  const auto plate = truth.flow.at<cv::Vec2f>(70, 120);
  EXPECT_NEAR(plate[0], (1000.0 * -0.3 / 13.0 + 100.0) - 120.0, 0.01);
  EXPECT_NEAR(plate[1], (1000.0 * 0.15 / 13.0 + 60.0) - 70.0, 0.01);
  EXPECT_EQ(truth.occlusion.at<std::uint8_t>(70, 120), kVisibleInOther);
  const auto wall = truth.flow.at<cv::Vec2f>(60, 5);
  EXPECT_NEAR(std::hypot(wall[0], wall[1]), 0.0, 1e-3);
  // The plate's left edge at -0.067 of the ray moves to (-1.6 / 13 = -0.123): wall pixels between are hidden.
  EXPECT_EQ(truth.occlusion.at<std::uint8_t>(60, 100 - 90), kOccludedInOther);
  const cv::Mat actors = actorTruth(surfaces, now);
  EXPECT_EQ(actors.at<std::uint16_t>(70, 120), 1);
  EXPECT_EQ(actors.at<std::uint16_t>(60, 5), 0);
  EXPECT_EQ(motionTruth(actors, world, 0.0).at<std::uint8_t>(70, 120), 255);
  EXPECT_EQ(motionTruth(actors, world, 0.0).at<std::uint8_t>(60, 5), 0);
}

TEST(GroundTruth, DrivingTowardsAWallExpandsAroundTheCentre) {
  const World world = wallAndPlate({100.0, 0.0, 0.0});
  const RayGeometry geometry(world);
  const Snapshot now(world, geometry, 5.0);  // the plate has gone through the wall
  const PinholeCamera camera = forwardCamera();
  const FlowTruth truth = flowTruth(traceSurfaces(now, camera), now, camera, now, forwardCamera(4.0));
  for (const auto& [u, v] : {std::pair<int, int>{150, 60}, {100, 100}, {40, 30}}) {
    // A point at depth 20 is at depth 16 after 4 m: offsets from the centre grow by 20 / 16.
    const auto flow = truth.flow.at<cv::Vec2f>(v, u);
    EXPECT_NEAR(flow[0], (u - 100) * 0.25, 0.01);
    EXPECT_NEAR(flow[1], (v - 60) * 0.25, 0.01);
  }
  EXPECT_EQ(truth.occlusion.at<std::uint8_t>(2, 2), kOutsideOther);
}

TEST(GroundTruth, SkyHasNeitherDepthNorFlow) {
  World world;
  StaticObject box;
  box.mesh = boxMesh({1.0F, 0.2F, 1.0F});
  box.T_map_from_object.translation() << 10.0, 0.0, -0.5;
  world.statics.push_back(box);
  const RayGeometry geometry(world);
  const Snapshot snapshot(world, geometry, 0.0);
  const PinholeCamera camera = forwardCamera();
  const VisibleSurfaces surfaces = traceSurfaces(snapshot, camera);
  const FlowTruth truth = flowTruth(surfaces, snapshot, camera, snapshot, camera);
  EXPECT_EQ(depthTruth(surfaces, camera).at<float>(0, 0), 0.0F);
  EXPECT_TRUE(std::isnan(truth.flow.at<cv::Vec2f>(0, 0)[0]));
  const cv::Mat encoded = encodeFlow(truth.flow);
  EXPECT_EQ(encoded.at<cv::Vec3w>(0, 0)[0], 0);
  EXPECT_EQ(encoded.at<cv::Vec3w>(60, 100), cv::Vec3w(1, 32768, 32768));
}

TEST(GroundTruth, EncodingsAreThoseOfTheBenchmarks) {
  const cv::Mat depth = (cv::Mat_<float>(1, 4) << 0.0F, 1.0F, 100.5F, 300.0F);
  EXPECT_EQ(cv::countNonZero(encodeDepth(depth) != (cv::Mat_<std::uint16_t>(1, 4) << 0, 256, 25728, 0)), 0);
  cv::Mat flow(1, 2, CV_32FC2);
  flow.at<cv::Vec2f>(0, 0) = {1.5F, -2.0F};
  flow.at<cv::Vec2f>(0, 1) = {600.0F, 0.0F};
  // KITTI: value = flow * 64 + 2^15; OpenCV's channel order is valid, v, u.
  EXPECT_EQ(encodeFlow(flow).at<cv::Vec3w>(0, 0), cv::Vec3w(1, 32768 - 128, 32768 + 96));
  EXPECT_EQ(encodeFlow(flow).at<cv::Vec3w>(0, 1)[0], 0);
}

TEST(ImageSensor, ShotNoiseFollowsThePhotonsAndRepeats) {
  const Lighting lighting;
  const cv::Mat grey(300, 400, CV_32FC3, cv::Scalar::all(0.25));
  ImageSensorParams params;
  params.vignetting = 0.0;
  params.read_noise = 0.0;
  const auto statistics = [&](double full_well) {
    params.full_well = full_well;
    cv::Scalar mean, sigma;
    cv::meanStdDev(takePicture(grey, lighting, params, 1, 1), mean, sigma);
    const double rounding = 1.0 / 12.0;  // variance of rounding to whole grey levels
    return std::pair<double, double>(mean[1], sigma[1] * sigma[1] - rounding);
  };
  const auto [clean_mean, clean_variance] = statistics(1e12);
  const auto [mean_of_few, variance_of_few] = statistics(1000.0);
  const auto [mean_of_many, variance_of_many] = statistics(4000.0);
  EXPECT_LT(clean_variance, 0.0) << "one grey level only";
  EXPECT_NEAR(mean_of_few, clean_mean, 0.7);
  EXPECT_NEAR(mean_of_many, clean_mean, 0.7);
  EXPECT_NEAR(variance_of_few / variance_of_many, 4.0, 0.3) << "a quarter of the photons";
  const cv::Mat picture = takePicture(grey, lighting, params, 1, 1);
  EXPECT_EQ(cv::norm(picture, takePicture(grey, lighting, params, 1, 1), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(picture, takePicture(grey, lighting, params, 1, 2), cv::NORM_INF), 0.0);
  EXPECT_GT(cv::norm(picture, takePicture(grey, lighting, params, 2, 1), cv::NORM_INF), 0.0);
}

TEST(ImageSensor, CornersAreDarkerByTheVignetting) {
  const Lighting lighting;
  const cv::Mat grey(201, 301, CV_32FC3, cv::Scalar::all(0.12));
  ImageSensorParams params;
  params.full_well = 1e12;
  params.read_noise = 0.0;
  params.vignetting = 0.5;
  const cv::Mat picture = takePicture(grey, lighting, params, 1, 1);
  const cv::Mat half =
      takePicture(0.5 * grey, lighting, ImageSensorParams{0.45, 0.0, 1e12, 1e12, 0.0, 90}, 1, 1);
  EXPECT_NEAR(picture.at<cv::Vec3b>(0, 0)[1], half.at<cv::Vec3b>(0, 0)[1], 1);
  EXPECT_GT(picture.at<cv::Vec3b>(100, 150)[1], picture.at<cv::Vec3b>(0, 0)[1] + 10);
}

/// Green of an image between its pixels.
double interpolated(const cv::Mat& image, float x, float y) {
  const int left = std::clamp(static_cast<int>(x), 0, image.cols - 2);
  const int top = std::clamp(static_cast<int>(y), 0, image.rows - 2);
  const float a = x - static_cast<float>(left);
  const float b = y - static_cast<float>(top);
  const auto at = [&](int du, int dv) {
    return static_cast<float>(image.at<cv::Vec3b>(top + dv, left + du)[1]);
  };
  return (1 - b) * ((1 - a) * at(0, 0) + a * at(1, 0)) + b * ((1 - a) * at(0, 1) + a * at(1, 1));
}

// The laws below are checked on a whole street.

struct StreetPair {
  Scenario scenario = makeScenario("crossing", 4.0, 7);
  RayGeometry geometry{scenario.world};
  double time_s = 2.0;
  Snapshot now{scenario.world, geometry, time_s};
  Snapshot next{scenario.world, geometry, time_s + kFrame};
  PinholeCamera camera = cameraAt(cameraMounts().front(), *scenario.ego, time_s, 800, 450);
  PinholeCamera next_camera = cameraAt(cameraMounts().front(), *scenario.ego, time_s + kFrame, 800, 450);
  VisibleSurfaces surfaces = traceSurfaces(now, camera);
  FlowTruth truth = flowTruth(surfaces, now, camera, next, next_camera);
  cv::Mat depth = depthTruth(surfaces, camera);
  cv::Mat motion = motionTruth(actorTruth(surfaces, now), scenario.world, time_s);
};

TEST(StreetLaws, StaticPixelsFollowTheRigidFlowEquationAndMoversDoNot) {
  const StreetPair pair;
  const Eigen::Isometry3d T_next_from_now =
      pair.next_camera.T_map_from_camera.inverse() * pair.camera.T_map_from_camera;
  const Eigen::Matrix3d K = pair.camera.matrix;
  double worst_static = 0.0;
  int movers = 0;
  int movers_off = 0;
  for (int v = 0; v < pair.depth.rows; ++v) {
    for (int u = 0; u < pair.depth.cols; ++u) {
      const float z = pair.depth.at<float>(v, u);
      if (z <= 0.0F) continue;
      // X_t = R X_{t-1} + t, projected: the paper's expected flow.
      const Eigen::Vector3d X = T_next_from_now * (z * (K.inverse() * Eigen::Vector3d(u, v, 1.0)));
      const Eigen::Vector2d expected(K(0, 0) * X.x() / X.z() + K(0, 2) - u,
                                     K(1, 1) * X.y() / X.z() + K(1, 2) - v);
      const auto flow = pair.truth.flow.at<cv::Vec2f>(v, u);
      const double residual = std::hypot(flow[0] - expected.x(), flow[1] - expected.y());
      const Hit& hit = pair.surfaces.at(u, v);
      if (pair.now.objects()[hit.object].actor < 0) {
        worst_static = std::max(worst_static, residual);
      } else if (pair.motion.at<std::uint8_t>(v, u) != 0) {
        ++movers;
        movers_off += residual > 0.3 ? 1 : 0;
      }
    }
  }
  EXPECT_LT(worst_static, 0.05) << "px";
  EXPECT_GT(movers, 500);
  EXPECT_GT(movers_off, movers / 2);
}

TEST(StreetLaws, WarpingTheNextImageByTheTrueFlowGivesThisOne) {
  const StreetPair pair;
  ImageSensorParams clean;
  clean.full_well = 1e12;
  clean.read_noise = 0.0;
  const auto picture = [&](const Snapshot& snapshot, const PinholeCamera& camera,
                           const VisibleSurfaces& surfaces) {
    return takePicture(renderRadiance(pair.scenario.world, snapshot, camera, surfaces,
                                      pair.scenario.ego->at(snapshot.time()).T_map_from_body),
                       pair.scenario.world.lighting, clean, 1, 1);
  };
  const cv::Mat image = picture(pair.now, pair.camera, pair.surfaces);
  const cv::Mat next = picture(pair.next, pair.next_camera, traceSurfaces(pair.next, pair.next_camera));
  std::vector<double> warped_errors, shifted_errors, unwarped_errors;
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      if (pair.truth.occlusion.at<std::uint8_t>(v, u) != kVisibleInOther) continue;
      const auto flow = pair.truth.flow.at<cv::Vec2f>(v, u);
      const float x = static_cast<float>(u) + flow[0];
      const float y = static_cast<float>(v) + flow[1];
      const double warped = interpolated(next, x, y);
      const double shifted = interpolated(next, x + 0.5F, y + 0.5F);
      const double here = image.at<cv::Vec3b>(v, u)[1];
      warped_errors.push_back(std::abs(warped - here));
      shifted_errors.push_back(std::abs(shifted - here));
      unwarped_errors.push_back(std::abs(static_cast<double>(next.at<cv::Vec3b>(v, u)[1]) - here));
    }
  }
  ASSERT_GT(warped_errors.size(), 100'000U);
  // What remains is interpolation of texture; the sensor's noise would be about 2 grey levels.
  EXPECT_LT(quantileOf(warped_errors), 2.5);
  EXPECT_LT(quantileOf(warped_errors), 0.5 * quantileOf(unwarped_errors));
  EXPECT_LT(quantileOf(warped_errors), 0.85 * quantileOf(shifted_errors)) << "half a pixel off is worse";
}

TEST(StreetLaws, LidarPointsLieOnTheDepthMap) {
  const StreetPair pair;
  const LidarModel model;
  const auto returns = simulateLidarSweep(pair.now, lidarMount(), *pair.scenario.ego, model, 1, 1);
  const Eigen::Isometry3d T_camera_from_lidar = pair.camera.T_map_from_camera.inverse() *
                                                pair.scenario.ego->at(pair.time_s).T_map_from_body *
                                                lidarMount().T_base_from_sensor;
  int compared = 0;
  int agree = 0;
  for (const LidarReturn& lidar_return : returns) {
    const Eigen::Vector3d point = T_camera_from_lidar * lidar_return.point.cast<double>();
    if (point.z() < 1.0) continue;
    const Eigen::Vector2d pixel = pair.camera.project(point);
    const auto u = static_cast<int>(std::lround(pixel.x()));
    const auto v = static_cast<int>(std::lround(pixel.y()));
    if (u < 1 || v < 1 || u > 798 || v > 448) continue;
    // On the surface of one of the pixels around; at edges a point may fall just beside.
    double nearest = 1e9;
    for (int dv = -1; dv <= 1; ++dv)
      for (int du = -1; du <= 1; ++du)
        nearest = std::min(nearest,
                           std::abs(static_cast<double>(pair.depth.at<float>(v + dv, u + du)) - point.z()));
    ++compared;
    agree += nearest < 4.0 * model.range_noise + 0.01 * point.z() ? 1 : 0;
  }
  EXPECT_GT(compared, 1000);
  // The lidar looks over things that hide what it sees from the camera, hence not all.
  EXPECT_GT(agree, 0.93 * compared);
}

}  // namespace
}  // namespace radar_dot::simulation
