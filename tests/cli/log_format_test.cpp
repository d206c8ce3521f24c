// What a log format from outside the library's folder costs, and where it turns up.

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "tests/support/run.hpp"
#include "tests/support/shared.hpp"

using Catch::Contains;

TEST_CASE("a log format is one file and one line: options, help, readers and JSON find it") {
  const std::string program = std::filesystem::path(test::program())
                                  .replace_filename("sensorchar_with_count_words")
                                  .string();
  const test::TemporaryFolder folder;
  const std::string log = (folder / "x.bytes").string();
  std::ofstream(log, std::ios::binary) << std::string("\1\2\3\2\1\2\3\2", 8);
  CHECK_THAT(test::run_words({program, "inspect", "--help"}).out,
             Contains("auto|bytes|csv|npy|raw"));
  CHECK_THAT(test::run_words({program, "allan", "--help"}).out, Contains(".bytes, .csv"));
  const auto json = test::run_words({program, "inspect", log, "--rate", "10Hz", "--json"});
  INFO(json.err);
  CHECK(json.code == 0);
  CHECK_THAT(json.out, Contains("\"bytes\""));
  // It is read only, and no other program knows it.
  CHECK_THAT(test::run_words({program, "convert", "--help"}).out, !Contains(".bytes"));
  CHECK(test::run({"inspect", log, "--format", "bytes"}).code == 2);
}
