#include "libchar/core/text/shown.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/units.hpp"

namespace libchar::detail {

std::string frequency_text(double hz, int digits) {
  struct {
    double below, unit;
    const char* symbol;
  } constexpr kSizes[] = {{1e-7, 1e-9, "nHz"}, {1e-4, 1e-6, "µHz"}, {0.1, 1e-3, "mHz"},
                          {1e5, 1, "Hz"},      {1e7, 1e3, "kHz"},   {1e10, 1e6, "MHz"}};
  if (!std::isfinite(hz)) return "–";
  if (hz == 0) return "0 Hz";
  for (const auto& size : kSizes)
    if (std::fabs(hz) < size.below) return brief_text(hz / size.unit, digits) + " " + size.symbol;
  return brief_text(hz / 1e9, digits) + " GHz";
}

std::string plus_minus_text(double value, double half_width) {
  if (!std::isfinite(value) || !(half_width > 0) || !std::isfinite(half_width)) return number_text(value);
  // Where the larger of the two is written with a power of ten, both have that one.
  const double larger = std::max(std::fabs(value), half_width);
  const bool power = number_text(larger, digits_for(half_width / larger)).find("×") != std::string::npos;
  const int exponent = clamped_whole(std::floor(std::log10(larger)), -400, 400);
  const double unit = power ? std::pow(10.0, exponent) : 1;
  const int decimals = std::max(0, 1 - clamped_whole(std::floor(std::log10(half_width / unit)), -9, 9));
  const std::string both = fmt::format("{:.{}f} ± {:.{}f}", value / unit, decimals, half_width / unit, decimals);
  return power ? "(" + both + ")×" + power_of_ten(exponent) : both;
}

std::string usual_unit(const std::string& unit) {
  const auto known = find_unit(unit);
  return known && known->symbol != "1" ? std::string(known->symbol) : unit;
}

}  // namespace libchar::detail
