// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "config/config_file.h"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <cerrno>
#include <fstream>
#include <functional>
#include <ios>
#include <iterator>
#include <map>
#include <set>
#include <sstream>
#include <system_error>

#include "radar_dot/common/did_you_mean.h"

namespace radar_dot {
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

/// YAML::LoadAll takes a comma where a document should begin for a document, and again, until there is no
/// memory left. Here it is refused.
class DocumentStarts : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override {
    if (mark.pos == last_) throw YAML::ParserException(mark, "no document begins here");
    last_ = mark.pos;
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark&, YAML::anchor_t) override {}
  void OnAlias(const YAML::Mark&, YAML::anchor_t) override {}
  void OnScalar(const YAML::Mark&, const std::string&, YAML::anchor_t, const std::string&) override {}
  void OnSequenceStart(const YAML::Mark&, const std::string&, YAML::anchor_t,
                       YAML::EmitterStyle::value) override {}
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark&, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
  }
  void OnMapEnd() override {}

 private:
  int last_ = -1;
};

/// @throws YAML::Exception
std::vector<YAML::Node> documentsOf(const std::string& text) {
  std::istringstream stream(text);
  YAML::Parser parser(stream);
  DocumentStarts starts;
  while (parser.HandleNextDocument(starts)) continue;
  return YAML::LoadAll(text);
}

[[noreturn]] void refuse(const Field& field, const std::string& what) {
  throw InvalidParameter({field.name}, fmt::format("{} {}", field.name, what));
}

/// What is written here without quotes is no text for roslaunch, which a nodelet then refuses.
void refuseOtherType(const Field& field, const YAML::Node& value) {
  if ((field.type != FieldType::kText && field.type != FieldType::kTextList) || value.Tag() != "?") return;
  double number = 0.0;
  bool is = false;
  const std::string& text = value.Scalar();
  if (YAML::convert<double>::decode(value, number) ||
      (text.size() > 1 && YAML::convert<bool>::decode(value, is)))
    refuse(field, fmt::format("is {} without quotes, must be {}", text, field.typeText()));
}

/// roslaunch converts what is marked as an angle in degrees, for example; nothing else may be read here.
void refuseTag(const Field& field, const YAML::Node& value) {
  const std::string& tag = value.Tag();
  if (!tag.empty() && tag != "?" && tag != "!" && tag.rfind("tag:yaml.org,2002:", 0) != 0)
    refuse(field, fmt::format("has the tag {}; tags are not read here, write the plain value", tag));
}

void setScalar(const Field& field, const YAML::Node& value) {
  refuseOtherType(field, value);
  const std::string& text = value.Scalar();
  const bool is_number = field.type == FieldType::kDouble || field.type == FieldType::kInt;
  if (is_number && (text.rfind("deg(", 0) == 0 || text.rfind("rad(", 0) == 0)) {
    refuse(field, fmt::format("is '{}'; deg() and rad() are not read here, write the number{}{}", text,
                              *field.unit == '\0' ? "" : " in ", field.unit));
  }
  field.setFromText(text);
}

void setSequence(const Field& field, const YAML::Node& list) {
  std::vector<std::string> items;
  for (const YAML::Node& item : list) {
    refuseTag(field, item);
    if (!item.IsScalar()) refuse(field, "holds more than single values");
    refuseOtherType(field, item);
    items.push_back(item.Scalar());
  }
  field.setFromItems(items);
}

/// @throws InvalidParameter
void setValue(const Field& field, const YAML::Node& value) {
  refuseTag(field, value);
  if (value.IsScalar()) return setScalar(field, value);
  if (value.IsSequence()) return setSequence(field, value);
  if (value.IsMap()) refuse(field, "is a dictionary, must be a value");
  if (!std::holds_alternative<std::monostate>(field.get())) refuse(field, "has no value");
}

class Reader {
 public:
  Reader(const std::string& path, const std::vector<Section>& sections, const std::string& tool,
         const FieldList& options)
      : path_(path), sections_(sections), tool_(tool), options_(options) {}

  std::map<const void*, std::string> read() {
    forEachDocument([this](const YAML::Node& document) { readDocument(document); });
    return std::move(set_);
  }

  /// Names and values without sections.
  void readOptions() {
    forEachDocument([this](const YAML::Node& document) { readValues("", options_, document); });
  }

  void readEntries(const FieldDictionary& dictionary) {
    forEachDocument([&](const YAML::Node& document) { readEntries("", dictionary, document); });
  }

