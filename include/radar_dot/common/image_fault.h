// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace radar_dot {

/// What keeps the bytes of an image file from being the whole image: they are none, those of no
/// known file, end early or are broken.
/// Decoders draw what they have of a JPEG, and grey for the rest, without a word.
/// Bytes behind the end, and padding before it, are no fault, as cameras add them.
/// @return empty: nothing, or it is a BMP or TIFF file, which is not looked at
std::string imageFault(const std::vector<std::uint8_t>& bytes);

}  // namespace radar_dot
