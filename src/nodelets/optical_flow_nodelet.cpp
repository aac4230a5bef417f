// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/optical_flow_nodelet.h"

#include <algorithm>
#include <cmath>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>
#include <utility>

#include "nodelets/common/process_clock.h"
#include "nodelets/common/read_parameters.h"
#include "radar_dot/vision/motion_segmentation.h"
#include "radar_dot/vision/rigid_motion.h"

namespace radar_dot {
namespace {

constexpr double kWaitingPeriod = 0.02;    // s, how often a waiting pair is looked at
constexpr double kNext = 1e-4;             // s; a pair is computed after the messages that wait already
constexpr std::uint32_t kImageQueue = 10;  // what is too much is seen, and counted, instead of lost before
constexpr std::uint32_t kDepthQueue = 30;  // those that come while a pair is computed
constexpr double kTwistHold = 0.3;         // s that the latest twist holds; only start values depend on it
// Of the asked-for interval: images are not taken exactly in time.
constexpr double kIntervalTolerance = 0.1;

std::unique_ptr<OpticalFlow> flowOf(const OpticalFlowParams& params) {
  const auto& network = params.network;
  return made(params,
              {&params.backend, &network.model, &network.device, &network.threads, &params.network_width,
               &params.network_height},
              makeOpticalFlow);
}

}  // namespace

void OpticalFlowNodelet::setUp() {
  describe("flow", config_.stream);
  ros::NodeHandle& handle = getNodeHandle();
  // Without a source of rotation: its latest sample comes later than the image, and flow would wait for it.
  motion_ = std::make_unique<EgoMotion>(
      *extrinsics_, [this] { scheduleQueue(kNext); },
      [this](const std::string& text) { warn("rotation", text); }, true);
  image_ = &listenToImages(kImageQueue, [this](LazyImage picture) { onImage(std::move(picture)); });
  const auto wanted = [this] { return config_.flow.initialisation == FlowStart::kExpected; };
  depth_input_ = &listen<sensor_msgs::Image>("depth", kDepthQueue,
                                             [this](const sensor_msgs::ImageConstPtr& depth) {
                                               depths_.add(depth);
                                               scheduleQueue(kNext);
                                             },
                                             {true, wanted, [this] { depths_.clear(); }});
  camera_input_ = &listenToCamera(camera_, {true, wanted, {}});
  listenToTwists(*motion_, {true, wanted, [this] { motion_->forget(); }});
  publisher_ = handle.advertise<Flow>("flow", 3);
  backward_publisher_ = handle.advertise<Flow>("flow/backward", 3);
  compute_timer_ = ProcessTimer(
      handle, kNext, [this] { guard(*image_, [this] { processQueue(); }); }, ProcessTimer::Kind::kOnce);
}

bool OpticalFlowNodelet::hasAudience() const {
  return publisher_.getNumSubscribers() + backward_publisher_.getNumSubscribers() > 0;
}

void OpticalFlowNodelet::apply(const OpticalFlowConfig& config) {
  // A network takes seconds to load, and may fail to: then nothing has changed.
  if (!flow_ || !sameFields(config_.flow, config.flow)) flow_ = flowOf(config.flow);
  // The order of its images is that of the former direction.
  if (config_.direction != config.direction) waiting_.clear();
  config_ = config;
}

void OpticalFlowNodelet::clearHistory() {
  latest_.reset();
  previous_.reset();
  pace_ = {};
  waiting_.clear();
  depths_.clear();
  motion_->forget();
  if (flow_) flow_->reset();
}

void OpticalFlowNodelet::onImage(LazyImage picture) {
  const auto current = std::make_shared<LazyImage>(std::move(picture));
  // The sensor's noise makes any two pictures differ. A simulated camera has none.
  if (latest_ && current->repeats(*latest_) && !stands(current->header().stamp)) {
    if (flow_) pixelsOf(*current);  // what cannot be decoded is refused, however often it comes
    ++repeated_;
    ++repeated_since_report_;
    warn("repeated", "images on '" + image_->topic() + "' repeat the previous one under a new stamp");
    return;
  }
  latest_ = current;
  const double stamp = current->header().stamp.toSec();
  pace_.addImage(stamp, ProcessClock::now().toSec());
  const SharedImage before = previous_;
  if (!before) {
    previous_ = current;
    return;
  }
  const double interval = stamp - before->header().stamp.toSec();
  if (interval < leastInterval() * (1.0 - kIntervalTolerance)) return;
  interval_ = interval;
  previous_ = current;
  if (interval_ > config_.max_pair_gap) {
    ++apart_;
    if (flow_) flow_->reset();
    warn("gap", "images on '" + image_->topic() + "' " + std::to_string(interval_) +
                    " s apart are no pair (" + nameOf(config_, config_.max_pair_gap) + ")");
    return;
  }
  const bool forward = config_.direction == FlowDirection::kForward;
  waiting_.push_back({forward ? before : current, forward ? current : before, Moment::now()});
  // Who keeps up on the average makes up for a moment without a free core; else the latest pair is the one.
  const std::size_t most = pace_.load() < 1.0 ? 2 : 1;
  while (waiting_.size() > most) {
    // Who comes in place of a pair that waited has waited as long: else none might ever be computed.
    waiting_[1].arrival = waiting_[0].arrival;
    waiting_.pop_front();
    ++replaced_;
    pace_.addLost();
  }
  scheduleQueue(kNext);
}

bool OpticalFlowNodelet::stands(const ros::Time& stamp) const {
  constexpr double kSlow = 0.3;  // m/s, and rad/s 10 m away
  constexpr double kFar = 10.0;  // m
  std::string missing;
  const std::optional<StampedTwist> twist = motion_->velocityAt(stamp, kTwistHold, missing);
  return twist && twist->linear.norm() < kSlow && twist->angular.norm() * kFar < kSlow;
}

void OpticalFlowNodelet::scheduleQueue(double delay) {
  if (waiting_.empty()) return;
  // Its callback lines up behind what is in the queue: images that wait there already may replace the pair.
  compute_timer_.restart(delay);
}

cv::Mat OpticalFlowNodelet::expectedFlowOf(const Pair& pair, bool within_timeout, std::string& missing) {
  const std_msgs::Header& first = pair.first->header();
  const sensor_msgs::ImageConstPtr depth_message = depths_.find(first.stamp);
  if (!camera_) {
    missing = "nothing on '" + camera_input_->topic() + "' yet";
    return {};
  }
  if (!depth_message) {
    missing = "no message with the stamp of the image on '" + depth_input_->topic() + "'";
    return {};
  }
  const std::optional<Eigen::Isometry3d> T_base_from_camera =
      extrinsics_->lookupCamera(first.frame_id, missing);
  if (!T_base_from_camera) return {};
  const IntervalMotion motion =
      motion_->between(first.stamp, pair.second->header().stamp, kTwistHold, within_timeout);
  if (!motion.T_begin_from_end) {
    missing = motion.missing;
    return {};
  }
  const cv::Mat depth = radar_dot::depthOf(*depth_message);
  const CameraIntrinsics camera = cameraOf(*camera_);
  if (!isGridOf(depth.size(), {camera.width, camera.height})) {
    throw std::invalid_argument("depth on '" + depth_input_->topic() + "' of " + sizeText(depth.size()) +
                                " px does not have the shape of camera_info");
  }
  return expectedFlow(camera.scaledTo(depth.cols, depth.rows),
                      staticPointMotion(*T_base_from_camera, *motion.T_begin_from_end), depth);
}

void OpticalFlowNodelet::processQueue() {
  if (waiting_.empty()) return;
  const Pair pair = waiting_.front();
  cv::Mat expected;
  if (config_.flow.initialisation == FlowStart::kExpected) {
    const bool within_timeout = pair.arrival.waits(config_.expected_timeout, Moment::now());
    std::string missing;
    bool may_come = within_timeout && !depths_.isPast(pair.first->header().stamp);
    try {
      expected = expectedFlowOf(pair, within_timeout, missing);
    } catch (const std::exception& error) {
      missing = error.what();
      may_come = false;
    }
    if (expected.empty() && may_come) {
      scheduleQueue(kWaitingPeriod);
      return;
    }
    if (expected.empty()) {
      ++without_start_;
      warn("expected", "no initial flow: " + missing);
    }
  }
  waiting_.pop_front();
  scheduleQueue(kNext);
  compute(pair, expected);
}

const cv::Mat& OpticalFlowNodelet::pixelsOf(LazyImage& picture) const {
  return flow_->takesGreyGrid() ? picture.onGrid(config_.flow.working_width, kGrey) : picture.pixels();
}

void OpticalFlowNodelet::compute(const Pair& pair, const cv::Mat& expected) {
  if (!flow_) throw std::invalid_argument("no optical flow: " + server_->error());
  const ros::WallTime start = ProcessClock::now();
  const cv::Mat& first = pixelsOf(*pair.first);
  const cv::Mat& second = pixelsOf(*pair.second);
  const cv::Size size = pair.first->size();
  if (pair.second->size() != size) {
    throw std::invalid_argument("the images of a pair have " + sizeText(size) + " and " +
                                sizeText(pair.second->size()) + " px; they must agree");
  }
  waiting_time_ = start.toSec() - pair.arrival.wall;
  decoding_time_ = (ProcessClock::now() - start).toSec();
  const std_msgs::Header& first_header = pair.first->header();
  const std_msgs::Header& second_header = pair.second->header();
  const FlowField field = flow_->compute(first, second, expected);
  backward_time_ = ProcessClock::isRecorded() ? 0.0 : field.backward_seconds;
  // The way back goes first: who looks back from the next flow finds it there.
  if (config_.flow.forward_backward && backward_publisher_.getNumSubscribers() > 0) {
    backward_publisher_.publish(
        flowMessage(second_header, first_header.stamp, backwardField(field, config_.flow), size));
  }
  computation_time_ = (ProcessClock::now() - start).toSec();
  publisher_.publish(flowMessage(first_header, second_header.stamp, field, size));
  latency_ = since(std::max(pair.first->header().stamp, pair.second->header().stamp));
  const ros::WallTime end = ProcessClock::now();
  pace_.addPair(std::abs((second_header.stamp - first_header.stamp).toSec()), (end - start).toSec(),
                end.toSec());
  ++computed_;
  noteOutput();
}

void OpticalFlowNodelet::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  const int every = pace_.every(config_.pair_interval, config_.max_pair_gap);
  if (withoutOutput() > silentAfter() + config_.pair_interval) {
    status.summaryf(DiagnosticStatus::ERROR, "no flow for %.1f s", withoutOutput());
    if (interval_ > config_.max_pair_gap) {
      status.mergeSummaryf(DiagnosticStatus::ERROR, "images are %.2f s apart, more than %s (%.2f s)",
                           interval_, nameOf(config_, config_.max_pair_gap), config_.max_pair_gap);
    }
    if (repeated_since_report_ > 0) {
      status.mergeSummaryf(DiagnosticStatus::ERROR, "the last %zu images repeat the previous one",
                           repeated_since_report_);
    }
  } else if (repeated_since_report_ > 0) {
    status.summaryf(DiagnosticStatus::WARN, "%zu images repeat the previous one, and are left out",
                    repeated_since_report_);
  } else if (every > 1) {
    status.summaryf(DiagnosticStatus::WARN, "too slow for every image: pairs of every %d%s", every,
                    every == 2   ? "nd"
                    : every == 3 ? "rd"
                                 : "th");
  } else if (without_start_ > 0) {
    status.summaryf(DiagnosticStatus::WARN, "%zu pairs without an initial flow", without_start_);
  } else {
    status.summary(DiagnosticStatus::OK, "computing");
  }
  status.addf("interval of the pair (s)", "%.3f", interval_);
  status.addf("computation time (ms)", "%.1f", 1e3 * computation_time_);
  status.addf("of it decoding (ms)", "%.1f", 1e3 * decoding_time_);
  status.addf("of it the way back (ms)", "%.1f", 1e3 * backward_time_);
  status.addf("share of the time between pairs", "%.2f", pace_.load());
  status.addf("pairs of every ... image", "%d", every);
  status.addf("waiting before (ms)", "%.1f", 1e3 * waiting_time_);
  status.addf("latency (ms)", "%.1f", 1e3 * latency_);
  status.addf("pairs", "%zu", computed_);
  status.addf("pairs replaced by later ones", "%zu", replaced_);
  status.addf("images too far apart", "%zu", apart_);
  status.addf("images repeated", "%zu", repeated_);
  without_start_ = repeated_since_report_ = 0;
}

}  // namespace radar_dot

PLUGINLIB_EXPORT_CLASS(radar_dot::OpticalFlowNodelet, nodelet::Nodelet)
