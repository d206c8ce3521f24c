#pragma once
// May the numbers of a channel be used? One judge, from which badge, sentences, headline and exit code follow.

#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/text/text_table.hpp"

namespace libchar {

/// Ordered: the larger, the worse.
enum class Rating {
  good,     ///< nothing speaks against them
  caution,  ///< they hold, but something was found that asks for a look
  bad,      ///< there are none, or they are unreliable
};
template <>
inline constexpr auto enum_table<Rating> = enum_words<Rating, "good caution bad">;

/// "good", "caution", "do not use".
std::string_view rating_word(Rating rating);
Tint tint_of(Rating rating);

struct Judgement {
  Rating rating = Rating::good;   ///< that of the worst finding
  std::vector<Finding> findings;  ///< about the channel and its numbers, the worst first
  bool has(std::string_view code) const { return libchar::has(findings, code); }
};

Judgement judge(const ChannelResult& channel);

/// What is known of a channel and of what was computed of it, the worst first: for whoever prints a part.
std::vector<Finding> findings_of(const ChannelResult& channel);

/// How well the model explains the channel, by the p-value of the fit.
std::string goodness_sentence(const Goodness& goodness);

// The report in sentences: what was found, how far it can be trusted, what to look at.

/// One paragraph for the whole recording, `judged` a channel each: as its badges say.
std::string verdict_of(const Characterization& result, const std::vector<Judgement>& judged);
std::string verdict_of(const Characterization& result);

/// What a fit found, in sentences with numbers in `unit`.
std::vector<std::string> findings(const NoiseFit& fit, const std::string& unit);

/// Findings of a fit other than its noise terms: temperature, a filter. The last of `findings`.
std::vector<std::string> findings_beside_terms(const NoiseFit& fit, const std::string& unit);

namespace detail {
/// What the reader found and a quantity depends on goes with each of its channels.
void add_findings_of(const Findings& recording, std::vector<Finding>& findings);

/// The terms describe the record, or the band of it that is fitted, within its scatter.
bool is_described(const NoiseFit& fit);

/// What is known of the samples behind a curve, and what the fit that makes the intervals found and took apart, which
/// the curve does not: steps, cycles, lines, noise that is not the same throughout.
std::vector<Finding> findings_of_curve(ChannelResult channel);

/// A channel in one sentence: what its noise is, how far that can be used, and what spoils it. The terms, then what
/// speaks against them; without a fit, why there is none.
std::string summary_sentence(const ChannelResult& channel, const Judgement& judgement, const std::string& unit);
}  // namespace detail

}  // namespace libchar
