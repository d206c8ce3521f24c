#include "libchar/core/text/term_cells.hpp"

#include <catch2/catch.hpp>
#include <limits>

using namespace libchar;

namespace {

Coefficient detected(double value, double low, double high) {
  Coefficient c;
  c.status = Status::detected;
  c.value = value;
  c.ci95 = {low, high};
  return c;
}

}  // namespace

TEST_CASE("term cells: a density says its sides, a floor that it is one") {
  const TermCells n = term_cells(detected(0.004, 0.00397, 0.00403), Term::white, "deg/s");
  CHECK(n.title == "Angle random walk");
  CHECK(said(n.own) == "0.004000 deg/s·√s");
  CHECK(n.own.low + " … " + n.own.high == "0.003970 … 0.004030");
  CHECK(said(n.field) == "0.2400 deg/√h, 0.005657 deg/s/√Hz one-sided, 6.981×10⁻⁵ rad/s/√Hz two-sided");
  CHECK(said(headline(n)) == "0.2400 deg/√h");
  const TermCells b = term_cells(detected(0.004, 0.0036, 0.0044), Term::flicker, "deg/s");
  CHECK(said(b.field) == "14.4 deg/h, 9.57 deg/h floor");
}

TEST_CASE("term cells: where the field has no word of its own the channel's unit leads") {
  const TermCells n = term_cells(detected(0.01, 0.0084, 0.0116), Term::white, "degC");
  CHECK(n.title == "White noise");
  CHECK(said(headline(n)) == "0.0100 degC·√s");
  CHECK(said(n.field) == "0.0141 °C/√Hz one-sided");
  CHECK(term_cells(detected(1, 0.9, 1.1), Term::walk, "furlong").field.empty());
}

TEST_CASE("term cells: digits follow the interval, lengths have two, unknown cells are empty") {
  Coefficient k = detected(0.0013706, 0.0009, 0.0018);
  k.relative_sd = 0.164;
  k.bound = 0.15;
  k.seconds_for_10_percent = 2508;
  TermCells cells = term_cells(k, Term::walk, "deg/s");
  CHECK(cells.own.value == "0.0014");
  CHECK(cells.known_to == "±16 %");
  CHECK(cells.best_possible == "±15 %");
  CHECK(cells.length_for_10_percent == "42 min");
  k.seconds_for_10_percent = 1e9;
  CHECK(term_cells(k, Term::walk, "deg/s").length_for_10_percent == "> 10 years");
  cells = term_cells({}, Term::walk, "deg/s");
  CHECK(cells.own.value == "–");
  CHECK(cells.field.empty());
  CHECK((cells.known_to + cells.best_possible + cells.length_for_10_percent).empty());
}

TEST_CASE("term cells: a limit stays one in every unit, an interval without an end says so") {
  Coefficient limit;
  limit.status = Status::not_detected;
  limit.upper95 = 1e-3;
  const TermCells cells = term_cells(limit, Term::flicker, "deg/s");
  CHECK(said(cells.own) == "≤ 0.00100 deg/s");
  CHECK(said(cells.field) == "≤ 3.60 deg/h, ≤ 2.39 deg/h floor");
  CHECK(cells.own.low.empty());
  CHECK(status_words(cells.status) == "not detected");
  const ShownValue open = shown_value(detected(2, 1, std::numeric_limits<double>::infinity()), 1, "s");
  CHECK(interval_brackets(open) == "[1.0, no end]");
  const ShownValue small = shown_value(detected(9.968e-5, 9.906e-5, 1.003e-4), 1, "g");
  CHECK(small.value + " " + small.low == "9.968×10⁻⁵ 9.906×10⁻⁵");
  CHECK(small.high == "10.030×10⁻⁵");
  CHECK(shown_value(detected(2e-4, 5e-5, 4e-4), 1, "g").low == "0.00005");
  Coefficient given = detected(2, 0, 0);
  given.status = Status::given;
  CHECK(shown_value(given, 1, "s").low.empty());
}
