// Workers: whole results or none, whoever is killed, whoever is first.

#include <fmt/ranges.h>
#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <thread>

#include "libchar/core/error.hpp"
#include "libchar/fleet/detail/result_store.hpp"
#include "libchar/fleet/jobs.hpp"
#include "libchar/fleet/plan.hpp"
#include "tests/fleet/fleet_folder.hpp"

using namespace libchar;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

fs::path result_of(const fs::path& fleet, const FleetUnit& unit) { return fleet / "results" / result_folder(unit.id); }

std::string all_records(const FleetPlan& plan, const fs::path& fleet) {
  std::string out;
  for (const DeviceRecord& record : merged_records(plan, fleet)) out += device_record_text(record) + "\n";
  return out;
}

}  // namespace

TEST_CASE("a unit is done once, its folder has the record and the reports") {
  const test::TemporaryFolder folder;
  const FleetPlan plan = test::planned(test::write_logs(folder.path(), 1));
  const fs::path fleet = folder / "F";
  CHECK(run_unit(plan.units[0], fleet).outcome == UnitOutcome::done);
  CHECK(run_unit(plan.units[0], fleet).outcome == UnitOutcome::already_there);
  for (const char* name : {"device.record", "report.html", "report.json", "curves.csv", "gx.sensor.yaml"})
    CHECK(fs::exists(result_of(fleet, plan.units[0]) / name));
  const auto record = stored_record(fleet, plan.units[0].id);
  REQUIRE(record);
  REQUIRE(record->channels.size() == 2);
  CHECK(record->channels[1].name == "gy");
  CHECK(record->channels[1].fitted);
  CHECK(record->settings == settings_id(*plan.units[0].options));
  CHECK(unpublished(fleet).empty());
}

TEST_CASE("results do not depend on the order, on the folder, or on channels being units of their own") {
  const test::TemporaryFolder folder;
  const auto logs = test::write_logs(folder.path(), 3);
  const FleetPlan plan = test::planned(logs);
  test::run_all(plan, folder / "A");
  for (std::size_t k = plan.units.size(); k-- > 0;) run_unit(plan.units[k], folder / "B");
  for (const FleetUnit& unit : plan.units)
    for (const char* name : {"device.record", "report.html", "report.json", "curves.csv"})
      CHECK(test::slurp(result_of(folder / "A", unit) / name) == test::slurp(result_of(folder / "B", unit) / name));
  FleetPlanOptions options;
  options.by_channel = true;
  options.reports = false;
  const FleetPlan channels = test::planned(logs, options);
  test::run_all(channels, folder / "C");
  const auto whole = merged_records(plan, folder / "A");
  const auto parts = merged_records(channels, folder / "C");
  REQUIRE(parts.size() == whole.size());
  for (std::size_t d = 0; d < whole.size(); ++d) CHECK(parts[d].channels == whole[d].channels);
}

