#include <algorithm>
#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <nlohmann/json.hpp>

#include "libchar/core/document/json.hpp"
#include "tests/support/noise.hpp"
#include "tests/support/run.hpp"
#include "tests/support/shared.hpp"

using Catch::Contains;

TEST_CASE("inspect says in one line what was understood, and marks guesses") {
  const auto ran = test::run({"inspect", test::fixture("npy/structured.npy").string()});
  CHECK(ran.code == 0);
  CHECK(ran.err.empty());
  CHECK_THAT(ran.out, Contains("structured.npy: 7 channels, 200 Hz (jitter 0 s), 25 ms, 0 gaps\n"));
  CHECK_THAT(ran.out, Contains("  guessed: time unit: ns"));
  CHECK_THAT(ran.out, Contains("gyr_0") && Contains("kurtosis of differences"));
  CHECK_THAT(ran.out, Contains("next: sensorchar characterize ") && Contains("--time-column t --time-unit ns"));
}

TEST_CASE("people read flags, documents name the options of the library") {
  const std::string log = test::fixture("npy/structured.npy").string();
  const auto text = test::run({"inspect", log, "--rate", "100"});
  CHECK_THAT(text.out, Contains("guessed: time unit: ns") && Contains("(--time-unit says otherwise)"));
  CHECK_THAT(text.out, Contains("(--time-column none ignores the stamps)"));
  const auto json = test::run({"inspect", log, "--rate", "100", "--json"});
  CHECK_THAT(json.out, Contains("(`time_unit` says otherwise)"));
  CHECK_THAT(json.out, Contains("(`time_column` none ignores the stamps)"));
  const auto warned = test::run({"allan", log, "--rate", "100"});
  CHECK_THAT(warned.err, Contains("warning") && Contains("(--time-column none ignores"));
  const auto refused = test::run({"inspect", log, "--names", "a"});
  CHECK(refused.code == 2);
  CHECK_THAT(refused.err, Contains("--names") && !Contains("`"));
}

TEST_CASE("inspect --json keeps its promise to scripts") {
  const std::string log = test::fixture("npy/half.npy").string();
  const auto ran = test::run({"inspect", "--json", log, "--rate", "1.5kHz"});
  REQUIRE(ran.code == 0);
  const libchar::Json document = libchar::parse_json(ran.out, "stdout");
  CHECK(document["format"] == "inspect");
  CHECK(document["version"] == 1);
  CHECK(document["tool"]["name"] == "sensorchar");
  CHECK(document["command"][1] == "inspect");
  CHECK(document["input"][0]["path"] == log);
  CHECK(document["input"][0]["bytes"] == 146);
  CHECK(document["findings"][0]["code"] == "infinite_value");
  const libchar::Json& recording = document["recordings"][0];
  for (const char* key : {"file", "sha256", "rows", "channels", "rate_hz", "jitter_s", "gaps", "repairs"})
    CHECK(recording.contains(key));
  CHECK(recording["rows"] == 9);
  CHECK(recording["rate_hz"] == 1500.0);
  CHECK(recording["repairs"]["infinite_value"] == 1);
  CHECK(recording["sha256"].get<std::string>().size() == 64);
  CHECK(recording["channels"][0]["name"] == "c0");
  CHECK(recording["channels"][0]["unit"] == "");
  CHECK(recording["channels"][0]["missing"] == 2);
  CHECK(recording["channels"][0]["maximum"] == 65504.0);
}

TEST_CASE("inspect --preview has small traces of the channels in place of the digest") {
  const std::string log = test::fixture("imu_at_rest.csv").string();
  const auto ran = test::run({"inspect", "--json", "--preview", log});
  REQUIRE(ran.code == 0);
  const libchar::Json document = libchar::parse_json(ran.out, "stdout"), &recording = document["recordings"][0];
  CHECK(recording["sha256"].is_null());
  for (const libchar::Json& channel : recording["channels"]) {
    const std::vector<double> low = channel["trace"]["low"], high = channel["trace"]["high"];
    CHECK(low.size() == (50000 + channel["trace"]["samples_per_block"].get<std::size_t>() - 1) /
                            channel["trace"]["samples_per_block"].get<std::size_t>());
    CHECK(low.size() <= 100);
    CHECK(*std::min_element(low.begin(), low.end()) == channel["minimum"].get<double>());
    CHECK(*std::max_element(high.begin(), high.end()) == channel["maximum"].get<double>());
  }
  const auto plain = test::run({"inspect", "--json", log});
  CHECK(!libchar::parse_json(plain.out, "stdout")["recordings"][0]["channels"][0].contains("trace"));
}

