// Excel's .xlsx (ECMA-376, Office Open XML): a ZIP archive with XML for each sheet of cells. A sheet becomes the text
// of a table: numbers keep their digits, cells whose style is a date become dates.
//   serial day s, 1900 system: 1899-12-30 + s;  1904 system: 1904-01-01 + s

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <map>
#include <optional>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/text.hpp"
#include "libchar/log/csv/head/dialect.hpp"
#include "libchar/log/csv/line.hpp"
#include "libchar/log/csv/made_text.hpp"
#include "libchar/log/detail/format.hpp"
#include "libchar/log/tables/member_text.hpp"
#include "libchar/log/tables/table_reader.hpp"
#include "libchar/log/tables/xml_events.hpp"

namespace libchar {
namespace {

/// Bytes of shared texts that are kept; a workbook of measurements has a few.
constexpr std::size_t kMostShared = std::size_t{64} << 20U;

enum class Style : unsigned char { number, date, clock };

struct Book {
  std::vector<std::string> shared;
  std::vector<Style> styles;  ///< of cells
  double first_day = 0;       ///< added to a serial day for days since 1899-12-30
};

/// Does a format of numbers show a date, a clock time, or neither? Letters in quotes, brackets and
/// behind \ do not count.
Style style_of(std::string_view format) {
  bool day = false, clock = false;
  for (std::size_t i = 0; i < format.size(); ++i) {
    const char c = static_cast<char>(format[i] | 0x20);
    if (format[i] == '\\' || format[i] == '_') {
      ++i;
    } else if (format[i] == '"' || format[i] == '[') {
      const bool elapsed = format[i] == '[' && i + 1 < format.size() &&
                           std::string_view("hHmMsS").find(format[i + 1]) != std::string_view::npos;
      clock = clock || elapsed;
      i = std::min(format.find(format[i] == '"' ? '"' : ']', i + 1), format.size());
    } else if (format[i] == ';') {
      break;
    } else {
      day = day || c == 'd' || c == 'y';
      clock = clock || c == 'h' || c == 's';
    }
  }
  return day ? Style::date : clock ? Style::clock : Style::number;
}

Style built_in_style(unsigned id) {
  if ((id >= 14 && id <= 17) || id == 22 || (id >= 27 && id <= 36)) return Style::date;
  return (id >= 18 && id <= 21) || (id >= 45 && id <= 47) ? Style::clock : Style::number;
}

template <class T>
T whole(std::string_view text) {
  T value = 0;
  std::from_chars(text.data(), text.data() + text.size(), value);
  return value;
}

/// To the microsecond, of which a double of a serial day has .6.
std::string date_text(double serial, Style style, double first_day) {
  using namespace std::chrono;
  constexpr double kMostDays = 2958466;  // the year 10000
  if (!(serial >= 0 && serial < kMostDays)) return "";
  const auto us = clamped_whole<std::int64_t>(std::round((serial + (style == Style::date ? first_day : 0)) * 86400e6));
  const auto day = us / 86400000000, in_day = us % 86400000000;
  const std::string clock = fmt::format("{:02}:{:02}:{:02}.{:06}", in_day / 3600000000, in_day / 60000000 % 60,
                                        in_day / 1000000 % 60, in_day % 1000000);
  if (style == Style::clock && day == 0) return clock;
  const year_month_day date{sys_days{year{1899} / 12 / 30} + days{day}};
  return fmt::format("{:04}-{:02}-{:02} {}", static_cast<int>(date.year()), static_cast<unsigned>(date.month()),
                     static_cast<unsigned>(date.day()), clock);
}

/// "AB12": 27.
std::size_t column_of_cell(std::string_view place, std::size_t otherwise) {
  std::size_t column = 0, letters = 0;
  for (; letters < place.size() && place[letters] >= 'A' && place[letters] <= 'Z' && letters < 3; ++letters)
    column = 26 * column + static_cast<std::size_t>(place[letters] - 'A') + 1;
  return letters == 0 ? otherwise : column - 1;
}

class SheetText final : public csv::MadeText {
 public:
  SheetText(const BinaryFile& file, const ZipMember& member, const Book& book)
      : xml_bytes_(member.stretch.bytes),
        member_(file, member),
        xml_([this](char* to, std::size_t n) { return member_.read(to, n); },
             file.path() + ", " + printable(member.name)),
        book_(book) {}
  std::string_view what() const override { return "a sheet of a workbook"; }
  std::string_view format() const override { return "xlsx"; }
  bool headed() const override { return false; }
  std::uint64_t stored_bytes() const override { return xml_bytes_; }

