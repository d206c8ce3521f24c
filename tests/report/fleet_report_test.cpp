// What is written of a fleet: the same bytes whatever the order, tables that read back, a page of
// bounded size, nothing injected.

#include "libchar/report/html/fleet_report.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libchar/core/file/whole_file.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/markup.hpp"
#include "libchar/log/read.hpp"
#include "libchar/report/compare/comparison_text.hpp"
#include "libchar/report/detail/charts.hpp"
#include "libchar/report/detail/npz_writer.hpp"
#include "tests/lot/made_fleet.hpp"
#include "tests/report/page_text.hpp"
#include "tests/report/written_fleet.hpp"
#include "tests/support/schemas.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

std::vector<DeviceRecord> two_batches(std::size_t each = 100) {
  test::MadeLot one, two;
  one.devices = two.devices = each;
  two.batch = "2";
  two.prefix = "b";
  two.mean[0] *= 1.2;
  auto records = test::made_lot(one, 1);
  test::append(records, test::made_lot(two, 2));
  records[7].channels[0].values[1].value *= 20;
  records[9].problem = "is empty";
  records[9].channels.clear();
  return records;
}

std::string csv_of(const std::vector<DeviceRecord>& records) {
  std::string out;
  write_coefficients_csv(records, fleet_lot(records), [&](std::string_view piece) { out += piece; });
  return out;
}

std::string npz_of(const std::vector<DeviceRecord>& records) {
  std::string out;
  write_coefficients_npz(records, fleet_lot(records), [&](std::string_view piece) { out += piece; });
  return out;
}

std::vector<std::vector<std::string>> cells_of(const std::string& csv) {
  std::vector<std::vector<std::string>> rows;
  std::istringstream lines(csv);
  for (std::string line; std::getline(lines, line);) {
    rows.emplace_back();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) rows.back().push_back(cell);
  }
  return rows;
}

std::size_t column_of(const std::vector<std::string>& heads, const std::string& name) {
  const auto at = std::find(heads.begin(), heads.end(), name);
  REQUIRE(at != heads.end());
  return static_cast<std::size_t>(at - heads.begin());
}

}  // namespace

TEST_CASE("a fleet's files do not depend on the order of its records") {
  auto records = two_batches();
  const auto files_of = [](const std::vector<DeviceRecord>& all) {
    const FleetLot lot = fleet_lot(all);
    return test::written_fleet({all, &lot, "fleet", {"sensorchar", "fleet"}, {}});
  };
  const auto before = files_of(records);
  std::reverse(records.begin(), records.end());
  std::swap(records[3], records[90]);
  const auto after = files_of(records);
  REQUIRE(before.size() == 4);
  for (std::size_t i = 0; i < before.size(); ++i) {
    CAPTURE(before[i].path);
    CHECK(before[i].path == after[i].path);
    CHECK((before[i].text == after[i].text));
  }
}

TEST_CASE("lot.json keeps its schema and names its files with their digests") {
  const auto records = two_batches();
  FleetLotOptions options;
  options.limits[""] = parse_limits(
      "format: noise-limits\nversion: 1\nlimits:\n  - channels: [gyro_x]\n    bias_instability: {value: 3e-3, unit: "
      "deg/s}\n",
      "limits.yaml");
  const FleetLot lot = fleet_lot(records, options);
  const auto files = test::written_fleet({records, &lot, "fleet", {}, {}});
  CHECK(test::schema_fault(files[3].text) == "");
  const auto document = nlohmann::json::parse(files[3].text);
  CHECK(document["devices"] == 200);
  CHECK(document["failed"][0]["device"] == "imu10");
  CHECK(document["worst"][0]["device"] == "imu8");
  CHECK(document["files"].size() == 4);
  CHECK(document["files_sha256"].contains("coefficients.npz"));
  // Alone, without limits and batches, too.
  test::MadeLot made;
  made.devices = 1;
  const auto one = test::made_lot(made, 3);
  const FleetLot small = fleet_lot(one);
  CHECK(test::schema_fault(dump_json(fleet_json({one, &small, "", {}, {}}))) == "");
}

