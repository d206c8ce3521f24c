#pragma once
// What is shown of a noise coefficient, made in one place: value and interval in the channel's unit and in the field's,
// each with what the unit leaves open, and status. Tables, pages, files and sentences only place it.

#include <string>
#include <vector>

#include "libchar/core/coefficient.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/core/text/text_table.hpp"
#include "libchar/core/units.hpp"

namespace libchar {

/// A coefficient in one unit.
struct ShownValue {
  std::string value;      ///< "0.2406", "≤ 0.0012", "–"; as many digits as its interval supports
  std::string low, high;  ///< of the 95 % interval, "no end" for infinity; "" where none is known
  std::string unit;       ///< "" for a number without
  Reading reading = Reading::plain;
  std::string name;  ///< of the field, "angle random walk"; "" in the channel's unit
};

struct TermCells {
  Term term = Term::white;
  std::string title, letter;      ///< "Angle random walk", "N"; of a clock "White frequency", "N"
  ShownValue own;                 ///< in the channel's unit
  std::vector<ShownValue> field;  ///< in the field's units; empty where there is nothing to say
  Status status = Status::not_fitted;
  /// Standard deviation and Cramér–Rao bound, "±0.37 %"; record length at which the bound is 10 %,
  /// "42 min". "" where not known.
  std::string known_to, best_possible, length_for_10_percent;
};

/// `unit`: of the channel, as it is to be shown. A clock's terms have a clock's words.
TermCells term_cells(const Coefficient& coefficient, Term term, const std::string& unit, bool clock = false);

/// Its standard deviation, "±0.37 %"; "" where it has none.
std::string known_to(const Coefficient& coefficient);

/// A coefficient times `factor` in `unit`.
ShownValue shown_value(const Coefficient& coefficient, double factor, std::string unit);

/// In the field's unit where it has a word of its own for the term, else in the channel's.
const ShownValue& headline(const TermCells& cells);

namespace detail {
/// The unit of that headline, and what a coefficient in the channel's own unit is multiplied by.
HabitualValue headline_unit(Term term, const std::string& unit);
}  // namespace detail

/// "deg/s/√Hz one-sided", "deg/h floor".
std::string unit_with_reading(const ShownValue& shown);
/// "0.3403 deg/s/√Hz one-sided", of all in a row.
std::string said(const ShownValue& shown);
std::string said(const std::vector<ShownValue>& shown);
/// "[0.0121, 0.0125]"; "" without an interval.
std::string interval_brackets(const ShownValue& shown);

/// "not detected": without the underlines of files. A detected term whose interval includes 0 is "uncertain".
std::string status_words(Status status);
std::string status_words(const Coefficient& coefficient);
namespace detail {
bool reaches_zero(const Coefficient& coefficient);
}
Tint tint_of(Status status);

/// "White noise"; of a channel in `unit`: "Angle random walk" of an angular rate, "Velocity random
/// walk" of an acceleration.
std::string term_title(Term term, const std::string& unit = "");

}  // namespace libchar
