#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "libchar/core/document/coefficient_fields.hpp"
#include "libchar/core/text/markup.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/figure/draw_figure.hpp"
#include "libchar/figure/make_figure.hpp"
#include "libchar/report/compare/comparison_text.hpp"
#include "libchar/report/detail/assets.hpp"
#include "libchar/report/detail/html/html_tables.hpp"
#include "libchar/report/detail/report_rows.hpp"
#include "libchar/report/detail/tables/coefficients.hpp"

namespace libchar {
namespace {

// ---- the table ----

/// Decades of averaging time that most of the curves reach, at most three, spread over the range.
std::vector<double> shown_times(const CharacterizationComparison& c) {
  std::vector<double> decades;
  for (int k = -3; k <= 5; ++k) {
    const double tau_s = std::pow(10.0, k);
    const auto has = [&](const ComparedGroup& group) {
      return !group.times.empty() && group.times.front().tau_s <= tau_s * 1.001 &&
             group.times.back().tau_s >= tau_s * 0.999;
    };
    if (!c.groups.empty() && std::all_of(c.groups.begin(), c.groups.end(), has)) decades.push_back(tau_s);
  }
  while (decades.size() > 3) decades.erase(decades.begin() + (decades.size() % 2 == 0 ? 0 : 1));
  return decades;
}

const ComparedGroup::Time* time_at(const ComparedGroup& group, double tau_s) {
  for (const ComparedGroup::Time& time : group.times)
    if (std::abs(time.tau_s / tau_s - 1) < 0.01) return &time;
  return nullptr;
}

/// "*" in texts, a word on a page.
void mark_lowest(const detail::Lowest& lowest, std::size_t i, Cell& out) {
  const auto& alike = lowest.not_apart;
  if (lowest.best == i) {
    out.sign = "*";
    out.marks.push_back({"lowest", alike.empty() ? Tint::good : Tint::doubtful});
  } else if (std::find(alike.begin(), alike.end(), i) != alike.end()) {
    out.sign = "=";
    out.marks.push_back({"not distinguished", Tint::doubtful});
  }
}

Cell compared_term_cell(const ComparedGroup& group, Term term, std::size_t i) {
  for (const ComparedTerm& one : group.terms)
    if (one.term == term) {
      Cell out = headline_cell(one.values[i], term, group.unit);
      mark_lowest(one.lowest, i, out);
      return out;
    }
  return "–";
}

Cell deviation_cell(const ComparedGroup& group, double tau_s, std::size_t i) {
  const ComparedGroup::Time* const time = time_at(group, tau_s);
  if (time == nullptr || !time->values[i].value) return "–";
  const Coefficient& c = time->values[i];
  Cell out = Cell::number(*c.value, c.ci95.low < c.ci95.high ? c.ci95 : Interval{kNone, kNone}, 3);
  out.unit = group.unit;
  mark_lowest(time->lowest, i, out);
  return out;
}

Cell data_sheet_cell(const ComparedGroup& group, Term term) {
  for (const ComparedTerm& one : group.terms)
    if (one.term == term && one.limit) {
      Coefficient c;
      c.status = Status::given;
      c.value = one.limit;
      return headline_cell(c, term, group.unit);
    }
  return "";
}

constexpr Term kColumnTerms[] = {Term::white, Term::flicker, Term::walk};

}  // namespace

Table detail::comparison_table(const CharacterizationComparison& c, TableGroups groups) {
  Table out("channel|sensor|N, white noise|B, bias instability|K, random walk",
            "channel|sensor|N,N_low95,N_high95|B,B_low95,B_high95|K,K_low95,K_high95");
  const std::vector<double> times = shown_times(c);
  for (const double tau_s : times) {
    out.columns.push_back({fmt::format("σ at {} s", brief_text(tau_s)),
                           fmt::format("adev_{0}s,adev_{0}s_low95,adev_{0}s_high95", tau_s)});
  }
  for (const ComparedGroup& group : c.groups) {
    if (groups != detail::TableGroups::all && group.within != (groups == detail::TableGroups::axes)) continue;
    for (std::size_t i = 0; i < group.candidates.size(); ++i) {
      Cell name(i == 0 ? group.name : "");
      name.data = group.name;
      std::vector<Cell> row = {std::move(name), group.candidates[i].name};
      for (const Term term : kColumnTerms) row.push_back(compared_term_cell(group, term, i));
      for (const double tau_s : times) row.push_back(deviation_cell(group, tau_s, i));
      out.add(std::move(row));
    }
    if (std::none_of(group.terms.begin(), group.terms.end(), [](const auto& t) { return t.limit; })) continue;
    Cell name("");
    name.data = group.name;
    std::vector<Cell> row = {std::move(name), "data sheet"};
    for (const Term term : kColumnTerms) row.push_back(data_sheet_cell(group, term));
    out.add(std::move(row), Table::Kind::aside);
  }
  out.whole_numbers = true;
  out.signs = "* lowest; = not distinguished from it. ";
  out.note = fmt::format(
      "Compared by the intervals, {} % over the whole comparison; σ: Allan deviation; in brackets: 95 % intervals; "
      "≤: not detected, upper 95 % limit; ?: do not rely on it.",
      brief_text(100 * c.probability));
  return out;
}

namespace {

// ---- the document ----

Json names_json(const ComparedGroup& group, const std::vector<std::size_t>& which) {
  return list_json(which, [&](std::size_t i) { return json_text(group.candidates[i].name); });
}

Json lowest_json(const ComparedGroup& group, const detail::Lowest& lowest) {
  return {{"lowest", lowest.best ? Json(json_text(group.candidates[*lowest.best].name)) : Json(nullptr)},
          {"not_distinguished", names_json(group, lowest.not_apart)}};
}

Json value_json(const Coefficient& c) {
  return {{"value", json_number(c.value)},
          {"ci95", c.value ? interval_json(c.ci95) : Json(nullptr)},
          {"upper95", json_number(c.upper95)},
          {"status", name_of(c.status)}};
}

Json term_json(const ComparedGroup& group, const ComparedTerm& t) {
  const auto key = kTermNames[static_cast<std::size_t>(t.term)].key;
  Json out = {{"term", key}, {"unit", json_text(term_unit(key, group.unit))}};
  out.update(lowest_json(group, t.lowest));
  out["limit"] = json_number(t.limit);
  out["sensors"] = Json::array();
  for (std::size_t i = 0; i < t.values.size(); ++i) {
    Json one = {{"name", json_text(group.candidates[i].name)}};
    one.update(value_json(t.values[i]));
    one["ratio"] = json_number(t.ratios[i].ratio);
    one["ratio_ci95"] = t.ratios[i].ratio ? interval_json(t.ratios[i].ci95) : Json(nullptr);
    one["p"] = json_number(t.ratios[i].p);
    one["difference"] = name_of(t.differences[i]);
    out["sensors"].push_back(std::move(one));
  }
  return out;
}

Json time_json(const ComparedGroup& group, const ComparedGroup::Time& time) {
  Json out = {{"tau_s", json_number(time.tau_s)}};
  out.update(lowest_json(group, time.lowest));
  out["deviation"] = list_json(time.values, [](const Coefficient& c) { return json_number(c.value); });
  out["ci95"] = list_json(time.values, [](const Coefficient& c) {
    return c.value && c.ci95.high > 0 ? interval_json(c.ci95) : Json(nullptr);
  });
  return out;
}

Json sensor_json(const ComparedGroup::Candidate& one) {
  return {{"name", json_text(one.name)},
          {"side", one.side},
          {"channels", texts_json(one.channels)},
          {"measured", one.measured},
          {"takes_part", one.takes_part},
          {"findings", list_json(one.findings, [](const Finding& f) { return json_text(f.code); })}};
}

Json group_json(const ComparedGroup& group) {
  return {{"name", json_text(group.name)},
          {"quantity", group.quantity},
          {"axis", group.axis},
          {"unit", json_text(group.unit)},
          {"of_axes", group.of_axes},
          {"sensors", list_json(group.candidates, sensor_json)},
          {"terms", list_json(group.terms, [&](const auto& t) { return term_json(group, t); })},
          {"times", list_json(group.times, [&](const auto& t) { return time_json(group, t); })},
          {"ranges", list_json(group.ranges,
                               [&](const ComparedGroup::Range& r) {
                                 return Json({{"from_s", json_number(r.from_s)},
                                              {"to_s", json_number(r.to_s)},
                                              {"lowest", names_json(group, r.lowest)}});
                               })},
          {"sentence", json_text(group.sentence)},
          {"terms_sentence", json_text(group.terms_sentence)}};
}

Json compared_side_json(const ReportedCharacterization& s) {
  return {{"name", json_text(s.name)},
          {"file", json_text(s.file)},
          {"format", s.format},
          {"program", s.program.empty() ? Json(nullptr) : Json(json_text(s.program))},
          {"recording", json_text(s.recording)},
          {"findings", list_json(s.findings, [](const Finding& one) { return document_of(finding_fields(), one); })}};
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> out;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    out.push_back(text.substr(from, end - from));
    from = end + 1;
  }
  return out;
}

}  // namespace