TEST_CASE("several logs make one document, channels are chosen by repetition and by commas") {
  const std::string a = test::fixture("npy/c_order.npy").string(), b = test::fixture("npy/big_endian_f4.npy").string();
  const auto ran = test::run({"inspect", "-c", "c0,c2", a, b, "-c", "c1", "--json"});
  REQUIRE(ran.code == 0);
  const libchar::Json document = libchar::parse_json(ran.out, "stdout");
  REQUIRE(document["recordings"].size() == 2);
  CHECK(document["recordings"][1]["channels"].size() == 3);
  const auto slip = test::run({"inspect", a, "-c", "c9"});
  CHECK(slip.code == 2);
}

TEST_CASE("inspect: blanks behind the commas of a list belong to no name") {
  const test::TemporaryFolder folder;
  const std::string log = (folder / "log.csv").string();
  std::ofstream(log) << "t[s],a,b,c\n0,1,2,3\n0.1,2,3,4\n0.2,1,2,3\n0.3,4,2,3\n";
  const auto names = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"inspect", log, "--json"});
    const auto ran = test::run(words);
    REQUIRE(ran.code == 0);
    std::string all;
    const libchar::Json document = libchar::parse_json(ran.out, "stdout");
    for (const libchar::Json& channel : document["recordings"][0]["channels"])
      all += channel["name"].get<std::string>() + channel["unit"].get<std::string>() + "|";
    return all;
  };
  CHECK(names({"-c", "a, b"}) == "a|b|");
  CHECK(names({"-c", "!a, !b"}) == "c|");
  CHECK(names({"-c", "a , c", "--names", "x, y", "--units", "V, mV"}) == "xV|ymV|");
  std::ofstream(log) << "t[s],\"a\",\" b\"\n0,1,2\n0.1,2,3\n0.2,1,2\n0.3,4,2\n";
  CHECK(test::run({"inspect", log, "-c", "a, b"}).code == 0);
}

TEST_CASE("inspect: what can be read only once has no next command") {
  const std::string log = test::fixture("imu_at_rest.csv").string();
  CHECK_THAT(test::run({"inspect", log}).out, Contains("next: sensorchar characterize"));
  test::RunOptions options;
  options.stdin_path = log;
  const auto ran = test::run({"inspect", "-"}, options);
  REQUIRE(ran.code == 0);
  CHECK_THAT(ran.out, !Contains("next:") && !Contains("standard input-report"));
}

TEST_CASE("option --strict turns warnings into exit code 3, --quiet keeps results") {
  const std::string log = test::fixture("npy/half.npy").string();
  CHECK(test::run({"inspect", log}).code == 0);
  const auto strict = test::run({"inspect", log, "--strict", "-q"});
  CHECK(strict.code == 3);
  CHECK_THAT(strict.err, Contains("--strict"));
  CHECK_THAT(strict.out, Contains("half.npy"));
}

TEST_CASE("a raw log without sidecar is answered with a sidecar") {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "gyro.f64") << std::string(48, 'x');
  const auto ran = test::run({"inspect", (folder / "gyro.f64").string()});
  CHECK(ran.code == 3);
  CHECK_THAT(ran.err, Contains("gyro.f64.json, such as {\"dtype\": \"f64\""));
}

