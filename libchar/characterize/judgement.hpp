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

}  // namespace libchar
