// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

namespace radar_dot::tools {

/// Columns on a terminal: bytes that continue a character of UTF-8 take none.
inline std::size_t widthOf(const std::string& text) {
  return static_cast<std::size_t>(std::count_if(
      text.begin(), text.end(), [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; }));
}

/// Words behind `first`, wrapped at `width` columns into lines that begin with `next`.
inline std::string wrapped(const std::string& first, const std::string& text, const std::string& next,
                           std::size_t width) {
  std::string lines = first;
  std::size_t at = widthOf(first.substr(first.rfind('\n') + 1));
  for (std::size_t begin = 0; begin < text.size();) {
    const std::string word = text.substr(begin, std::min(text.find(' ', begin), text.size()) - begin);
    if (begin > 0 && at + 1 + widthOf(word) > width) {
      lines += "\n" + next;
      at = widthOf(next);
    } else if (begin > 0) {
      lines += ' ';
      ++at;
    }
    lines += word;
    at += widthOf(word);
    begin += word.size() + 1;
  }
  return lines + "\n";
}

/// Adds an item to a list in one line, unless it is empty.
inline void append(std::string& list, const std::string& item, const char* separator = "; ") {
  if (!item.empty()) list += (list.empty() ? "" : separator) + item;
}

/// The items by the titles they have, in the order in which those appear first.
template <typename Items, typename TitleOf>
auto grouped(const Items& items, const TitleOf& title_of) {
  std::vector<std::pair<std::string, std::vector<const typename Items::value_type*>>> groups;
  for (const auto& item : items) {
    const std::string title = title_of(item);
    auto found = std::find_if(groups.begin(), groups.end(),
                              [&title](const auto& group) { return group.first == title; });
    if (found == groups.end()) found = groups.insert(groups.end(), {title, {}});
    found->second.push_back(&item);
  }
  return groups;
}

}  // namespace radar_dot::tools
