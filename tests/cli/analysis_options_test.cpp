// The same words mean the same in every verb that analyses, and no table carries a formula.

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <nlohmann/json.hpp>

#include "libchar/core/document/json.hpp"
#include "tests/support/run.hpp"

using Catch::Contains;
using libchar::Json;

namespace {

Json spectrum_settings(const std::vector<std::string>& more, const test::TemporaryFolder& folder) {
  const std::string out = (folder / "report").string();
  std::vector<std::string> words = {
      "characterize", test::fixture("imu_at_rest.csv").string(), "-c", "gyro_z", "-o", out, "--force", "--quiet"};
  words.insert(words.end(), more.begin(), more.end());
  const auto ran = test::run(words);
  INFO(ran.err);
  REQUIRE(ran.code == 0);
  return Json::parse(test::slurp(out + "/report.json"));
}

}  // namespace

TEST_CASE("a channel's name that a spreadsheet would run is guarded in allan as in psd") {
  const test::TemporaryFolder folder;
  const std::string log = (folder / "log.csv").string();
  {
    std::ofstream out(log);
    out << "=1+1\n";
    for (int i = 0; i < 256; ++i) out << (i * 37 % 11) << "\n";
  }
  const auto allan = test::run({"allan", log, "--rate", "10"});
  REQUIRE(allan.code == 0);
  CHECK_THAT(allan.out, Contains("\n'=1+1,") && !Contains("\n=1+1"));
  CHECK_THAT(test::run({"psd", log, "--rate", "10"}).out, Contains("frequency_hz,'=1+1["));
}

TEST_CASE("report.json says each reading option that was set") {
  const test::TemporaryFolder folder;
  const Json usual = spectrum_settings({}, folder);
  for (const char* key : {"units", "names", "encoding", "overflow_as_missing"})
    CHECK_FALSE(usual["config"]["reading"].contains(key));
  const Json set = spectrum_settings({"--units", "rad/s", "--encoding", "latin1", "--overflow", "nan"}, folder);
  CHECK(set["config"]["reading"]["units"] == Json({"rad/s"}));
  CHECK(set["config"]["reading"]["encoding"] == "latin1");
  CHECK(set["config"]["reading"]["overflow_as_missing"] == true);
}

TEST_CASE("the option segment takes samples, a time or N/4, in psd and in characterize") {
  const test::TemporaryFolder folder;
  const std::string log = test::fixture("imu_at_rest.csv").string();
  const auto psd = [&](const std::string& segment) {
    return test::run({"psd", log, "-c", "gyro_z", "--segment", segment}).out;
  };
  // 50 Hz.
  CHECK(psd("5s") == psd("250"));
  CHECK_FALSE(psd("5s").empty());
  CHECK(psd("N/4") == test::run({"psd", log, "-c", "gyro_z"}).out);
  const Json time = spectrum_settings({"--segment", "5s"}, folder);
  const Json samples = spectrum_settings({"--segment", "250"}, folder);
  CHECK(time.at("spectrum") == samples.at("spectrum"));
  CHECK(time.at("config").at("spectrum_segment_s") == 5);
  const Json quarter = spectrum_settings({"--segment", "N/4"}, folder);
  CHECK(quarter.at("spectrum") == spectrum_settings({}, folder).at("spectrum"));
  CHECK(quarter.at("spectrum") != samples.at("spectrum"));
}

TEST_CASE("a segment that cannot be is refused in the same words everywhere") {
  const test::TemporaryFolder folder;
  const std::string log = test::fixture("imu_at_rest.csv").string();
  for (const char* verb : {"psd", "characterize"}) {
    const auto refused = [&](const std::string& segment, const std::string& rate = "") {
      std::vector<std::string> words = {verb, log, "--segment", segment};
      if (verb == std::string("characterize")) words.insert(words.end(), {"-o", (folder / "out").string()});
      if (!rate.empty()) words.insert(words.end(), {"--time-column", rate});
      const auto ran = test::run(words);
      CHECK(ran.code == 2);
      return ran.err;
    };
    CAPTURE(verb);
    CHECK_THAT(refused("4"), Contains("--segment") && Contains("not below 8"));
    CHECK_THAT(refused("5 parsecs"), Contains("--segment") && Contains("a duration such as"));
    CHECK_THAT(refused("1ms"), Contains("--segment") && Contains("at least 8"));
    CHECK_THAT(refused("5s", "none"), Contains("--segment") && Contains("give --rate"));
  }
}

TEST_CASE("every window of the library is offered by psd and by characterize") {
  const test::TemporaryFolder folder;
  const Json document = spectrum_settings({"--window", "hann_nonzero"}, folder);
  CHECK(document["config"]["spectrum"]["window"] == "hann_nonzero");
  for (const char* verb : {"psd", "characterize"})
    CHECK_THAT(test::run({verb, "--help"}).out, Contains("hann|rectangular|blackman_harris|flat_top|hann_nonzero"));
}

TEST_CASE("allan says which deviation a row is, and what a log beyond the memory allowed would take") {
  const std::string log = test::fixture("imu_at_rest.csv").string();
  const auto table = test::run({"allan", log, "-c", "gyro_z", "--type", "mdev", "--taus", "1s"});
  CHECK_THAT(table.out,
             Contains("edf,terms,curve,findings\n") && Catch::EndsWith(",mdev,\n") && Contains("\ngyro_z,deg/s,1,"));
  const test::TemporaryFolder folder;
  const std::string longer = (folder / "long.f64").string();  // more than a leaf
  std::vector<double> samples((std::size_t{1} << 20U) + 1000);
  std::uint64_t state = 1;
  for (double& x : samples) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    x = static_cast<double>(state >> 40U);
  }
  std::ofstream(longer, std::ios::binary)
      .write(reinterpret_cast<const char*>(samples.data()),
             static_cast<std::streamsize>(samples.size() * sizeof(double)));
  std::ofstream(longer + ".json")
      << R"({"dtype": "f64", "endian": "little", "channels": [{"name": "a"}], "rate_hz": 100})";
  for (const char* verb : {"allan", "characterize"}) {
    std::vector<std::string> words = {verb,     longer,   "-c",     "a",         "--memory",
                                      "100KiB", "--taus", "1s,10s", "--segment", "5s"};
    if (verb == std::string("allan"))
      words.resize(words.size() - 2);
    else
      words.insert(words.end(), {"-o", (folder / "out").string()});
    const auto refused = test::run(words);
    CAPTURE(verb);
    CHECK(refused.code == 2);
    CHECK_THAT(refused.err, Contains("error E0701: a curve at other times than octaves takes all samples at once: 8200 "
                                     "KiB, and 100 KiB are allowed") &&
                                Contains("give --memory 8200KiB, or read less with --channel, --from, --to"));
    *(std::find(words.begin(), words.end(), "--memory") + 1) = "8200KiB";
    CHECK(test::run(words).code == 0);
  }
}
