// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/bag/bag_file.h"

#include <gtest/gtest.h>
#include <rosbag/view.h>
#include <sensor_msgs/CompressedImage.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdint>
#include <filesystem>
#include <iterator>
#include <random>
#include <stdexcept>
#include <string>
#include <system_error>

#include "fixtures/files.h"
#include "fixtures/refusal.h"

namespace radar_dot::bag {
namespace {

namespace fs = std::filesystem;

/// Noise, which no compression makes smaller.
sensor_msgs::CompressedImage picture(unsigned seed, std::size_t bytes) {
  std::mt19937 random(seed);
  sensor_msgs::CompressedImage image;
  image.data.resize(bytes);
  for (std::uint8_t& byte : image.data) byte = static_cast<std::uint8_t>(random() & 0xffU);
  return image;
}

void writePictures(BagFile& bag, unsigned count, std::size_t bytes) {
  for (unsigned i = 0; i < count; ++i) bag.write("/picture", ros::Time(1000 + i, 0), picture(i, bytes));
}

/// Does this process still keep content of a file of the folder on the disk, deleted ones included?
bool holdsFilesOf(const fs::path& folder) {
  for (const fs::directory_entry& descriptor : fs::directory_iterator("/proc/self/fd")) {
    std::error_code closed;
    if (fs::read_symlink(descriptor.path(), closed).string().rfind(folder.string(), 0) == 0 &&
        fs::file_size(descriptor.path(), closed) > 0)
      return true;
  }
  return false;
}

/// The message of the runtime_error of an action with no file allowed to grow beyond `bytes`, which is what a
/// full disk is to a writer. Runs in a process of its own: the limit, and what a broken compressed bag leaks,
/// end with it.
template <typename Action>
std::string errorWithinLimit(rlim_t bytes, const fs::path& folder, Action&& action) {
  int ends[2];
  if (::pipe(ends) != 0) return "no pipe";
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{bytes, bytes};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    std::string error = test::refusalOf<std::runtime_error>(action);
    if (holdsFilesOf(folder)) error += "; a file still has content: the disk stays full";
    const bool told = ::write(ends[1], error.data(), error.size()) == static_cast<ssize_t>(error.size());
    ::_exit(told ? 0 : 1);
  }
  ::close(ends[1]);
  std::string error;
  char buffer[512];
  for (ssize_t count; (count = ::read(ends[0], buffer, sizeof buffer)) > 0;) {
    error.append(buffer, static_cast<std::size_t>(count));
  }
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? error : "the process died";
}

TEST(BagFile, AppearsOnlyWhenCommitted) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "new/folder/a.bag";
  {
    BagFile bag(file, Compression::kNone, false);
    writePictures(bag, 3, 1000);
    EXPECT_FALSE(fs::exists(file));
    EXPECT_EQ(bag.messages(), 3U);
    const std::uintmax_t bytes = bag.commit();
    EXPECT_EQ(bytes, fs::file_size(file));
  }
  EXPECT_TRUE(fs::exists(file));
  rosbag::Bag read(file.string());
  EXPECT_EQ(rosbag::View(read).size(), 3U);
}

TEST(BagFile, LeavesNothingWithoutACommit) {
  const test::TemporaryFolder folder;
  {
    BagFile bag(folder.path() / "a.bag", Compression::kNone, false);
    writePictures(bag, 20, 1U << 20U);
    EXPECT_FALSE(fs::is_empty(folder.path())) << "the bag grows elsewhere: this test sees nothing";
  }
  EXPECT_TRUE(fs::is_empty(folder.path()));
}

TEST(BagFile, OverwritesOnlyWhenAllowed) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "a.bag";
  test::writeFile(file, "precious");
  test::expectRefusal<std::runtime_error>([&] { BagFile(file, Compression::kNone, false); },
                                          {file.string(), "exists already"});
  EXPECT_EQ(test::readFile(file), "precious");

  // A conversion that fails leaves the old bag as it was.
  { BagFile abandoned(file, Compression::kNone, true); }
  EXPECT_EQ(test::readFile(file), "precious");

  BagFile bag(file, Compression::kNone, true);
  writePictures(bag, 1, 10);
  bag.commit();
  rosbag::Bag read(file.string());
  EXPECT_EQ(rosbag::View(read).size(), 1U);
}

