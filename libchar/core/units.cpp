#include "libchar/core/units.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <unordered_map>

#include "libchar/core/text/decimal.hpp"

namespace libchar {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kGravity = 9.80665;  // standard gravity, m/s^2 (CGPM 1901)

struct UnitRow {
  const char* symbol;
  Quantity quantity;
  double to_si;
  const char* spellings;  // separated by '|', in the normal form of `normal`
};

const std::array kUnits = {
    UnitRow{"rad/s", Quantity::angular_rate, 1,
            "rad/s|rads/s|rads/sec|radians/s|radian/s|radians/sec|rads-1|rad/sec|radps|rads^-1"},
    UnitRow{"mrad/s", Quantity::angular_rate, 1e-3, "mrad/s|mrads-1|mrads^-1"},
    UnitRow{"deg/s", Quantity::angular_rate, kDegree,
            "deg/s|°/s|dps|degs-1|deg/sec|degs/s|degs/sec|°/sec|degree/s|degrees/s|degrees/sec|°s-1|°s^-1|degs^-1"},
    UnitRow{"mdeg/s", Quantity::angular_rate, 1e-3 * kDegree, "mdeg/s|mdps|m°/s"},
    UnitRow{"deg/h", Quantity::angular_rate, kDegree / 3600,
            "deg/h|°/h|dph|deg/hr|°/hr|deg/hour|°/hour|degree/h|degrees/h|degrees/hour|degh-1|degh^-1"},
    UnitRow{"rpm", Quantity::angular_rate, std::numbers::pi / 30, "rpm|r/min"},
    UnitRow{"m/s²", Quantity::acceleration, 1, "m/s2|m/s^2|ms-2|ms^-2|m/s/s|m/ss|m/sec2|m/sec^2|mps2"},
    UnitRow{"mm/s²", Quantity::acceleration, 1e-3, "mm/s2|mm/s^2"},
    UnitRow{"g", Quantity::acceleration, kGravity, "g|g0|gn|gee"},
    UnitRow{"mg", Quantity::acceleration, 1e-3 * kGravity, "mg|mgee"},
    UnitRow{"µg", Quantity::acceleration, 1e-6 * kGravity, "µg|ug|μg"},
    UnitRow{"Gal", Quantity::acceleration, 1e-2, "gal|cm/s2|cm/s^2"},
    UnitRow{"T", Quantity::magnetic_field, 1, "t|tesla"},
    UnitRow{"mT", Quantity::magnetic_field, 1e-3, "mt"},
    UnitRow{"µT", Quantity::magnetic_field, 1e-6, "µt|ut|μt|utesla"},
    UnitRow{"nT", Quantity::magnetic_field, 1e-9, "nt"},
    UnitRow{"Gauss", Quantity::magnetic_field, 1e-4, "gauss|gs|ga"},
    UnitRow{"mGauss", Quantity::magnetic_field, 1e-7, "mgauss|mgs"},
    UnitRow{"Pa", Quantity::pressure, 1, "pa"},
    UnitRow{"hPa", Quantity::pressure, 100, "hpa|mbar"},
    UnitRow{"kPa", Quantity::pressure, 1000, "kpa"},
    UnitRow{"bar", Quantity::pressure, 1e5, "bar"},
    UnitRow{"°C", Quantity::temperature, 1, "°c|degc|℃|celsius|c|degreesc|deg_c"},
    UnitRow{"K", Quantity::temperature, 1, "k|kelvin"},
    UnitRow{"°F", Quantity::temperature, 5.0 / 9, "°f|degf|fahrenheit"},
    UnitRow{"V", Quantity::voltage, 1, "v|volt|volts"},
    UnitRow{"mV", Quantity::voltage, 1e-3, "mv"},
    UnitRow{"µV", Quantity::voltage, 1e-6, "µv|uv|μv"},
    UnitRow{"deg", Quantity::angle, kDegree, "deg|°|degree|degrees"},
    UnitRow{"rad", Quantity::angle, 1, "rad"},
    UnitRow{"s", Quantity::time, 1, "s|sec|second|seconds"},
    UnitRow{"ms", Quantity::time, 1e-3, "ms|msec|milliseconds"},
    UnitRow{"µs", Quantity::time, 1e-6, "us|µs|μs|usec|microseconds"},
    UnitRow{"ns", Quantity::time, 1e-9, "ns|nsec|nanoseconds"},
    UnitRow{"min", Quantity::time, 60, "min|minutes"},
    UnitRow{"h", Quantity::time, 3600, "h|hr|hour|hours"},
    UnitRow{"day", Quantity::time, 86400, "day|days"},
    UnitRow{"Hz", Quantity::frequency, 1, "hz"},
    UnitRow{"kHz", Quantity::frequency, 1e3, "khz"},
    UnitRow{"MHz", Quantity::frequency, 1e6, "mhz"},
    UnitRow{"ppm", Quantity::concentration, 1e-6, "ppm"},
    UnitRow{"ppb", Quantity::concentration, 1e-9, "ppb"},
    UnitRow{"µg/m³", Quantity::concentration, 1, "µg/m3|ug/m3|μg/m3|ug/m^3"},
    UnitRow{"%", Quantity::ratio, 1e-2, "%|percent|%rh"},
    UnitRow{"1", Quantity::ratio, 1, "1|-|none"},
};

// Signs outside ASCII at the front of `text` and what they stand for.
std::optional<std::pair<std::string_view, std::string_view>> plain_sign(std::string_view text) {
  static constexpr std::pair<std::string_view, std::string_view> kSigns[] = {
      {"·", ""}, {"⋅", ""}, {"⁻", "-"}, {"−", "-"}, {"¹", "1"}, {"²", "2"}, {"³", "3"}, {"º", "°"}};
  if (static_cast<unsigned char>(text.front()) < 0x80) return std::nullopt;
  for (const auto& sign : kSigns)
    if (text.starts_with(sign.first)) return sign;
  return std::nullopt;
}

// Lower case, blanks, '*' and '·' dropped, raised digits lowered: "rad s^-1", "Rad·s⁻¹", "rad*s-1",
// "rad.s-1", "rad_s^-1" and "rad/(s)" are the same.
std::string normal(std::string_view text) {
  std::string out;
  const bool divided = text.find("/(") != std::string_view::npos, raised = text.find("^-") != std::string_view::npos;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (c == ' ' || c == '*' || (divided && (c == '(' || c == ')')) || (raised && c == '_')) continue;
    if (c == '.' && !out.empty() && text.substr(i + 1).starts_with('s')) continue;
    if (const auto plain = plain_sign(text.substr(i))) {
      out += plain->second;
      i += plain->first.size() - 1;
      continue;
    }
    out += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return out;
}

// "MT" is no millitesla and "mHz" no megahertz: a factor of 1e9 is not guessed.
bool mistakes_prefix(std::string_view text, std::string_view symbol) {
  const bool word = symbol == "min" || symbol.starts_with("m/") || text.starts_with("Milli");
  return !word && ((text.front() == 'M' && symbol.front() == 'm') || (text.front() == 'm' && symbol.front() == 'M'));
}

const UnitRow* row_of_spelling(const std::string& wanted) {
  static const std::unordered_map<std::string_view, const UnitRow*> rows = [] {
    std::unordered_map<std::string_view, const UnitRow*> out;
    for (const UnitRow& row : kUnits)
      for (std::string_view rest = row.spellings; !rest.empty();) {
        const std::size_t bar = std::min(rest.find('|'), rest.size());
        out.emplace(rest.substr(0, bar), &row);
        rest.remove_prefix(std::min(bar + 1, rest.size()));
      }
    return out;
  }();
  const auto found = rows.find(wanted);
  return found == rows.end() ? nullptr : found->second;
}

// "1/16.4 deg/s", "0.05 deg/s": a factor, a blank, a unit.
std::optional<Unit> with_factor(std::string_view text) {
  const auto counts = count_unit(text);
  if (!counts) return std::nullopt;
  auto unit = find_unit(counts->unit);
  unit->to_si *= counts->factor;
  unit->symbol = std::string(text.substr(0, text.find(' '))) + " " + unit->symbol;
  return unit;
}

}  // namespace

