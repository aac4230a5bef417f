// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "scene_rows.h"

#include <algorithm>
#include <map>
#include <utility>

#include "mask_box.h"
#include "new_token.h"
#include "radar_dot/dataset/dataroot_writer.h"
#include "radar_dot/dataset/instance_masks.h"
#include "vocabulary.h"

namespace radar_dot::dataset {
namespace {

using Positions = std::vector<std::size_t>;

/// Rows that follow each other: of each, the tokens of the rows before and behind it.
class Chains {
 public:
  explicit Chains(const std::vector<std::string>& tokens)
      : tokens_(tokens), previous_(tokens.size(), kEnd), next_(tokens.size(), kEnd) {}

  void connect(const Positions& chain) {
    for (std::size_t i = 1; i < chain.size(); ++i) {
      next_[chain[i - 1]] = chain[i];
      previous_[chain[i]] = chain[i - 1];
    }
  }
  std::string_view previous(std::size_t row) const { return token(previous_[row]); }
  std::string_view next(std::size_t row) const { return token(next_[row]); }

 private:
  static constexpr std::size_t kEnd = static_cast<std::size_t>(-1);
  std::string_view token(std::size_t row) const { return row == kEnd ? std::string_view() : tokens_[row]; }

  const std::vector<std::string>& tokens_;
  Positions previous_, next_;
};

/// Rows 0..size-1 by their group; within a group they keep their order.
template <typename GroupOf>
std::map<std::size_t, Positions> groupRows(std::size_t size, const GroupOf& group_of) {
  std::map<std::size_t, Positions> groups;
  for (std::size_t row = 0; row < size; ++row) groups[group_of(row)].push_back(row);
  return groups;
}

class SceneRows {
 public:
  SceneRows(const NewScene& scene, SceneTables& tables) : scene_(scene), tables_(tables) {
    for (const std::int64_t time_us : scene.samples_us)
      samples_.push_back(newToken({"sample", scene.name, std::to_string(time_us)}));
    for (const NewSensor& sensor : scene.sensors)
      calibrations_.push_back(newToken({"calibrated_sensor", scene.name, sensor.channel}));
    for (const NewReading& reading : scene.readings)
      readings_.push_back(newToken({"sample_data", scene.name, scene.sensors[reading.sensor].channel,
                                    std::to_string(reading.timestamp_us)}));
    for (std::size_t i = 0; i < scene.instances.size(); ++i)
      instances_.push_back(instanceToken(scene.name, i));
    for (const NewAnnotation& annotation : scene.annotations)
      annotations_.push_back(
          newToken({"sample_annotation", instances_[annotation.instance], samples_[annotation.sample]}));
  }

  void write() const {
    writeSceneAndLog();
    writeSamples();
    writeCalibrations();
    writeReadings();
    writeAnnotations();
    writeMasks();
  }

 private:
  void writeSceneAndLog() const {
    tables_.log.record()
        .set("token", logToken(scene_.log_name))
        .set("logfile", scene_.log_name)
        .set("vehicle", scene_.vehicle)
        .set("date_captured", scene_.date_captured)
        .set("location", scene_.location);
    tables_.scene.record()
        .set("token", sceneToken())
        .set("log_token", logToken(scene_.log_name))
        .set("nbr_samples", samples_.size())
        .set("first_sample_token", samples_.front())
        .set("last_sample_token", samples_.back())
        .set("name", scene_.name)
        .set("description", scene_.description);
  }

  void writeSamples() const {
    for (std::size_t i = 0; i < samples_.size(); ++i)
      tables_.sample.record()
          .set("token", samples_[i])
          .set("timestamp", scene_.samples_us[i])
          .set("prev", i == 0 ? std::string() : samples_[i - 1])
          .set("next", i + 1 == samples_.size() ? std::string() : samples_[i + 1])
          .set("scene_token", sceneToken());
  }

  void writeCalibrations() const {
    for (std::size_t i = 0; i < calibrations_.size(); ++i) {
      const NewSensor& sensor = scene_.sensors[i];
      std::vector<std::array<double, 3>> camera_matrix;
      for (std::size_t k = 0; k + 2 < sensor.camera_matrix.size(); k += 3)
        camera_matrix.push_back(
            {sensor.camera_matrix[k], sensor.camera_matrix[k + 1], sensor.camera_matrix[k + 2]});
      tables_.calibrated_sensor.record()
          .set("token", calibrations_[i])
          .set("sensor_token", sensorToken(sensor.channel))
          .set("translation", sensor.translation)
          .set("rotation", sensor.rotation)
          .set("camera_intrinsic", camera_matrix);
    }
  }

  void writeReadings() const {
    Chains chains(readings_);
    const auto sensor_of = [&](std::size_t row) { return scene_.readings[row].sensor; };
    for (const auto& [sensor, rows] : groupRows(readings_.size(), sensor_of)) chains.connect(rows);
    for (std::size_t i = 0; i < readings_.size(); ++i) {
      const NewReading& reading = scene_.readings[i];
      tables_.sample_data.record()
          .set("token", readings_[i])
          .set("sample_token", samples_[reading.sample])
          .set("ego_pose_token", readings_[i])
          .set("calibrated_sensor_token", calibrations_[reading.sensor])
          .set("timestamp", reading.timestamp_us)
          .set("fileformat", reading.file_format)
          .set("is_key_frame", reading.is_key_frame)
          .set("height", reading.height)
          .set("width", reading.width)
          .set("filename", reading.filename)
          .set("prev", chains.previous(i))
          .set("next", chains.next(i));
      tables_.ego_pose.record()
          .set("token", readings_[i])
          .set("timestamp", reading.timestamp_us)
          .set("rotation", reading.ego_pose.rotation)
          .set("translation", reading.ego_pose.translation);
    }
  }

