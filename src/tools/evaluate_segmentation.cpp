// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <mutex>
#include <utility>

#include "common/replace_file.h"
#include "evaluation/segmentation_results.h"
#include "evaluator.h"
#include "progress_bar.h"
#include "signal_watch.h"

namespace {

namespace dataset = radar_dot::dataset;
namespace evaluation = radar_dot::evaluation;
namespace tools = radar_dot::tools;
using evaluation::SegmentationReport;
using radar_dot::fieldsOf;

struct Options {
  int jobs = 1;
  bool compare_loop = false, ablation = false, best = false;
  evaluation::SegmentationEvaluationOptions evaluation;

  void describe(radar_dot::FieldList& fields) {
    fields.group("Input");
    fields.add("jobs", jobs, "Scenes that are evaluated at a time", "", {1, 1024});
    evaluation.describe(fields);
    fields.group("Comparison");
    fields.add(
        "ablation", ablation,
        "From the paper's masks to the best, step by step: score by uncertainty, refined motion, radar "
        "evidence, image borders, previous pair, memory; one table, and in --json");
    fields.add(
        "best", best,
        "All that --ablation adds, but for what is set otherwise: --score uncertainty --forward-backward "
        "--refine --refine-ground --border 40 --look-back --memory 0.4");
    fields.add(
        "compare_loop", compare_loop,
        "Run with neither of --mask-to-velocity and --radar-gain (its default where it is 0), with each and "
        "with both, and compare them in a table, and in --json");
  }
};
using Evaluator = tools::Evaluator<Options>;

/// The reports by scene, and where it was asked for, the comparison.
struct Results {
  std::vector<SegmentationReport> scenes;
  SegmentationReport overall;
  std::optional<evaluation::Comparison> comparison;
};

/// Of several scenes at a time; ends them between pairs, where no mask is half written.
class Progress {
 public:
  explicit Progress(std::size_t tasks) : tasks_(tasks, {0, 0}) {}

  void show(std::size_t task, std::size_t done, std::size_t all) {
    signals_.check();
    const std::lock_guard<std::mutex> lock(mutex_);
    tasks_[task] = {done, all};
    // Scenes that have not begun are taken to be as long as this one.
    std::size_t sum = 0;
    std::size_t total = 0;
    for (const auto& [so_far, pairs] : tasks_) {
      sum += so_far;
      total += pairs == 0 ? all : pairs;
    }
    bar_.update(sum, total);
  }

