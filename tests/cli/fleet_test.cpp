// The verbs of fleets as a user types them.

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/fleet/fleet_folder.hpp"
#include "tests/support/run.hpp"

using Catch::Contains;
namespace fs = std::filesystem;

namespace {

/// Small logs, and fleets of them; words are taken in its folder.
struct Fleets {
  test::TemporaryFolder folder;
  explicit Fleets(std::size_t logs) { test::write_logs(folder.path(), logs); }

  test::Ran run(std::vector<std::string> words) const {
    words.insert(words.begin(), "fleet");
    test::RunOptions options;
    options.folder = folder.path().string();
    return test::run(words, options);
  }
  std::string made(const std::string& name, const std::vector<std::string>& what) const {
    std::vector<std::string> words = {"plan", "-o", name};
    words.insert(words.end(), what.begin(), what.end());
    for (const auto& step : {words, std::vector<std::string>{"run", name}}) {
      const test::Ran ran = run(step);
      INFO(ran.err);
      REQUIRE(ran.code == 0);
    }
    return name;
  }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name) << text;
  }
  test::Ran refused(const std::vector<std::string>& words) const {
    test::Ran ran = run(words);
    CHECK(ran.code != 0);
    CHECK(ran.out.empty());
    return ran;
  }
};

constexpr const char* kTwoBatches =
    "log,device,batch\nd0.csv,A1,\"1,x\"\nd1.csv,A2,\"1,x\"\nd2.csv,A1,2\nd3.csv,A3,2\nd4.csv,A4,2\n";

}  // namespace

TEST_CASE("fleet compare: a lot is compared with another one only") {
  const Fleets fleets(4);
  fleets.made("a", {"d0.csv", "d1.csv"});
  fleets.made("b", {"d2.csv", "d3.csv"});
  fleets.made("c", {"d2.csv", "d0.csv"});
  const test::Ran ran = fleets.run({"compare", "b", "a"});
  CHECK(ran.code == 0);
  CHECK_THAT(ran.out,
             Contains("2 devices of b and 2 devices of a") && Contains("told by all of them"));
  CHECK_THAT(fleets.refused({"compare", "a", "a"}).err, Contains("E0795"));
  CHECK_THAT(fleets.refused({"compare", "a", "./a/"}).err, Contains("E0795"));
  CHECK_THAT(fleets.refused({"compare", "a", "c"}).err, Contains("E0783") && Contains("d0 in a"));
}

TEST_CASE("fleet compare: batches by name, with commas too, and a device in one of them") {
  const Fleets fleets(5);
  fleets.write("m.csv", kTwoBatches);
  fleets.made("f", {"m.csv"});
  const test::Ran ran =
      fleets.run({"compare", "f", "--batches", "1,x", "--batches", "2", "--json"});
  INFO(ran.err);
  REQUIRE(ran.code == 0);
  CHECK(test::schema_fault(ran.out) == "");
  const auto document = nlohmann::json::parse(ran.out);
  CHECK(document["a"]["devices"] == 2);
  CHECK(document["b"]["devices"] == 2);
  CHECK_THAT(document["notes"][0].get<std::string>(), Contains("A1 (batch 1,x, batch 2)"));
  CHECK_THAT(fleets.refused({"compare", "f", "--batches", "2,2"}).err,
             Contains("a batch is compared with another one; got \"2\""));
  CHECK_THAT(fleets.refused({"compare", "f", "--batches", "1,x,2"}).err,
             Contains("--batches OLD --batches NEW"));
  CHECK_THAT(fleets.refused({"compare", "f", "--batches", "2,3"}).err,
             Contains("batch 1,x, batch 2"));
}
