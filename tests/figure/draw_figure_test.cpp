#include "libchar/figure/draw_figure.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <random>

#include "libchar/core/error.hpp"
#include "tests/figure/figure_parts.hpp"
#include "tests/support/run.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

Chart allan_of(std::vector<SourceCurve> curves, FigureOptions options = {}) {
  const FigureSource source = test::figure_source_of(std::move(curves));
  options.kind = "allan";
  return make_figure({&source, 1}, options);
}

std::string svg_of_chart(const Chart& chart, const DrawingOptions& options = {}) {
  Findings warnings;
  return draw_figure(chart, FigureFormat::svg, options, warnings);
}

std::size_t times(const std::string& text, const std::string& part) {
  std::size_t out = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++out;
  return out;
}

/// What another program says of the file; "" where it is not installed.
std::string said_by(const std::vector<std::string>& words) {
  const test::Ran ran = test::run_words(words);
  return ran.code == 0 ? ran.out : "";
}

}  // namespace

TEST_CASE("a figure as SVG is XML, its texts are texts, and it is as wide as it was asked for") {
  const test::TemporaryFolder folder;
  const std::string svg = svg_of_chart(allan_of({test::figure_curve("gyro <&> \"x\"", "deg/s")}));
  CHECK_THAT(svg, Contains("<svg xmlns=") && Contains("width=\"240.94pt\""));
  CHECK_THAT(svg, Contains(">Averaging time τ [s]</text>"));
  CHECK_THAT(svg, Contains(">Overlapping Allan deviation [deg/s]</text>"));
  CHECK_THAT(svg, Contains("<title>Overlapping Allan deviation of gyro &lt;&amp;&gt;"));
  // decades of both axes: powers are raised by text, not drawn
  SourceCurve small = test::figure_curve("g", "deg/s");
  for (auto* values : {&small.y, &small.low95, &small.high95})
    for (double& v : *values) v *= 1e-4;
  CHECK_THAT(svg_of_chart(allan_of({small})), Contains("10<tspan dy=") && Contains(">−6</tspan>"));
  CHECK(times(svg, "<text") > 10);
  const std::string path = (folder / "figure.svg").string();
  std::ofstream(path) << svg;
  const test::Ran lint = test::run_words({"xmllint", "--noout", path});
  INFO(lint.err);
  CHECK(lint.code == 0);
}

TEST_CASE("points that are not reliable are hollow, and the interval is a band") {
  const std::string svg = svg_of_chart(allan_of({test::figure_curve("g", "deg/s")}));
  CHECK(times(svg, "<circle") == 26 + 1);  // and the one of the legend
  CHECK(times(svg, "fill-opacity=\"0.2\"") == 2);
  // three hollow ones in a group of their own
  const std::size_t hollow = svg.find("<g fill=\"#ffffff\"");
  REQUIRE(hollow != std::string::npos);
  CHECK(times(svg.substr(hollow, svg.find("</g>", hollow) - hollow), "<circle") == 3);
}

TEST_CASE("in grey no piece has a colour") {
  DrawingOptions options;
  options.grey = true;
  const Chart chart =
      allan_of({test::figure_curve("a", "deg/s"), test::figure_curve("b", "deg/s"), test::figure_curve("c", "deg/s")});
  const std::string svg = svg_of_chart(chart, options);
  for (std::size_t at = svg.find("=\"#"); at != std::string::npos; at = svg.find("=\"#", at + 1)) {
    const std::string hex = svg.substr(at + 3, 6);
    INFO(hex);
    CHECK(hex.substr(0, 2) == hex.substr(2, 2));
    CHECK(hex.substr(0, 2) == hex.substr(4, 2));
  }
  CHECK_THAT(svg_of_chart(chart), Contains("#0072b2"));
}

