// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/doppler_returns.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <stdexcept>

#include "fixtures/refusal.h"

namespace radar_dot {
namespace {

/// A cloud of float32 and uint8 columns, one map per point.
PointCloud makeCloud(const std::vector<std::string>& floats, const std::vector<std::string>& bytes,
                     const std::vector<std::map<std::string, double>>& points) {
  PointCloud cloud;
  std::uint32_t offset = 0;
  for (const auto& name : floats) {
    cloud.fields.push_back({name, offset, ScalarType::kFloat32, 1});
    offset += 4;
  }
  for (const auto& name : bytes) {
    cloud.fields.push_back({name, offset, ScalarType::kInt8, 1});
    offset += 1;
  }
  cloud.point_step = offset;
  cloud.size = points.size();
  cloud.data.resize(cloud.point_step * cloud.size);
  for (std::size_t i = 0; i < points.size(); ++i) {
    for (const PointField& field : cloud.fields) {
      std::uint8_t* target = cloud.data.data() + i * cloud.point_step + field.offset;
      const double value = points[i].at(field.name);
      if (field.type == ScalarType::kFloat32) {
        const auto narrow = static_cast<float>(value);
        std::memcpy(target, &narrow, sizeof narrow);
      } else {
        const auto narrow = static_cast<std::int8_t>(value);
        std::memcpy(target, &narrow, sizeof narrow);
      }
    }
  }
  return cloud;
}

// (vx, vy) = (-3, 7) at bearing (0.6, 0.8): the range rate is the projection, not the norm.
TEST(DopplerExtractor, ProjectsVelocityOntoTheBearing) {
  const PointCloud cloud = makeCloud({"x", "y", "z", "vx", "vy"}, {},
                                     {{{"x", 6.0}, {"y", 8.0}, {"z", 0.0}, {"vx", -3.0}, {"vy", 7.0}}});
  DopplerExtractor extractor;
  std::vector<DopplerReturn> returns;
  const ExtractionCounts counts = extractor.extract(cloud.view(), returns);
  ASSERT_EQ(counts.accepted, 1U);
  EXPECT_NEAR(returns[0].doppler, 0.6 * -3.0 + 0.8 * 7.0, 1e-6);
  EXPECT_NEAR(returns[0].range, 10.0, 1e-6);
  EXPECT_NEAR(returns[0].bearing.x(), 0.6, 1e-6);
  EXPECT_NEAR(returns[0].bearing.y(), 0.8, 1e-6);
}

TEST(DopplerExtractor, PrefersADopplerFieldAndScalesIt) {
  const PointCloud cloud = makeCloud(
      {"x", "y", "z", "vx", "vy", "doppler", "speed"}, {},
      {{{"x", 3.0}, {"y", 0.0}, {"z", 4.0}, {"vx", 9.0}, {"vy", 9.0}, {"doppler", 2.0}, {"speed", 5.0}}});
  std::vector<DopplerReturn> returns;
  DopplerExtractor automatic;
  automatic.extract(cloud.view(), returns);
  EXPECT_FLOAT_EQ(returns.at(0).doppler, 2.F);
  EXPECT_FLOAT_EQ(returns.at(0).bearing.z(), 0.8F);
  ExtractionParams params;
  params.doppler_field = "speed";
  params.doppler_scale = -1.0;
  DopplerExtractor named(params);
  named.extract(cloud.view(), returns);
  EXPECT_FLOAT_EQ(returns.at(0).doppler, -5.F);
}

TEST(DopplerExtractor, EachFilterCountsWhatItRefuses) {
  const std::map<std::string, double> good = {{"x", 10.0},
                                              {"y", 0.0},
                                              {"vx", 1.0},
                                              {"vy", 0.0},
                                              {"rcs", 5.0},
                                              {"pdh0", 1.0},
                                              {"invalid_state", 0.0},
                                              {"ambig_state", 3.0}};
  const auto with = [&](const std::string& field, double value) {
    auto point = good;
    point[field] = value;
    return point;
  };
  const PointCloud cloud =
      makeCloud({"x", "y", "vx", "vy", "rcs"}, {"pdh0", "invalid_state", "ambig_state"},
                {good, with("x", 0.1), with("x", 300.0), with("y", 20.0), with("rcs", -20.0),
                 with("pdh0", 3.0), with("invalid_state", 4.0), with("ambig_state", 1.0),
                 with("vx", std::nan("")), with("x", std::numeric_limits<double>::infinity())});
  ExtractionParams params;
  params.filter.min_azimuth = -1.0;
  params.filter.max_azimuth = 1.0;
  params.filter.min_rcs = -10.0;
  DopplerExtractor extractor(params);
  std::vector<DopplerReturn> returns;
  const ExtractionCounts counts = extractor.extract(cloud.view(), returns);
  EXPECT_EQ(counts.total, 10U);
  EXPECT_EQ(counts.accepted, 1U);
  EXPECT_EQ(counts.out_of_range, 2U);
  EXPECT_EQ(counts.out_of_azimuth, 1U);
  EXPECT_EQ(counts.rcs, 1U);
  EXPECT_EQ(counts.pdh0, 1U);
  EXPECT_EQ(counts.invalid_state, 1U);
  EXPECT_EQ(counts.ambig_state, 1U);
  EXPECT_EQ(counts.not_finite, 2U);

  params.filter.pdh0_states.clear();  // an empty list accepts every state
  params.filter.invalid_states = {0, 4};
  DopplerExtractor wider(params);
  EXPECT_EQ(wider.extract(cloud.view(), returns).accepted, 3U);
  EXPECT_EQ(returns.back().index, 6U) << "the index points back into the cloud";
}

TEST(DopplerExtractor, EmptyAndNanCloudsGiveNoReturns) {
  DopplerExtractor extractor;
  std::vector<DopplerReturn> returns(3);
  EXPECT_EQ(extractor.extract(makeCloud({"x", "y", "vx", "vy"}, {}, {}).view(), returns).total, 0U);
  EXPECT_TRUE(returns.empty());
  const double nan = std::nan("");
  const PointCloud cloud =
      makeCloud({"x", "y", "vx", "vy"}, {}, {{{"x", nan}, {"y", nan}, {"vx", nan}, {"vy", nan}}});
  EXPECT_EQ(extractor.extract(cloud.view(), returns).not_finite, 1U);
  const PointCloud origin =
      makeCloud({"x", "y", "vx", "vy"}, {}, {{{"x", 0.0}, {"y", 0.0}, {"vx", 0.0}, {"vy", 0.0}}});
  EXPECT_EQ(extractor.extract(origin.view(), returns).accepted, 0U);
}

TEST(DopplerExtractor, MissingFieldsAreNamedWithThoseAtHand) {
  const PointCloud cloud = makeCloud({"x", "y", "power"}, {}, {});
  DopplerExtractor extractor;
  std::vector<DopplerReturn> returns;
  test::expectRefusal([&] { extractor.extract(cloud.view(), returns); }, {"'vx'", "x, y, power"});
}

TEST(DopplerExtractor, AFieldBeyondThePointIsRefused) {
  PointCloud cloud = makeCloud({"x", "y", "vx", "vy"}, {}, {});
  cloud.fields[3].offset = 40;
  DopplerExtractor extractor;
  std::vector<DopplerReturn> returns;
  EXPECT_THROW(extractor.extract(cloud.view(), returns), std::invalid_argument);
}

TEST(DopplerExtractor, AShorterPointWithTheSameFieldsIsRefused) {
  PointCloud cloud =
      makeCloud({"x", "y", "vx", "vy"}, {}, {{{"x", 5.0}, {"y", 0.0}, {"vx", -1.0}, {"vy", 0.0}}});
  DopplerExtractor extractor;
  std::vector<DopplerReturn> returns;
  extractor.extract(cloud.view(), returns);
  cloud.point_step = 4;
  EXPECT_THROW(extractor.extract(cloud.view(), returns), std::invalid_argument);
}

TEST(DopplerExtractor, FollowsALayoutThatChanges) {
  DopplerExtractor extractor;
  std::vector<DopplerReturn> returns;
  extractor.extract(
      makeCloud({"x", "y", "vx", "vy"}, {}, {{{"x", 5.0}, {"y", 0.0}, {"vx", -1.0}, {"vy", 0.0}}}).view(),
      returns);
  EXPECT_FLOAT_EQ(returns.at(0).doppler, -1.F);
  extractor.extract(
      makeCloud({"vy", "vx", "y", "x"}, {}, {{{"x", 5.0}, {"y", 0.0}, {"vx", -2.0}, {"vy", 0.0}}}).view(),
      returns);
  EXPECT_FLOAT_EQ(returns.at(0).doppler, -2.F);
}

TEST(PointCloudView, OrganisedRowsMayBePadded) {
  std::vector<PointField> fields = {{"x", 0, ScalarType::kUint8, 1}};
  const std::uint8_t data[] = {1, 2, 99, 3, 4, 99};
  const PointCloudView view{&fields, data, 1, 2, 2, 3};
  EXPECT_EQ(view.size(), 4U);
  EXPECT_EQ(*view.point(2), 3);
  EXPECT_EQ(*view.point(3), 4);
}

TEST(ReadScalar, WidensEveryType) {
  const std::int16_t negative = -300;
  EXPECT_EQ(readScalar(reinterpret_cast<const std::uint8_t*>(&negative), ScalarType::kInt16), -300.0);
  const double precise = 0.1;
  EXPECT_EQ(readScalar(reinterpret_cast<const std::uint8_t*>(&precise), ScalarType::kFloat64), 0.1);
  const std::uint8_t byte = 200;
  EXPECT_EQ(readScalar(&byte, ScalarType::kUint8), 200.0);
  EXPECT_EQ(readScalar(&byte, ScalarType::kInt8), -56.0);
}

}  // namespace
}  // namespace radar_dot
