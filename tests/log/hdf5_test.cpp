// Files by h5py (fixtures/arrays/make.py): values, units, rates, what is never followed, and what a
// crash of the library does.

#include <catch2/catch.hpp>
#include <csignal>

#include "libchar/core/parallel/parallel.hpp"
#include "libchar/log/arrays/child_process.hpp"
#include "libchar/log/arrays/hdf5_worker.hpp"
#include "tests/log/array_log.hpp"
#include "tests/log/libraries.hpp"

using namespace libchar;
using test::array_fault;
using test::array_log;
using test::check_common_log;

TEST_CASE("hdf5: datasets of one length are one table, with their units, in any chunks, orders and filters") {
  NEEDS_LIBRARY(HDF5);
  const Recording log = array_log("log.h5");
  check_common_log(log);
  CHECK(log.info.format == "hdf5");
  CHECK(log.info.time.unit == "s");
  CHECK_FALSE(log.info.time.unit_guessed);
  for (const Channel& channel : log.info.channels)
    CHECK(channel.unit == (channel.name.starts_with("gyr") ? "deg/s" : "m/s^2"));
  for (const std::size_t bytes : {1, 70, 200, 1000}) {
    ReadOptions options;
    options.block_bytes = bytes;
    CHECK(array_log("log.h5", options).samples == log.samples);
  }
}

TEST_CASE("hdf5: members of a record may be arrays of any dimensions") {
  NEEDS_LIBRARY(HDF5);
  const Recording log = array_log("records.h5", {});
  REQUIRE(log.info.channels.size() == 7);
  CHECK(log.info.time.rate_hz == Approx(100));
  CHECK(log.samples[2][19] == 59.0 / 4);
  CHECK(log.samples[6][19] == 79.0 / 8);
}

TEST_CASE("hdf5: the fields of a record within a record have its name in front") {
  NEEDS_LIBRARY(HDF5);
  const Recording log = array_log("nested.h5", {});
  std::string names;
  for (const Channel& channel : log.info.channels) names += channel.name + " ";
  CHECK(names == "gyr.x gyr.y_0 gyr.y_1 id ");
  CHECK(log.info.time.rate_hz == Approx(100));
  CHECK(log.samples[0][19] == 19.0 / 4);
  CHECK(log.samples[2][19] == 39.0 / 8);
  CHECK(log.samples[3][19] == 7);
  ReadOptions options;
  options.channels = {"gyr.y_1"};
  CHECK(array_log("nested.h5", options).samples[0] == log.samples[2]);
}

TEST_CASE("hdf5: groups are topics, records bring their own stamps, an attribute is a rate") {
  NEEDS_LIBRARY(HDF5);
  const LogInfo listing = log_listing(test::fixture("arrays/groups.h5").string(), {});
  REQUIRE(listing.topics.size() == 3);
  ReadOptions options;
  options.topic = "imu";
  const Recording imu = array_log("groups.h5", options);
  CHECK(imu.info.time.column == "time_us");
  CHECK(imu.info.time.start_ns == 1403636579758555000);
  CHECK(imu.info.channels[1].name == "gyro/y");
  CHECK(imu.samples[1][19] == -9.5);  // binary16
  options.topic = "table";
  const Recording table = array_log("groups.h5", options);
  REQUIRE(table.info.channels.size() == 4);
  CHECK(table.info.channels[3].integer);
  CHECK(table.samples[1][19] == 361);
  REQUIRE(table.info.warnings.find("rounded_integer") != nullptr);
  CHECK(table.info.warnings.find("rounded_integer")->count == 10);  // the odd ones
  options.topic = "mag";
  const Recording mag = array_log("groups.h5", options);
  CHECK(mag.info.time.rate_hz == 50);
  REQUIRE(mag.info.channels.size() == 2);
  CHECK(mag.samples[0][99] == 99.0 / 8);
  CHECK(mag.samples[1][99] == 99);
  const std::string said = test::joined(mag.info.dialect);
  CHECK_THAT(said, Catch::Contains("words is text") && Catch::Contains("on holds truth values"));
  CHECK_THAT(said, Catch::Contains("one is a soft link") && Catch::Contains("other is a link to another file"));
  CHECK_THAT(said, Catch::Contains("left out of table: name is text"));
  CHECK_THAT(said, Catch::Contains("sampling_rate says 50 Hz"));
}

