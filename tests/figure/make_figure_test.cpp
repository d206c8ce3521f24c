#include "libchar/figure/make_figure.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "libchar/core/error.hpp"
#include "libchar/figure/detail/drawing.hpp"
#include "libchar/figure/detail/scale.hpp"
#include "libchar/figure/draw_figure.hpp"
#include "libchar/report/html/html_report.hpp"
#include "libchar/report/replay/replay_text.hpp"
#include "tests/figure/figure_parts.hpp"
#include "tests/report/synthetic.hpp"
#include "tests/report/synthetic_replay.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

FigureSource source_of(const Json& report) { return parse_figure_source(dump_json(report), "folder/report.json"); }

Chart chart_of(const FigureSource& source, const std::string& kind, std::vector<std::string> channels = {}) {
  FigureOptions options;
  options.kind = kind;
  options.channels = std::move(channels);
  return make_figure({&source, 1}, options);
}

Box box_of(const DrawnText& text) {
  const double width = text_width(text.runs, text.size, text.bold);
  const double before = text.anchor == Anchor::start ? 0 : text.anchor == Anchor::middle ? width / 2 : width;
  const double up = 0.72 * text.size, down = 0.1 * text.size;  // capitals, and a little below the base line
  if (text.upright) return {text.at.x - up, text.at.y - width + before, text.at.x + down, text.at.y + before};
  return {text.at.x - before, text.at.y - up, text.at.x - before + width, text.at.y + down};
}

std::string words_of(const DrawnText& text) {
  std::string out;
  for (const TextRun& run : text.runs) out += run.text;
  return out;
}

/// "A over B" for each two texts of the drawing whose boxes meet; "A outside" for one that leaves the sheet.
std::string texts_in_the_way(const Chart& chart, const DrawingOptions& options) {
  const Drawing drawing = lay_out(chart, options);
  std::vector<std::pair<Box, std::string>> boxes;
  std::string out;
  for (const DrawnPiece& piece : drawing.pieces) {
    if (!piece.is_text) continue;
    const Box box = box_of(piece.text);
    const std::string words = words_of(piece.text);
    if (box.left < -0.5 || box.top < -0.5 || box.right > drawing.width + 0.5 || box.bottom > drawing.height + 0.5)
      out += words + " outside; ";
    for (const auto& [other, said] : boxes)
      if (other.meets(box)) out += words + " over " + said + "; ";
    boxes.emplace_back(box, words);
  }
  REQUIRE(boxes.size() > 4);
  return out;
}

}  // namespace

TEST_CASE("a figure has the numbers of the report, curve by curve") {
  const Characterization result = test::synthetic_imu();
  const FigureSource source = source_of(json_report(result));
  const ChannelResult& first = result.channels[0];
  const Chart chart = chart_of(source, "allan", {first.channel.name});
  REQUIRE(chart.series.size() >= 3);
  REQUIRE(chart.series[0].name == "measured");
  REQUIRE(chart.series[0].y.size() == first.allan.points.size());
  for (std::size_t i = 0; i < first.allan.points.size(); ++i) {
    CHECK(chart.series[0].x[i] == first.allan.points[i].tau_s);
    CHECK(chart.series[0].y[i] == first.allan.points[i].deviation);
  }
  CHECK(chart.x.low < first.allan.points.front().tau_s);
  CHECK(chart.x.high > first.allan.points.back().tau_s);
  CHECK(!chart.marks.empty());
  CHECK_THAT(chart.marks[0].text, Contains("N = ") && Contains("√s"));
  const Chart psd = chart_of(source, "psd", {first.channel.name});
  CHECK(psd.series[0].y == first.spectrum.value);
  CHECK_THAT(psd.y.title, Contains("One-sided PSD"));
}

TEST_CASE("every kind is drawn of a report, or says why it has none") {
  const Json characterization = json_report(test::synthetic_imu());
  const Json replay = replay_json(test::synthetic_replay());
  const FigureSource of_log = source_of(characterization), of_replay = source_of(replay);
  for (const FigureKind& kind : figure_kinds()) {
    INFO(kind.word);
    const FigureSource& source = kind.of_replay ? of_replay : of_log;
    const std::string name = of_log.curves[0].channel;
    Chart chart;
    try {
      chart = chart_of(source, std::string(kind.word),
                       kind.of_replay ? std::vector<std::string>{} : std::vector<std::string>{name});
    } catch (const Error& error) {
      // A replay made from formulas has no run that was recorded; nothing else may lack.
      INFO(error.what());
      CHECK(error.problem().code == "E0978");
      CHECK((kind.word == "timeline" || kind.word == "error" || kind.word == "residuals" || kind.word == "trace"));
      continue;
    }
    Findings warnings;
    CHECK(draw_figure(chart, FigureFormat::svg, {}, warnings).size() > 1000);
    for (const double width : {kOneColumnMm, kTwoColumnsMm})
      for (const LegendPlace legend : {LegendPlace::automatic, LegendPlace::inside, LegendPlace::below})
        CHECK(texts_in_the_way(chart, {.width_mm = width, .legend = legend}) == "");
    // and of the other kind of report it is refused
    CHECK_THROWS_WITH(chart_of(kind.of_replay ? of_log : of_replay, std::string(kind.word)), Contains("E0978"));
  }
}

