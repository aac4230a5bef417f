// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/simulation/drive_simulator.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <memory>
#include <mutex>
#include <numeric>
#include <opencv2/imgcodecs.hpp>
#include <utility>

#include "radar_dot/common/random_stream.h"
#include "radar_dot/dataset/dataroot_writer.h"
#include "radar_dot/dataset/file_bytes.h"
#include "radar_dot/dataset/point_files.h"
#include "simulation/scenarios/drive_plan.h"
#include "simulation/sensors/annotations.h"
#include "simulation/sensors/ground_truth.h"
#include "simulation/sensors/pose_arrays.h"
#include "simulation/sensors/radar_sensor.h"

namespace radar_dot::simulation {
namespace {

namespace fs = std::filesystem;

constexpr double kCanMargin = 0.1;     // s, before and after the drive
constexpr int kFewestMaskPixels = 10;  // smaller ones no annotator would draw

std::string extensionOf(SensorKind kind) {
  return kind == SensorKind::kCamera ? "jpg" : kind == SensorKind::kLidar ? "pcd.bin" : "pcd";
}

const char* modalityOf(SensorKind kind) {
  return kind == SensorKind::kCamera ? "camera" : kind == SensorKind::kLidar ? "lidar" : "radar";
}

void storeImage(const fs::path& file, const char* extension, const cv::Mat& image,
                const std::vector<int>& options) {
  std::vector<std::uint8_t> bytes;
  cv::imencode(extension, image, bytes, options);
  dataset::writeBytes(file, bytes.data(), bytes.size());
}

/// One scene in the making. The work on its readings is independent of each other.
class Drive {
 public:
  Drive(const Scenario& scenario, const DriveOptions& options, std::size_t number, fs::path folder)
      : scenario_(scenario),
        options_(options),
        folder_(std::move(folder)),
        plan_(planDrive(options, number)),
        findings_(plan_.samples_us.size(), Findings(scenario.world.actors.size())),
        visible_shares_(plan_.samples_us.size()),
        masks_(plan_.readings.size()) {
    scene_.name = scenario.scene_name;
    scene_.description = scenario.description;
    scene_.log_name = fmt::format("sim-{}-{}", scenario.scene_name, scenario.name);
    scene_.vehicle = "simulated";
    scene_.date_captured = "2026-01-01";
    scene_.location = "simulated-" + scenario.name;
    scene_.samples_us = plan_.samples_us;
    listSensors();
    listReadings();
  }

  dataset::NewScene run(const DriveProgress& progress) {
    makeFolders();
    const std::size_t readings = plan_.readings.size();
    const std::size_t total = readings + plan_.samples_us.size();
    std::mutex mutex;
    std::size_t done = 0;
    const auto work = [&](const tbb::blocked_range<std::size_t>& range) {
      for (std::size_t job = range.begin(); job != range.end(); ++job) {
        if (job < readings)
          take(order_[job]);
        else
          lookAtActors(job - readings);
        if (!progress) continue;
        const std::lock_guard<std::mutex> lock(mutex);
        progress(++done, total);
      }
    };
    tbb::task_arena arena(options_.threads > 0 ? options_.threads : tbb::task_arena::automatic);
    arena.execute([&] {
      geometry_ = std::make_unique<RayGeometry>(scenario_.world);
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, total, 1), work, tbb::simple_partitioner());
    });
    return finish();
  }

 private:
  void listSensors() {
    for (const DriveSensor& sensor : plan_.sensors) {
      dataset::NewSensor row;
      row.channel = sensor.mount.channel;
      row.modality = modalityOf(sensor.kind);
      row.translation = asArray(sensor.mount.T_base_from_sensor.translation());
      row.rotation = quaternionOf(sensor.mount.T_base_from_sensor);
      if (sensor.kind == SensorKind::kCamera) {
        const Eigen::Matrix3d matrix =
            scaledCameraMatrix(cameraMounts()[sensor.number], options_.width, options_.height);
        for (int i = 0; i < 9; ++i) row.camera_matrix.push_back(matrix(i / 3, i % 3));
      }
      scene_.sensors.push_back(std::move(row));
    }
  }

