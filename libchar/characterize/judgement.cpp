// What a rating says follows from statuses and tests that stand with the fit: no threshold of a test is decided here.

#include "libchar/characterize/judgement.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "libchar/characterize/compare/verification.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/text/text_table.hpp"

namespace libchar {
namespace {

std::string without_stop(std::string sentence) {
  while (!sentence.empty() && sentence.back() == '.') sentence.pop_back();
  return sentence;
}

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
  return joined(letters);
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
  return joined(parts) + (all == 1 ? " was taken out" : " were taken out");
}

/// A noise of which a hundredth does not fit into the range is not the one that was recorded.
constexpr double kMostSaturated = 0.01;
/// Fewer missing samples cost nothing worth mentioning: terms that touch them are left out.
constexpr double kMostMissing = 0.01;

double share_of(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::string motion_phrase(const Motion& motion) {
  std::vector<std::string> parts;
  if (!motion.moving_s.empty())
    parts.push_back("moved or shaken in " + counted(motion.moving_s.size(), "stretch", "es"));
  if (motion.changes.size() == 1)
    parts.push_back(fmt::format("the noise is {} times as strong from {} s on",
                                brief_text(motion.changes[0].factor),
                                place_text(motion.changes[0].at_s)));
  else if (!motion.changes.empty())
    parts.push_back(fmt::format("the noise changes its strength {} times", motion.changes.size()));
  return fmt::format("{}", fmt::join(parts, "; "));
}

struct Judge {
  using enum ObjectionKind;
  using enum Rating;

  const ChannelResult& channel;
  Judgement out;

  void add(ObjectionKind kind, Rating rating, std::string phrase, std::string sentence = "") {
    out.rating = std::max(out.rating, rating);
    out.objections.push_back({kind, rating, std::move(phrase), std::move(sentence)});
  }

  void look_at_goodness(const NoiseFit& fit) {
    const bool explained = fit.goodness.p >= kDoubtful;
    const std::string sentence = explained ? "" : goodness_sentence(fit.goodness);
    const std::string p = probability_text(fit.goodness.p);
    if (!letters_with(fit, Status::misfit).empty())
      add(misfit, bad, "the noise terms do not describe the recording", sentence);
    else if (!explained)
      add(unexplained, bad, "the model does not explain the spectrum (" + p + ")", sentence);
    if (!fit.converged)
      add(not_converged, bad, "the fit did not converge", "The fit did not converge.");
  }

  void look_at_terms(const NoiseFit& fit) {
    if (const std::string letters = letters_with(fit, Status::undetermined); !letters.empty())
      add(undetermined,
          caution,
          letters +
              " undetermined: not told from another term, or contradicted by the Allan curve");
    for (std::size_t t = 0; t < kTerms; ++t)
      if (fit.term[t].status == Status::detected && !(fit.term[t].ci95.low > 0))
        add(reaches_zero,
            caution,
            fmt::format("{} is uncertain: its interval includes 0", kTermNames[t].letter));
  }

  void look_at_fit(const NoiseFit& fit) {
    look_at_goodness(fit);
    look_at_terms(fit);
    for (const Remedy& taken : fit.remedies)
      for (const auto& [kind, phrase] : kRemedies)
        if (taken.kind == kind) add(remedy, caution, std::string(phrase));
    if (!fit.events.empty()) add(events, caution, events_taken_out(fit));
    if (fit.second_opinion && !fit.second_opinion->agrees)
      add(allan_disagrees,
          caution,
          "the fit of the Allan curve disagrees",
          "The Allan fit disagrees: " + fit.second_opinion->sentence);
    if (fit.stationarity.noticeable)
      add(not_stationary, caution, "the noise is not the same throughout the recording");
    const Motion& moved = channel.motion;
    if (const std::string phrase = motion_phrase(moved); !phrase.empty())
      add(motion, caution, phrase, fmt::format("{}", fmt::join(moved.sentences, " ")));
  }

  void look_at_verification(const ChannelVerification& simulated) {
    if (simulated.agrees) return;
    add(simulation,
        simulated.nearly ? caution : bad,
        simulated.nearly ? "a simulation of the model differs by a few per cent"
                         : "a simulation of the model does not agree",
        simulated.sentences.front());
  }

  void look_at_samples(const ChannelQuality& q) {
    const double cut = share_of(q.saturated, q.samples);
    const std::string stand = q.saturated == 1 ? "sample stands" : "samples stand";
    const std::string phrase = (cut > kMostSaturated ? percent_text(cut) + " of the samples stand"
                                                     : count_text(q.saturated) + " " + stand) +
                               " at the end of the range";
    const bool said = !q.suggestions.empty() || !channel.digital.rails.empty();
    const std::string sentence = said ? "" : phrase + ".";
    if (cut > kMostSaturated)
      add(saturated, bad, phrase, sentence);
    else if (q.saturated > 0 && q.suggestions.empty())
      add(saturated, caution, phrase, sentence);
    if (const double share = share_of(q.missing, q.samples + q.missing); share > kMostMissing)
      add(missing,
          caution,
          percent_text(share) + " of the samples are missing",
          fmt::format("{} samples ({}) are missing.", count_text(q.missing), percent_text(share)));
  }

  // Sentences that other parts have made; without a fit they say why there is none.
  void look_at_sentences() {
    const auto& phrased = channel.motion.sentences;
    for (const std::string& sentence : channel.problems)
      if (!channel.fit)
        add(no_fit, bad, without_stop(sentence), sentence);
      else if (std::find(phrased.begin(), phrased.end(), sentence) == phrased.end())
        add(found, caution, as_part(sentence), sentence);
    if (!channel.fit && channel.problems.empty())
      add(no_fit, bad, "no noise coefficients were computed");
    for (const std::string& sentence : channel.quality.suggestions)
      add(found, caution, as_part(sentence), sentence);
  }
};

}  // namespace

std::string_view rating_word(Rating rating) {
  return rating == Rating::good ? "good" : rating == Rating::caution ? "caution" : "do not use";
}

Tint tint_of(Rating rating) {
  return rating == Rating::good      ? Tint::good
         : rating == Rating::caution ? Tint::doubtful
                                     : Tint::bad;
}

bool Judgement::has(ObjectionKind kind) const {
  return std::any_of(objections.begin(), objections.end(), [&](const Objection& objection) {
    return objection.kind == kind;
  });
}

std::string as_part(const std::string& whole) {
  std::string sentence = without_stop(whole);
  const auto is_in = [&](std::size_t i, char first, char last) {
    return sentence.size() > i && sentence[i] >= first && sentence[i] <= last;
  };
  if (is_in(0, 'A', 'Z') && is_in(1, 'a', 'z'))
    sentence[0] = static_cast<char>(sentence[0] - 'A' + 'a');
  return sentence;
}

Judgement judge(const ChannelResult& channel) {
  Judge found{channel, {}};
  if (channel.fit) found.look_at_fit(*channel.fit);
  if (channel.verification) found.look_at_verification(*channel.verification);
  found.look_at_samples(channel.quality);
  found.look_at_sentences();
  return found.out;
}

std::string goodness_sentence(const Goodness& g) {
  if (!(g.dof > 0)) return "The fit has no degrees of freedom left to be checked with.";
  const std::string figures = fmt::format("χ² = {} for {} degrees of freedom, {}",
                                          brief_text(g.chi2, 4),
                                          brief_text(g.dof, 4),
                                          probability_text(g.p));
  if (g.p >= 0.01) return "The model explains the spectrum within its scatter (" + figures + ").";
  if (g.p >= kDoubtful) return "The model explains the spectrum barely (" + figures + ").";
  return "The model does not explain the spectrum (" + figures +
         "): look at the residuals before using the intervals.";
}

}  // namespace libchar
