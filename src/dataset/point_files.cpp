// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/dataset/point_files.h"

#include <fmt/format.h>
#include <pcl/io/lzf.h>
#include <pcl/io/pcd_io.h>
#include <pcl/register_point_struct.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <sstream>
#include <string_view>
#include <utility>

#include "output_file.h"
#include "radar_dot/dataset/file_bytes.h"
#include "radar_dot/dataset/tables.h"

POINT_CLOUD_REGISTER_POINT_STRUCT(
    radar_dot::dataset::RadarRecord,
    (float, x, x)(float, y, y)(float, z, z)(std::int8_t, dyn_prop, dyn_prop)(std::int16_t, id, id)     //
    (float, rcs, rcs)(float, vx, vx)(float, vy, vy)(float, vx_comp, vx_comp)(float, vy_comp, vy_comp)  //
    (std::int8_t, is_quality_valid, is_quality_valid)(std::int8_t, ambig_state, ambig_state)           //
    (std::int8_t, x_rms, x_rms)(std::int8_t, y_rms, y_rms)(std::int8_t, invalid_state, invalid_state)  //
    (std::int8_t, pdh0, pdh0)(std::int8_t, vx_rms, vx_rms)(std::int8_t, vy_rms, vy_rms))

namespace radar_dot::dataset {
namespace {

constexpr float kMaxRing = 1023.0F;

std::vector<std::string_view> wordsOf(std::string_view line) {
  std::vector<std::string_view> words;
  for (std::size_t start = line.find_first_not_of(" \t\r"); start != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(" \t\r", start), line.size());
    words.push_back(line.substr(start, end - start));
    start = line.find_first_not_of(" \t\r", end);
  }
  return words;
}

/// Goes through the lines up to DATA and then puts their entries together. PCL's own reading of a header
/// names no line, allocates whatever POINTS says, and takes a file without points for an error.
class PcdHeader {
 public:
  PcdHeader(std::string_view content, const std::filesystem::path& file) : content_(content), file_(file) {
    while (entries_.find("DATA") == entries_.end()) parseLine(nextLine());
    constexpr std::string_view kFormats[] = {"ascii", "binary", "binary_compressed"};
    const Entry& data = entry("DATA");
    if (data.values.size() != 1 ||
        std::find(std::begin(kFormats), std::end(kFormats), data.values[0]) == std::end(kFormats))
      fail(data.line, "DATA must be ascii, binary or binary_compressed");
  }

  /// ascii, binary or binary_compressed.
  std::string_view format() const { return entry("DATA").values[0]; }

  /// What follows the header.
  std::string_view body() const { return content_.substr(position_); }

  /// The fields and the number of points; no data.
  PointCloud emptyCloud() const {
    PointCloud cloud;
    const Entry& names = entry("FIELDS");
    if (names.values.empty()) fail(names.line, "there are no fields");
    for (const char* name : {"SIZE", "TYPE", "COUNT"}) {
      if (entry(name).values.size() != names.values.size())
        fail(entry(name).line, fmt::format("{} has {} values for {} FIELDS", name, entry(name).values.size(),
                                           names.values.size()));
    }
    for (std::size_t i = 0; i < names.values.size(); ++i) {
      const std::string size(entry("SIZE").values[i]), type(entry("TYPE").values[i]);
      const auto scalar = static_cast<ScalarType>(pcl::getFieldType(std::atoi(size.c_str()), type[0]));
      if (type.size() != 1 || scalarSize(scalar) == 0 || std::to_string(scalarSize(scalar)) != size)
        fail(entry("TYPE").line,
             fmt::format("field '{}' has TYPE {} of SIZE {}", names.values[i], type, size));
      if (entry("COUNT").values[i] != "1")
        fail(entry("COUNT").line,
             fmt::format("field '{}' has COUNT {}, must be 1", names.values[i], entry("COUNT").values[i]));
      if (names.values[i] == "_") fail(names.line, "a field '_' is padding, which PCL does not read");
      if (findField(cloud.fields, names.values[i]) != nullptr)
        fail(names.line, fmt::format("field '{}' appears twice", names.values[i]));
      cloud.fields.push_back(
          {std::string(names.values[i]), static_cast<std::uint32_t>(cloud.point_step), scalar, 1});
      cloud.point_step += scalarSize(scalar);
    }
    cloud.size = number("POINTS");
    if (number("WIDTH") * number("HEIGHT") != cloud.size)
      fail(entry("POINTS").line, fmt::format("POINTS is {} but WIDTH x HEIGHT is {}", cloud.size,
                                             number("WIDTH") * number("HEIGHT")));
    return cloud;
  }

