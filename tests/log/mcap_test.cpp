// MCAP files by @mcap/core (fixtures/ros/make_mcap.mjs), whole, cut and broken.

#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>

#include "libchar/core/file/crc32.hpp"
#include "libchar/log/ros/decompress.hpp"
#include "tests/log/libraries.hpp"
#include "tests/log/ros_values.hpp"

using namespace libchar;

namespace {

const LogTopic& topic_called(const std::vector<LogTopic>& topics, const std::string& name) {
  for (const LogTopic& topic : topics)
    if (topic.name == name) return topic;
  throw std::runtime_error("no topic " + name);
}

std::string changed_mcap(const test::TemporaryFolder& folder, std::string bytes) {
  const std::string path = (folder / "changed.mcap").string();
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
  return path;
}

template <typename T>
T number_at(const std::string& bytes, std::size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

std::string mcap_record(char op, const std::string& content) {
  const std::uint64_t size = content.size();
  return op + std::string(reinterpret_cast<const char*>(&size), 8) + content;
}

}  // namespace

TEST_CASE("MCAP: an IMU in CDR has the generator's numbers, whatever the chunks are packed with") {
  NEEDS_LIBRARY(LZ4);
  NEEDS_LIBRARY(ZSTD);
  for (const char* name : {"ros2.mcap", "ros2_lz4.mcap", "ros2_zstd.mcap"}) {
    INFO(name);
    const test::Rows rows = test::read_rows("mcap", test::ros(name), test::of_topic("/imu0/data"));
    test::check_imu(rows, 200);
    CHECK(rows.warnings.empty());
  }
  test::check_imu(test::read_rows("mcap", test::ros("ros1.mcap")), 100);
  const test::Rows unchunked = test::read_rows("mcap", test::ros("ros2_unchunked.mcap"), test::of_topic("/imu0/data"));
  test::check_imu(unchunked, unchunked.time_ns.size());
  CHECK(unchunked.time_ns.size() > 80);
  CHECK(unchunked.warnings.empty());
}

TEST_CASE("MCAP: topics are listed with types, counts, rates and fields, or why there are none") {
  NEEDS_LIBRARY(ZSTD);
  const LogInfo listing = log_listing(test::ros("ros2_zstd.mcap").string(), {});
  const LogTopic& imu = topic_called(listing.topics, "/imu0/data");
  CHECK(imu.type == "sensor_msgs/msg/Imu");
  CHECK(imu.rows == 200);
  CHECK(imu.rate_hz == Approx(200).epsilon(0.02));
  CHECK(imu.sensor);
  CHECK(imu.fields.size() == 38);  // 37 doubles and the stamp
  CHECK(imu.fields[0].name == "header.stamp");
  CHECK(imu.fields[5].name == "orientation_covariance[0]");
  CHECK(topic_called(listing.topics, "/camera").why_not == "images");
  CHECK(topic_called(listing.topics, "/rosout").why_not == "no numbers");
  CHECK(topic_called(listing.topics, "/proto").why_not == "encoding protobuf");
  CHECK(topic_called(listing.topics, "/mag").fields[1].unit == "T");
  CHECK_FALSE(topic_called(listing.topics, "/level").sensor);
  CHECK(listing.dialect.front() == "MCAP, profile ros2, chunks packed with zstd");
  // Without a summary they are counted.
  std::string bytes = test::slurp(test::ros("ros2.mcap"));
  const test::TemporaryFolder folder;
  const LogInfo counted = log_listing(changed_mcap(folder, bytes.substr(0, bytes.size() - 20)), {});
  CHECK(counted.warnings.find("cut_end") != nullptr);
  CHECK(listing.warnings.empty());
  REQUIRE(counted.topics.size() == listing.topics.size());
  for (const LogTopic& topic : listing.topics) {
    INFO(topic.name);
    CHECK(topic_called(counted.topics, topic.name).rows == topic.rows);
    CHECK(topic_called(counted.topics, topic.name).fields.size() == topic.fields.size());
  }
}

TEST_CASE("MCAP: any message by its embedded definition") {
  const test::Rows odd = test::read_rows("mcap", test::ros("ros2.mcap"), test::of_topic("/odd"));
  CHECK(test::channel_names(odd.info) ==
        "on ticks small[0] small[1] small[2] port age[s] raw cells[0].volts cells[0].state cells[1].volts "
        "cells[1].state more[0].volts more[0].state gains[0] gains[1] gains[2] last");
  REQUIRE(odd.columns.size() == 18);
  for (std::size_t k = 0; k < 20; ++k) {
    const auto i = static_cast<double>(k);
    INFO(k);
    const double third = k == 7 ? kMissing : i / 4;
    const std::vector<double> expected = {static_cast<double>(k % 2),
                                          k == 3 ? 9007199254740992.0 : -i,
                                          i - 5,
                                          -128,
                                          127,
                                          60000 + i,
                                          i + 0.5,
                                          200 + i,
                                          1.5 * i,
                                          -i,
                                          2.5 * i,
                                          i,
                                          0.5,
                                          3 * i,
                                          k == 7 ? 1 : i,
                                          k == 7 ? 2 : i / 2,
                                          third,
                                          i / 8};
    for (std::size_t c = 0; c < expected.size(); ++c) {
      INFO(c);
      if (std::isnan(expected[c]))
        CHECK(std::isnan(odd.columns[c][k]));
      else
        CHECK(odd.columns[c][k] == expected[c]);
    }
  }
  CHECK(odd.info.channels[1].integer);
  CHECK_FALSE(odd.info.channels[8].integer);
  CHECK(odd.info.time.column == "log time");
  CHECK(odd.time_ns[2] == test::kRosStart + 100000000 + 1000000);
  REQUIRE(odd.warnings.find("array_length") != nullptr);
  CHECK(odd.warnings.find("array_length")->count == 1);
  CHECK(odd.warnings.find("rounded_integer")->count == 1);
}

TEST_CASE("MCAP: only the fields that are asked for, joints by their place, JSON by its first message") {
  NEEDS_LIBRARY(LZ4);
  const test::Rows one =
      test::read_rows("mcap", test::ros("ros2_lz4.mcap"), test::of_topic("/odd", {"cells[1].state", "gains[1]"}));
  REQUIRE(one.columns.size() == 2);
  CHECK(one.columns[0][19] == 19);
  CHECK(one.columns[1][19] == 9.5);
  const test::Rows joints = test::read_rows("mcap", test::ros("ros2.mcap"), test::of_topic("/joints"));
  CHECK(test::channel_names(joints.info) == "position[0] position[1] position[2] velocity[0] velocity[1] velocity[2]");
  CHECK(joints.columns[2][19] == -0.3 * 19);
  CHECK(joints.time_ns[19] == test::kRosStart + 950000000);
  const test::Rows room = test::read_rows("mcap", test::ros("ros2.mcap"), test::of_topic("/room"));
  CHECK(test::channel_names(room.info) == "celsius door.open cells[0] cells[1]");
  REQUIRE(room.time_ns.size() == 8);
  CHECK(room.time_ns[5] == test::kRosStart + 1250000000);
  CHECK(room.columns[0][5] == 20 + 5.0 / 16);
  CHECK(room.columns[1][5] == 1);
  CHECK(room.columns[3][7] == 14);
}

TEST_CASE("MCAP: whose stamps count can be said") {
  ReadOptions options = test::of_topic("/imu0/data", {"angular_velocity.x"});
  options.time_source = "log";
  const test::Rows log = test::read_rows("mcap", test::ros("ros2.mcap"), options);
  CHECK(log.info.time.column == "log time");
  CHECK(log.time_ns[1] == test::kRosStart + 5000000 + 2000000);
  options.time_source = "publish";
  const test::Rows publish = test::read_rows("mcap", test::ros("ros2.mcap"), options);
  CHECK(publish.time_ns[1] == test::kRosStart + 5000000 + 1500000);
  options.topic = "/level";
  options.channels = {};
  options.time_source = "header";
  CHECK_THAT(test::refusal("mcap", test::ros("ros2.mcap"), options),
             Catch::Contains("E0440") && Catch::Contains("/level"));
}

TEST_CASE("MCAP: cut at every 1000th byte, whole messages are read and the loss is said") {
  NEEDS_LIBRARY(LZ4);
  NEEDS_LIBRARY(ZSTD);
  for (const char* name : {"ros2.mcap", "ros2_lz4.mcap", "ros2_zstd.mcap", "ros2_unchunked.mcap"})
    test::check_cuts("mcap", name, "/imu0/data");
}

TEST_CASE("MCAP: of a cut file every whole message in front of the cut is read") {
  const std::string bytes = test::slurp(test::ros("ros2_unchunked.mcap"));
  // Where messages end, by a walk of its own: the first channel is that of the IMU.
  std::vector<std::size_t> ends;
  for (std::size_t at = 8; at + 9 < bytes.size();) {
    const auto size = number_at<std::uint64_t>(bytes, at + 1);
    if (bytes[at] == 5 && number_at<std::uint16_t>(bytes, at + 9) == 0) ends.push_back(at + 9 + size);
    at += 9 + size;
  }
  REQUIRE(ends.size() > 80);
  const test::TemporaryFolder folder;
  for (std::size_t cut = ends[2]; cut < ends.back(); cut += 1237) {
    const auto whole = static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), cut) - ends.begin());
    const test::Rows rows =
        test::read_rows("mcap", changed_mcap(folder, bytes.substr(0, cut)), test::of_topic("/imu0/data"));
    CHECK(rows.time_ns.size() == whole);
  }
}

