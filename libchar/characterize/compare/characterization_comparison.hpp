#pragma once
// Characterizations, models and curves side by side: which is the lowest, in each term and at each averaging
// time, and which cannot be distinguished from it?
//
//   CharacterizationComparison which = compare_characterizations({read_characterization_report("a"),
// read_characterization_report("b.yaml")});
//   which.verdict;                     // "Angular rate, mean of x, y and z: a is lowest below 1 s, …"

#include <optional>
#include <string>
#include <vector>

#include "libchar/characterize/compare/reported_characterization.hpp"
#include "libchar/characterize/compare/term_ratio.hpp"
#include "libchar/model/noise_limits.hpp"

namespace libchar {

/// One term of all candidates, in the unit of the group, and against that of the first.
struct ComparedTerm {
  Term term = Term::white;
  std::vector<Coefficient> values;
  std::vector<detail::TermRatio> ratios;
  std::vector<TermDifference> differences;
  detail::Lowest lowest;
  std::optional<double> limit;  ///< of a data sheet
};

/// Channels that measure the same.
struct ComparedGroup {
  /// A channel of one side (or its axes taken together) in a group of channels that measure the same.
  struct Candidate {
    std::size_t side = 0;
    std::vector<std::string> channels;
    std::string name;  ///< of the side, with that of the channel where the side has several here
    bool measured = true;           ///< else a model without intervals, such as a data sheet
    bool takes_part = true;         ///< no: a finding says that its numbers are not to be relied on
    std::vector<Finding> findings;  ///< what to know before it is chosen, the worst first
    std::vector<AllanPoint> curve;  ///< in the unit of the group
  };

  /// All curves at one averaging time: as coefficients, not fitted where a curve does not reach.
  struct Time {
    double tau_s = 0;
    std::vector<Coefficient> values;
    detail::Lowest lowest;
  };

  /// Averaging times over which the same are the lowest.
  struct Range {
    double from_s = 0, to_s = 0;
    std::vector<std::size_t> lowest;  ///< one, or those that are not distinguished
  };

  std::string name;      ///< "angular rate x", "angular rate, mean of x, y and z"
  std::string quantity;  ///< "angular_rate"; "": without a known unit
  std::string axis;      ///< "x"; "": none, or several
  std::string unit;      ///< of the first that has one
  bool of_axes = false;  ///< root mean square of several axes
  bool within = false;   ///< an axis of such a group, which has all of its candidates
  std::vector<Candidate> candidates;
  std::vector<ComparedTerm> terms;
  std::vector<Time> times;
  std::vector<Range> ranges;
  std::vector<double> limit_tau_s, limit_curve;  ///< of a data sheet
  std::string sentence;                          ///< for the averaging times
  std::string terms_sentence;  ///< "Lowest N: a; lowest B: not distinguished (a, c)."
};

struct CharacterizationComparison {
  std::vector<ReportedCharacterization> sides;
  std::vector<ComparedGroup> groups;  ///< of several axes first
  std::vector<std::string>
      remarks;  ///< bands, shapes, rates and units that differ; channels that are in one only
  std::vector<std::string> known;  ///< findings of the sides, in sentences
  double probability = 0.01;       ///< of calling any of equal sensors lower than another
  std::string verdict;             ///< a paragraph
};

struct CharacterizationCompareOptions {
  double probability =
      0.01;  ///< of calling any term, at any averaging time, of equal sensors different
  std::vector<std::string> names;  ///< of the sides, in their order; "" or none: by their files
  std::vector<std::string>
      channels;  ///< names or patterns, "gyro_x" for any channel that measures it; empty: all
  std::optional<NoiseLimits> limits;  ///< a data sheet
};

/// Throws Error(input) where no two channels measure the same, with what each of the sides measures;
/// Error(usage) for a channel that none has.
CharacterizationComparison compare_characterizations(
    std::vector<ReportedCharacterization> sides,
    const CharacterizationCompareOptions& options = {});

}  // namespace libchar
