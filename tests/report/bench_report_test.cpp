// Benchmarks as document, page, Markdown and text, and against an older run.

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/benchmark/bench_document.hpp"
#include "libchar/core/error.hpp"
#include "libchar/report/compare/comparison_text.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

EstimatorAccuracy made_method(const std::string& name, double error, double ns) {
  EstimatorAccuracy out;
  out.name = name;
  out.what = "what " + name + " does";
  TermAccuracy term;
  term.truth = 2e-3;
  term.bound = 1e-5;
  term.error = {error, {0.9 * error, 1.1 * error}, 20};
  term.coverage = {0.95, {0.9, 0.99}, 20};
  out.terms = {term};
  out.error = error;
  out.ns_per_sample = {ns, {0.98 * ns, 1.02 * ns}, 20};
  return out;
}

BenchReport made_report() {
  BenchReport out;
  out.command = {"sensorchar", "bench"};
  out.machine.processor = "made";
  out.machine.cores = 2;
  CharacterizationBench bench;
  bench.signal.name = "<b>evil</b>";
  bench.records = 20;
  bench.methods = {made_method("first", 1, 50), made_method("second", 3, 5)};
  bench.methods[1].is_ours = false;
  out.characterization = {bench};
  return out;
}

BenchReport read_back(const BenchReport& report) {
  return parse_bench_report(dump_json(document_of(bench_fields(), report)), "bench.json");
}

}  // namespace

TEST_CASE("bench: page, Markdown, text and document say the same, names escaped") {
  const BenchReport report = made_report();
  const std::string page = bench_html(report);
  CHECK_THAT(page, Contains("&lt;b&gt;evil&lt;/b&gt;") && !Contains("<b>evil"));
  CHECK_THAT(page, Contains("<svg") && Contains("second"));
  CHECK_THAT(page, Contains("first is the most accurate, 1.00 × the bound at 50.0 ns per sample"));
  CHECK_THAT(page, Contains("<a href=\"#part-1\">") && Contains("id=\"part-1\""));
  CHECK_THAT(bench_markdown(report), Contains("| first | 1.00 \\[0.900, 1.10\\] |"));
  CHECK_THAT(bench_text(report), Contains("first") && Contains("1.00 [0.900, 1.10]"));
  const Json document = document_of(bench_fields(), report);
  CHECK(document["format"] == "bench");
  REQUIRE(document["verdict"].size() == 1);
  CHECK_THAT(document["verdict"][0].get<std::string>(), Contains("first is the most accurate, 1.00 × the bound"));
  CHECK(document["characterization"][0]["methods"][1]["terms"][0]["rmse_over_bound"]["value"] == 3);
}

TEST_CASE("bench against: worse beyond both intervals is found, the rest is not") {
  const BenchReport was = read_back(made_report());
  BenchReport report = made_report();
  CHECK(bench_changes(was, report, "old").worse(0.05).empty());
  // Within the intervals: nothing. Beyond them: said.
  report.characterization[0].methods[0] = made_method("first", 1.1, 50);
  CHECK(bench_changes(was, report, "old").worse(0.05).empty());
  report.characterization[0].methods[0] = made_method("first", 1.5, 50);
  const BenchChanges worse = bench_changes(was, report, "old");
  REQUIRE(worse.worse(0.05).size() == 1);
  CHECK_THAT(worse.worse(0.05)[0].what, Contains("first") && Contains("RMSE"));
  CHECK(worse.worse(0.6).empty());
  CHECK_THAT(changes_text(worse, 0.05), Contains("worse") && Contains("1.500"));
}

TEST_CASE("bench against: times judge on the same machine only, and by three tolerances") {
  const BenchReport was = read_back(made_report());
  BenchReport report = made_report();
  report.characterization[0].methods[1] = made_method("second", 3, 5.6);
  CHECK(bench_changes(was, report, "old").worse(0.05).empty());
  report.characterization[0].methods[1] = made_method("second", 3, 6);
  CHECK(bench_changes(was, report, "old").worse(0.05).size() == 1);
  report.machine.processor = "another";
  CHECK(bench_changes(was, report, "old").worse(0.05).empty());
}

TEST_CASE("bench against: another document is refused") {
  CHECK_THROWS_WITH(parse_bench_report(R"({"format": "replay-report"})", "old.json"),
                    Contains("E0968") && Contains("old.json"));
  BenchReport other = made_report();
  other.characterization[0].signal.name = "other";
  CHECK_THROWS_WITH(bench_changes(other, made_report(), "old.json"), Contains("E0968"));
}
