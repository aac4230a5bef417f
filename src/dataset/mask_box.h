// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core.hpp>

namespace radar_dot::dataset {

/// The smallest box around the nonzero pixels of a CV_8UC1 image; empty where there are none.
cv::Rect boundingBox(const cv::Mat& mask);

}  // namespace radar_dot::dataset