TEST_CASE("the report of a lot at several temperatures says where its coefficients come from") {
  test::MadeLot made;
  made.devices = 12;
  const auto records = test::made_temperature_lot(made, {}, 4).records;
  const FleetLot lot = fleet_lot(records);
  const FleetReport report{records, &lot, "fleet", {}, {}};
  const std::string text = dump_json(fleet_json(report));
  CHECK(test::schema_fault(text) == "");
  const auto document = nlohmann::json::parse(text);
  std::size_t found = 0;
  for (const auto& q : document["quantities"])
    if (q["what"] == "temperature_coefficient") {
      ++found;
      CHECK(q["temperatures"]["slopes"].size() == 12);
      CHECK(q["temperatures"]["slopes"][0]["device"] == "imu1");
      CHECK(q["temperatures"]["range_c"] == nlohmann::json({-20, 60}));
    }
  CHECK(found == 2);
  const std::string page = fleet_html(report);
  CHECK_THAT(page,
             Contains("Slope of the turn-on bias over temperature: 12 devices with 48 recordings at -20 to 60 °C") &&
                 Contains("Coefficients of 12 devices"));
  CHECK_THAT(page, Contains("their bias is given at 25 °C by a line over temperature for each"));
}

TEST_CASE("a mean that leaves devices out says by how much it can be off, a chart what chance brings") {
  auto records = test::made_lot({}, 21);
  for (std::size_t i = 0; i < 40; ++i) {
    RecordedValue& k = records[i].channels[0].values[2];
    k.status = Status::not_detected;
    k.upper95 = 1e-4;
    k.value = kNone;
  }
  const FleetLot lot = fleet_lot(records);
  const FleetReport report{records, &lot, "fleet", {}, {}};
  const std::string text = dump_json(fleet_json(report));
  CHECK(test::schema_fault(text) == "");
  std::size_t left_out = 0;
  const auto document = nlohmann::json::parse(text);
  for (const auto& q : document["quantities"]) {
    left_out += !q["left_out"].is_null();
    if (q["chart"].is_null()) continue;
    CHECK(q["chart"]["zones"]["rules"]["two_of_three"].contains("by_chance"));
    CHECK(q["chart"]["zones"]["rules"]["beyond_3_sigma"]["signals"].get<std::size_t>() <=
          q["chart"]["beyond_count"].get<std::size_t>());
  }
  CHECK(left_out == 2);  // of the channel and of its kind
  const std::string page = fleet_html(report);
  CHECK_THAT(page, Contains(", too large by up to ") && Contains("40 are excluded (40 not detected)"));
  CHECK_THAT(page, Contains("four of five beyond 1 σ") && Contains("expected by chance"));
}

TEST_CASE("numbers of any size make a lot, a page and a document") {
  test::Gaussian gauss(6);
  const std::vector<double> wild = {0,      -0.0,  1e308, -1e308, 1e-308, 5e-324,
                                    1e-170, 1e170, kNone, 1,      -1,     std::numeric_limits<double>::infinity(),
                                    1e-60,  1e60};
  const auto any = [&] { return wild[static_cast<std::size_t>(gauss.uniform() * static_cast<double>(wild.size()))]; };
  for (int round = 0; round < 60; ++round) {
    test::MadeLot made;
    made.devices = round % 3 == 0 ? 6 : 80;
    auto records = test::made_lot(made, static_cast<std::uint64_t>(round));
    for (DeviceRecord& r : records) {
      r.batch = gauss.uniform() < 0.5 ? "1" : "2";
      if (gauss.uniform() < 0.5) r.temperature_c = gauss.uniform() < 0.2 ? any() : 60 * gauss();
      if (gauss.uniform() < 0.5) r.device = "imu1";  // several recordings of it
      for (RecordedChannel& c : r.channels)
        for (RecordedValue& v : c.values) {
          if (gauss.uniform() < 0.2) v.value = any();
          if (gauss.uniform() < 0.2) v.sd = std::abs(any());
          if (gauss.uniform() < 0.2) v.ci95 = {std::abs(any()), std::abs(any())};
        }
    }
    FleetLotOptions options;
    options.limits[""] = parse_limits(
        "format: noise-limits\nversion: 1\nlimits:\n  - kind: angular_rate\n    bias_instability: {value: 2e-3, unit: "
        "deg/s}\n",
        "limits.yaml");
    const FleetLot lot = fleet_lot(records, options);
    const FleetReport report{records, &lot, "", {}, {}};
    CHECK(test::schema_fault(dump_json(fleet_json(report))) == "");
    // Of the drawings, not of the scripts behind them.
    const std::string page = fleet_html(report), body = page.substr(0, page.find("<script"));
    for (const char* const bad : {"=\"nan", "=\"-nan", "nan,", ",nan", "inf,", ",inf", "=\"inf", "=\"-inf"}) {
      CAPTURE(round, bad);
      const std::size_t at = body.find(bad);
      CHECK(at == std::string::npos);
    }
    CHECK_FALSE(fleet_text(report).empty());
    const FleetComparison c = compare_lots(records, test::made_lot(made, 1));
    CHECK(test::schema_fault(dump_json(fleet_comparison_json(c))) == "");
  }
}

