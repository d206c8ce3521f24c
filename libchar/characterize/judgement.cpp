// What a rating says follows from statuses and tests that stand with the fit: no threshold of a test is decided here.

#include "libchar/characterize/judgement.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "libchar/characterize/verification.hpp"
#include "libchar/core/readable.hpp"
#include "libchar/core/term_cells.hpp"
#include "libchar/core/text_table.hpp"

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

void add(Judgement& out, Objection objection) {
  out.rating = std::max(out.rating, objection.rating);
  out.objections.push_back(std::move(objection));
}

void look_at_terms(const NoiseFit& fit, Judgement& out) {
  if (const std::string letters = letters_with(fit, Status::undetermined); !letters.empty())
    add(out,
        {ObjectionKind::undetermined,
         Rating::caution,
         letters +
             " undetermined: not told from another term, or contradicted by the Allan curve"});
  for (std::size_t t = 0; t < kTerms; ++t)
    if (fit.term[t].status == Status::detected && !(fit.term[t].ci95.low > 0))
      add(out,
          {ObjectionKind::reaches_zero,
           Rating::caution,
           fmt::format("{} is uncertain: its interval includes 0", kTermNames[t].letter)});
}

void look_at_goodness(const NoiseFit& fit, Judgement& out) {
  const bool explained = fit.goodness.p >= kDoubtful;
  const std::string sentence = explained ? "" : goodness_sentence(fit.goodness);
  if (!letters_with(fit, Status::misfit).empty())
    add(out,
        {ObjectionKind::misfit,
         Rating::bad,
         "the noise terms do not describe the recording",
         sentence});
  else if (!explained)
    add(out,
        {ObjectionKind::unexplained,
         Rating::bad,
         fmt::format("the model does not explain the spectrum ({})",
                     probability_text(fit.goodness.p)),
         sentence});
  if (!fit.converged)
    add(out,
        {ObjectionKind::not_converged,
         Rating::bad,
         "the fit did not converge",
         "The fit did not converge."});
}

void look_at_fit(const NoiseFit& fit, Judgement& out) {
  look_at_goodness(fit, out);
  look_at_terms(fit, out);
  for (const Remedy& remedy : fit.remedies)
    for (const auto& [kind, phrase] : kRemedies)
      if (remedy.kind == kind)
        add(out, {ObjectionKind::remedy, Rating::caution, std::string(phrase)});
  if (!fit.events.empty())
    add(out, {ObjectionKind::events, Rating::caution, events_taken_out(fit)});
  if (fit.second_opinion && !fit.second_opinion->agrees)
    add(out,
        {ObjectionKind::allan_disagrees,
         Rating::caution,
         "the fit of the Allan curve disagrees",
         "The Allan fit disagrees: " + fit.second_opinion->sentence});
  if (fit.stationarity.noticeable)
    add(out,
        {ObjectionKind::not_stationary,
         Rating::caution,
         "the noise is not the same throughout the recording"});
}

void look_at_motion(const Motion& motion, Judgement& out) {
  if (motion.moving_s.empty() && motion.changes.empty()) return;
  std::vector<std::string> parts;
  if (!motion.moving_s.empty())
    parts.push_back("moved or shaken in " + counted(motion.moving_s.size(), "stretch", "es"));
  if (motion.changes.size() == 1)
    parts.push_back(fmt::format("the noise is {} times as strong from {} s on",
                                brief_text(motion.changes[0].factor),
                                place_text(motion.changes[0].at_s)));
  else if (!motion.changes.empty())
    parts.push_back(fmt::format("the noise changes its strength {} times", motion.changes.size()));
  add(out,
      {ObjectionKind::motion,
       Rating::caution,
       fmt::format("{}", fmt::join(parts, "; ")),
       fmt::format("{}", fmt::join(motion.sentences, " "))});
}

/// A noise of which a hundredth does not fit into the range is not the one that was recorded.
constexpr double kMostSaturated = 0.01;
/// Fewer missing samples cost nothing worth mentioning: terms that touch them are left out.
constexpr double kMostMissing = 0.01;

double share_of(std::uint64_t part, std::uint64_t whole) {
  return whole == 0 ? 0 : static_cast<double>(part) / static_cast<double>(whole);
}

void look_at_samples(const ChannelResult& channel, Judgement& out) {
  const ChannelQuality& q = channel.quality;
  const double cut = share_of(q.saturated, q.samples);
  const bool said = !q.suggestions.empty() || !channel.digital.rails.empty();
  const std::string sentence =
      said ? "" : fmt::format("{} samples stand at the end of the range.", count_text(q.saturated));
  if (cut > kMostSaturated)
    add(out,
        {ObjectionKind::saturated,
         Rating::bad,
         fmt::format("{} of the samples stand at the end of the range", percent_text(cut)),
         sentence});
  else if (q.saturated > 0 && q.suggestions.empty())
    add(out,
        {ObjectionKind::saturated,
         Rating::caution,
         fmt::format("{} {} at the end of the range",
                     count_text(q.saturated),
                     q.saturated == 1 ? "sample stands" : "samples stand"),
         sentence});
  if (const double share = share_of(q.missing, q.samples + q.missing); share > kMostMissing)
    add(out,
        {ObjectionKind::missing,
         Rating::caution,
         fmt::format("{} of the samples are missing", percent_text(share)),
         fmt::format("{} samples ({}) are missing.", count_text(q.missing), percent_text(share))});
}

void look_at_verification(const ChannelVerification& verification, Judgement& out) {
  if (verification.agrees) return;
  const bool nearly = verification.nearly;
  add(out,
      {ObjectionKind::simulation,
       nearly ? Rating::caution : Rating::bad,
       nearly ? "a simulation of the model differs by a few per cent"
              : "a simulation of the model does not agree",
       verification.sentences.front()});
}

// Sentences that other parts have made; without a fit they say why there is none.
void look_at_sentences(const ChannelResult& channel, Judgement& out) {
  const auto& phrased = channel.motion.sentences;
  const auto kind = channel.fit ? ObjectionKind::found : ObjectionKind::no_fit;
  const auto rating = channel.fit ? Rating::caution : Rating::bad;
  for (const std::string& sentence : channel.problems)
    if (!channel.fit || std::find(phrased.begin(), phrased.end(), sentence) == phrased.end())
      add(out, {kind, rating, channel.fit ? as_part(sentence) : without_stop(sentence), sentence});
  if (!channel.fit && channel.problems.empty())
    add(out, {kind, rating, "no noise coefficients were computed", ""});
  for (const std::string& sentence : channel.quality.suggestions)
    add(out, {ObjectionKind::found, Rating::caution, as_part(sentence), sentence});
}

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
  Judgement out;
  if (channel.fit) {
    look_at_fit(*channel.fit, out);
    look_at_motion(channel.motion, out);
  }
  if (channel.verification) look_at_verification(*channel.verification, out);
  look_at_samples(channel, out);
  look_at_sentences(channel, out);
  return out;
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
