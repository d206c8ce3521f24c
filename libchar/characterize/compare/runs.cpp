// Whether runs have one set of coefficients: T = 2 (sum of the runs' ln L with their own - with common coefficients),
// the shape and band held. Its distribution is not chi-square (coefficients at zero, bins of one degree of freedom), so
// it is simulated: runs of the same bins from the common coefficients, energies as the likelihood has them, until ten
// are as large (Besag & Clifford, Biometrika 78 (1991) 301). Then the run of the largest ratio is named where that is
// beyond the largest of any by chance, left out, and the rest tested again. Where the rest is alike, the coefficients
// are its own. Turn-on bias: means of runs scatter by the noise (the Allan deviation of the run's length) and by the
// spread that is sought (core/random_effects.hpp). What the bias does between runs that were not switched off is in the
// spread as well.
#include "libchar/characterize/compare/runs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "libchar/allan/noise_curves.hpp"
#include "libchar/characterize/judgement.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/fit/signs/rounding.hpp"
#include "libchar/simulate/random.hpp"

namespace libchar {
namespace {

// Recordings that are to be taken together: are they of one sensor?

/// The channel of that name; null: none.
const ChannelResult* find_channel(const Characterization& result, const std::string& name) {
  for (const ChannelResult& c : result.channels)
    if (c.channel.name == name) return &c;
  return nullptr;
}

constexpr double kOtherRate = 0.01;  ///< relative: clocks of one kind of sensor differ by less

void check_channels(const Characterization& first, const Characterization& run) {
  for (const ChannelResult& c : first.channels) {
    const ChannelResult* const other = find_channel(run, c.channel.name);
    if (other == nullptr)
      throw input_error("E0761", run.log.file)
          .says("has no channel {}, which {} has: runs of one sensor have the same channels", c.channel.name,
                first.log.file)
          .hint("`channels` takes those that all have");
    if (other->channel.unit != c.channel.unit)
      throw input_error("E0761", run.log.file)
          .says("channel {} is in {}, and in {} in {}: runs of one sensor have one unit", c.channel.name,
                other->channel.unit.empty() ? "no unit" : other->channel.unit,
                c.channel.unit.empty() ? "no unit" : c.channel.unit, first.log.file)
          .hint("if a log does not state it, give `units`");
  }
  for (const ChannelResult& c : run.channels)
    if (find_channel(first, c.channel.name) == nullptr)
      throw input_error("E0761", run.log.file)
          .says("has a channel {}, which is not in {}: runs of one sensor have the same channels", c.channel.name,
                first.log.file)
          .hint("`channels` takes those that all have");
}

/// Throws Error where the runs cannot be of one sensor (runs.hpp).
void check_runs(std::span<const Characterization> runs) {
  if (runs.size() < 2) throw usage_error("E0205").says("one recording is not several runs").hint("name two at least");
  refuse_same_recording(runs);
  const Characterization& first = runs[0];
  for (const Characterization& run : runs) {
    check_channels(first, run);
    const double rate = run.log.time.rate_hz, other = first.log.time.rate_hz;
    if (std::abs(rate - other) > kOtherRate * other)
      throw input_error("E0761", run.log.file)
          .says("is sampled at {} Hz, and {} at {} Hz: runs of one sensor have one rate", brief_text(rate, 6),
                first.log.file, brief_text(other, 6));
    if (std::none_of(run.channels.begin(), run.channels.end(),
                     [](const ChannelResult& c) { return c.fit.has_value(); }))
      throw input_error("E0761", run.log.file)
          .says(run.channels.empty() || run.channels[0].findings.empty()
                    ? "no channel of this run could be fitted"
                    : "no channel of this run could be fitted: " + run.channels[0].findings[0].sentence)
          .hint("leave this run out");
  }
}

constexpr int kEnough = 10;  ///< simulated sums as large as the observed one, after which p is known well enough

/// chi-square / dof: of normal deviates, or by Wilson & Hilferty where there are many.
double scaled_chi_square(double dof, DeviateStream& random) {
  if (dof > 64 || dof != std::floor(dof)) {
    const double c = 2 / (9 * dof);
    const double root = 1 - c + random.normal() * std::sqrt(c);
    return root * root * root;
  }
  double sum = 0;
  for (int i = 0; i < static_cast<int>(dof); ++i) {
    const double z = random.normal();
    sum += z * z;
  }
  return sum / dof;
}

RunBins simulated(const RunBins& runs, const Mixture& theta, DeviateStream& random) {
  RunBins out = runs;
  for (auto& bins : out) {
    const std::vector<double> expected = expected_energy(bins, theta);
    for (std::size_t j = 0; j < bins.size(); ++j)
      bins[j].energy = expected[j] * std::max(1e-12, scaled_chi_square(bins[j].dof, random));
  }
  return out;
}

/// Ratios of some runs, and how often chance makes as large ones.
struct RunsTest {
  RunRatios ratios;
  double p = 1;
  int simulations = 0;
  std::vector<double> run_p;
};

RunsTest tested(const RunBins& runs, const std::array<bool, kTerms>& terms, const PoolOptions& options,
                DeviateStream& random) {
  RunsTest out;
  out.ratios = run_ratios(runs, terms);
  int made = 0, larger = 0;
  std::vector<int> exceeded(runs.size());
  while (made < options.replicates && larger < kEnough) {
    const RunRatios chance = run_ratios(simulated(runs, out.ratios.common, random), terms);
    const double largest = *std::max_element(chance.run.begin(), chance.run.end());
    ++made;
    larger += chance.total >= out.ratios.total ? 1 : 0;
    for (std::size_t r = 0; r < runs.size(); ++r) exceeded[r] += largest >= out.ratios.run[r] ? 1 : 0;
  }
  out.simulations = made;
  // With ten as large the last one made is one of them: without the observed one in the count.
  out.p = larger == kEnough ? static_cast<double>(larger) / made : (1.0 + larger) / (1.0 + made);
  for (const int count : exceeded) out.run_p.push_back((1.0 + count) / (1.0 + made));
  return out;
}

/// Names runs one by one: an unlike one bends the common coefficients, and all others would look
/// unlike beside it. Whether the rest is alike, and most of them.
bool name_unlike(const PooledFit& pooled, const PoolOptions& options, RunsTest test, DeviateStream& random,
                 PooledChannel& out) {
  RunBins rest = pooled.runs;
  std::vector<std::size_t> place(rest.size());
  std::iota(place.begin(), place.end(), std::size_t{0});
  while (test.p < options.probability && rest.size() > 2) {
    const auto worst = static_cast<std::size_t>(std::max_element(test.ratios.run.begin(), test.ratios.run.end()) -
                                                test.ratios.run.begin());
    if (!(test.run_p[worst] < options.probability)) break;
    out.runs[place[worst]].differs = true;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(worst));
    place.erase(place.begin() + static_cast<std::ptrdiff_t>(worst));
    test = tested(rest, pooled.terms, options, random);
  }
  return !(test.p < options.probability) && 2 * rest.size() > pooled.runs.size();
}

/// Fills the ratios, their p, and who differs. Whether those that do not are alike.
bool test_consistency(const PooledFit& pooled, const PoolOptions& options, PooledChannel& out) {
  DeviateStream random({options.seed, 0, Purpose::bootstrap});
  const RunsTest all = tested(pooled.runs, pooled.terms, options, random);
  out.ratio = all.ratios.total;
  out.p = all.p;
  out.simulations = all.simulations;
  out.consistent = !(all.p < options.probability);
  for (std::size_t r = 0; r < out.runs.size(); ++r) {
    out.runs[r].ratio = all.ratios.run[r];
    out.runs[r].p = all.run_p[r];
  }
  return out.consistent || name_unlike(pooled, options, all, random, out);
}

/// Coefficients of runs that do not share them: a mean of unlike things, known no better than they scatter.
void admit_unlike(const PooledFit& pooled, PooledChannel& out) {
  const double dof = static_cast<double>(
      (out.runs.size() - 1) * static_cast<std::size_t>(std::count(pooled.terms.begin(), pooled.terms.end(), true)));
  const double wider = std::sqrt(std::max(1.0, out.ratio / std::max(1.0, dof)));
  widen_as_misfit(wider, out.fit);
}

/// Squared coefficients, with what was not detected at its upper limit.
Mixture at_most(const NoiseFit& fit) {
  Mixture theta = fit.theta;
  for (std::size_t t = 0; t < kTerms; ++t)
    if (fit.term[t].upper95 && !fit.term[t].value)
      theta[t] = std::max(theta[t], *fit.term[t].upper95 * *fit.term[t].upper95);
  return theta;
}

/// Variance by which flicker moves the mean of a run, beyond its Allan variance there, when runs may lie a year apart:
/// what its density B²/(2 pi f) holds between 1/year and 1/length.
double slower_flicker(const Mixture& theta, double length_s) {
  constexpr double kYear = 3.15576e7;
  return theta[static_cast<std::size_t>(Term::flicker)] / std::numbers::pi * std::max(0.0, std::log(kYear / length_s));
}

void find_bias(std::span<const Characterization> runs, PooledChannel& out) {
  std::vector<double> mean, least, most;
  const Mixture limits = at_most(out.fit);
  for (ChannelRun& run : out.runs) {
    const ChannelResult& channel = *find_channel(runs[run.run], out.channel.name);
    const double dt_s = 1 / channel.fit->rate_hz, m = static_cast<double>(channel.fit->samples);
    run.mean = channel.quality.mean;
    least.push_back(allan_variance(out.fit.theta, m, dt_s));
    most.push_back(allan_variance(limits, m, dt_s) + slower_flicker(limits, m * dt_s));
    run.mean_sd = std::sqrt(least.back());
    mean.push_back(run.mean);
  }
  if (out.runs.size() < 2 || !(*std::min_element(least.begin(), least.end()) > 0)) return;
  out.bias = random_effects(mean, least);
  // Slow noise that was not detected may be there, and flicker goes on between the runs: nothing is claimed that they
  // could have done.
  const RandomEffects careful = random_effects(mean, most);
  out.bias->spread_ci95.low = std::min(out.bias->spread_ci95.low, careful.spread_ci95.low);
  out.bias->p = careful.p;
}

std::string files_of(const PooledChannel& channel, std::span<const Characterization> runs) {
  std::string out;
  for (const ChannelRun& run : channel.runs)
    if (run.differs) out += (out.empty() ? "" : ", ") + runs[run.run].log.file;
  return out;
}

std::string consistency_sentence(const PooledChannel& c, std::span<const Characterization> runs) {
  const std::string figures = fmt::format("2 ln L rises by {} with coefficients of their own, {}",
                                          number_text(c.ratio, 3), probability_text(c.p, c.simulations));
  if (c.consistent)
    return fmt::format("One set of coefficients describes {} ({}).",
                       c.runs.size() == 2 ? "both runs" : fmt::format("all {} runs", c.runs.size()), figures);
  const std::string named = files_of(c, runs);
  return fmt::format("The runs do not have one set of coefficients ({}); {}.", figures,
                     named.empty() ? "no run differs alone" : "not like the rest: " + named) +
         (c.rest_alike ? " The coefficients are those of the rest."
                       : " The common ones are a mean of runs that differ.");
}

std::string bias_sentence(const PooledChannel& c) {
  const std::string unit = c.channel.unit.empty() ? "U" : c.channel.unit;
  const RandomEffects& b = *c.bias;
  if (b.spread_ci95.low > 0)
    return fmt::format("Turn-on bias: {} {} [{}, {}] standard deviation from run to run, about a mean of {} {}.",
                       number_text(b.spread, 3), unit, number_text(b.spread_ci95.low, 3),
                       number_text(b.spread_ci95.high, 3), number_text(b.mean), unit);
  return fmt::format(
      "Turn-on bias: the means of the runs scatter no more than noise, including slow noise that a run may not show, "
      "explains ({}); its spread is at most {} {} (97.5 %).",
      probability_text(b.p), number_text(b.spread_ci95.high, 3), unit);
}

/// Of runs that share it: else N is that of the samples, as it is.
std::optional<DigitalFaults::Rounding> common_rounding(std::span<const Characterization> runs,
                                                       const std::string& channel,
                                                       const std::vector<std::size_t>& fitted) {
  std::optional<DigitalFaults::Rounding> common;
  for (const std::size_t r : fitted) {
    const std::optional<DigitalFaults::Rounding>& one = find_channel(runs[r], channel)->digital.rounding;
    if (!one || (common && one->step != common->step)) return std::nullopt;
    if (!common || one->sd > common->sd) common = one;
  }
  return common;
}

PooledChannel pooled_channel(std::span<const Characterization> runs, const Channel& channel,
                             const std::vector<std::size_t>& fitted, const PoolOptions& options) {
  PooledChannel out;
  out.channel = channel;
  std::vector<RunRecord> records;
  double samples = 0, seconds = 0;
  for (const std::size_t r : fitted) {
    const NoiseFit& fit = *find_channel(runs[r], channel.name)->fit;
    records.push_back({fit.bins, fit.samples});
    samples += static_cast<double>(fit.samples);
    seconds += static_cast<double>(fit.samples) / fit.rate_hz;
    out.runs.push_back({});
    out.runs.back().run = r;
  }
  FitOptions fit = options.fit;
  fit.unit = channel.unit;
  const PooledFit pooled = fit_pooled(records, samples / seconds, fit);
  out.fit = pooled.fit;
  if (records.size() >= 2) {
    out.rest_alike = test_consistency(pooled, options, out);
    if (!out.rest_alike) admit_unlike(pooled, out);
    if (out.rest_alike && !out.consistent) {
      std::vector<RunRecord> rest;
      for (std::size_t r = 0; r < records.size(); ++r)
        if (!out.runs[r].differs) rest.push_back(records[r]);
      out.fit = fit_pooled(rest, samples / seconds, fit).fit;
    }
    std::string said = consistency_sentence(out, runs);
    if (out.consistent)
      out.sentences.push_back(std::move(said));
    else
      out.fit.findings.push_back(
          finding("runs_unlike", std::move(said), "the runs do not have one set of coefficients"));
  }
  if (const auto rounding = common_rounding(runs, channel.name, fitted)) detail::take_out_rounding(*rounding, out.fit);
  if (options.data == SampleKind::rate) find_bias(runs, out);
  if (out.bias) out.sentences.push_back(bias_sentence(out));
  return out;
}

std::string pool_verdict(const PooledRuns& pooled) {
  std::vector<std::string> unlike, without;
  for (const PooledChannel& c : pooled.channels) {
    if (!c.consistent) unlike.push_back(c.channel.name);
    if (has(c.fit.findings, "run_left_out")) without.push_back(c.channel.name);
  }
  std::string out;
  const std::size_t n = pooled.channels.size();
  if (n == 0) return "No channel could be pooled.";
  if (unlike.empty())
    out = fmt::format("{} runs, one sensor: one set of coefficients describes {} in all of them{}.", pooled.runs.size(),
                      n == 1 ? "the channel" : fmt::format("each of {} channels", n),
                      without.empty() ? "" : " that are sound");
  else
    out = fmt::format("{} runs that do not have one set of coefficients for {}.", pooled.runs.size(),
                      fmt::join(unlike, ", "));
  if (!without.empty()) out += fmt::format(" Runs were left out of {}.", fmt::join(without, ", "));
  std::size_t spread = 0;
  for (const PooledChannel& c : pooled.channels) spread += c.bias && c.bias->spread_ci95.low > 0;
  if (spread > 0) out += fmt::format(" The bias changes from turn-on to turn-on in {} of {}.", spread, n);
  return out;
}

/// The worst that is known of a run's channel, where its coefficients are not to be relied on; without a code: nothing.
Finding what_spoils(const ChannelResult& channel) {
  const std::vector<Finding> found = findings_of(channel);
  if (channel.fit && worst_of(found) != Severity::bad) return {};
  return found.empty() ? finding("no_fit", "it could not be fitted") : found[0];
}

/// Runs of a channel, and what is said of those that are left out, or taken because too few are sound.
struct Choice {
  std::vector<std::size_t> runs;
  std::vector<Finding> findings;
};

Choice chosen_runs(std::span<const Characterization> runs, const std::string& channel) {
  Choice out;
  std::vector<std::size_t> fitted;
  std::vector<Finding> spoilt;
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const ChannelResult& one = *find_channel(runs[r], channel);
    if (one.fit) fitted.push_back(r);
    Finding worst = what_spoils(one);
    if (worst.code.empty()) {
      out.runs.push_back(r);
      continue;
    }
    const std::string why = as_part(worst.phrase.empty() ? worst.sentence : worst.phrase);
    out.findings.push_back(finding("run_left_out", fmt::format("{} was left out: {}.", runs[r].log.file, why),
                                   "a run was left out: " + why));
    worst.sentence = runs[r].log.file + ": " + worst.sentence;
    if (one.fit) spoilt.push_back(std::move(worst));
  }
  if (out.runs.size() >= 2 || fitted.size() < 2) return out;
  return {std::move(fitted), std::move(spoilt)};
}

}  // namespace