 private:
  struct Entry {
    std::vector<std::string_view> values;
    std::size_t line = 0;
  };

  [[noreturn]] void fail(std::size_t line, std::string_view complaint) const {
    throw DatasetError(fmt::format("{}: header line {}: {}", file_.string(), line, complaint));
  }

  std::string_view nextLine() {
    const std::size_t end = content_.find('\n', position_);
    if (end == std::string_view::npos)
      throw DatasetError(
          fmt::format("{}: no DATA line, so this is no PCD file or only the start of one", file_.string()));
    const std::string_view line = content_.substr(position_, end - position_);
    position_ = end + 1;
    ++line_;
    return line;
  }

  void parseLine(std::string_view line) {
    constexpr std::string_view kKeywords[] = {"VERSION", "FIELDS",    "SIZE",   "TYPE",   "COUNT",
                                              "WIDTH",   "VIEWPOINT", "HEIGHT", "POINTS", "DATA"};
    const std::vector<std::string_view> words = wordsOf(line);
    if (words.empty() || words[0][0] == '#') return;
    if (std::find(std::begin(kKeywords), std::end(kKeywords), words[0]) == std::end(kKeywords))
      fail(line_, fmt::format("'{}' is no entry of a PCD header", printable(words[0])));
    entries_[words[0]] = {{words.begin() + 1, words.end()}, line_};
  }

  const Entry& entry(std::string_view name) const {
    const auto found = entries_.find(name);
    if (found == entries_.end()) fail(line_, fmt::format("the header has no {}", name));
    return found->second;
  }

  std::size_t number(std::string_view name) const {
    constexpr std::size_t kMostDigits = 9;
    const Entry& found = entry(name);
    const std::string text(found.values.size() == 1 ? found.values[0] : "");
    if (text.empty() || text.size() > kMostDigits ||
        text.find_first_not_of("0123456789") != std::string::npos)
      fail(found.line, fmt::format("{} must be one whole number", name));
    return std::strtoul(text.c_str(), nullptr, 10);
  }

  static std::string printable(std::string_view text) {
    std::string shown(text.substr(0, 20));
    for (char& letter : shown)
      if (letter < ' ' || letter > '~') letter = '?';
    return shown;
  }