  void writeAnnotations() const {
    Chains chains(annotations_);
    const auto instance_of = [&](std::size_t row) { return scene_.annotations[row].instance; };
    for (auto& [instance, rows] : groupRows(annotations_.size(), instance_of)) {
      Positions chain = rows;
      std::sort(chain.begin(), chain.end(), [&](std::size_t a, std::size_t b) {
        return scene_.annotations[a].sample < scene_.annotations[b].sample;
      });
      chains.connect(chain);
      tables_.instance.record()
          .set("token", instances_[instance])
          .set("category_token", categoryToken(scene_.instances[instance]))
          .set("nbr_annotations", chain.size())
          .set("first_annotation_token", annotations_[chain.front()])
          .set("last_annotation_token", annotations_[chain.back()]);
    }
    for (std::size_t i = 0; i < annotations_.size(); ++i) {
      const NewAnnotation& annotation = scene_.annotations[i];
      tables_.sample_annotation.record()
          .set("token", annotations_[i])
          .set("sample_token", samples_[annotation.sample])
          .set("instance_token", instances_[annotation.instance])
          .set("visibility_token", visibilityToken(annotation.visibility))
          .set("attribute_tokens", attributeTokens(annotation.attributes))
          .set("translation", annotation.translation)
          .set("size", annotation.size)
          .set("rotation", annotation.rotation)
          .set("prev", chains.previous(i))
          .set("next", chains.next(i))
          .set("num_lidar_pts", annotation.lidar_points)
          .set("num_radar_pts", annotation.radar_points);
    }
  }

  void writeMasks() const {
    std::map<std::pair<std::size_t, std::size_t>, const NewAnnotation*> annotation_of;
    for (const NewAnnotation& annotation : scene_.annotations)
      annotation_of[{annotation.instance, annotation.sample}] = &annotation;
    for (const NewMask& mask : scene_.masks) {
      const cv::Rect box = boundingBox(decodeMask(mask.mask));
      if (box.empty()) continue;
      const NewReading& reading = scene_.readings[mask.reading];
      const auto annotation = annotation_of.find({mask.instance, reading.sample});
      writeMask(mask, box, annotation == annotation_of.end() ? nullptr : annotation->second);
    }
  }

  void writeMask(const NewMask& mask, const cv::Rect& box, const NewAnnotation* annotation) const {
    constexpr int kUnknown = -1;
    tables_.nuinsseg.record()
        .set("token", newToken({"nuinsseg", readings_[mask.reading], instances_[mask.instance]}))
        .set("sample_data_token", readings_[mask.reading])
        .set("filename", scene_.readings[mask.reading].filename)
        // The corners belong to the box.
        .set("bbox_corners", std::array<int, 4>{box.x, box.y, box.x + box.width - 1, box.y + box.height - 1})
        .set("category_name", scene_.instances[mask.instance])
        .setObject("instance_mask",
                   [&](JsonTableWriter& object) {
                     object.set("size", std::array<int, 2>{mask.mask.rows, mask.mask.columns});
                     object.set("counts", formatRunLengths(mask.mask));
                   })
        .set("attribute_tokens", attributeTokens(mask.attributes))
        .set("instance_token", instances_[mask.instance])
        .set("visibility_token", visibilityToken(mask.visibility))
        .set("num_lidar_pts", annotation == nullptr ? kUnknown : annotation->lidar_points)
        .set("num_radar_pts", annotation == nullptr ? kUnknown : annotation->radar_points)
        .set("prev", std::string_view())
        .set("next", std::string_view());
  }

  std::string sceneToken() const { return newToken({"scene", scene_.name}); }

  const NewScene& scene_;
  SceneTables& tables_;
  std::vector<std::string> samples_, calibrations_, readings_, instances_, annotations_;  ///< tokens
};

}  // namespace

SceneTables::SceneTables(const std::filesystem::path& version_folder)
    : calibrated_sensor(version_folder / "calibrated_sensor.json"),
      ego_pose(version_folder / "ego_pose.json"),
      instance(version_folder / "instance.json"),
      log(version_folder / "log.json"),
      nuinsseg(version_folder / "nuinsseg.json"),
      sample(version_folder / "sample.json"),
      sample_annotation(version_folder / "sample_annotation.json"),
      sample_data(version_folder / "sample_data.json"),
      scene(version_folder / "scene.json") {}

void SceneTables::finish() {
  for (JsonTableWriter* table : {&calibrated_sensor, &ego_pose, &instance, &log, &nuinsseg, &sample,
                                 &sample_annotation, &sample_data, &scene})
    table->finish();
}

std::string sensorToken(std::string_view channel) { return newToken({"sensor", channel}); }

std::string logToken(std::string_view log_name) { return newToken({"log", log_name}); }

void writeSceneRows(const NewScene& scene, SceneTables& tables) { SceneRows(scene, tables).write(); }

std::string instanceToken(const std::string& scene_name, std::size_t instance) {
  return newToken({"instance", scene_name, std::to_string(instance)});
}

}  // namespace radar_dot::dataset
