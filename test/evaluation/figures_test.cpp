// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/evaluation/figures.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include "evaluation/report_format.h"
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

bool isWritten(const Figures::Item& item) { return item.kind < Kind::kColumn; }

void expectSame(const Figures::Item& item, const rapidjson::Value& value) {
  if (item.kind == Kind::kCount) {
    EXPECT_TRUE(value.IsUint64() && value.GetUint64() == item.count) << item.key;
  } else if (std::isfinite(item.number)) {
    ASSERT_TRUE(value.IsNumber()) << item.key;
    EXPECT_NEAR(value.GetDouble(), item.number, 1e-6) << item.key;  // some files have six decimals
  } else {
    EXPECT_TRUE(value.IsNull()) << item.key;
  }
}

/// Expects the figures and nothing else in an object and those in it.
void expectFigures(const Figures& figures, const rapidjson::Value& object, std::size_t others) {
  std::vector<std::pair<const rapidjson::Value*, std::size_t>> open = {{&object, others}};
  for (const Figures::Item& item : figures.items()) {
    const std::string key = item.key.substr(item.key.rfind('/') + 1);
    if (item.kind == Kind::kEnd) {
      EXPECT_EQ(open.back().first->MemberCount(), open.back().second) << item.key;
      open.pop_back();
    } else if (isWritten(item) || item.kind == Kind::kBegin) {
      ASSERT_TRUE(open.back().first->HasMember(key.c_str())) << item.key;
      const rapidjson::Value& value = (*open.back().first)[key.c_str()];
      ++open.back().second;
      if (item.kind == Kind::kBegin)
        open.emplace_back(&value, 0);
      else
        expectSame(item, value);
    }
  }
  EXPECT_EQ(open.back().first->MemberCount(), open.back().second);
}

template <typename Report>
class Reports : public ::testing::Test {};
using Types = ::testing::Types<SegmentationReport, DepthReport, FlowReport, ObjectReport, VelocityReport>;
TYPED_TEST_SUITE(Reports, Types);

TYPED_TEST(Reports, EverySumAddsUp) {
  const TypeParam one = filled<TypeParam>(7), other = filled<TypeParam>(std::uint64_t{1} << 53U);
  TypeParam sum = one;
  sum += other;
  const Figures of_sum = figuresOf(sum), of_one = figuresOf(one), of_other = figuresOf(other);
  ASSERT_EQ(of_sum.items().size(), of_one.items().size());
  std::size_t sums = 0;
  for (std::size_t i = 0; i < of_sum.items().size(); ++i) {
    const Figures::Item &item = of_sum.items()[i], &a = of_one.items()[i], &b = of_other.items()[i];
    if (item.member == nullptr) continue;
    ++sums;
    EXPECT_EQ(item.count, a.count + b.count) << item.key;
    EXPECT_DOUBLE_EQ(item.number, a.number + b.number) << item.key;
  }
  EXPECT_GE(sums, 6U);
}

TYPED_TEST(Reports, EveryFigureIsInJson) {
  const TypeParam one = filled<TypeParam>(7);
  TypeParam sum = one;
  sum += one;
  rapidjson::Document json;
  json.Parse(formatJson(std::vector{one}, sum).c_str());
  ASSERT_FALSE(json.HasParseError());
  EXPECT_STREQ(json["scenes"][0]["scene"].GetString(), "scene-0001");
  expectFigures(figuresOf(one), json["scenes"][0], 1);
  expectFigures(figuresOf(sum), json["overall"], 0);
}

// The velocities' files have nested objects and columns of their own.
TYPED_TEST(Reports, EveryFigureIsInCsvAndReadsBack) {
  if constexpr (!std::is_same_v<TypeParam, VelocityReport>) {
    const TypeParam report = filled<TypeParam>(std::uint64_t{1} << 53U);
    const Figures figures = figuresOf(report);
    std::string titles = "scene", values = "scene-0001";
    for (const Figures::Item& item : figures.items()) {
      if (!isWritten(item)) continue;
      titles += "," + item.key;
      values += "," + (item.kind == Kind::kCount    ? std::to_string(item.count)
                       : std::isfinite(item.number) ? std::to_string(item.number)
                                                    : "");
    }
    const std::string csv = formatCsv(std::vector{report}, report);
    EXPECT_EQ(csv.substr(0, csv.find("\noverall,")), titles + "\n" + values);

    rapidjson::Document json;
    json.Parse(formatJson(std::vector{report}, report).c_str());
    TypeParam read;
    readSums(figuresOf(read), json["overall"], "test");
    const Figures again = figuresOf(read);
    for (std::size_t i = 0; i < figures.items().size(); ++i) {
      if (figures.items()[i].member == nullptr) continue;
      EXPECT_EQ(again.items()[i].count, figures.items()[i].count) << figures.items()[i].key;
      EXPECT_EQ(again.items()[i].number, figures.items()[i].number) << figures.items()[i].key;
    }
  }
}

TEST(Figures, MapsListsAndMeansAddUpEntryByEntry) {
  VelocityReport one, other;
  one.mae["A1"] = {1.0, 4};
  one.refusals["too_few"] = 1;
  one.models["planar"].vx = {0.5, 1};
  one.missing_files["RADAR_FRONT"] = {1, 10};
  other.mae["A1"] = {2.0, 2};
  other.refusals["too_few"] = 2;
  other.refusals["degenerate"] = 5;
  other.models["planar"].vx = {1.5, 3};
  other.mounts["RADAR_FRONT"] = {0.1, 10.0};
  other.missing_files["RADAR_FRONT"] = {2, 20};
  one += other;
  one += other;
  EXPECT_DOUBLE_EQ(one.mae.at("A1").value(), 5.0 / 8.0);
  EXPECT_EQ(one.refusals, (std::map<std::string, std::size_t>{{"degenerate", 10}, {"too_few", 5}}));
  EXPECT_DOUBLE_EQ(one.models.at("planar").vx.value(), 3.5 / 7.0);
  EXPECT_DOUBLE_EQ(one.mounts.at("RADAR_FRONT").yaw(), 0.01);
  EXPECT_EQ(one.missing_files.at("RADAR_FRONT"), (std::pair<std::size_t, std::size_t>{5, 50}));
  FlowReport flow, slower;
  flow.seconds = {0.01};
  slower.seconds = {0.03, 0.05};
  flow += slower;
  EXPECT_EQ(flow.seconds, (std::vector<double>{0.01, 0.03, 0.05}));
}

}  // namespace
}  // namespace radar_dot::evaluation
