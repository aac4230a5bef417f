// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
//
// The messages of the radars in docs/radars.md, laid out as their drivers do, read as the nodelet reads them.
// What comes through radar_lists_to_cloud is tested with it; here is what that publishes.
#include <gtest/gtest.h>
#include <ros/serialization.h>
#include <sensor_msgs/PointCloud.h>
#include <sensor_msgs/PointCloud2.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

#include "nodelets/messages/cloud_conversion.h"
#include "nodelets/messages/radar_message.h"
#include "nodelets/messages/radar_scan.h"
#include "radar_dot/config/sections.h"

namespace radar_dot {
namespace {

/// Something that stands, seen by a radar that drives along its x axis at 10 m/s: the range rate is -10 x /
/// range.
struct Return {
  double x, y, z, range, rate;
};
constexpr Return kScene[] = {
    {3.0, 4.0, 0.0, 5.0, -6.0}, {8.0, -6.0, 0.0, 10.0, -8.0}, {6.0, 2.0, 3.0, 7.0, -60.0 / 7.0}};

/// One column: a name, of what it is (a quantity or a number; else something that is none of what is looked
/// for), and as which type.
struct Column {
  std::string name, quantity;
  std::uint8_t type = sensor_msgs::PointField::FLOAT32;

  explicit Column(std::string token) {
    using sensor_msgs::PointField;
    if (const std::size_t colon = token.find(':'); colon != std::string::npos) {
      const std::string name_of_type = token.substr(colon + 1);
      type = name_of_type == "i8"    ? PointField::INT8
             : name_of_type == "i16" ? PointField::INT16
                                     : PointField::FLOAT64;
      token.resize(colon);
    }
    const std::size_t equals = std::min(token.find('='), token.size());
    name = token.substr(0, equals);
    quantity = equals < token.size() ? token.substr(equals + 1) : name.size() == 1 ? name : "-99";
  }

