// Databases laid out as rosbag2's, by Python's sqlite3 (fixtures/ros/make_db3.py).

#include <catch2/catch.hpp>

#include "tests/log/libraries.hpp"
#include "tests/log/ros_values.hpp"

using namespace libchar;

TEST_CASE("db3: an IMU of Humble by the definitions that the program brings") {
  NEEDS_LIBRARY(SQLITE);
  const test::Rows rows = test::read_rows("db3", test::ros("humble.db3"), test::of_topic("/imu0/data"));
  test::check_imu(rows, 200);
  CHECK(rows.info.topic == "/imu0/data");
  CHECK(rows.warnings.empty());
  const test::Rows joints = test::read_rows("db3", test::ros("humble.db3"), test::of_topic("/joints"));
  CHECK(joints.columns[2][19] == -0.3 * 19);
  const test::Rows level = test::read_rows("db3", test::ros("humble.db3"), test::of_topic("/level"));
  CHECK(level.columns[0][39] == 39.0 * 39 / 64);
  CHECK(level.time_ns[39] == test::kRosStart + 975000000 + 1000000);
}

TEST_CASE("db3: a type that nobody defines is said, since Iron the file defines it") {
  NEEDS_LIBRARY(SQLITE);
  const LogInfo humble = log_listing(test::ros("humble.db3").string(), {});
  REQUIRE(humble.topics.size() == 4);
  for (const LogTopic& topic : humble.topics) {
    INFO(topic.name);
    if (topic.name == "/odd") CHECK(topic.why_not == "the log has no definition of this type");
    if (topic.name == "/imu0/data") {
      CHECK(topic.rows == 200);
      CHECK(topic.rate_hz == Approx(200).epsilon(0.01));
    }
  }
  const test::Rows odd = test::read_rows("db3", test::ros("jazzy.db3"), test::of_topic("/odd"));
  REQUIRE(odd.time_ns.size() == 20);
  CHECK(odd.columns.back()[19] == 19.0 / 8);
  const test::Rows mag = test::read_rows("db3", test::ros("jazzy.db3"));
  CHECK(mag.info.topic == "/mag");
  CHECK(mag.columns[0][49] == 2e-5 + 49 * 1e-9);
}

TEST_CASE("db3: a folder of .msg files defines the types of one's own, with their parts") {
  NEEDS_LIBRARY(SQLITE);
  const test::TemporaryFolder folder;
  const auto write = [&](const std::string& name, const std::string& text) {
    std::filesystem::create_directories((folder / name).parent_path());
    std::ofstream(folder / name) << text;
  };
  const std::string odd =
      "uint8 KIND_A=1\nstring<=20 LABEL=\"x#y\"\nbool on\nint64 ticks\nint8[3] small\nuint16 port 9\n"
      "builtin_interfaces/Duration age\nbyte raw\nCell[2] cells\nCell[] more\nstring[] names\nfloat32[<=8] gains\n"
      "float32 last\n";
  write("src/bench/bench_msgs/msg/Odd.msg", odd);
  write("src/bench/bench_msgs/msg/Cell.msg", "float32 volts\nstring label\nint16 state\n");
  write("src/other_msgs/msg/Cell.msg", "string label\n");
  ReadOptions options = test::of_topic("/odd");
  CHECK_THAT(test::refusal("db3", test::ros("humble.db3"), options),
             Catch::Contains("no definition of this type") && Catch::Contains("`msg` DIR"));
  options.unsaid.msg = (folder / "src").string();
  const test::Rows read = test::read_rows("db3", test::ros("humble.db3"), options);
  const test::Rows iron = test::read_rows("db3", test::ros("jazzy.db3"), test::of_topic("/odd"));
  REQUIRE(read.time_ns.size() == 20);
  CHECK(read.columns.back() == iron.columns.back());
  CHECK(read.columns.size() == iron.columns.size());
  CHECK(test::channel_names(read.info) == test::channel_names(iron.info));
  write("Empty/readme.txt", "");
  options.unsaid.msg = (folder / "Empty").string();
  CHECK_THAT(test::refusal("db3", test::ros("humble.db3"), options), Catch::Contains("E0450"));
}

TEST_CASE("db3: cut anywhere, what is in front of the cut is read or the file refused") {
  NEEDS_LIBRARY(SQLITE);
  const std::string bytes = test::slurp(test::ros("humble.db3"));
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder / "cut.db3";
  std::size_t read = 0;
  for (std::size_t cut = 0; cut < bytes.size(); cut += 1000) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes.substr(0, cut);
    INFO(cut);
    try {
      const test::Rows rows = test::read_rows("db3", path, test::of_topic("/level"));
      CHECK(rows.warnings.find("cut_end") != nullptr);
      for (std::size_t i = 0; i < rows.time_ns.size(); ++i)
        CHECK(rows.columns[0][i] == static_cast<double>(i * i) / 64);
      ++read;
    } catch (const Error& error) {
      CHECK(error.problem().code.starts_with("E04"));
    }
  }
  CHECK(read > 10);
}

TEST_CASE("db3: another database, and a recording that was not closed, are told") {
  NEEDS_LIBRARY(SQLITE);
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder / "a b?#%.db3";
  std::ofstream(path, std::ios::binary) << test::slurp(test::ros("humble.db3"));
  std::ofstream(path.string() + "-wal") << "not yet written";
  const test::Rows rows = test::read_rows("db3", path, test::of_topic("/imu0/data"));
  test::check_imu(rows, 200);
  CHECK(rows.warnings.find("open_recording") != nullptr);
  CHECK(std::distance(std::filesystem::directory_iterator(folder / "."), {}) == 2);
  std::ofstream(path, std::ios::binary | std::ios::trunc)
      << std::string("SQLite format 3\0", 16) + std::string(84, '\1');
  CHECK_THAT(test::refusal("db3", path), Catch::Contains("E0446"));
}

TEST_CASE("db3: cut in front of its first message it is told to be cut, and where") {
  NEEDS_LIBRARY(SQLITE);
  const std::string bytes = test::slurp(test::ros("humble.db3"));
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder / "cut.db3";
  const auto cut_at = [&](std::size_t cut) {
    std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes.substr(0, cut);
    return test::refusal("db3", path);
  };
  CHECK_THAT(cut_at(0), Catch::Contains("E0446") && Catch::Contains("is empty"));
  CHECK_THAT(cut_at(50), Catch::Contains("ends at byte 50, inside the header"));
  CHECK_THAT(cut_at(1000), Catch::Contains("E0446") && Catch::Contains("ends at byte 1000 of 110592"));
  CHECK_THAT(cut_at(5000), Catch::Contains("E0426") && Catch::Contains("ends at byte 5000 of"));
  CHECK_THAT(cut_at(17000), Catch::Contains("E0426") && Catch::Contains("ends at byte 17000 of"));
}
