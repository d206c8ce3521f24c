// Trends and filters that all sensors and the reference go through alike.
#include "libchar/replay/detail/plan/preparation.hpp"

#include <fmt/format.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "libchar/replay/detail/align/instants.hpp"
#include "libchar/replay/replay.hpp"
#include "tests/replay/scene_text.hpp"

using namespace libchar;
using Catch::Contains;

namespace {

constexpr double kGap = std::numeric_limits<double>::quiet_NaN();

std::vector<double> filtered(const BandFilter& filter, const std::vector<double>& x) {
  FilteredChannel channel(filter);
  std::vector<double> out;
  for (const double value : x) out.push_back(channel(value));
  return out;
}

}  // namespace

TEST_CASE("band filter: Butterworth coefficients of scipy.signal.butter(2, …)") {
  const SecondOrderSection high = butterworth_high_pass(0.013);
  CHECK(high.b0 == Approx(0.9438775757370255).epsilon(1e-14));
  CHECK(high.b1 == Approx(-1.887755151474051).epsilon(1e-14));
  CHECK(high.a1 == Approx(-1.8846029408609604).epsilon(1e-14));
  CHECK(high.a2 == Approx(0.8909073620871416).epsilon(1e-14));
  const SecondOrderSection low = butterworth_low_pass(0.2);
  CHECK(low.b0 == Approx(0.20657208382614792).epsilon(1e-14));
  CHECK(low.b1 == Approx(0.41314416765229584).epsilon(1e-14));
  CHECK(low.a1 == Approx(-0.3695273773512414).epsilon(1e-14));
  CHECK(low.a2 == Approx(0.19581571265583306).epsilon(1e-14));
}

TEST_CASE("band filter: a band as scipy.signal.sosfilt runs it, begun in the first sample's steady state") {
  const BandFilter filter = band_filter(0.5, 12, 100);
  std::vector<double> x;
  for (int k = 0; k < 60; ++k) x.push_back(5 + std::sin(0.37 * k) + std::fmod(0.01 * k * k, 3));
  const std::vector<double> y = filtered(filter, x);
  CHECK(y[0] == 0);
  CHECK(y[1] == Approx(0.03318851187674564).epsilon(1e-10));
  CHECK(y[5] == Approx(0.8737826244339211).epsilon(1e-12));
  CHECK(y[30] == Approx(-0.47660857821061775).epsilon(1e-12));
  CHECK(y[59] == Approx(0.6516560999433023).epsilon(1e-12));
  CHECK(filter.noise_gain == Approx(0.2432937147614897).epsilon(1e-4));
  CHECK(band_filter(0.5, 0, 100).noise_gain == Approx(0.9888945600787588).epsilon(1e-4));
  CHECK(filter.settling == 330);
}

TEST_CASE("band filter: a step is below a thousandth once it has settled, an offset leaves nothing") {
  for (const double corner_hz : {0.01, 0.5, 20.0}) {
    const BandFilter filter = band_filter(corner_hz, 0, 100);
    std::vector<double> x(static_cast<std::size_t>(3 * filter.settling), 1e6);
    for (const double y : filtered(filter, x)) CHECK(y == 0);
    for (std::size_t k = 10; k < x.size(); ++k) x[k] += 1;
    const std::vector<double> y = filtered(filter, x);
    double largest = 0;
    for (std::size_t k = 10 + static_cast<std::size_t>(filter.settling); k < y.size(); ++k)
      largest = std::max(largest, std::abs(y[k]));
    CHECK(largest < 1e-3);
    CHECK(std::abs(y[10]) > 0.3);
  }
}

