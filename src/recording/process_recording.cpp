// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <XmlRpcValue.h>
#include <cv_bridge/cv_bridge.h>
#include <diagnostic_msgs/DiagnosticArray.h>
#include <fmt/format.h>
#include <ros/init.h>
#include <ros/param.h>
#include <sensor_msgs/Image.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "radar_dot/bag/bag_file.h"
#include "radar_dot/bag/bag_input.h"
#include "radar_dot/common/fields.h"
#include "recording/nodelet_graph.h"
#include "tools/command_line.h"
#include "tools/progress_bar.h"
#include "tools/signal_watch.h"

// What process_bag starts, with a master that holds the parameters, and those nodelets in ~nodelets.

namespace {

using radar_dot::bag::BagFile;
using radar_dot::bag::BagInput;
using radar_dot::recording::NodeletEntry;
using radar_dot::recording::NodeletGraph;

const std::string kMounts = "/tf_static";

constexpr double kStart = 2.0;       // s until everything has come once
constexpr double kAfterwards = 1.0;  // s of silence, for what still waits

struct Arguments {
  std::vector<std::string> bags;
  std::string output;
  radar_dot::bag::BagSelection selection;
  std::vector<std::string> topics;
  bool pictures = true;
  bool six_panel = false;
  bool copy = true;
  radar_dot::bag::Compression compression = radar_dot::bag::Compression::kLz4;
  bool force = false;
  bool quiet = false;

  void describe(radar_dot::FieldList& fields) {
    fields.group("Input");
    fields.add("bags", bags, "Bags of one recording");
    selection.describe(fields);
    fields.group("Output");
    fields.add("output", output, "The bag that is written");
    fields.add("topics", topics,
               "Outputs to write, e.g. ego/twist,dynamic/mask; empty: all but intermediate images; all: all "
               "of them");
    fields.add("pictures", pictures, "Write overlay/mask as JPEG, where topics is empty");
    fields.add("six_panel", six_panel, "Write overlay/six_panel as JPEG, where topics is empty");
    fields.add("copy", copy, "Copy the inputs as well, except images and clouds");
    fields.add("compression", compression, "Compression of the bag");
    fields.add("force", force, "Overwrite a bag that exists");
    fields.add("quiet", quiet, "Print warnings and errors only");
  }
};

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

bool isBulky(const std::string& type) {
  return type == "sensor_msgs/Image" || type == "sensor_msgs/CompressedImage" || type == "radar_dot/Flow" ||
         type == "sensor_msgs/PointCloud2";
}

/// What dynamic_reconfigure and image_transport publish of themselves.
bool isHousekeeping(const std::string& type) { return type.rfind("dynamic_reconfigure/", 0) == 0; }

std::vector<NodeletEntry> nodeletsOf(XmlRpc::XmlRpcValue entries) {
  std::vector<NodeletEntry> nodelets;
  const int count = entries.size();
  for (int i = 0; i < count; ++i) {
    XmlRpc::XmlRpcValue& entry = entries[i];
    nodelets.push_back({entry["name"], entry["type"], {}});
    for (auto& [from, to] : entry["remappings"])
      nodelets.back().remappings[from] = static_cast<std::string>(to);
  }
  return nodelets;
}

/// What the diagnostics said, by status.
class Findings {
 public:
  void add(const diagnostic_msgs::DiagnosticArray& message) {
    for (const diagnostic_msgs::DiagnosticStatus& status : message.status) {
      Finding& finding = findings_[status.name];
      ++finding.reports;
      if (status.level == diagnostic_msgs::DiagnosticStatus::OK) continue;
      ++finding.bad;
      finding.text = status.message;
    }
  }
  void print() const {
    for (const auto& [name, finding] : findings_) {
      if (finding.bad > 0)
        std::puts(fmt::format("  {}: {} ({} of {} reports)", name, finding.text, finding.bad, finding.reports)
                      .c_str());
    }
  }
  bool any() const {
    return std::any_of(findings_.begin(), findings_.end(),
                       [](const auto& entry) { return entry.second.bad > 0; });
  }

