// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/dataset/token.h"

#include <gtest/gtest.h>

#include <random>
#include <set>
#include <string>
#include <vector>

#include "radar_dot/dataset/token_index.h"

namespace radar_dot::dataset {
namespace {

const std::string kHex = "00a1b2c3d4e5f60718293a4b5c6d7e8f";

TEST(TokenPool, HexTokensFitAsTheyAre) {
  TokenPool pool;
  const Token token = pool.intern(kHex);
  EXPECT_EQ(token.high, 0x00a1b2c3d4e5f607ULL);
  EXPECT_EQ(token.low, 0x18293a4b5c6d7e8fULL);
  EXPECT_EQ(TokenPool().text(token), kHex) << "a hexadecimal token needs no pool to be read back";
}

TEST(TokenPool, EmptyTextIsTheNullToken) {
  TokenPool pool;
  EXPECT_EQ(pool.intern(""), Token{});
  EXPECT_EQ(pool.text(Token{}), "");
}

TEST(TokenPool, DifferentTextsNeverShareAToken) {
  const std::vector<std::string> texts = {"",
                                          "1",
                                          "2",
                                          "4",
                                          kHex,
                                          "00A1B2C3D4E5F60718293A4B5C6D7E8F",
                                          std::string(32, '0'),
                                          std::string(31, '0') + "1",
                                          std::string(15, '0') + "1" + std::string(16, '0'),
                                          kHex + "0",
                                          kHex.substr(1),
                                          "00a1b2c3d4e5f60718293a4b5c6d7e8g"};
  TokenPool pool;
  std::set<Token> seen;
  for (const std::string& text : texts) EXPECT_TRUE(seen.insert(pool.intern(text)).second) << text;
  for (const std::string& text : texts) {
    EXPECT_EQ(pool.text(pool.intern(text)), text);
    EXPECT_EQ(pool.find(text), pool.intern(text));
  }
}

TEST(TokenPool, FindDoesNotIntern) {
  TokenPool pool;
  EXPECT_EQ(pool.find("never seen"), Token{});
  const Token first = pool.intern("first");
  EXPECT_EQ(pool.find("first"), first);
  EXPECT_EQ(pool.find("never seen"), Token{});
}

struct Row {
  Token token;
};

TEST(TokenIndex, FindsEveryRowAndNoOther) {
  std::mt19937_64 random(7);
  for (const std::size_t size : {0U, 1U, 10U, 11U, 1000U, 40000U}) {
    std::vector<Row> rows;
    for (std::size_t i = 0; i < size; ++i) rows.push_back({{i % 3 == 0 ? 0 : random() | 1, i + 1}});
    TokenIndex index;
    ASSERT_EQ(index.build(rows), -1);
    for (std::size_t i = 0; i < size; ++i) ASSERT_EQ(index.find(rows, rows[i].token), static_cast<int>(i));
    EXPECT_EQ(index.find(rows, Token{}), -1);
    EXPECT_EQ(index.find(rows, Token{5, 0}), -1);
  }
  EXPECT_EQ(TokenIndex().find(std::vector<Row>{}, Token{1, 1}), -1) << "an index that was never built";
}

TEST(TokenIndex, NamesTheFirstRowThatRepeatsAToken) {
  const std::vector<Row> rows = {{{1, 1}}, {{2, 2}}, {{1, 2}}, {{2, 2}}, {{1, 1}}};
  TokenIndex index;
  EXPECT_EQ(index.build(rows), 3);
}

}  // namespace
}  // namespace radar_dot::dataset
