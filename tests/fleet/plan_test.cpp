// Plans: what is planned, what comes back of a file, what is refused.

#include "libchar/fleet/plan.hpp"

#include <sys/stat.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <set>

#include "libchar/core/error.hpp"
#include "tests/fleet/fleet_folder.hpp"

using namespace libchar;
using Catch::Contains;

TEST_CASE("a unit a log, or one a channel, the plan reads back") {
  const test::TemporaryFolder folder;
  const auto logs = test::write_logs(folder.path(), 3);
  CHECK(test::planned(logs).units.size() == 3);
  FleetPlanOptions options;
  options.by_channel = true;
  const FleetPlan plan = test::planned(logs, options);
  REQUIRE(plan.units.size() == 6);
  CHECK(plan.units[1].options->reading.channels == std::vector<std::string>{"gy"});
  CHECK(plan.units[0].cost.seconds > 0);
  CHECK(plan.units[0].cost.memory_bytes > 1000000);
  std::set<std::string> ids;
  for (const FleetUnit& unit : plan.units) ids.insert(unit.id);
  CHECK(ids.size() == 6);
  write_plan(plan, folder / "F");
  const FleetPlan again = read_plan(folder / "F");
  REQUIRE(again.units.size() == 6);
  for (std::size_t k = 0; k < 6; ++k) CHECK(unit_text(again.units[k]) == unit_text(plan.units[k]));
  CHECK(again.devices[2].device == "d2");
  CHECK(again.devices[2].sha256 == plan.devices[2].sha256);
}

TEST_CASE("a long log's channels can be units too: stretches of each, and a join") {
  const test::TemporaryFolder folder;
  std::string bytes(2 * kLeafSamples * 2, 'x');  // one leaf and a bit of two channels, a byte each
  bytes.resize(2 * (kLeafSamples + 1000));
  test::write_file(folder / "long.i8", bytes);
  test::write_file(folder / "long.i8.json",
                   R"({"dtype": "i8", "rate_hz": 100, "channels": [{"name": "a"}, {"name": "b"}]})");
  FleetPlanOptions options;
  options.split_bytes = 1 << 20U;
  options.stretch_bytes = 1 << 20U;
  const std::vector<std::string> logs = {(folder / "long.i8").string()};
  CHECK(test::planned(logs, options).units.size() == 3);
  options.by_channel = true;
  const FleetPlan plan = test::planned(logs, options);
  REQUIRE(plan.units.size() == 6);
  CHECK(plan.units[2].kind == UnitKind::join);
  CHECK(plan.units[3].kind == UnitKind::stretch);
  CHECK(plan.units[3].options->reading.channels == std::vector<std::string>{"b"});
}

TEST_CASE("a large log that cannot be divided is one unit, and the plan says why") {
  const test::TemporaryFolder folder;
  FleetPlanOptions options;
  options.split_bytes = 100;
  options.by_channel = true;
  const FleetPlan plan = test::planned(test::write_logs(folder.path(), 2), options);
  REQUIRE(plan.undivided.size() == 1);
  CHECK(plan.undivided.begin()->first == "its rows have no fixed places (csv)");
  CHECK(plan.undivided.begin()->second == std::set<std::size_t>{0, 1});
  CHECK(test::planned(test::write_logs(folder.path(), 2)).undivided.empty());
}

TEST_CASE("a shorter plan in the same folder leaves no task of the longer one") {
  const test::TemporaryFolder folder;
  auto logs = test::write_logs(folder.path(), 3);
  write_plan(test::planned(logs), folder / "F");
  logs.pop_back();
  write_plan(test::planned(logs), folder / "F");
  CHECK(std::filesystem::exists(folder / "F" / task_file(1)));
  CHECK_FALSE(std::filesystem::exists(folder / "F" / task_file(2)));
}

