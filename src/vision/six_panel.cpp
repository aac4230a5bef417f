// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

#include "drawing_parts.h"
#include "radar_dot/vision/drawing.h"

namespace radar_dot {
namespace {

/// What the six pictures are made of, none larger than a panel.
struct Prepared {
  cv::Mat image, mask, valid, residual, expected_flow, observed_flow, depth;
  double image_scale = 1.0;  ///< px of the small image per px of the whole one
  double max_flow = 0.0;     ///< px of the image
};

void requireTypes(const SixPanelInput& input) {
  const auto require = [](const cv::Mat& image, int type, const char* name) {
    if (!image.empty()) drawing::requireType(image, type, name);
  };
  if (input.image.type() != CV_8UC1) require(input.image, CV_8UC3, "image");
  require(input.mask, CV_8UC1, "mask");
  require(input.valid, CV_8UC1, "valid");
  require(input.expected_flow, CV_32FC2, "expected_flow");
  require(input.observed_flow, CV_32FC2, "observed_flow");
  require(input.residual, CV_32FC1, "residual");
  require(input.depth, CV_32FC1, "depth");
  drawing::requireScale(input.max_flow, true, "max_flow");
  drawing::requireScale(input.max_residual, true, "max_residual");
  drawing::requireScale(input.max_depth, false, "max_depth");
  if (input.panel.width < 64 || input.panel.height < 36)
    throw std::invalid_argument(
        fmt::format("panel is {}x{}: it must be 64x36 px or more", input.panel.width, input.panel.height));
}

/// The largest size of the image's aspect ratio that fits into the panel; a pixel of rounding is stretched.
cv::Size fittedSize(const cv::Size& image, const cv::Size& panel) {
  const double scale = std::min(panel.width / static_cast<double>(image.width),
                                panel.height / static_cast<double>(image.height));
  const auto side = [scale](int length, int limit) {
    const int fitted = std::clamp(cvRound(scale * length), 1, limit);
    return limit - fitted < 3 ? limit : fitted;
  };
  return {side(image.width, panel.width), side(image.height, panel.height)};
}

/// Exact halves as long as they are larger, which OpenCV does fast, then bilinear: as smooth as an area
/// average at a fraction of its time.
cv::Mat fitImage(const cv::Mat& image, const cv::Size& panel) {
  if (image.empty()) return {};
  const cv::Size size = fittedSize(image.size(), panel);
  cv::Mat fitted = image;
  while (fitted.cols >= 2 * size.width && fitted.rows >= 2 * size.height) {
    cv::Mat half;
    const cv::Rect even(0, 0, fitted.cols & ~1, fitted.rows & ~1);
    cv::resize(fitted(even), half, cv::Size(fitted.cols / 2, fitted.rows / 2), 0.0, 0.0, cv::INTER_AREA);
    fitted = half;
  }
  cv::Mat last;
  cv::resize(fitted, last, size, 0.0, 0.0, cv::INTER_LINEAR);
  if (last.channels() == 1) cv::cvtColor(last, last, cv::COLOR_GRAY2BGR);
  return last;
}

/// Values are not mixed: edges stay edges, and unknown pixels do not grow.
cv::Mat fitValues(const cv::Mat& values, const cv::Size& panel) {
  if (values.empty()) return {};
  cv::Mat fitted;
  cv::resize(values, fitted, fittedSize(values.size(), panel), 0.0, 0.0, cv::INTER_NEAREST);
  return fitted;
}

/// @param width  px, of the grid whose px the flow is wanted in
cv::Mat fitFlow(const cv::Mat& flow, const cv::Size& panel, int width) {
  cv::Mat fitted = fitValues(flow, panel);
  if (!fitted.empty() && flow.cols != width)
    fitted.convertTo(fitted, -1, width / static_cast<double>(flow.cols));
  return fitted;
}

cv::Mat differenceOf(const cv::Mat& first, const cv::Mat& second) {
  if (first.empty() || first.size() != second.size()) return {};
  cv::Mat difference(first.size(), CV_32FC1);
  for (int v = 0; v < first.rows; ++v) {
    const auto* a = first.ptr<cv::Vec2f>(v);
    const auto* b = second.ptr<cv::Vec2f>(v);
    auto* out = difference.ptr<float>(v);
    for (int u = 0; u < first.cols; ++u) {
      const float x = a[u][0] - b[u][0];
      const float y = a[u][1] - b[u][1];
      out[u] = std::sqrt(x * x + y * y);
    }
  }
  return difference;
}

Prepared prepare(const SixPanelInput& input) {
  const int flow_width = std::max(input.expected_flow.cols, input.observed_flow.cols);
  const int width = input.image.empty() ? flow_width : input.image.cols;
  Prepared small;
  small.image = fitImage(input.image, input.panel);
  if (!input.image.empty()) small.image_scale = small.image.cols / static_cast<double>(input.image.cols);
  small.mask = fitValues(input.mask, input.panel);
  small.valid = fitValues(input.valid, input.panel);
  small.depth = fitValues(input.depth, input.panel);
  small.expected_flow = fitFlow(input.expected_flow, input.panel, width);
  small.observed_flow = fitFlow(input.observed_flow, input.panel, width);
  small.residual = input.residual.empty() ? differenceOf(small.expected_flow, small.observed_flow)
                                          : fitValues(input.residual, input.panel);
  small.max_flow =
      input.max_flow > 0.0 ? input.max_flow : flowScale(small.expected_flow, small.observed_flow);
  return small;
}

std::vector<RadarPixel> pointsOn(const std::vector<RadarPixel>& points, double image_scale) {
  std::vector<RadarPixel> scaled = points;
  const auto scale = static_cast<float>(image_scale);
  for (RadarPixel& point : scaled) {
    point.pixel.x = (point.pixel.x + 0.5F) * scale - 0.5F;
    point.pixel.y = (point.pixel.y + 0.5F) * scale - 0.5F;
  }
  return scaled;
}

void paintFlowWithLegend(const cv::Mat& flow, double max_flow, cv::Mat& picture) {
  drawFlow(flow, max_flow).copyTo(picture);
  if (!drawing::isReadable(picture.size())) return;
  const int side = static_cast<int>(110.0 * drawing::unitOf(picture.size()));
  const cv::Rect corner(picture.cols - side, picture.rows - side, side, side);
  drawFlowLegend(side, max_flow).copyTo(picture(corner));
}

/// The figure while it is being filled.
class Panels {
 public:
  explicit Panels(const cv::Size& panel)
      : size_(panel), figure_(2 * panel.height, 3 * panel.width, CV_8UC3, cv::Scalar::all(0)) {}

