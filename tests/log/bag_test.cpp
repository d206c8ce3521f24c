// Bags by python3-rosbag (fixtures/ros/make_bag.py), whole, cut and broken.

#include <catch2/catch.hpp>

#include "tests/log/libraries.hpp"
#include "tests/log/ros_values.hpp"

using namespace libchar;

namespace {

std::string changed_bag(const test::TemporaryFolder& folder, const std::string& bytes) {
  const std::string path = (folder / "changed.bag").string();
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
  return path;
}

}  // namespace

TEST_CASE("bag: an IMU has the generator's numbers, whatever the chunks are packed with") {
  NEEDS_LIBRARY(LZ4);
  NEEDS_LIBRARY(BZIP2);
  for (const char* name : {"ros1_none.bag", "ros1_bz2.bag", "ros1_lz4.bag"}) {
    INFO(name);
    const test::Rows rows = test::read_rows("bag", test::ros(name), test::of_topic("/imu/data_raw"));
    test::check_imu(rows, 100);
    CHECK(rows.warnings.empty());
  }
}

TEST_CASE("bag: topics are listed by the index, or by a look at everything") {
  const test::TemporaryFolder folder;
  std::string bytes = test::slurp(test::ros("ros1_none.bag"));
  for (const bool indexed : {true, false}) {
    INFO(indexed);
    std::string changed = bytes;
    const std::size_t field = changed.find("index_pos=");
    REQUIRE(field != std::string::npos);
    if (!indexed) changed.replace(field + 10, 8, 8, '\0');
    const LogInfo listing = log_listing(changed_bag(folder, changed), {});
    REQUIRE(listing.topics.size() == 4);
    for (const LogTopic& topic : listing.topics) {
      INFO(topic.name);
      if (topic.name == "/imu/data_raw") {
        CHECK(topic.rows == 100);
        CHECK(topic.rate_hz == Approx(200).epsilon(0.02));
        CHECK(topic.sensor);
        CHECK(topic.type == "sensor_msgs/Imu");
        CHECK(topic.fields.size() == 39);  // 37 doubles, the stamp, the sequence
      }
      if (topic.name == "/notes") CHECK(topic.why_not == "no numbers");
      if (topic.name == "/pressure") CHECK(topic.fields[2].unit == "Pa");
    }
    CHECK(listing.dialect.front() ==
          (indexed ? "bag 2.0, chunks packed with none" : "bag 2.0, chunks packed with none, no index"));
    const test::Rows rows = test::read_rows("bag", changed_bag(folder, changed), test::of_topic("/imu/data_raw"));
    test::check_imu(rows, 100);
    CHECK((rows.warnings.find("cut_end") != nullptr) == !indexed);
  }
}

TEST_CASE("bag: any message by its definition, stamps of 0 give way to the time of recording") {
  NEEDS_LIBRARY(LZ4);
  NEEDS_LIBRARY(BZIP2);
  const test::Rows load = test::read_rows("bag", test::ros("ros1_lz4.bag"), test::of_topic("/load"));
  CHECK(test::channel_names(load.info) == "at[s] took[s] cells[0].volts cells[1].volts raw[0] raw[1] last");
  REQUIRE(load.time_ns.size() == 25);
  for (std::size_t k = 0; k < 25; ++k) {
    const auto i = static_cast<double>(k);
    CHECK(load.columns[0][k] == Approx(1.7e9 + 0.02 * i).epsilon(1e-15));
    CHECK(load.columns[1][k] == -0.75);
    CHECK(load.columns[2][k] == i / 2);
    CHECK(load.columns[3][k] == i / 4);
    CHECK(load.columns[5][k] == -i);
    CHECK(load.columns[6][k] == i / 8);
    CHECK(load.time_ns[k] == test::kRosStart + static_cast<std::int64_t>(k) * 20000000 + 1000000);
  }
  const test::Rows pressure = test::read_rows("bag", test::ros("ros1_bz2.bag"), test::of_topic("/pressure"));
  CHECK(test::channel_names(pressure.info) == "fluid_pressure[Pa]");
  CHECK(pressure.columns[0][24] == 101328);
  CHECK(pressure.info.time.column == "log time");
  CHECK(pressure.time_ns[1] == test::kRosStart + 21000000);
  CHECK(pressure.warnings.find("zero_stamp") != nullptr);
  ReadOptions options = test::of_topic("/pressure");
  options.time_source = "publish";
  CHECK_THAT(test::refusal("bag", test::ros("ros1_bz2.bag"), options), Catch::Contains("E0440"));
}

TEST_CASE("bag: cut at every 1000th byte, whole messages are read and the loss is said") {
  NEEDS_LIBRARY(LZ4);
  NEEDS_LIBRARY(BZIP2);
  for (const char* name : {"ros1_none.bag", "ros1_lz4.bag", "ros1_bz2.bag"})
    test::check_cuts("bag", name, "/imu/data_raw");
}

TEST_CASE("bag: a broken chunk is left out and said, other versions are refused") {
  NEEDS_LIBRARY(LZ4);
  NEEDS_LIBRARY(BZIP2);
  const test::TemporaryFolder folder;
  for (const char* name : {"ros1_lz4.bag", "ros1_bz2.bag"}) {
    INFO(name);
    std::string bytes = test::slurp(test::ros(name));
    for (std::size_t at = 4500; at < 4600; ++at) bytes[at] = static_cast<char>(~bytes[at]);
    const test::Rows rows = test::read_rows("bag", changed_bag(folder, bytes), test::of_topic("/imu/data_raw"), true);
    CHECK(rows.time_ns.size() < 100);
    CHECK(rows.time_ns.size() > 10);
    CHECK(rows.warnings.find("broken_chunk") != nullptr);
    CHECK(rows.warnings.find("lost_messages") != nullptr);
  }
  CHECK_THAT(test::refusal("bag", changed_bag(folder, "#ROSBAG V1.2\n")),
             Catch::Contains("E0444") && Catch::Contains("2.0"));
  CHECK_THAT(test::refusal("bag", changed_bag(folder, "#ROS")), Catch::Contains("E0444"));
  CHECK_THAT(test::refusal("bag", changed_bag(folder, "#ROSBAG V2.0\n")), Catch::Contains("E0426"));
  // A header of 2^31 bytes, data of 2^32: nothing is asked for.
  CHECK_THAT(test::refusal("bag", changed_bag(folder, std::string("#ROSBAG V2.0\n\0\0\0\x80zzzz", 21))),
             Catch::Contains("E0426"));
}

TEST_CASE("bag: cut in front of its first whole message, where it ends and inside what is said") {
  NEEDS_LIBRARY(BZIP2);
  const test::TemporaryFolder folder;
  const std::string bytes = test::slurp(test::ros("ros1_bz2.bag"));
  CHECK_THAT(
      test::refusal("bag", changed_bag(folder, bytes.substr(0, 5000))),
      Catch::Contains("E0426") && Catch::Contains("holds no whole message: the file ends at byte 5000 inside a chunk"));
  CHECK_THAT(test::refusal("bag", changed_bag(folder, bytes.substr(0, 12))),
             Catch::Contains("ends at byte 12, inside the 13 bytes that mark a bag") && !Catch::Contains("version"));
}
