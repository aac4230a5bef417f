// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/common/image_fault.h"

#include <algorithm>
#include <csetjmp>
#include <cstddef>
#include <cstdio>
#include <iterator>
#include <string_view>
// They need <cstdio>, and the second one the first.
#include <jpeglib.h>
// clang-format off
#include <jerror.h>
// clang-format on

namespace radar_dot {
namespace {

struct JpegErrors : jpeg_error_mgr {
  std::jmp_buf leave;
  char text[JMSG_LENGTH_MAX];
};

[[noreturn]] void fail(j_common_ptr codec) {
  auto* errors = static_cast<JpegErrors*>(codec->err);
  errors->format_message(codec, errors->text);
  std::longjmp(errors->leave, 1);
}

void warn(j_common_ptr codec, int level) {
  const jpeg_error_mgr& errors = *codec->err;
  constexpr int kEnd = 0xD9;
  constexpr int kMostPadding = 512;  // bytes
  const bool is_padding = errors.msg_code == JWRN_EXTRANEOUS_DATA && errors.msg_parm.i[1] == kEnd &&
                          errors.msg_parm.i[0] <= kMostPadding;
  const bool harmless =
      level >= 0 || is_padding || errors.msg_code == JWRN_ADOBE_XFORM || errors.msg_code == JWRN_JFIF_MAJOR;
  if (!harmless) fail(codec);
}

/// Decodes all bits, and an eighth of the pixels of each side.
void decode(jpeg_decompress_struct& codec, const std::vector<std::uint8_t>& bytes) {
  jpeg_mem_src(&codec, const_cast<std::uint8_t*>(bytes.data()), static_cast<unsigned long>(bytes.size()));
  constexpr long kMostMemory = 1L << 29L;  // for a size that is damaged
  codec.mem->max_memory_to_use = kMostMemory;
  jpeg_read_header(&codec, TRUE);
  constexpr unsigned kLeast = 8;
  codec.scale_denom = kLeast;
  codec.out_color_space = codec.jpeg_color_space;
  codec.dct_method = JDCT_IFAST;
  jpeg_start_decompress(&codec);
  const auto samples = codec.output_width * static_cast<unsigned>(codec.output_components);
  JSAMPARRAY row = codec.mem->alloc_sarray(reinterpret_cast<j_common_ptr>(&codec), JPOOL_IMAGE, samples, 1);
  while (codec.output_scanline < codec.output_height) jpeg_read_scanlines(&codec, row, 1);
  jpeg_finish_decompress(&codec);
}

std::string jpegFault(const std::vector<std::uint8_t>& bytes) {
  jpeg_decompress_struct codec{};
  JpegErrors errors{};
  codec.err = jpeg_std_error(&errors);
  errors.error_exit = fail;
  errors.emit_message = warn;
  // C++ has no objects between here and fail().
  if (setjmp(errors.leave) == 0) {
    jpeg_create_decompress(&codec);
    decode(codec, bytes);
  }
  jpeg_destroy_decompress(&codec);
  return errors.text;
}

}  // namespace

std::string imageFault(const std::vector<std::uint8_t>& bytes) {
  using namespace std::string_view_literals;
  if (bytes.empty()) return "there are no bytes";
  const auto begins = [&bytes](std::string_view with) {
    return bytes.size() >= with.size() &&
           std::equal(with.begin(), with.end(), bytes.begin(),
                      [](char a, std::uint8_t b) { return static_cast<std::uint8_t>(a) == b; });
  };
  // OpenCV tries its readers of medical and geographic images on anything else, and those end the process
  // where the file is damaged.
  constexpr std::string_view kKnown[] = {"\xff\xd8\xff"sv, "\x89PNG\r\n\x1a\n"sv, "BM"sv, "II*\0"sv,
                                         "MM\0*"sv};
  if (std::none_of(std::begin(kKnown), std::end(kKnown), begins))
    return "they begin like no JPEG, PNG, BMP or TIFF file";
  if (begins(kKnown[0])) return jpegFault(bytes);
  constexpr std::string_view kLastChunk = "IEND";
  const bool is_cut = begins(kKnown[1]) && std::find_end(bytes.begin(), bytes.end(), kLastChunk.begin(),
                                                         kLastChunk.end()) == bytes.end();
  return is_cut ? "PNG file ends early" : "";
}

}  // namespace radar_dot
