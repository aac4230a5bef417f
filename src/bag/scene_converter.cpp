// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/bag/scene_converter.h"

#include <fmt/format.h>
#include <rosbag/view.h>
#include <sensor_msgs/CompressedImage.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <boost/make_shared.hpp>
#include <cstdint>
#include <initializer_list>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "radar_dot/bag/messages.h"
#include "radar_dot/common/image_fault.h"
#include "radar_dot/dataset/file_bytes.h"
#include "radar_dot/dataset/point_files.h"
#include "scene_content.h"

namespace radar_dot::bag {
namespace {

namespace fs = std::filesystem;
using dataset::Index;
using dataset::Tables;

constexpr char kNodeName[] = "/nuscenes_to_bag";

/// `<folder>/<scene>.bag`. The name comes from a file: it must not lead out of the folder.
fs::path bagPath(const Tables& tables, Index scene, const fs::path& folder) {
  const std::string& name = at(tables.scenes, scene).name;
  if (name.empty() || name.find('/') != std::string::npos) {
    throw dataset::DatasetError(
        fmt::format("scene.json, record {}, field name: \"{}\" cannot name a bag file", scene, name));
  }
  return folder / (name + ".bag");
}

/// The name of a file may say something else. @throws DatasetError where it is no whole image
std::string formatOf(const std::vector<std::uint8_t>& image, const fs::path& file) {
  const auto begins = [&image](std::initializer_list<std::uint8_t> bytes) {
    return image.size() > bytes.size() && std::equal(bytes.begin(), bytes.end(), image.begin());
  };
  const bool is_jpeg = begins({0xff, 0xd8, 0xff});
  if (!image.empty() && !is_jpeg && !begins({0x89, 'P', 'N', 'G'}))
    throw dataset::DatasetError(file.string() + ": is neither a JPEG nor a PNG image");
  if (const std::string fault = imageFault(image); !fault.empty())
    throw dataset::DatasetError(file.string() + ": is no whole image: " + fault);
  return is_jpeg ? "jpeg" : "png";
}

dataset::Modality modalityOf(const Tables& tables, const dataset::SampleData& row) {
  return at(tables.sensors, at(tables.calibrated_sensors, row.calibrated_sensor).sensor).modality;
}

std::string topicOf(const Tables& tables, const dataset::SampleData& row) {
  const bool is_camera = modalityOf(tables, row) == dataset::Modality::kCamera;
  return "/" + frameOf(tables.channelOf(row)) + (is_camera ? "/image/compressed" : "");
}

/// A bag has its name since it is complete; files may have come since then.
ConvertSummary summaryOf(const fs::path& file, const Tables& tables, const SceneContent& content) {
  ConvertSummary summary;
  summary.file = file;
  summary.existed = true;
  summary.missing = content.missing;
  std::set<std::string> topics;
  std::size_t on_disk = 0;
  for (const Index reading : content.readings) {
    const dataset::SampleData& row = at(tables.sample_data, reading);
    if (modalityOf(tables, row) == dataset::Modality::kOther) continue;  // is not converted
    topics.insert(topicOf(tables, row));
    ++on_disk;
  }
  std::size_t in_bag = 0;
  try {
    rosbag::Bag bag(file.string(), rosbag::bagmode::Read);
    summary.messages = rosbag::View(bag).size();
    in_bag = rosbag::View(bag, rosbag::TopicQuery(std::vector(topics.begin(), topics.end()))).size();
  } catch (const std::exception& error) {
    throw dataset::DatasetError(
        fmt::format("{} exists already and is no complete bag ({}): remove it, or allow "
                    "overwriting (--force)",
                    file.string(), error.what()));
  }
  if (in_bag < on_disk)
    throw dataset::DatasetError(
        fmt::format("{} exists already, with {} of the {} sensor files that are on disk "
                    "now: remove it, or allow overwriting (--force)",
                    file.string(), in_bag, on_disk));
  return summary;
}

/// What `rosbag play` looks for to latch a topic again, and which vehicle the bag is of.
boost::shared_ptr<ros::M_string> latchedTfHeader(const std::string& vehicle) {
  auto header = boost::make_shared<ros::M_string>();
  (*header)["callerid"] = kNodeName;
  (*header)["latching"] = "1";
  (*header)["topic"] = "/tf_static";
  (*header)["type"] = ros::message_traits::DataType<tf2_msgs::TFMessage>::value();
  (*header)["md5sum"] = ros::message_traits::MD5Sum<tf2_msgs::TFMessage>::value();
  (*header)["message_definition"] = ros::message_traits::Definition<tf2_msgs::TFMessage>::value();
  (*header)["vehicle"] = vehicle;
  return header;
}

/// Turns the events of one scene into messages of its bag.
class SceneWriter {
 public:
  SceneWriter(const Tables& tables, const SceneContent& content, BagFile& bag)
      : tables_(tables), content_(content), bag_(bag) {}

