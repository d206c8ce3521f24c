// Independent sensors with Allan variances v_i at tau, weighted by 1/v_i: 1/v = sum 1/v_i; n equal ones: v/n. The
// length of a record: where the Cramer-Rao bound of a term falls to the share (fit/bounds.hpp).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/allan/noise_curves.hpp"
#include "libchar/benchmark/bench_document.hpp"
#include "libchar/benchmark/detail/estimators.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/fit/curve/bounds.hpp"

namespace libchar {
namespace {

void check_models(const std::vector<BenchSignal>& models, const DesignOptions& options) {
  if (!options.target) return;
  for (const BenchSignal& model : models) {
    if (model.model.unit != models[0].model.unit || model.rate_hz != models[0].rate_hz)
      throw usage_error("E0967", model.name)
          .says("one target for models of several units or rates")
          .hint("give models of one unit and rate at a time; of a log, by `channels`");
    if (options.tau_s * model.rate_hz < 1)
      throw usage_error("E0967", model.name)
          .says("the averaging time is below the time between two samples")
          .got("{} s", options.tau_s)
          .hint("a longer one");
  }
}

double averaging(const BenchSignal& model, const DesignOptions& options) {
  return std::round(options.tau_s * model.rate_hz);
}

double variance_at(const BenchSignal& model, const DesignOptions& options) {
  return allan_variance(truth_of(model.model), averaging(model, options), 1 / model.rate_hz);
}

/// Non-overlapping Allan variance at m, the plain definition.
double variance_in(const std::vector<double>& y, std::size_t m) {
  double before = 0, sum = 0;
  std::size_t terms = 0;
  for (std::size_t block = 0; (block + 1) * m <= y.size(); ++block) {
    double mean = 0;
    for (std::size_t i = 0; i < m; ++i) mean += y[block * m + i] / static_cast<double>(m);
    if (block > 0) sum += (mean - before) * (mean - before) / 2, ++terms;
    before = mean;
  }
  return sum / static_cast<double>(terms);
}

constexpr std::size_t kAverages = 16;  // in a simulated record

SensorsNeeded sensors_needed(const BenchSignal& model, const DesignOptions& options, Progress& progress) {
  SensorsNeeded out;
  out.model = model.name;
  const double variance = variance_at(model, options), target = *options.target;
  out.single = std::sqrt(variance);
  out.sensors = static_cast<std::uint64_t>(std::max(1.0, std::ceil(variance / (target * target))));
  out.predicted = std::sqrt(variance / static_cast<double>(out.sensors));
  const auto m = static_cast<std::size_t>(averaging(model, options));
  if (static_cast<double>(m * kAverages) * static_cast<double>(out.sensors) > options.most_samples) return out;
  BenchSignal record = model;
  record.samples = m * kAverages;
  std::vector<double> deviations;
  for (std::size_t r = 0; r < options.records; ++r) {
    progress.update(static_cast<double>(r) / static_cast<double>(options.records),
                    fmt::format("{} of {}: record {}", out.sensors, model.name, r + 1));
    const std::vector<double> fused = mean_of_records(record, out.sensors, options.seed + r);
    deviations.push_back(std::sqrt(variance_in(fused, m)));
  }
  // Degrees of freedom: about one a pair of averages; the records' own scatter says it better.
  std::vector<double> squares;
  squares.reserve(deviations.size());
  for (const double d : deviations) squares.push_back(d * d);
  const Figure mean = mean_figure(squares);
  out.simulated = {
      std::sqrt(mean.value), {std::sqrt(std::max(0.0, mean.ci95.low)), std::sqrt(mean.ci95.high)}, mean.count};
  return out;
}

RecordNeeded record_needed(const BenchSignal& model, Term term, const DesignOptions& options, Progress& progress) {
  RecordNeeded out;
  out.model = model.name;
  out.term = term;
  const Mixture theta = truth_of(model.model);
  TermSet terms{};
  for (std::size_t i = 0; i < kTerms; ++i) terms[i] = theta[i] > 0;
  out.seconds = seconds_for(term, options.share, theta, model.rate_hz, terms);
  if (!out.seconds) return out;
  out.samples = std::ceil(*out.seconds * model.rate_hz);
  if (out.samples > options.most_samples / 4 || out.samples < 64) return out;
  BenchSignal record = model;
  record.samples = static_cast<std::uint64_t>(out.samples);
  CharacterizationBenchOptions how;
  how.records = options.records;
  how.seed = options.seed;
  how.methods = {"whittle"};
  const CharacterizationBench found = bench_characterization(record, how, progress);
  for (const TermAccuracy& accuracy : found.methods[0].terms)
    if (accuracy.term == term) {
      const double scale = accuracy.bound / accuracy.truth;
      out.simulated = accuracy.error;
      out.simulated.value *= scale;
      out.simulated.ci95.low *= scale;
      out.simulated.ci95.high *= scale;
    }
  return out;
}

}  // namespace

DesignBench bench_design(const std::vector<BenchSignal>& models, const DesignOptions& options, Progress& progress) {
  check_models(models, options);
  DesignBench out;
  out.options = options;
  double information = 0;
  for (const BenchSignal& model : models) {
    if (options.target) {
      out.sensors.push_back(sensors_needed(model, options, progress));
      information += 1 / variance_at(model, options);
    }
    for (std::size_t i = 0; i < kTerms; ++i)
      if (truth_of(model.model)[i] > 0)
        out.records.push_back(record_needed(model, static_cast<Term>(i), options, progress));
  }
  if (options.target && models.size() > 1) out.one_of_each = std::sqrt(1 / information);
  return out;
}

}  // namespace libchar
