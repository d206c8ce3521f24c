// Monte Carlo of the noise fit on the scenes of the theory page: efficiency against the Cramér-Rao bound, bias,
// coverage, false terms, time. Usage: fit_bench [records per scene = 400] [scene letters = all] [blocks]
#include <fmt/format.h>

#include <chrono>
#include <cstdlib>
#include <string>

#include "libchar/core/coefficient.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/curve/bounds.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"
#include "libchar/fit/noise_fit.hpp"
#include "libchar/fit/record/power_bins.hpp"
#include "libchar/fit/record/record_sums.hpp"
#include "tests/support/noise.hpp"

namespace {

using namespace libchar;
using Clock = std::chrono::steady_clock;

struct Scene {
  std::string name;
  double rate_hz;
  std::size_t samples;
  double q, b, k;
};

const std::vector<Scene> kScenes = {
    {"a1", 200, 200000, 5e-3, 1e-3, 1e-4},
    {"a2", 200, 1000000, 5e-3, 1e-3, 1e-4},
    {"b'", 20.0 / 3, 200000, 1e-3, 1.598e-4, 4.137e-6},
    {"c", 1000, 100000, 1e-3, 2.5e-3, 0},
    {"d", 200, 200000, 5e-3, 0, 0},
    {"e", 200, 200000, 5e-3, 0, 1e-2},
    {"f", 200, 200000, 1e-3, 1e-2, 5e-3},
};

struct Tally {
  double sum = 0, square = 0;
  int covered = 0, count = 0, detected = 0, undetermined = 0, reported = 0, reported_covered = 0, decided_covered = 0;
};

struct Row {
  std::array<Tally, 3> term;
  int at_optimum = 0, records = 0;
  double fit_ms = 0, bins_ms = 0, worst_excess = 0, worst_ratio = 0, p_below = 0;
};

Mixture theta_of(const Scene& scene) { return {scene.q * scene.q, scene.b * scene.b, scene.k * scene.k, 0, 0}; }

double milliseconds(Clock::time_point from) {
  return std::chrono::duration<double, std::milli>(Clock::now() - from).count();
}

/// Excess of -lnL at the fit over the best of eight random starts.
double excess_over_multistart(const std::vector<PowerBin>& bins, const NoiseFit& fit, test::Gaussian& gauss) {
  const BinProblem problem = bin_problem(bins);
  const double reached = half_deviance(problem, {fit.theta, {}});
  TermSet kept{};
  for (std::size_t i = 0; i < kTerms; ++i) kept[i] = fit.theta[i] > 0;
  double best = reached;
  for (int i = 0; i < 8; ++i) {
    ModelPoint start;
    for (std::size_t t = 0; t < kTerms; ++t) start.theta[t] = kept[t] ? fit.theta[t] * std::exp(4 * gauss()) : 0;
    best = std::min(best, score(problem, kept, &start, 1e-12).half_deviance);
  }
  return reached - best;
}

void add(Tally& tally, const Coefficient& c, double truth) {
  const double value = c.value.value_or(0);
  tally.sum += value;
  tally.square += (value - truth) * (value - truth);
  ++tally.count;
  const bool inside = c.ci95.low <= truth && truth <= c.ci95.high;
  tally.covered += inside ? 1 : 0;
}

Row run(const Scene& scene, int records, bool in_blocks) {
  Row row;
  test::NoiseSource source(scene.samples, scene.rate_hz, 20261121);
  test::Gaussian starts(7);
  const std::array<double, 3> truth = {scene.q, scene.b, scene.k};
  FitOptions plain;
  plain.terms = {true, scene.b > 0, scene.k > 0, false, false};
  plain.threshold = 0;
  plain.remedies = plain.second_opinion = false;
  FitOptions deciding;
  deciding.second_opinion = deciding.remedies = false;
  for (int r = 0; r < records; ++r) {
    const std::vector<double> y = source.record(scene.q, scene.b, scene.k);
    auto from = Clock::now();
    const std::vector<PowerBin> bins = in_blocks
                                           ? power_bins(powers_of(record_sums(y, false).plain.bins), scene.rate_hz)
                                           : power_bins(y, scene.rate_hz);
    row.bins_ms += milliseconds(from);
    const NoiseFit fit = fit_power_bins(bins, scene.rate_hz, y.size(), nullptr, plain);
    from = Clock::now();
    const NoiseFit decided = fit_power_bins(bins, scene.rate_hz, y.size(), nullptr, deciding);
    row.fit_ms += milliseconds(from);
    const double excess = excess_over_multistart(bins, decided, starts);
    row.worst_excess = std::max(row.worst_excess, excess);
    row.at_optimum += decided.search.converged && excess < 1e-3 ? 1 : 0;
    row.p_below += decided.goodness.p < 0.05 ? 1 : 0;
    ++row.records;
    for (std::size_t i = 0; i < 3; ++i) {
      if (plain.terms[i]) add(row.term[i], fit.term[i], truth[i]);
      const Coefficient& c = decided.term[i];
      row.term[i].detected += c.status == Status::detected ? 1 : 0;
      row.term[i].undetermined += c.status == Status::undetermined ? 1 : 0;
      const bool inside = c.ci95.low <= truth[i] && truth[i] <= c.ci95.high;
      row.term[i].decided_covered += inside ? 1 : 0;
      if (c.status == Status::detected) {
        ++row.term[i].reported;
        row.term[i].reported_covered += inside ? 1 : 0;
      }
    }
  }
  return row;
}

void print(const Scene& scene, const Row& row) {
  const std::array<double, 3> truth = {scene.q, scene.b, scene.k};
  const TermSet fitted = {true, scene.b > 0, scene.k > 0, false, false};
  const auto bound = cramer_rao(theta_of(scene), scene.rate_hz, static_cast<double>(scene.samples), fitted);
  const double n = row.records;
  for (std::size_t i = 0; i < 3; ++i) {
    const Tally& t = row.term[i];
    if (truth[i] > 0) {
      const double crb = *bound[i] * truth[i];
      fmt::print("{:3} {:2} {:9.3f} {:10.3f} {:11.3f} {:10.1f} {:9.1f} {:13.1f} {:14.1f} {:11.1f}", scene.name,
                 kTermNames[i].letter, 100 * *bound[i], crb * crb / (t.square / n), (t.sum / n - truth[i]) / crb,
                 100.0 * t.covered / n, 100.0 * t.detected / n, 100.0 * t.undetermined / n,
                 t.reported ? 100.0 * t.reported_covered / t.reported : 0.0, 100.0 * t.decided_covered / n);
    } else {
      fmt::print("{:3} {:2} {:>9} {:>10} {:>11} {:>10} {:9.1f} {:13.1f} {:>14} {:11.1f}", scene.name,
                 kTermNames[i].letter, "absent", "", "", "", 100.0 * t.detected / n, 100.0 * t.undetermined / n, "",
                 100.0 * t.decided_covered / n);
    }
    if (i == 0)
      fmt::print(" {:7.1f} {:9.2e} {:8.3f} {:8.2f} {:7.1f}", 100.0 * row.at_optimum / n, row.worst_excess,
                 row.fit_ms / n, row.bins_ms / n, 100 * row.p_below / n);
    fmt::print("\n");
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int records = argc > 1 ? std::atoi(argv[1]) : 400;
  const std::string chosen = argc > 2 ? argv[2] : "all";
  const bool in_blocks = argc > 3 && std::string(argv[3]) == "blocks";
  fmt::print("records {}; {}\n", records, in_blocks ? "blocks" : "whole record");
  fmt::print(
      "         bound %   CRB2/MSE   bias [CRB] cover95 %  detected  undetermined  cover|detected  cover all  optimum  "
      "worst    ms/fit  ms/bins  p<.05\n");
  for (const Scene& scene : kScenes) {
    if (chosen == "all" || chosen.find(scene.name[0]) != std::string::npos)
      print(scene, run(scene, records, in_blocks));
  }
}
