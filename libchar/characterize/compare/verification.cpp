// Per term: z = ln(simulated / model) / sd(ln simulated), the model being the truth of the simulation. Per averaging
// time: AVAR_recorded / AVAR_simulated against the F distribution with the equivalent degrees of freedom of both.
#include "libchar/characterize/compare/verification.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/characterize/detail/channel_stage.hpp"
#include "libchar/characterize/model_from_fit.hpp"
#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/parallel/parallel.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/fit/remedies.hpp"
#include "libchar/simulate/sensor_array.hpp"

namespace libchar {
namespace {

constexpr std::size_t kRows = std::size_t{1} << 14U;

// Only the noise: a recording at rest says nothing about the other blocks, and its resolution is in
// the fit already where it was not taken out.
SensorModel noise_of(const ChannelResult& channel, const LogInfo& log) {
  SensorModel model = sensor_model_from(channel, log);
  model.saturation_low = model.saturation_high = std::nullopt;
  if (!(channel.fit->rounding > 0)) model.resolution = std::nullopt;
  return model;
}

// The recording's steps, warm-up, ramp, slow cycles and temperature on top of simulated noise: the measured curve has
// them.
class MeansAdded {
 public:
  MeansAdded(const NoiseFit& fit, const ArraySimulation& simulation) {
    const bool moved = fit.temperature && fit.temperature->order > 0;
    if (fit.events.empty() && fit.cycles.empty() && !moved) return;
    less_.assign(detail::in_memory(simulation.samples), 0.0);
    for (const std::vector<Event>* means : {&fit.events, &fit.cycles})
      subtract_events(*means, simulation.rate_hz, less_);
    if (moved) add_temperature_effect(*fit.temperature, -1, less_);
  }
  std::span<const double> added(std::span<const double> noise) {
    if (less_.empty()) return noise;
    sum_.assign(noise.begin(), noise.end());
    for (double& sample : sum_) sample -= less_[at_++];
    return sum_;
  }

