// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>

#include "radar_dot/evaluation/ego_velocity_evaluation.h"
#include "report_format.h"

namespace radar_dot::evaluation {
namespace {

Column column(const std::string& title, const std::string& key, int decimals = 3, double factor = 1.0) {
  return {title, 2 + std::max<std::size_t>(8, title.size()), key, decimals, factor};
}

std::vector<Column> estimatorColumns() {
  std::vector<Column> columns = {column("frames", "frames"), column("refused", "refused")};
  for (const std::string variant : kVariants) columns.push_back(column(variant, "mae/" + variant));
  return columns;
}

/// @param name  before the titles
void addErrors(const std::string& name, const std::string& object, bool with_yaw,
               std::vector<Column>& columns) {
  columns.push_back(column(name + "_vx", object + "/vx_mae"));
  columns.push_back(column(name + "_vy", object + "/vy_mae"));
  if (with_yaw) columns.push_back(column(name + "_yaw_rate", object + "/yaw_rate_mae", 4));
}

std::vector<Column> modelColumns() {
  std::vector<Column> columns;
  for (const std::string model : {"planar", "planar_yaw", "ackermann", "spatial"})
    addErrors(model, "models/" + model, model != "planar", columns);
  columns.push_back(column("wheel_vx", "wheel_speed/vx_mae"));
  columns.push_back(column("wheel_vs_truth", "wheel_speed/ground_truth_vx_mae"));
  return columns;
}

/// The latest estimate before the middle of each pair, single and filtered.
std::vector<Column> causalColumns() {
  std::vector<Column> columns;
  for (const std::string name : {"single", "filter"}) addErrors(name, "causal/" + name, true, columns);
  columns.push_back(column("rejected", "causal/rejected"));
  columns.push_back(column("starts", "causal/starts"));
  return columns;
}

/// How consistent the covariances are.
std::vector<Column> consistencyColumns() {
  std::vector<Column> columns;
  for (const char* name : {"single", "filter"}) {
    for (const char* axis : {"vx", "vy", "yaw_rate"})
      columns.push_back(column(fmt::format("{}_{}_nse", name, axis),
                               fmt::format("causal/{}/{}_normalised_squared", name, axis), 2));
  }
  return columns;
}

std::vector<Column> outcomeColumns() {
  return {column("sweeps", "sweeps"),
          column("sweeps_refused", "sweeps_refused"),
          column("distance", "trajectory/gt_heading/distance", 1),
          column("gt_heading_ate", "trajectory/gt_heading/ate_rmse", 2),
          column("gt_heading_drift", "trajectory/gt_heading/drift_percent", 2),
          column("own_heading_ate", "trajectory/own_heading/ate_rmse", 2),
          column("own_heading_drift", "trajectory/own_heading/drift_percent", 2),
          column("precision", "dynamic/precision"),
          column("recall", "dynamic/recall"),
          column("f1", "dynamic/f1"),
          column("f1_70m", "dynamic/f1_70m")};
}

void describe(const Confusion& labels, const std::string& suffix, Figures& figures) {
  figures.figure("precision" + suffix, labels.precision());
  figures.figure("recall" + suffix, labels.recall());
  figures.figure("f1" + suffix, labels.f1());
}

}  // namespace

void ModelErrors::describe(Figures& figures) {
  figures.mean("vx_mae", vx);
  figures.mean("vy_mae", vy);
  figures.mean("velocity_mae", velocity);
  figures.mean("yaw_rate_mae", yaw_rate);
  figures.mean("vx_normalised_squared", normalised_vx);
  figures.mean("vy_normalised_squared", normalised_vy);
  figures.mean("yaw_rate_normalised_squared", normalised_yaw_rate);
}

void MountError::describe(Figures& figures) {
  figures.part(numerator);
  figures.part(denominator);
}

void VelocityReport::describe(Figures& figures) {
  figures.name(scene);
  figures.sum("frames", frames);
  figures.sum("refused", refused);
  figures.part(refusals);
  figures.object("refusals", [&] {
    for (const auto& [reason, times] : refusals) figures.count(reason, times);
  });
  figures.part(mae);
  figures.object("mae", [&] {
    for (const char* variant : kVariants)
      figures.figure(variant, mae.count(variant) > 0 ? mae.at(variant).value() : Mean().value());
  });
  figures.part(models);
  figures.object("models", [&] {
    for (const auto& each : models) figures.object(each.first, [&] { figures.show(each.second); });
  });
  figures.object("causal", [&] {
    figures.object("single", [&] { figures.group(causal); });
    figures.object("filter", [&] { figures.group(filtered); });
    figures.sum("rejected", filter_rejected);
    figures.sum("starts", filter_starts);
  });
  figures.object("wheel_speed", [&] {
    figures.mean("vx_mae", wheel_estimate);
    figures.mean("ground_truth_vx_mae", wheel_ground_truth);
  });
  figures.part(mounts);
  figures.object("mount_yaw_error", [&] {
    for (const auto& [channel, error] : mounts) figures.figure(channel, error.yaw());
  });
  figures.sum("sweeps", sweeps);
  figures.sum("sweeps_refused", sweeps_refused);
  figures.object("trajectory", [&] {
    figures.object("gt_heading", [&] { figures.group(gt_heading); });
    figures.object("own_heading", [&] { figures.group(own_heading); });
  });
  figures.part(dynamic);
  figures.part(dynamic_70m);
  figures.object("dynamic", [&] {
    evaluation::describe(dynamic, "", figures);
    evaluation::describe(dynamic_70m, "_70m", figures);
  });
}

std::string formatTable(const std::vector<VelocityReport>& scenes, const VelocityReport& overall) {
  const std::vector<Row> rows = rowsOf(scenes, overall, "overall");
  const auto table = [&rows](const std::string& heading, const std::vector<Column>& columns) {
    return heading + "\n" + tableOf("scene", 12, rows, columns, true);
  };
  const std::vector<Column> models = modelColumns();
  const auto split = models.begin() + 5;  // planar and planar_yaw, then the others
  std::vector<Column> mounts;
  for (const auto& [channel, error] : overall.mounts)
    mounts.push_back(column(channel, "mount_yaw_error/" + channel, 1, 1e3));
  std::string causal;
  if (overall.filtered.vx.count > 0) {
    causal = table(
                 "Latest sweep at or before the middle of each pair, mean absolute error (m/s, rad/s): "
                 "single, and filtered over the sweeps up to it; sweeps the filter rejected, and its starts",
                 causalColumns()) +
             "\n";
  }
  causal +=
      table("Latest sweep, squared error over the stated variance (1: consistent)", consistencyColumns()) +
      "\n";
  return causal + table("Motion models, mean absolute error (m/s, rad/s)", {models.begin(), split}) + "\n" +
         table(
             "Motion models (continued); wheel_vx: planar_yaw against the rear wheels, wheel_vs_truth: the "
             "ground truth itself against them (m/s)",
             {split, models.end()}) +
         "\n" +
         table(
             "For comparison the paper's planar model, which knows no yaw rate: mean |v - v_gt| (m/s) of B1 "
             "least squares on all returns, A1 on the static ones, B2/A2 with RANSAC, robust with reweighted "
             "refinement",
             estimatorColumns()) +
         "\n" +
         table("Trajectory (m, drift in % of distance) and dynamic label against annotated boxes",
               outcomeColumns()) +
         "\n" + table("Yaw error of the calibrated mounts as the true motion shows it (mrad)", mounts);
}

std::string formatJson(const std::vector<VelocityReport>& scenes, const VelocityReport& overall) {
  return jsonText([&](JsonWriter& writer) {
    writer.SetIndent(' ', 2);
    writer.SetMaxDecimalPlaces(6);
    writeScenes(writer, figuresOf(scenes), figuresOf(overall));
  });
}

std::string formatCsv(const std::vector<VelocityReport>& scenes, const VelocityReport& overall) {
  std::vector<Column> columns = estimatorColumns();
  for (const auto& more : {modelColumns(), causalColumns(), consistencyColumns(), outcomeColumns()})
    columns.insert(columns.end(), more.begin(), more.end());
  return csvOf(rowsOf(scenes, overall, "overall"), columns);
}

}  // namespace radar_dot::evaluation
