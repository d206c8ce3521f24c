// A table as data, in each of its renderings.
#include "libchar/core/table/table.hpp"

#include <algorithm>
#include <catch2/catch.hpp>

#include "libchar/core/table/detail/formats.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

Cell status(Status known, double low = 0.2) {
  Coefficient c;
  c.status = known;
  c.ci95 = {low, 0.3};
  return Cell::status(c);
}

Table measured() {
  Table out("term|value|status|in other words", "term|value,low95,high95|status");
  Cell name("N white noise");
  name.data = "white_noise";
  Cell value = Cell::number(0.25, {0.2, 0.3}, 2);
  value.unit = "deg/s";
  out.add({name, value, status(Status::detected), "15 deg/min"});
  out.add({"B", Cell::number(kNone), status(Status::not_detected)});
  return out;
}

}  // namespace

TEST_CASE("a detected term whose interval includes 0 is uncertain in words, detected as data") {
  CHECK(status(Status::detected, 0).text == "uncertain");
  CHECK(status(Status::detected, 0).data == "detected");
  CHECK(status(Status::undetermined, 0).text == "undetermined");
}

TEST_CASE("a table in texts: intervals and units have columns of their own") {
  CHECK(terminal_table(measured()) ==
        "  term           value  95 % interval   unit        status  in other words\n"
        "  N white noise   0.25    0.20 … 0.30  deg/s      detected  15 deg/min\n"
        "  B                  –                        not detected\n");
  CHECK(table_text(measured()) ==
        "| term | value | 95 % interval | unit | status | in other words |\n"
        "|---|---:|---|---|---|---|\n"
        "| N white noise | 0.25 | 0.20 … 0.30 | deg/s | detected | 15 deg/min |\n"
        "| B | – |  |  | not detected |  |\n");
  Table whole = measured();
  whole.whole_numbers = true;
  CHECK_THAT(terminal_table(whole), Contains(" 0.25 [0.20, 0.30] deg/s "));
}

TEST_CASE("a table in CSV: numbers that read back, words of files, nothing for what is not known") {
  CHECK(table_text(measured(), TableFormat::csv) ==
        "term,value,low95,high95,status\nwhite_noise,0.25,0.2,0.3,detected\n"
        "B,,,,not_detected\n");
}

TEST_CASE("colours of a table follow what a cell says, and not its words") {
  const std::string text = terminal_table(measured(), {.colours = true});
  CHECK_THAT(text, Contains("\x1b[32mdetected\x1b[0m") && Contains("\x1b[2mnot detected"));
  Table words("status|");
  words.add({"detected", "not detected"});
  CHECK(terminal_table(words, {.colours = true}).find('\x1b') == std::string::npos);
}

TEST_CASE("columns that say nothing are left out, and so are heads where there are none") {
  Table table("|a|b");
  table.columns[1].head.clear();
  table.columns[2].head.clear();
  table.add({"name", "", "value"});
  CHECK(terminal_table(table, {}, "") == "name  value\n");
  table.drop("");
  CHECK(terminal_table(table, {}, "") == "value\n");
}

TEST_CASE("texts of anyone do not leave their cell") {
  const std::string name = "a|b\n<b>\x1b[31m_%&,\"=";
  Table table("", "name");
  table.columns[0] = {name, "name"};
  table.add({name});
  CHECK(terminal_table(table, {}, "").find('\x1b') == std::string::npos);
  const std::string markdown = table_text(table);
  CHECK(std::count(markdown.begin(), markdown.end(), '\n') == 3);
  CHECK_THAT(markdown, Contains("a\\|b") && Contains("\\<b\\>"));
  CHECK_THAT(table_text(table, TableFormat::latex), Contains("\\_\\%\\&"));
  CHECK_THAT(table_text(table, TableFormat::csv), Contains("\"\""));
}

TEST_CASE("texts and units for LaTeX") {
  const struct {
    const char *text, *latex;
  } kUnits[] = {{"deg/s·√s", "$\\mathrm{deg}/\\mathrm{s}\\cdot \\sqrt{\\mathrm{s}}$"},
                {"m/s²/√Hz", "$\\mathrm{m}/\\mathrm{s}^{2}/\\sqrt{\\mathrm{Hz}}$"},
                {"µg", "$\\mu \\mathrm{g}$"},
                {"", ""}};
  for (const auto& row : kUnits) CHECK(latex_unit(row.text) == row.latex);
  const struct {
    const char *text, *latex;
  } kTexts[] = {{"a_b & 5 % {x}", "a\\_b \\& 5 \\% \\{x\\}"},
                {"1.23×10⁻⁵", "1.23$\\times 10^{-5}$"},
                {"\\input{x}", "\\textbackslash{}input\\{x\\}"},
                {"0.24 deg/√h", "0.24 deg/$\\sqrt{\\mathrm{h}}$"},
                {"≤ 3 … 4", "$\\le$ 3 \\ldots{} 4"}};
  for (const auto& row : kTexts) CHECK(latex_text(row.text) == row.latex);
}
