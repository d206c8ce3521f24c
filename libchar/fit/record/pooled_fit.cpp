// Records are independent, so their log-likelihoods add. Bins of one frequency and one expectation (records of one
// length) are one bin: sums of gamma variables of one mean are sufficient,
//   energy = sum nu_r c_r / sum nu_r,   nu = sum nu_r,
// and unlike ones stand side by side. The rest is the fit of one record.
#include "libchar/fit/record/pooled_fit.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"
#include "libchar/fit/detail/curve/coefficients.hpp"

namespace libchar {
namespace {

constexpr double kWideAbove = 0.30;  ///< relative sd above which a term counts as not determined

bool alike(const PowerBin& a, const PowerBin& b) {
  if (a.low_hz != b.low_hz || a.high_hz != b.high_hz) return false;
  for (std::size_t t = 0; t < kTerms; ++t)
    if (std::abs(a.unit[t] - b.unit[t]) > 1e-12 * std::abs(a.unit[t])) return false;
  return true;
}

struct Merged {
  std::vector<PowerBin> bins;
  std::vector<std::vector<std::size_t>> place;  ///< of each bin of each record
};

/// A bin of a record, by its number.
struct BinOfRun {
  const PowerBin* bin = nullptr;
  std::size_t run = 0, index = 0;
};

Merged merged(std::span<const RunRecord> records) {
  std::vector<BinOfRun> all;
  Merged out;
  for (std::size_t r = 0; r < records.size(); ++r) {
    for (std::size_t j = 0; j < records[r].bins.size(); ++j) all.push_back({&records[r].bins[j], r, j});
    out.place.emplace_back(records[r].bins.size());
  }
  std::stable_sort(all.begin(), all.end(), [](const BinOfRun& a, const BinOfRun& b) {
    return std::pair(a.bin->frequency_hz, a.bin->high_hz) < std::pair(b.bin->frequency_hz, b.bin->high_hz);
  });
  std::size_t first = 0;  // of those merged bins that stand at this frequency
  for (const BinOfRun& one : all) {
    while (first < out.bins.size() && out.bins[first].frequency_hz < one.bin->frequency_hz) ++first;
    std::size_t at = first;
    while (at < out.bins.size() && !alike(out.bins[at], *one.bin)) ++at;
    if (at == out.bins.size()) {
      out.bins.push_back(*one.bin);
    } else {
      PowerBin& bin = out.bins[at];
      const double dof = bin.dof + one.bin->dof;
      if (dof > 0) bin.energy = (bin.energy * bin.dof + one.bin->energy * one.bin->dof) / dof;
      bin.dof = dof;
    }
    out.place[one.run][one.index] = at;
  }
  return out;
}

double of_terms(const PowerBin& bin, const Mixture& theta) {
  double sum = 0;
  for (std::size_t t = 0; t < kTerms; ++t) sum += theta[t] * bin.unit[t];
  return sum;
}

RunBins inside_band(std::span<const RunRecord> records, const Merged& all, const NoiseFit& fit) {
  RunBins out(records.size());
  for (std::size_t r = 0; r < records.size(); ++r)
    for (std::size_t j = 0; j < records[r].bins.size(); ++j) {
      const std::size_t at = all.place[r][j];
      const double terms = of_terms(all.bins[at], fit.theta);
      if (!fit.residuals[at].inside || !(terms > 0)) continue;
      PowerBin bin = records[r].bins[j];
      for (double& unit : bin.unit) unit *= fit.residuals[at].model / terms;
      out[r].push_back(bin);
    }
  return out;
}

/// The bounds of one long record are not those of many short ones: what the information of all bins gives stands in
/// relative_sd.
void without_bounds(NoiseFit& fit) {
  for (std::size_t t = 0; t < kTerms; ++t) {
    Coefficient& term = fit.term[t];
    term.bound.reset();
    term.seconds_for_10_percent.reset();
    if (term.status != Status::detected || !(term.relative_sd > kWideAbove)) continue;
    term.status = Status::undetermined;
    fit.findings.push_back(
        finding("too_short", fmt::format("The runs are too few or too short for {}: it is known to {} (1 sd).",
                                         long_name(static_cast<Term>(t)), percent_text(term.relative_sd))));
  }
}

}  // namespace

PooledFit fit_pooled(std::span<const RunRecord> records, double rate_hz, const FitOptions& options) {
  if (records.empty()) throw usage_error("E0205").says("there is no run to fit");
  const Merged all = merged(records);
  std::uint64_t samples = 0;
  for (const RunRecord& record : records) samples += record.samples;
  FitOptions one = options;
  one.second_opinion = false;
  PooledFit out;
  out.fit = fit_power_bins(all.bins, rate_hz, samples, nullptr, one);
  out.fit.search.method += fmt::format(" of {} runs", records.size());
  without_bounds(out.fit);
  out.terms = options.terms;
  for (std::size_t t = 0; t < kTerms; ++t) out.terms[t] = out.terms[t] || out.fit.theta[t] > 0;
  out.runs = inside_band(records, all, out.fit);
  return out;
}

RunRatios run_ratios(const RunBins& runs, const std::array<bool, kTerms>& terms) {
  std::vector<PowerBin> all;
  for (const auto& bins : runs) all.insert(all.end(), bins.begin(), bins.end());
  RunRatios out;
  const ScoringResult together = score(bin_problem(all), terms);
  out.common = together.at.theta;
  for (const auto& bins : runs) {
    if (bins.size() < count_of(terms)) {
      out.run.push_back(0);
      continue;
    }
    const BinProblem problem = bin_problem(bins);
    const double common = half_deviance(problem, together.at);
    out.run.push_back(std::max(0.0, 2 * (common - score(problem, terms).half_deviance)));
    out.total += out.run.back();
  }
  return out;
}

std::vector<double> expected_energy(const std::vector<PowerBin>& bins, const Mixture& theta) {
  std::vector<double> out;
  out.reserve(bins.size());
  for (const PowerBin& bin : bins) out.push_back(of_terms(bin, theta));
  return out;
}

}  // namespace libchar
