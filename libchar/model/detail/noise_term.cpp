#include "libchar/model/detail/noise_term.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libchar/core/document/coefficient_fields.hpp"
#include "libchar/core/units.hpp"

namespace libchar {
namespace {

constexpr Word kReadings[] = {{"coefficient", 0}, {"floor", 1}};

struct TermText {
  const char* meaning;
  const char* curve;
};
constexpr std::array<TermText, kTerms> kTexts = {{
    {"white noise (angle or velocity random walk): root of the two-sided density", "Allan deviation value / sqrt(tau)"},
    {"bias instability: flicker (1/f) noise; not the minimum of the Allan curve", "Allan deviation 0.6643 value, flat"},
    {"random walk of the bias: root of its two-sided driving density", "Allan deviation value sqrt(tau / 3)"},
    {"quantization noise of the integrated output", "Allan deviation sqrt(3) value / tau"},
    {"rate ramp: a linear drift", "Allan deviation value tau / sqrt(2)"},
}};

std::size_t index_of(std::string_view key) {
  std::size_t t = 0;
  while (kTermNames[t].key != key) ++t;
  return t;
}

// Sidedness of every value that is written per √Hz.
enum class Density { unsaid, one, two };

Density density_of(const MapReader& at) {
  if (!at.has("density")) return Density::unsaid;
  return at.word("density", {"one-sided", "two-sided"}) == "one-sided" ? Density::one : Density::two;
}

double side_factor(const MapReader& at, std::string_view key, Density density) {
  if (density == Density::one) return 1 / std::numbers::sqrt2;
  if (density == Density::two) return 1;
  at.refuse(key, "a density is one-sided or two-sided, and this file does not say which",
            "add density: one-sided (data sheets) or density: two-sided, or give the unit per √h or in ·√s");
}

// What a coefficient is multiplied by to get the two-sided density in the channel's unit.
struct Conversion {
  double factor = 1;
  std::string sentence;  ///< empty when nothing was converted
};

Conversion conversion(const MapReader& at, std::string_view unit_key, std::size_t t,
                      const std::optional<std::string>& unit, const std::string& channel_unit, Density density,
                      bool floor) {
  const Term term = static_cast<Term>(t);
  const std::string own = term_unit(kTermNames[t].key, channel_unit);
  NoiseUnit understood;
  if (unit) {
    const auto found = find_noise_unit(term, *unit, channel_unit);
    if (!found)
      at.refuse(unit_key,
                fmt::format("is not a unit of {} for a channel in {}", kTermNames[t].key,
                            channel_unit.empty() ? "an unnamed unit" : channel_unit),
                fmt::format("such as {}", fmt::join(noise_unit_examples(term, channel_unit), ", ")));
    understood = *found;
  } else {
    understood.density = term == Term::white || term == Term::walk;
  }
  Conversion out{understood.factor, ""};
  std::vector<std::string> said;
  if (std::abs(understood.factor - 1) > 1e-15) said.push_back(fmt::format("{} to {}", *unit, own));
  if (understood.density) {
    out.factor *= side_factor(at, unit ? unit_key : kTermNames[t].key, density);
    if (density == Density::one) said.push_back("one-sided to two-sided density (divided by √2)");
  }
  if (floor) {
    out.factor /= std::sqrt(2 * std::numbers::ln2 / std::numbers::pi);
    said.push_back("floor of the Allan curve to coefficient (divided by 0.6643)");
  }
  if (!said.empty()) out.sentence = fmt::format("{}: converted from {}", kTermNames[t].key, fmt::join(said, ", "));
  return out;
}

void check_status(const MapReader& at, const Coefficient& c) {
  const bool needs = c.status == Status::detected || c.status == Status::given;
  if (needs && !c.value) at.refuse("value", fmt::format("a term that is {} has a value", name_of(c.status)));
  if (c.status == Status::not_detected && c.value)
    at.refuse("value", "a term that is not_detected has no value, only upper95");
  if (c.status == Status::not_fitted && c.value)
    at.refuse("value", "a term that is not_fitted has no value; status: given for one that is stated");
}

void apply(const MapReader& at, std::string_view key, const Conversion& conversion, Coefficient& c,
           SensorModel& model) {
  const bool open = std::isinf(c.ci95.high);  // the record gives no upper end
  if (c.value) *c.value *= conversion.factor;
  if (c.upper95) *c.upper95 *= conversion.factor;
  c.ci95.low *= conversion.factor;
  c.ci95.high *= conversion.factor;
  const double highest = open ? 0 : c.ci95.high;
  if (!std::isfinite(c.value.value_or(0)) || !std::isfinite(c.upper95.value_or(0)) || !std::isfinite(highest))
    at.refuse(key, "is out of range once it is converted to the channel's unit");
  if (!conversion.sentence.empty()) model.remarks.push_back(conversion.sentence);
}

// What the conversion reads for itself.
void read_later(const MapReader&, std::string_view, Coefficient&) {}
void write_nothing(const Field&, const Coefficient&, std::vector<Entry>&) {}

bool read_off_floor(const MapReader& at, Term term) {
  if (!at.has("reading") || at.word("reading", {"coefficient", "floor"}) != "floor") return false;
  if (term != Term::flicker) at.refuse("reading", "only bias_instability can be read off the floor of a curve");
  return true;
}

Entry word_entry(const char* key, std::span<const Word> words, int value) {
  Entry entry{key, std::string(word_of(words, value))};
  for (const Word& word : words)
    if (word.value == value) entry.comment = word.comment;
  entry.bare = true;
  return entry;
}

void write_interval(const Coefficient& c, std::vector<Entry>& out) {
  const bool known = c.value && (c.status != Status::given || c.ci95.high > 0);
  Entry ci95{"ci95"};
  if (known) ci95.value = std::vector<double>{c.ci95.low, c.ci95.high};
  // JSON leaves out what it cannot say.
  ci95.in_json = known && c.status != Status::given && std::isfinite(c.ci95.low) && std::isfinite(c.ci95.high);
  Entry by = word_entry("ci95_by", interval_words(), c.profile ? 1 : 0);
  by.in_json = ci95.in_json;
  out.push_back(std::move(ci95));
  if (known) out.push_back(std::move(by));
}

}  // namespace

const Fields<Coefficient>& term_fields() {
  static const Fields<Coefficient> rows = {
      field<&Coefficient::value>("value", {.range = kNotNegative, .meaning = "the coefficient"}),
      custom<Coefficient, read_later, write_nothing>(
          "unit", "text",
          {.meaning = "U·√s, U, U/√s, U·s, U/s, or as data sheets say: deg/√h, °/s/√Hz, mdps/√Hz, µg/√Hz, m/s/√h, "
                      "deg/h, rad/s²/√Hz, deg/h/√h, arcsec, mV/√Hz…"}),
      field<&Coefficient::upper95>("upper95",
                                   {.range = kNotNegative,
                                    .comment = "one-sided upper 95 % limit",
                                    .meaning = "upper limit of a term that was not detected (simulated as 0)"}),
      field<&Coefficient::ci95>(
          "ci95", {.range = kNotNegative, .meaning = "95 % interval; an upper end of null: no end known"}),
      field<&Coefficient::profile>("ci95_by", {.words = interval_words(), .meaning = "where the interval comes from"}),
      field<&Coefficient::status>("status",
                                  {.words = status_words(), .meaning = "how it is known", .otherwise = "given"}),
      custom<Coefficient, read_later, write_nothing>(
          "reading", "",
          {.words = kReadings,
           .meaning = "floor: read off the flat part of an Allan curve, 0.664·B",
           .otherwise = "coefficient"}),
  };
  return rows;
}

void read_term(const MapReader& top, std::string_view key, SensorModel& model) {
  const std::size_t t = index_of(key);
  Coefficient& c = model.noise[t];
  const Document* const node = top.get(key);
  if (node == nullptr) return;
  c.status = Status::given;
  const Density density = density_of(top);
  if (node->kind != Document::Kind::map) {
    c.value = top.number(key, kNotNegative);
    return apply(top, key,
                 conversion(top, key, t, std::nullopt, model.unit, *c.value == 0 ? Density::two : density, false), c,
                 model);
  }
  const MapReader at = top.map(key, keys_of(term_fields()));
  read_fields(term_fields(), at, c);
  check_status(at, c);
  const bool floor = read_off_floor(at, static_cast<Term>(t));
  if (!c.value && !c.upper95) return;
  std::optional<std::string> unit;
  if (at.has("unit")) unit = at.text("unit");
  const bool none = c.value.value_or(0) == 0 && c.upper95.value_or(0) == 0;
  apply(top, key, conversion(at, "unit", t, unit, model.unit, none ? Density::two : density, floor), c, model);
}

void write_term(const Field& row, const SensorModel& model, std::vector<Entry>& out) {
  const std::size_t t = index_of(row.key);
  const Coefficient& c = model.noise[t];
  const TermName& name = kTermNames[t];
  Entry term{std::string(row.key)};
  term.comment = fmt::format("{} in IEEE 952: {}; {}", name.letter, kTexts[t].meaning, kTexts[t].curve);
  term.form = Entry::Form::block;
  term.below = {{"value"}, {"unit", term_unit(name.key, model.unit.empty() ? "U" : model.unit)}};
  if (c.value) term.below[0].value = *c.value;
  write_interval(c, term.below);
  if (!c.value && c.upper95) term.below.push_back({"upper95", *c.upper95, "one-sided upper 95 % limit"});
  term.below.push_back(word_entry("status", status_words(), static_cast<int>(c.status)));
  out.push_back(std::move(term));
}

// A unit text is a base (an angle, an angular rate, a speed, an acceleration, or the channel's own
// unit) and factors of time behind it: "/√Hz", "/√h", "·√s", "/s". With every base written as
//   factor * quantity * s^e
// the term's unit has the exponent of the channel's unit plus 1/2 (white noise), 0 (bias
// instability), -1/2 (random walk), 1 (quantization), -1 (ramp): docs/models.md.

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
  const bool root = bracket || eat(text, "√") || eat(text, "sqrt") || eat(text, "rt") || eat(text, "root");
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

bool near(double a, double b) { return std::abs(a - b) < 1e-9; }

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
    if (rest && near(rest->exponent, wanted)) return NoiseUnit{unit->to_si * rest->si / channel->to_si, rest->hertz};
  }
  return std::nullopt;
}

}  // namespace

std::optional<NoiseUnit> find_noise_unit(Term term, std::string_view raw, std::string_view channel_unit) {
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
