// Every CSV case of fixtures/known/badinputs: verdict, place and one line of reason as EXPECT.tsv says.
#include <algorithm>
#include <catch2/catch.hpp>
#include <map>
#include <sstream>
#include <vector>

#include "libchar/core/error.hpp"
#include "libchar/log/quality.hpp"
#include "libchar/log/read.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;

namespace {

struct Expected {
  std::string file, verdict, place;
};

// Refused when the table was written, and read since: what is guessed of them is said.
const std::map<std::string, std::string> kReadSince = {
    {"csv/036_latin1_header.csv", "ok"},
};

std::vector<Expected> table() {
  std::vector<Expected> rows;
  std::istringstream in(test::slurp(test::known("badinputs/EXPECT.tsv")));
  for (std::string line; std::getline(in, line);) {
    if (line.rfind("csv/", 0) != 0) continue;
    std::istringstream cells(line);
    Expected row;
    std::getline(cells, row.file, '\t');
    std::getline(cells, row.verdict, '\t');
    std::getline(cells, row.place, '\t');
    if (const auto since = kReadSince.find(row.file); since != kReadSince.end()) {
      row.verdict = since->second;
      row.place = "-";
    }
    rows.push_back(row);
  }
  return rows;
}

// Places that were counted wrongly by hand, with the count done again.
const std::map<std::string, std::string> kRecounted = {
    // "0,00,1,5": the first field too many ("1") starts in column 6; 5 is the comma before it.
    // 013_long_row counts the field.
    {"csv/038_comma_decimal_comma.csv", "2:6"},
};

// What the reason must name, so that no case passes for the wrong cause.
const std::map<std::string, std::string> kReason = {
    {"csv/011_truncated_number.csv", "exponent"},
    {"csv/013_long_row.csv", "4 fields, 3 expected"},
    {"csv/019_footer_row.csv", "END"},
    {"csv/023_repeated_header.csv", "`skip_repeated_header`"},
    {"csv/025_unterminated_quote.csv", "quote"},
    {"csv/027_text_after_quote.csv", "closing quote"},
    {"csv/030_nul_byte.csv", "NUL"},
    {"csv/032_ctrl_z.csv", "0x1A"},
    {"csv/035_npy_named_csv.csv", "NPY"},
    {"csv/038_comma_decimal_comma.csv", "decimal comma"},
    {"csv/041_underscore.csv", "underscore"},
    {"csv/053_overflow_neg.csv", "out of range"},
    {"csv/054_exp_4e492493924924.csv", "out of range"},
    {"csv/061_double_sign.csv", "signs"},
    {"csv/062_dots.csv", "digits"},
    {"csv/065_unicode_minus.csv", "U+2212"},
    {"csv/067_nbsp.csv", "U+00A0"},
    {"csv/068_zero_width.csv", "U+200B"},
    {"csv/073_time_overflow.csv", "64-bit"},
    {"csv/074_bool_words.csv", "number was expected"},
    {"csv/083_jump_garbage.csv", "wild"},
    {"csv/086_zero_dt_all.csv", "no time axis"},
    {"csv/088_nan_time.csv", "missing time stamp"},
    {"csv/093_all_nan.csv", "no finite value"},
    {"csv/102_long_field.csv", "128 KiB"},
    {"csv/003_no_header.csv", "no header"},
    {"csv/007_cr_only.csv", "carriage return"},
    {"csv/008_mixed_eol.csv", "line ends"},
    {"csv/014_trailing_comma.csv", "empty last column"},
    {"csv/015_blank_lines.csv", "blank"},
    {"csv/016_comment_lines.csv", "comment"},
    {"csv/021_empty_header_cell.csv", "without a name"},
    {"csv/051_inf_words.csv", "infinities"},
    {"csv/085_jitter.csv", "scatter"},
    {"csv/089_two_rates.csv", "rate changes (100 to 50 Hz)"},
    {"csv/095_quantised.csv", "distinct values"},
    {"csv/098_formula_name.csv", "formula"},
    {"csv/100_bidi_name.csv", "direction"},
};

// "line 3, column 6" → "3:6"
std::string as_place(const std::string& text) {
  const std::size_t line = text.find("line ");
  if (line != 0) return text;
  const std::size_t comma = text.find(", column ");
  return text.substr(5, comma == std::string::npos ? std::string::npos : comma - 5) + ":" +
         (comma == std::string::npos ? "1" : text.substr(comma + 9));
}

}  // namespace

TEST_CASE("every bad CSV input gets its verdict, place and reason") {
  const auto rows = table();
  REQUIRE(rows.size() == 54);
  for (const Expected& row : rows) {
    const std::string path = test::known("badinputs/" + row.file).string();
    const std::string place = kRecounted.count(row.file) > 0 ? kRecounted.at(row.file) : row.place;
    const std::string reason = kReason.count(row.file) > 0 ? kReason.at(row.file) : "";
    INFO(row.file << " " << row.verdict << " " << place);
    for (const std::size_t block_bytes : {std::size_t{1}, std::size_t{7}, std::size_t{1} << 22U}) {
      ReadOptions options;
      options.block_bytes =
          row.file.find("5000") != std::string::npos ? std::max<std::size_t>(block_bytes, 512) : block_bytes;
      std::string verdict = "ok", said;
      std::vector<std::string> places;
      try {
        const Recording recording = read_recording(path, options);
        // One sample is a recording: a deviation is refused by those that compute it.
        if (row.file == "csv/090_one_sample.csv") {
          CHECK(recording.info.samples == 1);
          continue;
        }
        for (const Finding& warning : recording.info.warnings.list()) {
          verdict = "warn";
          said += one_line(warning, path) + "\n";
          for (const std::string& p : warning.where.rows) places.push_back(as_place(p));
        }
      } catch (const Error& error) {
        verdict = "error";
        said = error.what();
        CHECK(said.find('\n') == std::string::npos);
        CHECK((error.problem().kind == ErrorKind::input || error.problem().kind == ErrorKind::numeric));
        const std::string& where = error.problem().where;
        REQUIRE(where.rfind(path, 0) == 0);
        std::string rest = where.substr(std::min(where.size(), path.size() + 1));
        places.push_back(rest.substr(0, rest.find(' ')));
      }
      INFO(said);
      CHECK(verdict == row.verdict);
      if (place != "-") CHECK(std::find(places.begin(), places.end(), place) != places.end());
      CHECK(said.find(reason) != std::string::npos);
      CHECK((row.verdict == "ok" || !reason.empty()));
    }
  }
}