  /// Paints into the middle of a panel, where the values of the picture have their size; or writes that they
  /// are missing. The title goes on top.
  template <typename Paint>
  void fill(int column, int row, const cv::Mat& values, const std::string& title, const std::string& missing,
            const Paint& paint) {
    cv::Mat panel = figure_(cv::Rect(cv::Point(column * size_.width, row * size_.height), size_));
    const double unit = drawing::unitOf(size_);
    if (values.empty()) {
      panel.setTo(cv::Scalar::all(32));
      if (drawing::isReadable(size_)) drawing::writeCentred(panel, missing, unit);
    } else {
      const cv::Point corner((size_.width - values.cols) / 2, (size_.height - values.rows) / 2);
      cv::Mat picture = panel(cv::Rect(corner, values.size()));
      paint(picture);
    }
    if (drawing::isReadable(size_)) drawing::writeTitle(panel, title, {0, 0}, unit);
  }

  const cv::Mat& finish() {
    for (int column = 1; column < 3; ++column)
      figure_(cv::Rect(column * size_.width - 1, 0, 2, figure_.rows)).setTo(cv::Scalar::all(0));
    figure_(cv::Rect(0, size_.height - 1, figure_.cols, 2)).setTo(cv::Scalar::all(0));
    return figure_;
  }

 private:
  cv::Size size_;
  cv::Mat figure_;
};

}  // namespace

cv::Mat sixPanel(const SixPanelInput& input) {
  requireTypes(input);
  const Prepared small = prepare(input);
  Panels panels(input.panel);
  panels.fill(0, 0, small.image, small.mask.empty() ? "image" : "image, moving pixels", "no image yet",
              [&](cv::Mat& picture) { overlayMask(small.image, small.mask, small.valid).copyTo(picture); });
  panels.fill(1, 0, small.residual, "residual: observed - expected flow", "no residual yet",
              [&](cv::Mat& picture) {
                drawResidual(small.residual, input.max_residual, input.residual_unit).copyTo(picture);
              });
  panels.fill(2, 0, small.expected_flow, "expected flow (static world)", "no expected flow yet",
              [&](cv::Mat& picture) { paintFlowWithLegend(small.expected_flow, small.max_flow, picture); });
  panels.fill(0, 1, small.depth, "metric depth", "no depth yet",
              [&](cv::Mat& picture) { drawDepth(small.depth, input.max_depth).copyTo(picture); });
  panels.fill(1, 1, input.radar ? small.image : cv::Mat(), "radar: static green, dynamic red (m/s)",
              input.radar ? "no image yet" : "no radar yet", [&](cv::Mat& picture) {
                drawRadar(small.image, pointsOn(*input.radar, small.image_scale)).copyTo(picture);
              });
  panels.fill(2, 1, small.observed_flow, "observed flow", "no observed flow yet",
              [&](cv::Mat& picture) { paintFlowWithLegend(small.observed_flow, small.max_flow, picture); });
  return panels.finish();
}

}  // namespace radar_dot