std::optional<Unit> find_unit(std::string_view text) {
  constexpr std::size_t kLongest = 1024;  // of a name in a log
  if (text.size() > kLongest) return std::nullopt;
  const std::string wanted = normal(text);
  if (wanted.empty()) return std::nullopt;
  // "T" (tesla) against "t", "G" (gauss) against "g", "mT"/"MT": only the spellings in the table are accepted, and a
  // lone capital G is refused because half the field means gauss by it and the other half gravity.
  if (text == "G" || text == "M" || text == "t") return std::nullopt;
  const UnitRow* row = row_of_spelling(wanted);
  if (row != nullptr && !mistakes_prefix(text.substr(text.find_first_not_of(' ')), row->symbol))
    return Unit{row->symbol, row->quantity, row->to_si};
  return with_factor(text);
}

std::optional<double> parse_factor(std::string_view text) {
  const std::size_t slash = text.find('/');
  const auto numerator = parse_double(text.substr(0, slash));
  const auto denominator = slash == std::string_view::npos ? std::optional(1.0) : parse_double(text.substr(slash + 1));
  if (!numerator || !denominator || *denominator == 0 || *numerator == 0) return std::nullopt;
  const double factor = *numerator / *denominator;
  return std::isfinite(factor) && factor != 0 ? std::optional(factor) : std::nullopt;
}

