// allan of several statistics, of single devices and in time; psd of two channels, by medians and
// in time: what the program prints is what the library computes.

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "libchar/core/document/json.hpp"
#include "tests/support/run.hpp"
#include "tests/support/shared.hpp"

using Catch::Contains;
using libchar::Json;

namespace {

std::string fixture_log() { return test::fixture("imu_at_rest.csv").string(); }

Json json_of(std::vector<std::string> words) {
  words.push_back("--json");
  const auto ran = test::run(words);
  INFO(ran.err);
  REQUIRE(ran.code == 0);
  return libchar::parse_json(ran.out, "");
}

/// Three clocks of a table of numbers without a pattern, over one that all share.
std::string three_clocks(const test::TemporaryFolder& folder, bool units) {
  const std::string path = (folder / "clocks.csv").string();
  std::ofstream file(path);
  file << (units ? "t[s],a[s],b[m],c[s]\n" : "t[s],a[s],b[s],c[s]\n");
  std::uint64_t n = 1234567890;
  const auto next = [&n] {
    n = 16807 * n % 2147483647;
    return double(n) / 2147483647 - 0.5;
  };
  double common = 0;
  for (int i = 0; i < 2000; ++i) {
    common += next();
    file << i << ',' << common + next() << ',' << common + 2 * next() << ',' << common + 4 * next() << '\n';
  }
  return path;
}

}  // namespace

TEST_CASE("allan: several statistics come from one reading, each as it comes alone") {
  const Json both = json_of({"allan", fixture_log(), "--type", "oadev,mtie", "--taus", "1s,10s"});
  CHECK(both["type"] == "oadev");
  CHECK(both["types"] == Json::array({"oadev", "mtie"}));
  CHECK(both["measured"]["work"]["passes"] == 1);
  REQUIRE(both["channels"].size() == 4);
  const Json alone = json_of({"allan", fixture_log(), "--type", "mtie", "--taus", "1s,10s"});
  CHECK(alone["type"] == "mtie");
  CHECK(alone.find("types") == alone.end());
  for (const std::size_t channel : {0U, 1U}) {
    Json one = both["channels"][2 * channel + 1];
    CHECK(one["type"] == "mtie");
    one.erase("type");
    CHECK(one == alone["channels"][channel]);
    CHECK(one["ci95"] == Json::array({nullptr, nullptr}));
    CHECK(one["edf"] == Json::array({nullptr, nullptr}));
  }
  const auto table = test::run({"allan", fixture_log(), "-c", "gyro_z", "--type", "mtie", "--taus", "1s"});
  CHECK_THAT(table.out, Contains(",,,,,,49951,mtie,\n"));
}

TEST_CASE("allan: the bias that was taken out stands beside the value, every time is every multiple") {
  const Json total = json_of({"allan", fixture_log(), "-c", "accel_z", "--type", "mtotdev", "--taus", "1s"});
  CHECK(total["channels"][0]["bias"][0].get<double>() == Approx(0.73).margin(0.01));
  const Json all = json_of({"allan", fixture_log(), "-c", "accel_z", "--taus", "all", "--tau-max", "2s"});
  CHECK(all["channels"][0]["m"].size() == 100);
  CHECK_THAT(test::run({"allan", fixture_log(), "--type", "oadev,mtei"}).err, Contains("did you mean mtie?"));
  CHECK(test::run({"allan", fixture_log(), "--type", "oadev,oadev"}).code == 2);
  CHECK(test::run({"allan", fixture_log(), "--type", "oadev,mdev", "--taus", "ten"}).code == 2);
  CHECK(test::run({"characterize", fixture_log(), "-o", "/nowhere", "--type", "oadev,mdev"}).code == 2);
}