TEST_CASE("band filter: short gaps are bridged, long ones begin anew and are missing until settled") {
  const BandFilter filter = band_filter(0.1, 0, 100);
  REQUIRE(filter.settling == 1650);
  REQUIRE(filter.bridged == 16);
  std::vector<double> x(8000);
  for (std::size_t k = 0; k < x.size(); ++k) x[k] = 3 + std::sin(0.02 * static_cast<double>(k));
  const std::vector<double> whole = filtered(filter, x);
  auto gap = x;
  for (std::size_t k = 2000; k < 2003; ++k) gap[k] = kGap;
  const std::vector<double> bridged = filtered(filter, gap);
  for (std::size_t k = 2000; k < 2003; ++k) CHECK(std::isnan(bridged[k]));
  for (std::size_t k = 2003; k < 8000; k += 7) CHECK(std::abs(bridged[k] - whole[k]) < 2e-3);
  for (std::size_t k = 2000; k < 2100; ++k) gap[k] = kGap;
  const std::vector<double> anew = filtered(filter, gap);
  for (std::size_t k = 2000; k < 3750; ++k) CHECK(std::isnan(anew[k]));
  for (std::size_t k = 3750; k < 8000; k += 7) CHECK(std::abs(anew[k] - whole[k]) < 2e-3);
}

TEST_CASE("band filter: a difference of two channels is the difference filtered") {
  const BandFilter filter = band_filter(0.5, 12, 100);
  std::vector<double> a, b, d;
  for (int k = 0; k < 500; ++k) {
    a.push_back(7 + std::sin(0.05 * k));
    b.push_back(std::cos(0.3 * k));
    d.push_back(a.back() - b.back());
  }
  const auto fa = filtered(filter, a), fb = filtered(filter, b), fd = filtered(filter, d);
  for (std::size_t k = 0; k < fd.size(); ++k) CHECK(std::abs(fa[k] - fb[k] - fd[k]) < 1e-12);
}

TEST_CASE("trends: means and lines of least squares, missing samples left out") {
  TrendMeter meter;
  Eigen::MatrixXd block(3, 50);
  for (Eigen::Index part = 0; part < 4; ++part) {
    for (Eigen::Index k = 0; k < 50; ++k) {
      const double t = static_cast<double>(part * 50 + k);
      block(0, k) = 1e9 + 0.25 * t;
      block(1, k) = k % 2 == 0 ? kGap : 4;
      block(2, k) = kGap;
    }
    meter.push(part * 50, block);
  }
  const auto lines = meter.lines(true);
  CHECK(lines[0].slope == Approx(0.25).epsilon(1e-9));
  CHECK(lines[0].at(100) == Approx(1e9 + 25).epsilon(1e-15));
  CHECK(lines[1].at(17) == Approx(4).epsilon(1e-14));
  CHECK(lines[2].at(5) == 0);
  CHECK(meter.lines(false)[0].at(0) == Approx(1e9 + 0.25 * 99.5).epsilon(1e-15));
}

namespace {

// Two sensors of a wave at 0.5 Hz on a slow drift, and the reference, which reads half a unit more; 40 s at 50 Hz.
std::string drifting_log() {
  std::string text = "t[s],a[m],b[m],ref[m]\n";
  std::uint32_t state = 7;
  const auto noise = [&] {
    state = state * 1664525U + 1013904223U;
    return static_cast<double>(state >> 8U) / 16777216.0 - 0.5;
  };
  for (int k = 0; k < 2000; ++k) {
    const double t = 0.02 * k, x = std::sin(std::numbers::pi * t);
    text += fmt::format("{:.2f},{:.6f},{:.6f},{:.6f}\n", t, x + 3 + 0.1 * t + 0.1 * noise(), x - 2 + 0.1 * noise(),
                        x + 0.5);
  }
  return text;
}

const std::string kDriftScene = "format: scene\nversion: 1\nrecording: drift.csv\nsensors: [a, b]\n";

Eigen::MatrixXd rows_of(const Instants& instants, std::int64_t from, std::int64_t to, std::size_t size) {
  Eigen::MatrixXd out(3, to - from);
  instants.pass(from, to, size, no_progress(), [&](const InstantBlock& b) {
    out.block(0, b.first - from, 2, b.samples.cols()) = b.samples;
    out.block(2, b.first - from, 1, b.truth.cols()) = b.truth;
  });
  return out;
}

}  // namespace