 private:
  tools::SignalWatch signals_;
  tools::ProgressBar bar_{"segmenting", "pairs"};
  std::mutex mutex_;
  std::vector<std::pair<std::size_t, std::size_t>> tasks_;  // done, all
};

std::vector<tools::SceneReports<SegmentationReport>> evaluateVariants(
    Evaluator& evaluator, const std::vector<evaluation::SegmentationEvaluationOptions>& variants) {
  const tools::SceneInput& input = evaluator.input;
  dataset::Tables tables = evaluator.load();
  if (!dataset::hasInstanceMasks(tables)) {
    throw std::runtime_error(
        fmt::format("{}/{}/nuinsseg.json: is not there; get nuInsSeg for the masks of nuScenes, or simulate "
                    "(simulate_drive)",
                    input.dataroot, input.version));
  }
  const std::vector<dataset::InstanceMask> masks = dataset::readInstanceMasks(tables);
  const auto by_scene = dataset::byScene(tables, masks);
  Progress progress(tables.scenes.size() * variants.size());
  return tools::evaluateScenes<SegmentationReport>(
      tables, variants.size(), static_cast<std::size_t>(evaluator.options.jobs),
      [&](dataset::Index scene, std::size_t variant) {
        const auto row = static_cast<std::size_t>(scene);
        return evaluateSegmentation(tables, scene, by_scene[row], variants[variant],
                                    [&](std::size_t done, std::size_t all) {
                                      progress.show(row * variants.size() + variant, done, all);
                                    });
      });
}

Results evaluateAll(Evaluator& evaluator) {
  const evaluation::SegmentationEvaluationOptions& options = evaluator.options.evaluation;
  const bool compare_loop = evaluator.options.compare_loop;
  require(!compare_loop || options.velocity != evaluation::VelocitySource::kGroundTruth, fieldsOf(options),
          {&options.velocity}, "--compare-loop needs a velocity by radar");
  Results results;
  std::vector<evaluation::SegmentationEvaluationOptions> variants = {options};
  std::size_t own = 0;
  if (compare_loop || evaluator.options.ablation) {
    results.comparison =
        comparisonOf(compare_loop ? evaluation::Variants::kLoop : evaluation::Variants::kAblation, options);
    own = ownVariant(*results.comparison, options);
    variants.clear();
    for (const evaluation::VariantResult& variant : results.comparison->results)
      variants.push_back(variant.options);
  }
  for (const evaluation::SegmentationEvaluationOptions& variant : variants) validate(variant);
  evaluation::checkBackend(options.depth.depth);
  evaluation::checkBackend(options.optical_flow.flow);
  for (const evaluation::SegmentationEvaluationOptions& variant : variants)
    if (!variant.mask_directory.empty()) {
      std::filesystem::create_directories(variant.mask_directory);
      radar_dot::requireReplaceable(variant.mask_directory + "/mask.png");
    }
  const std::vector<tools::SceneReports<SegmentationReport>> reports = evaluateVariants(evaluator, variants);
  results.scenes = reports[own].scenes;
  results.overall = reports[own].overall;
  for (std::size_t i = 0; results.comparison && i < reports.size(); ++i) {
    results.comparison->results[i].scenes = reports[i].scenes;
    results.comparison->results[i].overall = reports[i].overall;
  }
  return results;
}

Results merge(Evaluator& evaluator) {
  const auto [scenes, overall] = evaluator.merged<SegmentationReport>();
  return {scenes, overall, evaluation::mergeComparison(evaluator.input.merge)};
}

void write(const Evaluator& evaluator, const Results& results) {
  const auto& [scenes, overall, comparison] = results;
  if (!comparison) return evaluator.write(scenes, overall);
  const bool is_loop = comparison->variants == evaluation::Variants::kLoop;
  evaluator.write(formatJson(scenes, overall, *comparison), formatCsv(scenes, overall),
                  (is_loop ? formatTable(scenes, overall) + "\n" : "") + formatTable(*comparison));
}

/// @return the name of one of the options
void addRules(Evaluator& evaluator) {
  const Options& options = evaluator.options;
  const auto name_of = [&options](const void* member) { return tools::nameOf(options, member); };
  const std::string ablation = name_of(&options.ablation);
  evaluator.requireScenes();
  evaluator.command_line.exclude(ablation, name_of(&options.compare_loop));
  evaluator.command_line.exclude(ablation, name_of(&options.best));
}

/// Sets the fields that neither an option nor a file has set.
void takeNotGiven(const tools::CommandLine& command_line, const radar_dot::FieldList& values,
                  const radar_dot::FieldList& fields) {
  auto value = values.begin();
  for (const radar_dot::Field& field : fields) {
    if (!command_line.givenMember(field.address)) field.put(value->get());
    ++value;
  }
}

}  // namespace

int main(int argc, char** argv) {
  Evaluator evaluator(
      "evaluate_segmentation",
      "Scores dynamic masks against nuInsSeg on a nuScenes dataroot, as the paper's Table I.",
      {"evaluate_segmentation --dataroot /data/nuscenes --config config/nuscenes.yaml --scenes scene-0103 "
       "--best",
       "evaluate_segmentation --dataroot sim --version v1.0-sim --config config/simulation.yaml --config "
       "config/masks.yaml --pairs next"});
  radar_dot::Configuration& configuration = evaluator.configuration;
  // Half a second between keyframes is more than dis finds from zero; networks do, and start from it below.
  radar_dot::OpticalFlowParams& flow = configuration.optical_flow.flow;
  flow.initialisation = radar_dot::FlowStart::kExpected;
  tools::CommandLine& command_line = evaluator.command_line;
  command_line.add("", fieldsOf(configuration.dynamic_segmentation));
  command_line.add("", fieldsOf(configuration.optical_flow));
  command_line.add("", fieldsOf(configuration.depth));
  command_line.add("", fieldsOf(configuration.ego_velocity));
  addRules(evaluator);
  return evaluator.run(argc, argv, [&] {
    evaluation::SegmentationEvaluationOptions& options = evaluator.options.evaluation;
    if (!command_line.givenMember(&flow.initialisation) &&
        flow.backend != radar_dot::OpticalFlowParams{}.backend)
      flow.initialisation = radar_dot::FlowStart::kNone;
    options.ego_velocity = configuration.ego_velocity;
    options.optical_flow = configuration.optical_flow;
    options.depth = configuration.depth;
    options.segmentation = configuration.dynamic_segmentation;
    if (evaluator.options.best) {
      options = evaluation::bestOptions(options);
      takeNotGiven(command_line, fieldsOf(options.optical_flow), fieldsOf(configuration.optical_flow));
      takeNotGiven(command_line, fieldsOf(options.segmentation),
                   fieldsOf(configuration.dynamic_segmentation));
      options.optical_flow = configuration.optical_flow;
      options.segmentation = configuration.dynamic_segmentation;
    }
    write(evaluator, evaluator.input.merge.empty() ? evaluateAll(evaluator) : merge(evaluator));
  });
}
