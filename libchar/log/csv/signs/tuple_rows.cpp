// Cells that hold several numbers ("(1.0, 2.0, 3.0)", "[1 2 3]", "1.0; 2.0; 3.0" in quotes): a column for each of them,
// called as the elements of an array are, v_0, v_1, v_2.

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/csv/made_text.hpp"
#include "libchar/log/csv/signs/signs.hpp"

namespace libchar::csv {
namespace {

constexpr std::string_view kOpening = "([{", kClosing = ")]}";

bool among(std::string_view set, char c) { return set.find(c) != std::string_view::npos; }

/// The cells of a line; nothing inside of quotes and brackets separates them.
std::vector<std::string_view> whole_cells(std::string_view line, char delimiter) {
  std::vector<std::string_view> out;
  bool quoted = false;
  int depth = 0;
  std::size_t from = 0;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i < line.size()) {
      quoted = quoted != (line[i] == '"');
      depth += among(kOpening, line[i]) ? 1 : among(kClosing, line[i]) ? -1 : 0;
      if (quoted || depth > 0 || line[i] != delimiter) continue;
    }
    out.push_back(line.substr(from, i - from));
    from = i + 1;
  }
  return out;
}

/// "1 234 567" and "1,234,567" are one number.
bool groups_of_one(const std::vector<std::string>& numbers) {
  constexpr std::size_t kGroup = 3;
  return std::all_of(numbers.begin() + 1, numbers.end(), [](const std::string& text) {
    return std::min(text.find('.'), text.size()) == kGroup && text.find_first_not_of("0123456789.") == text.npos;
  });
}

/// The numbers of such a cell, as they are written; empty where it is none.
std::vector<std::string> numbers_of(std::string_view cell) {
  constexpr std::size_t kFewestBare = 3;
  cell = trimmed(cell);
  const bool quoted = cell.size() > 1 && cell.front() == '"' && cell.back() == '"';
  if (quoted) cell = trimmed(cell.substr(1, cell.size() - 2));
  const std::size_t begin = cell.find_first_of(kOpening);
  const bool brackets = begin != cell.npos && begin < cell.find_first_of("0123456789") && among(kClosing, cell.back());
  if (!brackets && !quoted) return {};
  if (brackets) {  // "array([1, 2])"
    cell.remove_prefix(begin);
    while (!cell.empty() && (among(kOpening, cell.front()) || cell.front() == ' ')) cell.remove_prefix(1);
    while (!cell.empty() && (among(kClosing, cell.back()) || cell.back() == ' ')) cell.remove_suffix(1);
  }
  const char sign = among(cell, ';') ? ';' : among(cell, ',') ? ',' : ' ';
  std::vector<std::string> out;
  for (std::size_t from = 0; from <= cell.size();) {
    const std::size_t end = std::min(cell.find(sign, from), cell.size());
    std::string text(trimmed(cell.substr(from, end - from)));
    from = end + 1;
    if (text.empty() && sign == ' ') continue;
    if (sign == ';') std::replace(text.begin(), text.end(), ',', '.');
    if (!parse_double(text)) return {};
    out.push_back(std::move(text));
  }
  const bool pair = brackets && out.size() > 1;
  return pair || (out.size() >= kFewestBare && !groups_of_one(out)) ? out : std::vector<std::string>();
}

/// Which columns hold how many numbers.
struct Tuples {
  char delimiter = 0;  ///< 0: there are none
  std::map<std::size_t, std::size_t> at = {};
};

/// In three lines and more, and in most behind the first.
Tuples tuples_in(std::string_view front, char delimiter) {
  constexpr std::size_t kFewest = 3;
  std::map<std::size_t, std::map<std::size_t, std::size_t>> seen;  // column, numbers: lines
  std::size_t lines = 0;
  for (std::size_t end = front.find('\n'); end != std::string_view::npos; end = front.find('\n')) {
    std::string_view line = front.substr(0, end);
    front.remove_prefix(end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    const auto cells = whole_cells(line, delimiter);
    ++lines;
    const auto empty = [](std::string_view cell) { return trimmed(cell).empty(); };
    if (static_cast<std::size_t>(std::count_if(cells.begin(), cells.end(), empty)) + 1 >= cells.size()) continue;
    for (std::size_t c = 0; c < cells.size(); ++c)
      if (const auto numbers = numbers_of(cells[c]); !numbers.empty()) ++seen[c][numbers.size()];
  }
  Tuples out;
  for (const auto& [column, sizes] : seen)
    if (sizes.size() == 1 && sizes.begin()->second >= kFewest && 4 * sizes.begin()->second >= 3 * (lines - 1))
      out.at[column] = sizes.begin()->first;
  out.delimiter = out.at.empty() ? '\0' : delimiter;
  return out;
}

Tuples tuples_of(std::string_view front) {
  if (front.find_first_of("([{\"") == std::string_view::npos) return {};
  for (const char delimiter : {'\t', ';', ',', '|'})
    if (Tuples found = tuples_in(front, delimiter); found.delimiter != 0) return found;
  return {};
}

/// "acc_1 [m/s^2]" of "acc [m/s^2]".
std::string element_name(std::string_view cell, std::size_t k) {
  const bool quoted = cell.size() > 1 && cell.front() == '"' && cell.back() == '"';
  if (quoted) cell = cell.substr(1, cell.size() - 2);
  const std::size_t unit = std::min(cell.find_first_of("[("), cell.size());
  const std::string_view name = trimmed(cell.substr(0, unit));
  std::string out = quoted ? "\"" : "";
  out += fmt::format("{}_{}{}{}", name, k, unit < cell.size() && unit > name.size() ? " " : "", cell.substr(unit));
  if (quoted) out.push_back('"');
  return out;
}

class FromTuples final : public CleanedLines {
 public:
  using CleanedLines::CleanedLines;
  std::string_view what() const override { return "several numbers in a cell, a column for each"; }

 private:
  void begin(std::string_view front) override { tuples_ = tuples_of(front); }
  void clean(std::string& line) override {
    const auto cells = whole_cells(line, tuples_.delimiter);
    if (cells.size() <= tuples_.at.rbegin()->first) return;
    std::string out;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      if (c > 0) out += tuples_.delimiter;
      const auto found = tuples_.at.find(c);
      if (found == tuples_.at.end())
        out += cells[c];
      else
        add(cells[c], found->second, out);
    }
    begun_ = true;
    line = std::move(out);
  }
  /// A name in the first line, missing numbers in the others.
  void add(std::string_view cell, std::size_t size, std::string& out) const {
    std::vector<std::string> numbers = numbers_of(cell);
    for (std::size_t k = 0; k < size; ++k) {
      if (k > 0) out += tuples_.delimiter;
      if (numbers.size() == size)
        out += numbers[k];
      else if (!begun_)
        out += element_name(trimmed(cell), k);
      else if (k == 0 && !bare(cell).empty())
        out += cell;  // refused with its place
    }
  }
  static std::string_view bare(std::string_view cell) {
    cell = trimmed(cell);
    return cell.find_first_not_of('"') == cell.npos ? "" : cell;
  }

  Tuples tuples_;
  bool begun_ = false;
};

}  // namespace

bool has_tuples(std::string_view front) { return tuples_of(front).delimiter != 0; }

std::unique_ptr<Unpacker> open_tuples(std::function<std::size_t(char*, std::size_t)> stored) {
  return std::make_unique<FromTuples>(std::move(stored));
}

}  // namespace libchar::csv
