
#include <catch2/catch.hpp>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "libchar/characterize/judgement.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/export/exports.hpp"
#include "libchar/log/inspection.hpp"
#include "libchar/report/html/html_report.hpp"
#include "libchar/report/text/curves_text.hpp"
#include "tests/report/synthetic.hpp"

using namespace libchar;

namespace {

// Splits a table as RFC 4180 says; the writer is not asked how it writes.
std::vector<std::vector<std::string>> rows_of(const std::string& text) {
  std::vector<std::vector<std::string>> rows(1, std::vector<std::string>(1));
  bool quoted = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (quoted) {
      if (c != '"')
        rows.back().back() += c;
      else if (i + 1 < text.size() && text[i + 1] == '"')
        rows.back().back() += text[++i];
      else
        quoted = false;
    } else if (c == '"') {
      quoted = true;
    } else if (c == ',') {
      rows.back().emplace_back();
    } else if (c == '\n') {
      rows.emplace_back(1);
    } else {
      rows.back().back() += c;
    }
  }
  rows.pop_back();
  return rows;
}

std::vector<std::string> keys_of(const Json& object) {
  std::vector<std::string> keys;
  for (const auto& [key, value] : object.items()) keys.push_back(key);
  return keys;
}

}  // namespace

TEST_CASE("report.json: the keys that scripts rely on, in order, measured last") {
  const auto result = test::synthetic_imu();
  const Json report = json_report(result);
  CHECK(report["format"] == "characterization");
  CHECK(report["version"] == 1);
  CHECK(keys_of(report).back() == "measured");
  CHECK(report["measured"]["seconds"] == 1.25);
  for (const char* key :
       {"tool", "command", "config", "input", "findings", "recording", "allan", "spectrum", "fit", "quality"})
    CHECK(report.contains(key));
  CHECK(report["input"][0]["sha256"] == result.log.sha256);
  CHECK(report["input"][0]["bytes"] == result.log.bytes);
  CHECK(report["findings"][0]["code"] == "gap");
  CHECK(report["findings"][0]["count"] == 37);
  CHECK(report["recording"]["repairs"]["duplicate_timestamp"] == 1);

  const Json& allan = report["allan"];
  CHECK(allan["format"] == "allan");
  CHECK(allan["type"] == "oadev");
  const Json& curve = allan["channels"][0];
  const std::size_t n = result.channels[0].allan.points.size();
  for (const char* key : {"tau_s", "deviation", "ci95", "edf", "terms", "m", "model"}) CHECK(curve[key].size() == n);
  CHECK(curve["ci95"][3].size() == 2);

  const Json& spectrum = report["spectrum"];
  CHECK(spectrum["format"] == "spectrum");
  CHECK(spectrum["sides"] == "one");
  CHECK(spectrum["scaling"] == "psd");
  for (const char* key : {"frequency_hz", "value", "dof"}) CHECK(spectrum["channels"][0][key].size() == 320);

  const Json& fit = report["fit"];
  CHECK(fit["format"] == "noise-fit");
  const Json& gyr_z = fit["channels"][2];
  CHECK(gyr_z["name"] == "gyr_z");
  CHECK(gyr_z["random_walk"]["value"].is_null());
  CHECK(gyr_z["random_walk"]["status"] == "not_detected");
  CHECK(gyr_z["random_walk"]["upper95"] == 2e-5);
  CHECK(gyr_z["white_noise"]["ci95"].size() == 2);
  CHECK(gyr_z["white_noise"]["upper95"].is_null());
  for (const char* key : {"chi2", "dof", "p"}) CHECK(gyr_z["goodness"].contains(key));
}

TEST_CASE("report.json: every number reads back to the same double, and the text is valid JSON for every input") {
  const auto result = test::synthetic_imu();
  const Json back = parse_json(dump_json(json_report(result)), "report.json");
  for (std::size_t c = 0; c < result.channels.size(); ++c) {
    const auto& points = result.channels[c].allan.points;
    for (std::size_t i = 0; i < points.size(); ++i) {
      CHECK(back["allan"]["channels"][c]["deviation"][i].get<double>() == points[i].deviation);
    }
    CHECK(back["fit"]["channels"][c]["white_noise"]["value"].get<double>() == *result.channels[c].fit->term[0].value);
  }
  CHECK_NOTHROW(parse_json(dump_json(json_report(test::hostile())), "report.json"));
  CHECK_NOTHROW(parse_json(dump_json(json_report(test::barely_anything())), "report.json"));
}

