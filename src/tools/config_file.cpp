// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "config_file.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <functional>
#include <ios>
#include <iterator>
#include <set>
#include <system_error>

namespace radar_dot::tools {
namespace {

constexpr const char* kReportKey = "parameters";
constexpr const char* kToolKey = "tool";
constexpr const char* kOptionsKey = "options";

std::string contentOf(const std::string& path) {
  errno = 0;
  try {
    std::ifstream file(path, std::ios::binary);
    if (!file) throw std::ios_base::failure("");
    // Reading a folder throws.
    return std::string(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  } catch (const std::ios_base::failure&) {
    const std::error_code cause(errno, std::generic_category());
    throw ConfigFileError(fmt::format("cannot read {}: {}", path, cause.message()));
  }
}

/// The lists that hold the parameters under one key.
using Lists = std::vector<const FieldList*>;

std::string nearestIn(const Lists& lists, const std::string& unknown) {
  std::vector<std::string> names;
  for (const FieldList* list : lists) {
    for (const Field& field : *list) names.emplace_back(field.name);
    for (const FieldDictionary& dictionary : list->dictionaries()) names.emplace_back(dictionary.name);
  }
  return nearestName(unknown, names);
}

class Reader {
 public:
  Reader(const std::string& path, const std::vector<Section>& sections, const ReportOwner& owner)
      : path_(path), sections_(sections), owner_(owner) {}

  std::vector<const void*> read() {
    const std::string text = contentOf(path_);
    try {
      // Several documents in one file are loaded one after the other, as by rosparam.
      for (const YAML::Node& document : YAML::LoadAll(text)) readDocument(document);
    } catch (const YAML::Exception& error) {
      throw ConfigFileError(fmt::format("{}:{}: not valid YAML: {}", path_, error.mark.line + 1, error.msg));
    }
    return std::move(set_);
  }

 private:
  [[noreturn]] void fail(const YAML::Node& where, const std::string& what) const {
    throw ConfigFileError(fmt::format("{}:{}: {}", path_, where.Mark().line + 1, what));
  }

  /// Calls visit(key, its node, value) for each key of a dictionary, which may be empty.
  template <typename Visit>
  void forEachKey(const YAML::Node& map, const std::string& what, const Visit& visit) const {
    if (map.IsNull()) return;
    if (!map.IsMap()) fail(map, what + " is no dictionary of names and values");
    std::set<std::string> seen;
    for (const auto& pair : map) {
      if (!pair.first.IsScalar()) fail(pair.first, what + " has a key that is not a name");
      const std::string& key = pair.first.Scalar();
      if (!seen.insert(key).second) fail(pair.first, fmt::format("{} is there twice", key));
      visit(key, pair.first, pair.second);
    }
  }

  void readDocument(const YAML::Node& root) {
    if (root.IsMap() && root[kReportKey]) {
      readReport(root[kReportKey]);
      return;
    }
    forEachKey(root, "the file",
               [this](const std::string& key, const YAML::Node& key_node, const YAML::Node& value) {
                 readSection(key, key_node, value);
               });
  }

  void readReport(const YAML::Node& parameters) {
    // Before names that another tool does not know are found to be wrong.
    if (parameters.IsMap() && parameters[kToolKey]) {
      const YAML::Node tool = parameters[kToolKey];
      if (!tool.IsScalar() || tool.Scalar() != owner_.tool) {
        fail(tool, fmt::format("the report is of {}, not of {}",
                               tool.IsScalar() ? tool.Scalar() : "no tool known", owner_.tool));
      }
    }
    forEachKey(parameters, kReportKey,
               [this](const std::string& key, const YAML::Node& key_node, const YAML::Node& value) {
                 if (key == kToolKey) return;
                 if (key != kOptionsKey) return readSection(key, key_node, value);
                 Lists lists;
                 for (const FieldList& options : owner_.options) lists.push_back(&options);
                 readValues(key, lists, value);
               });
  }

  void readSection(const std::string& key, const YAML::Node& key_node, const YAML::Node& value) {
    Lists lists;
    std::vector<std::string> names;
    for (const Section& section : sections_) {
      names.emplace_back(section.name);
      if (key == section.name) lists.push_back(&section.fields);
    }
    if (lists.empty())
      fail(key_node, didYouMean(fmt::format("unknown section {}", key), nearestName(key, names)));
    readValues(key, lists, value);
  }

  void readValues(const std::string& prefix, const Lists& lists, const YAML::Node& values) {
    forEachKey(
        values, prefix, [&](const std::string& key, const YAML::Node& key_node, const YAML::Node& value) {
          if (setField(prefix, lists, key, key_node, value) || setDictionary(prefix, lists, key, value))
            return;
          fail(key_node,
               didYouMean(fmt::format("unknown parameter {}/{}", prefix, key), nearestIn(lists, key)));
        });
  }

  bool setField(const std::string& prefix, const Lists& lists, const std::string& key,
                const YAML::Node& key_node, const YAML::Node& value) {
    bool is_known = false;
    for (const FieldList* list : lists) {
      const Field* field = list->find(key);
      if (field == nullptr) continue;
      is_known = true;
      try {
        setValue(*field, value);
      } catch (const InvalidParameter& error) {
        fail(key_node, prefix + "/" + error.what());
      }
      set_.push_back(field->address);
    }
    return is_known;
  }

  bool setDictionary(const std::string& prefix, const Lists& lists, const std::string& key,
                     const YAML::Node& value) {
    for (const FieldList* list : lists) {
      for (const FieldDictionary& dictionary : list->dictionaries()) {
        if (key != dictionary.name) continue;
        const std::string path = prefix + "/" + key;
        forEachKey(value, path,
                   [&](const std::string& name, const YAML::Node&, const YAML::Node& parameters) {
                     const FieldList entry = dictionary.entry(name);
                     readValues(path + "/" + name, {&entry}, parameters);
                   });
        return true;
      }
    }
    return false;
  }

  /// @throws InvalidParameter
  static void setValue(const Field& field, const YAML::Node& value) {
    const auto refuse = [&field](const std::string& what) {
      throw InvalidParameter({field.name}, std::string(field.name) + " " + what);
    };
    refuseTag(field, value);
    switch (value.Type()) {
      case YAML::NodeType::Scalar: return setScalar(field, value.Scalar());
      case YAML::NodeType::Sequence: return setSequence(field, value);
      case YAML::NodeType::Map: return refuse("is a dictionary, must be a value");
      case YAML::NodeType::Undefined:
      case YAML::NodeType::Null: break;
    }
    if (!std::holds_alternative<std::monostate>(field.get())) refuse("has no value");
  }

  static void setScalar(const Field& field, const std::string& text) {
    const bool is_number = field.type == FieldType::kDouble || field.type == FieldType::kInt;
    if (is_number && (text.rfind("deg(", 0) == 0 || text.rfind("rad(", 0) == 0)) {
      throw InvalidParameter({field.name},
                             fmt::format("{} is '{}'; deg() and rad() are not read here, write "
                                         "the number{}{}",
                                         field.name, text, *field.unit == '\0' ? "" : " in ", field.unit));
    }
    field.setFromText(text);
  }

  static void setSequence(const Field& field, const YAML::Node& list) {
    std::vector<std::string> items;
    for (const YAML::Node& item : list) {
      refuseTag(field, item);
      if (!item.IsScalar())
        throw InvalidParameter({field.name}, fmt::format("{} holds more than single values", field.name));
      items.push_back(item.Scalar());
    }
    // Texts may hold commas, so they are not joined.
    if (field.type == FieldType::kIntList)
      field.setFromText(fmt::format("[{}]", fmt::join(items, ", ")));
    else
      field.set(items);
  }

  /// roslaunch converts what is marked as an angle in degrees, for example; nothing else may be read here.
  static void refuseTag(const Field& field, const YAML::Node& value) {
    const std::string& tag = value.Tag();
    const bool is_plain = tag.empty() || tag == "?" || tag == "!" || tag.rfind("tag:yaml.org,2002:", 0) == 0;
    if (!is_plain) {
      throw InvalidParameter({field.name}, fmt::format("{} has the tag {}; tags are not read here, write the "
                                                       "plain value",
                                                       field.name, tag));
    }
  }

  const std::string& path_;
  const std::vector<Section>& sections_;
  const ReportOwner& owner_;
  std::vector<const void*> set_;
};

}  // namespace

std::string didYouMean(const std::string& refusal, const std::string& nearest) {
  return nearest.empty() ? refusal : fmt::format("{}; did you mean {}?", refusal, nearest);
}

std::vector<const void*> readConfigFile(const std::string& path, const std::vector<Section>& sections,
                                        const ReportOwner& owner) {
  return Reader(path, sections, owner).read();
}

}  // namespace radar_dot::tools
