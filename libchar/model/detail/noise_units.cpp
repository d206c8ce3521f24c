// A unit text is a base (an angle, an angular rate, a speed, an acceleration, or the channel's own
// unit) and factors of time behind it: "/√Hz", "/√h", "·√s", "/s". With every base written as
//   factor * quantity * s^e
// the term's unit has the exponent of the channel's unit plus 1/2 (white noise), 0 (bias
// instability), -1/2 (random walk), 1 (quantization), -1 (ramp): docs/models.md.
#include "libchar/model/detail/noise_units.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libchar/core/units.hpp"

namespace libchar {
namespace {

enum class Family { angular, linear, own };

struct Base {
  Family family = Family::own;
  double si = 1;
  double exponent = 0;  ///< of the second
};

std::optional<Base> base_of(std::string_view text) {
  if (text == "arcsec" || text == "″") return Base{Family::angular, std::numbers::pi / 648000, 0};
  if (text == "m") return Base{Family::linear, 1, 0};
  if (text == "m/s") return Base{Family::linear, 1, -1};
  const auto unit = find_unit(text);
  if (!unit) return std::nullopt;
  switch (unit->quantity) {
    case Quantity::angle:
      return Base{Family::angular, unit->to_si, 0};
    case Quantity::angular_rate:
      return Base{Family::angular, unit->to_si, -1};
    case Quantity::acceleration:
      return Base{Family::linear, unit->to_si, -2};
    default:
      return std::nullopt;
  }
}

struct Factor {
  double si = 1;
  double exponent = 0;
  bool hertz = false;
};

bool eat(std::string_view& text, std::string_view what) {
  if (!text.starts_with(what)) return false;
  text.remove_prefix(what.size());
  return true;
}

// "Hz", "h", "hr", "hour", "min", "s", "sec": seconds and the exponent of the second.
std::optional<Factor> time_unit(std::string_view& text) {
  if (eat(text, "Hz") || eat(text, "hz")) return Factor{1, -1, true};
  for (const char* word : {"hours", "hour", "hr", "h"})
    if (eat(text, word)) return Factor{3600, 1, false};
  if (eat(text, "min")) return Factor{60, 1, false};
  for (const char* word : {"sec", "s"})
    if (eat(text, word)) return Factor{1, 1, false};
  return std::nullopt;
}

// One of "/√Hz", "·√s", "/sqrt(h)", "/s", "/s^2", "/s²", "/rtHz", "/Hz^0.5".
std::optional<Factor> time_factor(std::string_view& text) {
  double power = 1;
  if (eat(text, "/")) {
    power = -1;
  } else if (!eat(text, "·") && !eat(text, "⋅") && !eat(text, "*") && !eat(text, ".")) {
    return std::nullopt;
  }
  const bool bracket = eat(text, "sqrt(") || eat(text, "√(");
  const bool root =
      bracket || eat(text, "√") || eat(text, "sqrt") || eat(text, "rt") || eat(text, "root");
  auto factor = time_unit(text);
  if (!factor || (bracket && !eat(text, ")"))) return std::nullopt;
  if (root) {
    power /= 2;
  } else if (eat(text, "^0.5") || eat(text, "^(1/2)") || eat(text, "^.5")) {
    power /= 2;
  } else if (eat(text, "^2") || eat(text, "²") || eat(text, "2")) {
    power *= 2;
  } else if (eat(text, "^3") || eat(text, "³") || eat(text, "3")) {
    power *= 3;
  }
  return Factor{std::pow(factor->si, power), factor->exponent * power, factor->hertz};
}

std::optional<Factor> time_factors(std::string_view text) {
  Factor all;
  while (!text.empty()) {
    const auto one = time_factor(text);
    if (!one) return std::nullopt;
    all.si *= one->si;
    all.exponent += one->exponent;
    all.hertz = all.hertz || one->hertz;
  }
  return all;
}

constexpr std::array<double, kTerms> kExponent = {0.5, 0, -0.5, 1, -1};

std::string without_blanks(std::string_view text) {
  std::string out;
  for (const char c : text)
    if (c != ' ') out += c;
  return out;
}

// "(rad/s)/√Hz" is "rad/s/√Hz".
std::string without_bracket(std::string text) {
  if (!text.starts_with('(')) return text;
  const std::size_t close = text.find(')');
  if (close == std::string::npos) return text;
  return text.substr(1, close - 1) + text.substr(close + 1);
}

bool near(double a, double b) {
  return std::abs(a - b) < 1e-9;
}

// The longest base in front whose rest is made of factors of time and gives the wanted exponent.
std::optional<NoiseUnit> by_prefix(std::string_view text, const Base& channel, double wanted) {
  for (std::size_t length = text.size(); length > 0; --length) {
    const auto base = base_of(text.substr(0, length));
    if (!base || base->family != channel.family) continue;
    const auto rest = time_factors(text.substr(length));
    if (rest && near(base->exponent + rest->exponent, channel.exponent + wanted))
      return NoiseUnit{base->si * rest->si / channel.si, rest->hertz};
  }
  return std::nullopt;
}

std::optional<NoiseUnit> by_own_unit(std::string_view text, std::string_view unit, double wanted) {
  if (unit.empty() || !text.starts_with(unit)) return std::nullopt;
  const auto rest = time_factors(text.substr(unit.size()));
  if (!rest || !near(rest->exponent, wanted)) return std::nullopt;
  return NoiseUnit{rest->si, rest->hertz};
}

// Another unit of the same quantity in front: "mV/√Hz" for a channel in V.
std::optional<NoiseUnit> by_quantity(std::string_view text, std::string_view own, double wanted) {
  const auto channel = find_unit(own);
  if (!channel) return std::nullopt;
  for (std::size_t length = text.size(); length > 0; --length) {
    const auto unit = find_unit(text.substr(0, length));
    if (!unit || unit->quantity != channel->quantity) continue;
    const auto rest = time_factors(text.substr(length));
    if (rest && near(rest->exponent, wanted))
      return NoiseUnit{unit->to_si * rest->si / channel->to_si, rest->hertz};
  }
  return std::nullopt;
}

}  // namespace

std::optional<NoiseUnit> find_noise_unit(Term term,
                                         std::string_view raw,
                                         std::string_view channel_unit) {
  const std::string text = without_bracket(without_blanks(raw));
  const std::string own = without_blanks(channel_unit);
  const double wanted = kExponent[static_cast<std::size_t>(term)];
  for (const std::string& unit : {own, std::string("U")})
    if (const auto found = by_own_unit(text, unit, wanted)) return found;
  if (const auto found = by_quantity(text, channel_unit, wanted)) return found;
  const auto channel = base_of(channel_unit);
  return channel ? by_prefix(text, *channel, wanted) : std::nullopt;
}

std::vector<std::string> noise_unit_examples(Term term, std::string_view channel_unit) {
  const std::string key(kTermNames[static_cast<std::size_t>(term)].key);
  const std::string u(channel_unit.empty() ? "U" : channel_unit);
  std::vector<std::string> out;
  if (term == Term::white) out.push_back(u + "/√Hz");
  out.push_back(term_unit(key, u));
  for (const HabitualValue& habit : habitual_units(key, channel_unit))
    if (find_noise_unit(term, habit.symbol, channel_unit) &&
        std::find(out.begin(), out.end(), habit.symbol) == out.end())
      out.push_back(habit.symbol);
  return out;
}

}  // namespace libchar