TEST_CASE("one log twice is refused, and so are logs that cannot be read unless they may be skipped") {
  const test::TemporaryFolder folder;
  auto logs = test::write_logs(folder.path(), 2);
  std::filesystem::copy_file(logs[0], folder / "copy.csv");
  auto twice = logs;
  twice.push_back((folder / "copy.csv").string());
  CHECK_THROWS_WITH(test::planned(twice), Contains("d0 and copy are the same, byte by byte"));
  auto broken = logs;
  test::write_file(folder / "broken.npy", "\x93NUMPY, and no more");
  broken.push_back((folder / "broken.npy").string());
  broken.push_back((folder / "absent.csv").string());
  CHECK_THROWS_WITH(test::planned(broken), Contains("2 of 4 logs cannot be read") && Contains("`skip_unreadable`"));
  FleetPlanOptions options;
  options.skip_unreadable = true;
  const FleetPlan plan = test::planned(broken, options);
  CHECK(plan.units.size() == 2);
  CHECK_THAT(plan.devices[3].problem, Contains("absent.csv"));
}

TEST_CASE("a task that a power cut has torn is read from the plan, one that was changed is not") {
  const test::TemporaryFolder folder;
  const FleetPlan plan = test::planned(test::write_logs(folder.path(), 3));
  write_plan(plan, folder / "F");
  const std::string task = (folder / "F" / task_file(1)).string();
  const std::string whole = test::slurp(task);
  CHECK(read_task(task).id == plan.units[1].id);
  for (const std::string& torn : {std::string(), whole.substr(0, 300), std::string(whole.size(), '\0')}) {
    test::write_file(task, torn);
    CHECK(unit_text(read_task(task)) + "\n" == whole);
  }
  std::filesystem::remove(task);
  CHECK(unit_text(read_task(task)) + "\n" == whole);
  CHECK(fleet_of_task(task) == folder / "F");
  test::write_file((folder / "tasks-alone.json").string(), whole);
  CHECK_THROWS_WITH(fleet_of_task((folder / "tasks-alone.json").string()),
                    Contains("E0784") && Contains("there is no plan next to it"));
  test::write_file(task, test::slurp(folder / "F" / task_file(0)).replace(10, 5, "xxxxx"));
  CHECK_THROWS_AS(read_task(task), Error);
  // Of no plan, or of a longer one that is not there any more.
  test::write_file((folder / "F" / task_file(3)).string(), "");
  CHECK_THROWS_WITH(read_task((folder / "F" / task_file(3)).string()), Contains("is empty"));
  std::filesystem::remove(folder / "F" / "plan.jsonl");
  test::write_file(task, "");
  CHECK_THROWS_WITH(read_task(task), Contains("is empty"));
  for (const auto& entry : std::filesystem::directory_iterator(folder / "F" / "tasks"))
    CHECK(entry.path().filename().string().size() == std::string("000001.json").size());
}

TEST_CASE("limits that cannot be read are told before the work") {
  const test::TemporaryFolder folder;
  Manifest manifest = manifest_of_logs(test::write_logs(folder.path(), 2));
  manifest.devices[1].limits = (folder / "sheet.yaml").string();
  manifest.devices[1].where = "line7.yaml:7:5";
  CHECK_THROWS_WITH(plan_fleet(manifest, {}), Contains("sheet.yaml") && Contains("line7.yaml:7:5"));
}

