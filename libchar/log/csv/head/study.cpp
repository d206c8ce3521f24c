#include "libchar/log/csv/head/study.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <utility>

#include "libchar/core/refusal.hpp"
#include "libchar/log/detail/column_name.hpp"
#include "libchar/log/time/time_column.hpp"

namespace libchar::csv {
namespace {

// "ax ay az" above "17 0.1 0.2 0.3": a first column of row numbers, or below a comment of stamps, has no name.
bool leaves_first_unnamed(const Study& study, std::string_view text, const Field& first) {
  constexpr std::size_t kFewest = 8;
  const bool comment = std::any_of(study.comments.begin(), study.comments.end(), [&](const Line& line) {
    return text.data() >= line.text.data() && text.data() < line.text.data() + line.text.size();
  });
  std::vector<double> values;
  bool whole = true;
  for (const Line& line : study.sample) {
    const Cells cells = cells_in(study.dialect, line.text);
    const Cell cell = cells.size() == study.columns ? read_cell(cells[0].text, study.dialect.decimal) : Cell{};
    if (cell.kind != Cell::value) continue;
    values.push_back(cell.number);
    whole = whole && cell.integer;
  }
  if (values.size() < kFewest || called_count(first.text)) return false;
  const double step = usual_step(values);
  for (std::size_t i = 1; i < values.size(); ++i) {
    const double here = values[i] - values[i - 1];
    if (whole ? here != 1 : !(here > 0.5 * step && here < 1.5 * step)) return false;
  }
  return whole || comment;
}

// R does not name the first column, of row numbers; others name the first ones alone, where the time is among them and
// no comma of the rows is a decimal one.
void add_missing_names(const Study& study, std::string_view text, Cells& fields) {
  const std::size_t columns = study.columns, rows = study.sample.size();
  const auto is_word = [&](const Field& field) { return cell_kind(field, study.style()) == CellKind::word; };
  if (rows < 3 || 2 * fields.size() < columns || !std::all_of(fields.begin(), fields.end(), is_word)) return;
  const Cells last = cells_in(study.dialect, study.sample[rows - 1].text),
              before = cells_in(study.dialect, study.sample[rows - 2].text);
  if (last.size() != columns || before.size() != columns) return;
  // Between single blanks an empty first cell is a blank in front of the line, where rows have none.
  const auto indented = [](std::string_view line) { return line.starts_with(' '); };
  if (study.dialect.delimiter == ' ' && fields.size() + 1 == columns && indented(text) &&
      !indented(study.sample[rows - 1].text) && !indented(study.sample[rows - 2].text)) {
    fields.insert(fields.begin(), Field{"", 0, false});
    return;
  }
  const auto says_time = [](const Field& field) {
    const auto name = time_name(name_and_unit(field.text).first);
    return name && !name->date;
  };
  constexpr double kFirstWeek = 1000, kLastWeek = 4000, kWeek = 604800;
  const Cell week = read_cell(last[0].text, '.'), second = read_cell(last[columns > 1 ? 1 : 0].text, '.');
  if (fields.size() + 1 == columns && says_time(fields[0]) && week.integer && week.number > kFirstWeek &&
      week.number < kLastWeek && second.kind == Cell::value && second.number >= 0 && second.number < kWeek &&
      read_cell(before[0].text, '.').number == week.number)
    fields.insert(fields.begin(), Field{"week", fields[0].offset, false});  // "GPST" of RTKLIB stands above both
  if (fields.size() == columns) return;
  const bool quoted = std::all_of(fields.begin(), fields.end(), [](const Field& f) { return f.quoted; });
  const bool time = fields.size() > 1 && std::any_of(fields.begin(), fields.end(), says_time);
  const Cell a = read_cell(before[0].text, '.'), b = read_cell(last[0].text, '.');
  const bool counts = a.kind == Cell::value && b.kind == Cell::value && a.integer && b.number == a.number + 1;
  if (fields.size() + 1 == columns &&
      ((quoted && last[0].quoted) || (time && counts) || (!time && leaves_first_unnamed(study, text, fields[0]))))
    fields.insert(fields.begin(), Field{"", 0, true});
  const auto has_point = [](const Field& field) { return field.text.find('.') != std::string::npos; };
  if (!time || (study.dialect.delimiter == ',' && std::none_of(last.begin(), last.end(), has_point))) return;
  while (fields.size() < columns) fields.push_back(Field{"", fields.back().offset, false});
}

// LabVIEW names a column of comments that its rows do not have; names with commas in them are known by the brackets
// around those, or by the blanks behind them.
void fit_names(const Study& study, std::string_view text, Cells& fields) {
  const std::size_t columns = study.columns;
  if (fields.size() == columns + 1 && fields.back().text == "Comment") fields.pop_back();
  if (fields.size() < columns) add_missing_names(study, text, fields);
  const auto behind_blank = [&](const Field& field) {
    return &field != fields.data() && field.offset > 0 && text[field.offset - 1] == ' ';
  };
  std::vector<bool> inside(fields.size());
  std::size_t at = 0;
  int depth = 0;
  for (std::size_t k = 0; k < fields.size(); ++k) {
    for (; at < std::min(fields[k].offset, text.size()); ++at)
      depth += text[at] == '(' || text[at] == '[' ? 1 : text[at] == ')' || text[at] == ']' ? -1 : 0;
    inside[k] = depth > 0;
  }
  const auto in_brackets = [&](const Field& field) { return inside[static_cast<std::size_t>(&field - fields.data())]; };
  const std::size_t more = study.dialect.delimiter == ',' && fields.size() > columns ? fields.size() - columns : 0;
  const auto explains = [&](const auto& joined) {
    return more > 0 && std::count_if(fields.begin(), fields.end(), joined) == static_cast<std::ptrdiff_t>(more);
  };
  const bool brackets = explains(in_brackets);
  if (!brackets && !explains(behind_blank)) return;
  Cells out;
  for (Field& field : fields)
    if (brackets ? in_brackets(field) : behind_blank(field))
      out.back().text += (behind_blank(field) ? ", " : ",") + field.text;
    else
      out.push_back(std::move(field));
  fields = std::move(out);
}

void add_cells(const Dialect& dialect, std::string_view text, bool whole, const std::vector<std::size_t>& columns,
               std::size_t most, std::vector<std::vector<Cells>>& out) {
  std::size_t full = 0;
  const auto add = [&](std::size_t k, Field cell) {
    if (out[k].size() == most || read_cell(cell.text, '.').kind == Cell::missing) return;
    out[k].push_back({std::move(cell)});
    if (out[k].size() == most) ++full;
  };
  for (std::size_t offset = 0; offset < text.size() && full < columns.size();) {
    const Line line = line_at(text, offset, 0);
    offset = line.after;
    if (offset == text.size() && !whole) return;  // may be cut
    if (is_comment(line.text, dialect.lines.semicolon_comments)) continue;
    if (columns.size() == 1) {
      if (auto cell = cell_at(line.text, columns[0], dialect.delimiter)) add(0, std::move(*cell));
      continue;
    }
    Cells cells = split(line.text, dialect.delimiter);
    for (std::size_t k = 0; k < columns.size() && columns[k] < cells.size(); ++k) add(k, std::move(cells[columns[k]]));
  }
}

constexpr std::size_t kPlaces = 64, kLook = 4096;

// Hands whole lines at places all over a file to `take`; none of one that is no file, or whose bytes are not its text:
// compressed, or UTF-16.
template <class Take>
void at_places(const std::string& path, std::string_view head, const Take& take) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) return;
  std::ifstream file(path, std::ios::binary);
  const std::uint64_t size = std::filesystem::file_size(path, none);
  std::string text(kLook, '\0');
  const auto look_at = [&](std::uint64_t place) {
    file.seekg(static_cast<std::streamoff>(place));
    return static_cast<bool>(file.read(text.data(), static_cast<std::streamsize>(kLook)));
  };
  if (!look_at(0) || !head.starts_with(text)) return;
  for (std::size_t k = 1; k <= kPlaces; ++k) {
    if (!look_at(size / kPlaces * k - std::min<std::uint64_t>(kLook, size / kPlaces))) break;
    take(std::string_view(text).substr(std::min(text.find('\n'), kLook - 1) + 1));
  }
}

