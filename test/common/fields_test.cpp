// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/common/fields.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <tuple>

#include "fixtures/refusal.h"

namespace radar_dot {

enum class Colour { kRed, kGreen };
template <>
struct EnumNames<Colour> {
  static constexpr EnumName<Colour> kValues[] = {{Colour::kRed, "red"},
                                                 {Colour::kGreen, "green", "as grass"}};
};

namespace {

struct Lamp {
  double power = 5.0;
  std::optional<double> tilt;
  std::optional<Colour> colour;
  std::optional<std::array<double, 3>> place;
  void describe(FieldList& fields) {
    fields.add("power", power, "Electric power", "W", {0.0, 100.0});
    fields.add("tilt", tilt, "Angle against the vertical", "rad", {-1.0, 1.0});
    fields.add("colour", colour, "Colour of its light");
    fields.add("place", place, "Where it stands", "m", {-9.0, 9.0});
  }
};

struct Street {
  bool lit = true;
  int lanes = 2;
  std::size_t houses = 7;
  double near = 1.0, far = 50.0;
  Colour colour = Colour::kRed;
  std::string name = "Elm";
  std::vector<int> numbers = {1, 3};
  std::vector<std::string> trees;
  double open_end = std::numeric_limits<double>::infinity();
  std::map<std::string, Lamp> lamps;

