// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>

/// One target each: feeds an input to what reads data of others. Only the documented refusals pass, and what
/// is accepted must be sound.
namespace radar_dot::test {

void fuzzPcd(const std::uint8_t* data, std::size_t size);
void fuzzLidar(const std::uint8_t* data, std::size_t size);
void fuzzTables(const std::uint8_t* data, std::size_t size);
void fuzzCanBus(const std::uint8_t* data, std::size_t size);
void fuzzRunLengths(const std::uint8_t* data, std::size_t size);
void fuzzInstanceMasks(const std::uint8_t* data, std::size_t size);
void fuzzConfiguration(const std::uint8_t* data, std::size_t size);
void fuzzMounts(const std::uint8_t* data, std::size_t size);
void fuzzPointCloud(const std::uint8_t* data, std::size_t size);
void fuzzImage(const std::uint8_t* data, std::size_t size);
void fuzzCompressedImage(const std::uint8_t* data, std::size_t size);
void fuzzCameraInfo(const std::uint8_t* data, std::size_t size);
void fuzzFlow(const std::uint8_t* data, std::size_t size);
void fuzzBag(const std::uint8_t* data, std::size_t size);

}  // namespace radar_dot::test
