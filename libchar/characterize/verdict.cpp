#include "libchar/characterize/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libchar/characterize/model_curve.hpp"
#include "libchar/characterize/summary.hpp"
#include "libchar/characterize/verification.hpp"
#include "libchar/core/decimal.hpp"
#include "libchar/core/readable.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

std::string in_habitual_unit(const Coefficient& c, Term term, const std::string& unit) {
  const auto habits = habitual_units(kTermNames[static_cast<std::size_t>(term)].key, unit);
  if (habits.empty()) return "";
  return fmt::format(" ({}{}{})",
                     value_text(c, habits[0].factor),
                     habits[0].symbol.empty() ? "" : " ",
                     habits[0].symbol);
}

std::string finding(const NoiseFit& fit, Term term, const std::string& unit) {
  const Coefficient& c = fit[term];
  const auto& name = kTermNames[static_cast<std::size_t>(term)];
  const std::string own = shown_term_unit(name.key, unit), title = term_title(term, unit);
  const std::string value =
      value_text(c) + (own.empty() ? "" : " ") + own + in_habitual_unit(c, term, unit);
  switch (c.status) {
    case Status::detected:
      return fmt::format("{} {} = {}, known to {} %.",
                         title,
                         name.letter,
                         value,
                         number_text(100 * c.relative_sd, 2));
    case Status::undetermined:
      return fmt::format(
          "{} {} = {}, but undetermined: the record cannot tell it from another term, or "
          "contradicts it.",
          title,
          name.letter,
          value);
    case Status::misfit:
      return fmt::format("{} {} = {}, but the noise terms do not describe the recording.",
                         title,
                         name.letter,
                         value);
    case Status::not_detected:
      return fmt::format("{} {} not detected, {} (95 %).", title, name.letter, value);
    case Status::given:
      return fmt::format("{} {} = {}, given.", title, name.letter, value);
    case Status::not_fitted:
      return "";
  }
  return "";
}

bool misfits(const NoiseFit& fit) {
  return std::any_of(fit.term.begin(), fit.term.end(), [](const Coefficient& term) {
    return term.status == Status::misfit;
  });
}

bool explained(const ChannelResult& c) {
  return c.fit && c.fit->goodness.p >= kDoubtful && !misfits(*c.fit);
}

std::string list_of(const std::vector<std::string>& names) {
  std::string out;
  for (std::size_t i = 0; i < std::min<std::size_t>(names.size(), 6); ++i)
    out += (i == 0 ? "" : ", ") + names[i];
  if (names.size() > 6) out += fmt::format(" and {} more", names.size() - 6);
  return out;
}

}  // namespace

double missing_share(const ChannelQuality& quality) {
  const std::uint64_t all = quality.samples + quality.missing;
  return all == 0 ? 0 : static_cast<double>(quality.missing) / static_cast<double>(all);
}

std::string term_title(Term term) {
  switch (term) {
    case Term::white:
      return "White noise";
    case Term::flicker:
      return "Bias instability";
    case Term::walk:
      return "Random walk";
    case Term::quantization:
      return "Quantization";
    case Term::ramp:
      return "Rate ramp";
  }
  return "";
}

std::string goodness_sentence(const Goodness& g) {
  if (!(g.dof > 0)) return "The fit has no degrees of freedom left to be checked with.";
  const std::string figures = fmt::format("χ² = {} for {} degrees of freedom, {}",
                                          significant(g.chi2, 4),
                                          significant(g.dof, 4),
                                          probability_text(g.p));
  if (g.p >= 0.01) return "The model explains the spectrum within its scatter (" + figures + ").";
  if (g.p >= kDoubtful) return "The model explains the spectrum barely (" + figures + ").";
  return "The model does not explain the spectrum (" + figures +
         "): look at the residuals before using the intervals.";
}

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
        value_text(fit.gauss_markov->sigma),
        unit.empty() ? "U" : unit,
        duration_text(*fit.gauss_markov->tau_s.value),
        fit.gauss_markov->sigma.status == Status::detected
            ? fmt::format(", known to {} % and {} %",
                          number_text(100 * fit.gauss_markov->sigma.relative_sd, 2),
                          number_text(100 * fit.gauss_markov->tau_s.relative_sd, 2))
            : ", but the record contradicts it or the terms do not describe it"));
  if (fit.temperature && fit.temperature->order > 0)
    out.push_back(temperature_sentence(*fit.temperature, unit));
  if (fit.bandwidth_hz) {
    out.push_back(
        fmt::format("A first-order low-pass at {} Hz colours the short averaging times; it is part "
                    "of the model.",
                    number_text(*fit.bandwidth_hz, 3)));
  }
  return out;
}

