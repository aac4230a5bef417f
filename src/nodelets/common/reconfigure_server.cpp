// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/common/reconfigure_server.h"

#include <dynamic_reconfigure/Config.h>
#include <dynamic_reconfigure/ConfigDescription.h>
#include <ros/console.h>

#include <algorithm>

#include "nodelets/common/reconfigure_messages.h"

namespace radar_dot {

bool failsWithItsCalls(std::string_view node) {
  constexpr std::string_view kTool = "rqt";
  const std::size_t slash = node.find_last_of('/');
  if (slash != std::string_view::npos) node.remove_prefix(slash + 1);
  return node.substr(0, kTool.size()) == kTool;
}

ReconfigureServerBase::ReconfigureServerBase(const ros::NodeHandle& private_handle,
                                             ParameterProblems problems)
    : handle_(private_handle), problems_(std::move(problems)) {}

void ReconfigureServerBase::start() {
  const std::size_t known = problems_.lines.size();
  usable_ =
      fallBackUntil([this] { applyInForce(); }, handle_.getNamespace(), inForce(), defaults(), problems_);
  logProblems(problems_, known);

  const FieldList fields = inForce();
  if (std::all_of(fields.begin(), fields.end(), [](const Field& field) { return field.at_start; })) return;
  // What was refused stays on the parameter server: the next start must not take the default for the wish.
  for (const Field& field : fields)
    if (!field.at_start && !refusedAtStart(field.name)) store(field);

  descriptions_ =
      handle_.advertise<dynamic_reconfigure::ConfigDescription>("parameter_descriptions", 1, true);
  descriptions_.publish(descriptionOf(defaults()));
  updates_ = handle_.advertise<dynamic_reconfigure::Config>("parameter_updates", 1, true);
  updates_.publish(messageOf(inForce()));
  service_ = handle_.advertiseService("set_parameters", &ReconfigureServerBase::set, this);
}

void ReconfigureServerBase::stop() { service_.shutdown(); }

bool ReconfigureServerBase::set(Call& call) {
  std::vector<std::string> names;
  try {
    change([&](const FieldList& fields) { names = writeRequest(call.getRequest().config, fields); });
  } catch (const std::exception& error) {
    ROS_ERROR("%s: rejected: %s; parameters unchanged", handle_.getNamespace().c_str(), error.what());
    call.getResponse().config = messageOf(inForce());
    // The client that asked shows what it asked for.
    updates_.publish(call.getResponse().config);
    if (!failsWithItsCalls(call.getCallerName())) throw;  // roscpp sends the text to the client
    refusal_ = error.what();
    return true;
  }
  usable_ = true;
  refusal_.clear();
  problems_.settle(names);
  const FieldList fields = inForce();
  for (const std::string& name : names) store(*fields.find(name));
  call.getResponse().config = messageOf(fields);
  updates_.publish(call.getResponse().config);
  return true;
}

void ReconfigureServerBase::store(const Field& field) {
  const XmlRpc::XmlRpcValue value = toXmlRpc(field);
  if (value.valid())
    handle_.setParam(field.name, value);
  else if (handle_.hasParam(field.name))
    handle_.deleteParam(field.name);
}

}  // namespace radar_dot
