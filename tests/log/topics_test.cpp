// Which topic of a log with several is meant, and what is common to their rows, by a reader that
// holds its messages in memory.

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <limits>

#include "libchar/core/error.hpp"
#include "libchar/log/ros/messages/message_topics.hpp"
#include "libchar/log/topics/joined_topics.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

std::vector<LogTopic> flight() {
  LogTopic imu0{"/imu0", "sensor_msgs/Imu", 5, 100, {{"w.x", "rad/s"}, {"w.y", "rad/s"}}, true, ""};
  LogTopic imu1 = imu0, camera, pose, nested;
  imu1.name = "/imu1";
  camera.name = "/camera";
  camera.why_not = "images";
  pose.name = "/pose";
  pose.fields = {{"x", "m"}, {"t", "s"}};
  nested.name = "/imu0/raw";
  nested.fields = {{"adc", ""}};
  return {imu0, imu1, camera, pose, nested};
}

ReadOptions asking(std::vector<std::string> channels, std::string topic = "") {
  ReadOptions options;
  options.channels = std::move(channels);
  options.topic = std::move(topic);
  return options;
}

// "/imu0: w.x w.y", "none", or the sentence that refuses.
std::string choice(const std::vector<LogTopic>& topics, const ReadOptions& options) {
  try {
    const auto chosen = choose_topic(topics, options, "a.bag");
    if (!chosen) return "none";
    std::string text = topics[chosen->topic].name + ":";
    for (const std::string& channel : chosen->channels) text += " " + channel;
    return text;
  } catch (const Error& error) {
    return error.what();
  }
}

// "/imu0: w.x /imu1:", or the sentence that refuses.
std::string several(const std::vector<LogTopic>& topics, const ReadOptions& options) {
  try {
    std::string text;
    for (const TopicChoice& one : choose_topics(topics, options, "a.bag")) {
      text += (text.empty() ? "" : " ") + topics[one.topic].name + ":";
      for (const std::string& channel : one.channels) text += " " + channel;
    }
    return text;
  } catch (const Error& error) {
    return error.what();
  }
}

struct MemoryReader final : TopicReader {
  std::vector<LogTopic> list = flight();
  std::string own_stamps = "header.stamp";
  std::vector<std::vector<double>> rows;  // of every topic alike
  std::vector<std::int64_t> stamps_ns;
  std::vector<std::size_t> usual, wanted;
  std::size_t at = 0, largest = 0;
  std::optional<std::size_t> time;
  std::int64_t unit = 0;

  const std::vector<LogTopic>& topics() const override { return list; }
  std::string stamps(std::size_t) const override { return own_stamps; }
  std::vector<std::size_t> usual_fields(std::size_t topic) const override {
    return usual.empty() ? TopicReader::usual_fields(topic) : usual;
  }
  FirstValues first_values(std::size_t, std::size_t field) override {
    FirstValues first;
    for (const auto& row : rows) first.values.push_back(row[field]);
    first.integers = false;
    return first;
  }
  void select(std::size_t, const std::vector<std::size_t>& fields, std::optional<std::size_t> time_field,
              StampUnit wanted_unit) override {
    wanted = fields;
    time = time_field;
    unit = wanted_unit.ns;
  }
  bool next(RowBlock& block, std::size_t most, Findings&) override {
    for (; at < rows.size() && block.rows < most; ++at, ++block.rows) {
      for (std::size_t c = 0; c < wanted.size(); ++c) block.columns[c].push_back(rows[at][wanted[c]]);
      if (time)
        block.time_ns.push_back(std::llround(rows[at][*time] * static_cast<double>(unit)));
      else if (!own_stamps.empty())
        block.time_ns.push_back(stamps_ns[at]);
    }
    largest = std::max(largest, block.rows);
    return block.rows > 0;
  }
  std::uint64_t bytes_read() const override { return at; }
};

