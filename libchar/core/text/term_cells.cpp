#include "libchar/core/text/term_cells.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "libchar/core/text/readable.hpp"

namespace libchar {
namespace {

std::string plus_minus(double share) { return "±" + percent_text(share); }

// Longer ones are extrapolated by too much.
constexpr double kLongestLength_s = 3.2e8;

}  // namespace

ShownValue shown_value(const Coefficient& c, double factor, std::string unit) {
  ShownValue out;
  out.value = value_text(c, factor);
  out.unit = std::move(unit);
  if (!c.value || c.status == Status::given || !(c.ci95.high > 0)) return out;
  out.low = end_text(c.ci95.low * factor, *c.value * factor, digits_of(c));
  out.high = end_text(c.ci95.high * factor, *c.value * factor, digits_of(c));
  return out;
}

std::string known_to(const Coefficient& c) { return c.value && c.relative_sd > 0 ? plus_minus(c.relative_sd) : ""; }

TermCells term_cells(const Coefficient& c, Term term, const std::string& unit, bool clock) {
  constexpr const char* kOfClock[] = {"White frequency", "Flicker frequency", "Random-walk frequency", "White phase",
                                      "Frequency drift"};
  const TermName& name = kTermNames[static_cast<std::size_t>(term)];
  TermCells out;
  out.term = term;
  out.title = clock ? kOfClock[static_cast<std::size_t>(term)] : term_title(term, unit);
  out.letter = name.letter;
  out.own = shown_value(c, 1, shown_term_unit(name.key, unit));
  out.status = c.status;
  out.known_to = known_to(c);
  if (c.bound) out.best_possible = plus_minus(*c.bound);
  if (const auto& length = c.seconds_for_10_percent)
    out.length_for_10_percent = *length < kLongestLength_s ? duration_text(*length, 2) : "> 10 years";
  if (!c.value && !c.upper95) return out;
  for (const HabitualValue& habit : habitual_units(name.key, unit)) {
    out.field.push_back(shown_value(c, habit.factor, habit.symbol));
    out.field.back().reading = habit.reading;
    out.field.back().name = habit.name;
  }
  return out;
}

const ShownValue& headline(const TermCells& cells) {
  const bool own_word = !cells.field.empty() && cells.field.front().reading == Reading::plain;
  return own_word ? cells.field.front() : cells.own;
}

HabitualValue detail::headline_unit(Term term, const std::string& unit) {
  const std::string_view key = kTermNames[static_cast<std::size_t>(term)].key;
  const auto habits = habitual_units(key, unit);
  if (!habits.empty() && habits.front().reading == Reading::plain) return habits.front();
  return {1, shown_term_unit(key, unit), {}, Reading::plain};
}

std::string unit_with_reading(const ShownValue& shown) {
  const std::string unit = shown.unit == "1" ? "" : shown.unit;  // a ratio
  if (shown.reading == Reading::plain) return unit;
  return unit + (unit.empty() ? "" : " ") + std::string(name_of(shown.reading));
}

std::string said(const ShownValue& shown) {
  const std::string unit = unit_with_reading(shown);
  return shown.value + (unit.empty() ? "" : " " + unit);
}

std::string said(const std::vector<ShownValue>& shown) {
  std::string out;
  for (const ShownValue& one : shown) out += (out.empty() ? "" : ", ") + said(one);
  return out;
}

std::string interval_brackets(const ShownValue& shown) {
  return shown.low.empty() ? "" : fmt::format("[{}, {}]", shown.low, shown.high);
}

std::string status_words(Status status) {
  std::string out(name_of(status));
  std::replace(out.begin(), out.end(), '_', ' ');
  return out;
}

bool detail::reaches_zero(const Coefficient& c) { return c.status == Status::detected && !(c.ci95.low > 0); }

std::string status_words(const Coefficient& c) {
  return detail::reaches_zero(c) ? "uncertain" : status_words(c.status);
}

Tint tint_of(Status status) {
  if (status == Status::misfit) return Tint::bad;
  if (status == Status::undetermined) return Tint::doubtful;
  return status == Status::detected || status == Status::given ? Tint::good : Tint::absent;
}

std::string term_title(Term term, const std::string& unit) {
  const auto known = find_unit(unit);
  const bool rate = known && known->quantity == Quantity::angular_rate;
  const bool acceleration = known && known->quantity == Quantity::acceleration;
  switch (term) {
    case Term::white:
      return rate ? "Angle random walk" : acceleration ? "Velocity random walk" : "White noise";
    case Term::flicker:
      return "Bias instability";
    case Term::walk:
      return rate ? "Rate random walk" : acceleration ? "Acceleration random walk" : "Random walk";
    case Term::quantization:
      return "Quantization";
    case Term::ramp:
      return "Rate ramp";
  }
  return "";
}

}  // namespace libchar
