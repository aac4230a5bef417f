// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <limits>
#include <unordered_set>

#include "dataroot_layout.h"
#include "table_source.h"

namespace radar_dot::dataset {

namespace fs = std::filesystem;

namespace {

/// Shortest records that occur, bytes. Rows are reserved for a file full of them: memory that is
/// never touched costs nothing, while growing by copies would double the peak.
constexpr std::size_t kShortestReading = 330;
constexpr std::size_t kShortestPose = 180;
/// A file name is less than a quarter of its record.
constexpr std::size_t kFilenameShare = 4;

Modality modalityOf(std::string_view name) {
  if (name == "camera") return Modality::kCamera;
  if (name == "lidar") return Modality::kLidar;
  if (name == "radar") return Modality::kRadar;
  return Modality::kOther;
}

}  // namespace

/// Reads table after table, in an order that lets most references be resolved on sight and that
/// tells which rows of the large tables belong to the wanted scenes.
class TableLoader {
 public:
  TableLoader(const fs::path& dataroot, const LoadOptions& options) : options_(options) {
    tables_.dataroot_ = dataroot;
    tables_.version_ = options.version;
  }

  Tables load() {
    requireTables(tables_.dataroot_, tables_.version_, options_.annotations);
    readSensors();
    readLogs();
    readScenes();
    readSamples();
    readSampleData();
    readEgoPoses();
    readNames();
    if (options_.annotations) {
      readAnnotations();
      readInstances();
    }
    tables_.reading_by_token_ = std::move(readings_.index);
    tables_.buildIndices();
    return std::move(tables_);
  }

 private:
  bool filtering() const noexcept { return !options_.scenes.empty(); }
  fs::path folder() const { return tables_.dataroot_ / tables_.version_; }
  fs::path file(std::string_view table) const { return folder() / fmt::format("{}.json", table); }
  std::string label(std::string_view table) const {
    return fmt::format("{}/{}.json", tables_.version_, table);
  }

  /// Reads a table; field 0 is the token. `read` fills a row and says whether to keep it.
  template <typename Row, typename Read>
  TableSource<Row> readTable(std::string_view table, const Record::FieldNames& fields, std::vector<Row>& rows,
                             const Read& read) {
    TableSource<Row> source;
    source.label = label(table);
    source.rows = &rows;
    const auto on_record = [&](const Record& record) {
      if (rows.size() >= static_cast<std::size_t>(std::numeric_limits<Index>::max()))
        record.fail(0, "is of a record too many; load fewer scenes");
      Row row;
      if (!read(record, row)) return;
      row.token = tables_.tokens.intern(record.text(0));
      if (row.token == Token{}) record.fail(0, "is empty");
      rows.push_back(std::move(row));
      if (filtering()) source.records.push_back(record.number());
    };
    // requireTables() has found all that are needed.
    if (fs::exists(file(table))) readRecords(file(table), source.label, fields, on_record);
    if (const Index twin = source.index.build(rows); twin != kNone) {
      const auto row = static_cast<std::size_t>(twin);
      const auto first = static_cast<std::size_t>(source.find(rows[row].token));
      throw DatasetError(fmt::format("{} record {} (token {}): field 'token' is that of record {} already",
                                     source.label, source.recordOf(row), tables_.tokens.text(rows[row].token),
                                     source.recordOf(first)));
    }
    return source;
  }

  template <typename Target>
  Index reference(const Record& record, std::size_t field, const TableSource<Target>& target) const {
    return resolve(record, field, tables_.tokens, target);
  }

  void readSensors() {
    enum { kToken, kChannel, kModality };
    const auto sensors = readTable("sensor", {"token", "channel", "modality"}, tables_.sensors,
                                   [](const Record& record, Sensor& row) {
                                     row.channel = record.text(kChannel);
                                     row.modality = modalityOf(record.text(kModality));
                                     return true;
                                   });
    enum { kSelf, kSensor, kTranslation, kRotation, kIntrinsic };
    calibrations_ = readTable(
        "calibrated_sensor", {"token", "sensor_token", "translation", "rotation", "camera_intrinsic"},
        tables_.calibrated_sensors, [&](const Record& record, CalibratedSensor& row) {
          row.sensor = reference(record, kSensor, sensors);
          const auto t = record.numbers<3>(kTranslation);
          const auto q = record.quaternion(kRotation);
          row.T_base_from_sensor.translation() << t[0], t[1], t[2];
          row.T_base_from_sensor.linear() =
              Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized().toRotationMatrix();
          row.camera_matrix = cameraMatrix(record, kIntrinsic);
          return true;
        });
  }

