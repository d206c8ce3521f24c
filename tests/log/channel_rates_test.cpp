// Rates of channels of a table without stamps: blanks between the samples of the slow ones, or columns side by side.

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>

#include "tests/log/log_text.hpp"

using namespace libchar;

namespace {

ReadOptions with_rates(std::vector<std::string> rates, std::vector<std::string> channels = {}) {
  ReadOptions options;
  options.unsaid.channel_rate = std::move(rates);
  options.channels = std::move(channels);
  return options;
}

/// Every 20th row has a value of the slow channel.
std::string with_blanks(int rows) {
  std::string text = "fast,slow\n";
  for (int i = 0; i < rows; ++i) text += fmt::format("{}.5,{}\n", i, i % 20 == 3 ? fmt::to_string(i / 20) : "");
  return text;
}

/// The slow column ends after a 20th of the rows.
std::string side_by_side(int rows) {
  std::string text = "fast,slow\n";
  for (int i = 0; i < rows; ++i) text += fmt::format("{}.5,{}\n", i, i < rows / 20 ? fmt::to_string(i) : "");
  return text;
}

}  // namespace

TEST_CASE("channels of unlike rates without stamps: each has its own rate, whatever the blanks and the blocks") {
  for (const bool blanks : {true, false})
    for (const std::size_t block : {std::size_t{64}, std::size_t{1} << 21U}) {
      INFO(blanks << " blanks, blocks of " << block);
      const std::string text = blanks ? with_blanks(12000) : side_by_side(12000);
      ReadOptions options = with_rates({"fast=200Hz", "slow=10Hz"}, {"slow"});
      options.block_bytes = block;
      const Recording slow = test::read_text(text, options);
      CHECK(slow.info.time.rate_hz == Approx(10));
      CHECK(slow.info.time.missing_samples == 0);
      REQUIRE(slow.samples[0].size() == 600);
      for (int k = 0; k < 600; ++k) CHECK(slow.samples[0][static_cast<std::size_t>(k)] == k);
      options.channels = {"fast"};
      const Recording fast = test::read_text(text, options);
      CHECK(fast.info.time.rate_hz == Approx(200));
      CHECK(fast.samples[0].size() == 12000);
      options.channels.clear();
      const Recording both = test::read_text(text, options);
      CHECK(both.samples[0].size() == 12000);
      CHECK(both.info.time.rate_hz == Approx(200));
      CHECK(test::count(both, "slow_channel") == 1);
      const std::size_t at = blanks ? 20 * 77 + 3 : 20 * 77;  // the 77th slow sample, at its instant
      CHECK(both.samples[1][at] == 77);
      CHECK(std::isnan(both.samples[1][at + 1]));
    }
}

TEST_CASE("rates of channels by patterns, beside the rate of all others") {
  ReadOptions options = with_rates({"sl*=10"}, {"slow"});
  options.rate_hz = 200;
  CHECK(test::read_text(with_blanks(4000), options).info.time.rate_hz == Approx(10));
  CHECK(test::read_text(side_by_side(4000), options).info.time.rate_hz == Approx(10));
  CHECK(test::read_text(side_by_side(4000), with_rates({"*=50"})).info.time.rate_hz == Approx(50));
}

TEST_CASE("rates of channels that cannot be are refused with what can") {
  const auto fault = [](const std::string& text, std::vector<std::string> rates) {
    return test::failure(text, with_rates(std::move(rates)));
  };
  CHECK_THAT(fault(with_blanks(4000), {"fast=200Hz", "slow=50Hz"}),
             Catch::Contains("E0342") && Catch::Contains("`channel_rate` slow=10"));
  CHECK_THAT(fault(with_blanks(4000), {"fast=200Hz"}), Catch::Contains("E0331"));
  CHECK_THAT(fault(with_blanks(4000), {"fast=200Hz", "slow=10Hz", "slwo=10Hz"}), Catch::Contains("E0331"));
  CHECK_THAT(fault(with_blanks(4000), {"*=200±1Hz"}), Catch::Contains("uncertainty"));
  CHECK_THAT(fault("t,x\n0,1\n0.1,2\n0.2,3\n", {"*=200Hz"}),
             Catch::Contains("E0205") && Catch::Contains("time_column"));
}