TEST_CASE("the table of coefficients holds every number to its last digit") {
  const auto records = two_batches(20);
  const auto rows = cells_of(csv_of(records));
  CHECK(rows.size() == 1 + 2 * 39);
  const std::size_t device = column_of(rows[0], "device"), channel = column_of(rows[0], "channel"),
                    white = column_of(rows[0], "white_noise"), high = column_of(rows[0], "turn_on_bias_high95"),
                    status = column_of(rows[0], "random_walk_status");
  CHECK(std::count(rows[0].begin(), rows[0].end(), "quantization") == 0);
  std::size_t found = 0;
  for (const auto& row : rows)
    for (const DeviceRecord& r : records)
      for (const RecordedChannel& c : r.channels)
        if (row[device] == r.device && row[channel] == c.name) {
          ++found;
          CHECK(parse_double(row[white]).value() == c.values[0].value);
          CHECK(parse_double(row[high]).value() == c.values[3].ci95.high);
          CHECK(row[status] == "detected");
        }
  CHECK(found == 78);
}

TEST_CASE("the tables give deviations in the unit of the value, and the batch of the device") {
  auto records = two_batches(20);
  DeviceRecord again = records[2];
  again.log = "again.csv";
  again.sha256 = "again";
  again.batch = "2";
  records.push_back(again);
  const auto rows = cells_of(csv_of(records));
  const std::size_t device = column_of(rows[0], "device"), batch = column_of(rows[0], "batch"),
                    channel = column_of(rows[0], "channel"), white = column_of(rows[0], "white_noise_sd"),
                    bias = column_of(rows[0], "turn_on_bias_sd");
  std::size_t found = 0;
  for (const auto& row : rows) {
    if (row[device] != "imu3" || row[channel] != "gyro_x") continue;
    ++found;
    const auto& values = records[2].channels[0].values;
    CHECK(parse_double(row[white]).value() == values[0].value * values[0].sd);
    CHECK(parse_double(row[bias]).value() == values[3].sd);
    CHECK(row[batch] == "1");
  }
  CHECK(found == 2);
}

TEST_CASE("what a name of a device would be in a spreadsheet is no formula") {
  auto records = two_batches(20);
  records[0].device = "=1+1";
  records[1].device = "a,\"b\"\nc";
  const std::string csv = csv_of(records);
  CHECK_THAT(csv, Contains(csv_cell("=1+1")) && Contains(csv_cell("a,\"b\"\nc")));
  CHECK_THAT(csv, !Contains(",=1+1,"));
}

TEST_CASE("the arrays of coefficients are read by our own reader of .npz") {
  auto records = two_batches(20);
  records[0].device = "µ-1";
  const test::TemporaryFolder folder;
  const std::string path = (folder.path() / "coefficients.npz").string();
  write_whole_file(path, npz_of(records), true);
  ReadOptions options;
  options.rate_hz = 1;
  options.channels = {"white_noise", "turn_on_bias_sd"};
  const Recording read = read_recording(path, options);
  const FleetLot lot = fleet_lot(records);
  REQUIRE(read.samples.size() == 2);
  std::size_t row = 0;
  for (const std::size_t r : lot.order)
    for (const RecordedChannel& c : records[r].channels) {
      CHECK(read.samples[0][row] == c.values[0].value);
      CHECK(read.samples[1][row++] == c.values[3].sd);
    }
  CHECK(row == read.samples[0].size());
}