 private:
  struct Finding {
    std::size_t reports = 0, bad = 0;
    std::string text;  ///< the latest
  };
  std::map<std::string, Finding> findings_;
};

class Processing {
 public:
  Processing(const Arguments& arguments, const std::vector<NodeletEntry>& nodelets)
      : arguments_(arguments),
        input_({arguments.bags.begin(), arguments.bags.end()}, arguments.selection),
        output_(arguments.output, arguments.compression, arguments.force),
        graph_(nodelets, input_.begin()) {}

  void run(const radar_dot::tools::SignalWatch& signals) {
    chooseOutputs();
    const std::vector<std::string> heard = graph_.start();
    const std::vector<std::string> topics = topicsToRead(heard);
    radar_dot::tools::ProgressBar bar(std::filesystem::path(arguments_.output).filename().string(), "s",
                                      !arguments_.quiet);
    const double length = (input_.end() - input_.begin()).toSec();
    // Mounts hold for all of the recording, whenever they were sent.
    input_.read({kMounts}, [this](const rosbag::MessageInstance& message) { take(message, input_.begin()); });
    input_.read(
        topics,
        [this](const rosbag::MessageInstance& message) {
          if (!together_.empty() && message.getTime() != together_.front().getTime()) takeTogether();
          together_.push_back(message);
        },
        [&](double done) {
          signals.check();
          bar.update(static_cast<std::size_t>(std::max(0.0, done)), static_cast<std::size_t>(length) + 1);
        });
    takeTogether();
    graph_.advanceTo(input_.end() + ros::Duration(kAfterwards));
    reportMissing(heard);
  }

  std::uintmax_t commit() { return output_.commit(); }

  void printSummary(std::uintmax_t bytes, double seconds) const {
    const double length = (input_.end() - input_.begin()).toSec();
    std::puts(fmt::format("{}: {:.1f} s of recording in {:.1f} s, {:.1f} times as fast as it was; {:.1f} MB",
                          arguments_.output, length, seconds, length / seconds,
                          1e-6 * static_cast<double>(bytes))
                  .c_str());
    for (const auto& [topic, count] : counts_)
      std::puts(fmt::format("  {:<32} {:6d}  {:6.1f} Hz", topic, count, static_cast<double>(count) / length)
                    .c_str());
    if (!missing_.empty())
      std::puts(fmt::format("listened to, but not in the recording: {}", fmt::join(missing_, ", ")).c_str());
    if (findings_.any()) std::puts("diagnostics that were not OK, with the latest message:");
    findings_.print();
  }

 private:
  void chooseOutputs() {
    const std::set<std::string> asked = [this] {
      std::set<std::string> names;
      for (const std::string& topic : arguments_.topics)
        names.insert(topic == "all" ? topic : ros::names::resolve(topic));
      return names;
    }();
    const bool all = asked.count("all") > 0;
    for (const auto& [topic, type] : graph_.outputs()) {
      const bool is_picture =
          asked.empty() && (endsWith(topic, "/overlay/mask") || endsWith(topic, "/overlay/six_panel"));
      bool wanted = asked.count(topic) > 0;
      if (all) wanted = !isHousekeeping(type) && type != "sensor_msgs/CompressedImage";
      if (asked.empty()) {
        wanted = is_picture ? (endsWith(topic, "mask") ? arguments_.pictures : arguments_.six_panel)
                            : !isHousekeeping(type) &&
                                  (!isBulky(type) || endsWith(topic, "/dynamic/mask") ||
                                   endsWith(topic, "radar/static") || endsWith(topic, "radar/dynamic"));
      }
      if (!wanted) continue;
      counts_[topic] = 0;
      graph_.record(topic, [this, topic = topic,
                            is_picture](const ros::MessageEvent<const NodeletGraph::Output>& event) {
        write(topic, is_picture, event);
      });
    }
    for (const std::string& topic : asked) {
      if (topic == "all" || graph_.outputs().count(topic) > 0) continue;
      std::vector<std::string> names;
      for (const auto& [name, type] : graph_.outputs())
        if (!isHousekeeping(type)) names.push_back(name);
      throw std::runtime_error(
          fmt::format("--topics: no nodelet publishes {}; there are {}", topic, fmt::join(names, ", ")));
    }
  }

