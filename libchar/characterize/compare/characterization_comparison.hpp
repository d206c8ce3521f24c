#pragma once
// Two characterizations, term by term: did the sensor change?

#include <optional>
#include <string>
#include <vector>

#include "libchar/characterize/compare/reported_characterization.hpp"
#include "libchar/core/document/enum_table.hpp"

namespace libchar {

enum class TermDifference {
  larger,        ///< in B, beyond chance
  smaller,       ///< in B, beyond chance
  not_resolved,  ///< the intervals allow none
  not_judged,    ///< one of the two cannot be relied on, or only limits are known
  only_one,      ///< fitted in one of the two only
};
template <>
inline constexpr auto enum_table<TermDifference> =
    enum_words<TermDifference, "larger smaller not_resolved not_judged only_one">;

/// A term of one channel; coefficients in the unit of the channel in A.
struct ComparedTerm {
  Term term = Term::white;
  Coefficient a, b;
  std::optional<double> ratio;  ///< B / A; none: one has no value
  Interval ratio_ci95;
  std::optional<double> p;  ///< two-sided, of this ratio or one farther from 1 when both are equal
  TermDifference difference = TermDifference::not_judged;
  std::string sentence;
};

struct ComparedChannel {
  std::string name, unit;
  bool in_a = true, in_b = true;
  std::vector<ComparedTerm> terms;
  std::vector<std::string> remarks;  ///< band, shape, events, units, rates that differ
};

struct CharacterizationComparison {
  ReportedCharacterization a, b;
  std::vector<ComparedChannel> channels;
  std::string verdict;  ///< a paragraph
};

struct CharacterizationCompareOptions {
  double probability =
      0.01;  ///< of calling any term of equal sensors different: each term gets its share
};

CharacterizationComparison compare_characterizations(
    ReportedCharacterization a,
    ReportedCharacterization b,
    const CharacterizationCompareOptions& options = {});

}  // namespace libchar
