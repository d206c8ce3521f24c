// Tables written in every dialect that comes of delimiter × decimal mark × quotes × header × units × dates × text
// columns × comments, with one to eight columns and 5 to 5,000 rows. Each is read with its values, names, units and
// rate, or refused; none is read wrong in silence, and at least 98 of 100 are read.

#include <fmt/format.h>

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "libchar/core/error.hpp"
#include "libchar/log/read.hpp"
#include "tests/log/log_text.hpp"

using namespace libchar;

namespace {

enum class Stamps { none, seconds, epoch_ms, iso, date_and_clock, slashes, count };
enum class Words { none, dense, sparse, late, tuples, newlines, count };
enum class Header { none, names, units_in_names, units_below, count };
enum class Quotes { none, header, words, all, count };
enum class Front { none, comments, semicolons, preamble, utf16, count };

struct WrittenDialect {
  char delimiter = ',';
  bool comma = false, crlf = false;
  Stamps stamps = Stamps::seconds;
  Words words = Words::none;
  Header header = Header::names;
  Quotes quotes = Quotes::none;
  Front front = Front::none;
  std::size_t columns = 1, rows = 5;
  int digits = 2;
  std::string text;
  std::vector<std::vector<double>> values;

  std::string title() const {
    return fmt::format("delimiter '{}' {} stamps {} words {} header {} quotes {} front {} columns {} rows {} digits {}",
                       delimiter == '\t' ? "tab" : std::string(1, delimiter), comma ? "comma" : "point",
                       static_cast<int>(stamps), static_cast<int>(words), static_cast<int>(header),
                       static_cast<int>(quotes), static_cast<int>(front), columns, rows, digits);
  }
};

template <class E>
E pick(std::mt19937_64& random) {
  return static_cast<E>(random() % static_cast<std::uint64_t>(E::count));
}

std::string in_quotes(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + '"';
}

std::string line_of(const WrittenDialect& w, const std::vector<std::string>& cells) {
  std::string out;
  for (std::size_t c = 0; c < cells.size(); ++c) out += (c == 0 ? "" : std::string(1, w.delimiter)) + cells[c];
  return out + (w.crlf ? "\r\n" : "\n");
}

// Seconds between rows: a tenth, and a minute where no fraction is written.
double step_of(const WrittenDialect& w) {
  return w.stamps == Stamps::slashes ? 60 : w.stamps == Stamps::date_and_clock ? 1 : 0.1;
}

std::vector<std::string> stamp_cells(const WrittenDialect& w, std::size_t row) {
  const auto clock = [&](std::size_t tenths) {
    return fmt::format("{:02d}:{:02d}:{:02d}", tenths / 36000 % 24, tenths / 600 % 60, tenths / 10 % 60);
  };
  const std::size_t day = 11 + row / 86400;
  switch (w.stamps) {
    case Stamps::seconds: {
      std::string text = fmt::format("{:.1f}", 0.1 * static_cast<double>(row));
      if (w.comma) std::replace(text.begin(), text.end(), '.', ',');
      return {text};
    }
    case Stamps::epoch_ms:
      return {fmt::format("{}", 1700000000000 + 100 * row)};
    case Stamps::iso:
      return {fmt::format("2026-11-22T{}.{}", clock(row), row % 10)};
    case Stamps::date_and_clock:
      return {fmt::format("{:02d}.11.2026", day), clock(10 * row)};
    case Stamps::slashes:
      return {fmt::format("11/{:02d}/2026{}{:02d}:{:02d}", 20 + row / 1440, w.delimiter == ' ' ? "T" : " ",
                          row / 60 % 24, row % 60)};
    default:
      return {};
  }
}

std::vector<std::string> stamp_names(const WrittenDialect& w) {
  if (w.stamps == Stamps::none) return {};
  if (w.stamps == Stamps::date_and_clock) return {"Datum", "Uhrzeit"};
  if (w.stamps == Stamps::seconds || w.stamps == Stamps::epoch_ms) return {"time"};
  return {"Timestamp"};
}

std::string number(const WrittenDialect& w, double value) {
  std::string text = fmt::format("{:.{}f}", value, w.digits);
  if (w.comma) std::replace(text.begin(), text.end(), '.', ',');
  return text;
}

std::string words(const WrittenDialect& w, std::size_t row) {
  static constexpr const char* kStates[] = {"OK", "idle", "moving", "OK"};
  switch (w.words) {
    case Words::dense:
      return kStates[row % 4];
    case Words::sparse:
      return row % 7 == 3 ? "bump" : "";
    case Words::late:
      return row < 120 ? "" : kStates[row % 4];
    case Words::tuples:
      return in_quotes(fmt::format("({}.5, {}, \"a\")", row, row % 3));
    case Words::newlines:
      return in_quotes(fmt::format("first\nsecond; {}, third", row));
    default:
      return "";
  }
}

void write_front(WrittenDialect& w) {
  const std::string end = w.crlf ? "\r\n" : "\n";
  if (w.front == Front::comments) w.text += "# Logger 17, made in May; serial 4" + end + "# bench" + end;
  if (w.front == Front::semicolons) w.text += "; Logger 17, made in May" + end + "; bench" + end;
  if (w.front == Front::preamble) w.text += "Logger type 17" + end + "Booting... ok" + end + "IMU found at 0x68" + end;
}

void write_header(WrittenDialect& w) {
  if (w.header == Header::none) return;
  std::vector<std::string> names = stamp_names(w), units(names.size(), "");
  const bool brackets = w.header == Header::units_in_names;
  for (std::size_t c = 0; c < w.columns; ++c) {
    names.push_back(fmt::format("ch{}{}", c, brackets ? (w.delimiter == ' ' ? "[V]" : " [V]") : ""));
    units.emplace_back("V");
  }
  if (w.words != Words::none) {
    names.emplace_back("note");
    units.emplace_back("");
  }
  if (w.quotes == Quotes::header || w.quotes == Quotes::all)
    for (std::string& name : names) name = in_quotes(name);
  w.text += line_of(w, names);
  if (w.header == Header::units_below) w.text += line_of(w, units);
}

void write_rows(WrittenDialect& w, std::mt19937_64& random) {
  std::normal_distribution<double> noise(0, 1);
  w.values.assign(w.columns, {});
  for (std::size_t row = 0; row < w.rows; ++row) {
    std::vector<std::string> cells = stamp_cells(w, row);
    for (std::size_t c = 0; c < w.columns; ++c) {
      cells.push_back(number(w, 21.0 * static_cast<double>(c % 3) + noise(random)));
      std::string plain = cells.back();
      std::replace(plain.begin(), plain.end(), ',', '.');
      w.values[c].push_back(std::stod(plain));
    }
    if (w.quotes == Quotes::all)
      for (std::string& cell : cells) cell = in_quotes(cell);
    if (w.words != Words::none) cells.push_back(words(w, row));
    const bool plain_words = w.words != Words::tuples && w.words != Words::newlines;
    if (plain_words && w.words != Words::none && (w.quotes == Quotes::words || w.quotes == Quotes::all))
      cells.back() = in_quotes(cells.back());
    w.text += line_of(w, cells);
  }
}

// What no writer of tables writes, or nobody can tell: cells that are not kept apart.
bool sensible(const WrittenDialect& w) {
  if (w.delimiter == ',' && w.comma && w.quotes != Quotes::all) return false;
  if (w.delimiter == ' ' && w.header == Header::units_below) return false;
  if (w.delimiter == ' ' && (w.words == Words::sparse || w.words == Words::late)) return w.quotes == Quotes::all;
  if (w.front == Front::semicolons && w.delimiter == ';') return false;
  if (w.stamps == Stamps::none && w.header == Header::none && w.words != Words::none) return false;
  return true;
}

std::string utf16(const std::string& text) {
  std::string out = "\xFF\xFE";
  for (const char c : text) {
    out += c;
    out += '\0';
  }
  return out;
}

WrittenDialect written(std::mt19937_64& random) {
  static constexpr std::size_t kRows[] = {5, 8, 20, 60, 130, 400, 5000};
  for (;;) {
    WrittenDialect w;
    w.delimiter = ",;\t "[random() % 4];
    w.comma = random() % 2 == 0;
    w.crlf = random() % 3 == 0;
    w.stamps = pick<Stamps>(random);
    w.words = random() % 2 == 0 ? Words::none : pick<Words>(random);
    w.header = pick<Header>(random);
    w.quotes = pick<Quotes>(random);
    w.front = random() % 2 == 0 ? Front::none : pick<Front>(random);
    w.columns = 1 + random() % 8;
    w.rows = kRows[random() % std::size(kRows)];
    w.digits = static_cast<int>(random() % 5);
    if (w.digits == 1 && w.columns > 4) w.digits = 6;
    if (w.words == Words::late && w.rows < 200) w.words = Words::sparse;
    if (!sensible(w)) continue;
    write_front(w);
    write_header(w);
    write_rows(w, random);
    if (w.front == Front::utf16) w.text = utf16(w.text);
    return w;
  }
}

// "" when all is right, else what is wrong.
std::string wrong(const WrittenDialect& w, const Recording& r) {
  if (r.info.channels.size() != w.columns) return fmt::format("{} channels", r.info.channels.size());
  for (std::size_t c = 0; c < w.columns; ++c) {
    if (r.samples[c] != w.values[c]) return fmt::format("values of channel {}", c);
    if (w.header == Header::none) continue;
    if (r.info.channels[c].name != fmt::format("ch{}", c)) return "name " + r.info.channels[c].name;
    const bool unit = w.header != Header::names;
    if (r.info.channels[c].unit != (unit ? "V" : "")) return "unit " + r.info.channels[c].unit;
  }
  if (w.stamps != Stamps::none && std::fabs(r.info.time.rate_hz * step_of(w) - 1) > 1e-6)
    return fmt::format("rate {}", r.info.time.rate_hz);
  return "";
}

}  // namespace

TEST_CASE("written dialects: none is read wrong in silence, 98 of 100 are read") {
  constexpr int kDialects = 600;
  std::mt19937_64 random(20261126);
  int read = 0, silent = 0;
  std::string report;
  for (int i = 0; i < kDialects; ++i) {
    const WrittenDialect w = written(random);
    ReadOptions options;
    if (w.stamps == Stamps::none) options.rate_hz = 10;
    try {
      const Recording r = test::read_text(w.text, options);
      const std::string what = wrong(w, r);
      read += what.empty();
      const bool said = std::any_of(r.info.guesses.begin(), r.info.guesses.end(), [](const std::string& guess) {
        return guess.find("`decimal` decide") != std::string::npos;
      });
      silent += !what.empty() && !said;
      if (!what.empty()) report += fmt::format("{}: {}: {}\n", said ? "NAMED" : "SILENT", what, w.title());
    } catch (const Error& error) {
      report += fmt::format("REFUSED: {}: {}\n", w.title(), error.what());
    }
  }
  INFO(report);
  CHECK(silent == 0);
  INFO(fmt::format("{} of {} read", read, kDialects));
  CHECK(100 * read >= 98 * kDialects);
}