TEST_CASE("limits that fit no channel are told before the work, with the entry of the manifest") {
  const test::TemporaryFolder folder;
  Manifest manifest = manifest_of_logs(test::write_logs(folder.path(), 2));
  const auto planned_with = [&](const std::string& block) {
    test::write_file(folder / "sheet.yaml", "format: noise-limits\nversion: 1\nlimits:\n  - " + block + "\n");
    manifest.devices[1].limits = (folder / "sheet.yaml").string();
    manifest.devices[1].where = "line7.yaml:7:5";
    return plan_fleet(manifest, {});
  };
  CHECK_NOTHROW(planned_with("{channels: [gy], white_noise: {value: 5, unit: deg/√h}}"));
  CHECK_THROWS_WITH(planned_with("{channels: [gq], white_noise: {value: 5, unit: deg/√h}}"),
                    Contains("line7.yaml:7:5") && Contains("sheet.yaml:4") && Contains("gq"));
  CHECK_THROWS_WITH(planned_with("{channels: [gy], white_noise: {value: 5, unit: m/s/√h}}"),
                    Contains("line7.yaml:7:5") && Contains("m/s/√h"));
  CHECK_THROWS_WITH(planned_with("{kind: acceleration, white_noise: {value: 5, unit: m/s/√h}}"),
                    Contains("acceleration"));
  // A channel that only the other device of its type has.
  test::write_file(folder / "d0.csv", "t[s],ax[m/s^2]\n0,1\n0.01,2\n0.02,3\n");
  CHECK_NOTHROW(planned_with("{channels: [ax], white_noise: {value: 5, unit: m/s/√h}}"));
  manifest.devices[0].type = "other";
  CHECK_THROWS_WITH(planned_with("{channels: [ax], white_noise: {value: 5, unit: m/s/√h}}"), Contains("ax"));
  // Limits without a type hold for types that have none too, as in the lot.
  CHECK_THROWS_WITH(planned_with("{channels: [gy], white_noise: {value: 5, unit: deg/√h}}"),
                    Contains("line7.yaml:7:5") && Contains("gy"));
  manifest.devices[0].limits = (folder / "other.yaml").string();
  test::write_file(folder / "other.yaml",
                   "format: noise-limits\nversion: 1\nlimits:\n  - {white_noise: {value: 5, unit: m/s/√h}}\n");
  CHECK_NOTHROW(planned_with("{channels: [gy], white_noise: {value: 5, unit: deg/√h}}"));
  // Angles: their rates are known once they are read.
  manifest.options[0].data = SampleKind::phase;
  CHECK_NOTHROW(planned_with("{channels: [ax], white_noise: {value: 5, unit: m/s/√h}}"));
}

TEST_CASE("what a plan replaces is known, and what is no plan is not overwritten") {
  const test::TemporaryFolder folder;
  const auto logs = test::write_logs(folder.path(), 3);
  CHECK_FALSE(plan_in(folder / "F"));
  const FleetPlan plan = test::planned(logs);
  write_plan(plan, folder / "F");
  REQUIRE(plan_in(folder / "F"));
  CHECK(plan_in(folder / "F")->devices == 3);
  test::run_all(plan, folder / "F");
  CHECK(results_of_others(plan, folder / "F") == 0);
  CHECK(results_of_others(test::planned({logs[1]}), folder / "F") == 2);
  const std::string file = (folder / "F" / "plan.jsonl").string();
  const std::string text = test::slurp(file);
  for (const std::size_t size : {std::size_t{0}, std::size_t{5}, std::size_t{60}}) {
    test::write_file(file, text.substr(0, size));
    CHECK(plan_in(folder / "F")->damaged);
    CHECK_THROWS_WITH(read_plan(folder / "F"), Contains("E0784") && Contains("fleet plan"));
    CHECK_NOTHROW(write_plan(plan, folder / "F"));
  }
  std::filesystem::create_directory(folder / "G");
  test::write_file(folder / "G" / "plan.jsonl", "{\"project\": 1}\n");
  CHECK_THROWS_WITH(write_plan(plan, folder / "G"),
                    Contains("E0784") && Contains("not a plan of a fleet") && Contains("move it away"));
  CHECK(test::slurp(folder / "G" / "plan.jsonl") == "{\"project\": 1}\n");
  CHECK_FALSE(std::filesystem::exists(folder / "G" / "tasks"));
}

