// Nothing is computed that nobody asked for: counts of work of typical requests. A count that rises
// here is work added: say in docs/bench.md what reads it.

#include <sys/resource.h>

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "libchar/core/document/json.hpp"
#include "tests/support/run.hpp"
#include "tests/support/shared.hpp"

namespace {

using Counts = std::map<std::string, std::uint64_t>;

Counts counts_in(const libchar::Json& document) { return document["measured"]["work"].get<Counts>(); }

Counts counts_of(const std::vector<std::string>& words) {
  const auto ran = test::run(words);
  REQUIRE(ran.code == 0);
  return counts_in(libchar::parse_json(ran.out, "stdout"));
}

Counts counts_of_report(std::vector<std::string> words) {
  const test::TemporaryFolder folder;
  const std::string out = (folder / "out").string();
  words.insert(words.end(), {"-o", out});
  REQUIRE(test::run(words).code == 0);
  return counts_in(libchar::parse_json(test::slurp(out + "/report.json"), "report.json"));
}

/// Processor time of programs that ran and ended.
double child_seconds() {
  rusage used{};
  ::getrusage(RUSAGE_CHILDREN, &used);
  return static_cast<double>(used.ru_utime.tv_sec + used.ru_stime.tv_sec) +
         1e-6 * static_cast<double>(used.ru_utime.tv_usec + used.ru_stime.tv_usec);
}

}  // namespace

TEST_CASE("work: a log is read once, and only what was asked for is computed") {
  const std::string log = test::fixture("imu_at_rest.csv");  // two channels, 50 000 rows
  const std::uint64_t rows = 50000;
  CHECK(counts_of({"inspect", log, "--json"}) == Counts{{"passes", 1}, {"rows", rows}});
  CHECK(counts_of({"psd", log, "--json"}) ==
        Counts{{"passes", 1}, {"rows", rows}, {"segments", 14}, {"cosine_transforms", 4}});  // motion
  CHECK(counts_of({"psd", log, "--json", "--channel", "gyro_z"}) ==
        Counts{{"passes", 1}, {"rows", rows}, {"segments", 7}, {"cosine_transforms", 2}});
  const test::TemporaryFolder folder;
  CHECK(counts_of({"convert", log, "-o", (folder / "x.npy").string(), "--json"}) ==
        Counts{{"passes", 1}, {"rows", rows}});
}

TEST_CASE("work: a fit takes no spectrum, an Allan curve the fit that its intervals need") {
  const std::string log = test::fixture("imu_at_rest.csv");
  const Counts allan = counts_of({"allan", log, "--json", "--channel", "gyro_z"});
  CHECK(allan.count("segments") == 0);
  CHECK(allan.at("allan_terms") == 931377);  // octaves, full overlap
  CHECK(allan.at("descents") <= 3);
  CHECK(allan.at("cosine_transforms") <= 10);  // of motion, and of the first look for events
  const Counts fit = counts_of({"fit", log, "--json", "--channel", "gyro_z"});
  CHECK(fit.count("segments") == 0);
  CHECK(fit.at("allan_terms") == 931377);
  CHECK(fit.at("descents") <= 3);
  CHECK(fit.at("cosine_transforms") <= 10);
}

TEST_CASE("work: a characterization of one channel is half of that of two") {
  const std::string log = test::fixture("imu_at_rest.csv");
  const Counts both = counts_of_report({"characterize", log}),
               one = counts_of_report({"characterize", log, "--channel", "gyro_z"});
  CHECK(both.at("passes") == 1);
  CHECK(both.at("segments") == 14);
  CHECK(one.at("segments") == 7);
  // Where no coefficient comes near a line the floor is known by counts, but for its ends.
  CHECK(one.at("floor_medians") <= 8);
  CHECK(2 * one.at("allan_terms") == both.at("allan_terms"));
  CHECK(both.at("descents") <= 6);
  CHECK(both.at("cosine_transforms") <= 16);  // four of them an eighth as long: the first look for events
}