std::vector<std::string> cautions(const ChannelResult& channel) {
  std::vector<std::string> out = channel.problems;
  const ChannelQuality& q = channel.quality;
  if (channel.fit) {
    const NoiseFit& fit = *channel.fit;
    if (!fit.converged) out.push_back("The fit did not converge.");
    if (!(fit.goodness.p >= kDoubtful)) out.push_back(goodness_sentence(fit.goodness));
    if (fit.second_opinion && !fit.second_opinion->agrees)
      out.push_back("The Allan fit disagrees: " + fit.second_opinion->sentence);
  }
  if (channel.verification && !channel.verification->agrees)
    out.push_back(channel.verification->sentences.front());
  if (q.saturated > 0 && q.suggestions.empty() && channel.digital.rails.empty())
    out.push_back(
        fmt::format("{} samples stand at the end of the range.", count_text(q.saturated)));
  // Fewer cost nothing worth mentioning here: terms that touch them are left out.
  if (const double share = missing_share(q); share > 0.01)
    out.push_back(fmt::format(
        "{} samples ({} %) are missing.", count_text(q.missing), number_text(100 * share, 2)));
  out.insert(out.end(), q.suggestions.begin(), q.suggestions.end());
  return out;
}

std::string verdict_of(const Characterization& result) {
  const std::size_t n = result.channels.size();
  std::vector<std::string> unfitted, doubtful, disputed, doubted, noted, refuted;
  std::size_t opinions = 0;
  for (const ChannelResult& c : result.channels) {
    if (c.fit && std::any_of(c.fit->term.begin(), c.fit->term.end(), [](const Coefficient& term) {
          return term.status == Status::undetermined || term.status == Status::misfit;
        }))
      doubted.push_back(c.channel.name);
    const bool unlike = c.verification && !c.verification->agrees;
    if (unlike) refuted.push_back(c.channel.name);
    opinions += c.fit && c.fit->second_opinion ? 1 : 0;
    if (c.fit && (!c.problems.empty() || unlike || !c.fit->events.empty()))
      noted.push_back(c.channel.name);
    if (!c.fit)
      unfitted.push_back(c.channel.name);
    else if (!explained(c))
      doubtful.push_back(c.channel.name);
    else if (c.fit->second_opinion && !c.fit->second_opinion->agrees)
      disputed.push_back(c.channel.name);
  }
  if (n == 0) return "The recording holds no channel to characterize.";
  const std::size_t good = n - unfitted.size() - doubtful.size() - disputed.size();
  std::string out;
  if (good == n) {
    out = n == 1 ? "The noise model explains the channel within its scatter"
                 : fmt::format("The noise model explains all {} channels within their scatter", n);
    if (opinions == n)
      out += n == 1 ? ", and the Allan fit agrees." : ", and the Allan fits agree.";
    else if (opinions > 0)
      out +=
          fmt::format(", and the Allan fits, where they are made ({} of {}), agree.", opinions, n);
    else
      out += ".";
  } else {
    out = fmt::format("The noise model explains {} of {} channels within their scatter.", good, n);
  }
  if (!doubtful.empty())
    out +=
        fmt::format(" It does not explain {}: see the residuals there before using the intervals.",
                    list_of(doubtful));
  if (!disputed.empty())
    out += fmt::format(" The Allan fit disagrees with the spectral fit on {}.", list_of(disputed));
  if (!refuted.empty())
    out += fmt::format(" A simulation of the model does not agree with {}.", list_of(refuted));
  if (!unfitted.empty()) out += fmt::format(" No fit was possible for {}.", list_of(unfitted));
  if (!doubted.empty()) out += fmt::format(" Coefficients of {} are doubtful.", list_of(doubted));
  if (!noted.empty()) out += fmt::format(" Read what is said of {}.", list_of(noted));
  if (result.still) out += " " + result.still->sentence;
  return out;
}

}  // namespace libchar