 private:
  std::vector<double> less_, sum_;
  std::size_t at_ = 0;
};

ChannelResult simulated_channel(const ChannelResult& recorded, const LogInfo& log, const CharacterizeOptions& options,
                                CharacterizeWorkspace& workspace, const VerifyOptions& how, std::uint64_t index,
                                const std::shared_ptr<const TemperatureRecord>& temperature) {
  ArraySimulation simulation;
  simulation.rate_hz = log.rate_hz_of(recorded.channel);
  simulation.samples = std::max<std::uint64_t>(recorded.fit->samples, 2);
  simulation.seed = how.seed + (index << 32U);
  simulation.sensors = {{recorded.channel.name, noise_of(recorded, log), {1}}};
  CharacterizeOptions same = options;
  same.data = SampleKind::rate;  // phase and frequency have become rates before the fit
  same.wanted.quality = false;
  same.ten_a_decade = false;  // octaves are compared
  ChannelStage stage(same, workspace, !what_needs_all_samples(same).empty());
  if (recorded.fit->temperature) stage.set_temperature(temperature);
  ArraySimulator simulator(simulation);
  MeansAdded means(*recorded.fit, simulation);
  for (auto columns = simulator.next(kRows); !columns.empty(); columns = simulator.next(kRows))
    stage.push(means.added(columns[0]));
  TimeBase time;
  time.rate_hz = simulation.rate_hz;
  return stage.finish(recorded.channel, time);
}

// The model is the truth of the simulation; but how much of a measured shape's beginning is the
// term's own is as uncertain as the term.
TermVerification compare_term(Term term, const Coefficient& model, const Coefficient& simulated, bool shape_measured,
                              const VerifyOptions& how) {
  TermVerification out{term, model, simulated, true};
  if (model.value && simulated.value && *model.value > 0) {
    // A wide interval is skew: its nearer end is what counts.
    const bool inside = *model.value >= simulated.ci95.low && *model.value <= simulated.ci95.high;
    const double sd = std::hypot(simulated.relative_sd, shape_measured ? model.relative_sd : 0);
    const double z = std::log(*simulated.value / *model.value) / std::max(sd, 1e-12);
    out.agrees = inside || std::abs(z) <= how.term_sd;
  } else if (model.value && simulated.upper95) {
    // Not seen again: no contradiction while the limit reaches the model.
    out.agrees = *simulated.upper95 >= *model.value / 1.5;
  } else if (!model.value && model.upper95 && simulated.value) {
    out.agrees = simulated.ci95.low <= *model.upper95;
  }
  return out;
}

double two_sided_probability(double variance_ratio, double edf1, double edf2) {
  const double low = fisher_cdf(variance_ratio, edf1, edf2);
  const double high = fisher_tail(variance_ratio, edf1, edf2);
  return std::min(1.0, 2 * std::min(low, high));
}

std::vector<PointVerification> compare_points(const AllanCurve& recorded, const AllanCurve& simulated,
                                              const VerifyOptions& how) {
  std::vector<PointVerification> out;
  for (const AllanPoint& r : recorded.points) {
    const auto same = std::find_if(simulated.points.begin(), simulated.points.end(),
                                   [&](const AllanPoint& s) { return std::abs(s.tau_s / r.tau_s - 1) < 1e-6; });
    if (same == simulated.points.end() || !(r.deviation > 0) || !(same->deviation > 0)) continue;
    if (!(r.edf > 0) || !(same->edf > 0)) continue;
    const double ratio = r.deviation / same->deviation;
    out.push_back({r.tau_s, ratio, two_sided_probability(ratio * ratio, r.edf, same->edf), true});
  }
  for (PointVerification& point : out) {
    const bool small = std::abs(std::log(point.ratio)) <= std::log1p(how.small_difference);
    point.agrees = small || point.p >= how.point_probability / static_cast<double>(out.size());
  }
  return out;
}

std::string term_sentence(const TermVerification& t, const std::string& name) {
  const std::string found =
      t.simulated.value ? coefficient_text(t.simulated) : "no " + name + ", " + value_text(t.simulated);
  return fmt::format("{}: the model says {}, the simulated record gives {}", name, value_text(t.model), found);
}

// The worst of a stretch of neighbouring averaging times that disagree.
std::vector<std::string> point_sentences(const std::vector<PointVerification>& points) {
  std::vector<std::string> out;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].agrees) continue;
    std::size_t end = i;
    double worst = points[i].ratio;
    for (; end < points.size() && !points[end].agrees; ++end)
      if (std::abs(std::log(points[end].ratio)) > std::abs(std::log(worst))) worst = points[end].ratio;
    const std::string where = end == i + 1 ? "at τ = " + duration_text(points[i].tau_s)
                                           : fmt::format("from τ = {} to {}", duration_text(points[i].tau_s),
                                                         duration_text(points[end - 1].tau_s));
    out.push_back(fmt::format(
        "{} the recording's Allan deviation is {} % {} than the simulated one: the model does not hold there", where,
        number_text(100 * std::abs(worst - 1), 2), worst > 1 ? "higher" : "lower"));
    i = end;
  }
  return out;
}

bool has_process(const NoiseFit& fit) { return fit.gauss_markov && fit.gauss_markov->in_model; }

// Of a Gauss-Markov process: empty when model and simulation agree. Where the simulated record does without it (or asks
// for one that the model has not), its flicker and walk stand for the same slow noise, and the curves alone compare it.
std::string process_disagreement(const NoiseFit& model, const NoiseFit& simulated, const VerifyOptions& how) {
  if (!has_process(model) || !has_process(simulated)) return "";
  const auto differs = [&how](const Coefficient& a, const Coefficient& b) {
    const bool inside = *a.value >= b.ci95.low && *a.value <= b.ci95.high;
    return !inside && std::abs(std::log(*b.value / *a.value)) > how.term_sd * std::max(b.relative_sd, 1e-12);
  };
  const GaussMarkovFit &a = *model.gauss_markov, &b = *simulated.gauss_markov;
  if (!differs(a.sigma, b.sigma) && !differs(a.tau_s, b.tau_s)) return "";
  return fmt::format("Gauss–Markov process: the model says σ = {}, τ = {}, the simulated record gives σ = {}, τ = {}",
                     value_text(a.sigma), duration_text(*a.tau_s.value), value_text(b.sigma),
                     duration_text(*b.tau_s.value));
}

bool compares(Term term, const NoiseFit& model, const NoiseFit& simulated) {
  const auto known = [term](const NoiseFit& fit) { return fit[term].value || fit[term].upper95; };
  const bool slow = term == Term::flicker || term == Term::walk;
  return known(model) && known(simulated) && (!slow || has_process(model) == has_process(simulated));
}

