// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/bag/bag_input.h"

#include <fmt/format.h>
#include <rosbag/view.h>

#include <algorithm>
#include <stdexcept>
#include <system_error>

#include "bag_records.h"

namespace radar_dot::bag {
namespace {

namespace fs = std::filesystem;

std::unique_ptr<rosbag::Bag> opened(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) {
    throw std::runtime_error(
        fmt::format("cannot read {}: {}", file.string(),
                    fs::exists(file, error) ? "it is no file" : "there is no such file"));
  }
  auto bag = std::make_unique<rosbag::Bag>();
  try {
    checkBagRecords(file);
    bag->open(file.string(), rosbag::bagmode::Read);
  } catch (const rosbag::BagUnindexedException&) {
    throw std::runtime_error(
        fmt::format("cannot read {}: its recording was not ended; `rosbag reindex {}` repairs it",
                    file.string(), file.string()));
  } catch (const std::exception& exception) {
    throw std::runtime_error(fmt::format("cannot read {} as a bag: {}", file.string(), exception.what()));
  }
  return bag;
}

bool isStatic(const rosbag::ConnectionInfo* connection) { return connection->topic == "/tf_static"; }

}  // namespace

void BagSelection::describe(FieldList& fields) {
  const Range from_zero{0.0, 1e9};
  fields.add("start", start, "Skip this much of the recording", "s", from_zero);
  fields.add("duration", duration, "Read this much from there on; 0: to the end", "s", from_zero);
}

BagInput::BagInput(const std::vector<fs::path>& files, const BagSelection& selection) {
  rosbag::View whole;
  for (const fs::path& file : files) {
    bags_.push_back(opened(file));
    whole.addQuery(*bags_.back());
  }
  for (const rosbag::ConnectionInfo* connection : whole.getConnections())
    topics_[connection->topic] = connection->datatype;
  if (whole.size() > 0) {
    begin_ = whole.getBeginTime() + ros::Duration(selection.start);
    end_ = whole.getEndTime();
    if (selection.duration > 0.0 && selection.duration < (end_ - begin_).toSec())
      end_ = begin_ + ros::Duration(selection.duration);
  }
  if (whole.size() == 0 || begin_ > end_) {
    throw std::runtime_error(fmt::format(
        "{}: no message {}", files.empty() ? "no bag" : files.front().string(),
        whole.size() == 0 ? "in it"
                          : fmt::format("from --start {} s on; the recording takes {:.1f} s", selection.start,
                                        (whole.getEndTime() - whole.getBeginTime()).toSec())));
  }
}

BagInput::~BagInput() = default;

void BagInput::read(const std::vector<std::string>& topics,
                    const std::function<void(const rosbag::MessageInstance&)>& body,
                    const std::function<void(double)>& progress) const {
  const auto isWanted = [&](const rosbag::ConnectionInfo* connection) {
    return topics.empty() || std::find(topics.begin(), topics.end(), connection->topic) != topics.end();
  };
  rosbag::View view;
  for (const std::unique_ptr<rosbag::Bag>& bag : bags_) {
    if (begin_ > ros::TIME_MIN) {
      view.addQuery(
          *bag, [&](const rosbag::ConnectionInfo* c) { return isStatic(c) && isWanted(c); }, ros::TIME_MIN,
          begin_ - ros::Duration(0, 1));
    }
    view.addQuery(*bag, isWanted, begin_, end_);
  }
  for (const rosbag::MessageInstance& message : view) {
    body(message);
    if (progress) progress((message.getTime() - begin_).toSec());
  }
}

}  // namespace radar_dot::bag