std::optional<CountUnit> count_unit(std::string_view text) {
  const std::size_t blank = text.find(' ');
  if (blank == std::string_view::npos || blank == 0) return std::nullopt;
  const auto factor = parse_factor(text.substr(0, blank));
  const std::size_t unit = text.find_first_not_of(' ', blank);
  if (!factor || unit == std::string_view::npos || !find_unit(text.substr(unit))) return std::nullopt;
  if (count_unit(text.substr(unit))) return std::nullopt;  // two numbers are a slip
  return CountUnit{*factor, std::string(text.substr(unit))};
}

bool dimensionless(std::string_view unit) {
  const auto known = find_unit(unit);
  return known && known->quantity == Quantity::ratio && known->symbol == "1";
}

std::vector<HabitualValue> habitual_units(std::string_view term, std::string_view unit_text) {
  const auto unit = find_unit(unit_text);
  if (!unit) return {};
  const double si = unit->to_si;
  const double root2 = std::numbers::sqrt2, hour = 3600, root_hour = 60;
  const double floor_of_b = std::sqrt(2 * std::numbers::ln2 / std::numbers::pi);
  if (unit->quantity == Quantity::angular_rate) {
    const double deg = si / kDegree;  // channel unit -> deg/s
    if (term == "white_noise")
      return {{deg * root_hour, "deg/√h", "angle random walk"},
              {deg * root2, "deg/s/√Hz", "noise density", Reading::one_sided},
              {si, "rad/s/√Hz", "noise density of Kalibr and kin", Reading::two_sided}};
    if (term == "bias_instability")
      return {{deg * hour, "deg/h", "bias instability B"},
              {deg * hour * floor_of_b, "deg/h", "0.664·B", Reading::floor}};
    if (term == "random_walk")
      return {{deg * hour * root_hour, "deg/h/√h", "rate random walk"},
              {si, "rad/s²/√Hz", "bias random walk of Kalibr and kin", Reading::two_sided}};
    if (term == "quantization") return {{deg * hour, "arcsec", "quantization (angle)"}};
    if (term == "rate_ramp") return {{deg * hour * hour, "deg/h/h", "rate ramp"}};
  }
  if (unit->quantity == Quantity::acceleration) {
    const double g = si / kGravity;
    if (term == "white_noise")
      return {{si * root_hour, "m/s/√h", "velocity random walk"},
              {g * 1e6 * root2, "µg/√Hz", "noise density", Reading::one_sided},
              {si, "m/s²/√Hz", "noise density of Kalibr and kin", Reading::two_sided}};
    if (term == "bias_instability")
      return {{g * 1e6, "µg", "bias instability B"}, {g * 1e6 * floor_of_b, "µg", "0.664·B", Reading::floor}};
    if (term == "random_walk")
      return {{g * 1e6 * root_hour, "µg/√h", "acceleration random walk"},
              {si, "m/s³/√Hz", "bias random walk of Kalibr and kin", Reading::two_sided}};
    if (term == "quantization") return {{si, "m/s", "quantization (velocity)"}};
    if (term == "rate_ramp") return {{g * 1e6 * hour, "µg/h", "acceleration ramp"}};
  }
  if (term == "white_noise") return {{root2, unit->symbol + "/√Hz", "noise density", Reading::one_sided}};
  if (term == "bias_instability") return {{floor_of_b, unit->symbol, "0.664·B", Reading::floor}};
  return {};
}

