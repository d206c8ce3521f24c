#pragma once
// Characterizations, models and curves side by side: which is the lowest, in each term and at each averaging
// time, and which cannot be distinguished from it?
//
//   CharacterizationComparison which = compare_characterizations({read_characterization_report("a"),
// read_characterization_report("b.yaml")});
//   which.verdict;                     // "Angular rate, mean of x, y and z: a is lowest below 1 s, …"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/characterize/compare/reported_characterization.hpp"
#include "libchar/core/coefficient.hpp"
#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/file/growth_check.hpp"
#include "libchar/model/noise_limits.hpp"

namespace libchar {
// Two independent coefficients, or two points of curves: what is their ratio, and is it beyond chance?

enum class TermDifference {
  larger,        ///< beyond chance
  smaller,       ///< beyond chance
  not_resolved,  ///< the intervals allow none
  not_judged,    ///< one of the two cannot be relied on, or only limits are known
  only_one,      ///< fitted in one of the two only
};
template <>
inline constexpr auto enum_table<TermDifference> =
    enum_words<TermDifference, "larger smaller not_resolved not_judged only_one">;

namespace detail {

/// Of one to another.
struct TermRatio {
  std::optional<double> ratio;  ///< none: one has no value
  Interval ci95;
  std::optional<double> p;  ///< two-sided, of this ratio or one farther from 1 when both are equal
};

bool relied_on(const Coefficient& c);
Coefficient scaled(Coefficient c, double factor);

TermRatio ratio_of(const Coefficient& b, const Coefficient& a);

/// Of b from a, where the probability of a difference of equal sensors is `share`.
TermDifference difference_of(const Coefficient& b, const Coefficient& a, double share);

/// The square root of the mean of squares, such as of the three axes of a sensor.
Coefficient root_mean_square(const std::vector<Coefficient>& all);

/// Which of several is the smallest, and which of them could be it as well.
struct Lowest {
  std::optional<std::size_t> best;     ///< none: none can be relied on
  std::vector<std::size_t> not_apart;  ///< not distinguished from it
};

/// Of the ones that take part. `share`: as difference_of.
Lowest lowest_of(const std::vector<Coefficient>& all, const std::vector<bool>& takes_part, double share);

}  // namespace detail

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
    std::string name;               ///< of the side, with that of the channel where the side has several here
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
  std::string terms_sentence;                    ///< "Lowest N: a; lowest B: not distinguished (a, c)."
};

struct CharacterizationComparison {
  std::vector<ReportedCharacterization> sides;
  std::vector<ComparedGroup> groups;  ///< of several axes first
  std::vector<std::string> remarks;   ///< bands, shapes, rates and units that differ; channels that are in one only
  std::vector<std::string> known;     ///< findings of the sides, in sentences
  double probability = 0.01;          ///< of calling any of equal sensors lower than another
  std::string verdict;                ///< a paragraph
};

struct CharacterizationCompareOptions {
  double probability = 0.01;          ///< of calling any term, at any averaging time, of equal sensors different
  std::vector<std::string> names;     ///< of the sides, in their order; "" or none: by their files
  std::vector<std::string> channels;  ///< names or patterns, "gyro_x" for any channel that measures it; empty: all
  std::optional<NoiseLimits> limits;  ///< a data sheet
};

/// Throws Error(input) where no two channels measure the same, with what each of the sides measures;
/// Error(usage) for a channel that none has.
CharacterizationComparison compare_characterizations(std::vector<ReportedCharacterization> sides,
                                                     const CharacterizationCompareOptions& options = {});

// Checks on characterizations, such as a build server asks for: "white_noise+5%", "gyro_x:bias_instability+20%".

/// Metrics: the keys of the terms; labels are of channels. Throws Error(usage).
GrowthCheck parse_characterization_check(std::string_view text);

/// One sentence for each term that fails. A later side fails where the first knows the term and it does not. It also
/// fails where the whole 95 % interval of its ratio to the first is above what is allowed. If the first has only a
/// limit, the whole interval of the later side must be above what is allowed of that limit. Throws Error(usage) when
/// `label` is in no side, and Error(check) when the first has no such term: a check that cannot fail.
std::vector<std::string> failures(const CharacterizationComparison& comparison, const GrowthCheck& check);

}  // namespace libchar

// Who is the lowest at which averaging time.

namespace libchar::detail {

/// A curve at an averaging time as a coefficient, interpolated on logarithmic axes: not fitted beyond its ends,
/// undetermined where it has no interval.
Coefficient curve_at(const std::vector<AllanPoint>& curve, double tau_s);

/// Ten averaging times a decade where two curves reach at least.
std::vector<double> compared_times(const ComparedGroup& group);

/// Octaves of them: neighbouring times share their samples, and an octave is about one judgement.
std::size_t octaves_of(const ComparedGroup& group);

/// Times, ranges and the sentence of a group. `share`: of each judgement.
void compare_times(ComparedGroup& group, double share);

}  // namespace libchar::detail

// Channels of several sides that measure the same, whatever their names.

namespace libchar {

namespace detail {

/// "gyro_x" for "wx", "GyrX" and "angular_velocity.x" in a unit of angular rate, "baro" for a pressure; the name
/// itself where the unit is not known.
std::string usual_channel_name(std::string_view name, std::string_view unit);

/// A channel in a group.
struct PairedChannel {
  std::size_t side = 0;
  const ReportedChannel* channel = nullptr;
  double factor = 1;  ///< to the unit of the group
};

struct ChannelPairs {
  ComparedGroup group;  ///< its name, quantity, axis and unit
  std::vector<PairedChannel> channels;
};

/// By its own name or the usual one; nothing wanted: all are.
bool is_chosen(const ReportedChannel& channel, const std::vector<std::string>& wanted);

/// Groups of the channels that `wanted` chooses, in the order of their first channels; also those of one channel only.
std::vector<ChannelPairs> paired_channels(const std::vector<ReportedCharacterization>& sides,
                                          const std::vector<std::string>& wanted);

/// Groups of one quantity and several axes with one channel of each side that takes part in all of them.
struct AxesTogether {
  ComparedGroup group;
  std::vector<std::vector<PairedChannel>> sides;  ///< the axes of each
};
std::vector<AxesTogether> axes_together(const std::vector<ChannelPairs>& pairs);

}  // namespace detail
}  // namespace libchar
