#include "libchar/core/text/readable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/text/shown.hpp"

namespace libchar {
namespace {

/// Exponents of ten down to this are written as zeros: "0.00012".
constexpr int kLeastPlain = -4;

/// A decimal fraction's zeros at the end.
std::string without_zeros(std::string decimal) {
  if (decimal.find('.') == std::string::npos) return decimal;
  decimal.erase(decimal.find_last_not_of('0') + 1);
  if (decimal.back() == '.') decimal.pop_back();
  return decimal;
}

struct Scientific {
  std::string mantissa;
  int exponent = 0;
  bool power = false;  ///< to be written as one
};

/// `value` is finite.
Scientific scientific(double value, int digits) {
  const std::string text = fmt::format("{:.{}e}", value, digits - 1);
  const std::size_t e = text.find('e');
  const int exponent = std::stoi(text.substr(e + 1));
  return {text.substr(0, e), exponent, exponent < kLeastPlain || exponent > std::max(digits, 5)};
}

std::string written(double value, int digits, bool brief) {
  if (!std::isfinite(value)) return "–";
  if (value == 0) return "0";
  const Scientific s = scientific(value, digits);
  std::string decimal = s.power ? s.mantissa : fmt::format("{:.{}f}", value, std::max(0, digits - 1 - s.exponent));
  if (brief) decimal = without_zeros(std::move(decimal));
  return s.power ? decimal + "×" + power_of_ten(s.exponent) : decimal;
}

}  // namespace

std::string number_text(double value, int digits) { return written(value, digits, false); }

std::string end_text(double end, double of, int digits) {
  if (std::isinf(end)) return "no end";
  if (end == 0 || of == 0 || !std::isfinite(end) || !std::isfinite(of)) return number_text(end, digits);
  constexpr double kFar = 1000;  // beyond that the power of the value makes the end longer, not easier to compare
  if (std::abs(end) > kFar * std::abs(of)) return number_text(end, digits);
  const Scientific s = scientific(of, digits);
  // Where only the end would have a power, it has few digits of the value's.
  if (!s.power)
    return scientific(end, digits).power ? fmt::format("{:.{}f}", end, std::max(0, digits - 1 - s.exponent))
                                         : number_text(end, digits);
  return fmt::format("{:.{}f}×{}", end / std::pow(10.0, s.exponent), digits - 1, power_of_ten(s.exponent));
}

std::string brief_text(double value, int digits) { return written(value, digits, true); }

std::string power_of_ten(int exponent) {
  static constexpr const char* kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string out = exponent < 0 ? "10⁻" : "10";
  for (const char c : fmt::format("{}", std::abs(exponent))) out += kDigits[c - '0'];
  return out;
}

int digits_for(double relative_uncertainty) {
  if (!(relative_uncertainty > 0)) return 4;
  // Clamped before it is an int: an uncertainty may be infinite.
  return static_cast<int>(std::clamp(1 - std::floor(std::log10(relative_uncertainty)), 2.0, 6.0));
}

int digits_of(double value, const Interval& ci95) {
  return value > 0 ? digits_for((ci95.high - ci95.low) / (4 * value)) : 3;
}

int digits_of(const Coefficient& c) { return digits_of(c.value.value_or(0), c.ci95); }

std::string duration_text(double seconds, int digits) {
  if (!std::isfinite(seconds)) return "–";
  constexpr double kDay = 86400, kYear = 365.25 * kDay;
  struct {
    double below, unit;
    const char* symbol;
  } constexpr kSizes[] = {{1e-6, 1e-9, "ns"}, {1e-3, 1e-6, "µs"},    {1, 1e-3, "ms"},       {120, 1, "s"},
                          {7200, 60, "min"},  {2 * kDay, 3600, "h"}, {2 * kYear, kDay, "d"}};
  if (seconds == 0) return "0 s";
  for (const auto& size : kSizes)
    if (std::fabs(seconds) < size.below) return brief_text(seconds / size.unit, digits) + " " + size.symbol;
  return brief_text(seconds / kYear, digits) + " years";
}

std::string place_text(double seconds) {
  return std::fabs(seconds) < 1e6 ? brief_text(seconds, 6) : fmt::format("{:.0f}", seconds);
}

std::string percent_text(double share, int digits) {
  return std::isfinite(share) ? brief_text(100 * share, digits) + " %" : "–";
}

std::string excess_text(double share) {
  if (!std::isfinite(share)) return "–";
  if (share >= 1) return brief_text(1 + share) + " ×";
  // In hundredths of a per cent: a regret of 3e-7 is none.
  return fmt::format("{:.{}f} %", 100 * share, std::fabs(share) < 0.1 ? 2 : 1);
}

std::string interval_text(const Interval& interval, int digits, double factor) {
  if (std::isnan(interval.low) || std::isnan(interval.high)) return "–";
  const double low = interval.low * factor, high = interval.high * factor;
  return end_text(low, low, digits) + " … " + end_text(high, high, digits);
}

std::string value_text(const Coefficient& c, double factor) {
  if (c.value) return number_text(*c.value * factor, digits_of(c));
  if (c.upper95) return "≤ " + number_text(*c.upper95 * factor, 3);
  return "–";
}

std::string coefficient_text(const Coefficient& c, double factor) {
  if (!c.value) return value_text(c, factor);
  const int digits = digits_of(c);
  const double value = *c.value * factor;
  return fmt::format("{} [{}, {}]", number_text(value, digits), end_text(c.ci95.low * factor, value, digits),
                     end_text(c.ci95.high * factor, value, digits));
}

std::string count_text(std::uint64_t count) {
  std::string digits = fmt::format("{}", count);
  for (std::size_t at = digits.size(); at > 3;) {
    at -= 3;
    digits.insert(at, "\u202F");
  }
  return digits;
}

std::string probability_text(double p, int simulations) {
  if (simulations > 0 && p * (simulations + 1) < 1.5) return "p ≤ " + number_text(p, 1);
  return p < 1e-4 ? "p < 0.0001" : "p = " + number_text(p, 2);
}

std::string bytes_text(const std::optional<std::uint64_t>& bytes) {
  if (!bytes) return "–";
  const auto value = static_cast<double>(*bytes);
  if (value < 1e4) return fmt::format("{} B", *bytes);
  return value < 1e6 ? brief_text(value / 1e3) + " kB" : brief_text(value / 1e6) + " MB";
}

std::string error_text(double value, const std::string& unit) {
  if (!std::isfinite(value)) return "–";
  return brief_text(value, 4) + (unit.empty() ? "" : " " + detail::usual_unit(unit));
}

}  // namespace libchar
