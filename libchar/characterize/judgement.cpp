// What a rating says follows from statuses and tests that stand with the fit: no threshold of a test is decided here.

#include "libchar/characterize/judgement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "libchar/characterize/compare/verification.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/fit/remedies.hpp"

namespace libchar {
namespace {

// "a step", "3 steps": with what a sentence says of several kinds joined.
std::string counted(std::size_t count, const std::string& name, const char* many = "s") {
  if (count == 1) return "a " + name;
  return fmt::format("{} {}{}", count, name, many);
}

std::string joined(const std::vector<std::string>& parts) {
  std::string out;
  for (std::size_t i = 0; i < parts.size(); ++i)
    out += std::string(i == 0 ? "" : i + 1 == parts.size() ? " and " : ", ") + parts[i];
  return out;
}

std::string letters_with(const NoiseFit& fit, Status status) {
  std::vector<std::string> letters;
  for (std::size_t t = 0; t < kTerms; ++t)
    if (fit.term[t].status == status) letters.emplace_back(kTermNames[t].letter);
  return joined(letters);
}

std::string events_taken_out(const NoiseFit& fit) {
  std::vector<std::string> parts;
  std::size_t all = 0;
  for (const EventKind kind : {EventKind::step, EventKind::warm_up, EventKind::ramp}) {
    const auto count = static_cast<std::size_t>(
        std::count_if(fit.events.begin(), fit.events.end(), [&](const Event& e) { return e.kind == kind; }));
    if (count > 0) parts.push_back(counted(count, std::string(event_name(kind))));
    all += count;
  }
  return joined(parts) + (all == 1 ? " was taken out" : " were taken out");
}

/// So few spikes are repaired without a trace in the coefficients.
constexpr double kManySpikes = 0.001;
/// Fewer missing samples cost nothing worth mentioning: terms that touch them are left out, and N keeps its interval.
constexpr double kMostMissing = 0.1;

double share_of(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

/// A step has one large difference, which its event explains.
bool has_step(const NoiseFit& fit) {
  return std::any_of(fit.events.begin(), fit.events.end(), [](const Event& e) { return e.kind == EventKind::step; });
}

struct Judge {
  const ChannelResult& channel;
  std::vector<Finding> out;

  void add(std::string_view code, std::string sentence, std::string phrase = "") {
    out.push_back(finding(code, std::move(sentence), std::move(phrase)));
  }
  void add_all(const std::vector<Finding>& found) { out.insert(out.end(), found.begin(), found.end()); }

  void look_at_goodness(const NoiseFit& fit) {
    const bool said =
        has(fit.findings, "misfit") || has(fit.findings, "digital_misfit") || has(fit.findings, "power_law");
    if (!detail::is_described(fit) && !said)
      add("misfit", "The noise terms do not describe the recording: the data support no coefficient.",
          "the noise terms do not describe the recording");
    if (!fit.search.converged) add("not_converged", "The fit did not converge.");
  }

  void look_at_terms(const NoiseFit& fit) {
    if (const std::string letters = letters_with(fit, Status::undetermined);
        !letters.empty() && !has(fit.findings, "undetermined")) {
      add("undetermined",
          fmt::format("Undetermined: {}. Another term could explain the same part of the recording, or the Allan curve "
                      "contradicts it.",
                      letters),
          letters + " undetermined: not distinguished from another term, or contradicted by the Allan curve");
      if (fit[Term::white].status == Status::undetermined) out.back().severity = Severity::caution;
    }
    for (std::size_t t = 0; t < kTerms; ++t)
      if (detail::reaches_zero(fit.term[t]))
        add("reaches_zero", fmt::format("{} is uncertain: its interval includes 0.", kTermNames[t].letter));
    constexpr double kWithin = 10;  // from one end of the interval to the other
    const auto is_known = [](const Coefficient& term) {
      return term.status == Status::detected && term.value && !detail::reaches_zero(term) &&
             term.ci95.high < kWithin * term.ci95.low;
    };
    if (std::none_of(fit.term.begin(), fit.term.end(), is_known) && fit[Term::white].status != Status::undetermined)
      add("nothing_detected", "No noise term is resolved: each is not detected, or its interval spans a decade.",
          "no noise term is resolved");
  }

  void look_at_remedies(const NoiseFit& fit) {
    const std::uint64_t samples = std::max<std::uint64_t>(1, fit.samples);
    if (const Remedy* spikes = find_remedy(fit, "spikes")) {
      add("spikes_left_out", fmt::format("Spikes: {}.", spikes->action), "spikes were left out");
      out.back().count = spikes->count;
      if (share_of(spikes->count, samples) > kManySpikes) out.back().severity = Severity::caution;
    }
  }

  /// The spectrum knows where they are, and how strong.
  Finding with_places(Finding lines) const {
    const SpectralLine* strongest = nullptr;
    for (const SpectralLine& line : channel.lines) {
      lines.where.frequency_hz.push_back(
          {line.frequency_hz - line.width_hz / 2, line.frequency_hz + line.width_hz / 2});
      if (strongest == nullptr || line.amplitude > strongest->amplitude) strongest = &line;
    }
    if (strongest != nullptr)
      lines.sentence +=
          fmt::format(" The strongest is at {}, amplitude {}{}.", detail::frequency_text(strongest->frequency_hz),
                      brief_text(strongest->amplitude), channel.channel.unit.empty() ? "" : " " + channel.channel.unit);
    return lines;
  }

  // Eight steps are one finding with eight places.
  void look_at_events(const NoiseFit& fit) {
    if (fit.events.empty()) return;
    Finding all = finding("event", "", events_taken_out(fit));
    all.count = fit.events.size();
    for (const Finding& one : fit.findings) {
      if (one.code != all.code) continue;
      all.sentence += (all.sentence.empty() ? "" : " ") + one.sentence;
      all.where.time_s.insert(all.where.time_s.end(), one.where.time_s.begin(), one.where.time_s.end());
    }
    out.push_back(std::move(all));
  }

  void look_at_fit(const NoiseFit& fit) {
    look_at_goodness(fit);
    look_at_terms(fit);
    look_at_remedies(fit);
    look_at_events(fit);
    for (const Finding& one : fit.findings)
      if (one.code != "event") out.push_back(one.code == "lines_left_out" ? with_places(one) : one);
    if (fit.second_opinion && !fit.second_opinion->agrees)
      add("allan_disagrees", "The Allan fit disagrees: " + fit.second_opinion->sentence,
          "the fit of the Allan curve disagrees");
  }

  void look_at_verification(const ChannelVerification& simulated) {
    if (simulated.agrees) return;
    add("simulation_disagrees", simulated.sentences.front(),
        simulated.nearly ? "a simulation of the model differs by a few per cent"
                         : "a simulation of the model does not agree");
    if (!simulated.nearly) out.back().severity = Severity::bad;
  }

  void look_at_samples(const ChannelQuality& q) {
    add_all(q.findings);
    const bool cut = has(q.findings, "saturated") || has(q.findings, "much_saturated");
    for (const Finding& one : channel.findings)
      if (!cut || one.code != "rail") out.push_back(one);
    const double share = share_of(q.missing, q.samples + q.missing);
    if (!(share > kMostMissing)) return;
    add("missing_samples", fmt::format("{} samples ({}) are missing.", count_text(q.missing), percent_text(share)),
        percent_text(share) + " of the samples are missing");
    out.back().count = q.missing;
  }
};

/// What is recorded is no noise: the channel is of no use, and that it has no fit and no curve needs no saying.
void drop_what_follows(std::vector<Finding>& found) {
  for (const char* cause : {"no_value", "constant", "counter", "moves_throughout"}) {
    const auto one =
        std::find_if(found.begin(), found.end(), [&](const Finding& finding) { return finding.code == cause; });
    if (one == found.end()) continue;
    one->severity = Severity::bad;
    std::erase_if(found, [](const Finding& other) {
      return other.code == "no_fit" || other.code == "not_computed" || other.code == "missing_samples";
    });
    return;
  }
}

}  // namespace

std::string_view rating_word(Rating rating) {
  return rating == Rating::good ? "good" : rating == Rating::caution ? "caution" : "do not use";
}

Tint tint_of(Rating rating) {
  return rating == Rating::good ? Tint::good : rating == Rating::caution ? Tint::doubtful : Tint::bad;
}

std::vector<Finding> findings_of(const ChannelResult& channel) {
  Judge found{channel, {}};
  found.look_at_samples(channel.quality);  // the rest may follow from them
  if (channel.fit) found.look_at_fit(*channel.fit);
  if (channel.verification) found.look_at_verification(*channel.verification);
  if (!channel.fit) drop_what_follows(found.out);
  // Heavy tails of the differences are the alarm, and these are what it was about.
  for (const char* cause :
       {"spikes_left_out", "spikes_kept", "heavy_tails", "held_values", "staircase", "motion", "moves_throughout"})
    if (has(found.out, cause)) std::erase_if(found.out, [](const Finding& one) { return one.code == "spiky"; });
  if (channel.fit && has_step(*channel.fit))
    std::erase_if(found.out, [](const Finding& one) { return one.code == "spiky"; });
  // The zeros of a held or interpolated value's spectrum lie between humps.
  if (has(found.out, "held_values") || has(found.out, "resampled"))
    std::erase_if(found.out, [](const Finding& one) { return one.code == "resonance"; });
  // Marks are far from all samples: they look like movement, and what moves is seen without them.
  if (has(found.out, "missing_mark"))
    std::erase_if(found.out, [](const Finding& one) {
      return one.code == "motion" || one.code == "moves_throughout" || one.code == "spiky" ||
             one.code == "strength_change";
    });
  // That the terms do not describe what moved follows from it.
  if (std::any_of(found.out.begin(), found.out.end(), [](const Finding& one) {
        return one.severity == Severity::bad && (one.code == "motion" || one.code == "moves_throughout");
      }))
    std::erase_if(found.out, [](const Finding& one) {
      return one.code == "misfit" || one.code == "nothing_detected" || one.code == "contradicted" ||
             one.code == "undetermined" || one.code == "white_or_flicker" || one.code == "flicker_or_walk";
    });
  // So are the ends of a range that the samples wrap at: they are no spikes, steps or levels.
  if (has(found.out, "phase_wraps"))
    std::erase_if(found.out, [](const Finding& one) {
      return one.code == "spiky" || one.code == "spikes_left_out" || one.code == "spikes_kept" || one.code == "event" ||
             one.code == "events_left_in" || one.code == "strength_change" || one.code == "not_stationary";
    });
  return worst_first(std::move(found.out));
}

void detail::add_findings_of(const Findings& recording, std::vector<Finding>& findings) {
  for (const Finding& one : recording.list())
    if (!one.effects.empty()) findings.push_back(one);
}

bool detail::is_described(const NoiseFit& fit) {
  constexpr double kMisfit = 1e-3;  // of residuals so large once in a thousand recordings
  return letters_with(fit, Status::misfit).empty() && !(fit.goodness.p < kMisfit);
}

std::vector<Finding> detail::findings_of_curve(ChannelResult channel) {
  Judge of_fit{channel, {}};
  if (channel.fit) of_fit.look_at_fit(*channel.fit);
  channel.fit.reset();
  std::vector<Finding> out = findings_of(channel);
  constexpr std::string_view kInCurve[] = {"not_stationary", "event",     "events_left_in", "cycle",
                                           "hump",           "resonance", "lines_left_out"};
  for (Finding& one : of_fit.out)
    if (std::find(std::begin(kInCurve), std::end(kInCurve), one.code) != std::end(kInCurve))
      out.push_back(std::move(one));
  return worst_first(std::move(out));
}

Judgement judge(const ChannelResult& channel) {
  std::vector<Finding> found = findings_of(channel);
  if (!channel.fit && worst_of(found) != Severity::bad)
    found.push_back(finding("no_fit", found.empty() ? "No noise coefficients were computed."
                                                    : "No noise coefficients: " + as_part(found[0].sentence) + "."));
  const Severity worst = worst_of(found);
  const Rating rating = worst == Severity::bad       ? Rating::bad
                        : worst == Severity::caution ? Rating::caution
                                                     : Rating::good;
  return {rating, worst_first(std::move(found))};
}

std::string goodness_sentence(const Goodness& g) {
  constexpr double kDoubtful = 1e-3;  // of residuals so large once in a thousand recordings
  if (!(g.dof > 0)) return "The fit has no degrees of freedom left to be checked with.";
  const std::string figures = fmt::format("χ² = {} for {} degrees of freedom, {}", brief_text(g.chi2, 4),
                                          brief_text(g.dof, 4), probability_text(g.p));
  if (g.p >= 0.01) return "The model explains the spectrum within its scatter (" + figures + ").";
  if (g.p >= kDoubtful) return "The model explains the spectrum barely (" + figures + ").";
  return "The model does not explain the spectrum (" + figures + "): look at the residuals before using the intervals.";
}

}  // namespace libchar
