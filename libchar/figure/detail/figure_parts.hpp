#pragma once
// What the makers of figures share: ranges of axes, looks of series, which channels are meant.

#include <limits>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/noise_terms.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/figure/figure.hpp"
#include "libchar/figure/make_figure.hpp"

namespace libchar {

/// Smallest and largest of what was taken; on a logarithmic axis of what is above zero.
class Extent {
 public:
  explicit Extent(bool log) : log_(log) {}
  void take(double value);
  void take(std::span<const double> values);
  bool empty() const { return !(low_ <= high_); }
  double low() const { return low_; }
  double high() const { return high_; }
  /// Both ends moved outward: by the factor on a logarithmic axis, by that share of the length on a linear one.
  void pad(double factor_or_share);
  /// Takes the value moved to at most `factor` beyond the ends of `inner` (both logarithmic).
  void take_near(double value, const Extent& inner, double factor);

 private:
  bool log_;
  double low_ = std::numeric_limits<double>::infinity(),
         high_ = -std::numeric_limits<double>::infinity();
};

/// Sets the ends: the user's range, else the extent, else 0.1 to 10.
void set_ends(FigureAxis& axis, const Extent& extent, const std::optional<Interval>& range);

/// Colour, dash and marker of the k-th of many: no two of the first 35 alike.
FigureLook series_look(std::size_t k);
Ink term_ink(Term term);
std::size_t term_dash(Term term);
FigureMarker term_marker(Term term);
std::string term_words(Term term);

/// The smallest and the largest value of a stretch, one above the other: a record drawn so looks as
/// all its samples would.
void add_extremes(FigureSeries& series, double x, double low, double high);

FigureSeries line_series(const std::string& name,
                         const std::vector<double>& x,
                         const std::vector<double>& y,
                         const FigureLook& look);

/// "Error [rad/s]"; the words alone for a ratio.
std::string axis_title(const std::string& words, const std::string& unit);

/// No patterns: every name.
bool is_wanted(const std::vector<std::string>& patterns, std::string_view name);
/// Every pattern has to match one of the names, or Error(usage) says which there are.
void refuse_unmatched(const std::vector<std::string>& patterns,
                      const std::vector<std::string>& names,
                      const std::string& file);

/// Throws Error(usage): there is no such figure of this source.
Refusal kind_refusal(const FigureSource& source, std::string_view kind);

bool above_zero(double value);

/// "deg/s" for what means the same; "U" where there is none; "" for a ratio.
std::string usual_figure_unit(const std::string& unit);

}  // namespace libchar
