// The same results wherever and however the program runs: the same bytes on one processor, eight digits on another.

#include <catch2/catch.hpp>
#include <filesystem>
#include <map>

#include "tests/support/run.hpp"

using Catch::Contains;

namespace {

namespace files = std::filesystem;

/// Name and content of every file of a result.
std::map<std::string, std::string> contents(const files::path& folder) {
  std::map<std::string, std::string> out;
  for (const auto& entry : files::directory_iterator(folder))
    out[entry.path().filename().string()] = test::slurp(entry.path());
  return out;
}

struct Surroundings {
  std::string what;
  test::RunOptions options;
};

/// Runs the same words in each of the surroundings, into a folder of one name below another.
void check_same_bytes(const std::vector<std::string>& words) {
  const test::TemporaryFolder folder;
  const std::vector<Surroundings> surroundings = {
      {"plain", {}},
      {"again", {}},
      {"another locale", {{"LC_ALL=de_DE.UTF-8", "LANG=de_DE.UTF-8"}, "", "", "/dev/null"}},
      {"another time zone", {{"TZ=Pacific/Apia"}, "", "", "/dev/null"}},
      {"a bare terminal", {{"TERM=dumb", "COLUMNS=20", "HOME="}, "", "", "/dev/null"}}};
  std::map<std::string, std::string> first;
  for (const Surroundings& where : surroundings) {
    CAPTURE(where.what);
    test::RunOptions options = where.options;
    // The command stands in the report: the same words, in a folder of its own.
    options.folder = (folder / where.what).string();
    files::create_directory(options.folder);
    std::vector<std::string> all = words;
    all.insert(all.end(), {"-o", "out"});
    REQUIRE(test::run(all, options).code == 0);
    const auto now = contents(files::path(options.folder) / "out");
    CHECK(now.size() >= 4);
    if (first.empty()) first = now;
    for (const auto& [name, text] : first) {
      CAPTURE(name);
      CHECK(now.count(name) == 1);
      CHECK((now.count(name) == 1 && now.at(name) == text));
    }
  }
}

}  // namespace

TEST_CASE("the same bytes in any locale, time zone, folder and run: characterize and replay") {
  check_same_bytes({"characterize", test::fixture("imu_at_rest.csv"), "--no-timing"});
  check_same_bytes({"replay", test::fixture("scenes/lever-arm.yaml"), "--no-timing"});
}

TEST_CASE("processor features hidden from the C library: eight digits, said as such") {
  const test::TemporaryFolder folder;
  test::RunOptions masked;
  masked.environment = {"GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX2,-FMA,-AVX512F,-AVX512VL"};
  for (const std::vector<std::string>& words :
       {std::vector<std::string>{"characterize", test::fixture("imu_at_rest.csv")},
        std::vector<std::string>{"replay", test::fixture("scenes/rv-3.3-calibrated.yaml")}}) {
    CAPTURE(words[0]);
    std::vector<std::string> all = words;
    const std::string out = (folder / words[0]).string();
    all.insert(all.end(), {"-o", out});
    REQUIRE(test::run(all).code == 0);
    const auto ran = test::run({"verify", out, "--rerun", out + "-again", "--allow-read"}, masked);
    INFO(ran.out);
    CHECK(ran.code == 0);
  }
}