TEST_CASE("no text stands beyond the page, whatever the names, sizes and values") {
  SourceCurve huge = test::figure_curve("a channel with a name that is longer than any column", "deg/s");
  for (auto* values : {&huge.y, &huge.low95, &huge.high95})
    for (double& v : *values) v *= 1e17;
  for (const double width : {85.0, 178.0, 40.0}) {
    DrawingOptions options;
    options.width_mm = width;
    options.legend = LegendPlace::below;
    FigureOptions wanted;
    wanted.title = "A title that says rather much about what is to be seen in the figure below it";
    const std::string svg = svg_of_chart(allan_of({huge, test::figure_curve("another", "deg/s")}, wanted), options);
    const double page = width * 72 / 25.4;
    for (std::size_t at = svg.find("<text x=\""); at != std::string::npos; at = svg.find("<text x=\"", at + 1)) {
      const double x = std::stod(svg.substr(at + 9));
      CHECK(x >= 0);
      CHECK(x <= page);
    }
  }
}

TEST_CASE("rows of a legend below stand one under the other, below the plot and on the page") {
  std::vector<SourceCurve> curves;
  for (int i = 0; i < 5; ++i)
    curves.push_back(test::figure_curve(fmt::format("row {} of a legend that needs a line each", i), "deg/s"));
  DrawingOptions options;
  options.width_mm = 85;
  options.height_mm = 100;
  options.legend = LegendPlace::below;
  const std::string svg = svg_of_chart(allan_of(curves), options);
  double above = 50 * 72 / 25.4;  // the middle of the page
  for (int i = 0; i < 5; ++i) {
    const std::size_t name = svg.find(fmt::format("row {} of", i));
    REQUIRE(name != std::string::npos);
    const std::size_t text = svg.rfind("<text x=\"", name);
    REQUIRE(text != std::string::npos);
    const double y = std::stod(svg.substr(svg.find(" y=\"", text) + 4));
    CHECK(y > above + 5);
    above = y;
  }
  CHECK(above <= 100 * 72 / 25.4);
}

TEST_CASE("the same figure gives the same bytes, in each format") {
  const Chart chart = allan_of({test::figure_curve("g", "deg/s")});
  for (const FigureFormat format : {FigureFormat::svg, FigureFormat::pdf, FigureFormat::png}) {
    if (format != FigureFormat::svg && !draws_with_cairo()) continue;
    Findings warnings;
    const std::string once = draw_figure(chart, format, {}, warnings);
    CHECK(once.size() > 1000);
    CHECK(once == draw_figure(chart, format, {}, warnings));
  }
}

TEST_CASE("a PDF embeds its fonts, has one page of the size, its texts as texts and no date") {
  if (!draws_with_cairo()) {
    std::puts("SKIPPED: built without Cairo");
    return;
  }
  const test::TemporaryFolder folder;
  Findings warnings;
  const std::string pdf = draw_figure(allan_of({test::figure_curve("g", "deg/s")}), FigureFormat::pdf, {}, warnings);
  CHECK(pdf.starts_with("%PDF-"));
  CHECK_THAT(pdf, !Contains("CreationDate"));
  const std::string path = (folder / "f.pdf").string();
  std::ofstream(path, std::ios::binary) << pdf;
  const std::string fonts = said_by({"pdffonts", path});
  if (fonts.empty()) {
    std::puts("SKIPPED: pdffonts is not installed");
    return;
  }
  std::size_t rows = 0;
  for (std::size_t at = fonts.find("TrueType"); at != std::string::npos; at = fonts.find("TrueType", at + 1)) {
    ++rows;
    // emb, sub, uni
    CHECK_THAT(fonts.substr(at, fonts.find('\n', at) - at), Contains("yes yes yes"));
  }
  CHECK(rows > 0);
  const std::string text = said_by({"pdftotext", path, "-"});
  CHECK_THAT(text, Contains("Averaging time") && Contains("Overlapping Allan deviation [deg/s]"));
  CHECK_THAT(said_by({"pdfinfo", path}), Contains("Page size:       240.9"));
}

TEST_CASE("a PNG is as large as its resolution says, and says it") {
  if (!draws_with_cairo()) {
    std::puts("SKIPPED: built without Cairo");
    return;
  }
  Findings warnings;
  DrawingOptions options;
  options.width_mm = 25.4 * 3;
  options.height_mm = 25.4 * 2;
  options.dpi = 100;
  const std::string png =
      draw_figure(allan_of({test::figure_curve("g", "deg/s")}), FigureFormat::png, options, warnings);
  REQUIRE(png.size() > 60);
  const auto number = [&](std::size_t at) {
    std::uint32_t out = 0;
    for (std::size_t i = 0; i < 4; ++i) out = out << 8U | static_cast<unsigned char>(png[at + i]);
    return out;
  };
  CHECK(number(16) == 300);
  CHECK(number(20) == 200);
  CHECK(png.substr(37, 4) == "pHYs");
  CHECK(number(41) == 3937);  // points a metre
}

