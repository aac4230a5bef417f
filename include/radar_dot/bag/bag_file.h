// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>
#include <rosbag/bag.h>

#include <boost/shared_ptr.hpp>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include "radar_dot/common/enum_names.h"

namespace radar_dot {

class InUse;

namespace bag {

enum class Compression : std::uint8_t { kNone, kLz4, kBz2 };

}  // namespace bag

template <>
struct EnumNames<bag::Compression> {
  static constexpr EnumName<bag::Compression> kValues[] = {
      {bag::Compression::kNone, "none"}, {bag::Compression::kLz4, "lz4"}, {bag::Compression::kBz2, "bz2"}};
};

namespace bag {

/// A rosbag that appears under its name only when it is complete: it grows as
/// `<file>.partial-<process id>` and is renamed by commit(). Without a commit nothing stays behind but of a
/// process that is killed, and that goes with the next bag of this name.
class BagFile {
 public:
  /// Opens the bag for writing; missing folders are made.
  /// @throws std::runtime_error naming the path and the cause when the bag exists and may not be
  ///         overwritten, or cannot be opened.
  BagFile(std::filesystem::path file, Compression compression, bool overwrite);
  ~BagFile();
  BagFile(const BagFile&) = delete;
  BagFile& operator=(const BagFile&) = delete;

  /// Appends a message.
  /// @param header  connection header, for what the topic's name and type do not tell (latching)
  /// @throws std::runtime_error naming the path and the cause (for example a full disk).
  template <typename Message>
  void write(const std::string& topic, const ros::Time& time, const Message& message,
             const boost::shared_ptr<ros::M_string>& header = {}) {
    errno = 0;
    try {
      bag_->write(topic, time, message, header);
    } catch (const ros::Exception& error) {
      fail(errno, error.what());
    }
    ++messages_;
  }

  /// Closes the bag, waits until the disk has it and gives it its name.
  /// @return size of the bag, bytes
  /// @throws std::runtime_error naming the path and the cause; the bag is abandoned then.
  std::uintmax_t commit();

  /// Messages written.
  std::size_t messages() const noexcept { return messages_; }
  const std::filesystem::path& path() const noexcept { return file_; }

 private:
  void open(Compression compression);
  void close();
  void abandon() noexcept;
  [[noreturn]] void fail(int cause, const std::string& otherwise) const;

  std::filesystem::path file_;
  std::filesystem::path partial_;
  bool overwrite_ = false;
  std::unique_ptr<rosbag::Bag> bag_;
  std::unique_ptr<InUse> in_use_;
  std::size_t messages_ = 0;
};

}  // namespace bag
}  // namespace radar_dot
