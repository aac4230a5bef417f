// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "creeping_actors.h"

#include <fmt/format.h>
#include <rapidjson/document.h>
#include <rapidjson/istreamwrapper.h>

#include <Eigen/Core>
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <set>

#include "radar_dot/dataset/instance_masks.h"
#include "radar_scene.h"
#include "scene_depths.h"

namespace radar_dot::evaluation {
namespace {

namespace fs = std::filesystem;
using dataset::DatasetError;
using dataset::Index;
using dataset::kNone;
using dataset::SampleAnnotation;

// m between two keyframes; boxes are rounded to millimetres.
constexpr double kLeastWay = 0.01;

bool moves(const dataset::Tables& tables, const SampleAnnotation& box) {
  const Index other = box.next != kNone ? box.next : box.previous;
  if (other == kNone) return false;
  const Eigen::Isometry3d there = tables.annotations[at(other)].T_map_from_box();
  return (there.translation() - box.T_map_from_box().translation()).norm() > kLeastWay;
}

}  // namespace

CreepingActors::CreepingActors(const dataset::Tables& tables, Index scene) : tables_(tables) {
  const fs::path file =
      tables.dataroot() / "ground_truth" / (tables.scenes[at(scene)].name + "_instances.json");
  std::ifstream stream(file);
  if (!stream) throw DatasetError(file.string() + ": cannot be opened");
  rapidjson::IStreamWrapper wrapper(stream);
  rapidjson::Document document;
  document.ParseStream<rapidjson::kParseIterativeFlag>(wrapper);
  if (document.HasParseError() || !document.IsObject()) {
    throw DatasetError(fmt::format("{}: is not an object of numbers and instance tokens", file.string()));
  }
  for (const auto& [key, value] : document.GetObject()) {
    if (!value.IsString()) throw DatasetError(fmt::format("{}: a value is not a token", file.string()));
    const dataset::Token token = tables.tokens.find(value.GetString());
    const int number = std::atoi(key.GetString());
    if (number > 0 && number <= 0xFFFF) numbers_[token] = static_cast<std::uint16_t>(number);
  }
}

cv::Mat CreepingActors::shownBy(Index reading) const {
  std::set<std::uint16_t> creeping;
  for (const Index row : tables_.annotationsOf(tables_.sample_data[at(reading)].sample)) {
    const SampleAnnotation& box = tables_.annotations[at(row)];
    if (isMoving(tables_, box) || !moves(tables_, box)) continue;
    const auto number = numbers_.find(tables_.instances[at(box.instance)].token);
    if (number != numbers_.end()) creeping.insert(number->second);
  }
  const fs::path file = tables_.dataroot() / "ground_truth" / "instance" / pngNameOf(tables_, reading);
  const cv::Mat actors = cv::imread(file.string(), cv::IMREAD_UNCHANGED);
  if (actors.empty() || actors.type() != CV_16UC1)
    throw DatasetError(file.string() + ": cannot be read as a 16-bit image");
  cv::Mat shown = cv::Mat::zeros(actors.size(), CV_8UC1);
  if (creeping.empty()) return shown;
  for (int row = 0; row < actors.rows; ++row)
    for (int column = 0; column < actors.cols; ++column)
      if (creeping.count(actors.at<std::uint16_t>(row, column)) > 0)
        shown.at<std::uint8_t>(row, column) = 255;
  return shown;
}

}  // namespace radar_dot::evaluation
