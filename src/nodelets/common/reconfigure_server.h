// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dynamic_reconfigure/Reconfigure.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <ros/service_callback_helper.h>
#include <ros/service_server.h>

#include <functional>
#include <string>
#include <string_view>
#include <utility>

#include "nodelets/common/read_parameters.h"
#include "radar_dot/common/fields.h"

namespace radar_dot {

/// Does a caller of set_parameters end for good where a call fails? rqt_reconfigure sends its changes from a
/// thread that an error ends; then the sliders move without any effect. It gets what is in force instead.
/// @param node  full name of the caller's node
bool failsWithItsCalls(std::string_view node);

/// The parameters of a running nodelet, for the clients of dynamic_reconfigure: rqt_reconfigure, dynparam.
///
/// A request is accepted as a whole, or it changes nothing: then the service call fails with what is wrong,
/// or, for a caller that fails with its calls, answers with what is in force.
/// Callbacks run in the queue of the node handle; everything else is called from the same thread.
class ReconfigureServerBase {
 public:
  virtual ~ReconfigureServerBase() = default;
  ReconfigureServerBase(const ReconfigureServerBase&) = delete;
  ReconfigureServerBase& operator=(const ReconfigureServerBase&) = delete;

  /// False: not even the defaults could be applied. A later change may succeed.
  bool usable() const noexcept { return usable_; }
  /// What was wrong at start, for diagnostics; of what can change, until a change has succeeded.
  std::string error() const { return problems_.text(); }
  /// The latest refused change whose caller was not told so, until one succeeds; empty: none.
  const std::string& refusal() const noexcept { return refusal_; }
  /// Does the parameter still have its default because what was given at start was refused?
  bool refusedAtStart(std::string_view name) const { return problems_.concern(name); }

 protected:
  using Write = std::function<void(const FieldList&)>;

  ReconfigureServerBase(const ros::NodeHandle& private_handle, ParameterProblems problems);

  virtual FieldList inForce() = 0;
  /// Of a configuration with the default values.
  virtual FieldList defaults() = 0;
  virtual void applyInForce() = 0;
  /// Applies a copy of the configuration with other values. @throws std::exception, then nothing has changed
  virtual void change(const Write& write) = 0;

  void start();
  void stop();

 private:
  using Call = ros::ServiceEvent<dynamic_reconfigure::Reconfigure::Request,
                                 dynamic_reconfigure::Reconfigure::Response>;
  bool set(Call& call);
  void store(const Field& field);

  ros::NodeHandle handle_;
  ParameterProblems problems_;
  bool usable_ = false;
  std::string refusal_;
  ros::Publisher descriptions_, updates_;
  ros::ServiceServer service_;
};

/// Config has `void describe(FieldList&)`, and validate(const Config&) where there are rules between its
/// fields.
template <typename Config>
class ReconfigureServer final : public ReconfigureServerBase {
 public:
  using Apply = std::function<void(const Config&)>;

  /// @param apply  puts a valid configuration into force, now and after each change; throws before it changes
  ///               anything. Parameters it refuses now fall back to their defaults.
  ReconfigureServer(const ros::NodeHandle& private_handle, const GivenConfig<Config>& given, Apply apply)
      : ReconfigureServerBase(private_handle, given.problems),
        config_(given.config),
        apply_(std::move(apply)) {
    start();
  }
  ~ReconfigureServer() override { stop(); }

  /// In force.
  const Config& config() const noexcept { return config_; }

 private:
  FieldList inForce() override { return fieldsOf(config_); }
  FieldList defaults() override { return fieldsOf(defaults_); }
  void applyInForce() override {
    validateConfig(config_);
    apply_(config_);
  }
  void change(const Write& write) override {
    Config changed = config_;
    write(fieldsOf(changed));
    validateConfig(changed);
    apply_(changed);
    config_ = std::move(changed);
  }

  Config defaults_, config_;
  Apply apply_;
};

}  // namespace radar_dot
