#pragma once
// A table as data: made once of a result, shown by every door. Texts are stored unchanged; each
// renderer escapes them for its place (HTML: report/detail/html/html_tables.hpp).

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/core/text/term_cells.hpp"
#include "libchar/core/text/text_table.hpp"

namespace libchar {

struct Cell {
  struct Mark {
    std::string text;
    std::optional<Tint> tint = {};
  };
  std::string text;       ///< words, or a number as people read it
  std::string data;       ///< words in CSV; "": `text`
  std::string unit;       ///< of the number
  std::string low, high;  ///< ends of its interval; "": none
  std::string sign;       ///< behind it, in texts: "*"
  bool is_number = false;
  double value = kNone;            ///< the number itself, for CSV and for sorting
  Interval ci95 = {kNone, kNone};  ///< the same of its interval
  std::optional<Tint> tint;        ///< the text is a status
  std::vector<Mark> marks;         ///< behind it, on a page
  std::vector<std::string> notes;  ///< below it, on a page
  std::vector<Cell> lines;         ///< one below the other on a page, in a row elsewhere
  std::string anchor, address;     ///< part of this page, or file next to it, that it links to
  bool code = false;               ///< a command, a digest

  Cell() = default;
  Cell(std::string words) : text(std::move(words)) {}
  Cell(std::string_view words) : text(words) {}
  Cell(const char* words) : text(words) {}
  /// "–" for NaN.
  static Cell number(double value, int digits = 4);
  static Cell number(double value, const Interval& ci95, int digits = 4);
  /// Any text of a number.
  static Cell shown(std::string text, double value);
  static Cell of(const ShownValue& shown, const Coefficient& coefficient);
  /// How the coefficient is known.
  static Cell status(const Coefficient& coefficient);
  static Cell word(std::string_view word, Tint tint);
};

struct Table {
  /// Who shows a column. A document: Markdown and LaTeX.
  enum Door : unsigned { kTerminal = 1, kDocument = 2, kPage = 4 };
  struct Column {
    std::string head;
    std::string key = {};    ///< in CSV, of a number "KEY,LOW,HIGH" with its interval; "": not there
    std::string about = {};  ///< what it means, where the pointer rests
    unsigned doors = kTerminal | kDocument | kPage;
    bool folded = false;  ///< on a page, at first
    bool name = false;    ///< the head names something (a sensor, a method): kept as written
  };
  enum class Kind {
    plain,
    best,
    aside,    ///< not compared
    derived,  ///< from the others; on a page its last cell takes the rest of the row
    part,     ///< one cell: the head of the rows below it, on a page
  };
  struct Row {
    std::vector<Cell> cells;
    Kind kind = Kind::plain;
  };

  std::string title;
  std::vector<Column> columns;
  std::vector<Row> rows;
  std::string signs;           ///< those of its cells, in texts: a page has words for them
  std::string note;            ///< below it
  bool whole_numbers = false;  ///< intervals and units follow their numbers in texts as well

  Table() = default;
  /// Heads and keys between "|". A column with a key and no head is in CSV only.
  explicit Table(std::string_view heads, std::string_view keys = "");
  void add(std::vector<Cell> cells, Kind kind = Kind::plain);
  Column& column(std::string_view head);
  void drop(std::string_view head);
  /// An empty cell after the end of a row.
  const Cell& cell(std::size_t row, std::size_t column) const;
  /// Where no row says anything, a column is left out; where all heads are empty, they are.
  bool says_anything(std::size_t column) const;
  bool holds_numbers(std::size_t column) const;
};

std::string terminal_table(const Table& table, const TextLook& look = {}, std::string_view indent = "  ");

enum class TableFormat { markdown, latex, csv };
template <>
inline constexpr auto enum_table<TableFormat> = enum_words<TableFormat, "markdown latex csv">;
/// LaTeX: a tabular that needs no package, without title and note. CSV: columns with a key, texts as
/// csv_cell, numbers that read back.
std::string table_text(const Table& table, TableFormat format = TableFormat::markdown);

}  // namespace libchar
