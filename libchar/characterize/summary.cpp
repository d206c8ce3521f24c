// What a rating says follows from statuses and tests that stand with the fit: no threshold is decided here.

#include "libchar/characterize/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "libchar/characterize/verdict.hpp"
#include "libchar/characterize/verification.hpp"
#include "libchar/core/readable.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

/// What was found against a channel, the worst of it first.
struct Found {
  Rating rating = Rating::good;
  std::vector<std::string> spoils;

  void add(Rating how_bad, const std::string& phrase) {
    rating = std::max(rating, how_bad);
    spoils.push_back(phrase);
  }
};

std::string without_stop(std::string sentence) {
  while (!sentence.empty() && sentence.back() == '.') sentence.pop_back();
  return sentence;
}

// A sentence as a part of another.
std::string as_part(const std::string& whole) {
  std::string sentence = without_stop(whole);
  const auto is_in = [&](std::size_t i, char first, char last) {
    return sentence.size() > i && sentence[i] >= first && sentence[i] <= last;
  };
  if (is_in(0, 'A', 'Z') && is_in(1, 'a', 'z'))
    sentence[0] = static_cast<char>(sentence[0] - 'A' + 'a');
  return sentence;
}

// "a step", "3 steps": with what a sentence says of several kinds joined.
std::string counted(std::size_t count, const std::string& name, const char* many = "s") {
  if (count == 1) return "a " + name;
  return fmt::format("{} {}{}", count, name, many);
}

std::string joined(const std::vector<std::string>& parts,
                   std::string_view last,
                   std::string_view others = ", ") {
  std::string out;
  for (std::size_t i = 0; i < parts.size(); ++i)
    out += std::string(i == 0 ? "" : i + 1 == parts.size() ? last : others) + parts[i];
  return out;
}

/// Remedies that say something about the recording; the others (band, shape) say what the sensor's filter is.
constexpr std::pair<std::string_view, std::string_view> kRemedies[] = {
    {"spikes", "spikes were left out"},
    {"lines", "spectral lines were left out"},
    {"lowest_bins", "the slowest part does not look like noise and was left out"},
};

std::string letters_with(const NoiseFit& fit, Status status) {
  std::vector<std::string> letters;
  for (std::size_t t = 0; t < kTerms; ++t)
    if (fit.term[t].status == status) letters.emplace_back(kTermNames[t].letter);
  return joined(letters, " and ");
}

std::string events_taken_out(const NoiseFit& fit) {
  std::vector<std::string> parts;
  std::size_t all = 0;
  for (const EventKind kind : {EventKind::step, EventKind::warm_up, EventKind::ramp}) {
    const auto count = static_cast<std::size_t>(std::count_if(
        fit.events.begin(), fit.events.end(), [&](const Event& e) { return e.kind == kind; }));
    if (count > 0) parts.push_back(counted(count, std::string(event_name(kind))));
    all += count;
  }
  return joined(parts, " and ") + (all == 1 ? " was taken out" : " were taken out");
}

void look_at_fit(const NoiseFit& fit, Found& found) {
  const bool explained = fit.goodness.p >= kDoubtful;
  if (const std::string letters = letters_with(fit, Status::misfit); !letters.empty())
    found.add(Rating::bad, "the noise terms do not describe the recording");
  else if (!explained)
    found.add(Rating::bad,
              fmt::format("the model does not explain the spectrum ({})",
                          probability_text(fit.goodness.p)));
  if (!fit.converged) found.add(Rating::bad, "the fit did not converge");
  if (const std::string letters = letters_with(fit, Status::undetermined); !letters.empty())
    found.add(
        Rating::caution,
        letters + " undetermined: not told from another term, or contradicted by the Allan curve");
  for (std::size_t t = 0; t < kTerms; ++t)
    if (fit.term[t].status == Status::detected && !(fit.term[t].ci95.low > 0))
      found.add(
          Rating::caution,
          fmt::format("{} may be next to nothing: its interval begins at 0", kTermNames[t].letter));
  for (const Remedy& remedy : fit.remedies)
    for (const auto& [kind, phrase] : kRemedies)
      if (remedy.kind == kind) found.add(Rating::caution, std::string(phrase));
  if (!fit.events.empty()) found.add(Rating::caution, events_taken_out(fit));
  if (fit.second_opinion && !fit.second_opinion->agrees)
    found.add(Rating::caution, "the fit of the Allan curve disagrees");
  if (fit.stationarity.noticeable)
    found.add(Rating::caution, "the noise is not the same throughout the recording");
}