TEST_CASE("channels that are units of their own are what the whole log says of them") {
  const test::TemporaryFolder folder;
  Manifest manifest;
  const auto check = [&](const char* name, const std::vector<std::size_t>& units_of_devices) {
    INFO(name);
    FleetPlanOptions options;
    options.reports = false;
    const FleetPlan whole = plan_fleet(manifest, options);
    options.by_channel = true;
    const FleetPlan parts = plan_fleet(manifest, options);
    std::vector<std::size_t> units(parts.devices.size());
    for (const FleetUnit& unit : parts.units) ++units[unit.device];
    CHECK(units == units_of_devices);
    test::run_all(whole, folder / "W");
    test::run_all(parts, folder / "P");
    const auto expected = merged_records(whole, folder / "W"), found = merged_records(parts, folder / "P");
    REQUIRE(found.size() == expected.size());
    for (std::size_t d = 0; d < found.size(); ++d) {
      REQUIRE(found[d].problem.empty());
      CHECK(found[d].channels == expected[d].channels);
      CHECK(found[d].temperature_c == expected[d].temperature_c);
      CHECK(found[d].settings == expected[d].settings);
      CHECK(found[d].findings == expected[d].findings);
    }
  };
  // Lists, an entry a channel: a unit has its own, and chooses by what the log says.
  const std::string rows = test::write_rows(folder / "rows.npy", 3, 4000);
  manifest = manifest_of_logs({rows});
  ReadOptions& reading = manifest.options[0].reading;
  reading.rate_hz = 100;
  check("plain", {3});
  reading.units = {"deg/s"};
  check("a unit for all", {3});
  reading.units = {"deg/s", "0.5 deg/s", "m/s^2"};
  check("units", {3});
  reading.names = {"gx", "c0", "ax"};
  check("names and units", {3});
  reading.units.clear();
  reading.channel_unit = {"*=deg/s", "a*=m/s^2", "b=g"};
  reading.channel_scale = {"gx=1/16.4"};
  check("values by name", {3});
  reading.channels = {"c1", "c2"};
  reading.names = {"y", "z"};
  check("of chosen channels", {2});
  // Stretches.
  const std::string most = test::write_rows(folder / "most.npy", 2, kLeafSamples + 1000);
  FleetPlanOptions options;
  options.split_bytes = 1 << 20U;
  options.by_channel = true;
  manifest = manifest_of_logs({most});
  manifest.options[0].reading.names = {"a", "b"};
  manifest.options[0].reading.rate_hz = 100;
  const FleetPlan stretches = plan_fleet(manifest, options);
  REQUIRE(stretches.units.size() == 4);
  test::run_all(stretches, folder / "S");
  const auto joined = merged_records(stretches, folder / "S");
  REQUIRE(joined[0].problem.empty());
  REQUIRE(joined[0].channels.size() == 2);
  CHECK(joined[0].channels[1].name == "b");
}

TEST_CASE("a thermometer is read with each channel that is a unit, and is there once") {
  const test::TemporaryFolder folder;
  std::vector<std::string> logs;
  for (const std::size_t place : {0, 1, 2}) {
    test::Gaussian gauss(place + 1);
    std::vector<std::string> heads = {"gx[deg/s]", "gy[deg/s]"};
    heads.insert(heads.begin() + static_cast<std::ptrdiff_t>(place), "temp[degC]");
    std::string text = fmt::format("t[s],{}\n", fmt::join(heads, ","));
    for (std::size_t k = 0; k < 2000; ++k) {
      const double degrees = 20 + 1e-2 * static_cast<double>(k);
      std::vector<double> values = {gauss() + degrees, gauss() - degrees};
      values.insert(values.begin() + static_cast<std::ptrdiff_t>(place), degrees);
      text += fmt::format("{:.2f},{:.6f}\n", 1e-2 * static_cast<double>(k), fmt::join(values, ","));
    }
    logs.push_back((folder / fmt::format("d{}.csv", place)).string());
    test::write_file(logs.back(), text);
  }
  Manifest manifest = manifest_of_logs(logs);
  manifest.options[0].temperature = "temp";
  FleetPlanOptions options;
  const FleetPlan whole = plan_fleet(manifest, options);
  options.by_channel = true;
  const FleetPlan parts = plan_fleet(manifest, options);
  CHECK(parts.units.size() == 6);
  test::run_all(whole, folder / "W");
  test::run_all(parts, folder / "P");
  const auto expected = merged_records(whole, folder / "W"), found = merged_records(parts, folder / "P");
  for (std::size_t d = 0; d < 3; ++d) {
    REQUIRE(found[d].problem.empty());
    REQUIRE(found[d].channels.size() == 3);
    CHECK(found[d].channels == expected[d].channels);
    CHECK(found[d].temperature_c == expected[d].temperature_c);
    CHECK(found[d].settings == expected[d].settings);
  }
  manifest.options[0].reading.names = {"x", "y", "temp"};
  CHECK_THROWS_WITH(plan_fleet(manifest, options), Contains("E0702") && Contains("no unit can be of one channel"));
  // A place is one among the channels that are read.
  manifest.options[0].reading.names.clear();
  manifest.options[0].temperature = "c2";
  manifest.devices.erase(manifest.devices.begin(), manifest.devices.begin() + 2);
  const FleetPlan by_place = plan_fleet(manifest, options);
  test::run_all(by_place, folder / "Q");
  CHECK(merged_records(by_place, folder / "Q")[0].channels == expected[2].channels);
}

