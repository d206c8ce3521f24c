#pragma once
// A channel in one sentence: what its noise is, how far that can be used, and what spoils it.

#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/core/enum_table.hpp"

namespace libchar {

/// May the numbers be used? Ordered: the larger, the worse.
enum class Rating {
  good,     ///< nothing speaks against them
  caution,  ///< they hold, but something was found that asks for a look
  bad,      ///< there are none, or they are not to be relied on
};
template <>
inline constexpr auto enum_table<Rating> = enum_words<Rating>({{Rating::good, "good"},
                                                               {Rating::caution, "caution"},
                                                               {Rating::bad, "bad"}});

/// "good", "look", "do not use".
std::string_view rating_word(Rating rating);

struct ChannelSummary {
  Rating rating = Rating::good;
  std::string sentence;             ///< the terms, then what spoils them
  std::vector<std::string> spoils;  ///< each a phrase; empty where nothing does
};

ChannelSummary summary_of(const ChannelResult& channel, const std::string& unit);

/// A term in the unit that the field quotes it in, or in its own where the field has none of its own.
struct FieldUnit {
  double factor = 1;  ///< multiply the coefficient by this
  std::string symbol;
};
FieldUnit field_unit(Term term, const std::string& unit);

/// "Angle random walk" for white noise of an angular rate, "Velocity random walk" of an acceleration, else "White noise";
/// likewise of the other terms.
std::string term_title(Term term, const std::string& unit);

}  // namespace libchar