void add_rows(const Dialect& dialect, std::string_view text, bool whole, Stretches& out) {
  out.emplace_back();
  for (std::size_t offset = 0; offset < text.size();) {
    const Line line = line_at(text, offset, 0);
    offset = line.after;
    if (offset == text.size() && !whole) return;  // may be cut
    if (!trimmed(line.text).empty() && !is_comment(line.text, dialect.lines.semicolon_comments))
      out.back().push_back(cells_in(dialect, line.text));
  }
}

}  // namespace

Refusal refusal(const Study& study, const Line& line, std::size_t column, std::string code) {
  return input_error(std::move(code), at(study.info.file, line.number, column + 1, line.offset + column));
}

Cells cells_in(const Dialect& dialect, std::string_view text, bool* open) {
  std::size_t after = 0;
  const auto lead = dialect.lead.empty() ? std::nullopt : lead_of(text, dialect.lead, after);
  Cells out = split(text.substr(after), dialect.delimiter, open);
  for (Field& field : out) field.offset += after;
  if (lead) out.insert(out.begin(), *lead);
  return out;
}

Cells table_cells(const Study& study, std::string_view text) {
  Cells out = cells_in(study.dialect, text);
  const bool ends_empty = study.dialect.delimiter != ' ' && out.back().text.empty() && !out.back().quoted;
  if (ends_empty && out.size() == study.columns + 1) out.pop_back();
  if (out.size() != study.columns) fit_names(study, text, out);
  return out;
}