  void describe(FieldList& fields) {
    fields.group("Looks");
    fields.add("lit", lit, "Lamps are on");
    fields.add("lanes", lanes, "Lanes in both directions", "", {1, 8});
    fields.add("houses", houses, "Houses on both sides");
    fields.add("near", near, "Where it begins", "m", {0.0, 1000.0});
    fields.add("far", far, "Where it ends", "m", {0.0, 1000.0});
    fields.add("colour", colour, "Colour of the houses");
    fields.group("At start", FieldList::kAtStart | FieldList::kLiveOnly);
    fields.add("name", name, "Its name");
    fields.add("numbers", numbers, "Numbers of its houses", "", {0, 255});
    fields.add("trees", trees, "Kinds of its trees");
    fields.add("open_end", open_end, "Farthest view", "m", {0.0});
    fields.addDictionary("lamps", lamps, "Its lamps by name");
  }
};

TEST(Fields, SetEachTypeFromText) {
  Street street;
  const FieldList fields = fieldsOf(street);
  const std::tuple<const char*, const char*, FieldValue> settings[] = {
      {"lit", "no", false},
      {"lanes", "4", std::int64_t{4}},
      {"houses", " 12 ", std::int64_t{12}},
      {"lanes", "5.0", std::int64_t{5}},
      {"houses", "1e2", std::int64_t{100}},
      {"numbers", "1.0, 2", std::vector<int>{1, 2}},
      {"near", "2.5", 2.5},
      {"far", "3", 3.0},
      {"colour", "green", std::string("green")},
      {"name", "Oak", std::string("Oak")},
      {"numbers", "[0, 4]", std::vector<int>{0, 4}},
      {"numbers", "", std::vector<int>{}},
      {"trees", "lime,ash", std::vector<std::string>{"lime", "ash"}},
      {"open_end", "-0.0", -0.0},
      {"open_end", ".inf", std::numeric_limits<double>::infinity()}};
  for (const auto& [name, text, value] : settings) {
    fields.find(name)->setFromText(text);
    EXPECT_EQ(fields.find(name)->get(), value) << name << " " << text;
  }
  EXPECT_EQ(street.houses, 100U);
  EXPECT_EQ(street.colour, Colour::kGreen);
  EXPECT_FALSE(street.lit);
  fields.find("near")->set(std::int64_t{3});
  fields.find("lanes")->set(3.0);
  EXPECT_EQ(street.near, 3.0);
  EXPECT_EQ(street.lanes, 3);
}

TEST(Fields, TextReadsBackExactly) {
  Street street;
  street.near = 0.1 + 0.2;
  const Street before = street;
  const FieldList fields = fieldsOf(street);
  for (const Field& field : fields) field.setFromText(toText(field.get()));
  EXPECT_TRUE(sameFields(before, street));
  EXPECT_EQ(street.near, 0.1 + 0.2);
}

TEST(Fields, RefusalsNameFieldValueAndWhatIsValid) {
  Street street;
  const FieldList fields = fieldsOf(street);
  const std::tuple<const char*, const char*, const char*> refusals[] = {
      {"near", "-1", "near is -1, must be between 0 and 1000 m"},
      {"near", "nan", "near is nan, must be between 0 and 1000 m"},
      {"near", "far", "near is 'far', must be a number"},
      {"lanes", "2.5", "lanes is '2.5', must be a whole number"},
      {"lanes", "9", "lanes is 9, must be between 1 and 8"},
      {"houses", "-1", "houses is -1, must be 0 or more"},
      {"houses", "3000000000", "houses is 3000000000, must be 2147483647 or less"},
      {"lit", "maybe", "lit is 'maybe', must be true or false"},
      {"colour", "blue", "colour is 'blue', must be one of red, green"},
      {"numbers", "1, 256", "numbers is 1, 256, must be between 0 and 255"}};
  for (const auto& [name, text, refusal] : refusals)
    EXPECT_EQ(test::refusalOf<InvalidParameter>(
                  [&, name = name, text = text] { fields.find(name)->setFromText(text); }),
              refusal);
  EXPECT_TRUE(sameFields(Street(), street)) << "what is refused changes nothing";
  EXPECT_EQ(test::refusalOf<InvalidParameter>([&] { fields.find("near")->set(true); }),
            "near is 'true', must be a number");
  street.far = std::nan("");
  EXPECT_EQ(test::refusalOf<InvalidParameter>([&] { validateFields(street); }),
            "far is nan, must be between 0 and 1000 m");
}

TEST(Fields, RulesBetweenFieldsNameThem) {
  Street street;
  street.near = 60.0;
  const FieldList fields = fieldsOf(street);
  try {
    requireLess(fields, street.near, street.far);
    FAIL() << "accepted";
  } catch (const InvalidParameter& error) {
    EXPECT_STREQ(error.what(), "near (60 m) must be smaller than far (50 m)");
    EXPECT_EQ(error.names(), (std::vector<std::string>{"near", "far"}));
  }
  EXPECT_EQ(
      test::refusalOf<InvalidParameter>([&] { require(false, fields, {&street.lanes}, "it must be even"); }),
      "lanes is 2; it must be even");
  const double stranger = 60.0;
  EXPECT_THROW(requireLess(fields, stranger, street.far), std::logic_error);
}

TEST(Fields, GroupsFlagsAndNearestNames) {
  Street street;
  const FieldList fields = fieldsOf(street);
  EXPECT_STREQ(fields.find("near")->group, "Looks");
  EXPECT_FALSE(fields.find("near")->at_start);
  EXPECT_TRUE(fields.find("name")->at_start);
  EXPECT_TRUE(fields.find("name")->live_only);
  for (const auto& [unknown, nearest] : {std::pair("colur", "colour"),
                                         {"lamp", "lamps"},
                                         {"threshold", ""},
                                         {"num", "numbers"},
                                         {"bers", "numbers"}})
    EXPECT_EQ(fields.nearestName(unknown), nearest);
  EXPECT_EQ(fields.find("nowhere"), nullptr);
}

TEST(Fields, DictionariesHoldParametersByName) {
  Street street;
  const FieldList fields = fieldsOf(street);
  const FieldDictionary& lamps = fields.dictionaries().at(0);
  lamps.entry("corner").find("power")->setFromText("7");
  lamps.entry("gate").find("tilt")->setFromText("0.5");
  EXPECT_EQ(lamps.keys(), (std::vector<std::string>{"corner", "gate"}));
  EXPECT_EQ(street.lamps.at("corner").power, 7.0);
  EXPECT_FALSE(street.lamps.at("corner").tilt.has_value());
  EXPECT_EQ(street.lamps.at("gate").tilt, 0.5);
  EXPECT_TRUE(lamps.entry("gate").find("tilt")->optional);
  lamps.entry("gate").find("tilt")->setFromText("");
  EXPECT_FALSE(street.lamps.at("gate").tilt.has_value());
  lamps.entry("gate").find("tilt")->setFromText("0.5");
  Street other = street;
  EXPECT_TRUE(sameFields(street, other));
  other.lamps.at("gate").power = 1.0;
  EXPECT_FALSE(sameFields(street, other));
  lamps.erase("gate");
  EXPECT_EQ(street.lamps.size(), 1U);
}

TEST(Fields, OptionalOnesHaveAValueOrNone) {
  Lamp lamp;
  const FieldList fields = fieldsOf(lamp);
  const Field &colour = *fields.find("colour"), &place = *fields.find("place");
  for (const Field* field : {&colour, &place}) EXPECT_EQ(field->get(), FieldValue()) << field->name;
  colour.setFromText("green");
  EXPECT_EQ(lamp.colour, Colour::kGreen);
  place.setFromText("[1, -2.5, 1e-1]");
  EXPECT_EQ(lamp.place, (std::array<double, 3>{1.0, -2.5, 0.1}));
  EXPECT_EQ(toText(place.get()), "1, -2.5, 0.1");
  for (const auto& [text, refusal] :
       {std::pair("1, 2", "place is 1, 2, must be 3 numbers between -9 and 9 m"),
        {"1, 2, 10", "place is 1, 2, 10, must be 3 numbers between -9 and 9 m"},
        {"1, a, 2", "place is '1, a, 2', must be a list of numbers"},
        {"3", "place is 3, must be 3 numbers between -9 and 9 m"}})
    EXPECT_EQ(test::refusalOf<InvalidParameter>([&, text = text] { place.setFromText(text); }), refusal);
  EXPECT_EQ(test::refusalOf<InvalidParameter>([&] { colour.setFromText("blue"); }),
            "colour is 'blue', must be one of red, green");
  EXPECT_EQ(lamp.place, (std::array<double, 3>{1.0, -2.5, 0.1}));
  for (const Field* field : {&colour, &place}) field->setFromText("");
  EXPECT_FALSE(lamp.place || lamp.colour);
}

TEST(Fields, OverridesAreCheckedAsWhatTheyOverride) {
  Street street;
  std::map<std::string, FieldValue> values;
  FieldList overrides;
  overrides.addOverrides(fieldsOf(street), values);
  EXPECT_EQ(overrides.size(), fieldsOf(street).size());
  for (const Field& field : overrides) EXPECT_EQ(field.get(), FieldValue()) << field.name;
  overrides.find("near")->setFromText("3");
  overrides.find("numbers")->setFromText("[]");
  overrides.find("colour")->setFromText("green");
  EXPECT_EQ(values, (std::map<std::string, FieldValue>{
                        {"near", 3.0}, {"numbers", std::vector<int>()}, {"colour", std::string("green")}}));
  EXPECT_TRUE(sameFields(street, Street()));
  EXPECT_EQ(test::refusalOf<InvalidParameter>([&] { overrides.find("near")->setFromText("-1"); }),
            "near is -1, must be between 0 and 1000 m");
  overrides.find("near")->setFromText("");
  EXPECT_EQ(values.count("near"), 0U);
}

}  // namespace
}  // namespace radar_dot
