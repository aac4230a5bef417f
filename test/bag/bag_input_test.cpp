// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/bag/bag_input.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rosbag/bag.h>
#include <std_msgs/String.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "fixtures/files.h"

namespace radar_dot::bag {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

struct Entry {
  double time;
  std::string topic, text;
};

class BagInputTest : public testing::Test {
 protected:
  fs::path write(const std::string& name, const std::vector<Entry>& entries,
                 rosbag::CompressionType compression = rosbag::compression::Uncompressed) {
    const fs::path file = folder_.path() / name;
    rosbag::Bag bag(file.string(), rosbag::bagmode::Write);
    bag.setCompression(compression);
    for (const Entry& entry : entries) {
      std_msgs::String message;
      message.data = entry.text;
      bag.write(entry.topic, ros::Time(entry.time), message);
    }
    return file;
  }

  static std::string read(const BagInput& input, const std::vector<std::string>& topics = {}) {
    std::string texts;
    input.read(topics,
               [&](const rosbag::MessageInstance& m) { texts += m.instantiate<std_msgs::String>()->data; });
    return texts;
  }

  static std::string failureOf(const std::vector<fs::path>& files, const BagSelection& selection = {}) {
    try {
      BagInput(files, selection);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "";
  }

  test::TemporaryFolder folder_;
};

TEST_F(BagInputTest, ReadsSeveralBagsInTheOrderOfTime) {
  const BagInput input({write("b.bag", {{12.0, "/x", "c"}, {13.0, "/y", "d"}}),
                        write("a.bag", {{10.0, "/x", "a"}, {12.5, "/x", "C"}}, rosbag::compression::BZ2)});
  EXPECT_EQ(read(input), "acCd");
  EXPECT_EQ(read(input, {"/x"}), "acC");
  EXPECT_EQ(input.begin(), ros::Time(10.0));
  EXPECT_EQ(input.end(), ros::Time(13.0));
  EXPECT_EQ(input.topics().at("/y"), "std_msgs/String");
}

TEST_F(BagInputTest, KeepsTheMountsOfAPart) {
  const fs::path file = write("a.bag", {{10.0, "/tf_static", "M"},
                                        {10.0, "/x", "a"},
                                        {11.0, "/x", "b"},
                                        {12.0, "/x", "c"},
                                        {13.0, "/x", "d"}});
  BagSelection part;
  part.start = 1.0;
  part.duration = 1.0;
  EXPECT_EQ(read(BagInput({file}, part)), "Mbc");
  std::vector<double> progress;
  BagInput({file}, part)
      .read(
          {"/x"}, [](const rosbag::MessageInstance&) {},
          [&](double seconds) { progress.push_back(seconds); });
  EXPECT_THAT(progress, ElementsAre(0.0, 1.0));
}

TEST_F(BagInputTest, SaysWhatIsWrongWithAFile) {
  EXPECT_THAT(failureOf({folder_.path() / "none.bag"}), HasSubstr("none.bag: there is no such file"));
  EXPECT_THAT(failureOf({folder_.path()}), HasSubstr("it is no file"));
  EXPECT_THAT(failureOf({write("empty.bag", {})}), HasSubstr("empty.bag: no message in it"));
  const fs::path file = write("a.bag", {{10.0, "/x", "a"}, {11.0, "/x", "b"}});
  BagSelection late;
  late.start = 5.0;
  EXPECT_THAT(failureOf({file}, late), HasSubstr("from --start 5 s on; the recording takes 1.0 s"));
  fs::resize_file(file, 20);
  EXPECT_THAT(failureOf({file}), HasSubstr("a.bag"));
}

// rosbag allocates what a length says and reads beyond its end.
TEST_F(BagInputTest, RefusesLengthsThatAreNoneOfTheFile) {
  const auto compressions = {rosbag::compression::Uncompressed, rosbag::compression::LZ4,
                             rosbag::compression::BZ2};
  for (const rosbag::CompressionType compression : compressions) {
    const fs::path file =
        write("a.bag", {{10.0, "/x", std::string(5000, '0')}, {11.0, "/x", "b"}}, compression);
    const std::string bytes = test::readFile(file);
    EXPECT_EQ(read(BagInput({file})), std::string(5000, '0') + "b");
    for (const char* field : {"op=", "size=", "conn=", "chunk_pos=", "index_pos="}) {
      const bool last = field == std::string("conn=");
      const std::size_t place = last ? bytes.rfind(field) : bytes.find(field);
      std::string broken = bytes;
      broken.replace(place - 4, 4, "\xff\xff\xff\xff");  // length of the field
      test::writeFile(file, broken);
      EXPECT_THAT(failureOf({file}), HasSubstr("a.bag as a bag: broken at byte ")) << field;
      if (field == std::string("op=") || last) continue;
      broken = bytes;
      broken.replace(bytes.find('=', place) + 1, 4, "\x07\xff\xff\xf0");  // the number itself
      test::writeFile(file, broken);
      EXPECT_THAT(failureOf({file}), HasSubstr("a.bag as a bag: broken at byte ")) << field;
    }
  }
}

}  // namespace
}  // namespace radar_dot::bag