TEST_CASE("curves of several devices are told apart by file, by channel, or by both") {
  const FigureSource both[] = {
      test::figure_source_of({test::figure_curve("x", "deg/s"), test::figure_curve("y", "deg/s")}, "one"),
      test::figure_source_of({test::figure_curve("x", "°/s"), test::figure_curve("y", "deg/s")}, "two")};
  FigureSource named[] = {both[0], both[1]};
  named[1].curves[0].unit = "deg/s";
  FigureOptions options;
  Chart chart = make_figure(named, options);
  REQUIRE(chart.series.size() == 4);
  CHECK(chart.series[0].name == "one: x");
  CHECK(chart.series[3].name == "two: y");
  options.channels = {"x"};
  options.labels = {"A", "B"};
  chart = make_figure(named, options);
  REQUIRE(chart.series.size() == 2);
  CHECK(chart.series[0].name == "A");
  CHECK(chart.series[1].name == "B");
  // told apart without colour: by dash and by marker
  CHECK(chart.series[0].look.dash != chart.series[1].look.dash);
  CHECK(chart.series[0].look.marker != chart.series[1].look.marker);
}

TEST_CASE("files of one name are told apart by their folders") {
  FigureSource both[] = {test::figure_source_of({test::figure_curve("x", "g")}, "m"),
                         test::figure_source_of({test::figure_curve("x", "g")}, "m")};
  both[0].file = "one/m.sensor.yaml";
  both[1].file = "two/m.sensor.yaml";
  const Chart chart = make_figure(both, {});
  CHECK(chart.series[0].name == "one/m");
  CHECK(chart.series[1].name == "two/m");
}

TEST_CASE("several statistics of one channel are drawn together, told apart by their names") {
  FigureSource source =
      test::figure_source_of({test::figure_curve("gyro_x", "deg/s"), test::figure_curve("gyro_x", "deg/s")});
  source.curves[1].statistic = {"Modified Allan deviation"};
  Chart chart = chart_of(source, "allan");
  REQUIRE(chart.series.size() == 2);
  CHECK(chart.series[0].name == "Overlapping Allan deviation");
  CHECK(chart.series[1].name == "Modified Allan deviation");
  CHECK_THAT(chart.y.title, Catch::StartsWith("Deviation"));
  for (const char* statistic : {"Overlapping Allan deviation", "Modified Allan deviation"}) {
    source.curves.push_back(test::figure_curve("gyro_y", "deg/s"));
    source.curves.back().statistic = {statistic};
  }
  chart = chart_of(source, "allan");
  REQUIRE(chart.series.size() == 4);
  CHECK(chart.series[3].name == "gyro_y, Modified Allan deviation");
  source.curves[1].statistic = {"Time deviation"};
  source.curves[1].value_unit = "deg";
  CHECK_THROWS_WITH(chart_of(source, "allan"), Contains("E0976") && Contains("Time deviation in deg"));
}