TEST_CASE("MCAP: a broken chunk is left out, said and counted, a changed byte outside too") {
  NEEDS_LIBRARY(LZ4);
  NEEDS_LIBRARY(ZSTD);
  const test::TemporaryFolder folder;
  for (const char* name : {"ros2.mcap", "ros2_lz4.mcap", "ros2_zstd.mcap"}) {
    INFO(name);
    std::string bytes = test::slurp(test::ros(name));
    bytes[6000] = static_cast<char>(bytes[6000] ^ 0x10);
    const test::Rows rows = test::read_rows("mcap", changed_mcap(folder, bytes), test::of_topic("/imu0/data"));
    CHECK(rows.time_ns.size() < 200);
    REQUIRE(rows.warnings.find("broken_chunk") != nullptr);
    CHECK(rows.warnings.find("broken_chunk")->count == 1);
  }
  std::string bytes = test::slurp(test::ros("ros2_unchunked.mcap"));
  bytes[20000] = static_cast<char>(bytes[20000] ^ 0x10);
  const test::Rows rows = test::read_rows("mcap", changed_mcap(folder, bytes), test::of_topic("/imu0/data"));
  CHECK(rows.warnings.find("checksum") != nullptr);
}

TEST_CASE("MCAP: records that are not known, empty or twice there change nothing") {
  const test::TemporaryFolder folder;
  const std::string bytes = test::slurp(test::ros("ros2_unchunked.mcap"));
  const std::size_t first = 8 + 9 + number_at<std::uint64_t>(bytes, 9);  // behind the header
  const std::size_t schema = 9 + number_at<std::uint64_t>(bytes, first + 1);
  REQUIRE(bytes[first] == 3);
  const std::string twice = bytes.substr(first, schema);
  const std::string more = mcap_record('\x7f', "later versions") + mcap_record('\x0c', "") + twice;
  std::string cut = bytes.substr(0, first) + more + bytes.substr(first);
  cut.resize(cut.size() - 8);  // the index is wrong now: without its end it is not looked at
  const test::Rows rows = test::read_rows("mcap", changed_mcap(folder, cut), test::of_topic("/imu0/data"));
  test::check_imu(rows, rows.time_ns.size());
  CHECK(rows.time_ns.size() > 80);
  CHECK(rows.warnings.find("definition_changed") == nullptr);
}