void look_at_motion(const Motion& motion, Found& found) {
  if (motion.whole) return;  // then there is no fit, and the sentence says why
  if (!motion.moving_s.empty())
    found.add(
        Rating::caution,
        fmt::format("moved or shaken in {}", counted(motion.moving_s.size(), "stretch", "es")));
  if (motion.changes.size() == 1)
    found.add(Rating::caution,
              fmt::format("the noise is {} times as strong from {} s on",
                          number_text(motion.changes[0].factor, 3),
                          number_text(motion.changes[0].at_s, 4)));
  else if (!motion.changes.empty())
    found.add(Rating::caution,
              fmt::format("the noise changes its strength {} times", motion.changes.size()));
}

/// A noise of which a hundredth does not fit into the range is not the one that was recorded.
constexpr double kMostSaturated = 0.01;

// What a fit or its absence leaves in sentences; reasons for no fit stand in the sentence itself.
void look_at_record(const ChannelResult& channel, Found& found) {
  const ChannelQuality& q = channel.quality;
  if (channel.verification && !channel.verification->agrees)
    found.add(channel.verification->nearly ? Rating::caution : Rating::bad,
              channel.verification->nearly ? "a simulation of the model differs by a few per cent"
                                           : "a simulation of the model does not agree");
  const double cut =
      q.samples == 0 ? 0 : static_cast<double>(q.saturated) / static_cast<double>(q.samples);
  if (cut > kMostSaturated)
    found.add(Rating::bad,
              fmt::format("{} % of the samples stand at the end of the range",
                          number_text(100 * cut, 2)));
  else if (q.saturated > 0 && q.suggestions.empty())
    found.add(Rating::caution,
              fmt::format("{} {} at the end of the range",
                          count_text(q.saturated),
                          q.saturated == 1 ? "sample stands" : "samples stand"));
  if (const auto share = missing_share(q); share > 0.01)
    found.add(Rating::caution,
              fmt::format("{} % of samples are missing", number_text(100 * share, 2)));
  const auto& told = channel.motion.sentences;  // in full; here they are phrases
  for (const auto* sentences : {&channel.problems, &q.suggestions})
    for (const std::string& sentence : *sentences)
      if ((channel.fit || sentence.rfind("no ", 0) != 0) &&
          std::find(told.begin(), told.end(), sentence) == told.end())
        found.add(Rating::caution, channel.fit ? as_part(sentence) : without_stop(sentence));
}

std::string term_phrase(const NoiseFit& fit, Term term, const std::string& unit) {
  const Coefficient& c = fit[term];
  if (!c.value && !c.upper95) return "";
  const FieldUnit field = field_unit(term, unit);
  const std::string symbol = field.symbol.empty() ? "" : " " + field.symbol;
  const std::string name = fmt::format(
      "{} {}", term_title(term, unit), kTermNames[static_cast<std::size_t>(term)].letter);
  if (!c.value) return fmt::format("{} not seen ({}{})", name, value_text(c, field.factor), symbol);
  const std::string whole = coefficient_text(c, field.factor);
  return fmt::format(
      "{} {}{} {}", name, value_text(c, field.factor), symbol, whole.substr(whole.find('[')));
}