TEST_CASE("standard input is read as CSV") {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "in.csv") << "t[s],x[V]\n0,1\n0.01,2\n0.02,3\n0.03,5\n";
  test::RunOptions options;
  options.stdin_path = (folder / "in.csv").string();
  const auto ran = test::run({"inspect", "-"}, options);
  CHECK(ran.code == 0);
  CHECK_THAT(ran.out, Contains("1 channel, 100 Hz"));
}

TEST_CASE("one row with a stamp has no rate, and --rate would not give it one") {
  const test::TemporaryFolder folder;
  const std::string log = (folder / "one.csv").string();
  std::ofstream(log) << "t,x\n1.0,2.0\n";
  const auto ran = test::run({"inspect", log});
  CHECK(ran.code == 0);
  CHECK_THAT(ran.out, Contains("next: one row with a time stamp gives no sampling rate") && !Contains("--rate"));
}

TEST_CASE("a constant channel has no kurtosis") {
  const test::TemporaryFolder folder;
  const std::string log = (folder / "flat.csv").string();
  std::ofstream(log) << "t[s],x,y\n0,5,1\n1,5,2\n2,5,1\n3,5,4\n";
  const auto ran = test::run({"inspect", log});
  CHECK_THAT(ran.out, Contains("constant"));
  const auto json = test::run({"inspect", "--json", log});
  const libchar::Json channels = libchar::parse_json(json.out, "stdout")["recordings"][0]["channels"];
  CHECK(channels[0]["difference_kurtosis"].is_null());
  CHECK(channels[1]["difference_kurtosis"].is_number());
}

TEST_CASE("the suggested command names each list once, and works") {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "x.csv") << "0,1,2\n0.1,2,1\n0.2,1,4\n0.3,2,2\n";
  test::RunOptions options;
  options.folder = folder.path().string();
  const auto ran = test::run({"inspect", "x.csv", "--names", "a b,c", "--units", "deg/s,g"}, options);
  CHECK(ran.code == 0);
  CHECK_THAT(ran.out, Contains(" --names 'a b,c' --units deg/s,g --time-column c0"));
}

TEST_CASE("inspect: a pipe has as many bytes as the file it comes from, comments and header too") {
  const test::TemporaryFolder folder;
  const std::string path = (folder / "log.csv").string();
  std::ofstream(path) << "# a comment\n# another\nt[s],x\n0,1\n0.5,2\n1,3\n1.5,2\n";
  test::RunOptions piped;
  piped.stdin_path = path;
  const auto bytes = [](const test::Ran& ran) {
    return libchar::parse_json(ran.out, "inspect")["recordings"][0]["bytes"].get<std::uint64_t>();
  };
  CHECK(bytes(test::run({"inspect", "-", "--json"}, piped)) == std::filesystem::file_size(path));
  CHECK(bytes(test::run({"inspect", path, "--json"})) == std::filesystem::file_size(path));
}

TEST_CASE("what mends a command replaces an option that it has") {
  const test::TemporaryFolder folder;
  const std::string log = (folder / "periods.txt").string(), out = (folder / "r").string();
  std::ofstream periods(log);
  test::Gaussian draw(4);
  for (int i = 0; i < 3000; ++i) periods << std::setprecision(15) << 1.0000001 + 3e-9 * draw() << '\n';
  periods.close();
  const auto ran = test::run({"characterize", log, "--rate", "1Hz", "--data", "phase", "-o", out});
  CHECK_THAT(ran.out,
             Contains("--data=frequency") && Contains("--nominal-frequency 1.0000001") && !Contains("--data phase -o"));
}

TEST_CASE("a log that cannot be read does not hide those behind it") {
  const std::string good = test::fixture("npy/half.npy").string();
  const auto text = test::run({"inspect", good, "absent.csv", good, "missing.csv"});
  CHECK(text.code == 3);
  CHECK(text.out.find("half.npy") != text.out.rfind("half.npy: 1"));
  CHECK_THAT(text.err, Contains("absent.csv: error") && Contains("missing.csv: error"));
  const auto json = test::run({"inspect", "--json", "absent.csv", good});
  CHECK(json.code == 3);
  CHECK(libchar::parse_json(json.out, "stdout")["recordings"].size() == 1);
}
