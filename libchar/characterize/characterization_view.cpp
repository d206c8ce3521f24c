#include "libchar/characterize/characterization_view.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/allan/deviation_types.hpp"
#include "libchar/allan/noise_curves.hpp"
#include "libchar/characterize/compare/verification.hpp"
#include "libchar/characterize/judgement.hpp"
#include "libchar/characterize/limits.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/units.hpp"
#include "libchar/fit/curve/shaped_curves.hpp"
#include "libchar/fit/signs/rounding.hpp"
#include "libchar/spectrum/spectrum.hpp"

namespace libchar {
namespace {

ModelCurve allan_model(const NoiseFit& fit, const AllanCurve& curve) {
  ModelCurve out;
  for (const AllanPoint& p : curve.points) {
    const auto m = static_cast<double>(p.m);
    out.values.push_back(model_deviation(fit, curve.type, m, curve.dt_s));
    out.intervals.push_back(model_interval(fit, curve.type, m, curve.dt_s));
  }
  out.asymptotes = allan_asymptotes(fit, curve);
  return out;
}

ModelCurve spectrum_model(const NoiseFit& fit, const Spectrum& spectrum) {
  ModelCurve out;
  for (const double f : spectrum.frequency_hz) out.values.push_back(model_spectrum(fit, spectrum, f));
  out.asymptotes = spectrum_asymptotes(fit, spectrum);
  return out;
}

std::vector<OtherOpinion> other_opinions(const NoiseFit& fit) {
  std::vector<OtherOpinion> out;
  if (!fit.second_opinion) return out;
  for (std::size_t t = 0; t < kTerms; ++t) {
    const auto& value = fit.second_opinion->value[t];
    if (!value) continue;
    const Coefficient& first = fit.term[t];
    OtherOpinion other{static_cast<Term>(t), *value, fit.second_opinion->sd[t], {}};
    const double sd = first.value ? std::hypot(other.sd, *first.value * first.relative_sd) : 0;
    if (first.value && sd > 0) other.apart = (*value - *first.value) / sd;
    out.push_back(other);
  }
  return out;
}

// A curve of zeros (constant data) has no place on a logarithmic axis; its table says it.
bool stands_on_log_axes(const AllanCurve& curve) {
  return std::any_of(curve.points.begin(), curve.points.end(), [](const AllanPoint& p) { return p.deviation > 0; });
}

bool stands_on_log_axes(const Spectrum& s) {
  for (std::size_t i = 0; i < s.value.size(); ++i)
    if (s.frequency_hz[i] > 0 && s.value[i] > 0) return true;
  return false;
}

void add_fit(ChannelView& view, const ChannelResult& channel, double rate_hz) {
  const NoiseFit& fit = *channel.fit;
  view.findings = findings(fit, view.unit);
  view.beside_terms = findings_beside_terms(fit, view.unit);
  view.goodness = goodness_sentence(fit.goodness);
  if (const Coefficient& white = fit[Term::white]; white.value) {
    view.per_sample_sd = *white.value * std::sqrt(rate_hz);
    view.noise_density_one_sided = *white.value * std::sqrt(2.0);
  }
  view.read_off = read_off_points(fit, channel.allan);
  view.allan_model = allan_model(fit, channel.allan);
  view.spectrum_model = spectrum_model(fit, channel.spectrum);
  view.other_opinions = other_opinions(fit);
  view.plain_from_s = plain_from_s(fit, channel.allan);
  if (rate_hz > 0) view.consumers = consumer_numbers(detail::terms_with_rounding(fit), view.unit, rate_hz);
}

TraceMark mark_of(const Event& event, double duration_s, const std::string& unit) {
  const std::string name(event_name(event.kind)), symbol = unit.empty() ? "" : " " + unit;
  TraceMark mark{name, event.at_s, event.at_s, fmt::format("{} {}{}", name, number_text(event.size, 2), symbol)};
  if (event.kind == EventKind::warm_up) {
    mark.from_s = event.from_s;
    mark.to_s = std::min(duration_s, event.from_s + 3 * event.tau_s);
    mark.label += ", τ " + duration_text(event.tau_s);
  }
  if (event.kind == EventKind::ramp) mark = {name, 0, duration_s, mark.label};
  return mark;
}

std::vector<TraceMark> trace_marks(const ChannelResult& channel, const std::string& unit) {
  std::vector<TraceMark> out;
  for (const Interval& moving : channel.motion.moving_s) out.push_back({"motion", moving.low, moving.high, "motion"});
  for (const StrengthChange& change : channel.motion.changes)
    if (change.kind == EventKind::step)
      out.push_back({"strength", change.at_s, change.at_s, fmt::format("noise × {}", number_text(change.factor, 3))});
  for (const Finding& one : channel.quality.findings) {
    const char* kind = one.code == "stuck" ? "frozen" : one.code == "interpolated" ? "filled" : "";
    for (std::size_t i = 0; *kind != '\0' && i < one.where.time_s.size(); ++i)
      out.push_back({kind, one.where.time_s[i].low, one.where.time_s[i].high, i == 0 ? kind : ""});
  }
  if (!channel.fit) return out;
  if (const Stationarity& found = channel.fit->stationarity; !found.steady) {
    const auto add = [&](const char* kind, const Interval& at, double times) {
      out.push_back({kind, at.low, at.high, fmt::format("{} (× {})", kind, number_text(times, 3))});
    };
    add("quietest", found.smallest_s, found.smallest);
    add("loudest", found.largest_s, found.largest);
  }
  for (const Event& event : channel.fit->events) out.push_back(mark_of(event, channel.fit->duration_s, unit));
  return out;
}

std::vector<ChannelGroup> groups_of(const std::vector<ChannelView>& channels) {
  std::vector<ChannelGroup> out;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const std::string& unit = channels[i].unit;
    auto group = std::find_if(out.begin(), out.end(), [&](const ChannelGroup& g) { return g.unit == unit; });
    if (group == out.end()) group = out.insert(out.end(), {detail::quantity_title(unit), unit, {}});
    group->channels.push_back(i);
  }
  return out;
}

/// Shared by the channels: they have most degrees of freedom in common.
struct Factors {
  IntervalFactors in68{0.6827}, in95{0.95};
};

ChannelView channel_view(const ChannelResult& channel, double rate_hz, Factors& factors) {
  ChannelView out;
  out.result = &channel;
  out.unit = detail::usual_unit(channel.channel.unit);
  out.shown_unit = shown_unit(out.unit);
  out.trace_unit = shown_unit(detail::usual_unit(channel.trace_unit));
  out.judgement = judge(channel);
  out.summary = detail::summary_sentence(channel, out.judgement, out.unit);
  out.marks = trace_marks(channel, out.shown_unit);
  for (const Finding& one : out.judgement.findings)
    if (one.severity != Severity::note) out.cautions.push_back(one.sentence);
  out.allan_minimum = allan_minimum(channel.allan);
  out.draws_allan = stands_on_log_axes(channel.allan);
  out.draws_spectrum = stands_on_log_axes(channel.spectrum);
  out.spectrum_ci68 = spectrum_intervals(channel.spectrum, factors.in68);
  out.spectrum_ci95 = spectrum_intervals(channel.spectrum, factors.in95);
  if (channel.verification) out.verification_ci95 = spectrum_intervals(channel.verification->spectrum, factors.in95);
  if (channel.fit) add_fit(out, channel, rate_hz);
  return out;
}

// Of the terms that have a limit; no limit is no noise.
std::vector<std::optional<double>> data_sheet_curve(const ChannelResult& channel, const LimitReport& limits) {
  Mixture theta{};
  bool any = false;
  for (const LimitJudgement& j : limits.judgements) {
    if (j.channel != channel.channel.name) continue;
    theta[static_cast<std::size_t>(j.term)] = j.most * j.most;
    any = true;
  }
  std::vector<std::optional<double>> out;
  if (!any || !deviation_row(channel.allan.type).is_allan()) return out;
  for (const AllanPoint& p : channel.allan.points) {
    const double variance = allan_variance(theta, static_cast<double>(p.m), channel.allan.dt_s);
    out.push_back(variance > 0 ? std::optional(std::sqrt(variance)) : std::nullopt);
  }
  return out;
}

void choose_details(std::vector<ChannelView>& channels) {
  if (channels.size() <= kMostInDetail) return;
  std::vector<ChannelView*> worst_first;
  worst_first.reserve(channels.size());
  for (ChannelView& channel : channels) worst_first.push_back(&channel);
  std::stable_sort(worst_first.begin(), worst_first.end(), [](const ChannelView* a, const ChannelView* b) {
    return a->judgement.rating > b->judgement.rating;
  });
  for (std::size_t k = kMostInDetail; k < worst_first.size(); ++k) worst_first[k]->in_detail = false;
}

}  // namespace