TEST_CASE("a hundred thousand points are drawn in seconds, whatever their order, as often as they are seen") {
  constexpr std::size_t kPoints = 100'000;
  SourceCurve curve = test::figure_curve("g", "deg/s");
  std::mt19937_64 random(1);
  std::lognormal_distribution<double> values(0, 1);
  for (auto* column : {&curve.x, &curve.y, &curve.low95, &curve.high95, &curve.low68, &curve.high68}) column->clear();
  curve.unreliable.clear();
  for (std::size_t i = 0; i < kPoints; ++i) {
    curve.x.push_back(values(random));
    curve.y.push_back(values(random));
  }
  const auto seconds = [&](bool line) {
    Chart chart = allan_of({curve});
    for (FigureSeries& series : chart.series) {
      series.look.width = line ? 0.9 : 0;
      series.look.marker = line ? FigureMarker::none : FigureMarker::circle;
    }
    const auto begin = std::chrono::steady_clock::now();
    Findings warnings;
    for (const FigureFormat format : {FigureFormat::svg, FigureFormat::pdf, FigureFormat::png})
      draw_figure(chart, format, {}, warnings);
    if (!line) CHECK(times(svg_of_chart(chart), "<circle") < kPoints);
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  };
  CHECK(seconds(true) < 20);  // quadratic: some minutes
  CHECK(seconds(false) < 20);
}

TEST_CASE("a page without room for a plot is refused") {
  const Chart chart = allan_of({test::figure_curve("g", "deg/s")});
  for (const auto& [width, height] : {std::pair{10.0, 0.0}, {85.0, 10.0}, {5000.0, 0.0}}) {
    DrawingOptions options;
    options.width_mm = width;
    options.height_mm = height;
    CHECK_THROWS_WITH(svg_of_chart(chart, options), Contains("E0981"));
  }
}

TEST_CASE("a series without points is not in a script for gnuplot") {
  Chart chart = allan_of({test::figure_curve("a", "deg/s")});
  const std::size_t there = chart.series.size();
  chart.series.emplace_back().name = "empty";
  const std::string script = figure_gnuplot(chart, {});
  for (std::size_t k = 0; k < there; ++k) CHECK_THAT(script, Contains(fmt::format("$series{} ", k)));
  CHECK_THAT(script, !Contains(fmt::format("$series{} ", there)));
}

TEST_CASE("the numbers of a figure, as a table and as a script that gnuplot runs") {
  const test::TemporaryFolder folder;
  SourceCurve curve = test::figure_curve("it's a, name", "deg/s");
  curve.marks = {{Term::white, 1, 0.01, "N = 0.01 deg/s·√s"}};
  const Chart chart = allan_of({curve});
  const std::string csv = figure_csv(chart);
  CHECK(csv.starts_with("part,name,x,y,low,high,text\nseries,measured,0.01,"));
  CHECK(times(csv, "\nseries,measured,") == 26);
  CHECK_THAT(csv, Contains("\nmark,,1,0.01,,,N = 0.01 deg/s·√s\n"));
  const std::string script = (folder / "f.gp").string(), out = (folder / "f.svg").string();
  std::ofstream(script) << figure_gnuplot(chart, {});
  // Without a locale gnuplot warns of its own degree sign.
  const test::Ran ran =
      test::run_words({"env", "LC_ALL=C.UTF-8", "gnuplot", "-e", "set terminal svg; set output '" + out + "'", script});
  if (ran.code == 127) {
    std::puts("SKIPPED: gnuplot is not installed");
    return;
  }
  INFO(ran.err);
  CHECK(ran.code == 0);
  CHECK(ran.err == "");
  CHECK_THAT(test::slurp(out), Contains("Averaging time"));
}