TEST_CASE("report.json: null stands only where a status says why") {
  const Json report = json_report(test::barely_anything());
  const Json& unfitted = report["fit"]["channels"][0];
  CHECK(unfitted["white_noise"]["value"].is_null());
  CHECK(unfitted["white_noise"]["status"] == "not_fitted");
  CHECK(!report["summary"]["channels"][0]["findings"].empty());
  CHECK(report["allan"]["channels"][0]["tau_s"].empty());
  CHECK(report["allan"]["channels"][1]["ci95"][0].is_null());
}

TEST_CASE("curves.csv: a tidy table that reads back to the same doubles") {
  const auto result = test::synthetic_imu();
  const auto rows = rows_of(csv_curves(result));
  CHECK(rows[0] == std::vector<std::string>{"curve", "channel", "unit", "x_unit", "x", "value", "low68", "high68",
                                            "low95", "high95", "dof", "terms", "model", "model_low95", "model_high95",
                                            "findings"});
  std::size_t expected = 1;
  for (const ChannelResult& c : result.channels) expected += c.allan.points.size() + c.spectrum.value.size();
  CHECK(rows.size() == expected);
  for (const auto& row : rows) REQUIRE(row.size() == 16);
  const auto& points = result.channels[0].allan.points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    CHECK(parse_double(rows[i + 1][5]) == points[i].deviation);
    CHECK(parse_double(rows[i + 1][9]) == points[i].ci95.high);
  }
  CHECK(rows[points.size() + 1][0] == "psd_one_sided");
  CHECK(rows[points.size() + 1][2] == "(deg/s)²/Hz");
  const double low = *parse_double(rows[points.size() + 1][8]), high = *parse_double(rows[points.size() + 1][9]);
  CHECK(low < result.channels[0].spectrum.value[0]);
  CHECK(high > result.channels[0].spectrum.value[0]);
}

TEST_CASE("a spectrogram as CSV: a row a value, none for a segment with a missing sample") {
  LogSpectrograms log;
  log.channels = {Channel{}, Channel{}};
  log.channels[0].name = "gx", log.channels[0].unit = "rad/s";
  log.channels[1].name = "t", log.channels[1].unit = "degC";
  Spectrogram one;
  one.time_s = {0.5, 1.5, 2.5};
  one.frequency_hz = {0, 2};
  one.value = {{0.25, 0.5}, {}, {4, 8}};
  log.spectrograms = {one, one};
  const auto rows = rows_of(spectrograms_csv(log));
  REQUIRE(rows.size() == 1 + 2 * 4);
  CHECK(rows[0] == std::vector<std::string>{"channel", "unit", "time_s", "frequency_hz", "value"});
  CHECK(rows[1] == std::vector<std::string>{"gx", "(rad/s)²/Hz", "0.5", "0", "0.25"});
  CHECK(rows[4] == std::vector<std::string>{"gx", "(rad/s)²/Hz", "2.5", "2", "8"});
  CHECK(rows[8] == std::vector<std::string>{"t", "degC²/Hz", "2.5", "2", "8"});
}

TEST_CASE("curves.csv: hostile names stay one cell and start no formula") {
  const auto result = test::hostile();
  std::set<std::string> names;
  for (const auto& row : rows_of(csv_curves(result))) {
    REQUIRE(row.size() == 16);
    CHECK(std::string("=+-@\t\r").find(row[1].empty() ? 'x' : row[1][0]) == std::string::npos);
    names.insert(row[1]);
  }
  CHECK(names.size() == test::hostile_names().size() + 1);
}