TEST_CASE("allan --hat: devices from their differences, by table and document") {
  const test::TemporaryFolder folder;
  const Json hat = json_of({"allan", three_clocks(folder, false), "--hat", "--taus", "1s,4s"});
  CHECK(hat["format"] == "cornered-hat");
  for (const std::size_t c : {0U, 1U, 2U}) {
    const Json& channel = hat["channels"][c];
    const double sigma = std::pow(2.0, double(c)) / std::sqrt(12.0);
    CHECK(channel["deviation"][0].get<double>() == Approx(sigma).epsilon(c == 0 ? 0.3 : 0.1));
    CHECK(channel["status"].size() == 2);
    CHECK(channel["variance_sd"][0].get<double>() > 0);
  }
  const auto table = test::run({"allan", three_clocks(folder, false), "--hat", "--taus", "1s"});
  CHECK_THAT(table.out, Contains("channel,unit,tau_s,deviation,variance,variance_sd,status,terms\na,s,1,"));
  CHECK_THAT(test::run({"allan", three_clocks(folder, true), "--hat"}).err,
             Contains("E0870") && Contains("must be in one unit"));
  CHECK_THAT(test::run({"allan", fixture_log(), "--hat", "-c", "gyro_z"}).err, Contains("there are 1"));
  CHECK(test::run({"allan", fixture_log(), "--hat", "--dynamic", "10s"}).code == 2);
  CHECK(test::run({"allan", fixture_log(), "--hat", "--type", "oadev,mdev"}).code == 2);
}

TEST_CASE("allan --dynamic: a curve a window") {
  const Json dynamic = json_of({"allan", fixture_log(), "-c", "gyro_z", "--dynamic", "100s,300s"});
  CHECK(dynamic["format"] == "dynamic-allan");
  const Json& windows = dynamic["channels"][0]["windows"];
  REQUIRE(windows.size() == 4);
  CHECK(windows[1]["from_s"] == 300.0);
  CHECK(windows[1]["time_s"] == 350.0);
  CHECK(windows[3]["deviation"].size() == windows[3]["tau_s"].size());
  CHECK_THAT(test::run({"allan", fixture_log(), "--dynamic", "2000s"}).err, Contains("--dynamic") && Contains("E0871"));
}

TEST_CASE("psd: two channels, by median and in time") {
  const Json cross = json_of({"psd", fixture_log(), "--cross", "accel_z,gyro_z", "--segment", "1000"});
  CHECK(cross["format"] == "cross-spectrum");
  CHECK(cross["first"]["name"] == "accel_z");  // as asked, not as in the log
  CHECK(cross["value_unit"] == "g*deg/s/Hz");
  CHECK(cross["coherence"].size() == 501);
  const Json turned = json_of({"psd", fixture_log(), "--coherence", "gyro_z,accel_z", "--segment", "1000"});
  CHECK(turned["coherence"] == cross["coherence"]);
  CHECK(turned["phase_rad"][5].get<double>() == -cross["phase_rad"][5].get<double>());
  const auto table = test::run({"psd", fixture_log(), "--coherence", "gyro_z,accel_z", "--segment", "1000"});
  CHECK_THAT(table.out, Contains("frequency_hz,coherence,coherence_unbiased,significant\n"));
  CHECK_THAT(table.err, Contains("stays below"));
  const Json median = json_of({"psd", fixture_log(), "--average", "median", "--segment", "20s"});
  CHECK(median["average"] == "median");
  CHECK(median["channels"][0]["segment"] == 1000);
  const Json gram = json_of({"psd", fixture_log(), "-c", "gyro_z", "--spectrogram", "100s", "--overlap", "0"});
  CHECK(gram["format"] == "spectrogram");
  CHECK(gram["channels"][0]["time_s"].size() == 10);
  CHECK(gram["channels"][0]["value"][9].size() == 2501);
}

TEST_CASE("psd: pairs that are none are refused in a sentence") {
  CHECK_THAT(test::run({"psd", fixture_log(), "--cross", "gyro_z"}).err, Contains("--cross") && Contains("E0873"));
  CHECK_THAT(test::run({"psd", fixture_log(), "--coherence", "gyro_z,gyro_z"}).err, Contains("E0873"));
  CHECK_THAT(test::run({"psd", fixture_log(), "--coherence", "gyro_z,acel_z"}).err, Contains("accel_z"));
  CHECK_THAT(test::run({"psd", fixture_log(), "--cross", "gyro_z,accel_z", "--segment", "50000"}).err,
             Contains("E0874") && Contains("--segment"));
  CHECK_THAT(test::run({"psd", fixture_log(), "--spectrogram", "60000"}).err, Contains("E0875"));
  CHECK(test::run({"psd", fixture_log(), "--cross", "a,b", "--spectrogram", "10s"}).code == 2);
}
