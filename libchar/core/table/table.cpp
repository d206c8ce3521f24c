#include "libchar/core/table/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/table/detail/formats.hpp"
#include "libchar/core/text/markup.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/text.hpp"

namespace libchar {
namespace {

std::vector<std::string> split_heads(std::string_view text) {
  std::vector<std::string> out;
  for (std::size_t end = 0; end != std::string_view::npos;) {
    end = text.find('|');
    out.emplace_back(text.substr(0, end));
    if (end != std::string_view::npos) text.remove_prefix(end + 1);
  }
  return out;
}

/// A table as texts show it: a column for each interval and unit.
struct FlatCell {
  std::string text;
  std::optional<Tint> tint = {};
  bool is_unit = false;
};
struct FlatTable {
  std::vector<std::string> heads;
  std::vector<bool> numbers;
  std::vector<std::vector<FlatCell>> rows;
};

std::string inline_text(const Cell& cell, bool whole) {
  std::string out = cell.text + (cell.sign.empty() ? "" : " " + cell.sign);
  if (whole && !cell.high.empty()) out += fmt::format(" [{}, {}]", cell.low, cell.high);
  if (whole && !cell.unit.empty()) out += " " + cell.unit;
  for (const Cell& line : cell.lines) out += (out.empty() ? "" : ", ") + inline_text(line, true);
  return out;
}

/// Left out where none says anything.
template <class CellOf>
void add_flat(FlatTable& out, std::string head, bool number, std::size_t rows, CellOf&& cell_of) {
  std::vector<FlatCell> cells;
  bool any = rows == 0;
  for (std::size_t r = 0; r < rows; ++r) {
    cells.push_back(cell_of(r));
    any = any || !cells.back().text.empty();
  }
  if (!any) return;
  out.heads.push_back(std::move(head));
  out.numbers.push_back(number);
  for (std::size_t r = 0; r < rows; ++r) out.rows[r].push_back(std::move(cells[r]));
}

FlatTable flat_table(const Table& table, Table::Door door) {
  const auto is_part = [](const Table::Row& row) { return row.kind == Table::Kind::part; };
  if (std::any_of(table.rows.begin(), table.rows.end(), is_part)) {
    Table without = table;
    std::erase_if(without.rows, is_part);
    return flat_table(without, door);
  }
  const std::size_t rows = table.rows.size();
  FlatTable out;
  out.rows.resize(rows);
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    const Table::Column& column = table.columns[c];
    if ((column.doors & door) == 0) continue;
    const bool whole = table.whole_numbers;
    add_flat(out, column.head, table.holds_numbers(c), rows, [&](std::size_t r) {
      const Cell& cell = table.cell(r, c);
      return FlatCell{inline_text(cell, whole || !cell.is_number), cell.tint};
    });
    if (whole || rows == 0 || !table.holds_numbers(c)) continue;
    add_flat(out, "95 % interval", false, rows, [&](std::size_t r) {
      const Cell& cell = table.cell(r, c);
      return FlatCell{cell.high.empty() ? cell.low : cell.low + " … " + cell.high};
    });
    add_flat(out, "unit", false, rows, [&](std::size_t r) { return FlatCell{table.cell(r, c).unit, {}, true}; });
  }
  return out;
}

/// A line of a document, each cell written by `write`.
template <class Cells, class Write>
std::string line_of(const Cells& cells, std::string_view between, Write&& write) {
  std::string out;
  for (const auto& cell : cells) {
    out += write(cell);
    out += between;
  }
  return out.substr(0, out.size() - between.size());
}

}  // namespace

Cell Cell::number(double value, int digits) { return Cell::shown(number_text(value, digits), value); }

Cell Cell::number(double value, const Interval& ci95, int digits) {
  Cell out = Cell::number(value, digits);
  if (std::isnan(ci95.low) || std::isnan(ci95.high)) return out;
  out.low = end_text(ci95.low, ci95.low, digits);
  out.high = end_text(ci95.high, ci95.high, digits);
  out.ci95 = ci95;
  return out;
}

Cell Cell::shown(std::string text, double value) {
  Cell out(std::move(text));
  out.is_number = true;
  out.value = value;
  return out;
}

Cell Cell::of(const ShownValue& shown, const Coefficient& coefficient) {
  Cell out = Cell::shown(shown.value, coefficient.value.value_or(kNone));
  out.unit = unit_with_reading(shown);
  out.low = shown.low;
  out.high = shown.high;
  if (coefficient.value) out.ci95 = coefficient.ci95;
  return out;
}

Cell Cell::status(const Coefficient& coefficient) {
  Cell out = Cell::word(status_words(coefficient),
                        detail::reaches_zero(coefficient) ? Tint::doubtful : tint_of(coefficient.status));
  out.data = name_of(coefficient.status);
  return out;
}

Cell Cell::word(std::string_view word, Tint tint) {
  Cell out(word);
  out.tint = tint;
  return out;
}