  std::string_view content_;
  const std::filesystem::path& file_;
  std::size_t position_ = 0;
  std::size_t line_ = 0;
  std::map<std::string_view, Entry> entries_;
};

/// The lines of an ASCII body that hold the records of the cloud, as many as there are.
std::string recordLines(std::string_view body, const PointCloud& cloud, const std::filesystem::path& file) {
  std::istringstream stream{std::string(body)};
  std::string lines;
  std::size_t record = 0;
  for (std::string line; record < cloud.size && std::getline(stream, line);) {
    const std::size_t count = wordsOf(line).size();
    if (count == 0) continue;
    if (count != cloud.fields.size())
      throw DatasetError(fmt::format("{}: record {} (counted from 0) has {} values for {} FIELDS",
                                     file.string(), record, count, cloud.fields.size()));
    lines += line + '\n';
    ++record;
  }
  return lines;
}

/// PCL makes some number of any word, and another of one that the type of its field cannot hold.
void checkAscii(const std::string& lines, const PointCloud& cloud, const std::filesystem::path& file) {
  std::istringstream words(lines);
  for (std::size_t record = 0; record < cloud.size; ++record) {
    for (const PointField& field : cloud.fields) {
      std::string word;
      words >> word;
      char* end = nullptr;
      const double given = field.type == ScalarType::kFloat32 ? double{std::strtof(word.c_str(), &end)}
                                                              : std::strtod(word.c_str(), &end);
      const double read = readScalar(cloud.view().point(record) + field.offset, field.type);
      if (*end != '\0' || !(given == read || (std::isnan(given) && std::isnan(read))))
        throw DatasetError(fmt::format("{}: record {} (counted from 0): '{}' is no value for the field '{}'",
                                       file.string(), record, word, field.name));
    }
  }
}

/// nuScenes pads its files with zeros; anything else are records of another size than the header says.
void requirePadding(std::string_view body, const PointCloud& cloud, const std::filesystem::path& file) {
  const std::size_t end = cloud.size * cloud.point_step;
  if (end >= body.size() || body.find_first_not_of('\0', end) == std::string_view::npos) return;
  throw DatasetError(
      fmt::format("{}: the data go on behind the last of {} records of {} bytes; SIZE, COUNT or "
                  "POINTS of its header are wrong",
                  file.string(), cloud.size, cloud.point_step));
}

/// Whether compressed data unpack to `size` bytes; PCL reads, and allocates, whatever they say.
bool unpacks(std::string_view body, std::size_t size) {
  std::uint32_t sizes[2] = {};  // packed, unpacked
  if (body.size() < sizeof sizes) return false;
  std::memcpy(sizes, body.data(), sizeof sizes);
  constexpr std::size_t kBestRatio = 88;  // 264 bytes by 3
  if (sizes[0] > body.size() - sizeof sizes || sizes[1] != size || size / kBestRatio > sizes[0]) return false;
  std::vector<char> unpacked(size);
  return pcl::lzfDecompress(body.data() + sizeof sizes, sizes[0], unpacked.data(), sizes[1]) == size;
}

template <typename Scalar>
void append(OutputFile& file, Scalar value) {
  file.write({reinterpret_cast<const char*>(&value), sizeof value});
}

/// By PCL, which trusts the header: what there is must have been checked.
std::vector<std::uint8_t> readRecords(std::string_view body, std::string_view format, const PointCloud& cloud,
                                      const std::filesystem::path& file) {
  pcl::PCLPointCloud2 records;
  for (const PointField& field : cloud.fields) {
    pcl::PCLPointField& column = records.fields.emplace_back();
    column.name = field.name;
    column.offset = field.offset;
    column.datatype = static_cast<std::uint8_t>(field.type);
    column.count = field.count;
  }
  records.height = 1;
  records.width = static_cast<std::uint32_t>(cloud.size);
  records.point_step = static_cast<std::uint32_t>(cloud.point_step);
  records.data.resize(cloud.size * cloud.point_step);
  std::istringstream text(format == "ascii" ? std::string(body) : "");
  const auto* bytes = reinterpret_cast<const unsigned char*>(body.data());
  pcl::PCDReader reader;
  if ((format == "ascii"
           ? reader.readBodyASCII(text, records, pcl::PCDReader::PCD_V7)
           : reader.readBodyBinary(bytes, records, pcl::PCDReader::PCD_V7, format != "binary", 0)) != 0)
    throw DatasetError(fmt::format("{}: PCL cannot read its records", file.string()));
  return std::move(records.data);
}

}  // namespace