Json comparison_json(const CharacterizationComparison& c) {
  return {{"verdict", json_text(c.verdict)},
          {"probability", c.probability},
          {"sides", list_json(c.sides, compared_side_json)},
          {"groups", list_json(c.groups, group_json)},
          {"remarks", texts_json(c.remarks)}};
}

std::string comparison_text(const CharacterizationComparison& c, std::size_t width) {
  std::string out;
  for (const std::string& line : lines_of(c.verdict)) out += printable(line) + "\n";
  out += "\n" + terminal_table(detail::comparison_table(c), {width}, "");
  if (!c.remarks.empty() || !c.known.empty()) out += "\n";
  for (const auto* lines : {&c.remarks, &c.known})
    for (const std::string& line : *lines) out += "  " + printable(line) + "\n";
  return out;
}

std::string comparison_markdown(const CharacterizationComparison& c) {
  std::string out = "# Sensors compared\n";
  for (const std::string& line : lines_of(c.verdict)) out += "\n" + markdown_text(line) + "\n";
  out += "\n" + table_text(detail::comparison_table(c)) + "\n";
  for (const ReportedCharacterization& side : c.sides)
    out += fmt::format("- {}: {}\n", markdown_text(side.name), markdown_text(side.file));
  const std::pair<const char*, const std::vector<std::string>*> lists[] = {{"Other differences:", &c.remarks},
                                                                           {"What is known of them:", &c.known}};
  for (const auto& [head, lines] : lists) {
    if (lines->empty()) continue;
    out += fmt::format("\n{}\n\n", head);
    for (const std::string& line : *lines) out += "- " + markdown_text(line) + "\n";
  }
  return out;
}

