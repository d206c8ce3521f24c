// Recordings of rosbag2: a folder of parts that is read as one log.

#include <catch2/catch.hpp>
#include <cstring>

#include "libchar/core/file/log_files.hpp"
#include "libchar/core/file/sha256.hpp"
#include "tests/log/libraries.hpp"
#include "tests/log/ros_values.hpp"

using namespace libchar;

namespace {

void write_metadata(const test::TemporaryFolder& folder, const std::vector<std::string>& parts) {
  std::string text =
      "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: mcap\n"
      "  topics_with_message_count:\n    - topic_metadata:\n        name: /imu0/data\n"
      "        offered_qos_profiles: \"- history: 3\\n  depth: 0\"\n      message_count: 200\n"
      "  compression_format: \"\"\n  relative_file_paths:\n";
  for (const std::string& part : parts) text += "    - " + part + "\n";
  std::ofstream(folder / "metadata.yaml") << text;
}

// The messages of ros2_unchunked.mcap from `first` to `end` in a file of their own, with all that is no message.
std::string piece_of_mcap(std::size_t first, std::size_t end) {
  const std::string all = test::slurp(test::ros("ros2_unchunked.mcap"));
  const std::string magic = all.substr(0, 8);
  std::string out = magic;
  std::size_t message = 0;
  for (std::size_t at = 8; at + 9 < all.size();) {
    std::uint64_t length = 0;
    std::memcpy(&length, all.data() + at + 1, sizeof length);
    const std::string record = all.substr(at, 9 + static_cast<std::size_t>(length));
    at += record.size();
    if (record[0] == 0x0f) break;  // the end of the data
    if (record[0] == 0x05 && (message < first || message >= end)) {
      ++message;
      continue;
    }
    message += record[0] == 0x05;
    out += record;
  }
  out += std::string("\x0f\x04\0\0\0\0\0\0\0", 9) + std::string(4, '\0');
  return out + std::string("\x02\x14\0\0\0\0\0\0\0", 9) + std::string(20, '\0') + magic;
}

std::string digest(const std::string& bytes) {
  Sha256 hash;
  hash.update(bytes);
  return hash.finish();
}

void write(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

}  // namespace

TEST_CASE("rosbag2: parts are one log in the order of metadata.yaml") {
  const test::TemporaryFolder folder;
  write(folder / "a_0.mcap", piece_of_mcap(0, 70));
  write(folder / "b_1.mcap", piece_of_mcap(70, 100000));
  write_metadata(folder, {"a_0.mcap", "old_folder/b_1.mcap"});
  const test::Rows whole =
      test::read_rows("mcap", test::ros("ros2_unchunked.mcap"), test::of_topic("/imu0/data"), true);
  for (const std::filesystem::path& path : {folder / ".", folder / "metadata.yaml"}) {
    const test::Rows rows =
        test::read_rows("rosbag2", named_log_file(path.string()), test::of_topic("/imu0/data"), true);
    test::check_imu(rows, whole.time_ns.size());
    CHECK(rows.warnings.empty());
    CHECK(rows.info.topic == "/imu0/data");
  }
  ReadOptions options = test::of_topic("/imu0/data");
  options.hash = true;
  const Recording read = read_recording((folder / ".").string(), options);
  CHECK(read.info.samples == whole.time_ns.size());
  CHECK(read.info.format == "rosbag2");
  CHECK(std::filesystem::path(read.info.file).filename() == "metadata.yaml");
  CHECK(read.info.sha256 == digest(test::slurp(folder / "metadata.yaml") + test::slurp(folder / "a_0.mcap") +
                                   test::slurp(folder / "b_1.mcap")));
  // In the other order the stamps go back, which is said as of any log.
  write_metadata(folder, {"b_1.mcap", "a_0.mcap"});
  CHECK_FALSE(read_recording((folder / ".").string(), options).info.warnings.empty());
}

TEST_CASE("rosbag2: topics of the parts are merged by name and type") {
  NEEDS_LIBRARY(SQLITE);
  const test::TemporaryFolder folder;
  for (const char* name : {"humble.db3", "jazzy.db3"}) std::filesystem::copy_file(test::ros(name), folder / name);
  write_metadata(folder, {"humble.db3", "jazzy.db3"});
  const LogInfo listing = log_listing((folder / ".").string(), {});
  std::map<std::string, std::uint64_t> rows;
  for (const LogTopic& topic : listing.topics) rows[topic.name] = topic.rows;
  CHECK(rows == std::map<std::string, std::uint64_t>{
                    {"/imu0/data", 200}, {"/joints", 20}, {"/level", 40}, {"/mag", 50}, {"/odd", 40}});
  CHECK(listing.dialect.front() == "recording of rosbag2, 2 parts: humble.db3, jazzy.db3");
  test::check_imu(test::read_rows("rosbag2", folder / "metadata.yaml", test::of_topic("/imu0/data")), 200);
  // The first part has no definition of this type.
  const test::Rows odd = test::read_rows("rosbag2", folder / "metadata.yaml", test::of_topic("/odd"), true);
  CHECK(odd.time_ns.size() == 20);
  const Finding* const lost = odd.warnings.find("unreadable_part");
  REQUIRE(lost != nullptr);
  CHECK(lost->count == 20);
  CHECK(lost->where.rows.front() == "humble.db3: the log has no definition of this type");
}

TEST_CASE("rosbag2: a part that is not there, is cut or is packed is named") {
  const test::TemporaryFolder folder;
  write(folder / "a_0.mcap", piece_of_mcap(0, 70));
  write_metadata(folder, {"a_0.mcap", "a_1.mcap"});
  const std::string path = (folder / ".").string();
  CHECK_THROWS_WITH(log_listing(path, {}),
                    Catch::Contains("E0448") && Catch::Contains("not there") && Catch::Contains("a_1.mcap"));
  write(folder / "a_1.mcap", piece_of_mcap(70, 100000).substr(0, 20000));
  const test::Rows cut = test::read_rows("rosbag2", folder / "metadata.yaml", test::of_topic("/imu0/data"), true);
  REQUIRE(cut.warnings.find("cut_end") != nullptr);
  CHECK_THAT(cut.warnings.find("cut_end")->where.rows.front(), Catch::StartsWith("a_1.mcap, "));
  CHECK(cut.time_ns.size() > 20);
  write(folder / "a_1.db3.zstd", "x");
  write_metadata(folder, {"a_0.mcap", "a_1.db3.zstd"});
  CHECK_THROWS_WITH(log_listing(path, {}), Catch::Contains("E0449") && Catch::Contains("unzstd"));
  write_metadata(folder, {});
  CHECK_THROWS_WITH(log_listing(path, {}), Catch::Contains("E0448") && Catch::Contains("lists no parts"));
  std::filesystem::remove(folder / "metadata.yaml");
  CHECK_THROWS_WITH(log_listing(path, {}), Catch::Contains("E0101") && Catch::Contains("is a folder"));
}

TEST_CASE("rosbag2: files about a recording are called after its folder") {
  CHECK(stem_of_log("/data/drive/metadata.yaml") == "drive");
  CHECK(stem_of_log("drive/./metadata.yaml") == "drive");
  CHECK(stem_of_log("drive/imu.csv") == "imu");
}
