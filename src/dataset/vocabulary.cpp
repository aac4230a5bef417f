// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "vocabulary.h"

#include <algorithm>
#include <iterator>

#include "json_table_writer.h"
#include "new_token.h"

namespace radar_dot::dataset {
namespace {

struct Term {
  std::string_view name, description;
};

constexpr Term kCategories[] = {
    {"human.pedestrian.adult", "An adult on foot."},
    {"human.pedestrian.child", "A child on foot."},
    {"human.pedestrian.wheelchair", "A wheelchair, with the person in it."},
    {"human.pedestrian.stroller", "A stroller, with the person in it."},
    {"human.pedestrian.personal_mobility", "A skateboard, scooter or the like, with the person on it."},
    {"human.pedestrian.police_officer", "A police officer on foot."},
    {"human.pedestrian.construction_worker", "A construction worker on foot."},
    {"animal", "An animal of any kind."},
    {"vehicle.car", "A car, van or jeep for personal use."},
    {"vehicle.motorcycle", "A motorcycle or motor scooter, with its rider."},
    {"vehicle.bicycle", "A bicycle, with its rider."},
    {"vehicle.bus.bendy", "A section of an articulated bus."},
    {"vehicle.bus.rigid", "A bus in one piece."},
    {"vehicle.truck", "A vehicle to haul cargo, without its trailer."},
    {"vehicle.construction", "A vehicle for construction work."},
    {"vehicle.emergency.ambulance", "An ambulance."},
    {"vehicle.emergency.police", "A police vehicle."},
    {"vehicle.trailer", "A trailer of any vehicle."},
    {"movable_object.barrier", "A temporary road barrier."},
    {"movable_object.trafficcone", "A traffic cone."},
    {"movable_object.pushable_pullable", "An object that a pedestrian may push or pull."},
    {"movable_object.debris", "An object left on the road, too large to be driven over."},
    {"static_object.bicycle_rack", "A rack, with the bicycles in it."},
};

constexpr Term kAttributes[] = {
    {"vehicle.moving", "The vehicle moves."},
    {"vehicle.stopped", "The vehicle stands and is about to move, with a driver in it."},
    {"vehicle.parked", "The vehicle stands and is not about to move."},
    {"cycle.with_rider", "There is a rider on the cycle."},
    {"cycle.without_rider", "There is no rider on the cycle."},
    {"pedestrian.sitting_lying_down", "The person sits or lies."},
    {"pedestrian.standing", "The person stands."},
    {"pedestrian.moving", "The person moves."},
};

constexpr Term kVisibilities[] = {
    {"v0-40", "0 to 40 % of the object can be seen"},
    {"v40-60", "40 to 60 % of the object can be seen"},
    {"v60-80", "60 to 80 % of the object can be seen"},
    {"v80-100", "80 to 100 % of the object can be seen"},
};

template <std::size_t N>
bool contains(const Term (&terms)[N], std::string_view name) {
  return std::any_of(std::begin(terms), std::end(terms), [&](const Term& term) { return term.name == name; });
}

template <std::size_t N, typename MakeToken>
void writeTerms(const std::filesystem::path& file, const Term (&terms)[N], const MakeToken& token) {
  JsonTableWriter table(file);
  for (const Term& term : terms)
    table.record().set("token", token(term.name)).set("name", term.name).set("description", term.description);
  table.finish();
}

}  // namespace

bool isCategory(std::string_view name) { return contains(kCategories, name); }

bool isAttribute(std::string_view name) { return contains(kAttributes, name); }

bool isVisibility(int level) noexcept {
  return level >= 1 && level <= static_cast<int>(std::size(kVisibilities));
}

std::string categoryToken(std::string_view name) { return newToken({"category", name}); }

std::string attributeToken(std::string_view name) { return newToken({"attribute", name}); }

std::vector<std::string> attributeTokens(const std::vector<std::string>& names) {
  std::vector<std::string> tokens;
  for (const std::string& name : names) tokens.push_back(attributeToken(name));
  return tokens;
}

std::string visibilityToken(int level) { return std::to_string(level); }

void writeVocabulary(const std::filesystem::path& version_folder) {
  writeTerms(version_folder / "category.json", kCategories, categoryToken);
  writeTerms(version_folder / "attribute.json", kAttributes, attributeToken);
  JsonTableWriter table(version_folder / "visibility.json");
  for (int level = 1; isVisibility(level); ++level) {
    const Term& term = kVisibilities[level - 1];
    table.record()
        .set("description", term.description)
        .set("token", visibilityToken(level))
        .set("level", term.name);
  }
  table.finish();
}

}  // namespace radar_dot::dataset