TEST_CASE("preparation: one filter for sensors and reference, the same from wherever a pass begins") {
  const test::SceneBench bench;
  bench.put("drift.csv", drifting_log());
  const Scene scene = bench.read(kDriftScene + "reference: ref\nhigh_pass_hz: 0.1\n");
  Instants instants(scene, no_progress());
  CHECK(instants.settled() == 825);
  const Eigen::MatrixXd whole = rows_of(instants, 0, 2000, 4096);
  for (const std::size_t size : {1, 100, 333}) CHECK(rows_of(instants, 700, 1500, size) == whole.middleCols(700, 800));
  const auto settled = whole.rightCols(1175);
  // What is left is the wave, and no offset.
  CHECK(std::abs(settled.row(0).mean()) < 0.3);
  CHECK((settled.row(1) - settled.row(2)).array().abs().maxCoeff() < 0.07);
  CHECK(settled.row(2).array().abs().maxCoeff() > 0.9);
  // Offsets are taken off behind it.
  instants.set_offsets({1, 0});
  CHECK((rows_of(instants, 900, 1000, 64).row(0) - whole.row(0).segment(900, 100)).array().abs().maxCoeff() ==
        Approx(1).epsilon(1e-12));
}

TEST_CASE("preparation: each row without its own mean or line") {
  const test::SceneBench bench;
  bench.put("drift.csv", drifting_log());
  const Scene means_scene = bench.read(kDriftScene + "reference: ref\ndetrend: mean\n");
  const Instants means(means_scene, no_progress());
  const Eigen::MatrixXd of_means = rows_of(means, 0, 2000, 512);
  CHECK(std::abs(of_means.row(0).mean()) < 1e-9);
  CHECK((of_means.row(0) - of_means.row(2)).array().abs().maxCoeff() > 1.9);
  const Scene lines_scene = bench.read(kDriftScene + "reference: ref\ndetrend: line\n");
  const Instants lines(lines_scene, no_progress());
  const Eigen::MatrixXd of_lines = rows_of(lines, 0, 2000, 512);
  for (Eigen::Index row = 0; row < 3; ++row) CHECK(std::abs(of_lines.row(row).mean()) < 1e-9);
  // The drift of 4 in 40 s is gone.
  CHECK((of_lines.row(0) - of_lines.row(2)).array().abs().maxCoeff() < 0.07);
}

TEST_CASE("preparation: what cannot be is refused") {
  const test::SceneBench bench;
  bench.put("drift.csv", drifting_log());
  const auto refused = [&](const std::string& more) { return bench.refusal(kDriftScene + more); };
  CHECK_THAT(refused("band_hz: [2, 1]\n"), Contains("band_hz"));
  CHECK_THAT(refused("band_hz: [0, 1]\n"), Contains("E0750"));
  CHECK_THAT(refused("band_hz: [-3, -1]\n"), Contains("E0750"));
  CHECK_THAT(refused("band_hz: [1, 2]\nhigh_pass_hz: 1\n"), Contains("E0735"));
  CHECK_THAT(refused("detrend: slope\n"), Contains("line"));
  CHECK_THAT(refused("high_pass_hz: 0\n"), Contains("high_pass_hz"));
  CHECK_THAT(refused("reference: {channels: ref, offset: estimate}\nhigh_pass_hz: 1\n"),
             Contains("E0750") && Contains("offset"));
  CHECK_THAT(refused("reference: {channels: ref, offset: much}\n"), Contains("or estimate"));
  CHECK_THAT(refused("reference: {channels: ref, lag_s: 1, delay: 1}\n"), Contains("E0735"));
  const Scene fast = bench.read(kDriftScene + "band_hz: [1, 25]\n");
  try {
    const Instants none(fast, no_progress());
    FAIL("25 Hz of 50 Hz");
  } catch (const Error& error) {
    CHECK_THAT(error.what(), Contains("E0912") && Contains("25 Hz"));
  }
}

