// Nothing is computed that nobody asked for: counts of work of typical requests. A count that rises
// here is work added: say in docs/bench.md what reads it.

#include <catch2/catch.hpp>
#include <map>
#include <nlohmann/json.hpp>

#include "libchar/core/json.hpp"
#include "tests/support/run.hpp"
#include "tests/support/shared.hpp"

namespace {

using Counts = std::map<std::string, std::uint64_t>;

Counts counts_in(const libchar::Json& document) {
  return document["measured"]["work"].get<Counts>();
}

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

}  // namespace

TEST_CASE("work: a log is read once, and only what was asked for is computed") {
  const std::string log = test::fixture("imu_at_rest.csv");  // two channels, 50 000 rows
  const std::uint64_t rows = 50000;
  CHECK(counts_of({"inspect", log, "--json"}) == Counts{{"passes", 1}, {"rows", rows}});
  CHECK(counts_of({"psd", log, "--json"}) ==
        Counts{{"passes", 1}, {"rows", rows}, {"segments", 14}});
  CHECK(counts_of({"psd", log, "--json", "--channel", "gyro_z"}) ==
        Counts{{"passes", 1}, {"rows", rows}, {"segments", 7}});
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
  CHECK(allan.at("cosine_transforms") <= 5);
  const Counts fit = counts_of({"fit", log, "--json", "--channel", "gyro_z"});
  CHECK(fit.count("segments") == 0);
  CHECK(fit.at("allan_terms") == 931377);
  CHECK(fit.at("descents") <= 3);
  CHECK(fit.at("cosine_transforms") <= 7);
}

TEST_CASE("work: a characterization of one channel is half of that of two") {
  const std::string log = test::fixture("imu_at_rest.csv");
  const Counts both = counts_of_report({"characterize", log}),
               one = counts_of_report({"characterize", log, "--channel", "gyro_z"});
  CHECK(both.at("passes") == 1);
  CHECK(both.at("segments") == 14);
  CHECK(one.at("segments") == 7);
  CHECK(2 * one.at("allan_terms") == both.at("allan_terms"));
  CHECK(both.at("descents") <= 6);
  CHECK(both.at("cosine_transforms") <= 12);
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
  const Counts counts = counts_of({"simulate",
                                   test::fixture("scenes/lever-arm.yaml"),
                                   "-o",
                                   (folder / "x.npy").string(),
                                   "--json"});
  CHECK(counts.at("simulated_samples") > 0);
  CHECK(counts.at("passes") == 1);
  CHECK(counts.size() == 2);
}
