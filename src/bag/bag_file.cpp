// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/bag/bag_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <stdexcept>
#include <system_error>
#include <utility>

#include "common/leftovers.h"

namespace radar_dot::bag {
namespace {

namespace fs = std::filesystem;

// Some dozens of radar scans, or a few dozens of pictures: few seeks when replaying, little memory.
constexpr std::uint32_t kChunkBytes = 4U << 20U;

rosbag::CompressionType toRosbag(Compression compression) {
  switch (compression) {
    case Compression::kNone: return rosbag::compression::Uncompressed;
    case Compression::kLz4: return rosbag::compression::LZ4;
    case Compression::kBz2: return rosbag::compression::BZ2;
  }
  throw std::invalid_argument("compression: neither none, lz4 nor bz2");
}

/// Waits until the disk holds the file (or folder). @return 0 or the error number
int synchronise(const fs::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return errno;
  const int cause = ::fsync(descriptor) == 0 ? 0 : errno;
  ::close(descriptor);
  return cause;
}

}  // namespace

BagFile::BagFile(fs::path file, Compression compression, bool overwrite)
    : file_(std::move(file)), partial_(file_), overwrite_(overwrite) {
  partial_ += fmt::format(".partial-{}", ::getpid());
  std::error_code error;
  const fs::path folder = file_.has_parent_path() ? file_.parent_path() : fs::path(".");
  fs::create_directories(folder, error);
  if (error) fail(error.value(), {});
  if (fs::is_directory(file_, error)) fail(EISDIR, {});
  if (!overwrite_ && fs::exists(file_, error)) {
    throw std::runtime_error(
        fmt::format("{} exists already: remove it, or allow overwriting (--force)", file_.string()));
  }
  removeLeftovers(folder, file_.filename().string() + ".partial-");
  try {
    open(compression);
  } catch (...) {
    abandon();
    throw;
  }
}

BagFile::~BagFile() { abandon(); }

void BagFile::open(Compression compression) {
  bag_ = std::make_unique<rosbag::Bag>();
  errno = 0;
  try {
    bag_->open(partial_.string(), rosbag::bagmode::Write);
    in_use_ = std::make_unique<InUse>(partial_);
    bag_->setCompression(toRosbag(compression));
    bag_->setChunkThreshold(kChunkBytes);
  } catch (const ros::Exception& error) {
    fail(errno, error.what());
  }
}

void BagFile::close() {
  errno = 0;
  try {
    bag_->close();
  } catch (const ros::Exception& error) {
    fail(errno, error.what());
  }
  bag_.reset();
}

std::uintmax_t BagFile::commit() {
  try {
    close();
    // A file system may accept bytes that it cannot store (quota, network): it says so here.
    if (const int cause = synchronise(partial_); cause != 0) fail(cause, {});
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(partial_, error);
    if (!error && !overwrite_ && fs::exists(file_)) error = std::make_error_code(std::errc::file_exists);
    if (!error) fs::rename(partial_, file_, error);
    if (error) fail(error.value(), error.message());
    synchronise(file_.has_parent_path() ? file_.parent_path() : fs::path("."));
    return bytes;
  } catch (...) {
    abandon();
    throw;
  }
}

void BagFile::abandon() noexcept {
  try {
    if (bag_) bag_->close();
  } catch (...) {
    // rosbag closes the bag in its destructor as well, where failing once more would end the process: leaking
    // it is the lesser evil. Its file is emptied, since an open one holds its place on the disk after it is
    // removed.
    static_cast<void>(bag_.release());
  }
  bag_.reset();
  std::error_code ignored;
  fs::resize_file(partial_, 0, ignored);
  fs::remove(partial_, ignored);
}

void BagFile::fail(int cause, const std::string& otherwise) const {
  throw std::runtime_error(fmt::format("cannot write {}: {}", file_.string(),
                                       cause != 0 ? std::generic_category().message(cause) : otherwise));
}

}  // namespace radar_dot::bag