TEST_CASE("hdf5: other files, virtual datasets and unknown filters are left out with the reason") {
  NEEDS_LIBRARY(HDF5);
  const Recording log = array_log("refused.h5");
  REQUIRE(log.info.channels.size() == 1);
  CHECK(log.samples[0][19] == 38);
  const std::string said = test::joined(log.info.dialect);
  CHECK_THAT(said, Catch::Contains("x is stored in another file, which is never read"));
  CHECK_THAT(said, Catch::Contains("y is a virtual dataset"));
  CHECK_THAT(said, Catch::Contains("z is packed by filter 32000 lzf"));
}

TEST_CASE("hdf5: a file cut anywhere is refused in one sentence, or read whole") {
  NEEDS_LIBRARY(HDF5);
  for (const char* name : {"log.h5", "groups.h5"}) {
    const std::string bytes = test::slurp(test::fixture(std::string("arrays/") + name));
    for (std::size_t cut = 1; cut < bytes.size(); cut += 1000) {
      const std::string said = test::with_bytes("log.h5", bytes.substr(0, cut));
      INFO(name << " cut at " << cut << ": " << said);
      CHECK_THAT(said, Catch::Contains("error E0"));
      CHECK(said.find('\n') == std::string::npos);
    }
  }
}

TEST_CASE("hdf5: changed bytes end in a sentence or in values, and never in a crash of this process") {
  NEEDS_LIBRARY(HDF5);
  const std::string bytes = test::slurp(test::fixture("arrays/log.h5"));
  for (std::size_t at = 8; at < bytes.size(); at += 97) {
    std::string changed = bytes;
    changed[at] = static_cast<char>(static_cast<unsigned char>(changed[at]) ^ 0xFFU);
    CHECK(test::with_bytes("log.h5", changed).find('\n') == std::string::npos);
  }
}

namespace {

/// Answers each byte with itself, unless it is to end in another way.
struct Echo final : Answering {
  explicit Echo(std::string end) : end_(std::move(end)) {}
  std::size_t question_bytes() const override { return 1; }
  std::string begin() override {
    if (end_ == "crash") std::raise(SIGSEGV);
    if (end_ == "give up") std::_Exit(0);
    return "";
  }
  std::string answer(std::span<const std::byte> question) override { return {static_cast<char>(question[0])}; }
  std::string end_;
};

std::unique_ptr<Answering> echo(const std::string& end) { return std::make_unique<Echo>(end); }

std::string why_gone(const std::string& end) {
  ChildProcess child(echo, end);
  std::byte byte{7};
  try {
    child.answer({&byte, 1});
  } catch (const ChildGone& gone) {
    return gone.why;
  }
  return "";
}

}  // namespace

TEST_CASE("child process: questions are answered, a crash is told from an end") {
  ChildProcess child(echo, "");
  for (int i = 0; i < 3; ++i) {
    const auto sent = static_cast<std::byte>(i + 65);
    std::byte got{};
    child.ask({&sent, 1});
    child.answer({&got, 1});
    CHECK(got == sent);
  }
  if (!parallel::has_threads()) return;  // nor processes: what crashes ends the page's worker
  CHECK(why_gone("crash") == "crashed (signal 11)");
  CHECK(why_gone("give up") == "gave up");
}

TEST_CASE("hdf5: a listing is the same behind its bytes, and broken bytes are none") {
  Hdf5Listing listing;
  LogArray array;
  array.group = "g";
  array.name = "a";
  array.shape = {3, 2};
  array.element_bytes = 8;
  array.fields.push_back({"f", "V", {NumberType::i32, false}, 4, 1, false, false});
  array.said.push_back({"", "fs", 100});
  listing.arrays.push_back(array);
  listing.left_out = {"b is text"};
  const std::string bytes = encode(listing);
  Hdf5Listing back;
  REQUIRE(decode(bytes, back));
  CHECK(back.arrays[0].shape == array.shape);
  CHECK(back.arrays[0].fields[0].unit == "V");
  CHECK(back.arrays[0].said[0].value == 100);
  CHECK(back.left_out == listing.left_out);
  for (std::size_t cut = 0; cut < bytes.size(); ++cut) {
    Hdf5Listing none;
    CHECK_FALSE(decode(bytes.substr(0, cut), none));
  }
  listing.arrays[0].fields[0].byte = 5;  // reaches behind the element
  Hdf5Listing none;
  CHECK_FALSE(decode(encode(listing), none));
}
