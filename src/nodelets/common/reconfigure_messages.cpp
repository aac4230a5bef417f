// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/common/reconfigure_messages.h"

#include <algorithm>
#include <cctype>

#include "radar_dot/common/did_you_mean.h"

namespace radar_dot {
namespace {

using dynamic_reconfigure::Config;
using dynamic_reconfigure::Group;

// The clients know these types by name.
const char* typeOf(const Field& field) {
  if (field.optional) return "str";
  switch (field.type) {
    case FieldType::kBool: return "bool";
    case FieldType::kInt: return "int";
    case FieldType::kDouble: return "double";
    default: return "str";
  }
}

template <typename Parameter, typename Value>
Parameter parameter(const Field& field, const Value& value) {
  Parameter result;
  result.name = field.name;
  result.value = value;
  return result;
}

void add(const Field& field, const FieldValue& value, Config& message) {
  using dynamic_reconfigure::BoolParameter;
  using dynamic_reconfigure::DoubleParameter;
  using dynamic_reconfigure::IntParameter;
  using dynamic_reconfigure::StrParameter;
  const std::string type = typeOf(field);
  if (type == "bool") {
    message.bools.push_back(parameter<BoolParameter>(field, std::get<bool>(value)));
  } else if (type == "int") {
    const auto number = static_cast<std::int32_t>(std::get<std::int64_t>(value));
    message.ints.push_back(parameter<IntParameter>(field, number));
  } else if (type == "double") {
    message.doubles.push_back(parameter<DoubleParameter>(field, std::get<double>(value)));
  } else {
    message.strs.push_back(parameter<StrParameter>(field, toText(value)));
  }
}

std::string lowerCase(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

std::string groupName(const Field& field, const FieldList& fields) {
  std::string name = field.group;
  std::replace(name.begin(), name.end(), ' ', '_');
  // rqt_reconfigure looks for values of a group by its name in any case, and would find the parameter.
  const bool taken = std::any_of(fields.begin(), fields.end(), [&name](const Field& each) {
    return lowerCase(each.name) == lowerCase(name);
  });
  return taken ? name + "_parameters" : name;
}

/// "Default", which holds what has no group, and its children.
std::vector<Group> groupsOf(const FieldList& fields) {
  std::vector<Group> groups(1);
  groups[0].name = "Default";
  for (const Field& field : fields) {
    if (field.at_start || *field.group == '\0') continue;
    const std::string name = groupName(field, fields);
    if (std::any_of(groups.begin() + 1, groups.end(),
                    [&name](const Group& each) { return each.name == name; }))
      continue;
    Group group;
    group.name = name;
    group.id = static_cast<std::int32_t>(groups.size());
    group.parent = 0;
    groups.push_back(group);
  }
  return groups;
}

void addGroups(const std::vector<Group>& groups, Config& message) {
  for (const Group& group : groups) {
    dynamic_reconfigure::GroupState state;
    state.name = group.name;
    state.state = true;
    state.id = group.id;
    state.parent = group.parent;
    message.groups.push_back(state);
  }
}

/// A text in Python, which the clients evaluate.
std::string pythonText(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (c == '\'' || c == '\\') result += '\\';
    if (c == '\n')
      result += "\\n";
    else
      result += c;
  }
  return result + "'";
}

/// The choices of an enum as a dictionary in Python.
std::string editMethod(const Field& field) {
  if (field.choices.empty()) return {};
  std::string items;
  for (const auto& [name, text] : field.choices) {
    items += (items.empty() ? "" : ", ") + std::string("{'name': ") + pythonText(name) +
             ", 'type': 'str', 'value': " + pythonText(name) + ", 'description': " + pythonText(text) + "}";
  }
  return "{'enum': [" + items + "], 'enum_description': " + pythonText(field.text) + "}";
}

dynamic_reconfigure::ParamDescription descriptionOf(const Field& field) {
  dynamic_reconfigure::ParamDescription description;
  description.name = field.name;
  description.type = typeOf(field);
  description.level = 0;
  description.description = field.text;
  if (*field.unit != '\0') description.description += " [" + std::string(field.unit) + "]";
  description.edit_method = editMethod(field);
  return description;
}

/// An end of the valid values; texts and lists have none.
FieldValue limitOf(const Field& field, bool highest) {
  const double limit = highest ? field.range.highest : field.range.lowest;
  const std::string type = typeOf(field);
  if (type == "bool") return highest;
  if (type == "int") return static_cast<std::int64_t>(limit);
  if (type == "double") return limit;
  return std::string();
}

const Field& changeable(const std::string& name, const FieldList& fields) {
  const Field* field = fields.find(name);
  if (field == nullptr)
    throw InvalidParameter(
        {name}, "'" + name + "' is no parameter of this nodelet" + didYouMean(fields.nearestName(name), "'"));
  if (field->at_start)
    throw InvalidParameter({name}, name + " is read at start, and cannot be changed while the nodelet runs");
  return *field;
}

}  // namespace

dynamic_reconfigure::ConfigDescription descriptionOf(const FieldList& defaults) {
  dynamic_reconfigure::ConfigDescription description;
  description.groups = groupsOf(defaults);
  for (const Field& field : defaults) {
    if (field.at_start) continue;
    const std::string name = *field.group == '\0' ? "Default" : groupName(field, defaults);
    const auto group = std::find_if(description.groups.begin(), description.groups.end(),
                                    [&name](const Group& each) { return each.name == name; });
    group->parameters.push_back(descriptionOf(field));
    add(field, limitOf(field, false), description.min);
    add(field, limitOf(field, true), description.max);
    add(field, field.get(), description.dflt);
  }
  for (Config* config : {&description.min, &description.max, &description.dflt})
    addGroups(description.groups, *config);
  return description;
}

Config messageOf(const FieldList& fields) {
  Config message;
  for (const Field& field : fields)
    if (!field.at_start) add(field, field.get(), message);
  addGroups(groupsOf(fields), message);
  return message;
}

std::vector<std::string> writeRequest(const Config& request, const FieldList& fields) {
  std::vector<std::string> names;
  const auto named = [&](const std::string& name) -> const Field& {
    names.push_back(name);
    return changeable(name, fields);
  };
  for (const auto& given : request.bools) named(given.name).set(given.value != 0);
  for (const auto& given : request.ints) named(given.name).set(static_cast<std::int64_t>(given.value));
  for (const auto& given : request.doubles) named(given.name).set(given.value);
  for (const auto& given : request.strs) {
    const Field& field = named(given.name);
    const bool as_text = field.type == FieldType::kText || field.type == FieldType::kEnum;
    // Only what is a text in the description is read from one.
    if (as_text || std::string(typeOf(field)) != "str")
      field.set(given.value);
    else
      field.setFromText(given.value);
  }
  return names;
}

}  // namespace radar_dot
