#include "libchar/report/text/report_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/core/text/csv_cell.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/pattern.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/core/units.hpp"
#include "libchar/report/detail/escape.hpp"

namespace libchar {
namespace {

struct ReportCell {
  std::string text;
  bool is_unit = false;
};
using ReportRow = std::vector<ReportCell>;

struct ReportTable {
  ReportRow head;
  std::string alignment;  ///< l or r, a column each
  std::vector<ReportRow> rows;
};

std::string row_in_markdown(const ReportRow& row) {
  std::string out = "|";
  for (const ReportCell& cell : row) out += " " + markdown_text(cell.text) + " |";
  return out + "\n";
}

std::string as_markdown(const ReportTable& table) {
  std::string out = row_in_markdown(table.head) + "|";
  for (const char a : table.alignment) out += a == 'r' ? "---:|" : "---|";
  out += "\n";
  for (const ReportRow& row : table.rows) out += row_in_markdown(row);
  return out;
}

std::string row_in_latex(const ReportRow& row) {
  std::string out;
  for (std::size_t i = 0; i < row.size(); ++i)
    out += (i == 0 ? "  " : " & ") +
           (row[i].is_unit ? latex_unit(row[i].text) : latex_text(row[i].text));
  return out + " \\\\\n";
}

std::string as_latex(const ReportTable& table) {
  std::string out = "\\begin{tabular}{" + table.alignment + "}\n  \\hline\n" +
                    row_in_latex(table.head) + "  \\hline\n";
  for (const ReportRow& row : table.rows) out += row_in_latex(row);
  return out + "  \\hline\n\\end{tabular}\n";
}

std::string rendered(const ReportTable& table, TableFormat format) {
  return format == TableFormat::latex ? as_latex(table) : as_markdown(table);
}

std::string csv_number(double value) {
  return std::isfinite(value) ? shortest(value) : "";
}

std::string csv_number(const std::optional<double>& value) {
  return value ? csv_number(*value) : "";
}

void add_channel(ReportTable& table, const ReportedChannel& channel) {
  bool first = true;
  for (std::size_t t = 0; t < kTerms; ++t) {
    const Coefficient& c = channel.term[t];
    if (c.status == Status::not_fitted) continue;
    const TermCells cells = term_cells(c, static_cast<Term>(t), channel.unit);
    const bool quoted = !cells.field.empty();
    table.rows.push_back({{first ? printable(channel.name) : ""},
                          {fmt::format("{} ({})", cells.title, cells.letter)},
                          {cells.own.value},
                          {c.value     ? interval_words(cells.own)
                           : c.upper95 ? "95 % upper limit"
                                       : ""},
                          {printable(cells.own.unit), true},
                          {quoted ? printable(said(cells.field.front())) : ""},
                          {status_words(c.status)}});
    first = false;
  }
}

std::string coefficient_csv(const std::vector<const ReportedChannel*>& channels) {
  std::string out = "channel,unit,term,value,low95,high95,upper95,term_unit,status\n";
  for (const ReportedChannel* channel : channels)
    for (std::size_t t = 0; t < kTerms; ++t) {
      const Coefficient& c = channel->term[t];
      if (c.status == Status::not_fitted) continue;
      out += fmt::format("{},{},{},{},{},{},{},{},{}\n",
                         csv_cell(channel->name),
                         csv_cell(channel->unit),
                         kTermNames[t].key,
                         csv_number(c.value),
                         c.value ? csv_number(c.ci95.low) : "",
                         c.value ? csv_number(c.ci95.high) : "",
                         csv_number(c.upper95),
                         csv_cell(term_unit(kTermNames[t].key, channel->unit)),
                         name_of(c.status));
    }
  return out;
}

std::vector<const ReportedChannel*> chosen_channels(const ReportedCharacterization& report,
                                                    const std::vector<std::string>& patterns) {
  std::vector<const ReportedChannel*> out;
  std::vector<std::string> names;
  for (const ReportedChannel& channel : report.channels) {
    names.push_back(channel.name);
    if (!channel.fitted) continue;
    if (patterns.empty() || std::any_of(patterns.begin(), patterns.end(), [&](const auto& p) {
          return matches(p, channel.name);
        }))
      out.push_back(&channel);
  }
  for (const std::string& pattern : patterns)
    if (std::none_of(
            names.begin(), names.end(), [&](const auto& name) { return matches(pattern, name); }))
      throw Error({ErrorKind::usage,
                   "E0985",
                   report.file,
                   "no channel of the report has this name",
                   pattern,
                   did_you_mean(nearest(pattern, names), "there are " + first_names(names))});
  if (out.empty())
    throw Error({ErrorKind::input,
                 "E0985",
                 report.file,
                 "no channel of the report was fitted: there is no coefficient for a table",
                 "",
                 ""});
  return out;
}

std::vector<const ReplayReport::Algorithm*> best_first(const ReplayReport& report) {
  std::vector<const ReplayReport::Algorithm*> out;
  for (const ReplayReport::Algorithm& a : report.algorithms)
    if (a.ran) out.push_back(&a);
  std::stable_sort(out.begin(), out.end(), [](const auto* a, const auto* b) {
    return std::isfinite(a->rmse) && (!std::isfinite(b->rmse) || a->rmse < b->rmse);
  });
  return out;
}

std::string ranking_csv(const ReplayReport& report) {
  std::string out = "algorithm,bound,rmse,low95,high95,unit,regret,ns_per_sample,peak_bytes\n";
  const std::string unit = report.inputs.empty() ? "" : report.inputs[0].unit;
  for (const ReplayReport::Algorithm* a : best_first(report))
    out += fmt::format("{},{},{},{},{},{},{},{},{}\n",
                       csv_cell(a->label),
                       a->bound,
                       csv_number(a->rmse),
                       csv_number(a->rmse_ci95.low),
                       csv_number(a->rmse_ci95.high),
                       csv_cell(unit),
                       csv_number(a->regret),
                       csv_number(a->ns_per_sample),
                       a->peak_bytes ? std::to_string(*a->peak_bytes) : "");
  return out;
}

}  // namespace

std::string coefficient_table(const ReportedCharacterization& report,
                              const std::vector<std::string>& channels,
                              TableFormat format) {
  const auto chosen = chosen_channels(report, channels);
  if (format == TableFormat::csv) return coefficient_csv(chosen);
  ReportTable table;
  table.head = {
      {"channel"}, {"term"}, {"value"}, {"95 % interval"}, {"unit"}, {"as quoted"}, {"status"}};
  table.alignment = "llrllll";
  for (const ReportedChannel* channel : chosen) add_channel(table, *channel);
  return rendered(table, format);
}

std::string ranking_table(const ReplayReport& report, TableFormat format) {
  if (format == TableFormat::csv) return ranking_csv(report);
  ReportTable table;
  const std::string unit = report.inputs.empty() ? "" : shown_unit(report.inputs[0].unit);
  const std::string score = report.reference ? "RMSE" : "leave-one-out RMS";
  table.head = {{"method"},
                {unit.empty() ? score : score + ", " + unit},
                {"95 % interval"},
                {"above the optimum"},
                {"a sample"},
                {"memory"}};
  table.alignment = "lrlrrr";
  for (const ReplayReport::Algorithm* a : best_first(report)) {
    table.rows.push_back({{printable(a->label) + (a->bound ? " (bound)" : "")},
                          {number_text(a->rmse)},
                          {interval_text(a->rmse_ci95)},
                          {excess_text(a->regret)},
                          {duration_text(1e-9 * a->ns_per_sample)},
                          {bytes_text(a->peak_bytes)}});
  }
  return rendered(table, format);
}

namespace {

struct LatexWord {
  std::string_view text, latex;
};

// In text mode.
constexpr LatexWord kLatexText[] = {{"\\", "\\textbackslash{}"},
                                    {"&", "\\&"},
                                    {"%", "\\%"},
                                    {"$", "\\$"},
                                    {"#", "\\#"},
                                    {"_", "\\_"},
                                    {"{", "\\{"},
                                    {"}", "\\}"},
                                    {"~", "\\textasciitilde{}"},
                                    {"^", "\\textasciicircum{}"},
                                    {"…", "\\ldots{}"},
                                    {"–", "--"},
                                    {"≤", "$\\le$"},
                                    {"·", "$\\cdot$"},
                                    {"√", "$\\surd$"},
                                    {"²", "$^{2}$"},
                                    {"³", "$^{3}$"},
                                    {"°", "$^{\\circ}$"},
                                    {"µ", "$\\mu$"},
                                    {"±", "$\\pm$"},
                                    {"−", "$-$"},
                                    {"\u202F", "\\,"}};

// In mathematics.
constexpr LatexWord kLatexUnit[] = {{"·", "\\cdot "},
                                    {"²", "^{2}"},
                                    {"³", "^{3}"},
                                    {"µ", "\\mu "},
                                    {"°", "^{\\circ}"},
                                    {"%", "\\%"},
                                    {"(", "("},
                                    {")", ")"},
                                    {"/", "/"},
                                    {"^", "\\hat{}"},
                                    {"\\", "\\backslash "},
                                    {"_", "\\_"},
                                    {"$", "\\$"},
                                    {"&", "\\&"},
                                    {"#", "\\#"},
                                    {"{", "\\{"},
                                    {"}", "\\}"},
                                    {"~", "\\sim "}};

const LatexWord* word_at(std::span<const LatexWord> words, std::string_view text) {
  for (const LatexWord& word : words)
    if (text.starts_with(word.text)) return &word;
  return nullptr;
}

/// "×10⁻⁵" at the beginning of the text: its length and what LaTeX writes.
std::pair<std::size_t, std::string> power_at(std::string_view text) {
  constexpr std::string_view kTimes = "×10";
  if (!text.starts_with(kTimes)) return {0, ""};
  constexpr LatexWord kRaised[] = {{"⁻", "-"},
                                   {"⁰", "0"},
                                   {"¹", "1"},
                                   {"²", "2"},
                                   {"³", "3"},
                                   {"⁴", "4"},
                                   {"⁵", "5"},
                                   {"⁶", "6"},
                                   {"⁷", "7"},
                                   {"⁸", "8"},
                                   {"⁹", "9"}};
  std::size_t at = kTimes.size();
  std::string exponent;
  while (const LatexWord* digit = word_at(kRaised, text.substr(at))) {
    exponent += digit->latex;
    at += digit->text.size();
  }
  return {at, "$\\times 10^{" + exponent + "}$"};
}

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

}  // namespace

std::string latex_text(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::string_view rest = std::string_view(text).substr(at);
    if (const auto [length, power] = power_at(rest); length > 0) {
      out += power;
      at += length;
    } else if (rest.starts_with("√") && rest.size() > 3 && is_letter(rest[3])) {
      // "deg/√h": the root of the unit that follows
      std::size_t end = at + std::string_view("√").size();
      const std::size_t from = end;
      while (end < text.size() && is_letter(text[end])) ++end;
      out += "$\\sqrt{\\mathrm{" + text.substr(from, end - from) + "}}$";
      at = end;
    } else if (const LatexWord* word = word_at(kLatexText, rest)) {
      out += word->latex;
      at += word->text.size();
    } else {
      out += text[at++];
    }
  }
  return out;
}

std::string latex_unit(const std::string& unit) {
  if (unit.empty()) return "";
  constexpr std::string_view kRoot = "√";
  std::string out;
  bool rooted = false;
  for (std::size_t at = 0; at < unit.size();) {
    const std::string_view rest = std::string_view(unit).substr(at);
    if (rest.starts_with(kRoot)) {
      rooted = true;
      at += kRoot.size();
    } else if (is_letter(unit[at])) {
      std::size_t end = at;
      while (end < unit.size() && is_letter(unit[end])) ++end;
      const std::string word = "\\mathrm{" + unit.substr(at, end - at) + "}";
      out += rooted ? "\\sqrt{" + word + "}" : word;
      rooted = false;
      at = end;
    } else if (const LatexWord* word = word_at(kLatexUnit, rest)) {
      out += word->latex;
      at += word->text.size();
    } else {
      out += unit[at++];
    }
  }
  return "$" + out + "$";
}

}  // namespace libchar
