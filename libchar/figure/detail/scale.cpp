#include "libchar/figure/detail/scale.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/readable.hpp"

namespace libchar {
namespace {

// Less than this many times the lower end: the powers of ten are too few, and steps are even as on a linear axis.
constexpr double kFewTimes = 6;

double round_step(double least) {
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0})
    if (factor * power >= least * (1 - 1e-9)) return factor * power;
  return 10 * power;
}

std::string minus_sign(const std::string& text) { return text.starts_with('-') ? "−" + text.substr(1) : text; }

/// Of a double no power of ten lies further out.
int whole_power(double power) { return clamped_whole(power, -400, 400); }

int power_below(double value) { return whole_power(std::floor(std::log10(value) + 1e-9)); }

int digits_for_steps(double largest, double step) {
  if (!(largest > 0)) return 3;
  return std::clamp(1 + power_below(largest) - power_below(step), 1, 15);
}

std::vector<Tick> even_ticks(const FigureAxis& axis, double length, double apart) {
  std::vector<Tick> out;
  const double words = std::max(2.0, length / apart);
  const double step = round_step((axis.high - axis.low) / words);
  const int digits = digits_for_steps(std::max(std::fabs(axis.low), std::fabs(axis.high)), step);
  for (double k = std::ceil(axis.low / step - 1e-9); k * step <= axis.high + 1e-9 * step; ++k) {
    const double value = k == 0 ? 0 : k * step;
    out.push_back({value, minus_sign(brief_text(value, digits)), true});
    if (out.size() > 1000) break;  // an axis whose steps a double does not resolve
  }
  return out;
}

std::string decade_label(int exponent, bool plain) {
  return plain ? brief_text(std::pow(10.0, exponent), 1) : power_of_ten(exponent);
}

std::vector<Tick> log_ticks(const FigureAxis& axis, double length, double apart) {
  const double low = std::log10(axis.low), high = std::log10(axis.high), decades = high - low;
  const int each = std::max(1, whole_power(std::ceil(decades * apart / length)));
  const bool few = decades < 2.3 && length / decades > 3 * apart, fine = each == 1;
  const bool plain = low > -3.1 && high < 3.9;  // "0.001" to "1000", else powers throughout
  std::vector<Tick> out;
  for (int e = whole_power(std::floor(low)); e <= whole_power(std::ceil(high)); ++e)
    for (int d = 1; d < (fine ? 10 : 2); ++d) {
      const double value = d * std::pow(10.0, e), at = std::log10(value);
      if (at < low - 1e-9 || at > high + 1e-9) continue;
      const bool decade = d == 1, worded = (decade && e % each == 0) || (few && (d == 2 || d == 5));
      out.push_back({value, !worded ? "" : decade ? decade_label(e, plain) : brief_text(value, 1), decade});
    }
  return out;
}

}  // namespace

double PageScale::at(double value) const {
  if (log && !(value > 0)) return kNone;
  const double share = log ? std::log10(value / low) / std::log10(high / low) : (value - low) / (high - low);
  return from + (to - from) * share;
}

PageScale page_scale(const FigureAxis& axis, double from, double to) {
  return {axis.log, axis.low, axis.high, from, to};
}

std::vector<Tick> axis_ticks(const FigureAxis& axis, double length, double apart) {
  if (!axis.log || axis.high / axis.low < kFewTimes) return even_ticks(axis, length, apart);
  return log_ticks(axis, length, apart);
}

}  // namespace libchar