std::string terms_of(const NoiseFit& fit, const std::string& unit) {
  std::vector<std::string> parts;
  for (std::size_t t = 0; t < kTerms; ++t) {
    std::string phrase = term_phrase(fit, static_cast<Term>(t), unit);
    if (phrase.empty()) continue;
    if (!parts.empty() && phrase[0] >= 'A' && phrase[0] <= 'Z')
      phrase[0] = static_cast<char>(phrase[0] - 'A' + 'a');
    parts.push_back(phrase);
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
  return parts.empty() ? "No noise term was found" : joined(parts, ", ");
}

std::string why_no_fit(const ChannelResult& channel) {
  for (const std::string& problem : channel.problems)
    if (problem.rfind("no ", 0) == 0) {
      const std::size_t colon = problem.find(": ");
      return "No noise coefficients: " +
             without_stop(colon == std::string::npos ? problem : problem.substr(colon + 2));
    }
  return "No noise coefficients were computed";
}

// Where the terms hold, when that is not everywhere, and what the sensor does beside its noise.
std::string beside_phrase(const NoiseFit& fit) {
  const std::string temperature = fit.temperature && fit.temperature->order > 0
                                      ? " Its dependence on temperature was taken out."
                                      : "";
  if (fit.band.whole || !(fit.rate_hz > 0) || fit.band.top_hz >= 0.499 * fit.rate_hz)
    return temperature;
  return fmt::format(" They hold below {} Hz.", number_text(fit.band.top_hz, 3)) + temperature;
}

constexpr std::size_t kMostSpoils = 4;

}  // namespace

std::string_view rating_word(Rating rating) {
  return rating == Rating::good ? "good" : rating == Rating::caution ? "look" : "do not use";
}

ChannelSentence summary_of(const ChannelResult& channel, const std::string& unit) {
  Found found;
  if (channel.fit) look_at_fit(*channel.fit, found);
  look_at_motion(channel.motion, found);
  look_at_record(channel, found);
  ChannelSentence out;
  out.rating = channel.fit ? found.rating : Rating::bad;
  out.spoils = std::move(found.spoils);
  out.sentence = channel.fit ? terms_of(*channel.fit, unit) : why_no_fit(channel);
  out.sentence += ".";
  if (channel.fit) out.sentence += beside_phrase(*channel.fit);
  if (out.spoils.empty()) return out;
  std::vector<std::string> told(
      out.spoils.begin(),
      out.spoils.begin() + static_cast<std::ptrdiff_t>(std::min(out.spoils.size(), kMostSpoils)));
  out.sentence += !channel.fit                ? " "
                  : out.rating == Rating::bad ? " Do not rely on them: "
                                              : " But: ";
  out.sentence += joined(told, "; ", "; ");
  if (out.spoils.size() > kMostSpoils)
    out.sentence += fmt::format("; and {} more", out.spoils.size() - kMostSpoils);
  out.sentence += ".";
  return out;
}

FieldUnit field_unit(Term term, const std::string& unit) {
  const auto key = kTermNames[static_cast<std::size_t>(term)].key;
  // The field has no shorter way to say it than the coefficient itself when its first habit is only a factor of ours.
  const auto habits = habitual_units(key, unit);
  const auto known = find_unit(unit);
  const bool inertial = known && (known->quantity == Quantity::angular_rate ||
                                  known->quantity == Quantity::acceleration);
  if (inertial && !habits.empty()) return {habits[0].factor, habits[0].symbol};
  return {1, shown_term_unit(key, unit)};
}

std::string term_title(Term term, const std::string& unit) {
  const auto known = find_unit(unit);
  const bool rate = known && known->quantity == Quantity::angular_rate;
  const bool acceleration = known && known->quantity == Quantity::acceleration;
  if (term == Term::white && rate) return "Angle random walk";
  if (term == Term::white && acceleration) return "Velocity random walk";
  if (term == Term::walk && rate) return "Rate random walk";
  if (term == Term::walk && acceleration) return "Acceleration random walk";
  return term_title(term);
}

}  // namespace libchar