  static std::optional<Eigen::Matrix3d> cameraMatrix(const Record& record, std::size_t field) {
    if (!record.has(field)) return std::nullopt;
    const JsonValue::ConstArray rows = record.list(field);
    if (rows.Empty()) return std::nullopt;
    Eigen::Matrix3d matrix;
    for (unsigned i = 0; i < 9; ++i) {
      if (rows.Size() != 3 || !rows[i / 3].IsArray() || rows[i / 3].Size() != 3 ||
          !rows[i / 3][i % 3].IsNumber())
        record.fail(field, "must be empty or 3 lists of 3 numbers");
      matrix(i / 3, i % 3) = rows[i / 3][i % 3].GetDouble();
    }
    if (!matrix.allFinite()) record.fail(field, "must hold finite numbers");
    return matrix;
  }

  void readLogs() {
    logs_ = readTable("log", {"token", "vehicle"}, tables_.logs, [](const Record& record, Log& row) {
      if (record.has(1)) row.vehicle = record.text(1);
      return true;
    });
  }

  void readScenes() {
    enum { kToken, kName, kLog };
    std::vector<std::string> names;
    scenes_ = readTable(
        "scene", {"token", "name", "log_token"}, tables_.scenes, [&](const Record& record, Scene& row) {
          row.name = record.text(kName);
          names.push_back(row.name);
          if (filtering() &&
              std::find(options_.scenes.begin(), options_.scenes.end(), row.name) == options_.scenes.end())
            return false;
          if (!tables_.logs.empty()) row.log = reference(record, kLog, logs_);
          return true;
        });
    for (const std::string& name : options_.scenes)
      if (std::find(names.begin(), names.end(), name) == names.end())
        throw DatasetError(
            fmt::format("{} holds no scene '{}'; scenes there: {}", scenes_.label, name, sortedList(names)));
  }

  void readSamples() {
    enum { kToken, kTimestamp, kScene };
    samples_ = readTable("sample", {"token", "timestamp", "scene_token"}, tables_.samples,
                         [&](const Record& record, Sample& row) {
                           if (isOfOtherScene(record, kScene, scenes_)) return false;
                           row.scene = reference(record, kScene, scenes_);
                           row.timestamp_us = record.integer(kTimestamp);
                           return true;
                         });
  }

  void readSampleData() {
    enum { kToken, kSample, kPose, kMount, kTime, kKeyFrame, kHeight, kWidth, kFilename, kPrevious };
    PendingColumn previous{"prev", {}};
    if (!filtering()) {
      const std::size_t bytes = fs::file_size(file("sample_data"));
      const std::size_t rows = bytes / kShortestReading;
      for (PendingColumn* column : {&poses_of_readings_, &previous}) column->tokens.reserve(rows);
      tables_.sample_data.reserve(rows);
      tables_.filenames_.reserve(bytes / kFilenameShare);
    }
    readings_ = readTable("sample_data",
                          {"token", "sample_token", "ego_pose_token", "calibrated_sensor_token", "timestamp",
                           "is_key_frame", "height", "width", "filename", "prev"},
                          tables_.sample_data, [&](const Record& record, SampleData& row) {
                            if (isOfOtherScene(record, kSample, samples_)) return false;
                            row.sample = reference(record, kSample, samples_);
                            row.calibrated_sensor = reference(record, kMount, calibrations_);
                            row.timestamp_us = record.integer(kTime);
                            row.is_key_frame = record.boolean(kKeyFrame);
                            row.height = side(record, kHeight);
                            row.width = side(record, kWidth);
                            keepFilename(record, kFilename, row);
                            remember(poses_of_readings_, record, kPose);
                            remember(previous, record, kPrevious);
                            return true;
                          });
    resolve(tables_.sample_data, &SampleData::previous, previous, readings_, readings_, tables_.tokens);
  }

  void readEgoPoses() {
    enum { kToken, kTimestamp, kTranslation, kRotation };
    std::unordered_set<Token> wanted;
    if (filtering())
      wanted.insert(poses_of_readings_.tokens.begin(), poses_of_readings_.tokens.end());
    else
      tables_.ego_poses.reserve(fs::file_size(file("ego_pose")) / kShortestPose);
    const auto poses = readTable("ego_pose", {"token", "timestamp", "translation", "rotation"},
                                 tables_.ego_poses, [&](const Record& record, EgoPose& row) {
                                   if (isUnwanted(record, wanted)) return false;
                                   row.timestamp_us = record.integer(kTimestamp);
                                   row.translation = record.numbers<3>(kTranslation);
                                   row.rotation = record.quaternion(kRotation);
                                   return true;
                                 });
    resolve(tables_.sample_data, &SampleData::ego_pose, poses_of_readings_, readings_, poses, tables_.tokens);
    poses_of_readings_.tokens = {};
  }