  void readList(const std::function<FieldList()>& next) {
    forEachDocument([&](const YAML::Node& document) {
      if (!document.IsSequence()) fail(document, "the file is no list");
      for (const YAML::Node& entry : document) {
        if (!entry.IsMap()) fail(entry, "an entry of the list is no dictionary of names and values");
        readValues("", next(), entry);
      }
    });
  }

 private:
  /// Several documents in one file are loaded one after the other, as by rosparam.
  void forEachDocument(const std::function<void(const YAML::Node&)>& read) const {
    const std::string text = contentOf(path_);
    try {
      for (const YAML::Node& document : documentsOf(text)) read(document);
    } catch (const YAML::Exception& error) {
      throw ConfigFileError(fmt::format("{}:{}: not valid YAML: {}", path_, error.mark.line + 1, error.msg));
    }
  }

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
    const bool is_report = root.IsMap() && root[kReportKey];
    const YAML::Node& parameters = is_report ? root[kReportKey] : root;
    // Before names that another tool does not know are found to be wrong.
    if (is_report && parameters.IsMap() && parameters[kToolKey]) {
      const YAML::Node tool = parameters[kToolKey];
      const std::string name = tool.IsScalar() ? tool.Scalar() : "no tool known";
      if (!tool.IsScalar() || name != tool_)
        fail(tool, fmt::format("the report is of {}, not of {}", name, tool_));
    }
    forEachKey(parameters, is_report ? kReportKey : "the file",
               [&](const std::string& key, const YAML::Node& key_node, const YAML::Node& value) {
                 if (is_report && key == kToolKey) return;
                 readValues(key, is_report && key == kOptionsKey ? options_ : sectionAt(key, key_node),
                            value);
               });
  }

  const FieldList& sectionAt(const std::string& key, const YAML::Node& key_node) const {
    std::vector<std::string> names;
    for (const Section& section : sections_) {
      if (key == section.name) return section.fields;
      names.emplace_back(section.name);
    }
    fail(key_node, "unknown section " + key + didYouMean(nearestName(key, names)));
  }

  /// @param prefix  of the names; empty: the file has no sections
  void readValues(const std::string& prefix, const FieldList& fields, const YAML::Node& values) {
    forEachKey(values, prefix.empty() ? "the file" : prefix,
               [&](const std::string& key, const YAML::Node& key_node, const YAML::Node& value) {
                 const std::string path = pathOf(prefix, key);
                 bool is_known = setFields(prefix, fields, key, key_node, value);
                 for (const FieldDictionary& dictionary : fields.dictionaries()) {
                   if (is_known || key != dictionary.name) continue;
                   is_known = true;
                   readEntries(path, dictionary, value);
                 }
                 if (!is_known)
                   fail(key_node, "unknown parameter " + path + didYouMean(fields.nearestName(key)));
               });
  }

  void readEntries(const std::string& prefix, const FieldDictionary& dictionary, const YAML::Node& entries) {
    forEachKey(entries, prefix.empty() ? "the file" : prefix,
               [&](const std::string& name, const YAML::Node&, const YAML::Node& parameters) {
                 readValues(pathOf(prefix, name), dictionary.entry(name), parameters);
               });
  }

  static std::string pathOf(const std::string& prefix, const std::string& name) {
    return prefix.empty() ? name : prefix + "/" + name;
  }

  /// Several fields of one name are set together. @return is there one?
  bool setFields(const std::string& prefix, const FieldList& fields, const std::string& key,
                 const YAML::Node& key_node, const YAML::Node& value) {
    bool is_known = false;
    for (const Field& field : fields) {
      if (key != field.name) continue;
      is_known = true;
      try {
        setValue(field, value);
      } catch (const InvalidParameter& error) {
        fail(key_node, pathOf(prefix, error.what()));
      }
      set_[field.address] = fmt::format("{}:{}", path_, key_node.Mark().line + 1);
    }
    return is_known;
  }

  const std::string& path_;
  const std::vector<Section>& sections_;
  const std::string& tool_;
  const FieldList& options_;
  std::map<const void*, std::string> set_;
};

}  // namespace

std::map<const void*, std::string> readConfigFile(const std::string& path,
                                                  const std::vector<Section>& sections,
                                                  const std::string& tool, const FieldList& options) {
  return Reader(path, sections, tool, options).read();
}

void readFieldsFile(const std::string& path, const FieldList& fields) {
  Reader(path, {}, "", fields).readOptions();
}

void readDictionaryFile(const std::string& path, const FieldDictionary& dictionary) {
  Reader(path, {}, "", {}).readEntries(dictionary);
}

void readListFile(const std::string& path, const std::function<FieldList()>& next) {
  Reader(path, {}, "", {}).readList(next);
}

}  // namespace radar_dot
