// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/figures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include "evaluation/report_format.h"
#include "fixtures/refusal.h"
#include "radar_dot/evaluation/depth_evaluation.h"
#include "radar_dot/evaluation/flow_evaluation.h"
#include "radar_dot/evaluation/object_evaluation.h"
#include "radar_dot/evaluation/segmentation_evaluation.h"

namespace radar_dot::evaluation {
namespace {

using Kind = Figures::Kind;

/// A report whose sums all differ: counts up from `first`, and tenths, which are no finite binary fractions.
template <typename Report>
Report filled(std::uint64_t first) {
  Report report;
  report.scene = "scene-0001";
  const Figures figures = figuresOf(report);
  for (const Figures::Item& item : figures.items()) {
    if (item.member == nullptr) continue;
    if (item.kind == Kind::kCount)
      *static_cast<std::uint64_t*>(item.member) = first++;
    else
      *static_cast<double*>(item.member) = 0.1 * static_cast<double>(first++);
  }
  return report;
}

/// The figures that files hold.
std::vector<Figures::Item> writtenOf(const Figures& figures) {
  std::vector<Figures::Item> items;
  for (const Figures::Item& item : figures.items())
    if (item.kind < Kind::kColumn) items.push_back(item);
  return items;
}

/// The members of an object and those in it, by key as Figures has it.
void flatten(const rapidjson::Value& object, const std::string& path,
             std::vector<std::pair<std::string, const rapidjson::Value*>>& members) {
  for (const auto& member : object.GetObject()) {
    const std::string key = path + member.name.GetString();
    if (member.value.IsObject())
      flatten(member.value, key + "/", members);
    else if (key != "scene" && key != "sums")
      members.emplace_back(key, &member.value);
  }
}

void expectFigures(const Figures& figures, const rapidjson::Value& object) {
  std::vector<std::pair<std::string, const rapidjson::Value*>> members;
  flatten(object, "", members);
  const std::vector<Figures::Item> items = writtenOf(figures);
  ASSERT_EQ(members.size(), items.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    const auto& [key, value] = members[i];
    EXPECT_EQ(key, items[i].key);
    if (items[i].kind == Kind::kCount) {
      EXPECT_TRUE(value->IsUint64() && value->GetUint64() == items[i].count) << key;
    } else if (std::isfinite(items[i].number)) {
      EXPECT_TRUE(value->IsNumber() && std::abs(value->GetDouble() - items[i].number) <= 1e-6) << key;
    } else {
      EXPECT_TRUE(value->IsNull()) << key;
    }
  }
}

template <typename Report>
class Reports : public ::testing::Test {};
using Types = ::testing::Types<SegmentationReport, DepthReport, FlowReport, ObjectReport, VelocityReport>;
TYPED_TEST_SUITE(Reports, Types);

TYPED_TEST(Reports, EverySumAddsUp) {
  const TypeParam one = filled<TypeParam>(7), other = filled<TypeParam>(std::uint64_t{1} << 53U);
  TypeParam sum = one;
  sum += other;
  const auto items = writtenOf(figuresOf(sum)), a = writtenOf(figuresOf(one)),
             b = writtenOf(figuresOf(other));
  ASSERT_EQ(items.size(), a.size());
  for (std::size_t i = 0; i < items.size(); ++i) {
    if (items[i].member == nullptr) continue;
    EXPECT_EQ(items[i].count, a[i].count + b[i].count) << items[i].key;
    EXPECT_DOUBLE_EQ(items[i].number, a[i].number + b[i].number) << items[i].key;
  }
}

TYPED_TEST(Reports, EveryFigureIsInJson) {
  const TypeParam one = filled<TypeParam>(7);
  TypeParam sum = one;
  sum += one;
  rapidjson::Document json;
  json.Parse(formatJson(std::vector{one}, sum).c_str());
  ASSERT_FALSE(json.HasParseError());
  EXPECT_STREQ(json["scenes"][0]["scene"].GetString(), "scene-0001");
  expectFigures(figuresOf(one), json["scenes"][0]);
  expectFigures(figuresOf(sum), json["overall"]);
}

// The velocities' files have nested objects and columns of their own.
TYPED_TEST(Reports, EveryFigureIsInCsv) {
  if constexpr (!std::is_same_v<TypeParam, VelocityReport>) {
    const TypeParam report = filled<TypeParam>(std::uint64_t{1} << 53U);
    const std::vector<Figures::Item> items = writtenOf(figuresOf(report));
    std::string titles = "scene", values = "scene-0001";
    for (const Figures::Item& item : items) {
      const std::string number = std::isfinite(item.number) ? std::to_string(item.number) : "";
      titles += "," + item.key;
      values += "," + (item.kind == Kind::kCount ? std::to_string(item.count) : number);
    }
    const std::string csv = formatCsv(std::vector{report}, report);
    EXPECT_EQ(csv.substr(0, csv.find("\noverall,")), titles + "\n" + values);
  }
}

TYPED_TEST(Reports, SumsReadBackWithoutRounding) {
  const TypeParam report = filled<TypeParam>(std::uint64_t{1} << 53U);
  const std::string sums = figuresOf(report).sums();
  TypeParam read = filled<TypeParam>(7);
  figuresOf(read).readSums(sums, "test");
  EXPECT_EQ(figuresOf(read).sums(), sums);
  read.scene = report.scene;
  EXPECT_EQ(formatJson(std::vector{read}, read), formatJson(std::vector{report}, report));
  for (const std::string& other : {sums + "1", sums.substr(0, sums.size() - 3), "x" + sums, std::string()})
    test::expectRefusal<std::runtime_error>([&] { figuresOf(read).readSums(other, "here"); },
                                            {"here", "'sums'"});
}

TEST(Figures, MapsListsAndMeansAddUpEntryByEntry) {
  VelocityReport one, other;
  one.mae["A1"] = {1.0, 4};
  one.refusals["too_few"] = 1;
  one.models["planar"].vx = {0.5, 1};
  other.mae["A1"] = {2.0, 2};
  other.refusals["too_few"] = 2;
  other.refusals["degenerate"] = 5;
  other.models["planar"].vx = {1.5, 3};
  other.mounts["RADAR_FRONT"] = {0.1, 10.0};
  one += other;
  one += other;
  EXPECT_DOUBLE_EQ(one.mae.at("A1").value(), 5.0 / 8.0);
  EXPECT_EQ(one.refusals, (std::map<std::string, std::size_t>{{"degenerate", 10}, {"too_few", 5}}));
  EXPECT_DOUBLE_EQ(one.models.at("planar").vx.value(), 3.5 / 7.0);
  EXPECT_DOUBLE_EQ(one.mounts.at("RADAR_FRONT").yaw(), 0.01);
  FlowReport flow, slower;
  flow.seconds = {0.01};
  slower.seconds = {0.03, 0.05};
  flow += slower;
  EXPECT_EQ(flow.seconds, (std::vector<double>{0.01, 0.03, 0.05}));

  VelocityReport read;
  figuresOf(read).readSums(figuresOf(one).sums(), "test");
  EXPECT_EQ(formatJson({read}, read), formatJson({one}, one));
  EXPECT_EQ(read.models.at("planar").vx.sum, 3.5);
  EXPECT_EQ(read.refusals, one.refusals);
  EXPECT_EQ(read.mounts.at("RADAR_FRONT").denominator, one.mounts.at("RADAR_FRONT").denominator);
  flow.errors.all.add(0.25, 3.0);
  flow.errors.all.add(40.0, 3.0);
  FlowReport flow_read;
  figuresOf(flow_read).readSums(figuresOf(flow).sums(), "test");
  EXPECT_EQ(flow_read.seconds, flow.seconds);
  EXPECT_EQ(flow_read.errors.all.median(), flow.errors.all.median());
}

}  // namespace
}  // namespace radar_dot::evaluation