bool nearly(const ChannelVerification& v, const VerifyOptions& how) {
  return std::all_of(v.terms.begin(), v.terms.end(), [](const auto& t) { return t.agrees; }) &&
         std::all_of(v.points.begin(), v.points.end(), [&how](const PointVerification& p) {
           return p.agrees || std::abs(std::log(p.ratio)) <= std::log1p(how.tolerable);
         });
}

ChannelVerification compared(const ChannelResult& recorded, ChannelResult simulated, const VerifyOptions& how) {
  ChannelVerification out;
  out.points = compare_points(recorded.allan, simulated.allan, how);
  std::vector<std::string> disagreements = point_sentences(out.points);
  for (std::size_t t = 0; simulated.fit && t < kTerms; ++t) {
    const Coefficient& model = recorded.fit->term[t];
    if (!compares(static_cast<Term>(t), *recorded.fit, *simulated.fit)) continue;
    out.terms.push_back(compare_term(static_cast<Term>(t), model, simulated.fit->term[t],
                                     recorded.fit->shape.kind == NoiseShape::Kind::measured, how));
    if (!out.terms.back().agrees)
      disagreements.push_back(term_sentence(out.terms.back(), std::string(term_title(static_cast<Term>(t)))));
  }
  if (simulated.fit) {
    std::string sentence = process_disagreement(*recorded.fit, *simulated.fit, how);
    if (!sentence.empty()) disagreements.push_back(std::move(sentence));
  }
  out.agrees = disagreements.empty() && simulated.fit.has_value();
  out.nearly = out.agrees || (simulated.fit && nearly(out, how));

  const auto good =
      std::count_if(out.points.begin(), out.points.end(), [](const PointVerification& p) { return p.agrees; });
  out.sentences.push_back(
      fmt::format("A sensor simulated from this model {} the recording: {} of {} averaging times and {} of {} "
                  "coefficients are alike.",
                  out.agrees ? "agrees with" : "does not agree with", good, out.points.size(),
                  std::count_if(out.terms.begin(), out.terms.end(), [](const TermVerification& t) { return t.agrees; }),
                  out.terms.size()));
  if (recorded.fit->term[0].status == Status::misfit && out.agrees)
    out.sentences.front() += " That does not prove its coefficients, which are a misfit.";
  if (!disagreements.empty() && !recorded.lines.empty())
    disagreements.push_back(
        recorded.lines.size() == 1
            ? "The model does not hold the recording's spectral line."
            : fmt::format("The model holds none of the {} spectral lines of the recording.", recorded.lines.size()));
  if (!disagreements.empty())
    if (const Remedy* spikes = find_remedy(*recorded.fit, "spikes"))
      disagreements.push_back(fmt::format("The recording's curve holds {} that {} left out of the fit.",
                                          spikes->count == 1 ? "a spike" : fmt::format("{} spikes", spikes->count),
                                          spikes->count == 1 ? "was" : "were"));
  for (std::string& sentence : disagreements) out.sentences.push_back(std::move(sentence));
  out.allan = std::move(simulated.allan);
  out.spectrum = std::move(simulated.spectrum);
  out.fit = std::move(simulated.fit);
  return out;
}

}  // namespace

bool verify(Characterization& recorded, const CharacterizeOptions& options, const VerifyOptions& how,
            Progress& progress) {
  CharacterizeWorkspace workspace;
  auto& channels = recorded.channels;
  const std::size_t group = 2;  // as in characterize: memory stays bounded however many channels there are
  for (std::size_t first = 0; first < channels.size(); first += group) {
    progress.update(static_cast<double>(first) / static_cast<double>(channels.size()), "simulating");
    const std::size_t last = std::min(channels.size(), first + group);
    parallel::for_each(first, last, [&](std::size_t c) {
      ChannelResult& channel = channels[c];
      if (!channel.fit) return;
      channel.verification = std::make_shared<ChannelVerification>(compared(
          channel, simulated_channel(channel, recorded.log, options, workspace, how, c, recorded.temperature), how));
    });
  }
  return std::all_of(channels.begin(), channels.end(), [](const ChannelResult& channel) {
    return !channel.verification || channel.verification->agrees;
  });
}

}  // namespace libchar
