// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <rosbag/bag.h>
#include <rosbag/view.h>

#include <boost/shared_ptr.hpp>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace radar_dot::test {

/// A bag opened for reading.
class BagReader {
 public:
  explicit BagReader(const std::filesystem::path& file) : bag_(file.string()), view_(bag_) {}

  rosbag::View& view() noexcept { return view_; }

  /// Number of messages by topic.
  std::map<std::string, std::size_t> counts();

  /// All messages of a topic in the order of the bag.
  template <typename Message>
  std::vector<boost::shared_ptr<Message>> messages(const std::string& topic) {
    std::vector<boost::shared_ptr<Message>> found;
    for (const rosbag::MessageInstance& message : view_) {
      if (message.getTopic() == topic) found.push_back(message.instantiate<Message>());
    }
    return found;
  }

 private:
  rosbag::Bag bag_;
  rosbag::View view_;
};

/// A binary PCD file taken apart without the package's own reader.
struct RawPcd {
  struct Field {
    std::string name;
    char type = 'F';
    std::size_t size = 0;
    std::size_t offset = 0;  ///< bytes from the start of a record
  };
  std::vector<Field> fields;
  std::size_t points = 0;
  std::size_t record = 0;  ///< bytes
  std::string data;        ///< the records, without padding
};

/// @throws std::runtime_error.
RawPcd readRawPcd(const std::filesystem::path& file);

/// Microseconds of a stamp, which must not hold finer parts.
std::int64_t microseconds(const ros::Time& time);

}  // namespace radar_dot::test
