// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <benchmark/benchmark.h>

#include <filesystem>
#include <opencv2/core.hpp>
#include <random>

#include "fixtures/files.h"
#include "fixtures/pcd_writer.h"
#include "radar_dot/dataset/can_bus.h"
#include "radar_dot/dataset/instance_masks.h"
#include "radar_dot/dataset/point_files.h"
#include "radar_dot/dataset/tables.h"

namespace {

namespace fs = std::filesystem;
using namespace radar_dot;
using namespace radar_dot::dataset;

fs::path realData() { return fs::path(RADAR_DOT_SHARED_DATA) / "nuscenes_mini_real"; }

/// One radar file of `range(0)` points.
void readPcdFile(benchmark::State& state) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "radar.pcd";
  test::PcdContent content;
  content.fields = test::nuscenesRadarFields();
  content.records.assign(static_cast<std::size_t>(state.range(0)), std::vector<double>(18, 12.25));
  content.padding = 4096;
  test::writePcd(file, content);
  for (auto _ : state) benchmark::DoNotOptimize(readPcd(file));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(readPcdFile)->ArgName("points")->Arg(0)->Arg(90)->Arg(125);

bool lacksRealData(benchmark::State& state) {
  if (fs::exists(realData())) return false;
  for (auto _ : state) state.SetLabel("skipped: no real data");
  return true;
}

void readRealPcdFiles(benchmark::State& state) {
  if (lacksRealData(state)) return;
  const Tables tables = Tables::load(realData());
  std::vector<fs::path> files;
  for (const SampleData& reading : tables.sample_data)
    if (tables.channelOf(reading).substr(0, 5) == "RADAR") files.push_back(tables.path(reading));
  for (auto _ : state)
    for (const fs::path& file : files) benchmark::DoNotOptimize(readPcd(file));
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(files.size()));
}
BENCHMARK(readRealPcdFiles)->Unit(benchmark::kMillisecond);

/// All scenes, or one of them.
void loadRealTables(benchmark::State& state) {
  if (lacksRealData(state)) return;
  LoadOptions options;
  if (state.range(0) != 0) options.scenes = {"scene-0103"};
  for (auto _ : state) benchmark::DoNotOptimize(Tables::load(realData(), options).sample_data.size());
}
BENCHMARK(loadRealTables)->ArgName("one_scene")->Arg(0)->Arg(1)->Unit(benchmark::kMillisecond);

void readRealCanBus(benchmark::State& state) {
  if (lacksRealData(state)) return;
  for (auto _ : state) benchmark::DoNotOptimize(readCanBus(realData(), "scene-0103").poses.size());
}
BENCHMARK(readRealCanBus)->Unit(benchmark::kMillisecond);

/// A full-size mask with the given number of blobs.
cv::Mat blobs(std::int64_t count) {
  std::mt19937 random(1);
  cv::Mat mask = cv::Mat::zeros(kMaskRows, kMaskColumns, CV_8UC1);
  for (std::int64_t i = 0; i < count; ++i)
    mask(cv::Rect(static_cast<int>(random() % 1500), static_cast<int>(random() % 800), 100, 100)) = 255;
  return mask;
}

void decodeRunLengths(benchmark::State& state) {
  const std::string text = formatRunLengths(encodeMask(blobs(state.range(0))));
  for (auto _ : state)
    benchmark::DoNotOptimize(decodeMask(parseRunLengths(text, kMaskRows, kMaskColumns)).data);
}
BENCHMARK(decodeRunLengths)->ArgName("blobs")->Arg(1)->Arg(30)->Unit(benchmark::kMicrosecond);

void encodeRunLengths(benchmark::State& state) {
  const cv::Mat mask = blobs(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(formatRunLengths(encodeMask(mask)));
}
BENCHMARK(encodeRunLengths)->ArgName("blobs")->Arg(1)->Arg(30)->Unit(benchmark::kMicrosecond);

}  // namespace

BENCHMARK_MAIN();
