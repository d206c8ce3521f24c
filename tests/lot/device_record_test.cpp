// The record of a device: what it takes from a characterization, and that it reads back as it was written.

#include "libchar/lot/device_record.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

#include "libchar/core/error.hpp"
#include "libchar/lot/detail/record_scanner.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/schemas.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

Coefficient detected(double value, double relative) {
  Coefficient c;
  c.status = Status::detected;
  c.value = value;
  c.relative_sd = relative;
  c.ci95 = {value * (1 - 2 * relative), value * (1 + 2 * relative)};
  return c;
}

Characterization recording() {
  Characterization out;
  out.log.file = "lot/imu7.csv";
  out.log.sha256 = std::string(64, 'a');
  ChannelResult c;
  c.channel = {"gyro_x", "deg/s"};
  c.quality.mean = 0.1 + 0.2;
  c.quality.samples = 100000;
  c.quality.missing = 3;
  NoiseFit& fit = c.fit.emplace();
  fit.rate_hz = 100;
  fit.duration_s = 1000;
  fit.samples = 100000;
  fit.goodness.p = 1.0 / 3;
  fit.term[0] = detected(0.005, 0.01);
  fit.term[0].in_all = SquareInAll{2.4e-5, 1.1e-6, 0.2};
  fit.theta[0] = 0.005 * 0.005;
  fit.term[1].status = Status::not_detected;
  fit.term[1].upper95 = 1e-3;
  fit.gauss_markov = GaussMarkovFit{detected(0.002, 0.1), detected(30, 0.4), true};
  fit.gauss_markov->tau_s.ci95.high = std::numeric_limits<double>::infinity();
  TemperatureEffect& effect = fit.temperature.emplace();
  effect.unit = "degC";
  effect.order = 1;
  effect.mean = 31.5;
  effect.coefficient[0] = -0.012;
  effect.ci95 = {-0.013, -0.011};
  out.channels.push_back(c);
  out.log.warnings.add("gap", "a gap", "line 7", 2);
  ChannelResult none;
  none.quality.mean = std::numeric_limits<double>::quiet_NaN();
  none.channel = {"x\"\n\x01", ""};
  none.findings = {finding("constant", "it is constant"), finding("spiky", "µ")};
  out.channels.push_back(none);
  return out;
}

DeviceRecord filled() {
  DeviceRecord r = record_of(recording());
  r.device = "imu <7>";
  r.type = "gyro";
  r.batch = "2024-05";
  r.settings = "s1";
  r.report = "imu7";
  return r;
}

}  // namespace

TEST_CASE("a device record holds what a lot looks at") {
  const DeviceRecord r = record_of(recording());
  CHECK(r.log == "lot/imu7.csv");
  CHECK(r.temperature_c == 31.5);
  REQUIRE(r.channels.size() == 2);
  const RecordedChannel& gyro = r.channels[0];
  CHECK(gyro.samples == 100000);
  CHECK(gyro.missing == 3);
  const auto value = [&](DeviceQuantity q) {
    const RecordedValue* v = gyro.find(q);
    REQUIRE(v != nullptr);
    return *v;
  };
  CHECK(value(DeviceQuantity::white_noise).value == 0.005);
  CHECK(value(DeviceQuantity::white_noise).sd == 0.01);
  CHECK(value(DeviceQuantity::white_noise).in_all == SquareInAll{2.4e-5, 1.1e-6, 0.2});
  CHECK_FALSE(value(DeviceQuantity::gauss_markov_time).in_all);
  CHECK(value(DeviceQuantity::bias_instability).status == Status::not_detected);
  CHECK(value(DeviceQuantity::bias_instability).upper95 == 1e-3);
  CHECK(gyro.find(DeviceQuantity::random_walk) == nullptr);
  CHECK(value(DeviceQuantity::gauss_markov_time).value == 30);
  // White noise moves the mean of 1000 s by N/sqrt(T), a process of 30 s by about sigma sqrt(2 tau/T).
  const double mean_sd = std::hypot(0.005 / std::sqrt(1000.0), 0.002 * std::sqrt(60.0 / 1000));
  CHECK(value(DeviceQuantity::turn_on_bias).value == 0.1 + 0.2);
  CHECK(value(DeviceQuantity::turn_on_bias).sd == Approx(mean_sd).epsilon(0.05));
  CHECK(value(DeviceQuantity::temperature_coefficient).value == -0.012);
  CHECK(value(DeviceQuantity::temperature_coefficient).sd == Approx(0.001 / 1.959964).epsilon(1e-6));
  CHECK_FALSE(r.channels[1].fitted);
  CHECK(gyro.mean == 0.1 + 0.2);
  CHECK(std::isnan(r.channels[1].mean));
  CHECK(r.findings == recording().log.warnings.list());
  CHECK(record_of(recording(), SampleKind::phase).channels[0].find(DeviceQuantity::turn_on_bias) == nullptr);
}

