// Fleets that were planned apart: one report, as if one plan had had all devices.

#include <catch2/catch.hpp>
#include <filesystem>

#include "libchar/core/error.hpp"
#include "libchar/fleet/plan.hpp"
#include "libchar/lot/fleet_lot.hpp"
#include "tests/fleet/fleet_folder.hpp"
#include "tests/report/written_fleet.hpp"

using namespace libchar;
using Catch::Contains;
namespace fs = std::filesystem;

namespace {

/// Everything that is written of these fleets.
std::string report_of_fleets(const std::vector<std::string>& folders, const fs::path& to) {
  const std::vector<PlannedFleet> fleets = read_fleets(folders);
  refuse_common_logs(fleets);
  std::vector<DeviceRecord> records;
  for (const PlannedFleet& one : fleets)
    for (DeviceRecord& record : merged_records(one.plan, one.folder, {false, to})) records.push_back(std::move(record));
  const FleetLot lot = fleet_lot(records);
  std::string out;
  for (const OutputFile& file : test::written_fleet({records, &lot, "", {}, {}})) out += file.text;
  return out;
}

std::string fleet_in(const fs::path& folder, const std::vector<std::string>& logs, const FleetPlanOptions& options) {
  const FleetPlan plan = test::planned(logs, options);
  write_plan(plan, folder);
  test::run_all(plan, folder);
  return folder.string();
}

}  // namespace

TEST_CASE("fleets in any order give the bytes of one fleet that has all devices") {
  const test::TemporaryFolder folder;
  const auto logs = test::write_logs(folder.path(), 7);
  FleetPlanOptions options;
  options.reports = false;  // their pages are in other folders
  const std::string whole = fleet_in(folder / "whole", logs, options);
  const std::string a = fleet_in(folder / "a", {logs[5], logs[0]}, options);
  const std::string b = fleet_in(folder / "b", {logs[3]}, options);
  options.by_channel = true;
  const std::string c = fleet_in(folder / "c", {logs[1], logs[6], logs[2], logs[4]}, options);
  const std::string expected = report_of_fleets({whole}, folder.path());
  CHECK(expected.size() > 10000);
  CHECK(report_of_fleets({a, b, c}, folder.path()) == expected);
  CHECK(report_of_fleets({c, a, b}, folder.path()) == expected);
  CHECK(report_of_fleets({b + "/", c, a}, folder.path()) == expected);
}

TEST_CASE("each device of several fleets is linked to the page in its own") {
  const test::TemporaryFolder folder;
  const auto logs = test::write_logs(folder.path(), 2);
  const std::string a = fleet_in(folder / "a", {logs[0]}, {}), b = fleet_in(folder / "deep" / "b", {logs[1]}, {});
  fs::create_directory(folder / "report");
  for (const PlannedFleet& one : read_fleets({a, b}))
    for (const DeviceRecord& r : merged_records(one.plan, one.folder, {false, folder / "report"})) {
      CHECK(fs::path(r.report).is_relative());
      const fs::path page = folder / "report" / r.report / "report.html";
      REQUIRE(fs::exists(page));
      CHECK_THAT(test::slurp(page), Contains(r.device + ".csv"));
    }
}

TEST_CASE("one log in two fleets is refused by name, and so is one fleet named twice") {
  const test::TemporaryFolder folder;
  const auto logs = test::write_logs(folder.path(), 3);
  fs::copy_file(logs[1], folder / "again.csv");
  FleetPlanOptions options;
  options.reports = false;
  const std::string a = fleet_in(folder / "a", {logs[0], logs[1]}, options);
  options.by_channel = true;
  const std::string b = fleet_in(folder / "b", {logs[2], (folder / "again.csv").string()}, options);
  for (const auto& order : {std::vector{a, b}, std::vector{b, a}})
    CHECK_THROWS_WITH(refuse_common_logs(read_fleets(order)), Contains("E0783") && Contains("d1 in " + a) &&
                                                                  Contains("again in " + b) &&
                                                                  Contains("the same, byte by byte"));
  fs::create_directory_symlink(a, folder / "link");
  CHECK_THROWS_WITH(read_fleets({a, b, (folder / "link").string()}), Contains("E0795"));
  CHECK_THROWS_WITH(read_fleets({a, a + "/"}), Contains("named twice"));
  // Other settings, or another channel: no recording counts twice.
  Manifest manifest = manifest_of_logs({logs[1]});
  manifest.options[0].reading.rate_hz = 50;
  write_plan(plan_fleet(manifest, options), folder / "c");
  CHECK_NOTHROW(refuse_common_logs(read_fleets({a, (folder / "c").string()})));
  manifest.options[0] = {};
  options.by_channel = false;
  manifest.options[0].reading.channels = {"gx"};
  write_plan(plan_fleet(manifest, options), folder / "x");
  manifest.options[0].reading.channels = {"gy"};
  write_plan(plan_fleet(manifest, options), folder / "y");
  CHECK_NOTHROW(refuse_common_logs(read_fleets({folder / "x", folder / "y"})));
  CHECK_THROWS_WITH(refuse_common_logs(read_fleets({a, folder / "y"})), Contains("d1 in"));
}

namespace {

/// Gyros of .1 deg/s/K at these temperatures: up by 6 °C and down again, so that the mean is 3 °C above where it began.
std::vector<std::string> write_warm_logs(const fs::path& folder, const std::vector<double>& from) {
  std::vector<std::string> logs;
  for (const double degrees : from) {
    test::Gaussian gauss(static_cast<std::uint64_t>(degrees));
    std::string text = "t[s],gx[deg/s],temp[degC]\n";
    for (int k = 0; k < 6000; ++k) {
      const double temperature = degrees + 6 - 0.002 * std::abs(k - 2999.5);
      text += fmt::format("{:.2f},{:.6f},{:.4f}\n", k / 100.0, gauss() + 0.1 * temperature, temperature);
    }
    logs.push_back((folder / fmt::format("t{}.csv", degrees)).string());
    test::write_file(logs.back(), text);
  }
  return logs;
}

}  // namespace