TEST_CASE("a damaged result counts as none, is named, and is computed again") {
  const test::TemporaryFolder folder;
  const FleetPlan plan = test::planned(test::write_logs(folder.path(), 2));
  const fs::path fleet = folder / "F";
  test::run_all(plan, fleet);
  const std::string before = all_records(plan, fleet);
  const fs::path file = result_of(fleet, plan.units[1]) / "device.record";
  std::string text = test::slurp(file);
  text[text.size() / 2] ^= 1;
  test::write_file(file.string(), text);
  const FleetStatus status = fleet_status(plan, fleet);
  CHECK(status.done == 1);
  REQUIRE(status.damaged.size() == 1);
  CHECK_THAT(status.damaged[0], Contains("damaged") && Contains(plan.units[1].id));
  CHECK_THROWS_WITH(merged_records(plan, fleet), Contains("1 of 2 units have no result") && Contains("d1"));
  CHECK(run_unit(plan.units[1], fleet).outcome == UnitOutcome::done);
  CHECK(all_records(plan, fleet) == before);
  test::write_file(file.string(), "");
  CHECK(run_unit(plan.units[1], fleet).outcome == UnitOutcome::done);
  CHECK(all_records(plan, fleet) == before);
}

TEST_CASE("two workers on one unit: one result, no litter") {
  const test::TemporaryFolder folder;
  const FleetPlan plan = test::planned(test::write_logs(folder.path(), 1, 2000));
  const fs::path fleet = folder / "F";
  std::vector<UnitOutcome> outcomes(4);
  std::vector<std::thread> workers;
  for (std::size_t w = 0; w < outcomes.size(); ++w)
    workers.emplace_back([&, w] { outcomes[w] = run_unit(plan.units[0], fleet).outcome; });
  for (std::thread& worker : workers) worker.join();
  CHECK(std::count(outcomes.begin(), outcomes.end(), UnitOutcome::done) == 1);
  CHECK(unpublished(fleet).empty());
  CHECK(stored_record(fleet, plan.units[0].id));
}

TEST_CASE("what a worker that is no more has begun is removed by the next one, that of others stays") {
  const test::TemporaryFolder folder;
  const FleetPlan plan = test::planned(test::write_logs(folder.path(), 1));
  const fs::path fleet = folder / "F";
  const pid_t gone = ::fork();
  if (gone == 0) ::_exit(0);
  REQUIRE(::waitpid(gone, nullptr, 0) == gone);
  std::string mine;
  {
    const ResultFolder working(fleet, plan.units[0].id);
    mine = working.path().filename().string();
  }
  const fs::path parent = result_of(fleet, plan.units[0]).parent_path();
  const auto begun_by = [&](const std::string& machine, long process) {
    const std::string host = mine.substr(0, mine.rfind('-', mine.rfind('-') - 1));
    const std::string name = machine.empty() ? host : host.substr(0, host.rfind('-') + 1) + machine;
    const fs::path path = parent / fmt::format("{}-{}-0", name, process);
    fs::create_directories(path);
    test::write_file(path / "report.json", "{");
    return path;
  };
  const fs::path dead = begun_by("", gone), alive = begun_by("", ::getppid()), elsewhere = begun_by("another", gone);
  CHECK(unpublished(fleet).size() == 3);
  CHECK(run_unit(plan.units[0], fleet).outcome == UnitOutcome::done);
  CHECK_FALSE(fs::exists(dead));
  CHECK(fs::exists(alive));
  CHECK(fs::exists(elsewhere));
  CHECK(fleet_status(plan, fleet).unpublished.size() == 2);
}