TEST_CASE("what does not go together is refused in a sentence") {
  const FigureSource mixed =
      test::figure_source_of({test::figure_curve("gyro", "deg/s"), test::figure_curve("accel", "g")});
  CHECK_THROWS_WITH(chart_of(mixed, "allan"), Contains("E0976") && Contains("gyro in deg/s") && Contains("accel in g"));
  const FigureSource joined =
      test::figure_source_of({test::figure_curve("IMU 0/GyrX", "deg/s"), test::figure_curve("IMU 0/AccX", "g")});
  CHECK_THROWS_WITH(chart_of(joined, "allan", {"IMU*"}), Contains("`channels` ('*/Gyr*')"));
  CHECK(chart_of(joined, "allan", {"*/Gyr*"}).series.size() == 1);
  const FigureSource board =
      test::figure_source_of({test::figure_curve("imu1_gyr_x", "deg/s"), test::figure_curve("imu1_gyr_y", "deg/s"),
                              test::figure_curve("imu1_acc_x", "g")});
  CHECK_THROWS_WITH(chart_of(board, "allan"), Contains("`channels` ('imu1_g*')"));
  CHECK(chart_of(board, "allan", {"imu1_g*"}).series.size() == 2);
  CHECK_THROWS_WITH(chart_of(mixed, "allan", {"gyroo"}), Contains("E0977") && Contains("gyro"));
  CHECK_THROWS_WITH(chart_of(mixed, "psd"), Contains("E0978") && Contains("no spectrum"));
  CHECK_THROWS_WITH(chart_of(mixed, "alan"), Contains("E0978") && Contains("allan"));
  FigureSource other = mixed;
  other.curves[1] = test::figure_curve("accel", "deg/s");
  other.curves[1].statistic = {"Hadamard deviation"};
  CHECK_THROWS_WITH(chart_of(other, "allan"), Contains("E0983") && Contains("Hadamard"));
  FigureOptions options;
  options.channels = {"gyro"};
  options.x_range = Interval{-1, 10};
  CHECK_THROWS_WITH(make_figure({&mixed, 1}, options), Contains("E0981"));
  FigureSource many = test::figure_source_of({});
  for (int i = 0; i < 40; ++i) many.curves.push_back(test::figure_curve("c" + std::to_string(i), "g"));
  CHECK_THROWS_WITH(chart_of(many, "allan"), Contains("E0984"));
}

TEST_CASE("a report that was damaged is refused with its place") {
  Json report = json_report(test::synthetic_imu());
  report["allan"]["channels"][0]["deviation"].erase(0);
  CHECK_THROWS_WITH(source_of(report), Contains("E0982") && Contains("allan.channels[0].deviation"));
  report = json_report(test::synthetic_imu());
  report["allan"]["channels"][0]["tau_s"][3] = "x";
  CHECK_THROWS_WITH(source_of(report), Contains("E0982") && Contains("a number was expected"));
  CHECK_THROWS_WITH(parse_figure_source("{\"format\": \"inspect\", \"version\": 1}", "a.json"),
                    Contains("E0975") && Contains("inspect"));
  Json replay = replay_json(test::synthetic_replay());
  replay["algorithms"][0]["inputs"] = 7;
  CHECK_THROWS_AS(chart_of(source_of(replay), "window", {"*"}), Error);
}

TEST_CASE("names that try to become part of the drawing stay names") {
  const Characterization hostile = test::hostile();
  const FigureSource source = source_of(json_report(hostile));
  for (const SourceCurve& curve : source.curves) {
    FigureSource one = test::figure_source_of({curve, curve});
    one.curves[1].channel = "beside";
    Findings warnings;
    const std::string svg =
        draw_figure(chart_of(one, curve.is_allan ? "allan" : "psd"), FigureFormat::svg, {}, warnings);
    CHECK_THAT(svg, !Contains("<script") && !Contains("<img") && !Contains("\x01"));
  }
}

TEST_CASE("marks of a trace that look the same share one name in the legend") {
  SourceTrace trace;
  trace.channel = "x";
  trace.unit = "V";
  trace.low = {-1, -1, -1, -1};
  trace.high = {1, 1, 1, 1};
  FigureSource source = test::figure_source_of({});
  source.traces.push_back(std::move(trace));
  const auto names = [&] {
    std::set<std::string> out;
    FigureOptions options;
    options.kind = "trace";
    for (const FigureStretch& one : make_figure({&source, 1}, options).stretches) out.insert(one.name);
    return out;
  };
  source.traces[0].marks = {{"step", 1, 1, "step 3.1 V"}};
  CHECK(names() == std::set<std::string>{"step 3.1 V"});
  source.traces[0].marks = {
      {"step", 1, 1, "step 3.1 V"}, {"warm-up", 0, 1, "warm-up -1 V, τ 27 s"}, {"step", 2, 2, "step -2 V"}};
  CHECK(names() == std::set<std::string>{"2 × step, warm-up"});
}

TEST_CASE("docs/plots.md has a row for each figure and for nothing else") {
  const std::string page = test::slurp(test::source_folder() / "docs/plots.md");
  std::string rows, kinds;
  for (std::size_t at = page.find("\n| `"); at != std::string::npos; at = page.find("\n| `", at + 1)) {
    const std::string word = page.substr(at + 4, page.find('`', at + 4) - at - 4);
    if (!word.starts_with("--")) rows += word + " ";
  }
  for (const FigureKind& kind : figure_kinds()) kinds += std::string(kind.word) + " ";
  CHECK(rows == kinds);
}
