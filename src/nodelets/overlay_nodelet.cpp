// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/overlay_nodelet.h"

#include <algorithm>
#include <cmath>
#include <pluginlib/class_list_macros.hpp>
#include <stdexcept>
#include <utility>

namespace radar_dot {
namespace {

constexpr double kPeriod = 0.05;        // s, how often subscribers and waiting masks are looked at
constexpr double kInputTimeout = 0.3;   // s that a mask waits for what belongs to it
constexpr std::size_t kMaxWaiting = 4;  // masks
constexpr double kKept = 2.0;           // s of images: as long as the other inputs are kept
constexpr std::size_t kMaxKept = 40;    // images; raw ones are large
constexpr double kPanelShape = 9.0 / 16.0;
constexpr float kNearest = 0.1F;  // m; what is nearer to the camera's plane has no useful pixel

}  // namespace

void OverlayNodelet::onInit() {
  const GivenConfig<OverlayConfig> given = readConfig<OverlayConfig>(getPrivateNodeHandle());
  config_ = given.config;
  setUp("overlay", config_.stream);
  ros::NodeHandle& handle = getNodeHandle();
  extrinsics_ = std::make_unique<Extrinsics>(config_.stream.base_frame, handle);
  motion_ = std::make_unique<EgoMotion>(
      *extrinsics_, [] {}, [this](const std::string& text) { warn("rotation", text); });
  const auto warn_of_sensor = [this](const std::string& text) { warn("sensor", text); };
  static_returns_ = std::make_unique<RecentClouds>(*extrinsics_, *motion_, warn_of_sensor);
  dynamic_returns_ = std::make_unique<RecentClouds>(*extrinsics_, *motion_, warn_of_sensor);

  // As long as images are kept; what comes later has nothing to be drawn on.
  valids_ = depths_ = expected_flows_ = StampCache<sensor_msgs::Image>(kKept);
  flows_ = StampCache<Flow>(kKept);

  image_ = &addInput("image");
  camera_input_ = &addInput("camera_info");
  mask_input_ = &addInput("dynamic/mask");
  valid_input_ = &addInput("dynamic/valid");
  depth_input_ = &addInput("depth");
  flow_input_ = &addInput("flow");
  expected_input_ = &addInput("dynamic/expected_flow");
  twist_input_ = &addInput("ego/twist", false);
  static_input_ = &addInput("radar/static", false);
  dynamic_input_ = &addInput("radar/dynamic", false);

  checkTransport();
  transport_ = std::make_unique<image_transport::ImageTransport>(handle);
  mask_publisher_ = transport_->advertise("overlay/mask", 2);
  panels_publisher_ = transport_->advertise("overlay/six_panel", 2);
  serve<OverlayConfig>(given, [this](const OverlayConfig& config) { config_ = config; });
  timer_ = handle.createWallTimer(ros::WallDuration(kPeriod), [this](const ros::WallTimerEvent&) {
    attempt([this] { updateSubscriptions(); });
    guard(*mask_input_, [this] { processQueue(); });
  });
}

void OverlayNodelet::updateSubscriptions() {
  const bool wanted = maskWanted() || panelsWanted();
  if (wanted == listening_ && panelsWanted() == listening_for_panels_) return;
  disconnect();
  listening_ = wanted;
  listening_for_panels_ = panelsWanted();
  if (wanted) connect();
}

void OverlayNodelet::connect() {
  using sensor_msgs::Image;
  const auto keep = [this](StampCache<Image>& cache) {
    return [this, &cache](const sensor_msgs::ImageConstPtr& message) {
      cache.add(message);
      processQueue();
    };
  };
  subscribers_.push_back(
      listenToImages(*image_, 3, [this](LazyImage picture) { keepImage(std::move(picture)); }));
  subscribers_.push_back(listen<Image>(*mask_input_, "dynamic/mask", 3,
                                       [this](const sensor_msgs::ImageConstPtr& mask) { onMask(mask); }));
  subscribers_.push_back(listen<Image>(*valid_input_, "dynamic/valid", 3, keep(valids_)));
  if (!listening_for_panels_) return;
  subscribers_.push_back(listen<Image>(*depth_input_, "depth", 5, keep(depths_)));
  subscribers_.push_back(listen<Image>(*expected_input_, "dynamic/expected_flow", 3, keep(expected_flows_)));
  subscribers_.push_back(listen<Flow>(*flow_input_, "flow", 3, [this](const FlowConstPtr& flow) {
    flows_.add(flow);
    processQueue();
  }));
  subscribers_.push_back(listenToCamera(*camera_input_, camera_));
  subscribers_.push_back(listenToTwists(*twist_input_, *motion_));
  subscribers_.push_back(listenToClouds(*static_input_, "radar/static", *static_returns_));
  subscribers_.push_back(listenToClouds(*dynamic_input_, "radar/dynamic", *dynamic_returns_));
}

void OverlayNodelet::disconnect() {
  subscribers_.clear();
  for (InputMonitor* input : {image_, camera_input_, mask_input_, valid_input_, depth_input_, flow_input_,
                              expected_input_, twist_input_, static_input_, dynamic_input_}) {
    input->setTopic({});
    input->reset();
  }
  clearHistory();
}

void OverlayNodelet::clearHistory() {
  waiting_.clear();
  images_.clear();
  for (StampCache<sensor_msgs::Image>* cache : {&valids_, &depths_, &expected_flows_}) cache->clear();
  flows_.clear();
  static_returns_->clear();
  dynamic_returns_->clear();
  motion_->forget();
}

void OverlayNodelet::keepImage(LazyImage picture) {
  const ros::Time stamp = picture.header().stamp;
  images_.push_back({stamp, std::make_shared<LazyImage>(std::move(picture))});
  while (images_.size() > kMaxKept || (stamp - images_.front().stamp).toSec() > kKept) images_.pop_front();
  processQueue();
}

void OverlayNodelet::onMask(const sensor_msgs::ImageConstPtr& mask) {
  const ros::WallTime now = ros::WallTime::now();
  if (config_.max_rate > 0.0 && (now - last_drawn_).toSec() < 1.0 / config_.max_rate) return;
  last_drawn_ = now;
  waiting_.push_back({mask, Moment::now()});
  processQueue();
}

OverlayNodelet::Parts OverlayNodelet::partsAt(const ros::Time& stamp) const {
  Parts parts;
  for (const KeptImage& kept : images_)
    if (kept.stamp == stamp) parts.image = kept.picture;
  parts.valid = valids_.find(stamp);
  if (!listening_for_panels_) return parts;
  parts.depth = depths_.find(stamp);
  parts.flow = flows_.find(stamp);
  parts.expected_flow = expected_flows_.find(stamp);
  return parts;
}

std::string OverlayNodelet::missingOf(const Parts& parts) const {
  std::string missing;
  const auto note = [&missing](bool there, const InputMonitor& input) {
    if (!there) missing += (missing.empty() ? "'" : ", '") + input.topic() + "'";
  };
  note(parts.image != nullptr, *image_);
  note(parts.valid != nullptr, *valid_input_);
  if (!listening_for_panels_) return missing;
  note(parts.depth != nullptr, *depth_input_);
  note(parts.flow != nullptr, *flow_input_);
  note(parts.expected_flow != nullptr, *expected_input_);
  return missing;
}

void OverlayNodelet::processQueue() {
  while (!waiting_.empty()) {
    const WaitingMask mask = waiting_.front();
    const Parts parts = partsAt(mask.message->header.stamp);
    const std::string missing = missingOf(parts);
    const bool within_timeout = mask.arrival.waits(kInputTimeout, Moment::now());
    if (!missing.empty() && within_timeout && waiting_.size() <= kMaxWaiting) return;
    waiting_.pop_front();
    if (!missing.empty()) {
      ++incomplete_since_report_;
      missing_ = missing;
      warn("missing", "nothing with the stamp of the mask on " + missing);
    }
    draw(mask.message, parts);
  }
}

std::vector<RadarPixel> OverlayNodelet::radarPixels(const std_msgs::Header& header) {
  std::vector<RadarPixel> pixels;
  std::string missing;
  const std::optional<Eigen::Isometry3d> T_base_from_camera = extrinsics_->lookup(header.frame_id, missing);
  if (!T_base_from_camera || !camera_) return pixels;
  const CameraIntrinsics camera = cameraOf(*camera_);
  const Eigen::Isometry3f T_camera_from_base = T_base_from_camera->inverse().cast<float>();
  for (RecentClouds* clouds : {static_returns_.get(), dynamic_returns_.get()}) {
    for (const CloudPoint& point : clouds->at(header.stamp, config_.radar_max_age)) {
      const Eigen::Vector3f position = T_camera_from_base * point.position;
      if (position.z() < kNearest) continue;
      const Eigen::Vector2d pixel = camera.project(position.cast<double>());
      pixels.push_back({{static_cast<float>(pixel.x()), static_cast<float>(pixel.y())},
                        position.z(),
                        std::isnan(point.residual) ? 0.0F : point.residual,
                        clouds == dynamic_returns_.get()});
    }
  }
  return pixels;
}

void OverlayNodelet::draw(const sensor_msgs::ImageConstPtr& message, const Parts& parts) {
  if (!parts.image) return;  // there is nothing to draw on
  const ros::WallTime start = ros::WallTime::now();
  const std_msgs::Header& header = message->header;
  // The masks stay in their messages, which outlive this function.
  const DecodedImage mask = decodedImageOf(message);
  const DecodedImage valid = parts.valid ? decodedImageOf(parts.valid) : DecodedImage{};
  const cv::Mat& image = parts.image->pixels();
  if (maskWanted()) {
    mask_publisher_.publish(imageMessage(header, "bgr8", overlayMask(image, mask.pixels, valid.pixels)));
  }
  if (panelsWanted()) {
    SixPanelInput input;
    input.image = image;
    input.mask = mask.pixels;
    input.valid = valid.pixels;
    if (parts.depth) input.depth = radar_dot::depthOf(*parts.depth);
    if (parts.flow) input.observed_flow = radar_dot::flowOf(*parts.flow).flow;
    if (parts.expected_flow) input.expected_flow = flowImageOf(*parts.expected_flow);
    input.radar = radarPixels(header);
    input.max_flow = config_.max_flow;
    input.max_residual = config_.max_residual;
    input.max_depth = config_.max_drawn_depth;
    input.panel = {config_.panel_width, static_cast<int>(std::lround(config_.panel_width * kPanelShape))};
    panels_publisher_.publish(imageMessage(header, "bgr8", sixPanel(input)));
  }
  drawing_time_ = (ros::WallTime::now() - start).toSec();
  ++drawn_;
}

void OverlayNodelet::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  if (!listening_) {
    status.summary(DiagnosticStatus::OK, "idle: no subscribers");
  } else if (incomplete_since_report_ > 0) {
    status.summary(DiagnosticStatus::WARN,
                   "incomplete pictures: nothing with the stamp of the mask on " + missing_);
  } else {
    status.summary(DiagnosticStatus::OK, "drawing");
  }
  status.addf("drawing time (ms)", "%.1f", 1e3 * drawing_time_);
  status.addf("pictures", "%zu", drawn_);
  incomplete_since_report_ = 0;
}

}  // namespace radar_dot

PLUGINLIB_EXPORT_CLASS(radar_dot::OverlayNodelet, nodelet::Nodelet)