TEST_CASE("a log that was changed after planning is told by name, one that is gone may come back") {
  const test::TemporaryFolder folder;
  const auto logs = test::write_logs(folder.path(), 2);
  const FleetPlan plan = test::planned(logs);
  const std::string text = test::slurp(logs[0]);
  std::string other = text;
  other[other.size() - 3] = other[other.size() - 3] == '1' ? '2' : '1';
  test::write_file(logs[0], other);
  CHECK_THROWS_WITH(run_unit(plan.units[0], folder / "F"),
                    Contains("d0.csv") && Contains("changed after the fleet was planned"));
  test::write_file(logs[0], text + "x");
  CHECK_THROWS_WITH(run_unit(plan.units[0], folder / "F"), Contains("changed after"));
  fs::remove(logs[0]);
  try {
    run_unit(plan.units[0], folder / "F");
    FAIL("a log that is not there was characterized");
  } catch (const Error& error) {
    CHECK(error.problem().kind == ErrorKind::again);
  }
  CHECK(unpublished(folder / "F").empty());
  test::write_file(logs[0], text);
  CHECK(run_unit(plan.units[0], folder / "F").outcome == UnitOutcome::done);
}

TEST_CASE("what a log's content does not allow is a result, and stands in the merged records") {
  const test::TemporaryFolder folder;
  auto logs = test::write_logs(folder.path(), 2);
  // The head is fine, a row in the second block that is read is not.
  std::string text = test::slurp(logs[1]);
  const std::string rows = text.substr(text.find('\n') + 1);
  while (text.size() < (std::size_t{3} << 20U)) text += rows;
  test::write_file(logs[1], text + "7.00,abc,1\n");
  const FleetPlan plan = test::planned(logs);
  const UnitRun run = run_unit(plan.units[1], folder / "F");
  CHECK(run.outcome == UnitOutcome::no_result);
  CHECK_THAT(run.problem, Contains("d1.csv:"));
  run_unit(plan.units[0], folder / "F");
  CHECK(fleet_status(plan, folder / "F").no_result == 1);
  const auto records = merged_records(plan, folder / "F");
  CHECK_THAT(records[1].problem, Contains("d1.csv:"));
  CHECK(records[1].channels.empty());
}

TEST_CASE("a log in which nothing could be fitted has no result, and says why") {
  const test::TemporaryFolder folder;
  auto logs = test::write_logs(folder.path(), 2);
  test::write_file(logs[1], "t[s],gx[deg/s],gy[deg/s]\n0,1,1\n");
  FleetPlanOptions options;
  for (const bool by_channel : {false, true}) {
    options.by_channel = by_channel;
    const FleetPlan plan = test::planned(logs, options);
    const fs::path fleet = folder / (by_channel ? "C" : "F");
    for (const FleetUnit& unit : plan.units) {
      const UnitRun run = run_unit(unit, fleet);
      CHECK((run.outcome == UnitOutcome::no_result) == (unit.device == 1));
      CHECK((unit.device == 0 || run.problem.find("no channel could be fitted; g") != std::string::npos));
    }
    CHECK(fleet_status(plan, fleet).no_result == (by_channel ? 2 : 1));
    const auto records = merged_records(plan, fleet);
    CHECK(records[0].problem.empty());
    CHECK_THAT(
        records[1].problem,
        Contains(
            "d1.csv: error E0711: no channel could be fitted; gx: no curves and no fit: 1 sample, and so no rate"));
    CHECK(records[1].channels.empty());
  }
}

TEST_CASE("merging what there is names what there is not") {
  const test::TemporaryFolder folder;
  const FleetPlan plan = test::planned(test::write_logs(folder.path(), 2));
  run_unit(plan.units[1], folder / "F");
  MergeOptions options;
  options.partial = true;
  const auto records = merged_records(plan, folder / "F", options);
  CHECK_THAT(records[0].problem, Contains("not there yet"));
  CHECK(records[0].awaited);
  CHECK_FALSE(records[1].awaited);
  CHECK(records[1].channels.size() == 2);
  CHECK(records[1].device == "d1");
}
