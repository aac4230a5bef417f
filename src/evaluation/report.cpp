// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/report.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "report_format.h"

namespace radar_dot::evaluation {
namespace {

Mean meanOf(const VelocityReport& report, const char* variant) {
  const auto found = report.mae.find(variant);
  return found == report.mae.end() ? Mean{} : found->second;
}

ModelErrors errorsOf(const VelocityReport& report, const char* model) {
  const auto found = report.models.find(model);
  return found == report.models.end() ? ModelErrors{} : found->second;
}

void writeTrajectory(JsonWriter& writer, const char* key, const TrajectoryError& error) {
  writer.Key(key);
  writer.StartObject();
  number(writer, "ate_rmse", error.rootMeanSquare());
  number(writer, "drift_percent", error.driftPercent());
  number(writer, "distance", error.distance);
  writer.EndObject();
}

void writeErrors(JsonWriter& writer, const char* key, const ModelErrors& errors) {
  writer.Key(key);
  writer.StartObject();
  number(writer, "vx_mae", errors.vx.value());
  number(writer, "vy_mae", errors.vy.value());
  number(writer, "yaw_rate_mae", errors.yaw_rate.value());
  number(writer, "vx_normalised_squared", errors.normalised_vx.value());
  number(writer, "vy_normalised_squared", errors.normalised_vy.value());
  number(writer, "yaw_rate_normalised_squared", errors.normalised_yaw_rate.value());
  writer.EndObject();
}

void writeReport(JsonWriter& writer, const VelocityReport& report, bool overall) {
  writer.StartObject();
  if (!overall) {
    writer.Key("scene");
    writer.String(report.scene.c_str());
  }
  count(writer, "frames", report.frames);
  count(writer, "refused", report.refused);
  writer.Key("refusals");
  writer.StartObject();
  for (const auto& [reason, times] : report.refusals) count(writer, reason.c_str(), times);
  writer.EndObject();
  writer.Key("mae");
  writer.StartObject();
  for (const char* variant : kVariants) number(writer, variant, meanOf(report, variant).value());
  writer.EndObject();
  writer.Key("models");
  writer.StartObject();
  for (const auto& [model, errors] : report.models) writeErrors(writer, model.c_str(), errors);
  writer.EndObject();
  writer.Key("causal");
  writer.StartObject();
  writeErrors(writer, "single", report.causal);
  writeErrors(writer, "filter", report.filtered);
  count(writer, "rejected", report.filter_rejected);
  count(writer, "starts", report.filter_starts);
  writer.EndObject();
  writer.Key("wheel_speed");
  writer.StartObject();
  number(writer, "vx_mae", report.wheel_estimate.value());
  number(writer, "ground_truth_vx_mae", report.wheel_ground_truth.value());
  writer.EndObject();
  writer.Key("mount_yaw_error");
  writer.StartObject();
  for (const auto& [channel, error] : report.mounts) number(writer, channel.c_str(), error.yaw());
  writer.EndObject();
  count(writer, "sweeps", report.sweeps);
  count(writer, "sweeps_refused", report.sweeps_refused);
  writer.Key("trajectory");
  writer.StartObject();
  writeTrajectory(writer, "gt_heading", report.gt_heading);
  writeTrajectory(writer, "own_heading", report.own_heading);
  writer.EndObject();
  writer.Key("dynamic");
  writer.StartObject();
  number(writer, "precision", report.dynamic.precision());
  number(writer, "recall", report.dynamic.recall());
  number(writer, "f1", report.dynamic.f1());
  number(writer, "precision_70m", report.dynamic_70m.precision());
  number(writer, "recall_70m", report.dynamic_70m.recall());
  number(writer, "f1_70m", report.dynamic_70m.f1());
  writer.EndObject();
  writer.EndObject();
}

/// One column of a table or CSV file.
struct Column {
  std::string title;
  std::function<std::string(const VelocityReport&)> text;
};

std::vector<Column> estimatorColumns() {
  std::vector<Column> columns = {
      {"frames", [](const VelocityReport& r) { return std::to_string(r.frames); }},
      {"refused", [](const VelocityReport& r) { return std::to_string(r.refused); }}};
  for (const char* variant : kVariants) {
    columns.push_back(
        {variant, [variant](const VelocityReport& r) { return figure(meanOf(r, variant).value()); }});
  }
  return columns;
}

std::vector<Column> modelColumns() {
  std::vector<Column> columns;
  for (const char* model : {"planar", "planar_yaw", "ackermann", "spatial"}) {
    columns.push_back({fmt::format("{}_vx", model),
                       [model](const VelocityReport& r) { return figure(errorsOf(r, model).vx.value()); }});
    columns.push_back({fmt::format("{}_vy", model),
                       [model](const VelocityReport& r) { return figure(errorsOf(r, model).vy.value()); }});
    if (std::string(model) == "planar_yaw" || std::string(model) == "ackermann") {
      columns.push_back({fmt::format("{}_yaw_rate", model), [model](const VelocityReport& r) {
                           return figure(errorsOf(r, model).yaw_rate.value(), 4);
                         }});
    }
  }
  columns.push_back({"wheel_vx", [](const VelocityReport& r) { return figure(r.wheel_estimate.value()); }});
  columns.push_back(
      {"wheel_vs_truth", [](const VelocityReport& r) { return figure(r.wheel_ground_truth.value()); }});
  return columns;
}

/// The latest estimate before the middle of each pair, single and filtered.
std::vector<Column> causalColumns() {
  std::vector<Column> columns;
  for (const auto& [name, errors] :
       {std::pair{"single", &VelocityReport::causal}, {"filter", &VelocityReport::filtered}}) {
    const auto add = [&, which = errors](const char* axis, Mean ModelErrors::*mean, int decimals) {
      columns.push_back({fmt::format("{}_{}", name, axis), [=](const VelocityReport& r) {
                           return figure((r.*which.*mean).value(), decimals);
                         }});
    };
    add("vx", &ModelErrors::vx, 3);
    add("vy", &ModelErrors::vy, 3);
    add("yaw_rate", &ModelErrors::yaw_rate, 4);
  }
  columns.push_back({"rejected", [](const VelocityReport& r) { return std::to_string(r.filter_rejected); }});
  columns.push_back({"starts", [](const VelocityReport& r) { return std::to_string(r.filter_starts); }});
  return columns;
}

std::vector<Column> outcomeColumns() {
  return {
      {"sweeps", [](const VelocityReport& r) { return std::to_string(r.sweeps); }},
      {"sweeps_refused", [](const VelocityReport& r) { return std::to_string(r.sweeps_refused); }},
      {"distance", [](const VelocityReport& r) { return figure(r.gt_heading.distance, 1); }},
      {"gt_heading_ate", [](const VelocityReport& r) { return figure(r.gt_heading.rootMeanSquare(), 2); }},
      {"gt_heading_drift", [](const VelocityReport& r) { return figure(r.gt_heading.driftPercent(), 2); }},
      {"own_heading_ate", [](const VelocityReport& r) { return figure(r.own_heading.rootMeanSquare(), 2); }},
      {"own_heading_drift", [](const VelocityReport& r) { return figure(r.own_heading.driftPercent(), 2); }},
      {"precision", [](const VelocityReport& r) { return figure(r.dynamic.precision()); }},
      {"recall", [](const VelocityReport& r) { return figure(r.dynamic.recall()); }},
      {"f1", [](const VelocityReport& r) { return figure(r.dynamic.f1()); }},
      {"f1_70m", [](const VelocityReport& r) { return figure(r.dynamic_70m.f1()); }}};
}

std::vector<Column> mountColumns(const VelocityReport& overall) {
  std::vector<Column> columns;
  for (const auto& entry : overall.mounts) {
    const std::string& channel = entry.first;
    columns.push_back({channel, [channel](const VelocityReport& r) {
                         const auto found = r.mounts.find(channel);
                         return found == r.mounts.end() ? "-" : figure(1e3 * found->second.yaw(), 1);
                       }});
  }
  return columns;
}

std::string formatRows(const std::string& heading, const std::vector<Column>& columns,
                       const std::vector<VelocityReport>& scenes, const VelocityReport& overall) {
  constexpr std::size_t kSceneWidth = 12;
  std::string text = heading + "\n" + fmt::format("{:<{}}", "scene", kSceneWidth);
  std::size_t width = kSceneWidth;
  for (const Column& column : columns) {
    text += fmt::format("  {:>8}", column.title);
    width += 2 + std::max<std::size_t>(8, column.title.size());
  }
  text += "\n" + std::string(width, '-') + "\n";
  const auto row = [&](const std::string& name, const VelocityReport& report) {
    text += fmt::format("{:<{}}", name, kSceneWidth);
    for (const Column& column : columns) {
      text += fmt::format("  {:>{}}", column.text(report), std::max<std::size_t>(8, column.title.size()));
    }
    text += "\n";
  };
  for (const VelocityReport& scene : scenes) row(scene.scene, scene);
  text += std::string(width, '-') + "\n";
  row("overall", overall);
  return text;
}

}  // namespace

std::string formatTable(const std::vector<VelocityReport>& scenes, const VelocityReport& overall) {
  const std::vector<Column> models = modelColumns();
  const auto split = models.begin() + 5;  // planar and planar_yaw, then the others
  std::string causal;
  if (overall.filtered.vx.count > 0) {
    causal = formatRows(
                 "Latest sweep at or before the middle of each pair, mean absolute error (m/s, rad/s): "
                 "single, and "
                 "filtered over the sweeps up to it; sweeps the filter rejected, and its starts",
                 causalColumns(), scenes, overall) +
             "\n";
  }
  return formatRows(
             "Ego velocity, mean |v - v_gt| (m/s), planar model: B1 least squares on all returns, A1 on the "
             "static ones, B2/A2 with RANSAC, robust with reweighted refinement",
             estimatorColumns(), scenes, overall) +
         "\n" +
         formatRows("Motion models, mean absolute error (m/s, rad/s)", {models.begin(), split}, scenes,
                    overall) +
         "\n" +
         formatRows(
             "Motion models (continued); wheel_vx: planar_yaw against the rear wheels, wheel_vs_truth: the "
             "ground truth itself against them (m/s)",
             {split, models.end()}, scenes, overall) +
         "\n" + causal +
         formatRows("Trajectory (m, drift in % of distance) and dynamic label against annotated boxes",
                    outcomeColumns(), scenes, overall) +
         "\n" +
         formatRows("Yaw error of the calibrated mounts as the true motion shows it (mrad)",
                    mountColumns(overall), scenes, overall);
}

std::string formatJson(const std::vector<VelocityReport>& scenes, const VelocityReport& overall) {
  rapidjson::StringBuffer buffer;
  JsonWriter writer(buffer);
  writer.SetIndent(' ', 2);
  writer.SetMaxDecimalPlaces(6);
  writeScenes(writer, scenes, overall, [&writer](const VelocityReport& report, bool is_overall) {
    writeReport(writer, report, is_overall);
  });
  return std::string(buffer.GetString()) + "\n";
}

std::string formatCsv(const std::vector<VelocityReport>& scenes, const VelocityReport& overall) {
  std::vector<Column> columns = estimatorColumns();
  for (const auto& more : {modelColumns(), causalColumns(), outcomeColumns()})
    columns.insert(columns.end(), more.begin(), more.end());
  std::string text = "scene";
  for (const Column& column : columns) text += "," + column.title;
  text += "\n";
  const auto row = [&](const std::string& name, const VelocityReport& report) {
    text += name;
    for (const Column& column : columns) {
      const std::string value = column.text(report);
      text += "," + (value == "-" ? std::string() : value);
    }
    text += "\n";
  };
  for (const VelocityReport& scene : scenes) row(scene.scene, scene);
  row("overall", overall);
  return text;
}

void writeFile(const std::string& path, const std::string& text) {
  namespace fs = std::filesystem;
  const auto fail = [&](const std::string& cause) {
    throw std::runtime_error(fmt::format("{}: cannot be written: {}", path, cause));
  };
  if (path.empty()) fail("the name is empty");
  // A link is followed to the file it means; a device or pipe is written to, never replaced.
  std::error_code error;
  const fs::path target = fs::is_symlink(path, error) ? fs::weakly_canonical(path, error) : fs::path(path);
  if (fs::is_directory(target, error)) fail("it is a folder");
  const bool in_place = fs::exists(target, error) && !fs::is_regular_file(target, error);

  std::string name = in_place ? target.string() : target.string() + ".XXXXXX";
  const int descriptor = in_place ? ::open(name.c_str(), O_WRONLY | O_CLOEXEC) : ::mkstemp(name.data());
  if (descriptor < 0) fail(std::generic_category().message(errno));
  int cause = 0;
  for (std::size_t written = 0; written < text.size() && cause == 0;) {
    const ssize_t count = ::write(descriptor, text.data() + written, text.size() - written);
    if (count < 0 && errno != EINTR) cause = errno;
    if (count > 0) written += static_cast<std::size_t>(count);
  }
  if (!in_place && cause == 0 && ::fchmod(descriptor, 0644) != 0) cause = errno;
  if (::close(descriptor) != 0 && cause == 0) cause = errno;
  if (!in_place && cause == 0 && std::rename(name.c_str(), target.c_str()) != 0) cause = errno;
  if (cause == 0) return;
  if (!in_place) ::unlink(name.c_str());
  fail(std::generic_category().message(cause));
}

}  // namespace radar_dot::evaluation