  void readNames() {
    const auto read_name = [](const Record& record, auto& row) {
      row.name = record.text(1);
      return true;
    };
    categories_ = readTable("category", {"token", "name"}, tables_.categories, read_name);
    attributes_ = readTable("attribute", {"token", "name"}, tables_.attributes, read_name);
  }

  void readAnnotations() {
    enum { kToken, kSample, kInstance, kAttributes, kTranslation, kSize, kRotation, kPrevious, kNext };
    PendingColumn previous{"prev", {}}, next{"next", {}};
    annotations_ = readTable("sample_annotation",
                             {"token", "sample_token", "instance_token", "attribute_tokens", "translation",
                              "size", "rotation", "prev", "next"},
                             tables_.annotations, [&](const Record& record, SampleAnnotation& row) {
                               if (isOfOtherScene(record, kSample, samples_)) return false;
                               row.sample = reference(record, kSample, samples_);
                               row.attributes = attributesOf(record, kAttributes);
                               row.translation = record.numbers<3>(kTranslation);
                               row.size = record.numbers<3>(kSize);
                               row.rotation = record.quaternion(kRotation);
                               remember(instances_of_annotations_, record, kInstance);
                               remember(previous, record, kPrevious);
                               remember(next, record, kNext);
                               return true;
                             });
    resolve(tables_.annotations, &SampleAnnotation::previous, previous, annotations_, annotations_,
            tables_.tokens);
    resolve(tables_.annotations, &SampleAnnotation::next, next, annotations_, annotations_, tables_.tokens);
  }

  void readInstances() {
    enum { kToken, kCategory };
    std::unordered_set<Token> wanted;
    if (filtering())
      wanted.insert(instances_of_annotations_.tokens.begin(), instances_of_annotations_.tokens.end());
    const auto instances = readTable("instance", {"token", "category_token"}, tables_.instances,
                                     [&](const Record& record, Instance& row) {
                                       if (isUnwanted(record, wanted)) return false;
                                       row.category = reference(record, kCategory, categories_);
                                       return true;
                                     });
    resolve(tables_.annotations, &SampleAnnotation::instance, instances_of_annotations_, annotations_,
            instances, tables_.tokens);
  }

  /// Stores a reference to be resolved later. Only prev and next may be empty.
  void remember(PendingColumn& column, const Record& record, std::size_t field) {
    const std::string_view text = record.text(field);
    if (text.empty() && column.field != "prev" && column.field != "next") record.fail(field, "is empty");
    column.tokens.push_back(tables_.tokens.intern(text));
  }

  /// The owner of a row is not among the wanted scenes (or its samples), which are all known by now.
  template <typename Owner>
  bool isOfOtherScene(const Record& record, std::size_t field, const TableSource<Owner>& owners) const {
    return filtering() && owners.find(tables_.tokens.find(record.text(field))) == kNone;
  }

  bool isUnwanted(const Record& record, const std::unordered_set<Token>& wanted) const {
    return filtering() && wanted.find(tables_.tokens.find(record.text(0))) == wanted.end();
  }

  void keepFilename(const Record& record, std::size_t field, SampleData& row) {
    const std::string_view name = record.text(field);
    std::string& names = tables_.filenames_;
    if (name.empty() || name.size() > UINT16_MAX) record.fail(field, "must hold 1..65535 characters");
    if (names.size() > UINT32_MAX - name.size()) record.fail(field, "is one too many; load fewer scenes");
    row.filename_offset = static_cast<std::uint32_t>(names.size());
    row.filename_length = static_cast<std::uint16_t>(name.size());
    names.append(name);
  }

  std::vector<Index> attributesOf(const Record& record, std::size_t field) const {
    std::vector<Index> found;
    for (const std::string_view token : record.texts(field)) {
      found.push_back(attributes_.find(tables_.tokens.find(token)));
      if (found.back() == kNone) record.fail(field, danglingReference(std::string(token), attributes_.label));
    }
    return found;
  }

  /// Of an image, px; other sensors may have none.
  static std::uint16_t side(const Record& record, std::size_t field) {
    return record.has(field) ? static_cast<std::uint16_t>(record.integer(field, 0, UINT16_MAX))
                             : std::uint16_t{0};
  }

  const LoadOptions& options_;
  Tables tables_;
  TableSource<CalibratedSensor> calibrations_;
  TableSource<Log> logs_;
  TableSource<Scene> scenes_;
  TableSource<Sample> samples_;
  TableSource<SampleData> readings_;
  TableSource<Category> categories_;
  TableSource<Attribute> attributes_;
  TableSource<SampleAnnotation> annotations_;
  PendingColumn poses_of_readings_{"ego_pose_token", {}};
  PendingColumn instances_of_annotations_{"instance_token", {}};
};

Tables Tables::load(const fs::path& dataroot, const LoadOptions& options) {
  return TableLoader(dataroot, options).load();
}

}  // namespace radar_dot::dataset