 protected:
  bool more(std::string& text) override {
    using Kind = XmlEvents::Kind;
    for (Kind kind = xml_.next(); kind != Kind::end; kind = xml_.next()) {
      if (kind == Kind::open && xml_.name() == "row") {
        cells_.clear();
        row_bytes_ = 0;
        measured_ = false;
      } else if (kind == Kind::open && xml_.name() == "c") {
        cell();
      } else if (kind == Kind::close && xml_.name() == "row") {
        row(text);
        return true;
      }
    }
    return false;
  }

 private:
  void cell() {
    const std::size_t column = column_of_cell(xml_.attribute("r"), cells_.size());
    if (column >= csv::kMaxColumns) return;
    const std::string type = xml_.attribute("t");
    const auto style = whole<std::size_t>(xml_.attribute("s"));
    std::string value;
    using Kind = XmlEvents::Kind;
    bool counts = false, phonetic = false;  // text inside <v> or <t>, not the reading aid beside it
    for (Kind kind = xml_.next(); kind != Kind::end; kind = xml_.next()) {
      const std::string& name = xml_.name();
      if (kind == Kind::text && counts && value.size() <= csv::kMaxField) value += xml_.text();
      if (kind == Kind::text) continue;
      if (kind == Kind::close && name == "c") break;
      if (name == "rPh") phonetic = kind == Kind::open;
      counts = kind == Kind::open && (name == "v" || name == "t") && !phonetic;
    }
    if (value.empty() || type == "e" || row_bytes_ > csv::kMaxLine) return;  // such a row is refused
    if (cells_.size() <= column) cells_.resize(column + 1);
    cells_[column] = shown(value, type, style < book_.styles.size() ? book_.styles[style] : Style::number);
    row_bytes_ += cells_[column].size();
  }

  std::string shown(const std::string& value, const std::string& type, Style style) {
    std::string cell;
    if (type == "s") {
      const auto index = whole<std::size_t>(value);
      if (index < book_.shared.size()) add_quoted(cell, book_.shared[index]);
    } else if (type == "b") {
      cell = value == "1" ? "TRUE" : "FALSE";
    } else if (type.empty() || type == "n" || type == "d") {
      measured_ = true;
      const auto serial = parse_double(value);
      if (style != Style::number && serial)
        cell = date_text(*serial, style, book_.first_day);
      else
        cell = value;
    } else {
      add_quoted(cell, value);
    }
    return cell;
  }

  /// Cells behind the last one of a row of numbers are empty and not stored.
  void row(std::string& text) {
    width_ = std::max(width_, cells_.size());
    if (measured_) cells_.resize(width_);
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      if (c > 0) text += ',';
      text += cells_[c];
    }
    text += '\n';
  }

  std::uint64_t xml_bytes_;
  MemberText member_;
  XmlEvents xml_;
  const Book& book_;
  std::vector<std::string> cells_;
  std::size_t width_ = 0, row_bytes_ = 0;
  bool measured_ = false;  // the row holds a number
};

class Workbook final : public TableReader {
 public:
  Workbook(const std::string& path, const ReadOptions&) : file_(path) {
    for (ZipMember& member : read_zip_directory(file_)) members_.emplace(member.name, std::move(member));
    if (!members_.contains("xl/workbook.xml"))
      throw input_error("E0339", path)
          .says("holds no workbook (xl/workbook.xml)")
          .hint("save it as .xlsx again, or as CSV");
    read_styles();
    read_shared();
    read_sheets();
  }
  std::vector<std::string> dialect() const override { return {"workbook of " + plural(sheets_.size(), "sheet")}; }
  std::optional<std::pair<std::size_t, std::string>> usual_table() const override {
    // A sheet of notes has no rows of numbers.
    for (const std::uint64_t rows : {std::uint64_t{2}, std::uint64_t{0}})
      for (std::size_t t = 0; sheets_.size() > 1 && t < sheets_.size(); ++t)
        if (topics()[t].why_not.empty() && topics()[t].rows >= rows)
          return std::pair(t, fmt::format("sheet: {}, the first table of {} (`topic` takes another one)",
                                          printable(topics()[t].name), plural(sheets_.size(), "sheet")));
    return {};
  }
  std::unique_ptr<RowSource> open_table(std::size_t topic, const ReadOptions& options) override {
    const auto sheet = members_.find(sheets_[topic]);
    if (sheet == members_.end())
      throw input_error("E0339", file_.path()).says("does not hold the sheet").got(sheets_[topic]);
    return csv::open_text(std::make_unique<SheetText>(file_, sheet->second, book_),
                          fmt::format("{}, sheet {}", file_.path(), topic + 1), options);
  }

