// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

namespace radar_dot::dataset {

/// Identity of a table row in 16 bytes. nuScenes tokens are 32 hexadecimal digits, which fit as
/// they are; any other text is interned by a TokenPool, so that no two texts share a token.
struct Token {
  std::uint64_t high = 0;
  std::uint64_t low = 0;
  friend bool operator==(Token a, Token b) noexcept { return a.high == b.high && a.low == b.low; }
  friend bool operator!=(Token a, Token b) noexcept { return !(a == b); }
  friend bool operator<(Token a, Token b) noexcept {
    return a.high != b.high ? a.high < b.high : a.low < b.low;
  }
};

/// Turns token texts into Tokens and back. The empty text is Token{}.
class TokenPool {
 public:
  Token intern(std::string_view text);
  /// The token of a text that may never have been interned; Token{} then.
  Token find(std::string_view text) const;
  std::string text(Token token) const;

 private:
  std::vector<std::string> texts_;
  std::unordered_map<std::string, std::uint64_t> index_;
};

}  // namespace radar_dot::dataset

template <>
struct std::hash<radar_dot::dataset::Token> {
  std::size_t operator()(radar_dot::dataset::Token token) const noexcept {
    return static_cast<std::size_t>(token.high ^ (token.low * 0x9e3779b97f4a7c15ULL));
  }
};