Table::Table(std::string_view heads, std::string_view keys) {
  const std::vector<std::string> all = split_heads(keys);
  for (std::string& head : split_heads(heads)) {
    const std::size_t place = columns.size();
    columns.push_back({std::move(head), place < all.size() ? all[place] : ""});
    if (columns.back().head.empty() && !columns.back().key.empty()) columns.back().doors = 0;
  }
}

void Table::add(std::vector<Cell> cells, Kind kind) { rows.push_back({std::move(cells), kind}); }

Table::Column& Table::column(std::string_view head) {
  return *std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.head == head; });
}

void Table::drop(std::string_view head) {
  const auto place = &column(head) - columns.data();
  columns.erase(columns.begin() + place);
  for (Row& row : rows)
    if (place < std::ssize(row.cells)) row.cells.erase(row.cells.begin() + place);
}

const Cell& Table::cell(std::size_t row, std::size_t column) const {
  static const Cell kEmpty;
  return column < rows[row].cells.size() ? rows[row].cells[column] : kEmpty;
}

bool Table::says_anything(std::size_t column) const {
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (!cell(r, column).text.empty() || !cell(r, column).lines.empty()) return true;
  return rows.empty();
}

bool Table::holds_numbers(std::size_t column) const {
  for (std::size_t r = 0; r < rows.size(); ++r)
    if (cell(r, column).is_number) return true;
  return false;
}

std::string terminal_table(const Table& table, const TextLook& look, std::string_view indent) {
  const FlatTable flat = flat_table(table, Table::kTerminal);
  const auto empty = [](const std::string& head) { return head.empty(); };
  std::vector<std::vector<std::string>> rows = {{}};
  for (const std::string& head : flat.heads) rows[0].push_back(printable(head));
  if (std::all_of(flat.heads.begin(), flat.heads.end(), empty)) rows.clear();
  for (const auto& row : flat.rows) {
    rows.emplace_back();
    for (const FlatCell& cell : row) {
      const std::string text = printable(cell.text);
      rows.back().push_back(cell.tint ? tinted(text, *cell.tint, look.colours) : text);
    }
  }
  const bool words_last = !flat.numbers.empty() && !flat.numbers.back();
  std::string out = table.title.empty() ? "" : printable(table.title) + "\n";
  out += text_table(rows, indent, words_last, look.width);
  return table.note.empty() ? out : out + std::string(indent) + printable(table.signs + table.note) + "\n";
}

namespace {

std::string in_markdown(const Table& table) {
  const FlatTable flat = flat_table(table, Table::kDocument);
  const auto plain = [](const FlatCell& cell) { return markdown_text(cell.text); };
  const auto rule = [](bool number) { return number ? "---:" : "---"; };
  std::string out = table.title.empty() ? "" : "### " + markdown_text(table.title) + "\n\n";
  out += "| " + line_of(flat.heads, " | ", markdown_text) + " |\n|";
  out += line_of(flat.numbers, "|", rule) + "|\n";
  for (const auto& row : flat.rows) out += "| " + line_of(row, " | ", plain) + " |\n";
  return table.note.empty() ? out : out + "\n" + markdown_text(table.signs + table.note) + "\n";
}

std::string in_latex(const Table& table) {
  const FlatTable flat = flat_table(table, Table::kDocument);
  const auto head = [](const std::string& text) { return latex_text(printable(text)); };
  const auto plain = [](const FlatCell& cell) {
    return cell.is_unit ? latex_unit(printable(cell.text)) : latex_text(printable(cell.text));
  };
  const auto alignment = [](bool number) { return number ? "r" : "l"; };
  std::string out = "\\begin{tabular}{" + line_of(flat.numbers, "", alignment) + "}\n  \\hline\n  ";
  out += line_of(flat.heads, " & ", head) + " \\\\\n  \\hline\n";
  for (const auto& row : flat.rows) out += "  " + line_of(row, " & ", plain) + " \\\\\n";
  return out + "  \\hline\n\\end{tabular}\n";
}

std::string in_csv(const Table& table) {
  const auto has_interval = [](const std::string& key) { return key.find(',') != key.npos; };
  std::string out;
  for (const Table::Column& column : table.columns)
    if (!column.key.empty()) out += column.key + ",";
  out.back() = '\n';
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      const std::string& key = table.columns[c].key;
      const Cell& cell = table.cell(r, c);
      if (key.empty()) continue;
      out += cell.is_number ? csv_cell(cell.value) : csv_cell(cell.data.empty() ? cell.text : cell.data);
      if (has_interval(key)) out += "," + csv_cell(cell.ci95.low) + "," + csv_cell(cell.ci95.high);
      out += ',';
    }
    out.back() = '\n';
  }
  return out;
}

}  // namespace

std::string table_text(const Table& table, TableFormat format) {
  switch (format) {
    case TableFormat::markdown:
      return in_markdown(table);
    case TableFormat::latex:
      return in_latex(table);
    case TableFormat::csv:
      return in_csv(table);
  }
  return "";
}

}  // namespace libchar
