// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ros/time.h>
#include <rosbag/bag.h>
#include <rosbag/message_instance.h>

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "radar_dot/common/fields.h"

namespace radar_dot::bag {

/// Which part of a recording is read.
struct BagSelection {
  double start = 0.0;     ///< s after the first message
  double duration = 0.0;  ///< s; 0: to the end
  void describe(FieldList& fields);
};

/// One or several bags of a recording, read as one in the order of time. Compressed ones too.
class BagInput {
 public:
  /// @throws std::runtime_error naming the file and the cure when one is missing, is no bag, was not closed
  ///         (rosbag reindex), or when nothing lies in the selected part
  explicit BagInput(const std::vector<std::filesystem::path>& files, const BagSelection& selection = {});
  ~BagInput();

  /// Times of the first and the last message of the selected part.
  ros::Time begin() const noexcept { return begin_; }
  ros::Time end() const noexcept { return end_; }
  /// Message type by topic, of the whole bags.
  const std::map<std::string, std::string>& topics() const noexcept { return topics_; }

  /// Calls `body` with each message of these topics (with a leading slash; empty: all) within the selected
  /// part, or from earlier where it is static: the messages of /tf_static before the part come first.
  /// Equal times keep the order of files and of messages in them.
  /// @param progress  s of the part that are done, after each message
  void read(const std::vector<std::string>& topics,
            const std::function<void(const rosbag::MessageInstance&)>& body,
            const std::function<void(double)>& progress = {}) const;

 private:
  std::vector<std::unique_ptr<rosbag::Bag>> bags_;
  std::map<std::string, std::string> topics_;
  ros::Time begin_, end_;
};

}  // namespace radar_dot::bag