TEST_CASE("logs that cannot be read are named with their entries, and no fleet is left of none") {
  const test::TemporaryFolder folder;
  test::write_logs(folder.path(), 1);
  std::string text = "device,log\nA,d0.csv\n";
  for (int k = 1; k < 8; ++k) text += fmt::format("D{},gone{}.csv\n", k, k);
  test::write_file(folder / "m.csv", text);
  const std::string path = (folder / "m.csv").string();
  CHECK_THROWS_WITH(plan_fleet(read_manifest(path), {}), Contains("7 of 8 logs") && Contains("m.csv:3:1: ") &&
                                                             Contains("m.csv:7:1: ") && !Contains("m.csv:8:1: ") &&
                                                             Contains("mend the manifest, or plan"));
  FleetPlanOptions skip;
  skip.skip_unreadable = true;
  CHECK(plan_fleet(read_manifest(path), skip).units.size() == 1);
  test::write_file(folder / "m.csv", "device,log\nA,gone.csv\n");
  CHECK_THROWS_WITH(plan_fleet(read_manifest(path), skip), Contains("1 of 1 logs") && !Contains("skip_unreadable"));
  CHECK_THROWS_WITH(test::planned({(folder / "gone.csv").string()}),
                    Contains("name logs that can be read") && !Contains("manifest"));
  REQUIRE(::mkfifo((folder / "pipe.csv").c_str(), 0600) == 0);
  CHECK_THROWS_WITH(test::planned({(folder / "pipe.csv").string()}), Contains("is not a regular file"));
}

TEST_CASE("a plan that is cut, or is none, is refused") {
  const test::TemporaryFolder folder;
  CHECK_THROWS_WITH(read_plan(folder.path()), Contains("no plan"));
  write_plan(test::planned(test::write_logs(folder.path(), 2)), folder / "F");
  const std::string text = test::slurp(folder / "F" / "plan.jsonl");
  const std::string path = (folder / "F" / "plan.jsonl").string();
  test::write_file(path, text.substr(0, text.rfind("{\"format\"")));
  CHECK_THROWS_WITH(read_plan(folder / "F"), Contains("cut"));
  std::string of_another = text;
  of_another[of_another.find("\"device\":1,") + std::string("\"device\":").size()] = '0';
  test::write_file(path, of_another);
  CHECK_THROWS_WITH(read_plan(folder / "F"), Contains("changed"));
  for (std::size_t at = 0; at + 1 < text.size(); at += 97) {
    test::write_file(path, text.substr(0, at));
    CHECK_THROWS_AS(read_plan(folder / "F"), Error);
  }
}

TEST_CASE("a log without a sampling rate is told before the work") {
  const test::TemporaryFolder folder;
  const auto logs = test::write_logs(folder.path(), 1);
  const std::string stamps_none = (folder / "plain.csv").string();
  test::write_file(stamps_none, "gx,gy\n1,2\n2,1\n1.5,2\n");
  const std::string npy = test::write_long_log(folder / "a.npy", 1, 2000);
  for (const std::string& log : {stamps_none, npy}) {
    CHECK_THROWS_WITH(test::planned({logs[0], log}),
                      Contains("E0782") && Contains("1 of 2 logs") && Contains("`rate_hz`"));
    FleetPlanOptions options;
    options.skip_unreadable = true;
    const FleetPlan plan = test::planned({logs[0], log}, options);
    CHECK(plan.units.size() == 1);
    CHECK_THAT(plan.devices[1].problem, Contains("the sampling rate is not known"));
    CharacterizeOptions given;
    given.reading.rate_hz = 100;
    CHECK(plan_fleet(manifest_of_logs({log}, given), {}).units.size() == 1);
  }
}

TEST_CASE("an option that fits no channel of a log is told when planning") {
  const test::TemporaryFolder folder;
  const auto logs = test::write_logs(folder.path(), 2);
  CharacterizeOptions options;
  options.reading.channel_unit = {"gz=deg/s"};
  const FleetPlan plan = plan_fleet(manifest_of_logs(logs, options), {});
  REQUIRE(plan.warned.size() == 2);
  CHECK(plan.warned[0].first == logs[0]);
  CHECK(plan.warned[0].second.find("unused_option") != nullptr);
  CHECK(test::planned(logs).warned.empty());
}