std::vector<std::vector<Cells>> filled_cells(const Study& study, const std::vector<std::size_t>& columns,
                                             std::size_t most) {
  std::vector<std::vector<Cells>> out(columns.size());
  const std::string_view body = study.head.substr(std::min(study.dialect.data_offset, study.head.size()));
  if (study.dialect.lead.empty()) add_cells(study.dialect, body, study.whole, columns, most, out);
  return out;
}

std::vector<Cells> cells_further_on(const Study& study, std::size_t column) {
  std::vector<std::vector<Cells>> out(1);
  if (!study.whole)
    at_places(study.info.file, study.head, [&](std::string_view lines) {
      add_cells(study.dialect, lines, false, {column}, std::numeric_limits<std::size_t>::max(), out);
    });
  return std::move(out[0]);
}

Stretches stretches_of(const Study& study) {
  Stretches out;
  if (!study.whole)
    at_places(study.info.file, study.head, [&](std::string_view lines) { add_rows(study.dialect, lines, false, out); });
  if (!out.empty()) return out;
  const std::string_view body = study.head.substr(std::min(study.dialect.data_offset, study.head.size()));
  if (body.size() <= kPlaces * kLook) {
    add_rows(study.dialect, body, study.whole, out);
    return out;
  }
  for (std::size_t k = 1; k <= kPlaces; ++k) {
    const std::string_view text = body.substr(body.size() / kPlaces * k - kLook, kLook);
    add_rows(study.dialect, text.substr(std::min(text.find('\n'), kLook - 1) + 1), false, out);
  }
  return out;
}

Stretches stretches_of(const std::string& path, const Dialect& dialect) {
  std::error_code none;
  if (!std::filesystem::is_regular_file(path, none)) return {};
  std::string head(kPlaces * kLook, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  const ReadOptions options;
  LogInfo info;
  info.file = path;
  return stretches_of(Study{.head = head, .whole = file.eof(), .options = options, .info = info, .dialect = dialect});
}

}  // namespace libchar::csv