namespace {

/// With the sentence where the verdict does not have it.
std::string figure_html(const ComparedGroup& group, bool with_sentence) {
  const Chart chart = detail::compared_chart(group);
  if (chart.series.empty()) return "";
  return drawn_figure(chart, {.width_mm = 160, .shape = 0.5},
                      with_sentence ? group.name + ": " + group.sentence : group.name);
}

std::string sides_html(const CharacterizationComparison& c, const std::vector<std::string>& command) {
  Table facts("sensor|file|recording");
  for (const ReportedCharacterization& side : c.sides) facts.add({side.name, side.file, side.recording});
  Table program("|");
  add_program(program, command);
  return "<section class=\"channel\">\n<h2>Where the numbers come from</h2>\n" +
         html_table(facts, {.css = "cards", .cards = true}) + html_table(program) + "</section>\n";
}

}  // namespace

std::string detail::comparison_html(const CharacterizationComparison& c, const Json& document,
                                    const std::vector<std::string>& command) {
  std::string body = "<section id=\"overview\">\n";
  for (const std::string& line : lines_of(c.verdict)) body += "<p class=\"verdict\">" + html_text(line) + "</p>\n";
  body += bullet_list(c.known, "cautions") + "</section>\n";
  body += "<section class=\"channel\">\n<h2>Which is lowest</h2>\n" +
          html_table(detail::comparison_table(c), {.css = "many cards", .cards = true}) + "</section>\n";
  std::string first, rest;
  for (const ComparedGroup& group : c.groups) {
    const bool folds = group.within;
    (folds ? rest : first) += figure_html(group, folds);
  }
  body += "<section class=\"channel\">\n<h2>Allan deviation</h2>\n" + first +
          (rest.empty() ? ""
                        : folded("Each axis", html_table(detail::comparison_table(c, detail::TableGroups::axes),
                                                         {.css = "many cards", .cards = true}) +
                                                  rest)) +
          "</section>\n";
  if (!c.remarks.empty())
    body +=
        "<section class=\"channel\">\n<h2>Other differences</h2>\n" + bullet_list(c.remarks, "plain") + "</section>\n";
  std::string names;
  for (const ReportedCharacterization& side : c.sides) names += (names.empty() ? "" : ", ") + side.name;
  return html_page({"Sensors compared", names, "reportPage.start({}, () => 320);\n",
                    std::string(page_css()) + std::string(many_page_css())},
                   body + sides_html(c, command), json_in_script(document));
}

}  // namespace libchar
