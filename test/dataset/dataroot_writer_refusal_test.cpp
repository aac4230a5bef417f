// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// Scenes that fit no dataroot.
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "dataset/small_scene.h"
#include "fixtures/files.h"
#include "fixtures/refusal.h"
#include "radar_dot/dataset/dataroot_writer.h"
#include "radar_dot/dataset/tables.h"

namespace radar_dot::dataset {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();

/// A defect, and what the message must say after the scene's name.
struct Defect {
  std::string message;
  std::function<void(NewScene&)> make;
};

class DatarootRefusalTest : public ::testing::Test {
 protected:
  /// The defect is refused, and the writer goes on as if there had been none.
  void expectRefusals(const std::vector<Defect>& defects) {
    for (const Defect& defect : defects) {
      NewScene scene = test::smallScene(1);
      defect.make(scene);
      EXPECT_EQ(test::refusalOf([&] { writer_.add(scene); }),
                "scene '" + scene.name + "': " + defect.message);
    }
    writer_.add(test::smallScene(1));
    writer_.finish();
    EXPECT_EQ(Tables::load(folder_.path() / "dataroot", {"v1.0-sim", {}}).sample_data.size(), 20U);
  }

  test::TemporaryFolder folder_;
  DatarootWriter writer_{folder_.path() / "dataroot", "v1.0-sim", false};
};

TEST_F(DatarootRefusalTest, Names) {
  expectRefusals({
      {"the name must be a plain file name", [](NewScene& s) { s.name = "../scene"; }},
      {"the name must be a plain file name", [](NewScene& s) { s.name = ""; }},
      {"the log name must be a plain file name", [](NewScene& s) { s.log_name = "a/b"; }},
  });
}

TEST_F(DatarootRefusalTest, Sensors) {
  expectRefusals({
      {"sensor 1: the channel must be a plain file name", [](NewScene& s) { s.sensors[1].channel = ""; }},
      {"sensor 2: another sensor has this channel", [](NewScene& s) { s.sensors[2].channel = "CAM_FRONT"; }},
      {"sensor 2: the modality must be camera, lidar or radar",
       [](NewScene& s) { s.sensors[2].modality = "sonar"; }},
      {"sensor 1: the translation is not finite",
       [](NewScene& s) { s.sensors[1].translation[2] = kNotANumber; }},
      {"sensor 1: the rotation must be a unit quaternion w x y z but its norm is 0",
       [](NewScene& s) { s.sensors[1].rotation = {}; }},
      {"sensor 0: the camera matrix must hold 9 numbers for a camera and none for others",
       [](NewScene& s) { s.sensors[0].camera_matrix.clear(); }},
      {"sensor 1: the camera matrix must hold 9 numbers for a camera and none for others",
       [](NewScene& s) { s.sensors[1].camera_matrix = s.sensors[0].camera_matrix; }},
      {"sensor 0: the camera matrix is not finite",
       [](NewScene& s) { s.sensors[0].camera_matrix[4] = kNotANumber; }},
  });
}

TEST_F(DatarootRefusalTest, SamplesAndReadings) {
  expectRefusals({
      {"there are no samples", [](NewScene& s) { s.samples_us.clear(); }},
      {"sample 2: not later than the sample before it",
       [](NewScene& s) { s.samples_us[2] = s.samples_us[1]; }},
      {"reading 3: sensor 3 does not exist, there are 3", [](NewScene& s) { s.readings[3].sensor = 3; }},
      {"reading 3: sample 7 does not exist, there are 3", [](NewScene& s) { s.readings[3].sample = 7; }},
      {"reading 4: not later than the reading of its sensor before it",
       [](NewScene& s) { s.readings[4].timestamp_us = s.readings[3].timestamp_us; }},
      {"reading 5: the translation is not finite",
       [](NewScene& s) { s.readings[5].ego_pose.translation[0] = kNotANumber; }},
      {"reading 5: the rotation must be a unit quaternion w x y z but its norm is 2",
       [](NewScene& s) {
         s.readings[5].ego_pose.rotation = {0.0, 2.0, 0.0, 0.0};
       }},
      {"reading 5: the file name must be relative to the dataroot and inside of it",
       [](NewScene& s) { s.readings[5].filename = "/a.pcd"; }},
      {"reading 5: the file name must be relative to the dataroot and inside of it",
       [](NewScene& s) { s.readings[5].filename = "samples/../../a.pcd"; }},
      {"reading 5: another reading has this file name",
       [](NewScene& s) { s.readings[5].filename = s.readings[0].filename; }},
      {"reading 5: there is no file format", [](NewScene& s) { s.readings[5].file_format = ""; }},
      {"reading 2: width and height must lie in 1..65535 but are 16 and 0",
       [](NewScene& s) { s.readings[2].height = 0; }},
      {"reading 3: its sensor has another key frame for this sample",
       [](NewScene& s) { s.readings[3].is_key_frame = true; }},
  });
}

TEST_F(DatarootRefusalTest, InstancesAndAnnotations) {
  expectRefusals({
      {"instance 2: nuScenes knows no category 'vehicle.tank'",
       [](NewScene& s) { s.instances[2] = "vehicle.tank"; }},
      {"annotation 1: sample 3 does not exist, there are 3",
       [](NewScene& s) { s.annotations[1].sample = 3; }},
      {"annotation 1: instance 3 does not exist, there are 3",
       [](NewScene& s) { s.annotations[1].instance = 3; }},
      {"annotation 1: its instance has another annotation in this sample",
       [](NewScene& s) { s.annotations[1].sample = 2; }},
      {"annotation 1: the translation is not finite",
       [](NewScene& s) { s.annotations[1].translation[1] = kNotANumber; }},
      {"annotation 1: the rotation must be a unit quaternion w x y z but its norm is nan",
       [](NewScene& s) { s.annotations[1].rotation[1] = kNotANumber; }},
      {"annotation 1: the size must be positive", [](NewScene& s) { s.annotations[1].size[2] = 0.0; }},
      {"annotation 1: nuScenes knows no attribute 'vehicle.flying'",
       [](NewScene& s) {
         s.annotations[1].attributes = {"vehicle.moving", "vehicle.flying"};
       }},
      {"annotation 1: the visibility must be one of 1..4 but is 5",
       [](NewScene& s) { s.annotations[1].visibility = 5; }},
      {"annotation 1: the numbers of points must not be negative",
       [](NewScene& s) { s.annotations[1].radar_points = -1; }},
  });
}

TEST_F(DatarootRefusalTest, MasksAndCanMessages) {
  expectRefusals({
      {"mask 1: reading 99 does not exist, there are 20", [](NewScene& s) { s.masks[1].reading = 99; }},
      {"mask 1: instance 9 does not exist, there are 3", [](NewScene& s) { s.masks[1].instance = 9; }},
      {"mask 1: its instance has another mask in this reading",
       [](NewScene& s) { s.masks[1].reading = s.masks[0].reading; }},
      {"mask 1: its reading must be a key frame of a camera", [](NewScene& s) { s.masks[1].reading = 0; }},
      {"mask 1: its instance has no annotation in this scene", [](NewScene& s) { s.masks[1].instance = 2; }},
      {"mask 1: nuScenes knows no attribute 'moving'",
       [](NewScene& s) { s.masks[1].attributes = {"moving"}; }},
      {"mask 1: the visibility must be one of 1..4 but is 0", [](NewScene& s) { s.masks[1].visibility = 0; }},
      {"mask 1: its runs do not add up to the image", [](NewScene& s) { s.masks[1].mask.counts = {191}; }},
      {"mask 1: its size is 16x11 but that of the image 16x12",
       [](NewScene& s) {
         s.masks[1].mask = RunLengthMask{11, 16, {176}};
       }},
      {"CAN pose 2: not later than the one before it",
       [](NewScene& s) { s.can_bus.poses[2].timestamp_us = s.can_bus.poses[1].timestamp_us; }},
      {"CAN pose 2: the rotation must be a unit quaternion w x y z but its norm is 0",
       [](NewScene& s) { s.can_bus.poses[2].orientation = {}; }},
      {"CAN IMU message 0: a value is not finite",
       [](NewScene& s) { s.can_bus.imu[0].rotation_rate[1] = kNotANumber; }},
      {"CAN vehicle message 1: a value is not finite",
       [](NewScene& s) { s.can_bus.vehicle[1].steering_angle_deg = kNotANumber; }},
  });
}

TEST(DatarootRefusal, ScenesMustDifferAndShareTheirSensors) {
  const test::TemporaryFolder folder;
  DatarootWriter writer(folder.path() / "dataroot", "v1.0-sim", false);
  writer.add(test::smallScene(1));
  const auto expect = [&](const std::string& message, const std::function<void(NewScene&)>& make) {
    NewScene scene = test::smallScene(2);
    make(scene);
    EXPECT_EQ(test::refusalOf([&] { writer.add(scene); }), message);
  };
  expect("scene 'scene-0001': another scene has this name", [](NewScene& s) { s.name = "scene-0001"; });
  expect("scene 'scene-0002': another scene has the log 'sim-2026-01-01-00-00-00+0000'",
         [](NewScene& s) { s.log_name = "sim-2026-01-01-00-00-00+0000"; });
  expect("scene 'scene-0002': sensor 2: LIDAR_TOP is a lidar in another scene",
         [](NewScene& s) { s.sensors[2].modality = "radar"; });
  expect("scene 'scene-0002': reading 7: a reading of another scene has this file name",
         [](NewScene& s) { s.readings[7].filename = test::smallScene(1).readings[2].filename; });
  writer.add(test::smallScene(2));
}

}  // namespace
}  // namespace radar_dot::dataset