TEST_CASE("the one channel in °C beside others is a thermometer") {
  Characterization result = recording();
  for (ChannelResult& c : result.channels)
    if (c.fit) c.fit->temperature.reset();
  ChannelResult thermometer = result.channels[0];
  thermometer.channel = {"temp", "degC"};
  thermometer.quality.mean = 41.5;
  result.channels.push_back(thermometer);
  const DeviceRecord one = record_of(result);
  CHECK(one.temperature_c == 41.5);
  CHECK(one.channels[0].find(DeviceQuantity::turn_on_bias) != nullptr);
  CHECK(one.channels[2].find(DeviceQuantity::turn_on_bias) == nullptr);
  CHECK(one.channels[2].find(DeviceQuantity::white_noise) != nullptr);
  // One of two may be anywhere.
  result.channels.push_back(thermometer);
  result.channels.back().channel.name = "temp2";
  const DeviceRecord two = record_of(result);
  CHECK_FALSE(two.temperature_c);
  CHECK(two.channels[2].find(DeviceQuantity::turn_on_bias) != nullptr);
  // Alone it is the sensor.
  result.channels = {thermometer};
  const DeviceRecord alone = record_of(result);
  CHECK_FALSE(alone.temperature_c);
  CHECK(alone.channels[0].find(DeviceQuantity::turn_on_bias) != nullptr);
}

TEST_CASE("a temperature that does nothing is not detected") {
  Characterization result = recording();
  result.channels[0].fit->temperature->order = 0;
  const DeviceRecord record = record_of(result);
  const RecordedValue* v = record.channels[0].find(DeviceQuantity::temperature_coefficient);
  REQUIRE(v != nullptr);
  CHECK(v->status == Status::not_detected);
  CHECK(std::isnan(v->value));
}

TEST_CASE("a device record reads back as it was written, to the last bit, and keeps its schema") {
  const DeviceRecord r = filled();
  const std::string text = device_record_text(r);
  CHECK(text.find('\n') == std::string::npos);
  CHECK(test::schema_fault(text) == "");
  CHECK(parse_device_record(text, "a.jsonl") == r);
  CHECK(device_record_text(parse_device_record(text, "a.jsonl")) == text);
  // Numbers of any size.
  test::Gaussian gauss(1);
  DeviceRecord wild = r;
  for (int i = 0; i < 200; ++i) {
    RecordedValue& v = wild.channels[0].values[0];
    v.value = std::exp(100 * gauss());
    v.sd = std::exp(300 * gauss());
    v.ci95 = {v.value / 3, std::numeric_limits<double>::infinity()};
    CHECK(parse_device_record(device_record_text(wild), "") == wild);
  }
}

TEST_CASE("a log that could not be characterized is a record without channels") {
  DeviceRecord r;
  r.device = "imu8";
  r.problem = "imu8.csv: is empty";
  const std::string text = device_record_text(r);
  CHECK(test::schema_fault(text) == "");
  CHECK(parse_device_record(text, "") == r);
}

