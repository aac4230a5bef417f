// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/radar/doppler_returns.h"

#include <gtest/gtest.h>

#include <cctype>
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

/// A layout with these float32 fields behind x and y, and no points.
PointCloud withFields(std::vector<std::string> names) {
  names.insert(names.begin(), {"x", "y"});
  return makeCloud(names, {}, {});
}

/// Where the range rate comes from, or the faults.
std::string sourceOf(const PointCloud& cloud, const ExtractionParams& params = {}) {
  DopplerExtractor extractor(params);
  std::string text;
  for (const std::string& fault : extractor.faults(cloud.view())) text += fault + ". ";
  return extractor.dopplerSource() + text;
}

TEST(DopplerExtractor, KnowsTheUsualNamesOfARangeRateInAnyCase) {
  const ExtractionParams params;
  const std::string description = fieldsOf(params).find("doppler_field")->text;
  for (std::string name :
       {"doppler", "doppler_velocity", "radial_velocity", "range_rate", "radial_speed", "v_doppler_mps",
        "v_r", "vr", "vrad", "rdot", "radar_relative_radial_velocity", "velocity", "vel", "speed"}) {
    EXPECT_NE(description.find(' ' + name), std::string::npos) << name;
    EXPECT_EQ(sourceOf(withFields({name})), "field '" + name + "'");
    name[0] = static_cast<char>(std::toupper(name[0]));
    EXPECT_EQ(sourceOf(withFields({name})), "field '" + name + "'");
  }
}

// In this order, wherever they stand in the cloud; what is compensated for the vehicle's motion is not among
// them.
TEST(DopplerExtractor, ChoosesTheFieldThatIsARangeRate) {
  EXPECT_EQ(sourceOf(withFields({"speed", "v_r_compensated", "v_r"})), "field 'v_r'");
  EXPECT_EQ(sourceOf(withFields({"ground_relative_radial_velocity", "radar_relative_radial_velocity"})),
            "field 'radar_relative_radial_velocity'");
  EXPECT_EQ(sourceOf(withFields({"recoveredSpeed", "velocity", "Doppler"})), "field 'Doppler'");
  EXPECT_EQ(sourceOf(withFields({"DOPPLER", "doppler"})), "field 'doppler'") << "the exact name comes first";
  EXPECT_EQ(sourceOf(withFields({"speed", "vy", "vx"})), "(vx, vy) on the line of sight")
      << "speed is the length of the vector";
  EXPECT_EQ(sourceOf(withFields({"VX", "VY", "VZ"})), "(vx, vy, vz) on the line of sight");
  ExtractionParams named;
  named.doppler_field = "V";
  EXPECT_EQ(sourceOf(withFields({"doppler", "v"}), named), "field 'v'");
  for (const char* other : {"v", "h", "v_r_compensated", "v_doppler_comp", "recoveredSpeed", "vx_comp",
                            "ground_relative_radial_velocity", "vx"}) {
    EXPECT_NE(sourceOf(withFields({other})).find("set doppler_field"), std::string::npos) << other;
  }
}

