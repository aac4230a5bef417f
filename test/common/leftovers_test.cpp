// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "common/leftovers.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include "fixtures/files.h"

namespace radar_dot {
namespace {

namespace fs = std::filesystem;

TEST(Leftovers, AreWhatNobodyWorksOn) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "a.bag.partial-1", made = folder.path() / "a.bag.partial-2";
  test::writeFile(file, "half");
  test::writeFile(made / "inner", "half");
  test::writeFile(folder.path() / "a.bag", "whole");
  int ready[2];
  ASSERT_EQ(pipe(ready), 0);
  const pid_t child = fork();
  if (child == 0) {
    const InUse one(file), other(made);
    if (write(ready[1], "x", 1) != 1) _exit(1);
    pause();
  }
  char byte = 0;
  ASSERT_EQ(read(ready[0], &byte, 1), 1);
  EXPECT_TRUE(leftoversIn(folder.path(), "a.bag.partial-").empty());
  kill(child, SIGKILL);
  waitpid(child, nullptr, 0);
  EXPECT_EQ(leftoversIn(folder.path(), "a.bag.partial-").size(), 2U);
  removeLeftovers(folder.path(), "a.bag.partial-");
  EXPECT_TRUE(fs::exists(folder.path() / "a.bag"));
  EXPECT_FALSE(fs::exists(file) || fs::exists(made));
}

TEST(Leftovers, NoneWhereThereIsNoFolder) { EXPECT_TRUE(leftoversIn("/nowhere", "a").empty()); }

}  // namespace
}  // namespace radar_dot
