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
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder / name) << text; }
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
  CHECK_THAT(ran.out, Contains("2 devices of b and 2 devices of a") && Contains("decided over all of them"));
  CHECK_THAT(fleets.refused({"compare", "a", "a"}).err, Contains("E0795"));
  CHECK_THAT(fleets.refused({"compare", "a", "./a/"}).err, Contains("E0795"));
  CHECK_THAT(fleets.refused({"compare", "a", "c"}).err, Contains("E0783") && Contains("d0 in a"));
}

TEST_CASE("fleet compare: batches by name, with commas too, and a device in one of them") {
  const Fleets fleets(5);
  fleets.write("m.csv", kTwoBatches);
  fleets.made("f", {"m.csv"});
  const test::Ran ran = fleets.run({"compare", "f", "--batches", "1,x", "--batches", "2", "--json"});
  INFO(ran.err);
  REQUIRE(ran.code == 0);
  CHECK(test::schema_fault(ran.out) == "");
  const auto document = nlohmann::json::parse(ran.out);
  CHECK(document["a"]["devices"] == 2);
  CHECK(document["b"]["devices"] == 2);
  CHECK_THAT(document["notes"][0].get<std::string>(), Contains("A1 (batch 1,x, batch 2)"));
  CHECK_THAT(fleets.refused({"compare", "f", "--batches", "2,2"}).err,
             Contains("a batch is compared with another one; got \"2\""));
  CHECK_THAT(fleets.refused({"compare", "f", "--batches", "1,x,2"}).err, Contains("--batches OLD --batches NEW"));
  CHECK_THAT(fleets.refused({"compare", "f", "--batches", "2,3"}).err, Contains("batch 1,x, batch 2"));
}

TEST_CASE("fleet merge and the verbs for other reports: what a lot's report is") {
  const Fleets fleets(2);
  fleets.made("f", {"d0.csv", "d1.csv"});
  CHECK_THAT(fleets.refused({"merge", "f", "-o", "-"}).err, Contains("name a folder"));
  CHECK_THAT(fleets.refused({"plan", "d0.csv", "-o", "-"}).err, Contains("name a folder"));
  CHECK_FALSE(fs::exists(fleets.folder / "-"));
  REQUIRE(fleets.run({"merge", "f", "-o", "r"}).code == 0);
  for (const char* report : {"r", "r/lot.json"}) {
    const std::string path = (fleets.folder / report).string();
    const test::Ran table = test::run({"report", path}), compared = test::run({"compare", path, path});
    CHECK(table.code == 3);
    CHECK_THAT(table.err, Contains("report of a lot of devices") && Contains("coefficients.csv"));
    CHECK(compared.code == 3);
    CHECK_THAT(compared.err, Contains("sensorchar fleet compare A B"));
  }
}

TEST_CASE("fleet status and export: what comes next, in which folder") {
  const Fleets fleets(2);
  REQUIRE(fleets.run({"plan", "d0.csv", "d1.csv", "-o", "f"}).code == 0);
  CHECK_THAT(fleets.run({"export", "f", "--to", "parallel"}).out,
             Contains("2 units left") && Contains("next: cd f && sh fleet.parallel.sh"));
  REQUIRE(fleets.run({"run", "f"}).code == 0);
  CHECK_THAT(fleets.run({"status", "f"}).out, Contains("next: sensorchar fleet merge f -o report\n"));
  CHECK(fleets.run({"export", "f", "--to", "parallel"}).out ==
        "nothing is left, every unit has a result\nnext: sensorchar fleet merge f -o report\n");
  test::RunOptions inside;
  inside.folder = (fleets.folder / "f").string();
  CHECK_THAT(test::run({"fleet", "status", "."}, inside).out,
             Contains("next: sensorchar fleet merge . -o ../report\n"));
}

TEST_CASE("fleet status: whose results are damaged") {
  const Fleets fleets(2);
  fleets.made("f", {"d0.csv", "d1.csv"});
  for (const auto& entry : fs::recursive_directory_iterator(fleets.folder / "f" / "results"))
    if (entry.path().filename() == "device.record") fs::resize_file(entry.path(), 100);
  const test::Ran ran = fleets.run({"status", "f", "--json"});
  const auto document = nlohmann::json::parse(ran.out);
  REQUIRE(document["damaged_units"].size() == 2);
  const auto& second = document["damaged_units"][1];
  CHECK(second["task"] == "tasks/000002.json");
  CHECK(second["device"] == "d1");
  CHECK(second["problem"] == document["damaged"][1]);
  CHECK_THAT(second["problem"].get<std::string>(), Contains(second["id"].get<std::string>()));
}