// A wall that recedes with (-3, 7, 2) m/s, seen at elevations of +-30 degrees: the range rate is the
// projection.
TEST(DopplerExtractor, ProjectsVelocityOnTheFullLineOfSight) {
  const Eigen::Vector3d velocity(-3.0, 7.0, 2.0);
  for (const double elevation : {-M_PI / 6.0, 0.0, M_PI / 6.0}) {
    for (const double azimuth : {-1.0, 0.3}) {
      const Eigen::Vector3d bearing(std::cos(elevation) * std::cos(azimuth),
                                    std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      const std::map<std::string, double> point = {{"x", 20.0 * bearing.x()}, {"y", 20.0 * bearing.y()},
                                                   {"z", 20.0 * bearing.z()}, {"vx", velocity.x()},
                                                   {"vy", velocity.y()},      {"vz", velocity.z()}};
      std::vector<DopplerReturn> returns;
      DopplerExtractor extractor;
      extractor.extract(makeCloud({"x", "y", "z", "vx", "vy", "vz"}, {}, {point}).view(), returns);
      EXPECT_NEAR(returns.at(0).doppler, bearing.dot(velocity), 1e-5);
      EXPECT_NEAR(returns[0].tangential_speed, std::cos(azimuth) * 7.0 + std::sin(azimuth) * 3.0, 1e-5);
      extractor.extract(makeCloud({"x", "y", "z", "vx", "vy"}, {}, {point}).view(), returns);
      EXPECT_NEAR(returns.at(0).doppler, bearing.head<2>().dot(velocity.head<2>()), 1e-5)
          << "without vz the velocity is horizontal";
    }
  }
}

TEST(DopplerExtractor, FlattensBearingsWhereElevationsAreNotUsed) {
  const PointCloud cloud = makeCloud({"x", "y", "z", "doppler"}, {},
                                     {{{"x", 6.0}, {"y", 8.0}, {"z", 10.0}, {"doppler", 1.0}},
                                      {{"x", 0.0}, {"y", 0.0}, {"z", 5.0}, {"doppler", 1.0}}});
  ExtractionParams params;
  params.use_elevation = false;
  std::vector<DopplerReturn> returns;
  const ExtractionCounts counts = DopplerExtractor(params).extract(cloud.view(), returns);
  ASSERT_EQ(counts.accepted, 1U);
  EXPECT_EQ(counts.not_finite, 1U) << "straight above there is no bearing in the plane";
  EXPECT_TRUE(returns[0].bearing.isApprox(Eigen::Vector3f(0.6F, 0.8F, 0.F)));
  EXPECT_NEAR(returns[0].range, std::sqrt(200.0), 1e-5);
  EXPECT_EQ(returns[0].doppler, 1.F);
}

TEST(DopplerExtractor, FiltersByElevationHeightSnrAndFlag) {
  const auto point = [](double z, double power, double flag) {
    return std::map<std::string, double>{{"x", 10.0},      {"y", 0.0},       {"z", z},
                                         {"doppler", 1.0}, {"Power", power}, {"denoiseFlag", flag}};
  };
  const PointCloud cloud =
      makeCloud({"x", "y", "z", "doppler", "Power", "denoiseFlag"}, {},
                {point(0.0, 9.0, 0.0), point(-3.0, 9.0, 0.0), point(3.0, 9.0, 0.0), point(1.0, 9.0, 0.0),
                 point(-1.0, 9.0, 0.0), point(0.0, 4.0, 0.0), point(0.0, 9.0, 1.0), point(0.0, 9.0, -2.0)});
  ExtractionParams params;
  params.filter.min_elevation = params.filter.min_height = -0.2;
  params.filter.max_elevation = 0.2;
  params.filter.max_height = 0.8;
  params.filter.min_snr = 5.0;
  params.filter.flag_field = "denoiseflag";
  params.filter.accepted_flags = {0, -2};
  DopplerExtractor extractor(params);
  std::vector<DopplerReturn> returns;
  const Eigen::Isometry3d mount(Eigen::Translation3d(0.0, 0.0, 0.5));
  const ExtractionCounts counts = extractor.extract(cloud.view(), returns, &mount);
  EXPECT_EQ(counts.out_of_elevation, 2U);
  EXPECT_EQ(counts.out_of_height, 2U);
  EXPECT_EQ(counts.snr, 1U);
  EXPECT_EQ(counts.flag, 1U);
  ASSERT_EQ(counts.accepted, 2U);
  EXPECT_EQ(returns[1].index, 7U);
  EXPECT_EQ(extractor.extract(cloud.view(), returns).accepted, 4U) << "no height without a mount";
}

TEST(DopplerExtractor, ReadsTheOtherFieldsWithoutCaseToo) {
  const PointCloud cloud = makeCloud(
      {"X", "Y", "Z", "V_R", "Rcs", "SNR"}, {"Pdh0"},
      {{{"X", 0.0}, {"Y", 3.0}, {"Z", 4.0}, {"V_R", 1.0}, {"Rcs", 1.0}, {"SNR", 7.0}, {"Pdh0", 1.0}}});
  ExtractionParams params;
  std::vector<DopplerReturn> returns;
  EXPECT_EQ(DopplerExtractor(params).extract(cloud.view(), returns).accepted, 1U);
  EXPECT_FLOAT_EQ(returns.at(0).bearing.z(), 0.8F);
  const auto refused = [&](std::size_t ExtractionCounts::*count) {
    return DopplerExtractor(params).extract(cloud.view(), returns).*count;
  };
  params.filter.min_snr = 8.0;
  EXPECT_EQ(refused(&ExtractionCounts::snr), 1U);
  params.filter.min_rcs = 2.0;
  EXPECT_EQ(refused(&ExtractionCounts::rcs), 1U);
  params.filter.pdh0_states = {2};
  EXPECT_EQ(refused(&ExtractionCounts::pdh0), 1U);
}

TEST(DopplerExtractor, RefusesParametersThatDoNotGoTogether) {
  ExtractionParams params;
  params.filter.accepted_flags = {1};
  test::expectRefusal([&] { validate(params); }, {"accepted_flags", "flag_field"});
  params = {};
  params.filter.min_elevation = 0.3;
  params.filter.max_elevation = 0.2;
  test::expectRefusal([&] { validate(params); }, {"min_elevation", "max_elevation"});
  params = {};
  params.filter.min_height = 0.3;
  params.filter.max_height = 0.2;
  test::expectRefusal([&] { validate(params); }, {"min_height", "max_height"});
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

TEST(DopplerExtractor, NamesAllThatIsMissingAtOnce) {
  PointCloud cloud = makeCloud({"x", "Alpha", "power"}, {}, {});
  DopplerExtractor extractor;
  std::vector<DopplerReturn> returns;
  EXPECT_EQ(
      test::refusalOf([&] { extractor.extract(cloud.view(), returns); }),
      "the cloud has no field 'y' (position, else by range and azimuth); none of its fields has the name "
      "of a range rate, nor are there 'vx' and 'vy': set doppler_field; its fields are: x, Alpha, power");
  EXPECT_EQ(extractor.dopplerSource(), "");

  ExtractionParams params;
  params.doppler_field = "rate";
  params.filter.snr_field = "strength";
  params.filter.flag_field = "valid";
  cloud.fields[0].offset = 40;
  DopplerExtractor named(params);
  const std::vector<std::string>& faults = named.faults(cloud.view());
  ASSERT_EQ(faults.size(), 6U);
  EXPECT_EQ(faults[0], "field 'x' (offset 40, type 7) does not fit into points of 12 bytes");
  EXPECT_EQ(faults[2], "the cloud has no field 'rate' (parameter doppler_field)");
  EXPECT_EQ(faults[3], "the cloud has no field 'strength' (parameter snr_field)");
  EXPECT_EQ(faults[4], "the cloud has no field 'valid' (parameter flag_field)");

  cloud = makeCloud({"x", "y", "rate", "strength", "valid"}, {}, {});
  EXPECT_TRUE(named.faults(cloud.view()).empty()) << "another layout";
  EXPECT_EQ(named.dopplerSource(), "field 'rate'");
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
