// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rapidjson/prettywriter.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "output_file.h"

namespace radar_dot::dataset {

/// Writes a JSON list of flat records in the layout of the official tables: a line for each field
/// and list element. Numbers keep all their digits.
class JsonTableWriter {
 public:
  /// @throws DatasetError here and below where the file cannot be written.
  explicit JsonTableWriter(std::filesystem::path file)
      : stream_{OutputFile(std::move(file))}, json_(stream_) {
    json_.SetIndent(' ', 0);
    json_.StartArray();
  }
  JsonTableWriter(const JsonTableWriter&) = delete;
  JsonTableWriter& operator=(const JsonTableWriter&) = delete;

  /// Begins the next record.
  JsonTableWriter& record() {
    endRecord();
    json_.StartObject();
    in_record_ = true;
    return *this;
  }
  /// Adds a field to the record; numbers must be finite.
  template <typename T>
  JsonTableWriter& set(std::string_view name, const T& value) {
    writeText(name);
    write(value);
    return *this;
  }
  /// Adds a field that is an object.
  template <typename Fill>
  JsonTableWriter& setObject(std::string_view name, const Fill& fill) {
    writeText(name);
    json_.StartObject();
    fill(*this);
    json_.EndObject();
    return *this;
  }
  /// Ends the list and closes the file.
  void finish() {
    endRecord();
    json_.EndArray();
    stream_.Put('\n');
    stream_.file.close();
  }

 private:
  struct Stream {
    using Ch = char;
    void Put(char character) { file.put(character); }
    void Flush() {}  // RapidJSON asks for it once the list is complete; finish() closes the file
    OutputFile file;
  };

  void endRecord() {
    if (in_record_) json_.EndObject();
    in_record_ = false;
  }
  /// RapidJSON sees a key in the text that comes first.
  void writeText(std::string_view text) {
    json_.String(text.data(), static_cast<rapidjson::SizeType>(text.size()));
  }
  template <typename T>
  void write(const T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      json_.Bool(value);
    } else if constexpr (std::is_integral_v<T>) {
      json_.Int64(static_cast<std::int64_t>(value));
    } else if constexpr (std::is_floating_point_v<T>) {
      json_.Double(value);
    } else {
      writeText(value);
    }
  }
  template <typename T>
  void write(const std::vector<T>& values) {
    writeList(values);
  }
  template <typename T, std::size_t N>
  void write(const std::array<T, N>& values) {
    writeList(values);
  }
  template <typename List>
  void writeList(const List& values) {
    json_.StartArray();
    for (const auto& value : values) write(value);
    json_.EndArray();
  }

  Stream stream_;
  rapidjson::PrettyWriter<Stream> json_;
  bool in_record_ = false;
};

}  // namespace radar_dot::dataset
