#include "libchar/figure/detail/figure_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/units.hpp"

namespace libchar {

bool above_zero(double value) { return std::isfinite(value) && value > 0; }

void Extent::take(double value) {
  if (!std::isfinite(value) || (log_ && !(value > 0))) return;
  low_ = std::min(low_, value);
  high_ = std::max(high_, value);
}

void Extent::take(std::span<const double> values) {
  for (const double value : values) take(value);
}

void Extent::pad(double factor_or_share) {
  if (empty()) return;
  if (log_) {
    low_ /= factor_or_share;
    high_ *= factor_or_share;
    return;
  }
  double reach = factor_or_share * (high_ - low_);
  if (!(reach > 0)) reach = high_ != 0 ? 0.1 * std::fabs(high_) : 1;
  low_ -= reach;
  high_ += reach;
}

void Extent::take_near(double value, const Extent& inner, double factor) {
  if (!above_zero(value) || inner.empty()) return;
  take(std::clamp(value, inner.low() / factor, inner.high() * factor));
}

std::pair<double, std::string> time_unit_for(double end_s) {
  constexpr double kHour = 3600, kDay = 86400;
  if (end_s > 4e5) return {kDay, "d"};
  if (end_s > 2e4) return {kHour, "h"};
  return {1, "s"};
}

void set_ends(FigureAxis& axis, const Extent& extent, const std::optional<Interval>& range) {
  // An open end is where the data end.
  axis.low = range && std::isfinite(range->low) ? range->low : extent.empty() ? 0.1 : extent.low();
  axis.high = range && std::isfinite(range->high) ? range->high : extent.empty() ? 10 : extent.high();
  if (axis.low < axis.high) return;
  Extent wider(axis.log);
  wider.take(axis.low);
  wider.pad(axis.log ? 3 : 0.1);
  axis.low = wider.low();
  axis.high = wider.high();
}

FigureLook series_look(std::size_t k) {
  constexpr FigureMarker kMarkers[] = {FigureMarker::circle,  FigureMarker::square, FigureMarker::triangle,
                                       FigureMarker::diamond, FigureMarker::down,   FigureMarker::cross};
  // Seven inks and five dashes have no common factor.
  return {.ink = static_cast<Ink>(k % kSeriesInks),
          .dash = k % 5,
          .width = 1.1,
          .marker = kMarkers[k % std::size(kMarkers)],
          .size = 1.7};
}

Ink term_ink(Term term) {
  constexpr Ink kInks[] = {Ink::green, Ink::purple, Ink::orange, Ink::sky, Ink::black};
  return kInks[static_cast<std::size_t>(term)];
}

std::size_t term_dash(Term term) { return 1 + static_cast<std::size_t>(term); }

FigureMarker term_marker(Term term) {
  constexpr FigureMarker kMarkers[] = {FigureMarker::diamond, FigureMarker::triangle, FigureMarker::square,
                                       FigureMarker::down, FigureMarker::cross};
  return kMarkers[static_cast<std::size_t>(term)];
}

std::string term_words(Term term) {
  const TermName& name = kTermNames[static_cast<std::size_t>(term)];
  std::string words(name.key);
  std::replace(words.begin(), words.end(), '_', ' ');
  return fmt::format("{} {}", words, name.letter);
}

// The end that is nearer to the last value comes first, so that a smooth line stays one.
void add_extremes(FigureSeries& series, double x, double low, double high) {
  series.x.push_back(x);
  if (low == high || !std::isfinite(low) || !std::isfinite(high)) {
    series.y.push_back(low);
    return;
  }
  series.x.push_back(x);
  const bool down = !series.y.empty() && std::fabs(series.y.back() - high) < std::fabs(series.y.back() - low);
  series.y.push_back(down ? high : low);
  series.y.push_back(down ? low : high);
}

std::string axis_title(const std::string& words, const std::string& unit) {
  return unit.empty() ? words : fmt::format("{} [{}]", words, unit);
}

bool is_wanted(const std::vector<std::string>& patterns, std::string_view name) {
  return patterns.empty() ||
         std::any_of(patterns.begin(), patterns.end(), [&](const auto& p) { return matches(p, name); });
}

void refuse_unmatched(const std::vector<std::string>& patterns, const std::vector<std::string>& names,
                      const std::string& file) {
  for (const std::string& pattern : patterns) {
    if (std::any_of(names.begin(), names.end(), [&](const auto& n) { return matches(pattern, n); })) continue;
    throw usage_error("E0977", file)
        .says("nothing has this name")
        .got(pattern)
        .hint(did_you_mean(nearest(pattern, names), "there are " + first_names(names)));
  }
}

Refusal kind_refusal(const FigureSource& source, std::string_view kind) {
  return usage_error("E0978", source.file).about(fmt::format("no figure `{}` can be drawn of it", kind));
}

FigureSeries line_series(const std::string& name, const std::vector<double>& x, const std::vector<double>& y,
                         const FigureLook& look) {
  FigureSeries out;
  out.name = name;
  out.x = x;
  out.y = y;
  out.look = look;
  return out;
}

std::string usual_figure_unit(const std::string& unit) {
  const auto known = find_unit(unit);
  return shown_unit(known && known->symbol != "1" ? known->symbol : unit);
}

}  // namespace libchar