TEST_CASE("a log in two fleets is refused where one has its channels as units, with names of a list") {
  const test::TemporaryFolder folder;
  const std::vector<std::string> logs = {test::write_rows(folder / "a.npy", 2, 50),
                                         test::write_rows(folder / "b.npy", 3, 50)};
  Manifest both = manifest_of_logs(logs);
  both.options = {both.options[0], both.options[0]};
  both.options[0].reading.rate_hz = both.options[1].reading.rate_hz = 100;
  both.options[0].reading.names = {"gx", "gy"};
  both.options[1].reading.names = {"gx", "gz", "gw"};
  both.devices[1].options = 1;
  FleetPlanOptions options;
  options.by_channel = true;
  write_plan(plan_fleet(both, options), folder / "parts");
  // The unit of the channel that both logs call gx is read alike, and is of unlike settings.
  both.devices.erase(both.devices.begin());
  write_plan(plan_fleet(both, {}), folder / "whole");
  CHECK_THROWS_WITH(refuse_common_logs(read_fleets({folder / "parts", folder / "whole"})),
                    Contains("E0783") && Contains("b in"));
}

TEST_CASE("a thermometer in the log tells its temperature where the manifest says nothing") {
  const test::TemporaryFolder folder;
  const auto logs = write_warm_logs(folder.path(), {20, 40});
  for (const bool taken_out : {false, true}) {
    CharacterizeOptions options;
    if (taken_out) options.temperature = "temp";
    Manifest manifest = manifest_of_logs(logs, options);
    manifest.devices[1].temperature_c = 60;
    const FleetPlan plan = plan_fleet(manifest, {});
    const fs::path fleet = folder / (taken_out ? "out" : "in");
    test::run_all(plan, fleet);
    const auto records = merged_records(plan, fleet);
    REQUIRE(records.size() == 2);
    REQUIRE(records[0].temperature_c);
    CHECK(*records[0].temperature_c == Approx(23).margin(0.01));
    CHECK(records[1].temperature_c == 60.0);
    for (const DeviceRecord& record : records) {
      REQUIRE(record.channels.size() == 2);
      const RecordedValue* found = record.channels[0].find(DeviceQuantity::temperature_coefficient);
      REQUIRE((found != nullptr) == taken_out);
      if (taken_out) CHECK(found->value == Approx(0.1).epsilon(0.2));
      CHECK(record.channels[1].find(DeviceQuantity::temperature_coefficient) == nullptr);
      CHECK(record.channels[1].find(DeviceQuantity::turn_on_bias) == nullptr);
    }
  }
  FleetPlanOptions by_channel;
  by_channel.by_channel = true;
  const FleetPlan whole = test::planned(logs), parts = test::planned(logs, by_channel);
  test::run_all(whole, folder / "whole");
  test::run_all(parts, folder / "parts");
  const auto a = merged_records(whole, folder / "whole"), b = merged_records(parts, folder / "parts");
  for (std::size_t d = 0; d < 2; ++d) {
    CHECK(a[d].channels == b[d].channels);
    CHECK(a[d].temperature_c == b[d].temperature_c);
  }
}

TEST_CASE("what was mended in a log is told by the worker, in the record, and in the lot") {
  const test::TemporaryFolder folder;
  auto logs = test::write_logs(folder.path(), 3);
  std::string text = test::slurp(logs[1]);
  const std::size_t row = text.find("0.10,");
  text.insert(row, text.substr(row, text.find('\n', row) + 1 - row));  // a row stands twice
  test::write_file(logs[1], text);
  const FleetPlan plan = test::planned(logs);
  std::size_t warned = 0;
  for (const FleetUnit& unit : plan.units) warned += !run_unit(unit, folder / "F").warnings.empty();
  CHECK(warned == 1);
  const auto records = merged_records(plan, folder / "F");
  CHECK(records[0].findings.empty());
  REQUIRE(has(records[1].findings, "duplicate_timestamp"));
  const FleetLot lot = fleet_lot(records);
  REQUIRE(has(lot.findings, "duplicate_timestamp"));
  CHECK_THAT(lot.findings[0].sentence, Contains("1 device (d1)"));
}

TEST_CASE("what a log's channels are called is no way to characterize it, what is fitted is one") {
  const test::TemporaryFolder folder;
  const auto logs = test::write_logs(folder.path(), 2);
  const auto notes_of = [&](const std::string& name, void (*change)(CharacterizeOptions&)) {
    Manifest manifest = manifest_of_logs(logs);
    manifest.options.push_back(manifest.options[0]);
    change(manifest.options[1]);
    manifest.devices[1].options = 1;
    FleetPlanOptions options;
    options.reports = false;
    const FleetPlan plan = plan_fleet(manifest, options);
    test::run_all(plan, folder / name);
    const auto records = merged_records(plan, folder / name);
    CHECK(records[0].settings != records[1].settings);
    CHECK(records[1].problem == "");
    return fleet_lot(records).notes;
  };
  CHECK(notes_of("read", [](CharacterizeOptions& o) { o.reading.units = {"deg/s", "deg/s"}; }).empty());
  const auto notes = notes_of("fitted", [](CharacterizeOptions& o) { o.spectrum.overlap = 0.25; });
  REQUIRE(notes.size() == 1);
  CHECK_THAT(notes[0], Contains("characterized with 2 settings"));
}