void refuse_same_recording(std::span<const Characterization> runs) {
  for (std::size_t i = 0; i < runs.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (!runs[i].log.sha256.empty() && runs[i].log.sha256 == runs[j].log.sha256)
        throw input_error("E0762", runs[i].log.file)
            .says("is the same recording as {}: it would count twice", runs[j].log.file)
            .hint("leave one of them out");
}

PooledRuns pool_runs(std::span<const Characterization> runs, const PoolOptions& options) {
  check_runs(runs);
  PooledRuns out;
  for (const Characterization& run : runs) {
    const double rate = run.log.time.rate_hz;
    out.runs.push_back(
        {run.log.file, run.log.samples, rate > 0 ? static_cast<double>(run.log.samples) / rate : 0, rate});
  }
  for (const ChannelResult& first : runs[0].channels) {
    const Choice choice = chosen_runs(runs, first.channel.name);
    if (choice.runs.size() < 2) {
      out.findings.push_back(finding("not_computed", fmt::format("{}: not pooled, it could be fitted in {} of {} runs",
                                                                 first.channel.name, choice.runs.size(), runs.size())));
      out.findings.back().subject = first.channel.name;
      continue;
    }
    out.channels.push_back(pooled_channel(runs, first.channel, choice.runs, options));
    std::vector<Finding>& known = out.channels.back().fit.findings;
    known.insert(known.end(), choice.findings.begin(), choice.findings.end());
  }
  out.verdict = pool_verdict(out);
  return out;
}

}  // namespace libchar
