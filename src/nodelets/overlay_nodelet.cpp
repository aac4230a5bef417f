// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "nodelets/overlay_nodelet.h"

#include <cmath>
#include <pluginlib/class_list_macros.hpp>
#include <utility>

#include "nodelets/common/process_clock.h"

namespace radar_dot {
namespace {

constexpr double kInputTimeout = 0.3;  // s that a mask waits for what belongs to it
constexpr double kKept = 2.0;          // s of images: as long as the other inputs are kept
constexpr std::size_t kMaxKept = 40;   // images; raw ones are large
constexpr double kPanelShape = 9.0 / 16.0;
constexpr float kNearest = 0.1F;  // m; what is nearer to the camera's plane has no useful pixel

}  // namespace

void OverlayNodelet::setUp() {
  describe("overlay", config_.stream);
  motion_ = std::make_unique<EgoMotion>(
      *extrinsics_, [] {}, [this](const std::string& text) { warn("rotation", text); });
  const auto warn_of_sensor = [this](const std::string& text) { warn("sensor", text); };
  static_returns_ = std::make_unique<RecentClouds>(*extrinsics_, *motion_, warn_of_sensor);
  dynamic_returns_ = std::make_unique<RecentClouds>(*extrinsics_, *motion_, warn_of_sensor);

  // As long as images are kept; what comes later has nothing to be drawn on.
  valids_ = depths_ = expected_flows_ = StampCache<sensor_msgs::Image>(kKept);
  flows_ = StampCache<Flow>(kKept);
  listenToInputs();
  transport_ = std::make_unique<image_transport::ImageTransport>(getNodeHandle());
  mask_publisher_ = transport_->advertise("overlay/mask", 2);
  panels_publisher_ = transport_->advertise("overlay/six_panel", 2);
}

void OverlayNodelet::listenToInputs() {
  using sensor_msgs::Image;
  const auto keep = [this](StampCache<Image>& cache) {
    return [this, &cache](const sensor_msgs::ImageConstPtr& message) {
      cache.add(message);
      processQueue();
    };
  };
  const auto panels = [this] { return panelsWanted(); };
  image_ = &listenToImages(3, [this](LazyImage picture) { keepImage(std::move(picture)); });
  mask_input_ =
      &listen<Image>("dynamic/mask", 3, [this](const sensor_msgs::ImageConstPtr& mask) { onMask(mask); });
  valid_input_ = &listen<Image>("dynamic/valid", 3, keep(valids_));
  depth_input_ = &listen<Image>("depth", 5, keep(depths_), {true, panels, {}});
  expected_input_ = &listen<Image>("dynamic/expected_flow", 3, keep(expected_flows_), {true, panels, {}});
  flow_input_ = &listen<Flow>("flow", 3,
                              [this](const FlowConstPtr& flow) {
                                flows_.add(flow);
                                processQueue();
                              },
                              {true, panels, {}});
  listenToCamera(camera_, {true, panels, {}});
  listenToTwists(*motion_, {false, panels, {}});
  listenToClouds("radar/static", *static_returns_, {false, panels, {}});
  listenToClouds("radar/dynamic", *dynamic_returns_, {false, panels, {}});
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
  const ros::WallTime now = ProcessClock::now();
  if (config_.max_rate > 0.0 && (now - last_drawn_).toSec() < 1.0 / config_.max_rate) return;
  last_drawn_ = now;
  waiting_.add(mask, Moment::now());
  processQueue();
}

OverlayNodelet::Parts OverlayNodelet::partsAt(const ros::Time& stamp) const {
  Parts parts;
  for (const KeptImage& kept : images_)
    if (kept.stamp == stamp) parts.image = kept.picture;
  parts.valid = valids_.find(stamp);
  if (!listensForPanels()) return parts;
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
  if (!listensForPanels()) return missing;
  note(parts.depth != nullptr, *depth_input_);
  note(parts.flow != nullptr, *flow_input_);
  note(parts.expected_flow != nullptr, *expected_input_);
  return missing;
}

void OverlayNodelet::processQueue() {
  using Queue = WaitingQueue<sensor_msgs::ImageConstPtr>;
  const auto lackOf = [this](const sensor_msgs::ImageConstPtr& mask, double) -> Queue::Lack {
    return {missingOf(partsAt(mask->header.stamp))};
  };
  while (const std::optional<Queue::Taken> taken = waiting_.take(kInputTimeout, Moment::now(), lackOf)) {
    if (!taken->missing.empty()) {
      ++incomplete_since_report_;
      missing_ = taken->missing;
      warn("missing", "nothing with the stamp of the mask on " + missing_);
    }
    const ros::Time stamp = taken->item->header.stamp;
    draw(taken->item, partsAt(stamp));
    dropThrough(stamp);
  }
}

/// Masks come in the order of their stamps.
void OverlayNodelet::dropThrough(const ros::Time& stamp) {
  while (!images_.empty() && images_.front().stamp <= stamp) images_.pop_front();
  for (StampCache<sensor_msgs::Image>* cache : {&valids_, &depths_, &expected_flows_})
    cache->dropBefore(stamp);
  flows_.dropBefore(stamp);
}

std::vector<RadarPixel> OverlayNodelet::radarPixels(const std_msgs::Header& header) {
  std::vector<RadarPixel> pixels;
  std::string missing;
  const std::optional<Eigen::Isometry3d> T_base_from_camera =
      extrinsics_->lookupCamera(header.frame_id, missing);
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
  const ros::WallTime start = ProcessClock::now();
  const std_msgs::Header& header = message->header;
  // The masks stay in their messages, which outlive this function.
  const DecodedImage mask = decodedImageOf(message);
  const DecodedImage valid = parts.valid ? decodedImageOf(parts.valid) : DecodedImage{};
  if (panelsWanted()) {
    SixPanelInput input;
    input.image = parts.image->pixels();  // flows are drawn in its pixels
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
  if (maskWanted()) {
    const cv::Mat& image = parts.image->onGrid(config_.panel_width, kColour);
    mask_publisher_.publish(imageMessage(header, "bgr8", overlayMask(image, mask.pixels, valid.pixels)));
  }
  drawing_time_ = (ProcessClock::now() - start).toSec();
  ++drawn_;
}

void OverlayNodelet::report(diagnostic_updater::DiagnosticStatusWrapper& status) {
  using diagnostic_msgs::DiagnosticStatus;
  if (incomplete_since_report_ > 0) {
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