TEST_CASE("work: a replay of one method fuses for it and its bounds alone") {
  const std::string scene = test::fixture("scenes/rv-3.3-calibrated.yaml");
  const Counts mean = counts_of_report({"replay", scene, "--algorithms", "mean"});
  CHECK(mean.at("passes") == 2);  // one to learn the optimum's weights, one to fuse
  CHECK(mean.count("training_steps") == 0);
  CHECK(mean.count("blind_instants") == 0);
  CHECK(mean.at("fused_instants") == 270000);
  const Counts all = counts_of_report({"replay", scene, "--algorithms", "mean", "--no-skip"});
  CHECK(all.at("fused_instants") > 8 * mean.at("fused_instants"));
  CHECK(all.at("blind_instants") > 0);
  const Counts net = counts_of_report({"replay", scene, "--algorithms", "perceptron"});
  CHECK(net.at("training_steps") > 0);
}

TEST_CASE("work: what is simulated is counted, and nothing is fitted") {
  const test::TemporaryFolder folder;
  const Counts counts =
      counts_of({"simulate", test::fixture("scenes/lever-arm.yaml"), "-o", (folder / "x.npy").string(), "--json"});
  CHECK(counts.at("simulated_samples") > 0);
  CHECK(counts.at("passes") == 1);
  CHECK(counts.size() == 2);
}

// A hundred thousand columns took 25 s where each was compared with all others, and take 4.
TEST_CASE("work: columns of a table cost as many of them as there are, not their square") {
  const test::TemporaryFolder folder;
  const auto seconds = [&](int columns) {
    const std::string log = (folder / (std::to_string(columns) + ".csv")).string();
    std::string names = "c0", row = "1";
    for (int c = 1; c < columns; ++c) {
      names += ",c" + std::to_string(c);
      row += ",1";
    }
    std::ofstream(log) << names << '\n' << row << '\n' << row << '\n' << row << '\n';
    const double before = child_seconds();
    CHECK(test::run({"inspect", log}).code == 0);
    return child_seconds() - before;
  };
  const double few_s = seconds(8'000);
  CHECK(seconds(32'000) < 7 * few_s);  // four times, where each was compared with all seventeen
}

// A digest is of the whole file: of this one it takes long, and all else reads the first 4,096 of its samples.
TEST_CASE("work: a digest is taken only where an output states it") {
  const test::TemporaryFolder folder;
  const std::string log = (folder / "x.f64").string();
  {
    std::ofstream out(log, std::ios::binary);
    std::uint64_t state = 1;
    for (int i = 0; i < 4096; ++i) {
      state = state * 6364136223846793005U + 1442695040888963407U;
      const auto value = static_cast<double>(state >> 11U) * 0x1p-53;
      out.write(reinterpret_cast<const char*>(&value), sizeof value);
    }
    std::ofstream(log + ".json")
        << R"({"dtype": "f64", "endian": "little", "rate_hz": 1, "channels": [{"name": "x"}]})";
  }
  std::filesystem::resize_file(log, std::uintmax_t{1} << 28U);
  const auto run_s = [&](std::vector<std::string> words) {
    words.insert(words.begin() + 1, {log, "--to", "4096s"});
    const double before = child_seconds();
    const auto ran = test::run(words);
    INFO(words[0] << " " << ran.err);
    CHECK(ran.code == 0);
    if (words.back() == "--json") CHECK(libchar::parse_json(ran.out, "stdout")["input"][0]["sha256"].is_string());
    return child_seconds() - before;
  };
  const double hashed_s = run_s({"inspect", "--json"});
  CHECK(run_s({"inspect"}) < hashed_s / 4);
  CHECK(run_s({"allan"}) < hashed_s / 4);
  CHECK(run_s({"psd"}) < hashed_s / 4);
  CHECK(run_s({"fit"}) < hashed_s / 4);
  CHECK(run_s({"allan", "-o", (folder / "x.csv").string()}) < hashed_s / 4);
}