 private:
  /// Calls `tag` at each tag that opens in a part, if it is there.
  template <class F>
  void walk(const std::string& part, F tag) {
    const auto found = members_.find(part);
    if (found == members_.end()) return;
    MemberText member(file_, found->second);
    XmlEvents xml([&](char* to, std::size_t n) { return member.read(to, n); }, file_.path() + ", " + part);
    while (xml.next_open()) tag(xml);
  }

  void read_styles() {
    std::map<unsigned, Style> own;
    bool of_cells = false;
    walk("xl/styles.xml", [&](const XmlEvents& xml) {
      if (xml.name() == "numFmt")
        own[whole<unsigned>(xml.attribute("numFmtId"))] = style_of(xml.attribute("formatCode"));
      if (xml.name() == "cellXfs" || xml.name() == "cellStyleXfs" || xml.name() == "cellStyles")
        of_cells = xml.name() == "cellXfs";
      if (xml.name() != "xf" || !of_cells) return;
      const auto id = whole<unsigned>(xml.attribute("numFmtId"));
      const auto found = own.find(id);
      book_.styles.push_back(found == own.end() ? built_in_style(id) : found->second);
    });
  }

  void read_shared() {
    const auto found = members_.find("xl/sharedStrings.xml");
    if (found == members_.end()) return;
    MemberText member(file_, found->second);
    XmlEvents xml([&](char* to, std::size_t n) { return member.read(to, n); }, file_.path() + ", xl/sharedStrings.xml");
    using Kind = XmlEvents::Kind;
    std::size_t bytes = 0;
    bool counts = false, phonetic = false;
    for (Kind kind = xml.next(); kind != Kind::end; kind = xml.next()) {
      if (kind == Kind::text) {
        if (counts && !book_.shared.empty()) book_.shared.back() += xml.text();
        bytes += xml.text().size();
        continue;
      }
      if (kind == Kind::open && xml.name() == "si") {
        book_.shared.emplace_back();
        bytes += sizeof(std::string);
      }
      if (xml.name() == "rPh") phonetic = kind == Kind::open;
      counts = kind == Kind::open && xml.name() == "t" && !phonetic;
      if (bytes > kMostShared)
        throw input_error("E0339", file_.path())
            .says("holds more than {} MiB of texts", kMostShared >> 20U)
            .hint("save the sheet as CSV");
    }
  }

  void read_sheets() {
    std::map<std::string, std::string> parts;
    walk("xl/_rels/workbook.xml.rels", [&](const XmlEvents& xml) {
      std::string target = xml.attribute("Target");
      if (xml.name() == "Relationship")
        parts[xml.attribute("Id")] = target.starts_with('/') ? target.substr(1) : "xl/" + target;
    });
    std::vector<std::string> names;
    walk("xl/workbook.xml", [&](const XmlEvents& xml) {
      const std::string system = xml.attribute("date1904");
      if (xml.name() == "workbookPr" && (system == "1" || system == "true")) book_.first_day = 1462;
      if (xml.name() != "sheet") return;
      names.push_back(xml.attribute("name"));
      sheets_.push_back(parts[xml.attribute("r:id")]);
    });
    for (const std::string& name : names) list_table(name);
  }

  BinaryFile file_;
  std::map<std::string, ZipMember> members_;
  Book book_;
  std::vector<std::string> sheets_;  ///< their parts
};

}  // namespace

Format xlsx_format() {
  Format row;
  row.about.name = "xlsx";
  row.about.title = "Excel workbook";
  row.about.suffixes = {".xlsx"};
  row.about.topics = row.about.text = true;
  row.certain = [](std::string_view front) {
    const std::string_view name = front.substr(std::min<std::size_t>(front.size(), 30));
    return front.starts_with(kLocalMagic) && (name.starts_with("[Content_Types].xml") || name.starts_with("xl/"));
  };
  row.topics = open_topics<Workbook>;
  return row;
}

}  // namespace libchar
