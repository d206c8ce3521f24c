#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/benchmark/bench_document.hpp"
#include "libchar/benchmark/detail/estimators.hpp"
#include "libchar/benchmark/turns.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/fit/curve/bounds.hpp"

namespace libchar {
namespace {

/// A term whose bound is wider than this share of it is not in the mean of errors: an estimate of
/// zero would be the best there is.
constexpr double kTellable = 0.5;

struct NamedNoise {
  const char* name;
  double rate_hz;
  double white, flicker, walk;
};

// The regimes of docs/theory/fit.md: every pair of terms, one of them barely there, one alone.
constexpr NamedNoise kSignals[] = {{"gyroscope, all three terms", 200, 5e-3, 1e-3, 1e-4},
                                   {"white noise alone", 200, 5e-3, 0, 0},
                                   {"white noise and flicker", 1000, 1e-3, 2.5e-3, 0},
                                   {"white noise and random walk", 200, 5e-3, 0, 1e-2},
                                   {"flicker to half the rate", 200, 1e-3, 1e-2, 5e-3}};

void give(SensorModel& model, Term term, double value) {
  Coefficient& c = model.noise[static_cast<std::size_t>(term)];
  if (value <= 0) return;
  c.status = Status::given;
  c.value = value;
}

std::vector<Estimator> chosen_estimators(const std::vector<std::string>& names) {
  if (names.empty()) return estimators();
  std::vector<std::string> known;
  for (const Estimator& row : estimators()) known.emplace_back(row.name);
  std::vector<Estimator> out;
  for (const std::string& name : names) {
    const auto row = std::find(known.begin(), known.end(), name);
    if (row == known.end())
      throw usage_error("E0202")
          .says("no such way to get noise coefficients")
          .got(name)
          .hint(did_you_mean(nearest(name, known), first_names(known)));
    out.push_back(estimators()[static_cast<std::size_t>(row - known.begin())]);
  }
  return out;
}

struct Tally {
  std::array<std::vector<double>, kTerms> error;  // of the value, over the bound
  std::array<std::size_t, kTerms> covered{}, stated{};
  std::size_t false_records = 0, records = 0;
  std::vector<double> ns;
  std::optional<double> bytes;
};

bool says_present(const CoefficientEstimate& estimate) {
  return estimate.value && *estimate.value > 0 && (!estimate.ci95 || estimate.ci95->low > 0);
}

void add(const NoiseEstimate& estimate, const Mixture& truth, const std::array<std::optional<double>, kTerms>& bound,
         Tally& tally) {
  bool any_false = false;
  for (std::size_t i = 0; i < kTerms; ++i) {
    const double is = std::sqrt(truth[i]);
    if (truth[i] == 0) {
      any_false = any_false || says_present(estimate[i]);
      continue;
    }
    tally.error[i].push_back((estimate[i].value.value_or(0) - is) / (bound[i].value_or(NAN) * is));
    if (!estimate[i].ci95) continue;
    ++tally.stated[i];
    tally.covered[i] += estimate[i].ci95->low <= is && is <= estimate[i].ci95->high ? 1 : 0;
  }
  tally.false_records += any_false ? 1 : 0;
  ++tally.records;
}

void run(const Estimator& estimator, const std::vector<double>& record, double rate_hz, const Mixture& truth,
         const std::array<std::optional<double>, kTerms>& bound, HeapMeter* heap, Tally& tally) {
  TermSet terms{};
  for (std::size_t i = 0; i < kTerms; ++i) terms[i] = truth[i] > 0;
  if (heap != nullptr) heap->begin();
  const double from = thread_seconds();
  const NoiseEstimate estimate = estimator.estimate(record, rate_hz, terms);
  const auto samples = static_cast<double>(record.size());
  tally.ns.push_back(1e9 * (thread_seconds() - from) / samples);
  if (heap != nullptr) tally.bytes = std::max(tally.bytes.value_or(0), static_cast<double>(heap->end().peak) / samples);
  add(estimate, truth, bound, tally);
}

EstimatorAccuracy accuracy_of(const Estimator& estimator, const Tally& tally, const Mixture& truth,
                              const std::array<std::optional<double>, kTerms>& bound) {
  EstimatorAccuracy out;
  out.name = estimator.name;
  out.what = estimator.what;
  out.is_ours = estimator.is_ours;
  out.told = estimator.told;
  double log_sum = 0, tellable = 0;
  bool has_absent = false;
  for (std::size_t i = 0; i < 3; ++i) has_absent = has_absent || truth[i] == 0;
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (truth[i] == 0) continue;
    TermAccuracy term;
    term.term = static_cast<Term>(i);
    term.truth = std::sqrt(truth[i]);
    term.bound = bound[i].value_or(NAN) * term.truth;
    term.error = rms_figure(tally.error[i]);
    term.coverage = share_figure(tally.covered[i], tally.stated[i]);
    term.bias = mean_figure(tally.error[i]).value;
    out.terms.push_back(term);
    if (!(*bound[i] <= kTellable)) continue;
    log_sum += std::log(term.error.value);
    ++tellable;
  }
  out.error = std::exp(log_sum / tellable);
  if (has_absent && !estimator.told) out.false_terms = share_figure(tally.false_records, tally.records);
  out.ns_per_sample = time_figure(tally.ns);
  out.bytes_per_sample = tally.bytes;
  return out;
}

void add_front_gaps(std::vector<EstimatorAccuracy>& methods) {
  std::vector<CostAndError> all, deciding;
  for (const EstimatorAccuracy& m : methods) {
    all.push_back({m.ns_per_sample.value, m.error});
    deciding.push_back(m.told ? CostAndError{NAN, NAN} : all.back());
  }
  const std::vector<double> gaps = front_gaps(all), own = front_gaps(deciding);
  for (std::size_t i = 0; i < methods.size(); ++i) methods[i].front_gap = methods[i].told ? gaps[i] : own[i];
}

std::vector<std::string> notes_on(const SensorModel& model) {
  std::vector<std::string> out;
  if (model.noise_shape.kind != NoiseShape::Kind::none || model.bandwidth_hz || model.gauss_markov.sigma > 0 ||
      model.flicker_phase > 0)
    out.emplace_back(
        "the model has a shape, a bandwidth or a further process: the bound is that of its terms without them, which "
        "nobody can reach");
  return out;
}

}  // namespace