TEST_CASE("outputs do not depend on the time it took, but for one key") {
  auto result = test::synthetic_imu();
  const std::string page = html_report(result), table = csv_curves(result);
  Json report = json_report(result);
  result.seconds = 99;
  CHECK(html_report(result) == page);
  CHECK(csv_curves(result) == table);
  Json again = json_report(result);
  CHECK(again != report);
  again.erase("measured");
  report.erase("measured");
  CHECK(again == report);
}

TEST_CASE("which number goes where: the formulas of docs/exports.md on figures of its own") {
  NoiseFit fit;
  fit.term[0].value = 1.6968e-4;
  fit.term[0].ci95 = {1.69679e-4, 1.69681e-4};
  fit.term[2].value = 1.9393e-5;
  fit.term[2].ci95 = {1.93929e-5, 1.93931e-5};
  std::map<std::string, std::string> value;
  for (const ConsumerNumber& row : consumer_numbers(fit.term, "rad/s", 200))
    value[row.consumer + "/" + row.key] = row.value;
  CHECK(value["Kalibr, EuRoC, OpenVINS/gyroscope_noise_density"] == "0.000169680");
  CHECK(value["VINS-Mono, VINS-Fusion/gyr_n"] == "0.00339360");
  CHECK(value["VINS-Mono, VINS-Fusion/gyr_w"] == "0.000274258");
  CHECK(value["GTSAM/gyroscopeCovariance"] == "2.879×10⁻⁸");
  CHECK(value["GTSAM/biasOmegaCovariance"] == "3.761×10⁻¹⁰");
  CHECK(value["Gazebo SDF/stddev"] == "0.00239964");
  CHECK(value["Data sheet/angle random walk"] == "0.583317");
  CHECK(value.count("Data sheet/bias instability") == 0);
  fit.term[2].value.reset();
  fit.term[2].upper95 = 1e-5;
  for (const ConsumerNumber& row : consumer_numbers(fit.term, "rad/s", 200)) {
    if (row.key == "gyroscope_random_walk") CHECK(row.value == "≤ 1.00×10⁻⁵");
  }
  CHECK(consumer_numbers(Coefficients{}, "rad/s", 200).empty());
}

TEST_CASE("verdict: says what is fine, what is not, and where") {
  auto result = test::synthetic_imu();
  CHECK(verdict_of(result).find("5 of 6 channels") != std::string::npos);
  CHECK(verdict_of(result).find("acc_z") != std::string::npos);
  result.channels.pop_back();
  CHECK(verdict_of(result).find("all 5 channels") != std::string::npos);
  CHECK(verdict_of(test::barely_anything()).find("No fit was possible for gyr_x, gyr_y") != std::string::npos);
  Characterization moved = test::synthetic_imu();  // no finding speaks of the fit beside the motion
  moved.channels[0].fit.reset();
  moved.channels[0].findings = {finding("moves_throughout", "It moves.")};
  CHECK(verdict_of(moved).find("4 of 6 channels") != std::string::npos);
  result.channels.clear();
  CHECK(verdict_of(result) == "The recording holds no channel to characterize.");
}

TEST_CASE("inspect and the report describe a recording by the same keys and values") {
  const Characterization result = test::synthetic_imu();
  Inspection inspection;
  inspection.info = result.log;
  inspection.info.channels.clear();
  for (const ChannelResult& c : result.channels) {
    inspection.info.channels.push_back(c.channel);
    inspection.quality.push_back(c.quality);
  }
  const Json inspected = inspection_json({inspection})["recordings"][0];
  CHECK(inspected == json_report(result)["recording"]);
  for (const char* key : {"file", "sha256", "rows", "rate_hz", "time_column", "start_ns", "format"})
    CHECK(inspected.contains(key));
  // one key for each fact
  CHECK_FALSE(inspected.contains("log_format"));
  CHECK_FALSE(inspected.contains("time"));
  CHECK(inspected["channels"][0].contains("integer"));
  CHECK(inspected["channels"][0].contains("float32_step"));
}

TEST_CASE("warnings of the report name their file") {
  const Json report = json_report(test::synthetic_imu());
  CHECK(report["findings"][0]["file"] == report["input"][0]["path"]);
}
