// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/dataset/token.h"

namespace radar_dot::dataset {
namespace {

constexpr std::size_t kHexDigits = 32;

/// Value of a lower-case hexadecimal digit, or a number above 15. Upper case is another text, and
/// so must not share a token with its lower case.
std::uint64_t digitValue(char digit) noexcept {
  if (digit >= '0' && digit <= '9') return static_cast<std::uint64_t>(digit - '0');
  if (digit >= 'a' && digit <= 'f') return static_cast<std::uint64_t>(digit - 'a') + 10;
  return 255;
}

/// A token with high == 0 is a number in the pool, so a text of 32 digits whose upper half is zero
/// does not fit as it is either.
bool fitsAsItIs(std::string_view text, Token& token) noexcept {
  if (text.size() != kHexDigits) return false;
  std::uint64_t halves[2] = {0, 0};
  std::uint64_t seen = 0;
  for (std::size_t i = 0; i < kHexDigits; ++i) {
    const std::uint64_t value = digitValue(text[i]);
    seen |= value;
    halves[i / 16] = halves[i / 16] << 4 | (value & 15);
  }
  token = {halves[0], halves[1]};
  return seen < 16 && token.high != 0;
}

}  // namespace

Token TokenPool::intern(std::string_view text) {
  if (text.empty()) return {};
  Token token;
  if (fitsAsItIs(text, token)) return token;
  const auto [entry, is_new] = index_.try_emplace(std::string(text), texts_.size() + 1);
  if (is_new) texts_.emplace_back(text);
  return {0, entry->second};
}

Token TokenPool::find(std::string_view text) const {
  if (text.empty()) return {};
  Token token;
  if (fitsAsItIs(text, token)) return token;
  const auto entry = index_.find(std::string(text));
  return entry == index_.end() ? Token{} : Token{0, entry->second};
}

std::string TokenPool::text(Token token) const {
  if (token == Token{}) return {};
  if (token.high == 0) return texts_.at(token.low - 1);
  std::string text(kHexDigits, '0');
  for (std::size_t i = 0; i < kHexDigits; ++i) {
    const std::uint64_t half = i < 16 ? token.high : token.low;
    text[i] = "0123456789abcdef"[half >> (60 - 4 * (i % 16)) & 15];
  }
  return text;
}

}  // namespace radar_dot::dataset