  void write(const std::string& topic, bool is_picture,
             const ros::MessageEvent<const NodeletGraph::Output>& event) {
    const NodeletGraph::Output& message = *event.getConstMessage();
    if (message.getDataType() == "diagnostic_msgs/DiagnosticArray") {
      if (!isUnderWay(ros::Time::now())) return;
      findings_.add(*message.instantiate<diagnostic_msgs::DiagnosticArray>());
    }
    ++counts_[topic];
    if (is_picture) {
      const cv_bridge::CvImageConstPtr picture = cv_bridge::toCvShare(
          boost::shared_ptr<sensor_msgs::Image>(message.instantiate<sensor_msgs::Image>()));
      output_.write(topic + "/compressed", ros::Time::now(), *picture->toCompressedImageMsg());
      return;
    }
    output_.write(topic, ros::Time::now(), message, event.getConnectionHeaderPtr());
  }

  /// Neither at the start nor after the end, where silence is no finding.
  bool isUnderWay(const ros::Time& time) const {
    return time > input_.begin() + ros::Duration(kStart) && time <= input_.end();
  }

  std::vector<std::string> topicsToRead(const std::vector<std::string>& heard) const {
    std::vector<std::string> topics;
    std::vector<std::string> ours;
    for (const auto& [topic, type] : input_.topics()) {
      const bool is_heard = std::find(heard.begin(), heard.end(), topic) != heard.end();
      if (isOurs(topic))
        ours.push_back(topic);
      else if (topic != kMounts && (is_heard || !isBulky(type)))
        topics.push_back(topic);
    }
    if (!ours.empty()) {
      std::fputs(fmt::format("the recording's own {} {} left out: the nodelets publish them again\n",
                             fmt::join(ours, ", "), ours.size() == 1 ? "is" : "are")
                     .c_str(),
                 stderr);
    }
    return topics;
  }

  /// Transforms and diagnostics come from many sides.
  bool isOurs(const std::string& topic) const {
    return graph_.outputs().count(topic) > 0 && topic != "/tf" && topic != kMounts && topic != "/diagnostics";
  }

  /// Of messages of one time those come first that say how to read the others.
  void takeTogether() {
    for (const bool is_bulky : {false, true})
      for (const rosbag::MessageInstance& message : together_)
        if (isBulky(message.getDataType()) == is_bulky) take(message, message.getTime());
    together_.clear();
  }

  void take(const rosbag::MessageInstance& message, const ros::Time& time) {
    if (message.getTopic() != "/diagnostics") graph_.take(message, time);
    if (arguments_.copy && !isBulky(message.getDataType()) && graph_.outputs().count(message.getTopic()) == 0)
      output_.write(message.getTopic(), time, message, message.getConnectionHeader());
  }

  void reportMissing(const std::vector<std::string>& heard) {
    for (const std::string& topic : heard) {
      if (topic != "/clock" && input_.topics().count(topic) == 0 && graph_.outputs().count(topic) == 0)
        missing_.push_back(topic);
    }
    std::sort(missing_.begin(), missing_.end());
  }

  const Arguments& arguments_;
  BagInput input_;
  BagFile output_;
  std::map<std::string, std::size_t> counts_;
  Findings findings_;
  std::vector<std::string> missing_;
  std::vector<rosbag::MessageInstance> together_;  ///< messages of one time
  NodeletGraph graph_;
};

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  radar_dot::tools::CommandLine command_line("process_recording", "Runs the nodelets of ~nodelets over bags.",
                                             {"process_bag IN.bag --config MY.yaml --output OUT.bag"});
  command_line.add("", radar_dot::fieldsOf(arguments));
  command_line.require("bags");
  command_line.require("output");
  if (const std::optional<int> exit_code = command_line.parse(argc, argv)) return *exit_code;
  return command_line.run("no bag is left behind", [&] {
    const radar_dot::tools::SignalWatch signals;
    ros::init(ros::M_string{}, "process_bag",
              ros::init_options::NoSigintHandler | ros::init_options::NoRosout);
    XmlRpc::XmlRpcValue nodelets;
    ros::param::get("/process_bag/nodelets", nodelets);
    const auto start = std::chrono::steady_clock::now();
    Processing processing(arguments, nodeletsOf(nodelets));
    processing.run(signals);
    const std::uintmax_t bytes = processing.commit();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (!arguments.quiet) processing.printSummary(bytes, seconds);
  });
}