TEST_CASE("MCAP: what asks for more than there is gets nothing") {
  const test::TemporaryFolder folder;
  const std::string magic = "\x89MCAP0\r\n";
  const std::string header = mcap_record(1, std::string(8, '\0'));
  const auto refused = [&](const std::string& bytes) { return test::refusal("mcap", changed_mcap(folder, bytes)); };
  // A chunk that says it holds 2^60 bytes, and one of a method that does not exist.
  std::string front(28, '\0');
  front[8 + 8 + 7] = 0x10;
  std::string chunk = front + std::string("\4\0\0\0lz4 ", 8) + std::string(8, '\0');
  CHECK_THAT(refused(magic + header + mcap_record(6, chunk)), Catch::Contains("E0443"));
  front = std::string(28, '\0');
  chunk = front + std::string("\3\0\0\0xyz", 7) + std::string(8, '\0');
  CHECK_THAT(refused(magic + header + mcap_record(6, chunk)), Catch::Contains("E0442") && Catch::Contains("xyz"));
  // A record that says it is longer than the file; no records; another file.
  CHECK_THAT(refused(magic + header + "\5" + std::string(8, '\xff')), Catch::Contains("E0426"));
  CHECK_THAT(refused(magic), Catch::Contains("E0426"));
  CHECK_THAT(refused("MCAP"), Catch::Contains("E0441"));
  CHECK_THAT(refused("\x89MCA"), Catch::Contains("E0441") && Catch::Contains("ends at byte 4"));
  CHECK_THAT(refused(""), Catch::Contains("E0441"));
}