  void writeMounts(const ros::Time& start, const std::string& vehicle);
  void write(const Event& event);

  std::size_t readings() const noexcept { return readings_; }
  std::size_t radarFiles() const noexcept { return radar_files_; }
  std::uintmax_t sensorBytes() const noexcept { return sensor_bytes_; }

 private:
  void writeReading(Index reading);
  void writeCloud(const dataset::SampleData& reading, PointCloud&& cloud, const std::string& frame);
  void writeImage(const dataset::SampleData& reading, const std::string& frame);
  void writeCameraInfo(const dataset::SampleData& reading, const std::string& frame);
  void writeMask(Index reading);

  const Tables& tables_;
  const SceneContent& content_;
  BagFile& bag_;
  std::size_t readings_ = 0;
  std::size_t radar_files_ = 0;
  std::uintmax_t sensor_bytes_ = 0;
  std::map<std::string, std::uint32_t> clouds_;  // by frame: how many
};

void SceneWriter::writeMounts(const ros::Time& start, const std::string& vehicle) {
  tf2_msgs::TFMessage mounts;
  for (const Index reading : content_.mounts) {
    const dataset::SampleData& row = at(tables_.sample_data, reading);
    mounts.transforms.push_back(toTransform(at(tables_.calibrated_sensors, row.calibrated_sensor),
                                            frameOf(tables_.channelOf(row)), start));
  }
  bag_.write("/tf_static", start, mounts, latchedTfHeader(vehicle));
}

void SceneWriter::write(const Event& event) {
  const ros::Time time = toTime(event.time_us);
  switch (event.kind) {
    case EventKind::kEgoPose:
      bag_.write(
          "/ground_truth/odom", time,
          toOdometry(at(tables_.ego_poses, content_.poses[event.index]), content_.twists[event.index]));
      break;
    case EventKind::kBoxes:
      bag_.write("/ground_truth/boxes", time, toBoxes(tables_, content_.keyframes[event.index]));
      break;
    case EventKind::kImu: bag_.write("/can/imu", time, toImu(content_.can.imu[event.index])); break;
    case EventKind::kWheelSpeed:
      bag_.write("/can/wheel_speed", time, toWheelSpeed(content_.can.vehicle[event.index]));
      break;
    case EventKind::kReading:
      writeReading(content_.readings[event.index]);
      ++readings_;
      break;
    case EventKind::kMask: writeMask(static_cast<Index>(event.index)); break;
  }
}

void SceneWriter::writeReading(Index reading) {
  const dataset::SampleData& row = at(tables_.sample_data, reading);
  const std::string frame = frameOf(tables_.channelOf(row));
  switch (modalityOf(tables_, row)) {
    case dataset::Modality::kRadar:
      writeCloud(row, dataset::readRadarPcd(tables_.path(row)), frame);
      ++radar_files_;
      break;
    case dataset::Modality::kLidar: writeCloud(row, dataset::readLidarBin(tables_.path(row)), frame); break;
    case dataset::Modality::kCamera:
      writeImage(row, frame);
      writeCameraInfo(row, frame);
      break;
    case dataset::Modality::kOther: break;
  }
}

void SceneWriter::writeCloud(const dataset::SampleData& reading, PointCloud&& cloud,
                             const std::string& frame) {
  const ros::Time stamp = toTime(reading.timestamp_us);
  sensor_msgs::PointCloud2 message = toPointCloud2(std::move(cloud), frame, stamp);
  message.header.seq = ++clouds_[frame];  // a replay keeps it, and shows what is lost
  bag_.write(topicOf(tables_, reading), stamp, message);
  sensor_bytes_ += fs::file_size(tables_.path(reading));
}

void SceneWriter::writeImage(const dataset::SampleData& reading, const std::string& frame) {
  const fs::path file = tables_.path(reading);
  sensor_msgs::CompressedImage image;
  image.header.stamp = toTime(reading.timestamp_us);
  image.header.frame_id = frame;
  image.data = dataset::readBytes(file);
  image.format = formatOf(image.data, file);
  bag_.write(topicOf(tables_, reading), image.header.stamp, image);
  sensor_bytes_ += image.data.size();
}

void SceneWriter::writeCameraInfo(const dataset::SampleData& reading, const std::string& frame) {
  const ros::Time stamp = toTime(reading.timestamp_us);
  if (reading.width == 0 || reading.height == 0)
    throw dataset::DatasetError(fmt::format("sample_data.json: the record of {} has no width and height",
                                            tables_.path(reading).string()));
  bag_.write("/" + frame + "/camera_info", stamp,
             toCameraInfo(at(tables_.calibrated_sensors, reading.calibrated_sensor), reading, frame, stamp));
}

void SceneWriter::writeMask(Index reading) {
  const dataset::SampleData& row = at(tables_.sample_data, reading);
  const std::string frame = frameOf(tables_.channelOf(row));
  const ros::Time stamp = toTime(row.timestamp_us);
  // A mask is of use without its image, but not without the camera's intrinsics.
  const bool has_image =
      std::find(content_.readings.begin(), content_.readings.end(), reading) != content_.readings.end();
  if (!has_image) writeCameraInfo(row, frame);
  bag_.write(frame == "cam_front" ? "/ground_truth/dynamic_mask/compressed"
                                  : "/ground_truth/" + frame + "/dynamic_mask/compressed",
             stamp, toDynamicMask(tables_, content_.masks.at(reading), frame, stamp));
}

}  // namespace

ConvertSummary convertScene(const Tables& tables, Index scene, const fs::path& folder,
                            const ConvertOptions& options, const ProgressCallback& progress) {
  const SceneContent content = collectContent(tables, scene, options);
  const fs::path file = bagPath(tables, scene, folder);
  if (!options.overwrite && fs::is_regular_file(file)) return summaryOf(file, tables, content);
  const std::vector<Event> events = schedule(tables, content);
  BagFile bag(file, options.compression, options.overwrite);
  SceneWriter writer(tables, content, bag);
  // Readers of a bag do not order messages of the same time: a microsecond keeps the mounts first.
  const Index log = at(tables.scenes, scene).log;
  writer.writeMounts(toTime(events.front().time_us - 1),
                     log == dataset::kNone ? "" : at(tables.logs, log).vehicle);
  for (const Event& event : events) {
    writer.write(event);
    if (progress) progress(writer.readings(), content.readings.size());
  }
  ConvertSummary summary;
  summary.bag_bytes = bag.commit();
  summary.file = bag.path();
  summary.messages = bag.messages();
  summary.radar_files = writer.radarFiles();
  summary.sensor_bytes = writer.sensorBytes();
  summary.missing = content.missing;
  return summary;
}

}  // namespace radar_dot::bag