  double of(const Return& seen) const {
    const double azimuth = std::atan2(seen.y, seen.x), elevation = std::asin(seen.z / seen.range);
    const std::pair<const char*, double> quantities[] = {{"x", seen.x},
                                                         {"y", seen.y},
                                                         {"z", seen.z},
                                                         {"range", seen.range},
                                                         {"rate", seen.rate},
                                                         {"reversed", -seen.rate},
                                                         {"azimuth", azimuth},
                                                         {"elevation", elevation},
                                                         {"azimuth_deg", azimuth * 180.0 / M_PI},
                                                         {"elevation_deg", elevation * 180.0 / M_PI}};
    for (const auto& [name_of_quantity, value] : quantities)
      if (quantity == name_of_quantity) return value;
    return quantity == "nan" ? std::numeric_limits<double>::quiet_NaN()
                             : std::strtod(quantity.c_str(), nullptr);
  }
};

std::vector<Column> columnsOf(const std::string& text) {
  std::vector<Column> columns;
  std::istringstream stream(text);
  for (std::string token; stream >> token;) columns.emplace_back(token);
  return columns;
}

/// A column "_" is padding, as PCL has it.
sensor_msgs::PointCloud2 cloud2Of(const std::string& text) {
  sensor_msgs::PointCloud2 cloud;
  const std::vector<Column> columns = columnsOf(text);
  std::vector<sensor_msgs::PointField> fields;
  for (const Column& column : columns) {
    sensor_msgs::PointField& field = fields.emplace_back();
    field.name = column.name;
    field.offset = cloud.point_step;
    field.datatype = column.type;
    field.count = 1;
    cloud.point_step += static_cast<std::uint32_t>(scalarSize(static_cast<ScalarType>(column.type)));
    if (column.name != "_") cloud.fields.push_back(field);
  }
  cloud.height = 1;
  cloud.width = static_cast<std::uint32_t>(std::size(kScene));
  cloud.row_step = cloud.point_step * cloud.width;
  for (const Return& seen : kScene) {
    for (const Column& column : columns) {
      const double value = column.of(seen);
      const auto append = [&cloud](auto number) {
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(&number);
        cloud.data.insert(cloud.data.end(), bytes, bytes + sizeof number);
      };
      if (column.type == sensor_msgs::PointField::INT8) append(static_cast<std::int8_t>(value));
      if (column.type == sensor_msgs::PointField::INT16) append(static_cast<std::int16_t>(value));
      if (column.type == sensor_msgs::PointField::FLOAT32) append(static_cast<float>(value));
      if (column.type == sensor_msgs::PointField::FLOAT64) append(value);
    }
  }
  return cloud;
}

sensor_msgs::PointCloud cloudOf(const std::string& text) {
  sensor_msgs::PointCloud cloud;
  for (const Return& seen : kScene) {
    geometry_msgs::Point32& point = cloud.points.emplace_back();
    point.x = static_cast<float>(seen.x);
    point.y = static_cast<float>(seen.y);
    point.z = static_cast<float>(seen.z);
  }
  for (const Column& column : columnsOf(text)) {
    sensor_msgs::ChannelFloat32& channel = cloud.channels.emplace_back();
    channel.name = column.name;
    for (const Return& seen : kScene) channel.values.push_back(static_cast<float>(column.of(seen)));
  }
  return cloud;
}

radar_msgs::RadarScan scan() {
  radar_msgs::RadarScan message;
  const Column azimuth("azimuth=azimuth"), elevation("elevation=elevation");
  for (const Return& seen : kScene) {
    message.returns.push_back({static_cast<float>(seen.range), static_cast<float>(azimuth.of(seen)),
                               static_cast<float>(elevation.of(seen)), static_cast<float>(seen.rate), -99.F});
  }
  return message;
}

/// As it comes over the connection.
template <typename Message>
RadarMessage received(Message message) {
  message.header.frame_id = "radar";
  message.header.stamp = ros::Time(1.0);
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  RadarMessage result;
  result.setType(ros::message_traits::datatype(message), ros::message_traits::md5sum(message));
  result.read(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  return result;
}

enum class Kind { kCloud2, kCloud, kScan };

struct Layout {
  const char* radar;
  const char* preset;
  Kind kind;
  const char* columns;
  const char* parameter = "";  ///< name=value, beside the preset
  bool needs_preset = false;   ///< its range rate has a name that means something else elsewhere
};
std::ostream& operator<<(std::ostream& stream, const Layout& layout) { return stream << layout.radar; }

class RadarLayouts : public testing::TestWithParam<Layout> {
 protected:
  static void expectScene(const std::string& preset) {
    const Layout& layout = GetParam();
    EgoVelocityConfig config;
    RadarEntry& entry = config.radars["front"];
    entry.topic = "points";
    entry.preset = preset;
    if (const std::string text = layout.parameter; !text.empty())
      fieldsOf(entry).find(text.substr(0, text.find('=')))->setFromText(text.substr(text.find('=') + 1));
    ASSERT_NO_THROW(validate(config));

    const RadarMessage message = layout.kind == Kind::kCloud2  ? received(cloud2Of(layout.columns))
                                 : layout.kind == Kind::kCloud ? received(cloudOf(layout.columns))
                                                               : received(scan());
    ASSERT_EQ(message.defect, "");
    EXPECT_EQ(message.header.frame_id, "radar");
    DopplerExtractor extractor(extractionOf(config, entry));
    std::vector<std::string> faults;
    const sensor_msgs::PointCloud2ConstPtr cloud =
        withPositions(message.cloud, extractor.params().angle_unit, faults);
    std::vector<PointField> fields;
    const PointCloudView view = viewOf(*cloud, fields);
    faults.insert(faults.end(), extractor.faults(view).begin(), extractor.faults(view).end());
    ASSERT_EQ(faults, std::vector<std::string>());
    std::vector<DopplerReturn> returns;
    extractor.extract(view, returns);

    ASSERT_EQ(returns.size(), std::size(kScene));
    for (std::size_t i = 0; i < returns.size(); ++i) {
      const Return& seen = kScene[i];
      const Eigen::Vector3d position(seen.x, seen.y, extractor.params().use_elevation ? seen.z : 0.0);
      EXPECT_NEAR(returns[i].range, seen.range, 1e-4) << i;
      EXPECT_NEAR(returns[i].doppler, seen.rate, 1e-4) << i;
      EXPECT_TRUE(returns[i].bearing.isApprox(position.normalized().cast<float>(), 1e-5F))
          << i << ": " << returns[i].bearing.transpose();
    }
  }
};

TEST_P(RadarLayouts, AreReadWithTheirPreset) { expectScene(GetParam().preset); }

TEST_P(RadarLayouts, AreReadByTheirNamesAlone) {
  if (!GetParam().needs_preset) expectScene("");
}

const Layout kLayouts[] = {
    {"radar_msgs/RadarScan", "", Kind::kScan, ""},
    {"ARS408 of tier4", "ars408_radar_msgs", Kind::kScan, ""},
    {"polar, radians", "", Kind::kCloud2, "range=range azimuth=azimuth elevation=elevation doppler=rate"},
    {"polar, degrees", "", Kind::kCloud2,
     "range=range azimuth=azimuth_deg elevation=elevation_deg doppler=rate", "angle_unit=degrees"},
    {"Altos", "altos_v1_v2", Kind::kCloud2, "x y z _ h=rate s=-99 v=-1 _", "", true},
    {"Ainstein", "ainstein", Kind::kCloud2,
     "x y z snr range=range speed=rate azimuth=azimuth_deg elevation=elevation_deg"},
    {"Ainstein reversed", "ainstein", Kind::kCloud2,
     "x y z snr range=range speed=reversed azimuth=azimuth_deg elevation=elevation_deg", "doppler_scale=-1"},
    {"bitsensing AFI910", "bitsensing_afi910", Kind::kCloud2, "x y z vel=rate power"},
    {"bitsensing MFI920", "bitsensing_mfi920", Kind::kCloud2, "x y z velocity=rate power"},
    {"Bosch GPR", "bosch_gpr", Kind::kCloud2, "x y z radial_velocity=rate reflected_power"},
    {"Bosch premium radar", "bosch_gpr", Kind::kCloud2, "x y z radial_velocity=rate radar_cross_section"},
    {"CARLA", "carla", Kind::kCloud2,
     "x y z Range=range Velocity=rate AzimuthAngle=azimuth ElevationAngle=elevation"},
    {"ARS408 of nuScenes", "", Kind::kCloud2,
     "x y z dyn_prop:i8 id:i16 rcs vx=-10 vy=0 vx_comp=0 vy_comp=0 ambig_state=3:i8 invalid_state=0:i8 "
     "pdh0=1:i8"},
    {"radar_lists_to_cloud", "", Kind::kCloud2, "x y z doppler=rate rcs snr"},
    {"ARS408 by radar_lists_to_cloud", "ars408", Kind::kCloud2,
     "x y z doppler=rate rcs ambig_state=3 invalid_state=0 pdh0=1"},
    {"ARS430 by radar_lists_to_cloud", "ars430", Kind::kCloud2, "x y z doppler=rate rcs snr"},
    {"ARS548 of ars548_ros", "ars548", Kind::kCloud2,
     "x y z v=rate r=range RCS:i8 azimuth=azimuth elevation=elevation", "", true},
    {"ARS548 of RosDriverForARS548", "ars548_channels", Kind::kCloud,
     "doppler_velocity=rate range=range rcs"},
    {"ARS548 of nebula", "ars548_nebula", Kind::kCloud2,
     "x y z azimuth=azimuth azimuth_std elevation=elevation elevation_std range=range range_std "
     "range_rate=rate "
     "range_rate_std rcs:i8"},
    {"Oculii Eagle of MSC-RAD4R", "oculii_eagle", Kind::kCloud2,
     "x y z alpha beta range=range doppler=rate power recoveredSpeed=0 dotFlags:i16"},
    {"Oculii Eagle of NTU4DRadLM", "oculii_eagle_channels", Kind::kCloud,
     "Doppler=rate Range=range Power Alpha Beta"},
    {"Provizio", "provizio", Kind::kCloud2,
     "x y z radar_relative_radial_velocity=rate signal_to_noise_ratio ground_relative_radial_velocity=nan"},
    {"Hugin", "hugin", Kind::kCloud2, "x y z _ doppler=rate power range=range"},
    {"SICK", "sick_rms", Kind::kCloud2, "x y z vrad=rate amplitude"},
    {"UMRR", "umrr", Kind::kCloud2,
     "x y z radial_speed=rate power rcs noise snr azimuth_angle=azimuth elevation_angle=elevation "
     "range=range"},
    {"TI", "ti_mmwave", Kind::kCloud2, "x y z _ intensity velocity=rate"},
    {"TI of reve", "ti_reve_rio", Kind::kCloud2, "x y z _ snr_db noise_db v_doppler_mps=rate"},
    {"TI of ethz-asl/rio", "ti_ethz_rio", Kind::kCloud2, "x y z doppler=rate snr:i16 noise:i16"},
    {"TI of ColoRadar", "coloradar", Kind::kCloud2, "x y z intensity range=range doppler=rate"},
    {"TJ4DRadSet", "", Kind::kCloud2, "x y z V_r=rate Range=range Power Alpha Beta"},
    {"View-of-Delft", "vod", Kind::kCloud2, "x y z RCS v_r=rate v_r_compensated=0 time:f64"}};

INSTANTIATE_TEST_SUITE_P(Drivers, RadarLayouts, testing::ValuesIn(kLayouts));

}  // namespace
}  // namespace radar_dot