void take_all(RowSource& rows, std::vector<std::vector<double>>& columns, std::vector<std::int64_t>& stamps,
              Findings& warnings) {
  RowBlock block;
  while (rows.next(block, warnings)) {
    columns.resize(block.columns.size());
    for (std::size_t c = 0; c < columns.size(); ++c)
      columns[c].insert(columns[c].end(), block.columns[c].begin(), block.columns[c].end());
    stamps.insert(stamps.end(), block.time_ns.begin(), block.time_ns.end());
  }
  rows.finish(warnings);
}

struct Opened {
  test::TemporaryFolder folder;
  std::unique_ptr<RowSource> rows;
  std::vector<std::vector<double>> columns;
  std::vector<std::int64_t> stamps;
  Findings warnings;

  Opened(std::unique_ptr<TopicReader> reader, const ReadOptions& options) {
    const std::string path = (folder / "a.bag").string();
    std::ofstream(path, std::ios::binary) << "abc";
    rows = open_topic_rows(std::move(reader), path, "bag", options);
    take_all(*rows, columns, stamps, warnings);
  }
  std::string names() const {
    std::string all;
    for (const Channel& channel : rows->info().channels) all += channel.name + " ";
    return all;
  }
};

std::unique_ptr<MemoryReader> pose_reader() {
  auto reader = std::make_unique<MemoryReader>();
  reader->rows = {{1, 0}, {2, 0.5}, {3, 1}, {4, 1.5}};
  reader->stamps_ns = {10, 20, 30, 40};
  return reader;
}

}  // namespace

TEST_CASE("the topic is the one that is named, by itself or in front of a channel") {
  const auto topics = flight();
  CHECK(choice(topics, asking({}, "/pose")) == "/pose:");
  CHECK(choice(topics, asking({}, "/po*")) == "/pose:");
  CHECK(choice(topics, asking({"/imu1/w.x"})) == "/imu1: w.x");
  CHECK(choice(topics, asking({"/imu1.w.y", "w.x"})) == "/imu1: w.y w.x");
  CHECK(choice(topics, asking({"/imu0/raw/adc"})) == "/imu0/raw: adc");
  CHECK(choice(topics, asking({"/imu1/*"})) == "/imu1: w.x w.y");
  CHECK(choice(topics, asking({"x"})) == "/pose: x");
  CHECK(choice(topics, asking({"w.*"}, "/imu1")) == "/imu1: w.x w.y");
  CHECK(choice(topics, asking({"c1"}, "/imu1")) == "/imu1: c1");
}

TEST_CASE("the number of an instance may be left out where there is one") {
  std::vector<LogTopic> topics = flight();
  topics[0].name = "gyro 0";
  topics[1].name = "accel 0";
  topics[3].name = "accel 1";
  topics[4].name = "accel x";
  CHECK(choice(topics, asking({}, "gyro")) == "gyro 0:");
  CHECK(choice(topics, asking({}, "accel 1")) == "accel 1:");
  CHECK(several(topics, asking({}, "accel")) == "accel 0: accel 1:");
  CHECK_THAT(choice(topics, asking({}, "gyr")), Catch::Contains("no topic of this name"));
}

TEST_CASE("the only topic with numbers, or the only sensor's, is taken, of several none") {
  auto topics = flight();
  CHECK(choice(topics, {}) == "none");
  CHECK(choice({topics[2], topics[3]}, {}) == "/pose:");
  CHECK(choice({topics[0], topics[2], topics[3]}, {}) == "/imu0:");
  const auto chosen = choose_topic({topics[0], topics[3]}, {}, "a.bag");
  REQUIRE(chosen);
  CHECK(chosen->guess == "topic: /imu0, the only one of 2 that is a sensor's (`topic` takes another one)");
  CHECK_THROWS_WITH(refuse_without_topic(topics, "a.bag"), Catch::Contains("E0427") &&
                                                               Catch::Contains("holds 4 topics") &&
                                                               Catch::Contains("`topic` /imu0 chooses one"));
  CHECK_THROWS_WITH(refuse_without_topic({topics[2]}, "a.bag"),
                    Catch::Contains("E0426") && Catch::Contains("/camera: images"));
  CHECK_THROWS_WITH(refuse_without_topic({}, "a.bag"), Catch::Contains("holds no messages"));
}

