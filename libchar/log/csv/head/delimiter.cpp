#include "libchar/log/csv/head/delimiter.hpp"

#include <algorithm>

#include "libchar/core/error.hpp"
#include "libchar/log/csv/head/columns.hpp"
#include "libchar/log/csv/rows/number.hpp"

namespace libchar::csv {

namespace {

// "1.234,56" under a decimal comma, "1,234.56" under a point: one mark between groups of three, another once behind them.
char mark_of_grouped(std::string_view text) {
  for (const auto& [point, group] : {std::pair{'.', ','}, std::pair{',', '.'}})
    if (const std::string plain = without_thousands(text, {point, group});
        plain != text && text.find(point) != std::string_view::npos)
      return point;
  return 0;
}

}  // namespace

bool numeric(const Field& field, char delimiter, char* mark) {
  if (const std::size_t label = label_length(field.text); label > 0)
    return numeric({field.text.substr(label), 0, field.quoted}, delimiter, mark);
  if (const char grouped = mark_of_grouped(field.text); grouped != 0) {
    if (mark != nullptr) *mark = grouped;
    return true;
  }
  if (read_cell(field.text, '.').kind != Cell::bad) {
    if (mark != nullptr && field.text.find('.') != std::string::npos) *mark = '.';
    return true;
  }
  if (const auto measured = number_and_unit(field.text))
    return numeric({std::string(measured->number), 0, field.quoted}, delimiter, mark);
  if (delimiter == ',' && !field.quoted) return false;
  if (read_cell(field.text, ',').kind == Cell::bad) return false;
  if (mark != nullptr) *mark = ',';
  return true;
}

Score score(const std::vector<Line>& lines, char delimiter) {
  std::vector<std::size_t> counts, ending_empty;
  std::size_t cells = 0, numbers = 0, widest = 0;
  for (const Line& line : lines) {
    const auto fields = split(line.text, delimiter);
    const std::size_t n = fields.size();
    if (n > 1 && fields.back().text.empty() && !fields.back().quoted && delimiter != ' ') {
      ending_empty.push_back(n);
    } else {
      counts.push_back(n);
      widest = std::max(widest, n);
    }
    for (const Field& field : fields) {
      ++cells;
      numbers += numeric(field, delimiter);
    }
  }
  // An empty last cell is missing where other lines have one there; else a delimiter ends the line.
  for (const std::size_t n : ending_empty) counts.push_back(n == widest ? n : n - 1);
  Score result{delimiter, 1, 0};
  if (counts.empty()) return result;
  std::vector<std::size_t> sorted = counts;
  std::sort(sorted.begin(), sorted.end());
  std::size_t best = 0;
  for (std::size_t i = 0; i < sorted.size();) {
    const std::size_t run =
        static_cast<std::size_t>(std::upper_bound(sorted.begin(), sorted.end(), sorted[i]) -
                                 sorted.begin()) -
        i;
    if (run >= best) {
      best = run;
      result.columns = sorted[i];
    }
    i += run;
  }
  const double consistent = static_cast<double>(best) / static_cast<double>(counts.size());
  result.quality =
      result.columns < 2
          ? 0
          : consistent * (0.05 + static_cast<double>(numbers) / static_cast<double>(cells));
  return result;
}

Score best_score(const std::vector<Line>& lines) {
  Score best;
  for (const char candidate : {',', ';', '\t', ' '}) {
    Score s = score(lines, candidate);
    // Tabs count as blanks, and names behind tabs have blanks inside: those must win clearly.
    if (candidate == ' ' && best.delimiter == '\t' && best.columns > 1) s.quality *= 0.7;
    if (s.quality > best.quality + 1e-9) best = s;
  }
  return best;
}

char decimal_mark(const std::vector<Line>& lines, char delimiter) {
  std::size_t commas = 0, points = 0;
  for (const Line& line : lines)
    for (const Field& field : split(line.text, delimiter)) {
      char mark = 0;
      if (!numeric(field, delimiter, &mark)) continue;
      commas += mark == ',';
      points += mark == '.';
    }
  return commas > points ? ',' : '.';
}

char thousands_mark(const std::vector<Line>& lines, char delimiter, char decimal) {
  constexpr std::size_t kEnough = 3;
  for (const char group : {',', '.', '\'', ' '}) {
    if (group == decimal || (group == ' ' && delimiter == ' ')) continue;
    std::size_t found = 0;
    for (const Line& line : lines)
      for (const Field& field : split(line.text, delimiter)) {
        if (read_cell(field.text, decimal).kind != Cell::bad) continue;
        const std::string plain = without_thousands(field.text, {decimal, group});
        found += plain != field.text && read_cell(plain, decimal).kind == Cell::value;
      }
    if (found >= kEnough) return group;
  }
  return 0;
}

char named_delimiter(const std::string& name) {
  if (name == "tab" || name == "\\t" || name == "\t") return '\t';
  if (name == "space" || name == " ") return ' ';
  if (name.size() == 1 && !is_digit(name[0]) && name[0] != '"' && name[0] != '\r' &&
      name[0] != '\n' && name[0] != '-' && name[0] != '+')
    return name[0];
  throw Error({ErrorKind::usage,
               "E0202",
               "`delimiter`",
               "unknown delimiter",
               name,
               "use auto, tab, space, or one character such as , or ;"});
}

std::string delimiter_name(char delimiter) {
  if (delimiter == '\t') return "tab";
  if (delimiter == ' ') return "blanks";
  return std::string(1, delimiter);
}

}  // namespace libchar::csv
