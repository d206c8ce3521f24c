#include "libchar/characterize/detail/summary.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/units.hpp"
#include "libchar/fit/curve/power_laws.hpp"

namespace libchar {
namespace {

std::string term_phrase(const std::string& name, const ShownValue& shown, Status status) {
  const char* doubt = status == Status::undetermined ? ", undetermined" : "";
  return shown.low.empty()
             ? fmt::format("{} not seen ({}{})", name, said(shown), doubt)
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
    say(fmt::format("{} h_{}", law.name, law.alpha), shown_value(law.h, 1, ""), law.h);
  for (std::size_t t = laws.empty() ? 0 : static_cast<std::size_t>(Term::ramp); t < kTerms; ++t) {
    const TermCells cells = term_cells(fit.term[t], static_cast<Term>(t), unit, !laws.empty());
    say(cells.title + " " + cells.letter, headline(cells), fit.term[t]);
  }
  // Without it, "not seen" of flicker and walk would read as no slow noise at all.
  if (fit.gauss_markov && fit.gauss_markov->in_model && fit.gauss_markov->sigma.value) {
    const std::string symbol = shown_unit(unit);
    parts.push_back(fmt::format("a Gauss–Markov process of {}{}{} with a correlation time of {}",
                                value_text(fit.gauss_markov->sigma),
                                symbol.empty() ? "" : " ",
                                symbol,
                                duration_text(*fit.gauss_markov->tau_s.value)));
  }
  return parts.empty() ? "No noise term was found" : fmt::format("{}", fmt::join(parts, ", "));
}

// Where the terms hold, when that is not everywhere, and what the sensor does beside its noise.
std::string beside_phrase(const NoiseFit& fit) {
  const std::string temperature = fit.temperature && fit.temperature->order > 0
                                      ? " Its dependence on temperature was taken out."
                                      : "";
  if (fit.band.whole || !(fit.rate_hz > 0) || fit.band.top_hz >= 0.499 * fit.rate_hz)
    return temperature;
  return fmt::format(" They hold below {} Hz.", brief_text(fit.band.top_hz)) + temperature;
}

constexpr std::size_t kMostSpoils = 4;

std::string spoils_phrase(const Judgement& judgement) {
  std::vector<std::string> told;
  std::size_t more = 0;
  for (const Finding& one : judgement.findings)
    if (one.severity != Severity::note)
      told.size() < kMostSpoils ? told.push_back(one.phrase) : void(++more);
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

std::string summary_sentence(const ChannelResult& channel,
                             const Judgement& judgement,
                             const std::string& unit) {
  if (!channel.fit) return begun(spoils_phrase(judgement));
  const std::string terms = begun(terms_of(*channel.fit, unit)) + "." + beside_phrase(*channel.fit);
  if (judgement.rating == Rating::good) return terms;
  return terms + (judgement.rating == Rating::bad ? " Do not rely on them: " : " But: ") +
         spoils_phrase(judgement);
}

}  // namespace libchar