std::string detail::quantity_title(const std::string& unit) {
  const auto known = find_unit(unit);
  if (!known) return "";
  switch (known->quantity) {
    case Quantity::angular_rate:
      return "Angular rate";
    case Quantity::acceleration:
      return "Acceleration";
    case Quantity::magnetic_field:
      return "Magnetic field";
    case Quantity::pressure:
      return "Pressure";
    case Quantity::temperature:
      return "Temperature";
    case Quantity::voltage:
      return "Voltage";
    case Quantity::angle:
      return "Angle";
    case Quantity::time:
      return "Time";
    case Quantity::frequency:
      return "Frequency";
    case Quantity::concentration:
      return "Concentration";
    case Quantity::ratio:
      return "Ratio";
  }
  return "";
}

CharacterizationView characterization_view(const Characterization& result) {
  CharacterizationView out;
  out.result = &result;
  const double rate_hz = result.log.time.rate_hz;
  if (rate_hz > 0) out.duration_s = static_cast<double>(result.log.samples) / rate_hz;
  Factors factors;
  for (const ChannelResult& channel : result.channels) {
    out.channels.push_back(channel_view(channel, result.log.rate_hz_of(channel.channel), factors));
    if (result.limits) out.channels.back().data_sheet = data_sheet_curve(channel, *result.limits);
  }
  std::vector<Judgement> judged;
  for (const ChannelView& channel : out.channels) {
    judged.push_back(channel.judgement);
    out.rating = std::max(out.rating, channel.judgement.rating);
  }
  out.verdict = verdict_of(result, judged);
  choose_details(out.channels);
  out.groups = groups_of(out.channels);
  return out;
}

}  // namespace libchar
