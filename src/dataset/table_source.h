// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <fmt/format.h>

#include <string>
#include <string_view>
#include <vector>

#include "json_records.h"
#include "radar_dot/dataset/tables.h"
#include "radar_dot/dataset/token_index.h"

namespace radar_dot::dataset {

/// A table that has been read: its rows by token, and where each row stands in its file. Needed
/// only until every reference to and from the table is resolved.
template <typename Row>
struct TableSource {
  std::string label;  ///< "v1.0-mini/sample.json"
  const std::vector<Row>* rows = nullptr;
  TokenIndex index;
  std::vector<std::size_t> records;  ///< record of each row; empty where rows and records agree

  Index find(Token token) const noexcept { return index.find(*rows, token); }
  std::size_t recordOf(std::size_t row) const { return records.empty() ? row : records[row]; }
};

/// A column of tokens whose rows are not known while their table is being read.
struct PendingColumn {
  std::string_view field;
  std::vector<Token> tokens;  ///< one a row; Token{} = no reference
};

inline std::string danglingReference(const std::string& token, const std::string& target) {
  return fmt::format("refers to token {}, which {} does not hold; are both tables of one download?", token,
                     target);
}

/// A reference to a table that has been read already. @throws DatasetError for a dangling or empty
/// reference.
template <typename Target>
Index resolve(const Record& record, std::size_t field, const TokenPool& tokens,
              const TableSource<Target>& target) {
  const std::string_view text = record.text(field);
  if (text.empty()) record.fail(field, "is empty");
  const Index row = target.find(tokens.find(text));
  if (row == kNone) record.fail(field, danglingReference(std::string(text), target.label));
  return row;
}

/// Fills `member` of all rows from a column. @throws DatasetError for a dangling reference.
template <typename Row, typename Target>
void resolve(std::vector<Row>& rows, Index Row::*member, const PendingColumn& column,
             const TableSource<Row>& source, const TableSource<Target>& target, const TokenPool& tokens) {
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Token token = column.tokens[i];
    if (token == Token{}) continue;
    rows[i].*member = target.find(token);
    if (rows[i].*member == kNone)
      throw DatasetError(fmt::format("{} record {} (token {}): field '{}' {}", source.label,
                                     source.recordOf(i), tokens.text(rows[i].token), column.field,
                                     danglingReference(tokens.text(token), target.label)));
  }
}

}  // namespace radar_dot::dataset
