#include "libchar/model/detail/noise_term.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "libchar/core/document/coefficient_fields.hpp"
#include "libchar/core/units.hpp"
#include "libchar/model/detail/noise_units.hpp"

namespace libchar {
namespace {

constexpr Word kReadings[] = {{"coefficient", 0}, {"floor", 1}};

struct TermText {
  const char* meaning;
  const char* curve;
};
constexpr std::array<TermText, kTerms> kTexts = {{
    {"white noise (angle or velocity random walk): root of the two-sided density",
     "Allan deviation value / sqrt(tau)"},
    {"bias instability: flicker (1/f) noise; not the minimum of the Allan curve",
     "Allan deviation 0.6643 value, flat"},
    {"random walk of the bias: root of its two-sided driving density",
     "Allan deviation value sqrt(tau / 3)"},
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
  return at.word("density", {"one-sided", "two-sided"}) == "one-sided" ? Density::one
                                                                       : Density::two;
}

double side_factor(const MapReader& at, std::string_view key, Density density) {
  if (density == Density::one) return 1 / std::numbers::sqrt2;
  if (density == Density::two) return 1;
  at.refuse(key,
            "a density is one-sided or two-sided, and this file does not say which",
            "add density: one-sided (data sheets) or density: two-sided, or give the unit per √h "
            "or in ·√s");
}

// What a coefficient is multiplied by to get the two-sided density in the channel's unit.
struct Conversion {
  double factor = 1;
  std::string sentence;  ///< empty when nothing was converted
};

Conversion conversion(const MapReader& at,
                      std::string_view unit_key,
                      std::size_t t,
                      const std::optional<std::string>& unit,
                      const std::string& channel_unit,
                      Density density,
                      bool floor) {
  const Term term = static_cast<Term>(t);
  const std::string own = term_unit(kTermNames[t].key, channel_unit);
  NoiseUnit understood;
  if (unit) {
    const auto found = find_noise_unit(term, *unit, channel_unit);
    if (!found)
      at.refuse(
          unit_key,
          fmt::format("is no unit of {} for a channel in {}",
                      kTermNames[t].key,
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
  if (!said.empty())
    out.sentence = fmt::format("{}: converted from {}", kTermNames[t].key, fmt::join(said, ", "));
  return out;
}

void check_status(const MapReader& at, const Coefficient& c) {
  const bool needs = c.status == Status::detected || c.status == Status::given;
  if (needs && !c.value)
    at.refuse("value", fmt::format("a term that is {} has a value", name_of(c.status)));
  if (c.status == Status::not_detected && c.value)
    at.refuse("value", "a term that is not_detected has no value, only upper95");
  if (c.status == Status::not_fitted && c.value)
    at.refuse("value",
              "a term that is not_fitted has no value; status: given for one that is stated");
}

void apply(const MapReader& at,
           std::string_view key,
           const Conversion& conversion,
           Coefficient& c,
           SensorModel& model) {
  if (c.value) *c.value *= conversion.factor;
  if (c.upper95) *c.upper95 *= conversion.factor;
  c.ci95.low *= conversion.factor;
  c.ci95.high *= conversion.factor;
  if (!std::isfinite(c.value.value_or(0)) || !std::isfinite(c.upper95.value_or(0)) ||
      !std::isfinite(c.ci95.high))
    at.refuse(key, "is out of range once it is converted to the channel's unit");
  if (!conversion.sentence.empty()) model.remarks.push_back(conversion.sentence);
}

// What the conversion reads for itself.
void read_later(const MapReader&, std::string_view, Coefficient&) {}
void write_nothing(const Field&, const Coefficient&, std::vector<Entry>&) {}

bool read_off_floor(const MapReader& at, Term term) {
  if (!at.has("reading") || at.word("reading", {"coefficient", "floor"}) != "floor") return false;
  if (term != Term::flicker)
    at.refuse("reading", "only bias_instability can be read off the floor of a curve");
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
  ci95.in_json =
      known && c.status != Status::given && std::isfinite(c.ci95.low) && std::isfinite(c.ci95.high);
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
          "unit",
          "text",
          {.meaning = "U·√s, U, U/√s, U·s, U/s, or as data sheets say: deg/√h, °/s/√Hz, mdps/√Hz, "
                      "µg/√Hz, m/s/√h, deg/h, rad/s²/√Hz, deg/h/√h, arcsec, mV/√Hz…"}),
      field<&Coefficient::upper95>(
          "upper95",
          {.range = kNotNegative,
           .comment = "one-sided upper 95 % limit",
           .meaning = "upper limit of a term that was not detected (simulated as 0)"}),
      field<&Coefficient::ci95>("ci95", {.range = kNotNegative, .meaning = "95 % interval"}),
      field<&Coefficient::profile>(
          "ci95_by", {.words = interval_words(), .meaning = "where the interval comes from"}),
      field<&Coefficient::status>(
          "status", {.words = status_words(), .meaning = "how it is known", .otherwise = "given"}),
      custom<Coefficient, read_later, write_nothing>(
          "reading",
          "",
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
    return apply(
        top,
        key,
        conversion(
            top, key, t, std::nullopt, model.unit, *c.value == 0 ? Density::two : density, false),
        c,
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
  apply(top,
        key,
        conversion(at, "unit", t, unit, model.unit, none ? Density::two : density, floor),
        c,
        model);
}

void write_term(const Field& row, const SensorModel& model, std::vector<Entry>& out) {
  const std::size_t t = index_of(row.key);
  const Coefficient& c = model.noise[t];
  const TermName& name = kTermNames[t];
  Entry term{std::string(row.key)};
  term.comment =
      fmt::format("{} in IEEE 952: {}; {}", name.letter, kTexts[t].meaning, kTexts[t].curve);
  term.form = Entry::Form::block;
  term.below = {{"value"}, {"unit", term_unit(name.key, model.unit.empty() ? "U" : model.unit)}};
  if (c.value) term.below[0].value = *c.value;
  write_interval(c, term.below);
  if (!c.value && c.upper95)
    term.below.push_back({"upper95", *c.upper95, "one-sided upper 95 % limit"});
  term.below.push_back(word_entry("status", status_words(), static_cast<int>(c.status)));
  out.push_back(std::move(term));
}

}  // namespace libchar