TEST_CASE("a device record that is none is refused with file, place and key") {
  const std::string good = device_record_text(filled());
  const auto refusal = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    text.replace(at, from.size(), to);
    try {
      parse_device_record(text, "r.jsonl");
    } catch (const Error& e) {
      CHECK(e.problem().kind == ErrorKind::input);
      return std::string(e.what());
    }
    return std::string("accepted");
  };
  CHECK_THAT(refusal("device-record", "lot"), Contains("r.jsonl") && Contains("format"));
  CHECK_THAT(refusal("\"version\":1", "\"version\":2"), Contains("version"));
  CHECK_THAT(refusal("\"device\":", "\"devise\":"), Contains("device is missing"));
  CHECK_THAT(refusal("\"detected\"", "\"found\""), Contains("white_noise.status"));
  CHECK_THAT(refusal("\"value\":0.005", "\"value\":-0.005"), Contains("channels[0].values.white_noise.value"));
  CHECK_THAT(refusal("\"rate_hz\":100.0", "\"rate_hz\":\"fast\""), Contains("rate_hz"));
  CHECK_THAT(refusal("\"ci95\":[", "\"ci95\":[1,"), Contains("two numbers"));
  CHECK_THAT(refusal("{", ""), Contains("r.jsonl:1"));
  // Keys of a later program.
  CHECK(refusal("\"type\":", "\"colour\":\"red\",\"type\":") == "accepted");
}

TEST_CASE("the fast way to read a record and the slow one agree, on good lines and on broken ones") {
  test::Gaussian gauss(3);
  const std::string good = device_record_text(filled());
  DeviceRecord bare = filled();
  bare.channels.pop_back();  // its name needs escapes
  bare.findings.clear();
  const std::string plain = device_record_text(bare);
  CHECK(scan_device_record(plain) == bare);
  CHECK(scan_device_record(plain + "\n") == bare);
  CHECK_FALSE(scan_device_record(good));
  const std::string letters = "0123456789-+.eE\"\\{}[]:,nul tx\xff";
  int scanned = 0;
  for (int i = 0; i < 20000; ++i) {
    std::string line = plain;
    const auto at = static_cast<std::size_t>(gauss.uniform() * static_cast<double>(line.size()));
    const char letter = letters[static_cast<std::size_t>(gauss.uniform() * static_cast<double>(letters.size()))];
    const double way = gauss.uniform();
    if (way < 0.4)
      line[at] = letter;
    else if (way < 0.7)
      line.erase(at, 1);
    else
      line.insert(at, 1, letter);
    const auto fast = scan_device_record(line);
    if (!fast) continue;
    ++scanned;
    CAPTURE(line);
    REQUIRE_NOTHROW(read_device_record(line, "") == *fast);
    CHECK(read_device_record(line, "") == *fast);
  }
  CHECK(scanned > 3000);
}

TEST_CASE("logs side by side are devices, called as their files are, each once") {
  std::vector<Characterization> logs(3, recording());
  logs[1].log.file = "other/imu7.csv";
  logs[2].log.file = "imu8.csv";
  CHECK_THROWS_WITH(records_of(logs), Contains("E0762") && Contains("same recording"));
  for (std::size_t i = 0; i < 3; ++i) logs[i].log.sha256 = std::to_string(i);
  for (ChannelResult& c : logs[2].channels) c.fit.reset();
  logs[2].channels[0].findings = {finding("constant", "it is constant")};
  const auto records = records_of(logs);
  REQUIRE(records.size() == 3);
  CHECK(records[0].device == "lot/imu7.csv");
  CHECK(records[1].device == "other/imu7.csv");
  CHECK(records[2].device == "imu8");
  CHECK(records[0].channels == record_of(logs[0]).channels);
  CHECK_THAT(records[2].problem, Contains("E0711") && Contains("it is constant"));
  CHECK(records[2].channels.empty());
}