PointCloud readPcd(const std::filesystem::path& file) {
  const std::vector<std::uint8_t> bytes = readBytes(file);
  const PcdHeader header({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, file);
  PointCloud cloud = header.emptyCloud();
  const std::string_view format = header.format();
  const std::string lines = format == "ascii" ? recordLines(header.body(), cloud, file) : "";
  const std::string_view body = format == "ascii" ? lines : header.body();
  if (format == "binary_compressed") {
    if (cloud.size != 0 && !unpacks(body, cloud.size * cloud.point_step))
      throw DatasetError(
          fmt::format("{}: the compressed data of the {} records are incomplete or damaged; "
                      "extract it again",
                      file.string(), cloud.size));
  } else {
    if (format == "binary") requirePadding(body, cloud, file);
    const std::size_t available = format == "ascii"
                                      ? static_cast<std::size_t>(std::count(body.begin(), body.end(), '\n'))
                                      : body.size() / cloud.point_step;
    if (available < cloud.size)
      throw DatasetError(
          fmt::format("{}: the data end in record {} of {} (counted from 0); the file is incomplete, "
                      "extract it again",
                      file.string(), available, cloud.size));
  }
  if (cloud.size == 0) return cloud;
  cloud.data = readRecords(body, format, cloud, file);
  if (format == "ascii") checkAscii(lines, cloud, file);
  return cloud;
}

PointCloud readLidarBin(const std::filesystem::path& file) {
  PointCloud cloud;
  for (const char* name : {"x", "y", "z", "intensity", "ring"}) {
    cloud.fields.push_back({name, static_cast<std::uint32_t>(cloud.point_step), ScalarType::kFloat32, 1});
    cloud.point_step += sizeof(float);
  }
  cloud.data = readBytes(file);
  if (cloud.data.size() % cloud.point_step != 0)
    throw DatasetError(
        fmt::format("{}: {} bytes are no multiple of a record of {} (five float32); is the file complete?",
                    file.string(), cloud.data.size(), cloud.point_step));
  cloud.size = cloud.data.size() / cloud.point_step;
  bool is_empty = true;
  for (std::size_t i = 0; i < cloud.size; ++i) {
    std::array<float, 5> record{};
    std::memcpy(record.data(), cloud.data.data() + i * cloud.point_step, cloud.point_step);
    const float ring = record[4];
    if (!std::isfinite(record[0] + record[1] + record[2]) || !(ring >= 0.0F && ring <= kMaxRing) ||
        ring != std::floor(ring))
      throw DatasetError(fmt::format(
          "{}: record {} (counted from 0) is no x y z intensity ring: {} {} {} {} {}; the file has "
          "other records than five float32, or is none of points",
          file.string(), i, record[0], record[1], record[2], record[3], ring));
    is_empty = is_empty && record == std::array<float, 5>{};
  }
  if (is_empty && cloud.size > 1)
    throw DatasetError(
        fmt::format("{}: holds zeros alone; the file is incomplete, extract it again", file.string()));
  return cloud;
}

PointCloud readRadarPcd(const std::filesystem::path& file) {
  PointCloud cloud = readPcd(file);
  const bool has_velocity =
      std::any_of(cloud.fields.begin(), cloud.fields.end(), [](const PointField& field) {
        std::string name = field.name;
        for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        return name.front() == 'v' || name.find("doppler") != std::string::npos ||
               name.find("rate") != std::string::npos || name.find("speed") != std::string::npos ||
               name == "rdot";
      });
  if (!has_velocity)
    throw DatasetError(fmt::format("{}: is no radar scan, which has a velocity; its fields are: {}",
                                   file.string(), fieldNames(cloud.fields)));
  return cloud;
}

void writeRadarPcd(const std::filesystem::path& file, const std::vector<RadarRecord>& records) {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  if (records.empty())  // the stand-in for a scan without returns in nuScenes
    return writeRadarPcd(file, {{kNan, kNan, kNan, 0, 0, kNan, kNan, kNan, kNan, kNan}});
  std::vector<pcl::PCLPointField> fields;
  pcl::for_each_type<pcl::traits::fieldList<RadarRecord>::type>(pcl::detail::FieldAdder<RadarRecord>(fields));
  OutputFile output(file);  // names what is wrong, which PCDWriter::writeBinary() does not
  output.write(
      pcl::PCDWriter::generateHeader(pcl::PointCloud<RadarRecord>(), static_cast<int>(records.size())));
  output.write("DATA binary\n");
  for (const RadarRecord& record : records)
    for (const pcl::PCLPointField& field : fields)
      output.write({reinterpret_cast<const char*>(&record) + field.offset,
                    static_cast<std::size_t>(pcl::getFieldSize(field.datatype))});
  output.close();
}

void writeLidarBin(const std::filesystem::path& file, const std::vector<LidarRecord>& records) {
  OutputFile output(file);
  for (const LidarRecord& r : records)
    for (const float value : {r.x, r.y, r.z, r.intensity, r.ring}) append(output, value);
  output.close();
}

}  // namespace radar_dot::dataset