std::string term_unit(std::string_view term, std::string_view unit) {
  std::string u(unit.empty() ? "U" : unit);
  // "1/16.4 deg/s·√s" would read as something else.
  if (u.find(' ') != std::string::npos && u.front() != '(' && term != "bias_instability") u = "(" + u + ")";
  if (term == "white_noise") return u + "·√s";
  if (term == "random_walk") return u + "/√s";
  if (term == "quantization") return u + "·s";
  if (term == "rate_ramp") return u + "/s";
  return u;
}

std::string shown_unit(std::string_view unit) {
  if (unit.empty()) return "U";
  return dimensionless(unit) ? "" : std::string(unit);
}

std::string shown_term_unit(std::string_view term, std::string_view unit) {
  if (!dimensionless(unit)) return term_unit(term, unit);
  const std::string u = term_unit(term, "1");
  if (u == "1") return "";
  return u.starts_with("1·") ? u.substr(std::string_view("1·").size()) : u;
}

std::optional<double> unit_factor(std::string_view from, std::string_view to) {
  const auto x = find_unit(from), y = find_unit(to);
  if (!x || !y) return 1;
  if (x->quantity != y->quantity) return std::nullopt;
  return x->to_si / y->to_si;
}

namespace {

// What stands behind a number in front: one count of it has the zero of the unit itself.
std::string without_count(std::string_view text, const Unit& unit) {
  const auto count = count_unit(text);
  const auto plain = count ? find_unit(count->unit) : std::nullopt;
  return plain ? plain->symbol : unit.symbol;
}

bool is_share(std::string_view symbol) { return symbol == "ppm" || symbol == "ppb"; }

}  // namespace

std::optional<double> Unit::sample_factor(std::string_view from, std::string_view to) {
  if (from == to || from.empty() || to.empty()) return 1;
  const auto x = find_unit(from), y = find_unit(to);
  if (!x || !y || x->quantity != y->quantity) return std::nullopt;
  const std::string a = without_count(from, *x), b = without_count(to, *y);
  if (x->quantity == Quantity::temperature && a != b) return std::nullopt;
  if (x->quantity == Quantity::concentration && is_share(a) != is_share(b)) return std::nullopt;
  return x->to_si == y->to_si ? 1 : x->to_si / y->to_si;
}

detail::DifferencedUnit detail::differenced_unit(const std::string& unit) {
  const auto known = find_unit(unit);
  if (known && known->quantity == Quantity::time) return {"1", known->to_si};
  return {unit.empty() ? "" : unit + "/s", 1};
}

}  // namespace libchar