TEST_CASE("what names no topic, or several, is refused with the way out") {
  const auto topics = flight();
  CHECK_THAT(choice(topics, asking({}, "/imu2")), Catch::Contains("E0425") && Catch::Contains("did you mean"));
  CHECK_THAT(choice(topics, asking({}, "/camera")), Catch::Contains("cannot be read: images"));
  CHECK_THAT(choice(topics, asking({"w.x"})), Catch::Contains("several topics have this channel: /imu0, /imu1"));
  CHECK_THAT(choice(topics, asking({"/imu0/w.x", "/imu1/w.x"})), Catch::Contains("its own clock"));
  CHECK_THAT(choice(topics, asking({"nothing"})), Catch::Contains("no topic has a channel"));
}

TEST_CASE("rows of a topic: its stamps, in blocks of any size, with what is no sample taken out") {
  auto reader = pose_reader();
  reader->rows[1][0] = std::numeric_limits<double>::quiet_NaN();
  reader->rows[2][0] = std::numeric_limits<double>::infinity();
  MemoryReader* const memory = reader.get();
  ReadOptions options = asking({}, "/pose");
  options.block_bytes = 48;
  const Opened log(std::move(reader), options);
  CHECK(memory->largest == 2);
  CHECK(log.names() == "x t ");
  CHECK(log.stamps == std::vector<std::int64_t>{10, 20, 30, 40});
  CHECK(log.columns[0][0] == 1);
  CHECK(std::isnan(log.columns[0][1]));
  CHECK(std::isnan(log.columns[0][2]));
  CHECK(log.warnings.find("missing_cell")->where.rows[0] == "row 1 of /pose, field x");
  CHECK(log.warnings.find("infinite_value")->count == 1);
  CHECK(log.rows->info().time.column == "header.stamp");
  CHECK(log.rows->info().topic == "/pose");
  CHECK(log.rows->sha256() == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST_CASE("a topic without stamps has them in a field, and a field can be asked for") {
  auto reader = pose_reader();
  reader->own_stamps = "";
  const Opened log(std::move(reader), asking({}, "/pose"));
  CHECK(log.names() == "x ");
  CHECK(log.stamps == std::vector<std::int64_t>{0, 500000000, 1000000000, 1500000000});
  CHECK(log.rows->info().time.column == "t");
  ReadOptions by_name = asking({}, "/pose");
  by_name.time_column = "t";
  const Opened named(pose_reader(), by_name);
  CHECK(named.stamps == log.stamps);
  ReadOptions none = asking({}, "/pose");
  none.time_column = "none";
  const Opened without(pose_reader(), none);
  CHECK(without.names() == "x t ");
  CHECK(without.stamps.empty());
}

TEST_CASE("fields that no sensor measures are left out unless asked for, and that is said") {
  auto reader = pose_reader();
  reader->usual = {0};
  const Opened log(std::move(reader), asking({}, "/pose"));
  CHECK(log.names() == "x ");
  CHECK_THAT(log.rows->info().dialect.back(), Catch::Contains("1 field left out") && Catch::Contains("such as t"));
  reader = pose_reader();
  reader->usual = {0};
  CHECK(Opened(std::move(reader), asking({"/pose/t"})).names() == "t ");
}

TEST_CASE("a pattern names several topics, of which channels choose") {
  const auto topics = flight();
  CHECK(several(topics, asking({}, "/imu?")) == "/imu0: /imu1:");
  CHECK(several(topics, asking({}, "/imu0")).empty());
  CHECK(several(topics, asking({}, "/pose*")).empty());
  CHECK(several(topics, asking({"w.x"}, "/imu?")) == "/imu0: w.x /imu1: w.x");
  CHECK(several(topics, asking({"/imu1/w.y"}, "/imu?")) == "/imu1: w.y");
  CHECK(several(topics, asking({"/imu?/w.y"}, "/imu?")) == "/imu0: w.y /imu1: w.y");
  CHECK(several(topics, asking({"!w.y"}, "/imu?")) == "/imu0: !w.y /imu1: !w.y");
  CHECK_THAT(several(topics, asking({"w.z"}, "/imu?")), Catch::Contains("E0320") && Catch::Contains("/imu1/w.y"));
}

namespace {

// Each reader has one topic's stamps.
std::vector<std::vector<std::int64_t>> clocks;
std::size_t opened = 0;

std::unique_ptr<TopicReader> next_clock(const std::string&, const ReadOptions&) {
  auto reader = std::make_unique<MemoryReader>();
  reader->stamps_ns = clocks[opened++];
  for (std::size_t i = 0; i < reader->stamps_ns.size(); ++i) reader->rows.push_back({static_cast<double>(i), 0});
  return reader;
}

struct Joined {
  test::TemporaryFolder folder;
  std::unique_ptr<RowSource> rows;
  std::vector<std::vector<double>> columns;
  std::vector<std::int64_t> stamps;
  Findings warnings;

  Joined(std::vector<std::vector<std::int64_t>> stamps_ns, const ReadOptions& options) {
    clocks = std::move(stamps_ns);
    opened = 0;
    const std::string path = (folder / "a.bag").string();
    std::ofstream(path, std::ios::binary) << "abc";
    const auto topics = flight();
    rows = open_joined_topics(choose_topics(topics, options, path), topics, next_clock, path, "bag", options);
    take_all(*rows, columns, stamps, warnings);
  }
};

std::size_t missing(const std::vector<double>& values) {
  return static_cast<std::size_t>(std::count_if(values.begin(), values.end(), [](double v) { return std::isnan(v); }));
}

std::vector<std::int64_t> clock_of(std::size_t n, double first, double step) {
  std::vector<std::int64_t> out;
  for (std::size_t i = 0; i < n; ++i) out.push_back(std::llround(first + step * static_cast<double>(i)));
  return out;
}

}  // namespace

TEST_CASE("topics of one rate share rows, at the stamps of the first, however far apart they are") {
  for (const double behind : {0.0, 50.0, 480.0, 520.0, 950.0, -400.0}) {
    INFO(behind);
    const Joined log({clock_of(5000, 1e6, 1000), clock_of(5000, 1e6 + behind, 1000)}, asking({"w.x"}, "/imu?"));
    CHECK(log.rows->info().channels[1].name == "/imu1/w.x");
    CHECK(log.rows->info().channels[1].every == 1);
    CHECK(log.stamps.size() <= 5001);
    CHECK(missing(log.columns[0]) <= 1);
    CHECK(missing(log.columns[1]) <= 1);
    CHECK(std::abs(log.columns[1][2000] - log.columns[0][2000]) <= 1);
    CHECK((log.warnings.find("stamps_apart") != nullptr) == (behind != 0));
  }
}

TEST_CASE("a topic goes on where another one pauses, and one row is lost where a clock passes another") {
  auto paused = clock_of(5000, 0, 1000);
  paused.erase(paused.begin() + 2000, paused.begin() + 3000);
  const Joined log({paused, clock_of(5000, 300, 1000)}, asking({"w.x"}, "/imu?"));
  CHECK(log.stamps.size() == 5000);
  CHECK(missing(log.columns[0]) == 1000);
  CHECK(missing(log.columns[1]) == 0);
  CHECK(log.columns[1][4000] == 4000);
  CHECK(log.columns[0][4000] == 3000);

  for (const double step : {999.5, 1000.5}) {
    const Joined drift({clock_of(20000, 0, 1000), clock_of(20000, 100, step)}, asking({"w.x"}, "/imu?"));
    INFO(step);
    CHECK(drift.stamps.size() <= 20010);
    CHECK(missing(drift.columns[0]) <= 20);
    CHECK(missing(drift.columns[1]) <= 30);
    CHECK(std::abs(drift.columns[1][18000] - 18000 * 1000 / step) < 1.5);
  }
}

TEST_CASE("topics of unlike rates: rows of the fastest, and a clock of its own for the others") {
  const Joined log({clock_of(1000, 70, 4000), clock_of(4000, 0, 1000)}, asking({"w.x"}, "/imu?"));
  CHECK(log.stamps.size() == 4000);
  CHECK(log.rows->info().channels[0].every == 4);
  CHECK(log.rows->info().channels[1].every == 1);
  CHECK(missing(log.columns[0]) == 3000);
  CHECK(log.columns[0][4 * 700] == 700);
  ReadOptions own = asking({"w.x"}, "/imu?");
  own.kinds.own_stamps = true;
  CHECK(Joined({clock_of(1000, 70, 4000), clock_of(4000, 0, 1000)}, own).stamps.size() == 5000);
}

TEST_CASE("one wild stamp of a topic holds nothing up") {
  auto wild = clock_of(3000, 0, 1000);
  wild[1500] = std::int64_t{1} << 60U;
  const Joined log({wild, clock_of(3000, 0, 1000)}, asking({"w.x"}, "/imu?"));
  CHECK(log.stamps.size() == 3000);
  CHECK(missing(log.columns[0]) == 1);
  CHECK(log.warnings.find("wild_stamp")->count == 1);
}

TEST_CASE("instances in a flight log are one recording, the channels of one of them alone too") {
  const std::string log = test::fixture("flight/copter.bin");
  ReadOptions options = asking({"GyrX"}, "IMU");
  const Recording both = read_recording(log, options);
  REQUIRE(both.info.channels.size() == 2);
  CHECK(both.info.channels[1].name == "IMU 1/GyrX");
  options = asking({"GyrX"}, "IMU 1");
  CHECK(both.samples[1] == read_recording(log, options).samples[0]);
  options = asking({"IMU 1/GyrX"}, "IMU*");
  CHECK(both.samples[1] == read_recording(log, options).samples[0]);
}

TEST_CASE("topics of one name and type are one, those of another type get it in their name") {
  const auto topic = [](const char* name, const char* type, const char* definition, std::uint64_t rows,
                        std::int64_t first_ns, std::int64_t last_ns) {
    RawTopic out;
    out.name = name;
    out.format.type = type;
    out.format.definition = definition;
    out.rows = rows;
    out.first_ns = first_ns;
    out.last_ns = last_ns;
    return out;
  };
  RawTopics topics;
  CHECK(topics.add(topic("/a", "T", "x", 0, 0, 0)) == 0);
  CHECK(topics.add(topic("/a", "U", "x", 1, 5, 5)) == 1);
  CHECK(topics.add(topic("/a", "T", "y", 1, 6, 6)) == 2);  // another definition is another type
  CHECK(topics.add(topic("/b", "T", "x", 1, 7, 7)) == 3);
  CHECK(topics.add(topic("/a", "T", "x", 2, 30, 40)) == 0);
  CHECK(topics.add(topic("/a", "T", "x", 2, 20, 35)) == 0);
  CHECK(topics.add(topic("/a", "U", "x", 3, 1, 9)) == 1);  // by the name that it was given
  const std::vector<RawTopic> found = topics.take();
  REQUIRE(found.size() == 4);
  CHECK(found[0].name == "/a");
  CHECK(found[0].rows == 4);
  CHECK(found[0].first_ns == 20);
  CHECK(found[0].last_ns == 40);
  CHECK(found[1].name == "/a (U)");
  CHECK(found[1].rows == 4);
  CHECK(found[1].first_ns == 1);
  CHECK(found[1].last_ns == 9);
  CHECK(found[2].name == "/a (T)");
  CHECK(found[3].name == "/b");
}
