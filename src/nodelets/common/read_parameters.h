// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <XmlRpcValue.h>
#include <ros/node_handle.h>

#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "radar_dot/common/fields.h"

// The parameters of a nodelet from the parameter server. One bad value does not take the good ones with it,
// and none ends the process: what is refused has its default, and is reported.

namespace radar_dot {

/// What was wrong with the parameters that were given at start.
struct ParameterProblems {
  std::vector<std::string> lines;  ///< one sentence each, with the full names
  /// Of the lines, those of parameters that are read at start only.
  std::vector<std::string> lasting_lines;
  /// Fields that have their defaults instead of what was given; "radars/front": an entry that was left out.
  std::vector<std::string> refused;

  void add(const std::string& line, bool lasting);
  /// After a valid change: what is read at start stays a problem, and what was not changed stays refused.
  void settle(const std::vector<std::string>& changed);
  bool concern(std::string_view name) const;
  /// All lines in one; empty: nothing is wrong.
  std::string text() const;
};

/// Writes what is given into the fields of these names. @param space  name of the namespace, for messages
void readFields(const XmlRpc::XmlRpcValue& given, const std::string& space, const FieldList& fields,
                ParameterProblems& problems);

/// One line for each name in the namespace that is not read: most often it is misspelt.
std::vector<std::string> unknownParameters(const XmlRpc::XmlRpcValue& given, const std::string& space,
                                           const FieldList& fields);

/// Repeats `attempt` until it succeeds. What throws InvalidParameter sends the fields that it names back to
/// their defaults; after another std::exception all that can change while the nodelet runs have them.
/// @return false: it fails with the defaults too
bool fallBackUntil(const std::function<void()>& attempt, const std::string& space, const FieldList& fields,
                   const FieldList& defaults, ParameterProblems& problems);

/// A field as the parameter server holds it; invalid: it has no value.
XmlRpc::XmlRpcValue toXmlRpc(const Field& field);

/// Reads all fields from the namespace of the handle. Unknown names are warned of.
void readParameters(const ros::NodeHandle& private_handle, const FieldList& fields,
                    ParameterProblems& problems);

/// One error line for each problem from `first` on.
void logProblems(const ParameterProblems& problems, std::size_t first = 0);

/// The name of a parameter, for messages. @param member  of the configuration
template <typename Config, typename Member>
const char* nameOf(const Config& config, const Member& member) {
  return fieldsOf(config).of(&member).name;
}

template <typename Config>
std::vector<std::string> namesOf(const Config& config, const std::vector<const void*>& members) {
  const FieldList fields = fieldsOf(config);
  std::vector<std::string> names;
  for (const void* member : members) names.emplace_back(fields.of(member).name);
  return names;
}

/// What `make()` makes of the parameters. @throws InvalidParameter for whatever goes wrong, naming the
/// members that choose what is made where it does not name any itself
template <typename Params, typename Make>
auto made(const Params& params, const std::vector<const void*>& members, const Make& make) {
  try {
    return make(params);
  } catch (const InvalidParameter&) {
    throw;
  } catch (const std::exception& error) {
    throw InvalidParameter(namesOf(params, members), error.what());
  }
}

/// Why nothing can be subscribed by this name; empty: it can.
std::string topicDefect(const ros::NodeHandle& handle, const std::string& topic);

template <typename Config, typename = void>
struct HasRules : std::false_type {};
template <typename Config>
struct HasRules<Config, std::void_t<decltype(validate(std::declval<const Config&>()))>> : std::true_type {};

/// Checks the fields, and by validate(const Config&) the rules between them where there are any.
/// @throws InvalidParameter
template <typename Config>
void validateConfig(const Config& config) {
  if constexpr (HasRules<Config>::value)
    validate(config);
  else
    validateFields(config);
}

/// A configuration as it was given, as far as it is valid.
template <typename Config>
struct GivenConfig {
  Config config;
  ParameterProblems problems;
};

/// Reads and validates a configuration, and logs what is wrong with it.
template <typename Config>
GivenConfig<Config> readConfig(const ros::NodeHandle& private_handle) {
  GivenConfig<Config> given;
  Config defaults;
  const FieldList fields = fieldsOf(given.config);
  readParameters(private_handle, fields, given.problems);
  fallBackUntil([&given] { validateConfig(given.config); }, private_handle.getNamespace(), fields,
                fieldsOf(defaults), given.problems);
  logProblems(given.problems);
  return given;
}

}  // namespace radar_dot
