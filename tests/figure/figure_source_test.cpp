#include "libchar/figure/figure_source.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <fstream>

#include "libchar/core/error.hpp"
#include "libchar/fit/fit_json.hpp"
#include "tests/support/shared.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

std::string written(const test::TemporaryFolder& folder, const std::string& name, const std::string& text) {
  const std::string path = (folder / name).string();
  std::ofstream(path) << text;
  return path;
}

}  // namespace

TEST_CASE("tables of curves are read with their intervals and units") {
  const test::TemporaryFolder folder;
  const FigureSource allan =
      read_figure_source(written(folder, "a.csv",
                                 "channel,unit,tau_s,deviation,low68,high68,low95,high95,edf,terms,curve\n"
                                 "x,deg/s,1,0.5,0.4,0.6,0.3,0.7,10,9,mdev\nx,deg/s,2,0.3,,,,,,4,mdev\n"));
  REQUIRE(allan.curves.size() == 1);
  CHECK(allan.curves[0].statistic.title == "Modified Allan deviation");
  CHECK(allan.curves[0].y == std::vector<double>{0.5, 0.3});
  CHECK(allan.curves[0].high95[0] == 0.7);
  CHECK(std::isnan(allan.curves[0].high95[1]));
  CHECK(allan.name == "a");
  const FigureSource wide =
      read_figure_source(written(folder, "p.csv", "frequency_hz,x[(deg/s)²/Hz],y[g²/Hz]\n0,1,2\n0.5,3,4\n1,5,6\n"));
  REQUIRE(wide.curves.size() == 2);
  CHECK(wide.curves[0].statistic.title == "One-sided PSD");
  CHECK(wide.curves[0].unit == "deg/s");
  CHECK(wide.curves[1].y == std::vector<double>{4, 6});
  const FigureSource variances = read_figure_source(written(folder, "v.csv", "tau,avar\n1,0.04\n10,0.01\n"));
  CHECK(variances.curves[0].y == std::vector<double>{0.2, 0.1});
}

TEST_CASE("a model gives its Allan curve and its spectrum") {
  const test::TemporaryFolder folder;
  const FigureSource model = read_figure_source(written(folder, "m.sensor.yaml",
                                                        "format: sensor-model\nversion: 1\nchannel: g\n"
                                                        "unit: deg/s\nrate_hz: 100\ndensity: two-sided\n"
                                                        "white_noise: {value: 0.01}\n"
                                                        "random_walk: {value: 0.001}\n"));
  REQUIRE(model.curves.size() == 2);
  CHECK(model.name == "m");
  const SourceCurve& allan = model.curves[0];
  CHECK(allan.of_model);
  // sigma² = N²/tau + K² tau/3 where tau is long
  for (std::size_t i = 0; i < allan.x.size(); ++i) {
    if (allan.x[i] < 1) continue;
    CHECK(allan.y[i] == Approx(std::sqrt(1e-4 / allan.x[i] + 1e-6 * allan.x[i] / 3)).epsilon(2e-3));
  }
  // one-sided: 2 N² where the walk is gone
  CHECK(model.curves[1].y.back() == Approx(2e-4).epsilon(1e-2));
  REQUIRE(allan.marks.size() == 2);
  CHECK(allan.marks[0].text == "N = 0.0100 deg/s·√s");
}

TEST_CASE("a fit gives the curves of its coefficients") {
  const test::TemporaryFolder folder;
  NoiseFit fit;
  fit.rate_hz = 100;
  fit.duration_s = 1000;
  const auto detected = [&](Term term, double value) {
    Coefficient& c = fit.term[static_cast<std::size_t>(term)];
    c.status = Status::detected;
    c.value = value;
    c.ci95 = {0.9 * value, 1.1 * value};
  };
  detected(Term::white, 0.01);
  detected(Term::walk, 0.001);
  Finding moved;
  moved.code = "motion";
  moved.severity = Severity::bad;
  fit.findings = {moved};
  const Json document =
      noise_fit_document(Json::array({noise_fit_json("gx", "deg/s", fit), no_fit_json("c", "V", {moved})}));
  const FigureSource source = read_figure_source(written(folder, "fit.json", document.dump()));
  REQUIRE(source.curves.size() == 2);
  CHECK(source.curves[0].channel == "gx");
  CHECK(source.curves[0].of_model);
  CHECK(source.curves[0].y.front() == Approx(0.1).epsilon(1e-2));
  CHECK(source.curves[1].y.back() == Approx(2e-4).epsilon(1e-2));
  REQUIRE(source.curves[0].marks.size() == 2);
  CHECK(source.curves[0].marks[1].text == "K = 0.00100 deg/s/√s");
  REQUIRE(source.findings.size() == 2);  // one of each channel
  CHECK(source.findings[0].subject == "gx");
  const double plain = source.curves[0].y.front();
  fit.flicker_phase.emplace().value = 0.01;  // of a clock: written as a power law
  const Json clock = noise_fit_document(Json::array({noise_fit_json("y", "", fit)}));
  CHECK(read_figure_source(written(folder, "clock.json", clock.dump())).curves[0].y.front() > 1.1 * plain);
  const Json none = noise_fit_document(Json::array({no_fit_json("c", "V", {moved})}));
  CHECK_THROWS_WITH(read_figure_source(written(folder, "none.json", none.dump())), Contains("E0975"));
}

TEST_CASE("what is no curve is refused with what to do") {
  const test::TemporaryFolder folder;
  const struct {
    const char *name, *text, *code, *says;
  } kRows[] = {
      {"log.csv", "t,gyro\n0,1\n1,2\n2,3\n", "E0975", "sensorchar allan"},
      {"empty.csv", "", "E0975", "is it a log?"},
      {"scene.yaml", "format: scene\nversion: 1\n", "E0975", "sensorchar replay"},
      {"x.json", "[1, 2", "E06", "x.json"},
      {"newer.json", "{\"format\": \"allan\", \"version\": 99, \"channels\": []}", "E05", "version"},
      {"none.json", "{\"format\": \"allan\", \"version\": 1, \"channels\": []}", "E0975", "no curve"},
      {"bad.csv", "tau_s,deviation\n1,x\n", "E0311", "a number"},
      {"wide.csv", "frequency_hz,x[g²/Hz]\n1,2\n2\n", "E0304", "2 expected"},
  };
  for (const auto& row : kRows) {
    INFO(row.name);
    CHECK_THROWS_WITH(read_figure_source(written(folder, row.name, row.text)),
                      Contains(row.code) && Contains(row.says));
  }
  CHECK_THROWS_AS(read_figure_source((folder / "absent.json").string()), Error);
  CHECK_THROWS_AS(read_figure_source((folder / "absent.csv").string()), Error);
}
