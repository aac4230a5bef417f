// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include "radar_dot/evaluation/motion_comparison.h"
#include "report_format.h"

namespace radar_dot::evaluation {
namespace {

std::string offsetText(const MotionReport& report) {
  const TimeOffset& found = report.time_offset;
  std::string text = found.why_not.empty()
                         ? fmt::format("{:+.4f} s, 1 sigma {:.4f} s, to add to the stamps of the estimate",
                                       found.offset, found.sigma)
                         : "not seen: " + found.why_not;
  return fmt::format("Time offset: {}; added: {:+.4f} s\n", text, report.applied_offset);
}

std::string covarianceText(const JointErrors& joint) {
  if (joint.nees.empty()) return "Covariance: the estimate has none\n";
  const double mean = joint.mean();
  const char* verdict = mean > joint.upper() ? "too small" : mean < joint.lower() ? "too large" : "right";
  return fmt::format(
      "Covariance: {}; NEES of vx, vy and yaw rate together {:.2f}, 95 % limits {:.2f} to {:.2f}; {:.1f} % "
      "of "
      "the errors within their 95 % limit\n",
      verdict, mean, joint.lower(), joint.upper(), 100.0 * ratio(joint.within_95, joint.nees.size()));
}

}  // namespace

void MotionReport::describe(Figures& figures) {
  figures.count("compared", compared);
  figures.count("outside", outside);
  figures.object("estimate", [&] { figures.show(estimate); });
  figures.object("reference", [&] { figures.show(reference); });
  figures.object("time_offset", [&] {
    figures.figure("found", time_offset.offset);
    figures.figure("sigma", time_offset.sigma);
    figures.figure("added", applied_offset);
  });
  figures.object("vx", [&] { figures.show(vx); });
  figures.object("vy", [&] { figures.show(vy); });
  figures.object("yaw_rate", [&] { figures.show(yaw_rate); });
  figures.object("joint", [&] { figures.show(joint); });
  figures.object("trajectory", [&] {
    const auto add = [&](const char* key, const std::optional<PathErrors>& path) {
      figures.object(key, [&] { figures.show(path.value_or(PathErrors())); });
    };
    add("reference_heading", reference_heading);
    add("own_heading", own_heading);
    add("odometry", odometry);
  });
  if (masks) {
    figures.object("masks", [&] {
      figures.figure("iou", masks->iou());
      figures.figure("false_positive_share", masks->falsePositiveShare());
      figures.show(masks->pixels);
      figures.count("frames", masks->frames);
      figures.count("without_truth", masks_without_truth);
    });
  }
  if (objects) {
    figures.object("objects", [&] {
      figures.show(*objects);
      figures.count("without_objects", keyframes_without_objects);
    });
  }
  figures.name(scene);
}

std::string formatTable(const MotionReport& report) {
  const auto rowOf = [](const char* name, const auto& part) { return Row(name, figuresOf(part)); };
  std::string text =
      tableOf("Messages", 18, {rowOf("estimate", report.estimate), rowOf("reference", report.reference)},
              {{"Number", 8, "messages"},
               {"Hz", 9, "rate", 2},
               {"longest gap s", 15, "longest_gap"},
               {"not finite", 12, "not_finite"},
               {"no fix", 8, "no_fix"},
               {"zero stamps", 13, "zero_stamps"},
               {"unordered", 11, "unordered"},
               {"repeated", 10, "repeated"}});
  text += fmt::format("{} estimates compared, {} without a reference at their time\n", report.compared,
                      report.outside);
  text += offsetText(report) + "\n";
  text += tableOf(
      "Error", 18,
      {rowOf("vx m/s", report.vx), rowOf("vy m/s", report.vy), rowOf("yaw rate rad/s", report.yaw_rate)},
      {{"MAE", 9, "mae", 4},
       {"RMSE", 9, "rmse", 4},
       {"bias", 9, "bias", 4},
       {"95 %", 9, "p95", 4},
       {"NEES", 9, "nees", 2},
       {"number", 9, "count"}});
  text += covarianceText(report.joint) + "\n";
  std::vector<Row> paths;
  if (report.reference_heading) paths.push_back(rowOf("reference heading", *report.reference_heading));
  if (report.own_heading) paths.push_back(rowOf("own heading", *report.own_heading));
  if (report.odometry) paths.push_back(rowOf("odometry", *report.odometry));
  if (!paths.empty()) {
    text += tableOf("Path", 18, paths,
                    {{"distance m", 12, "distance", 1},
                     {"drift %", 9, "drift_percent", 2},
                     {"ATE m", 9, "ate_rmse", 3},
                     {"aligned ATE m", 15, "ate_rmse_aligned", 3}});
    text += "ATE: from the same first pose; aligned: after the best rigid motion.\n";
  }
  if (report.masks) {
    text += fmt::format("\n{} masks compared, {} without a truth of their stamp\n", report.masks->frames,
                        report.masks_without_truth);
    text += tableOf("Masks", 18, {rowOf("pixels", *report.masks)},
                    {{"IoU", 9, "iou", 4},
                     {"Precision", 11, "precision", 4},
                     {"Recall", 9, "recall", 4},
                     {"F1", 9, "f1", 4},
                     {"FP share", 10, "false_positive_share", 4}});
  }
  if (report.objects) {
    text += fmt::format("\n{} keyframes compared, {} without objects at their time\n",
                        report.objects->keyframes, report.keyframes_without_objects);
    text += formatTable(std::vector<ObjectReport>(), *report.objects);
  } else if (!report.objects_missing.empty()) {
    text += "\nObjects: not compared: " + report.objects_missing + "\n";
  }
  return text;
}

}  // namespace radar_dot::evaluation
