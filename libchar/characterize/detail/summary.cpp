#include "libchar/characterize/detail/summary.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

std::string term_phrase(const TermCells& cells) {
  const ShownValue& shown = headline(cells);
  const std::string name = cells.title + " " + cells.letter;
  const char* doubt = cells.status == Status::undetermined ? ", undetermined" : "";
  return shown.low.empty()
             ? fmt::format("{} not seen ({}{})", name, said(shown), doubt)
             : fmt::format("{} {} {}{}", name, said(shown), interval_brackets(shown), doubt);
}

std::string terms_of(const NoiseFit& fit, const std::string& unit) {
  std::vector<std::string> parts;
  for (std::size_t t = 0; t < kTerms; ++t) {
    if (!fit.term[t].value && !fit.term[t].upper95) continue;
    const std::string phrase = term_phrase(term_cells(fit.term[t], static_cast<Term>(t), unit));
    parts.push_back(parts.empty() ? phrase : as_part(phrase));
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

}  // namespace

std::string summary_sentence(const ChannelResult& channel,
                             const Judgement& judgement,
                             const std::string& unit) {
  if (!channel.fit) {
    std::string out = spoils_phrase(judgement);
    if (out[0] >= 'a' && out[0] <= 'z') out[0] = static_cast<char>(out[0] - 'a' + 'A');
    return out;
  }
  const std::string terms = terms_of(*channel.fit, unit) + "." + beside_phrase(*channel.fit);
  if (judgement.rating == Rating::good) return terms;
  return terms + (judgement.rating == Rating::bad ? " Do not rely on them: " : " But: ") +
         spoils_phrase(judgement);
}

}  // namespace libchar