  void listReadings() {
    for (const PlannedReading& planned : plan_.readings) {
      const DriveSensor& sensor = plan_.sensors[planned.sensor];
      const Eigen::Isometry3d pose = scenario_.ego->at(planned.time_s).T_map_from_body;
      dataset::NewReading reading;
      reading.sensor = planned.sensor;
      reading.timestamp_us = planned.timestamp_us;
      reading.sample = planned.sample;
      reading.is_key_frame = planned.is_key_frame;
      reading.filename = fmt::format("{}/{}/{}.{}", planned.is_key_frame ? "samples" : "sweeps",
                                     sensor.mount.channel, stemOf(planned), extensionOf(sensor.kind));
      reading.file_format = sensor.kind == SensorKind::kCamera ? "jpg" : "pcd";
      if (sensor.kind == SensorKind::kCamera) {
        reading.width = options_.width;
        reading.height = options_.height;
      }
      reading.ego_pose = {asArray(pose.translation()), quaternionOf(pose)};
      scene_.readings.push_back(std::move(reading));
    }
    // In the order of time, so that the time left can be told from the time passed.
    order_.resize(plan_.readings.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::stable_sort(order_.begin(), order_.end(), [&](std::size_t a, std::size_t b) {
      return plan_.readings[a].timestamp_us < plan_.readings[b].timestamp_us;
    });
  }

  std::string stemOf(const PlannedReading& reading) const {
    return fmt::format("{}__{}__{}", scene_.log_name, plan_.sensors[reading.sensor].mount.channel,
                       reading.timestamp_us);
  }

  void makeFolders() const {
    for (const char* kind : {"samples", "sweeps"})
      for (const DriveSensor& sensor : plan_.sensors)
        fs::create_directories(folder_ / kind / sensor.mount.channel);
    if (options_.ground_truth == GroundTruth::kNone) return;
    fs::create_directories(folder_ / "ground_truth");
    const auto& cameras = options_.cameras;
    if (std::find(cameras.begin(), cameras.end(), "CAM_FRONT") == cameras.end()) return;
    for (const char* kind :
         {"depth", "flow", "occlusion", "keyframe_flow", "keyframe_occlusion", "instance", "motion"})
      fs::create_directories(folder_ / "ground_truth" / kind);
  }

  void take(std::size_t number) {
    const PlannedReading& reading = plan_.readings[number];
    const DriveSensor& sensor = plan_.sensors[reading.sensor];
    const Snapshot snapshot(scenario_.world, *geometry_, reading.time_s);
    const fs::path file = folder_ / scene_.readings[number].filename;
    const std::uint64_t stream = mixBits(static_cast<std::uint64_t>(reading.timestamp_us)) + reading.sensor;
    switch (sensor.kind) {
      case SensorKind::kCamera: return takePictureOf(number, snapshot, file, stream);
      case SensorKind::kRadar: return takeScan(reading, snapshot, file, stream);
      case SensorKind::kLidar: return takeSweep(reading, snapshot, file, stream);
    }
  }

  void takeScan(const PlannedReading& reading, const Snapshot& snapshot, const fs::path& file,
                std::uint64_t stream) {
    const auto returns = simulateRadarScan(snapshot, plan_.sensors[reading.sensor].mount, *scenario_.ego,
                                           options_.seed, stream);
    for (const RadarReturn& r : returns)
      if (reading.is_key_frame && r.object >= 0)
        count(reading.sample, snapshot.objects()[static_cast<std::size_t>(r.object)].actor, &Findings::radar);
    dataset::writeRadarPcd(file, {returns.begin(), returns.end()});
  }

  void takeSweep(const PlannedReading& reading, const Snapshot& snapshot, const fs::path& file,
                 std::uint64_t stream) {
    const auto returns =
        simulateLidarSweep(snapshot, lidarMount(), *scenario_.ego, options_.lidar, options_.seed, stream);
    std::vector<dataset::LidarRecord> records;
    for (const LidarReturn& r : returns) {
      records.push_back({r.point.x(), r.point.y(), r.point.z(), r.intensity, static_cast<float>(r.ring)});
      if (reading.is_key_frame) count(reading.sample, r.actor, &Findings::lidar);
    }
    dataset::writeLidarBin(file, records);
  }

  void count(std::size_t sample, std::int32_t actor, std::vector<int> Findings::*kind) {
    if (actor < 0) return;
    const std::lock_guard<std::mutex> lock(findings_mutex_);
    ++(findings_[sample].*kind)[static_cast<std::size_t>(actor)];
  }

  PinholeCamera cameraOf(const PlannedReading& reading, double time_s) const {
    return cameraAt(cameraMounts()[plan_.sensors[reading.sensor].number], *scenario_.ego, time_s,
                    options_.width, options_.height);
  }

  void takePictureOf(std::size_t number, const Snapshot& snapshot, const fs::path& file,
                     std::uint64_t stream) {
    const PlannedReading& reading = plan_.readings[number];
    const PinholeCamera camera = cameraOf(reading, reading.time_s);
    const VisibleSurfaces surfaces = traceSurfaces(snapshot, camera);
    const cv::Mat radiance = renderRadiance(scenario_.world, snapshot, camera, surfaces,
                                            scenario_.ego->at(reading.time_s).T_map_from_body);
    storeImage(file, ".jpg",
               takePicture(radiance, scenario_.world.lighting, options_.image, options_.seed, stream),
               {cv::IMWRITE_JPEG_QUALITY, options_.image.jpeg_quality});
    const cv::Mat actors = actorTruth(surfaces, snapshot);
    if (reading.is_key_frame) masks_[number] = masksOf(number, actors);
    const bool wanted = options_.ground_truth == GroundTruth::kAll ||
                        (options_.ground_truth == GroundTruth::kKeyframes && reading.is_key_frame);
    if (wanted && plan_.sensors[reading.sensor].mount.channel == "CAM_FRONT")
      storeGroundTruth(reading, snapshot, camera, surfaces, actors);
  }

  void storeGroundTruth(const PlannedReading& reading, const Snapshot& snapshot, const PinholeCamera& camera,
                        const VisibleSurfaces& surfaces, const cv::Mat& actors) const {
    storeTruth("depth", reading, encodeDepth(depthTruth(surfaces, camera)));
    storeTruth("instance", reading, actors);
    storeTruth("motion", reading, motionTruth(actors, scenario_.world, reading.time_s));
    const auto storeFlow = [&](std::int64_t other_us, const std::string& prefix) {
      const double other_s = 1e-6 * static_cast<double>(other_us - plan_.start_us);
      const Snapshot other(scenario_.world, *geometry_, other_s);
      const FlowTruth truth = flowTruth(surfaces, snapshot, camera, other, cameraOf(reading, other_s));
      storeTruth(prefix + "flow", reading, encodeFlow(truth.flow));
      storeTruth(prefix + "occlusion", reading, truth.occlusion);
    };
    // In pairs only a keyframe's successor is the next image of the camera.
    const bool next_follows = options_.frames == CameraFrames::kAll ||
                              (options_.frames == CameraFrames::kPairs && reading.is_key_frame);
    if (next_follows && reading.next_us >= 0) storeFlow(reading.next_us, "");
    if (reading.is_key_frame) {
      const std::int64_t next = nextKeyframe(reading);
      if (next >= 0) storeFlow(next, "keyframe_");
    }
  }

  std::int64_t nextKeyframe(const PlannedReading& reading) const {
    for (const PlannedReading& other : plan_.readings)
      if (other.sensor == reading.sensor && other.is_key_frame && other.sample == reading.sample + 1)
        return other.timestamp_us;
    return -1;
  }

  void storeTruth(const std::string& kind, const PlannedReading& reading, const cv::Mat& image) const {
    // Depth and flow take one filter of PNG, as OpenCV does without a level, and a search for repeats: to try
    // all filters takes twice as long and saves a tenth. Masks do with run lengths.
    const bool is_mask = image.type() != CV_16UC3 && kind != "depth";
    storeImage(folder_ / "ground_truth" / kind / (stemOf(reading) + ".png"), ".png", image,
               is_mask ? std::vector<int>{}
                       : std::vector<int>{cv::IMWRITE_PNG_STRATEGY, cv::IMWRITE_PNG_STRATEGY_DEFAULT});
  }

  std::vector<dataset::NewMask> masksOf(std::size_t number, const cv::Mat& actors) const {
    std::vector<int> pixels(scenario_.world.actors.size() + 1, 0);
    for (const std::uint16_t actor : cv::Mat_<std::uint16_t>(actors)) ++pixels[actor];
    std::vector<dataset::NewMask> masks;
    for (std::size_t actor = 0; actor + 1 < pixels.size(); ++actor) {
      const Actor& who = scenario_.world.actors[actor];
      if (pixels[actor + 1] < kFewestMaskPixels || who.model->category.empty()) continue;
      dataset::NewMask mask;
      mask.reading = number;
      mask.instance = actor;
      const std::string attribute = attributeOf(who, plan_.readings[number].time_s);
      if (!attribute.empty()) mask.attributes.push_back(attribute);
      mask.mask = dataset::encodeMask(actors == static_cast<double>(actor + 1));
      masks.push_back(std::move(mask));
    }
    return masks;
  }

  double timeOf(std::size_t sample) const {
    return 1e-6 * static_cast<double>(plan_.samples_us[sample] - plan_.start_us);
  }

  void lookAtActors(std::size_t sample) {
    const Snapshot snapshot(scenario_.world, *geometry_, timeOf(sample));
    visible_shares_[sample] = visibleShares(scenario_.world, snapshot, *scenario_.ego);
  }

  /// Which row of the tables a number of the instance images is.
  void storeInstances() const {
    std::string text = "{";
    for (std::size_t actor = 0; actor < scene_.instances.size(); ++actor)
      text += fmt::format("{}\n\"{}\": \"{}\"", text.size() > 1 ? "," : "", actor + 1,
                          dataset::instanceToken(scene_.name, actor));
    text += "\n}\n";
    dataset::writeBytes(folder_ / "ground_truth" / (scene_.name + "_instances.json"), text.data(),
                        text.size());
  }

  dataset::NewScene finish() {
    for (const auto& of_reading : masks_)
      for (const dataset::NewMask& mask : of_reading)
        findings_[scene_.readings[mask.reading].sample].masks[mask.instance] += 1;
    for (const Actor& actor : scenario_.world.actors)
      // Without a category it is never annotated, and so not in the tables, whatever stands here.
      scene_.instances.push_back(actor.model->category.empty() ? "movable_object.debris"
                                                               : actor.model->category);
    for (std::size_t sample = 0; sample < plan_.samples_us.size(); ++sample)
      for (auto& annotation : annotate(scenario_.world, *scenario_.ego, timeOf(sample), sample,
                                       findings_[sample], visible_shares_[sample]))
        scene_.annotations.push_back(std::move(annotation));
    for (auto& of_reading : masks_) {
      for (dataset::NewMask& mask : of_reading) {
        mask.visibility =
            visibilityLevel(visible_shares_[scene_.readings[mask.reading].sample][mask.instance]);
        scene_.masks.push_back(std::move(mask));
      }
    }
    double begin_s = 0.0;
    double end_s = timeOf(plan_.samples_us.size() - 1);
    for (const PlannedReading& reading : plan_.readings) {
      begin_s = std::min(begin_s, reading.time_s);
      end_s = std::max(end_s, reading.time_s);
    }
    scene_.can_bus = simulateCanBus(*scenario_.ego, begin_s - kCanMargin, end_s + kCanMargin, plan_.start_us,
                                    options_.chassis, options_.seed);
    if (options_.ground_truth != GroundTruth::kNone) storeInstances();
    return std::move(scene_);
  }

  const Scenario& scenario_;
  const DriveOptions& options_;
  fs::path folder_;
  DrivePlan plan_;
  std::unique_ptr<RayGeometry> geometry_;
  dataset::NewScene scene_;
  std::vector<std::size_t> order_;  ///< of the readings in time
  std::mutex findings_mutex_;
  std::vector<Findings> findings_;                    ///< per sample
  std::vector<std::vector<double>> visible_shares_;   ///< per sample and actor
  std::vector<std::vector<dataset::NewMask>> masks_;  ///< per reading
};

}  // namespace

dataset::NewScene simulateDrive(const Scenario& scenario, const DriveOptions& options, std::size_t number,
                                const fs::path& folder, const DriveProgress& progress) {
  checkOptions(options);
  return Drive(scenario, options, number, folder).run(progress);
}

}  // namespace radar_dot::simulation