TEST_CASE("replay: the reference's offset is found, subtracted, and said") {
  const test::SceneBench bench;
  std::string text = "t[s],a[m],b[m],ref[m]\n";
  for (int k = 0; k < 4000; ++k) {
    const double x = std::sin(0.01 * k), e = 0.1 * std::sin(12.9898 * k * k + 78.233);
    text += fmt::format("{:.2f},{:.6f},{:.6f},{:.6f}\n", 0.01 * k, x + e, x - e / 3, x + 0.5);
  }
  bench.put("drift.csv", text);
  ReplayOptions options;
  options.algorithms = {{"mean", {}, 0, 0}};
  const auto run = [&](const std::string& more) { return replay(bench.read(kDriftScene + more), options); };
  const ReplayResult plain = run("reference: ref\nlearning: [0, 20]\n");
  const ReplayResult found = run("reference: {channels: ref, offset: estimate}\nlearning: [0, 20]\n");
  REQUIRE(found.reference_offset);
  // A fused log is told of it.
  REQUIRE(found.learnt.inputs.at(0).reference_offset);
  CHECK(*found.learnt.inputs[0].reference_offset == Approx(found.reference_offset->value));
  CHECK(found.reference_offset->value == Approx(0.5).margin(0.01));
  CHECK(found.reference_offset->ci95.low < 0.5);
  CHECK(found.reference_offset->ci95.high > 0.5);
  CHECK(found.reference_offset->in_learning);
  CHECK(found.reference_offset->window.to_s == 20);
  CHECK(plain.algorithms[0].rmse > 0.49);
  CHECK(found.algorithms[0].rmse < 0.06);
  // A number says the same; without a learning window it is found on what is scored.
  const ReplayResult given = run("reference: {channels: ref, offset: 0.5}\nlearning: [0, 20]\n");
  CHECK(given.algorithms[0].rmse == Approx(found.algorithms[0].rmse).epsilon(0.05));
  const ReplayResult scored = run("reference: {channels: ref, offset: estimate, delay: 0}\n");
  CHECK_FALSE(scored.reference_offset->in_learning);
  CHECK(std::abs(scored.algorithms[0].inputs[0].error.bias) < 1e-6);
}

TEST_CASE("replay: behind a filter levels are those behind it, and the start is not scored") {
  const test::SceneBench bench;
  bench.put("drift.csv", drifting_log());
  const std::string models =
      "format: scene\nversion: 1\nrecording: drift.csv\nsensors:\n"
      "  - {name: a, model: {unit: m, white_noise: {value: 0.1}, density: two-sided}, noise: 0.2}\n"
      "  - {name: b, model: {unit: m, white_noise: {value: 0.1}, density: two-sided}, noise: 0.2}\n"
      "reference: ref\n";
  ReplayOptions options;
  options.algorithms = {{"mean", {}, 0, 0}, {"virtual-sensor", {}, 0, 0}};
  const ReplayResult whole = replay(bench.read(models), options);
  CHECK(*whole.sensors[0].noise_variance == Approx(0.04).epsilon(1e-12));
  CHECK(whole.algorithms[1].ran);
  const ReplayResult band = replay(bench.read(models + "band_hz: [0.2, 5]\n"), options);
  CHECK(*band.sensors[0].noise_variance == Approx(0.04 * band_filter(0.2, 5, 50).noise_gain).epsilon(1e-9));
  CHECK_FALSE(band.algorithms[1].ran);
  CHECK(band.warnings.find("learning_before_settled") == nullptr);
  const ReplayResult early = replay(bench.read(models + "band_hz: [0.2, 5]\nlearning: [0, 5]\n"), options);
  CHECK(early.warnings.find("learning_before_settled") != nullptr);
  CHECK(band.algorithms[0].inputs[0].error.samples == 2000 - 413);
  CHECK(band.algorithms[0].rmse < 0.1 * whole.algorithms[0].rmse);
}

TEST_CASE("instants: parts of a slow reference's intervals at the ends are said") {
  const test::SceneBench bench;
  std::string log = "t[s],a[m],b[m]\n", slow = "t[s],ref[m]\n";
  for (int k = 0; k < 2000; ++k) log += fmt::format("{:.2f},1,2\n", 1000.5 + 0.02 * k);
  for (int k = 0; k < 60; ++k) slow += fmt::format("{},1\n", 990 + k);
  bench.put("drift.csv", log);
  bench.put("slow.csv", slow);
  const Scene scene = bench.read(kDriftScene + "reference: {channels: ref, recording: slow.csv}\n");
  const Instants instants(scene, no_progress());
  CHECK(instants.info().count == 39);
  CHECK_THAT(instants.info().reference_use,
             Contains("the first 0.5 s and the last 0.5 s of the recording") && Contains("not used"));
}
