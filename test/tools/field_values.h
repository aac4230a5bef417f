// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "radar_dot/common/fields.h"

namespace radar_dot::test {

/// Is it valid for the field?
inline bool accepts(const Field& field, const FieldValue& value) {
  try {
    field.check(value);
  } catch (const InvalidParameter&) {
    return false;
  }
  return true;
}

/// Another valid value than the one it has; the same where there is only one.
inline FieldValue anotherValue(const Field& field) {
  const FieldValue value = field.get();
  std::vector<FieldValue> candidates;
  switch (field.type) {
    case FieldType::kBool: candidates = {!std::get<bool>(value)}; break;
    case FieldType::kInt: {
      const std::int64_t number = std::get<std::int64_t>(value);
      candidates = {number + 1, number - 1};
      break;
    }
    case FieldType::kDouble: {
      // Of many digits, to see that none is lost.
      const double number = std::holds_alternative<double>(value) ? std::get<double>(value) : 0.0;
      candidates = {number * 1.1 + 1e-3, number * 0.9 - 1e-3, 0.123456789012345678, number / 3.0,
                    std::isfinite(field.range.lowest) ? field.range.lowest : 0.0};
      break;
    }
    case FieldType::kText: candidates = {"another " + std::get<std::string>(value)}; break;
    case FieldType::kEnum:
      for (const auto& [name, meaning] : field.choices) candidates.emplace_back(std::string(name));
      break;
    case FieldType::kIntList:
      candidates = {std::vector<int>{1, 2, 3}, std::vector<int>{0, 1}, std::vector<int>{}};
      break;
    case FieldType::kTextList: candidates = {std::vector<std::string>{"a_b", "c"}}; break;
  }
  for (const FieldValue& candidate : candidates)
    if (candidate != value && accepts(field, candidate)) return candidate;
  return value;
}

/// One that is not valid, as text; none where everything of its type is.
inline std::optional<std::string> invalidText(const Field& field) {
  switch (field.type) {
    case FieldType::kBool: return "perhaps";
    case FieldType::kEnum: return "no_such_name";
    case FieldType::kText:
    case FieldType::kTextList: return std::nullopt;
    case FieldType::kInt: return "1.5";
    case FieldType::kIntList: return "[1.5]";
    case FieldType::kDouble: break;
  }
  if (std::isfinite(field.range.highest)) return toText(field.range.highest * 2.0 + 1.0);
  if (std::isfinite(field.range.lowest)) return toText(field.range.lowest - 1.0);
  return "nan";
}

}  // namespace radar_dot::test
