#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "libchar/characterize/judgement.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/units.hpp"
#include "libchar/fit/curve/power_laws.hpp"

namespace libchar {
namespace {

std::string finding(const NoiseFit& fit, Term term, const std::string& unit) {
  const Coefficient& c = fit[term];
  const bool clock = fit.flicker_phase.has_value();
  const TermCells cells = term_cells(c, term, unit, clock);
  const std::string name = clock ? cells.title : cells.title + " " + cells.letter;
  const std::string value = said(cells.own) + (cells.field.empty() ? "" : " (" + said(cells.field.front()) + ")");
  switch (c.status) {
    case Status::detected:
      return fmt::format("{} = {}, known to {}.", name, value, percent_text(c.relative_sd));
    case Status::undetermined:
      return fmt::format("{} = {}, but undetermined: the record cannot tell it from another term, or contradicts it.",
                         name, value);
    case Status::misfit:
      return fmt::format("{} = {}, but the noise terms do not describe the recording.", name, value);
    case Status::not_detected:
      return fmt::format("{} not detected, {} (95 %).", name, value);
    case Status::given:
      return fmt::format("{} = {}, given.", name, value);
    case Status::not_fitted:
      return "";
  }
  return "";
}

/// Reasons that the headline says in a sentence of their own, with the channels that have one of them.
struct HeadlineRow {
  const char *code, *or_code;
  const char* before;
  const char* behind;
};
constexpr HeadlineRow kHeadline[] = {
    {"misfit", "misfit", " It does not explain ", ": see the residuals there before using the intervals."},
    {"allan_disagrees", "allan_disagrees", " The Allan fit disagrees with the spectral fit on ", "."},
    {"simulation_disagrees", "simulation_disagrees", " A simulation of the model does not agree with ", "."},
    {"no_fit", "no_fit", " No fit was possible for ", "."},
    {"undetermined", "misfit", " Coefficients of ", " are doubtful."}};

/// The first finding that no sentence of the headline says; null: none.
const Finding* unsaid(const Judgement& judgement, Severity severity) {
  for (const Finding& one : judgement.findings)
    if (one.severity == severity &&
        std::none_of(std::begin(kHeadline), std::end(kHeadline),
                     [&](const HeadlineRow& row) { return one.code == row.code || one.code == row.or_code; }))
      return &one;
  return nullptr;
}

// "The noise model explains both channels within their scatter, and the Allan fits agree."
std::string explained_sentence(const Characterization& result, const std::vector<Judgement>& judged) {
  const std::size_t n = judged.size();
  const auto is_explained = [](const ChannelResult& c) { return c.fit && detail::is_described(*c.fit); };
  const auto good =
      static_cast<std::size_t>(std::count_if(result.channels.begin(), result.channels.end(), is_explained));
  if (good == 0 && n == 1) return "The noise model does not explain the channel.";
  if (good < n) return fmt::format("The noise model explains {} of {} channels within their scatter.", good, n);
  const auto opinions =
      static_cast<std::size_t>(std::count_if(result.channels.begin(), result.channels.end(),
                                             [](const ChannelResult& c) { return c.fit && c.fit->second_opinion; }));
  const std::string out = n == 1 ? "The noise model explains the channel within its scatter"
                                 : fmt::format("The noise model explains {} within their scatter",
                                               n == 2 ? "both channels" : fmt::format("all {} channels", n));
  const bool agree =
      std::none_of(judged.begin(), judged.end(), [](const Judgement& j) { return j.has("allan_disagrees"); });
  if (opinions == 0 || !agree) return out + ".";
  if (opinions == n) return out + (n == 1 ? ", and the Allan fit agrees." : ", and the Allan fits agree.");
  return out + fmt::format(", and the Allan fits, where they are made ({} of {}), agree.", opinions, n);
}

// What else speaks against channels: the objection of one, the names of several.
std::string unsaid_sentence(const Characterization& result, const std::vector<Judgement>& judged, Rating rating) {
  std::vector<std::string> names;
  std::string phrase;
  bool one_reason = true;
  for (std::size_t c = 0; c < judged.size(); ++c) {
    if (judged[c].rating != rating) continue;  // what is not to be used is not used with caution
    const Severity severity = rating == Rating::bad ? Severity::bad : Severity::caution;
    if (const Finding* one = unsaid(judged[c], severity)) {
      names.push_back(result.channels[c].channel.name);
      one_reason = one_reason && (names.size() == 1 || phrase == one->phrase);
      phrase = one->phrase;
    }
  }
  if (names.empty()) return "";
  return fmt::format(" {} {}{}: {}.", rating == Rating::bad ? "Do not use" : "Use",
                     judged.size() == 1 ? "it" : first_names(names), rating == Rating::bad ? "" : " with caution",
                     one_reason ? phrase : "see the notes on them");
}

}  // namespace

std::vector<std::string> findings(const NoiseFit& fit, const std::string& unit) {
  std::vector<std::string> out;
  for (std::size_t t = 0; t < kTerms; ++t) {
    std::string sentence = finding(fit, static_cast<Term>(t), unit);
    if (!sentence.empty()) out.push_back(std::move(sentence));
  }
  for (std::string& sentence : findings_beside_terms(fit, unit)) out.push_back(std::move(sentence));
  return out;
}

std::vector<std::string> findings_beside_terms(const NoiseFit& fit, const std::string& unit) {
  std::vector<std::string> out;
  if (fit.gauss_markov && fit.gauss_markov->in_model)
    out.push_back(fmt::format(
        "Gauss–Markov process: standard deviation σ = {} {}, correlation time τ = {}{}.",
        value_text(fit.gauss_markov->sigma), unit.empty() ? "U" : unit, duration_text(*fit.gauss_markov->tau_s.value),
        fit.gauss_markov->sigma.status == Status::detected
            ? fmt::format(", known to {} and {}", percent_text(fit.gauss_markov->sigma.relative_sd),
                          percent_text(fit.gauss_markov->tau_s.relative_sd))
            : ", but the record contradicts it or the terms do not describe it"));
  if (fit.temperature && fit.temperature->order > 0) out.push_back(temperature_sentence(*fit.temperature, unit));
  if (fit.bandwidth_hz) {
    out.push_back(
        fmt::format("A first-order low-pass at {} colours the short averaging times; it is part of the model.",
                    detail::frequency_text(*fit.bandwidth_hz)));
  }
  return out;
}

std::string verdict_of(const Characterization& result, const std::vector<Judgement>& judged) {
  if (judged.empty()) return "The recording holds no channel to characterize.";
  std::string out = explained_sentence(result, judged);
  for (const HeadlineRow& row : kHeadline) {
    std::vector<std::string> names;
    for (std::size_t c = 0; c < judged.size(); ++c)
      if (judged[c].has(row.code) || judged[c].has(row.or_code)) names.push_back(result.channels[c].channel.name);
    if (!names.empty()) out += row.before + first_names(names) + row.behind;
  }
  for (const Rating rating : {Rating::bad, Rating::caution}) out += unsaid_sentence(result, judged, rating);
  if (result.still) out += " " + result.still->sentence;
  return out;
}

std::string verdict_of(const Characterization& result) {
  std::vector<Judgement> judged;
  for (const ChannelResult& channel : result.channels) judged.push_back(judge(channel));
  return verdict_of(result, judged);
}

namespace {

std::string term_phrase(const std::string& name, const ShownValue& shown, Status status) {
  const char* doubt = status == Status::undetermined ? ", undetermined" : "";
  return shown.low.empty() ? fmt::format("{} not detected ({}{})", name, said(shown), doubt)
                           : fmt::format("{} {} {}{}", name, said(shown), interval_brackets(shown), doubt);
}

std::string terms_of(const NoiseFit& fit, const std::string& unit) {
  std::vector<std::string> parts;
  const auto say = [&](const std::string& name, const ShownValue& shown, const Coefficient& c) {
    if (!c.value && !c.upper95) return;
    const std::string phrase = term_phrase(name, shown, c.status);
    parts.push_back(parts.empty() ? phrase : as_part(phrase));
  };
  const std::vector<PowerLaw> laws = power_laws(fit);
  for (const PowerLaw& law : laws)
    say(fmt::format("{} h_{}", law.name, law.alpha), shown_value(law.h, 1, detail::power_law_unit(law.alpha, unit)),
        law.h);
  for (std::size_t t = laws.empty() ? 0 : static_cast<std::size_t>(Term::ramp); t < kTerms; ++t) {
    const TermCells cells = term_cells(fit.term[t], static_cast<Term>(t), unit, !laws.empty());
    say(cells.title + " " + cells.letter, headline(cells), fit.term[t]);
  }
  // Without it, "not detected" of flicker and walk would read as no slow noise at all.
  if (fit.gauss_markov && fit.gauss_markov->in_model && fit.gauss_markov->sigma.value) {
    const std::string symbol = shown_unit(unit);
    parts.push_back(fmt::format("a Gauss–Markov process of {}{}{} with a correlation time of {}",
                                value_text(fit.gauss_markov->sigma), symbol.empty() ? "" : " ", symbol,
                                duration_text(*fit.gauss_markov->tau_s.value)));
  }
  return parts.empty() ? "No noise term was found" : fmt::format("{}", fmt::join(parts, ", "));
}

// Where the terms hold, when that is not everywhere, and what the sensor does beside its noise.
std::string beside_phrase(const NoiseFit& fit) {
  const std::string temperature =
      fit.temperature && fit.temperature->order > 0 ? " Its dependence on temperature was taken out." : "";
  if (fit.band.whole || !(fit.rate_hz > 0) || fit.band.top_hz >= 0.499 * fit.rate_hz) return temperature;
  return fmt::format(" Valid below {}.", detail::frequency_text(fit.band.top_hz)) + temperature;
}

constexpr std::size_t kMostSpoils = 4;

std::string spoils_phrase(const Judgement& judgement) {
  std::vector<std::string> told;
  std::size_t more = 0;
  for (const Finding& one : judgement.findings)
    if (one.severity != Severity::note) told.size() < kMostSpoils ? told.push_back(one.phrase) : void(++more);
  std::string out = fmt::format("{}", fmt::join(told, "; "));
  if (more > 0) out += fmt::format("; and {} more", more);
  return out + ".";
}

/// Of a sentence.
std::string begun(std::string text) {
  if (text[0] >= 'a' && text[0] <= 'z') text[0] = static_cast<char>(text[0] - 'a' + 'A');
  return text;
}

}  // namespace

std::string detail::summary_sentence(const ChannelResult& channel, const Judgement& judgement,
                                     const std::string& unit) {
  if (!channel.fit) return begun(spoils_phrase(judgement));
  const std::string terms = begun(terms_of(*channel.fit, unit)) + "." + beside_phrase(*channel.fit);
  if (judgement.rating == Rating::good) return terms;
  return terms + (judgement.rating == Rating::bad ? " Do not rely on them: " : " But: ") + spoils_phrase(judgement);
}

}  // namespace libchar