TEST_CASE("unpacking stops at what was said, and says what is wrong") {
  std::vector<std::byte> out;
  const std::byte junk[8] = {};
  for (const char* method : {"lz4", "zstd", "bz2"}) {
    if (!why_not_packed(method).empty()) continue;
    CHECK_FALSE(unpack(method, junk, 1000, out).empty());
    CHECK(out.empty());
    CHECK_FALSE(unpack(method, {}, 1000, out).empty());
  }
  CHECK(why_not_packed("none").empty());
  CHECK_THAT(why_not_packed("brotli"), Catch::Contains("brotli"));
  const std::string text = "123456789";
  CHECK(crc32_of(std::as_bytes(std::span(text))) == 0xcbf43926);  // the check value of CRC-32
  CHECK(crc32_of(std::as_bytes(std::span(text).subspan(4)), crc32_of(std::as_bytes(std::span(text).first(4)))) ==
        0xcbf43926);
}

TEST_CASE("MCAP: cut in front of its first whole message, where it ends and inside what is said") {
  NEEDS_LIBRARY(ZSTD);
  const test::TemporaryFolder folder;
  const std::string zstd = test::slurp(test::ros("ros2_zstd.mcap"));
  CHECK_THAT(test::refusal("mcap", changed_mcap(folder, zstd.substr(0, 3000))),
             Catch::Contains("E0426") &&
                 Catch::Contains("holds no whole message: the file ends at byte 3000 inside a chunk") &&
                 Catch::Contains("begins at byte 55"));
  CHECK_THAT(test::refusal("mcap", changed_mcap(folder, zstd.substr(0, 8))),
             Catch::Contains("ends at byte 8 without its end mark"));
  const std::string plain = test::slurp(test::ros("ros1.mcap"));
  CHECK_THAT(test::refusal("mcap", changed_mcap(folder, plain.substr(0, 1000))),
             Catch::Contains("/imu: no messages") || Catch::Contains("ends at byte 1000"));
}
