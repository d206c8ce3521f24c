#pragma once
// May the numbers of a channel be used? One judge, from which badge, sentences, headline and exit code follow.

#include <string>
#include <vector>

#include "libchar/characterize/characterization.hpp"
#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/text/text_table.hpp"

namespace libchar {

/// Ordered: the larger, the worse.
enum class Rating {
  good,     ///< nothing speaks against them
  caution,  ///< they hold, but something was found that asks for a look
  bad,      ///< there are none, or they are not to be relied on
};
template <>
inline constexpr auto enum_table<Rating> = enum_words<Rating>({{Rating::good, "good"},
                                                               {Rating::caution, "caution"},
                                                               {Rating::bad, "bad"}});

/// "good", "caution", "do not use".
std::string_view rating_word(Rating rating);
Tint tint_of(Rating rating);

enum class ObjectionKind {
  no_fit,           ///< there are no coefficients
  misfit,           ///< the noise terms do not describe the record
  unexplained,      ///< goodness of fit below `kDoubtful`
  not_converged,    ///< the fit
  undetermined,     ///< terms
  reaches_zero,     ///< the interval of a detected term
  remedy,           ///< spikes, lines, the slowest part: left out
  events,           ///< steps, warm-ups, ramps: taken out
  allan_disagrees,  ///< the fit of the Allan curve
  not_stationary,   ///< the noise changes
  motion,           ///< moved, shaken, or of changing strength
  simulation,       ///< of the model disagrees (`--verify`)
  saturated,        ///< samples at the end of the range
  missing,          ///< more than 1 % of the samples
  found,            ///< anything else that was found in the channel
};

struct Objection {
  ObjectionKind kind = ObjectionKind::found;
  Rating rating = Rating::caution;
  std::string phrase;  ///< part of a sentence: "spikes were left out"
  /// For a list of what asks for a look; "" where another part of the report says it.
  std::string sentence = "";
};

struct Judgement {
  Rating rating = Rating::good;       ///< that of the worst objection
  std::vector<Objection> objections;  ///< against the numbers; empty: good
  bool has(ObjectionKind kind) const;
};

Judgement judge(const ChannelResult& channel);

/// A sentence as a part of another: its first letter small, no full stop.
std::string as_part(const std::string& sentence);

/// Below this the residuals are not what the model leads one to expect in one record of a thousand.
inline constexpr double kDoubtful = 1e-3;

/// How well the model explains the channel, by the p-value of the fit.
std::string goodness_sentence(const Goodness& goodness);

}  // namespace libchar
