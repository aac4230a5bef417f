// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "radar_dot/dataset/tables.h"

namespace radar_dot::dataset {

/// COCO run-length encoding of a binary mask: runs of zeros and ones in turn, column by column,
/// starting with zeros.
struct RunLengthMask {
  int rows = 0;  ///< px
  int columns = 0;
  std::vector<std::uint32_t> counts;
};

/// Decodes COCO's compressed `counts` text. @throws std::invalid_argument when the runs are
/// malformed or do not add up to rows x columns.
RunLengthMask parseRunLengths(std::string_view counts, int rows, int columns);
/// The inverse of parseRunLengths.
std::string formatRunLengths(const RunLengthMask& mask);
/// CV_8UC1 image, 0 or 255.
cv::Mat decodeMask(const RunLengthMask& mask);
/// Encodes every nonzero pixel of a CV_8UC1 image.
RunLengthMask encodeMask(const cv::Mat& mask);

/// A polygon, px: x0 y0 x1 y1 ...
using Polygon = std::vector<double>;

/// Size of an image of which nothing else is known, px.
inline constexpr int kMaskRows = 900;
inline constexpr int kMaskColumns = 1600;

/// One row of nuinsseg.json.
struct InstanceMask {
  Token token;
  Token sample_data_token;
  std::string filename;
  std::array<double, 4> bounding_box{};  ///< px: x0 y0 x1 y1
  std::string category_name;
  std::vector<Token> attribute_tokens;
  cv::Size image{kMaskColumns, kMaskRows};  ///< px, of its image
  /// One or several RLEs, or polygons; their union is the mask.
  std::variant<std::vector<RunLengthMask>, std::vector<Polygon>> mask;
};

/// Reads dataroot/version/nuinsseg.json (or `file` when given); the tokens join `tables.tokens`. Rows of
/// readings that the tables do not hold (other scenes, other parts of the dataset) are left out; so are, with
/// an entry in tables.left_out, masks that enclose nothing (null, empty, polygons of two corners) and masks
/// of another size than their image.
/// @throws DatasetError naming file, record and field.
std::vector<InstanceMask> readInstanceMasks(Tables& tables, const std::filesystem::path& file = {});

/// The masks of each scene, which must outlive them.
std::vector<std::vector<const InstanceMask*>> byScene(const Tables& tables,
                                                      const std::vector<InstanceMask>& masks);

/// True where tables/version/nuinsseg.json exists.
bool hasInstanceMasks(const Tables& tables);

/// Union of an instance's parts, CV_8UC1 0 or 255. A polygon's corners are rounded to pixels and its
/// border belongs to it. @throws std::invalid_argument for run lengths that do not fit their size.
cv::Mat decodeMask(const InstanceMask& instance);

/// Does an attribute of this name say that its object moves: "*.moving" or "cycle.with_rider".
bool isMovingAttribute(std::string_view name) noexcept;

/// Does the object move: an attribute "*.moving" or "cycle.with_rider".
bool isMoving(const Tables& tables, const InstanceMask& instance);
bool isMoving(const Tables& tables, const SampleAnnotation& annotation);

/// The paper's ground truth: union of the masks of the moving instances of one image, CV_8UC1
/// 0 or 255, kMaskRows x kMaskColumns where there is no instance.
cv::Mat dynamicMask(const Tables& tables, const std::vector<const InstanceMask*>& instances);

}  // namespace radar_dot::dataset
