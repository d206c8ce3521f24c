#include "libchar/report/detail/tables/coefficients.hpp"

#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/units.hpp"
#include "libchar/fit/curve/power_laws.hpp"

namespace libchar {
namespace {

/// "N angle random walk": the letter of IEEE 952 and the field's name.
std::string letter_and_title(const TermCells& cells) {
  std::string title = cells.title;
  title[0] = static_cast<char>(title[0] - 'A' + 'a');
  return cells.letter + " " + title;
}

Cell field_cell(const std::vector<ShownValue>& field) {
  Cell out;
  for (const ShownValue& shown : field) {
    Cell& line = out.lines.emplace_back(shown.value);
    line.unit = unit_with_reading(shown);
    line.notes = {shown.name};
  }
  return out;
}

void add_term(Table& table, const Coefficient& c, Term term, const std::string& unit, bool clock) {
  const TermCells cells = term_cells(c, term, unit, clock);
  const std::string_view key = kTermNames[static_cast<std::size_t>(term)].key;
  Cell name(letter_and_title(cells));
  name.data = key;
  table.add({name, Cell::of(cells.own, c), Cell::shown("", c.upper95.value_or(kNone)), term_unit(key, unit),
             Cell::status(c), cells.known_to, cells.best_possible, cells.length_for_10_percent,
             field_cell(cells.field)});
}

void add_process(Table& table, const char* name, const Coefficient& c, const std::string& unit) {
  const bool judged = c.status != Status::not_fitted;
  table.add({name, Cell::of(shown_value(c, 1, unit), c), "", unit, judged ? Cell::status(c) : Cell(), known_to(c),
             c.bound ? "±" + percent_text(*c.bound) : ""});
}

}  // namespace

Table coefficients_table(const Coefficients& terms, const std::string& unit, const std::vector<Coefficient>& process,
                         bool clock) {
  Table out("term|value|||status|known to|best possible|record for 10 %|in other words",
            "term|value,low95,high95|upper95|term_unit|status");
  out.column("known to").doors = Table::kPage;
  out.column("known to").about = "one standard deviation";
  out.column("best possible").about = "Cramér–Rao bound: one standard deviation, relative";
  out.column("record for 10 %").about = "record length at which the bound is 10 %";
  for (std::size_t t = 0; t < kTerms; ++t)
    if (terms[t].status != Status::not_fitted || terms[t].value)
      add_term(out, terms[t], static_cast<Term>(t), unit, clock);
  if (process.empty()) return out;
  add_process(out, "gauss_markov sigma", process[0], unit.empty() ? "U" : unit);
  add_process(out, "gauss_markov tau", process[1], "s");
  return out;
}

Table coefficients_table(const NoiseFit& fit, const std::string& unit) {
  std::vector<Coefficient> process;
  if (fit.gauss_markov && fit.gauss_markov->in_model) process = {fit.gauss_markov->sigma, fit.gauss_markov->tau_s};
  return coefficients_table(fit.term, unit, process, fit.flicker_phase.has_value());
}

Table power_laws_table(const NoiseFit& fit, const std::string& unit) {
  Table out("noise type|Stable32|α|h|unit|status");
  out.title = "As a clock: one-sided S_y(f) = Σ h_α f^α";
  for (const PowerLaw& law : power_laws(fit))
    out.add({law.name, law.abbreviation, Cell::shown(std::to_string(law.alpha), law.alpha),
             Cell::of(shown_value(law.h, 1, ""), law.h), detail::power_law_unit(law.alpha, unit), Cell::status(law.h)});
  return out;
}

Cell headline_cell(const Coefficient& c, Term term, const std::string& unit, bool spoilt) {
  if (!c.value && !c.upper95) return "–";
  const TermCells cells = term_cells(c, term, unit);
  Cell out = Cell::of(headline(cells), c);
  if (const Tint tint = tint_of(c.status); spoilt || tint == Tint::doubtful || tint == Tint::bad)
    out.unit += out.unit.empty() ? "?" : " ?";
  if (!c.value) out.tint = Tint::absent;
  return out;
}

std::vector<Cell> headline_cells(const Channel& channel, const NoiseFit& fit) {
  std::vector<Cell> out;
  for (const Term term : {Term::white, Term::flicker, Term::walk})
    out.push_back(headline_cell(fit[term], term, channel.unit));
  out.emplace_back(probability_text(fit.goodness.p));
  return out;
}

std::vector<Cell> headline_cells(const RecordedChannel& channel) {
  if (!channel.fitted) return {"–", "–", "–", "no fit"};
  std::vector<Cell> out;
  for (const Term term : {Term::white, Term::flicker, Term::walk}) {
    const RecordedValue* value = channel.find(quantity_of(term));
    const Coefficient c = value == nullptr ? Coefficient{} : coefficient_of(*value);
    out.push_back(headline_cell(c, term, channel.unit, channel.is_spoilt(quantity_of(term))));
  }
  out.emplace_back(probability_text(channel.p));
  return out;
}

}  // namespace libchar