std::vector<BenchSignal> bench_signals(std::uint64_t samples) {
  std::vector<BenchSignal> out;
  for (const NamedNoise& row : kSignals) {
    BenchSignal signal{row.name, {}, row.rate_hz, samples};
    give(signal.model, Term::white, row.white);
    give(signal.model, Term::flicker, row.flicker);
    give(signal.model, Term::walk, row.walk);
    out.push_back(std::move(signal));
  }
  return out;
}

CharacterizationBench bench_characterization(const BenchSignal& signal, const CharacterizationBenchOptions& options,
                                             Progress& progress, HeapMeter* heap) {
  const Mixture truth = truth_of(signal.model);
  if (truth[0] + truth[1] + truth[2] == 0)
    throw input_error("E0962", signal.name)
        .says("no white noise, flicker or random walk to estimate")
        .hint("a model needs one of noise.white_noise, bias_instability, random_walk");
  TermSet fitted{};
  for (std::size_t i = 0; i < kTerms; ++i) fitted[i] = truth[i] > 0;
  const auto bound = cramer_rao(truth, signal.rate_hz, static_cast<double>(signal.samples), fitted);
  const std::vector<Estimator> rows = chosen_estimators(options.methods);
  std::vector<Tally> tallies(rows.size());
  for (std::size_t r = 0; r < options.records; ++r) {
    const std::vector<double> record = record_of(signal, options.seed + r);
    for (const std::size_t i : order_of_round(rows.size(), r)) {
      progress.update(static_cast<double>(r) / static_cast<double>(options.records),
                      fmt::format("{}: record {} of {}", signal.name, r + 1, options.records));
      run(rows[i], record, signal.rate_hz, truth, bound, heap, tallies[i]);
    }
  }
  CharacterizationBench out{signal, options.seed, options.records, {}, notes_on(signal.model)};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    out.methods.push_back(accuracy_of(rows[i], tallies[i], truth, bound));
    std::vector<double> ratios;
    for (std::size_t r = 0; r < options.records; ++r) ratios.push_back(tallies[i].ns[r] / tallies[0].ns[r]);
    out.methods[i].time_ratio = time_figure(std::move(ratios));
  }
  add_front_gaps(out.methods);
  return out;
}

}  // namespace libchar
