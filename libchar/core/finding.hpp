#pragma once
// What is known about a recording, a channel, a sensor or a noise term apart from its numbers. A finding is made at
// its discovery and carried as data by every later document: reports, models, exports, device records. Its parts
// follow the diagnostics of compilers (a code, places, a help that can be applied) and SARIF 2.1.0 (OASIS).

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/numeric/interval.hpp"

namespace libchar {

/// Ordered: the larger, the worse.
enum class Severity {
  note,     ///< worth knowing; the numbers hold
  caution,  ///< look before the numbers are used
  bad,      ///< there are no numbers, or they are not to be relied on
};
template <>
inline constexpr auto enum_table<Severity> = enum_words<Severity, "note caution bad">;

/// What a finding changes.
enum class Affected { values, time, rate, scale, mean, noise, white, flicker, walk, weights, verdict };
template <>
inline constexpr auto enum_table<Affected> =
    enum_words<Affected, "values time rate scale mean noise N B K weights verdict">;

enum class Direction { unknown, too_small, too_large };
template <>
inline constexpr auto enum_table<Direction> = enum_words<Direction, "unknown too-small too-large">;

struct Finding {
  struct Effect {
    Affected quantity = Affected::noise;
    Direction direction = Direction::unknown;
    std::optional<double> factor = {};  ///< by which it is too large or too small, where known
    bool operator==(const Effect&) const = default;
  };
  /// An option of the library and its value, as text: "missing", "-999".
  struct Setting {
    std::string option, value;
    bool operator==(const Setting&) const = default;
  };
  /// What to do about it; `options` are those of the same call that do it, none where it is not done by options.
  struct Help {
    std::string sentence;
    std::vector<Setting> options = {};
    bool operator==(const Help&) const = default;
  };
  struct Place {
    std::vector<Interval> time_s, frequency_hz;  ///< from the first sample; of the spectrum
    std::vector<std::string> rows;               ///< the first three, e.g. "line 412"
    bool operator==(const Place&) const = default;
  };
  std::string code;  ///< stable key of its kind (finding_kinds), snake_case: "duplicate_timestamp"
  Severity severity = Severity::caution;
  std::string subject;   ///< channel or sensor; "": the recording, or the channel that has it
  std::string sentence;  ///< what was found and what was done about it, without the count
  std::string phrase;    ///< the same as a part of a sentence: "spikes were left out"
  std::uint64_t count = 1;
  Place where = {};
  std::vector<Effect> effects = {};
  std::vector<Help> help = {};
  bool operator==(const Finding&) const = default;
};

/// What is known of all findings of one code (finding_kinds.cpp has the table).
struct FindingKind {
  std::string_view code;
  Severity severity = Severity::caution;
  std::string_view title;    ///< a few words
  std::string_view meaning;  ///< what was seen and what it does to the numbers
  std::string_view remedy;   ///< what to do; "" where there is nothing to do
  std::vector<Finding::Effect> effects = {};
};

std::span<const FindingKind> finding_kinds();
/// Null: there is no such code.
const FindingKind* find_finding_kind(std::string_view code);

/// Severity and effects as the code's kind says. `phrase` is made of the sentence when empty.
Finding finding(std::string_view code, std::string sentence, std::string phrase = "");

/// That of the worst; note where there is none.
Severity worst_of(std::span<const Finding> findings);
bool has(std::span<const Finding> findings, std::string_view code);
/// The worst first, in the order in which they were made otherwise.
std::vector<Finding> worst_first(std::vector<Finding> findings);

/// A sentence as a part of another: its first letter small, no full stop.
std::string as_part(const std::string& sentence);

/// " (`still` auto)": its options in a sentence; "" where it has none.
std::string settings_text(const Finding::Help& help);
/// Its sentence and what to do: "SENTENCE Use the longest still stretch (`still` auto)."
std::string with_help(const Finding& finding);
/// At most `most`, the worst first, one for each line, and how many more there are.
std::string findings_text(std::span<const Finding> findings, std::size_t most = 5, bool colours = false);
/// "3 × SENTENCE (first: line 412, line 413, line 9001)", control characters escaped.
std::string sentence_of(const Finding& finding);
namespace detail {
/// Cautions and bad ones of `from`, about the channel or sensor `subject`, each once.
void add_cautions(std::vector<Finding>& to, std::span<const Finding> from, const std::string& subject);
/// What a table of curves carries of a curve: "motion:bad event:caution", from cautions on; "" without any.
std::string findings_cell(std::span<const Finding> findings);
/// Its inverse, with the sentence that the code's kind has; other words are left out.
std::vector<Finding> findings_in_cell(std::string_view cell);
/// " Read it alone (`channels` temp).": what options do about it; "" where none does anything.
std::string help_of(const Finding& finding);
}  // namespace detail
/// "FILE: warning: 3 × SENTENCE (first: line 412, line 413, line 9001)", control characters escaped.
std::string one_line(const Finding& finding, std::string_view file, bool colours = false);

/// Counted findings of a reader, in the order in which their kinds first appeared.
class Findings {
 public:
  /// Counts `count` more cases of the kind `code`. The sentence of the first call for a code is kept.
  Finding& add(std::string_view code, std::string_view sentence, std::string_view place = {}, std::uint64_t count = 1);
  void merge(const Findings& other);
  /// What is no longer so.
  void remove(std::string_view code);
  const std::vector<Finding>& list() const { return list_; }
  bool empty() const { return list_.empty(); }
  const Finding* find(std::string_view code) const;

 private:
  Finding& entry(std::string_view code, std::string_view sentence);
  std::vector<Finding> list_;
};

}  // namespace libchar
