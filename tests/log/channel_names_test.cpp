#include "libchar/log/channel_names.hpp"

#include <catch2/catch.hpp>

#include "tests/log/log_text.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

const std::string kChannelRows = "t[s],gyro_10[deg/s],gyro_2[deg/s],gyro_1[deg/s],acc*,ref\n0,1,2,3,4,5\n1,1,2,3,4,5\n";

struct NamesBench {
  NamesBench() { std::ofstream(path, std::ios::binary) << kChannelRows; }
  test::TemporaryFolder folder;
  std::string path = (folder / "log.csv").string();
  std::vector<std::vector<std::string>> names(const std::vector<std::string>& words,
                                              const std::vector<std::string>& except = {},
                                              const ReadOptions& options = {}) const {
    return channel_names(path, options, words, except);
  }
  std::string refusal(const std::vector<std::string>& words) const {
    try {
      names(words);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
};

using Words = std::vector<std::vector<std::string>>;

}  // namespace

TEST_CASE("channel names: patterns in natural order, names and positions as they are") {
  const NamesBench bench;
  CHECK(bench.names({"gyro*"}) == Words{{"gyro_1", "gyro_2", "gyro_10"}});
  CHECK(bench.names({"c0", "ref"}) == Words{{"gyro_10"}, {"ref"}});
  // A name wins over a pattern, as written in the header too.
  CHECK(bench.names({"acc*"}) == Words{{"acc*"}});
  CHECK(bench.names({"gyro_2[deg/s]"}) == Words{{"gyro_2"}});
  // What another word names, or an earlier pattern took, is not meant again; the time never is.
  CHECK(bench.names({"gyro*", "gyro_2", "*"}, {"ref"}) == Words{{"gyro_1", "gyro_10"}, {"gyro_2"}, {"acc*"}});
}

TEST_CASE("channel names: new names stand for all columns") {
  const NamesBench bench;
  ReadOptions options;
  options.names = {"a10", "a9", "b", "c", "d"};
  CHECK(bench.names({"a*", "c4"}, {}, options) == Words{{"a9", "a10"}, {"d"}});
}

TEST_CASE("channel names: a word for nothing is refused with what there is") {
  const NamesBench bench;
  CHECK_THAT(bench.refusal({"gyr?"}), Contains("E0320") && Contains("no channel matches this pattern") &&
                                          Contains("gyro_10, gyro_2, gyro_1, acc*, ref"));
  CHECK_THAT(bench.refusal({"gyro_3"}), Contains("E0320") && Contains("did you mean gyro_"));
  CHECK_THAT(bench.refusal({"ref", "re*"}), Contains("E0320") && Contains("named elsewhere"));
  CHECK_THAT(bench.refusal({"t"}), Contains("time column"));
}

TEST_CASE("channels of a reading are patterns too, in the order of the file") {
  ReadOptions options;
  options.channels = {"gyro*", "ref"};
  const Recording recording = test::read_text(kChannelRows, options);
  REQUIRE(recording.info.channels.size() == 4);
  CHECK(recording.info.channels[0].name == "gyro_10");
  CHECK(recording.info.channels[3].name == "ref");
  CHECK(recording.samples[1][0] == 2);
  options.channels = {"acc*"};
  CHECK(test::read_text(kChannelRows, options).info.channels.size() == 1);
  options.channels = {"x*"};
  CHECK_THAT(test::failure(kChannelRows, options), Contains("E0320") && Contains("pattern"));
}
