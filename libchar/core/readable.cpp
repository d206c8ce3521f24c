#include "libchar/core/readable.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/decimal.hpp"

namespace libchar {
namespace {

std::string superscript(int exponent) {
  static constexpr const char* kDigits[] = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string out = exponent < 0 ? "⁻" : "";
  for (const char c : fmt::format("{}", std::abs(exponent))) out += kDigits[c - '0'];
  return out;
}

int digits_of(const Coefficient& c) {
  const double value = c.value.value_or(0);
  return value > 0 ? digits_for((c.ci95.high - c.ci95.low) / (4 * value)) : 3;
}

}  // namespace

std::string number_text(double value, int digits) {
  if (!std::isfinite(value)) return "–";
  if (value == 0) return "0";
  const std::string scientific = fmt::format("{:.{}e}", value, digits - 1);
  const std::size_t e = scientific.find('e');
  const int exponent = std::stoi(scientific.substr(e + 1));
  if (exponent < -3 || exponent > std::max(digits, 5)) {
    return scientific.substr(0, e) + "×10" + superscript(exponent);
  }
  return fmt::format("{:.{}f}", value, std::max(0, digits - 1 - exponent));
}

std::string significant_or_dash(double value, int digits) {
  return std::isfinite(value) ? significant(value, digits) : "–";
}

int digits_for(double relative_uncertainty) {
  if (!(relative_uncertainty > 0)) return 4;
  // Clamped before it is an int: an uncertainty may be infinite.
  return static_cast<int>(std::clamp(1 - std::floor(std::log10(relative_uncertainty)), 2.0, 6.0));
}

std::string duration_text(double seconds) {
  if (!std::isfinite(seconds)) return "–";
  if (seconds == 0) return "0 s";
  const double size = std::fabs(seconds);
  if (size < 1e-3) return number_text(seconds * 1e6, 3) + " µs";
  if (size < 1) return number_text(seconds * 1e3, 3) + " ms";
  if (size < 120) return number_text(seconds, 3) + " s";
  if (size < 7200) return number_text(seconds / 60, 3) + " min";
  if (size < 172800) return number_text(seconds / 3600, 3) + " h";
  if (size < 2 * 365.25 * 86400) return number_text(seconds / 86400, 3) + " d";
  return number_text(seconds / (365.25 * 86400), 3) + " years";
}

std::string place_text(double seconds) {
  return std::fabs(seconds) < 1e6 ? fmt::format("{:.6g}", seconds) : fmt::format("{:.0f}", seconds);
}

std::string value_text(const Coefficient& c, double factor) {
  if (c.value) return number_text(*c.value * factor, digits_of(c));
  if (c.upper95) return "≤ " + number_text(*c.upper95 * factor, 3);
  return "–";
}

std::string coefficient_text(const Coefficient& c, double factor) {
  if (!c.value) return value_text(c, factor);
  const int digits = digits_of(c);
  return fmt::format("{} [{}, {}]",
                     number_text(*c.value * factor, digits),
                     number_text(c.ci95.low * factor, digits),
                     number_text(c.ci95.high * factor, digits));
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

std::string nanoseconds_text(double ns) {
  if (!std::isfinite(ns)) return "–";
  if (ns < 1e3) return significant(ns, 3) + " ns";
  return ns < 1e6 ? significant(ns / 1e3, 3) + " µs" : significant(ns / 1e6, 3) + " ms";
}

std::string bytes_text(const std::optional<std::uint64_t>& bytes) {
  if (!bytes) return "–";
  const auto value = static_cast<double>(*bytes);
  if (value < 1e4) return fmt::format("{} B", *bytes);
  return value < 1e6 ? significant(value / 1e3, 3) + " kB" : significant(value / 1e6, 3) + " MB";
}

std::string error_text(double value, const std::string& unit) {
  if (!std::isfinite(value)) return "–";
  return significant(value, 4) + (unit.empty() ? "" : " " + unit);
}

}  // namespace libchar
