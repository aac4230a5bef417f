// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/common/read_parameters.h"

#include <fmt/format.h>
#include <ros/console.h>

#include <algorithm>
#include <iterator>

#include "radar_dot/common/did_you_mean.h"

namespace radar_dot {
namespace {

using XmlRpc::XmlRpcValue;

// What libraries read from the namespace of a nodelet.
constexpr std::string_view kForeign[] = {
    "diagnostic_period",  // diagnostic_updater
    "image_transport",    // transport of a subscriber of images
};

template <typename Item>
XmlRpcValue arrayOf(const std::vector<Item>& list) {
  XmlRpcValue array;
  array.setSize(static_cast<int>(list.size()));
  for (std::size_t i = 0; i < list.size(); ++i) array[static_cast<int>(i)] = XmlRpcValue(list[i]);
  return array;
}

/// For messages.
std::string textOf(const XmlRpcValue& value) {
  switch (value.getType()) {
    case XmlRpcValue::TypeBoolean: return static_cast<const bool&>(value) ? "true" : "false";
    case XmlRpcValue::TypeInt: return std::to_string(static_cast<const int&>(value));
    case XmlRpcValue::TypeDouble: return toText(static_cast<const double&>(value));
    case XmlRpcValue::TypeString: return "'" + static_cast<const std::string&>(value) + "'";
    case XmlRpcValue::TypeStruct: return "a dictionary";
    case XmlRpcValue::TypeArray: {
      std::string text;
      for (int i = 0; i < value.size(); ++i) text += (i == 0 ? "" : ", ") + textOf(value[i]);
      return "[" + text + "]";
    }
    default: return "of an unknown type";
  }
}

[[noreturn]] void refuseType(const Field& field, const XmlRpcValue& value) {
  throw InvalidParameter({field.name},
                         fmt::format("{} is {}, must be {}", field.name, textOf(value), field.typeText()));
}

/// The texts of the items. Those of a list of texts must be texts: YAML has made something else of others.
std::vector<std::string> itemsOf(const Field& field, const XmlRpcValue& array) {
  std::vector<std::string> items;
  for (int i = 0; i < array.size(); ++i) {
    const bool is_text = array[i].getType() == XmlRpcValue::TypeString;
    if (!is_text && field.type == FieldType::kTextList) refuseType(field, array);
    items.push_back(is_text ? static_cast<const std::string&>(array[i]) : textOf(array[i]));
  }
  return items;
}

void setFrom(const XmlRpcValue& value, const Field& field) {
  const bool is_text =
      field.type == FieldType::kText || field.type == FieldType::kEnum || field.type == FieldType::kTextList;
  const bool is_flag = field.type == FieldType::kBool;
  switch (value.getType()) {
    case XmlRpcValue::TypeBoolean:
      if (is_flag) return field.set(static_cast<const bool&>(value));
      break;
    case XmlRpcValue::TypeInt:
      if (is_flag) return field.setFromText(textOf(value));
      if (!is_text) return field.set(static_cast<std::int64_t>(static_cast<const int&>(value)));
      break;
    case XmlRpcValue::TypeDouble:
      if (!is_flag && !is_text) return field.set(static_cast<const double&>(value));
      break;
    // What was quoted, and what roslaunch makes a text of: 1e-3, inf.
    case XmlRpcValue::TypeString: return field.setFromText(static_cast<const std::string&>(value));
    case XmlRpcValue::TypeArray: return field.setFromItems(itemsOf(field, value));
    default: break;
  }
  refuseType(field, value);
}

std::string defaultText(const Field& field) {
  const bool is_text = field.type == FieldType::kText || field.type == FieldType::kEnum;
  const std::string text = toText(field.get());
  if (is_text || text.empty()) return "'" + text + "'";
  return *field.unit == '\0' ? text : text + " " + field.unit;
}

void readEntry(const XmlRpcValue& given, const FieldList& fields) {
  if (given.getType() != XmlRpcValue::TypeStruct)
    throw InvalidParameter({}, "is " + textOf(given) + ", must be a dictionary");
  // An entry has no parameters of others, and one without the parameter that was meant may do harm.
  for (const auto& [name, value] : given) {
    const Field* field = fields.find(name);
    if (field == nullptr)
      throw InvalidParameter({name}, "/" + name + " is unknown" + didYouMean(fields.nearestName(name), "'"));
    try {
      setFrom(value, *field);
    } catch (const InvalidParameter& error) {
      throw InvalidParameter({name}, std::string("/") + error.what());
    }
  }
}

void readDictionary(const XmlRpcValue& given, const std::string& place, const FieldDictionary& dictionary,
                    ParameterProblems& problems) {
  if (given.getType() != XmlRpcValue::TypeStruct) {
    problems.add(fmt::format("{} is {}, must be a dictionary: name -> parameters", place, textOf(given)),
                 true);
    problems.refused.emplace_back(dictionary.name);
    return;
  }
  for (const std::string& key : dictionary.keys()) dictionary.erase(key);
  for (const auto& [key, entry] : given) {
    try {
      readEntry(entry, dictionary.entry(key));
    } catch (const InvalidParameter& error) {
      dictionary.erase(key);
      const std::string what = error.what();
      const char* gap = what.front() == '/' ? "" : " ";
      problems.add(fmt::format("{}/{}{}{}; {} is left out", place, key, gap, what, key), true);
      problems.refused.push_back(fmt::format("{}/{}", dictionary.name, key));
    }
  }
}

/// Of a dictionary, or of one of its entries: "radars", "radars/front".
bool eraseEntries(const std::string& name, const FieldList& fields) {
  const std::size_t slash = name.find('/');
  for (const FieldDictionary& dictionary : fields.dictionaries()) {
    if (name.substr(0, slash) != dictionary.name) continue;
    const std::string key = slash == std::string::npos ? "" : name.substr(slash + 1);
    bool erased = false;
    for (const std::string& each : dictionary.keys()) {
      if (!key.empty() && each != key && key.compare(0, each.size() + 1, each + "/") != 0) continue;
      dictionary.erase(each);
      erased = true;
    }
    return erased;
  }
  return false;
}

/// @return false: it has its default already
bool toDefault(const Field& field, const FieldList& defaults) {
  const FieldValue value = defaults.find(field.name)->get();
  if (field.get() == value) return false;
  field.put(value);
  return true;
}

/// Sends the named ones back. @return what they have now, for a message; empty: nothing could be changed
std::string fallBack(const std::vector<std::string>& names, const FieldList& fields,
                     const FieldList& defaults, ParameterProblems& problems) {
  std::string outcome;
  for (const std::string& name : names) {
    const Field* field = fields.find(name);
    if (field != nullptr ? toDefault(*field, defaults) : eraseEntries(name, fields)) {
      problems.refused.push_back(name);
      const std::string now = field != nullptr
                                  ? fmt::format("using the default {} of {}", defaultText(*field), name)
                                  : name + " is left out";
      outcome += (outcome.empty() ? "" : ", ") + now;
    }
  }
  return outcome;
}

void fallBackEntirely(const FieldList& fields, const FieldList& defaults, ParameterProblems& problems) {
  for (const Field& field : fields)
    if (!field.at_start && toDefault(field, defaults)) problems.refused.emplace_back(field.name);
}

/// Does none of the names stand for a parameter that can change while the nodelet runs?
bool isReadAtStart(const std::vector<std::string>& names, const FieldList& fields) {
  return std::all_of(names.begin(), names.end(), [&fields](const std::string& name) {
    const Field* field = fields.find(name);
    return field == nullptr || field->at_start;  // entries of dictionaries are no fields
  });
}

}  // namespace

void ParameterProblems::add(const std::string& line, bool lasting) {
  lines.push_back(line);
  if (lasting) lasting_lines.push_back(line);
}

void ParameterProblems::settle(const std::vector<std::string>& changed) {
  lines = lasting_lines;
  const auto was_changed = [&changed](const std::string& name) {
    return std::find(changed.begin(), changed.end(), name) != changed.end();
  };
  refused.erase(std::remove_if(refused.begin(), refused.end(), was_changed), refused.end());
}

bool ParameterProblems::concern(std::string_view name) const {
  return std::find(refused.begin(), refused.end(), name) != refused.end();
}

std::string ParameterProblems::text() const { return fmt::format("{}", fmt::join(lines, "; ")); }

void readFields(const XmlRpcValue& given, const std::string& space, const FieldList& fields,
                ParameterProblems& problems) {
  if (given.getType() != XmlRpcValue::TypeStruct) return;
  for (const auto& [name, value] : given) {
    const Field* field = fields.find(name);
    if (field == nullptr) continue;
    try {
      setFrom(value, *field);
    } catch (const InvalidParameter& error) {
      problems.add(fmt::format("{}/{}; using the default {}", space, error.what(), defaultText(*field)),
                   field->at_start);
      problems.refused.push_back(name);
    }
  }
  for (const FieldDictionary& dictionary : fields.dictionaries()) {
    if (given.hasMember(dictionary.name))
      readDictionary(given[dictionary.name], space + "/" + dictionary.name, dictionary, problems);
  }
}

std::vector<std::string> unknownParameters(const XmlRpcValue& given, const std::string& space,
                                           const FieldList& fields) {
  std::vector<std::string> lines;
  if (given.getType() != XmlRpcValue::TypeStruct) return lines;
  const auto isDictionary = [&fields](const std::string& name) {
    return std::any_of(fields.dictionaries().begin(), fields.dictionaries().end(),
                       [&name](const FieldDictionary& each) { return name == each.name; });
  };
  for (const auto& [name, value] : given) {
    if (fields.find(name) != nullptr || isDictionary(name)) continue;
    if (std::find(std::begin(kForeign), std::end(kForeign), name) != std::end(kForeign)) continue;
    const std::string nearest = fields.nearestName(name);
    // Topics and nodes below this name have their parameters here too: depth/image/compressed/jpeg_quality.
    if (value.getType() == XmlRpcValue::TypeStruct && !isDictionary(nearest)) {
      for (const auto& [below, ignored] : value) {
        if (fields.find(below) == nullptr && !isDictionary(below)) continue;
        lines.push_back(
            fmt::format("'{0}/{1}/{2}' is not read; it belongs directly below '{0}'", space, name, below));
      }
      continue;
    }
    lines.push_back(
        fmt::format("'{}/{}' is no parameter of this nodelet{}", space, name, didYouMean(nearest, "'")));
  }
  return lines;
}

bool fallBackUntil(const std::function<void()>& attempt, const std::string& space, const FieldList& fields,
                   const FieldList& defaults, ParameterProblems& problems) {
  bool has_defaults = false;
  while (true) {
    std::string reason;
    try {
      attempt();
      return true;
    } catch (const InvalidParameter& error) {
      reason = error.what();
      const std::string outcome = fallBack(error.names(), fields, defaults, problems);
      if (!outcome.empty()) {
        problems.add(fmt::format("{}: {}; {}", space, reason, outcome), isReadAtStart(error.names(), fields));
        continue;
      }
    } catch (const std::exception& error) {
      reason = error.what();
    }
    if (has_defaults) {
      problems.add(fmt::format("{}: {}, with the defaults too", space, reason), false);
      return false;
    }
    has_defaults = true;
    fallBackEntirely(fields, defaults, problems);
    problems.add(fmt::format("{}: {}; using defaults for all parameters", space, reason), false);
  }
}

XmlRpcValue toXmlRpc(const Field& field) {
  struct Convert {
    XmlRpcValue operator()(std::monostate) const { return {}; }
    XmlRpcValue operator()(bool is) const { return is; }
    XmlRpcValue operator()(std::int64_t number) const { return static_cast<int>(number); }
    XmlRpcValue operator()(double number) const { return number; }
    XmlRpcValue operator()(const std::string& text) const { return text; }
    XmlRpcValue operator()(const std::vector<int>& list) const { return arrayOf(list); }
    XmlRpcValue operator()(const std::vector<double>& list) const { return arrayOf(list); }
    XmlRpcValue operator()(const std::vector<std::string>& list) const { return arrayOf(list); }
  };
  return std::visit(Convert(), field.get());
}

std::string topicDefect(const ros::NodeHandle& handle, const std::string& topic) {
  if (topic.empty()) return "its name is empty";
  try {
    handle.resolveName(topic);
    return {};
  } catch (const std::exception& error) {
    return error.what();
  }
}

void readParameters(const ros::NodeHandle& private_handle, const FieldList& fields,
                    ParameterProblems& problems) {
  const std::string& space = private_handle.getNamespace();
  XmlRpcValue given;
  if (!private_handle.getParam("", given)) return;
  readFields(given, space, fields, problems);
  for (const std::string& line : unknownParameters(given, space, fields)) ROS_WARN("%s", line.c_str());
}

void logProblems(const ParameterProblems& problems, std::size_t first) {
  for (std::size_t i = first; i < problems.lines.size(); ++i) ROS_ERROR("%s", problems.lines[i].c_str());
}

}  // namespace radar_dot
