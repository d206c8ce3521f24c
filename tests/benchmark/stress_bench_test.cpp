// Stress: nothing is wrong, everything is tried, and what is wrong would be seen.

#include <catch2/catch.hpp>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>

#include "libchar/allan/deviation_types.hpp"
#include "libchar/benchmark/bench_document.hpp"
#include "libchar/benchmark/detail/stress_cells.hpp"
#include "libchar/fusion/registry.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;
using Catch::Contains;

TEST_CASE("stress: nothing is wrong, of several seeds") {
  for (const std::uint64_t seed : {1U, 2U, 11U})
    for (const StressCell& cell : bench_stress({true, seed}).cells) {
      INFO(seed << " " << cell.subject << ", " << cell.input << ": " << cell.what);
      CHECK(cell.outcome != StressOutcome::wrong);
      if (cell.outcome == StressOutcome::refused) CHECK(cell.what.size() > 10);
    }
}

TEST_CASE("stress: every deviation and every fusion algorithm is tried, worst first") {
  const StressBench bench = bench_stress({true, 1});
  std::set<std::string> subjects;
  for (const StressCell& cell : bench.cells) subjects.insert(cell.subject);
  for (const DeviationRow& row : deviation_rows()) CHECK(subjects.count(std::string(row.word)) == 1);
  for (const fusion::Entry& entry : fusion::algorithms())
    CHECK(subjects.count(std::string(entry.description->name)) == 1);
  CHECK(bench.count(StressOutcome::digits) > 300);
  CHECK(bench.count(StressOutcome::digits) + bench.count(StressOutcome::held) + bench.count(StressOutcome::refused) ==
        bench.cells.size());
  double before = -100;
  for (const StressCell& cell : bench.cells) {
    if (std::isnan(cell.stated)) break;
    CHECK(cell.digits - cell.stated >= before);
    before = cell.digits - cell.stated;
  }
}

TEST_CASE("stress: digits by hand") {
  const std::vector<double> values = {1.001, 0};
  CHECK(right_digits(values, std::vector<Exact>{1, 0}) == Approx(3).margin(1e-9));
  CHECK(right_digits(values, std::vector<Exact>{1.001, 0}) == 16);
  CHECK(right_digits(std::vector<double>{1, 1e-5}, std::vector<Exact>{1, 0}) == Approx(5));
  CHECK(right_digits_together(std::vector<double>{3, 4.005}, std::vector<Exact>{3, 4}) == Approx(3));
  CHECK(right_digits(std::vector<double>{std::nan("")}, std::vector<Exact>{1}) == 0);
  CHECK(right_digits(values, std::vector<Exact>{1.001}) == 0);
  StressCell cell;
  judge_digits(3, 4, cell);
  CHECK(cell.outcome == StressOutcome::wrong);
  CHECK_THAT(cell.what, Contains("3.0 digits, 4 are stated"));
  judge_digits(4, 4, cell);
  CHECK(cell.outcome == StressOutcome::digits);
  judge_held(false, "beyond", cell);
  CHECK(cell.outcome == StressOutcome::wrong);
  judge_refused("", cell);
  CHECK(cell.outcome == StressOutcome::wrong);
}

TEST_CASE("stress: the definitions in long double give SP 1065's thousand points") {
  const auto known = nlohmann::json::parse(test::slurp(test::known("allan/sp1065_1000pt_devs.json")));
  std::vector<double> y(1000);
  std::uint64_t n = 1234567890;
  for (double& value : y) {
    value = static_cast<double>(n) / 2147483647.0;
    n = 16807 * n % 2147483647;
  }
  int compared = 0;
  for (const auto& [name, points] : known["dev"].items())
    for (const auto& [m, point] : points.items()) {
      INFO(name << " " << m);
      std::string word = name;
      for (char& c : word) c = static_cast<char>(std::tolower(c));
      const Exact expected = std::strtold(std::string(point["dev"]).c_str(), nullptr);
      const Exact found = exact_deviation(y, 1, deviation_type(word).value(), std::stoul(m), 1);
      CHECK(static_cast<double>(std::abs(found / expected - 1)) < 2e-15);
      ++compared;
    }
  CHECK(compared == 70);
}

TEST_CASE("stress: weights in long double against the closed form for two") {
  // Errors of variance 1 and 4, uncorrelated: weights 4/5 and 1/5.
  const std::vector<std::vector<double>> errors = {{1, -1, 1, -1}, {2, 2, -2, -2}};
  const std::vector<Exact> w = exact_weights(errors);
  CHECK(static_cast<double>(w[0]) == Approx(0.8).epsilon(1e-15));
  CHECK(static_cast<double>(w[1]) == Approx(0.2).epsilon(1e-15));
}