TEST(BagFile, RefusesToReplaceABagThatAppearedMeanwhile) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "a.bag";
  BagFile bag(file, Compression::kNone, false);
  writePictures(bag, 1, 10);
  test::writeFile(file, "precious");
  test::expectRefusal<std::runtime_error>([&] { bag.commit(); }, {"exists"});
  EXPECT_EQ(test::readFile(file), "precious");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

TEST(BagFile, NamesThePathThatCannotBeWritten) {
  const test::TemporaryFolder folder;
  test::writeFile(folder.path() / "file", "a regular file is no folder");
  const fs::path below_file = folder.path() / "file/a.bag";
  test::expectRefusal<std::runtime_error>([&] { BagFile(below_file, Compression::kNone, false); },
                                          {below_file.string(), "Not a directory"});
  test::expectRefusal<std::runtime_error>([] { BagFile("/proc/a.bag", Compression::kNone, false); },
                                          {"/proc/a.bag"});
  fs::create_directory(folder.path() / "folder.bag");
  test::expectRefusal<std::runtime_error>(
      [&] { BagFile(folder.path() / "folder.bag", Compression::kNone, true); }, {"Is a directory"});
}

class BagFileOnAFullDisk : public testing::TestWithParam<Compression> {};

// The limit strikes within a chunk, at the end of one, or only in the index that closing writes.
TEST_P(BagFileOnAFullDisk, FailsWithTheCauseAndLeavesNothing) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "a.bag";
  for (const rlim_t limit : {0U, 4000U, 100'000U, 4'200'000U, 4'400'000U}) {
    const std::string error = errorWithinLimit(limit, folder.path(), [&] {
      BagFile bag(file, GetParam(), false);
      writePictures(bag, 48, 100'000);
      bag.commit();
    });
    EXPECT_EQ(error, "cannot write " + file.string() + ": File too large") << "limit " << limit;
    EXPECT_TRUE(fs::is_empty(folder.path())) << "limit " << limit;
  }
}

TEST_P(BagFileOnAFullDisk, NoticesAnIndexThatDoesNotFit) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "a.bag";
  const auto convert = [&] {
    BagFile bag(file, GetParam(), true);
    writePictures(bag, 100, 100);
    return bag.commit();
  };
  const std::uintmax_t size = convert();
  fs::remove(file);
  for (const std::uintmax_t missing : {1U, 10U, 100U, 1000U}) {
    EXPECT_EQ(errorWithinLimit(size - missing, folder.path(), convert),
              "cannot write " + file.string() + ": File too large")
        << missing << " bytes missing";
    EXPECT_TRUE(fs::is_empty(folder.path()));
  }
}

TEST_P(BagFileOnAFullDisk, IsReadableWhenThereIsRoom) {
  const test::TemporaryFolder folder;
  const fs::path file = folder.path() / "a.bag";
  {
    BagFile bag(file, GetParam(), false);
    writePictures(bag, 60, 80'000);
    bag.commit();
  }
  rosbag::Bag read(file.string());
  unsigned count = 0;
  rosbag::View view(read);
  for (const rosbag::MessageInstance& message : view) {
    EXPECT_TRUE(message.instantiate<sensor_msgs::CompressedImage>()->data == picture(count, 80'000).data)
        << count;
    ++count;
  }
  EXPECT_EQ(count, 60U);
}

INSTANTIATE_TEST_SUITE_P(Compressions, BagFileOnAFullDisk,
                         testing::Values(Compression::kNone, Compression::kLz4, Compression::kBz2));

}  // namespace
}  // namespace radar_dot::bag