TEST_CASE("an archive of arrays above four gigabytes, made small: sizes and places in extensions") {
  const std::vector<double> values = {1, 2.5, -3};
  const std::vector<std::uint64_t> counts = {7, 8, 9};
  const auto archive = [&](std::uint64_t wide_from) {
    std::string out;
    NpzWriter writer([&](std::string_view piece) { out += piece; }, wide_from);
    writer.add("a", values);  // 152 bytes, at 0
    writer.add("b", counts);  // 152 bytes, at 187
    writer.finish();
    return out;
  };
  const auto entry = [](const std::string& text, std::size_t at, std::size_t bytes) {
    std::uint64_t value = 0;
    for (std::size_t i = bytes; i-- > 0;) value = value << 8U | static_cast<std::uint8_t>(text[at + i]);
    return value;
  };
  const std::string plain = archive(1000);
  CHECK(archive(std::numeric_limits<std::uint32_t>::max()) == plain);
  // The second place is far, the directory is, no member is large; then everything is.
  for (const std::uint64_t wide_from : {160, 100}) {
    const std::string wide = archive(wide_from);
    const bool large = wide_from < 152;
    CHECK(entry(wide, 4, 2) == (large ? 45U : 20U));
    CHECK(entry(wide, 18, 4) == (large ? 0xFFFFFFFFU : 152U));
    CHECK(entry(wide, 28, 2) == (large ? 20U : 0U));  // length of the extension
    if (large) CHECK(wide.substr(35, 4) == std::string("\1\0\x10\0", 4));
    if (large) CHECK(entry(wide, 39, 8) == 152);
    const std::size_t end = wide.size() - 22, locator = end - 20, record = locator - 56;
    CHECK(entry(wide, end + 16, 4) == 0xFFFFFFFFU);
    CHECK(wide.substr(locator, 4) == "PK\x06\x07");
    CHECK(entry(wide, locator + 8, 8) == record);
    CHECK(wide.substr(record, 4) == "PK\x06\x06");
    CHECK(entry(wide, record + 32, 8) == 2);
    const std::size_t directory = entry(wide, record + 48, 8);
    CHECK(wide.substr(directory, 4) == "PK\x01\x02");
    CHECK(directory + entry(wide, record + 40, 8) == record);
    const test::TemporaryFolder folder;
    const std::string path = (folder.path() / "wide.npz").string();
    write_whole_file(path, wide);
    ReadOptions options;
    options.rate_hz = 1;
    const Recording read = read_recording(path, options);
    REQUIRE(read.samples.size() == 2);
    CHECK(read.samples[0][1] == 2.5);
    CHECK(read.samples[1][2] == 9);
  }
}

TEST_CASE("the page of a fleet grows by names, not by drawings") {
  const auto size = [](std::size_t devices) {
    test::MadeLot made;
    made.devices = devices;
    const auto records = test::made_lot(made, 4);
    const FleetLot lot = fleet_lot(records);
    return static_cast<double>(fleet_html({records, &lot, "", {}, {}}).size());
  };
  const double each = (size(20000) - size(2000)) / 18000;
  CHECK(each < 60);  // bytes: name, type, batch, state
}

TEST_CASE("the page of a fleet links the worst devices, and no name becomes a tag or another address") {
  auto records = two_batches();
  const std::string bad = "<script>alert(1)</script>\"'";
  records[7].device = bad;
  records[7].report = "javascript:" + bad;
  records[8].type = bad;
  const FleetLot lot = fleet_lot(records);
  const std::string page = fleet_html({records, &lot, bad, {bad}, {}});
  CHECK_THAT(page, !Contains("<script>alert") && !Contains("href=\"javascript:"));
  CHECK_THAT(page, Contains("href=\"./javascript%3A%3Cscript%3Ealert%281%29%3C/script%3E%22%27/report.html\""));
  CHECK_THAT(page, Contains("id=\"device-search\""));
}

TEST_CASE("a list of devices that only names them again is left out") {
  test::MadeLot made;
  made.devices = 3;
  std::vector<DeviceRecord> records = test::made_lot(made, 3);
  const auto page_of = [](const std::vector<DeviceRecord>& all) {
    const FleetLot lot = fleet_lot(all);
    return fleet_html({all, &lot, "", {}, {}});
  };
  for (DeviceRecord& record : records) record.batch = record.type = "";
  CHECK_THAT(page_of(records), Contains(">Each device<") && !Contains(">All devices<"));
  records[1].batch = "second";
  CHECK_THAT(page_of(records), Contains(">Each device<") && Contains(">All devices<"));
}

TEST_CASE("the text of a fleet has its table and its worst devices") {
  const auto records = two_batches();
  const FleetLot lot = fleet_lot(records);
  const std::string text = fleet_text({records, &lot, "", {}, {}});
  CHECK_THAT(text, Contains("1 device is an outlier") && Contains("gyro_x") &&
                       Contains("the worst first:\n  imu8  gyro_x: Bias instability"));
  CHECK_THAT(text, Contains("1 recording could not be characterized") &&
                       Contains("\ncould not be characterized:\n  imu10  is empty\n"));
}

TEST_CASE("results that are not there yet stand apart from those that cannot be") {
  auto records = two_batches();
  for (std::size_t i = 20; i < 23; ++i) {
    records[i].problem = "its result is not there yet";
    records[i].awaited = true;
    records[i].channels.clear();
  }
  const FleetLot lot = fleet_lot(records);
  const FleetReport report{records, &lot, "", {}, {}};
  const Json document = fleet_json(report);
  CHECK(test::schema_fault(test::written_fleet(report)[3].text) == "");
  CHECK(document["failed_count"] == 1);
  CHECK(document["awaited_count"] == 3);
  CHECK(document["awaited"][0]["device"] == "imu21");
  const std::string page = fleet_html(report);
  CHECK_THAT(page, Contains("1 recording could not be characterized") && Contains("3 recordings without a result yet"));
}

TEST_CASE("the list of devices tells the recordings of one apart") {
  auto records = two_batches(20);
  const auto recordings = [&] {
    const FleetLot lot = fleet_lot(records);
    const std::string page = fleet_html({records, &lot, "", {}, {}});
    const std::size_t at = page.find("\"recording\":");
    return page.substr(at, page.find("\"type\":", at) - at);
  };
  CHECK(recordings() == "\"recording\":null,");
  records.push_back(records[2]);
  records.back().sha256 = "hot";
  records.back().log = "logs/imu3-hot.csv";
  records.back().temperature_c = 60.04;
  CHECK_THAT(recordings(), Contains("\"\",\"imu3-hot.csv, 60 \\u00b0C\",\"imu3.csv\",\"\""));
}

TEST_CASE("a histogram has words for the mean and the limit, and says where a far limit is") {
  const Histogram h = histogram_of(std::vector<double>{1, 1.1, 1.2, 1.3, 1.4, 1.5, 2, 2});
  for (const double limit : {1.39, 1.4, 1.41, 2.05, 9.0, -9.0}) {
    CAPTURE(limit);
    const std::string drawing = histogram_figure(h, {false, "x", 1.4, limit}, "t");
    const bool far = std::abs(limit) > 5;
    CHECK(test::count(drawing, ">mean</text>") == 1);
    CHECK(test::count(drawing, ">limit</text>") == (far ? 0 : 1));
    CHECK(test::count(drawing, limit > 5 ? "is further up" : "is further down") == (far ? 1 : 0));
  }
}

TEST_CASE("a comparison of lots keeps its schema and has a table") {
  test::MadeLot other;
  other.mean[0] *= 1.1;
  const auto a = test::made_lot({}, 1), b = test::made_lot(other, 2);
  const FleetComparison c = compare_lots(a, b, {.name_a = "March", .name_b = "April"});
  const std::string document = dump_json(fleet_comparison_json(c));
  CHECK(test::schema_fault(document) == "");
  CHECK_THAT(fleet_comparison_text(c), Contains("mean of March") && Contains("larger than of March ["));
}
