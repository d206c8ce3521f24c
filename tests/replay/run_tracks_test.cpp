#include "libchar/replay/detail/tracks/run_tracks.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <vector>

#include "libchar/replay/replay.hpp"
#include "tests/replay/replay_numbers.hpp"
#include "tests/replay/scene_text.hpp"

using namespace libchar;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Timeline enveloped(const std::vector<double>& values, std::size_t bins, std::size_t block) {
  Envelope envelope(static_cast<std::int64_t>(values.size()), bins);
  for (std::size_t at = 0; at < values.size(); at += block)
    envelope.push(static_cast<std::int64_t>(at), static_cast<Eigen::Index>(std::min(block, values.size() - at)),
                  [&](Eigen::Index k) { return values[at + static_cast<std::size_t>(k)]; });
  Timeline out;
  envelope.add_to(out, 100, 10);
  return out;
}

// Three sensors of a sine that differ by offsets; the second fails for a while.
std::string log_of(std::size_t rows, bool with_truth) {
  std::string out = with_truth ? "t[s],a,b,c,truth\n" : "t[s],a,b,c\n";
  for (std::size_t k = 0; k < rows; ++k) {
    const double x = std::sin(0.01 * static_cast<double>(k)), wiggle = k % 7 == 0 ? 0.25 : 0;
    const double own = 2e-6 * (static_cast<double>(k % 3) - 1);  // else c would be a copy of a
    out += std::to_string(0.01 * static_cast<double>(k)) + "," + std::to_string(x + 0.5) + "," +
           (k % 11 == 3 ? "" : std::to_string(x - wiggle)) + "," + std::to_string(x - 1 + own) +
           (with_truth ? "," + std::to_string(x) : "") + "\n";
  }
  return out;
}

std::string scene_of(const std::string& more) {
  return "format: scene\nversion: 1\nname: three\nrecording: three.csv\nsensors:\n"
         "  - {name: a}\n  - {name: b}\n  - {name: c}\n" +
         more;
}

}  // namespace

TEST_CASE("envelope: the smallest and the largest of each stretch, the last one shorter") {
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<double> values = {3, 1, 2, -5, kNan, 7, kNan, kNan, infinity, 4};
  const Timeline t = enveloped(values, 4, values.size());  // stretches of 3, 3, 3, 1
  REQUIRE(t.low.size() == 1);
  REQUIRE(t.low[0].size() == 4);
  CHECK(t.low[0][0] == 1);
  CHECK(t.high[0][0] == 3);
  CHECK(t.low[0][1] == -5);
  CHECK(t.high[0][1] == 7);
  CHECK(std::isnan(t.low[0][2]));
  CHECK(std::isnan(t.high[0][2]));
  CHECK(t.low[0][3] == 4);
  CHECK(t.time_s[0] == Approx(100.1));
  CHECK(t.time_s[3] == Approx(100.9));
}

TEST_CASE("envelope: blocks of any size give the same") {
  std::vector<double> values;
  for (int k = 0; k < 1003; ++k) values.push_back(std::sin(0.7 * k) * k);
  const Timeline whole = enveloped(values, 100, values.size());
  CHECK(whole.time_s.size() == 92);  // of 11 each
  for (const std::size_t block : {1, 5, 11, 12, 500}) CHECK(enveloped(values, 100, block).high == whole.high);
}

TEST_CASE("close-ups: at the faults and where scoring begins, apart from each other, within the run") {
  const auto places = close_up_places(100000, 500, {600, 50000, 99990, -5, 50100, 200000}, 10);
  REQUIRE(places.size() == 3);  // 600 and 50100 are too near to others, two are outside
  CHECK(places[0].from == 500);
  CHECK_FALSE(places[0].fault);
  CHECK(places[1].from == 49900);
  CHECK(places[1].fault == 1);
  CHECK(places[2].from == 99600);
  CHECK(places[2].count == 400);
  CHECK(close_up_places(1000, 0, {500}, 10).empty());        // has every instant anyhow
  CHECK(close_up_places(100000, 0, {500}, 100000).empty());  // too much to keep
  CHECK(close_up_places(100000, 0, {}, 200)[1].from == 50000);
  CHECK(close_up_places(100000, 0, {}, 200)[0].count == 125);
}

TEST_CASE("replay: keeps the run of the best method and of the best single sensor") {
  const test::SceneBench bench;
  bench.put("three.csv", log_of(5000, true));
  const ReplayResult r = replay(bench.read(scene_of("reference: truth\nwarm_up_s: 2\nalgorithms: [mean, median]\n")));
  REQUIRE(r.best);
  REQUIRE(r.algorithms[*r.best].label == "median");
  CHECK(r.tracks.algorithm == r.best);
  CHECK(r.scored_from_s == 2);
  REQUIRE(r.tracks.whole.inputs.size() == 1);
  const InputTracks& input = r.tracks.whole.inputs[0];
  REQUIRE(input.error.low[0].size() == 1000);  // stretches of 5
  // The sensor b, where it is there; else the middle of a and c.
  const double e = 1e-6;
  for (std::size_t bin = 0; bin < 1000; ++bin) {
    double low = 1, high = -1, sensor_low = 1;
    for (std::size_t k = 5 * bin; k < 5 * bin + 5; ++k) {
      const double wiggle = k % 7 == 0 ? 0.25 : 0, error = k % 11 == 3 ? -0.25 : -wiggle;
      low = std::min(low, error);
      high = std::max(high, error);
      if (k % 11 != 3) sensor_low = std::min(sensor_low, -wiggle);
    }
    REQUIRE(input.error.low[0][bin] == Approx(low).margin(2 * e));
    REQUIRE(input.error.high[0][bin] == Approx(high).margin(2 * e));
    REQUIRE(r.tracks.whole.sensor_error.low[0][bin] == Approx(sensor_low).margin(2 * e));
  }
  CHECK(input.reference.high[0][31] == Approx(std::sin(1.57)).margin(1e-3));
  CHECK(r.sensors[*r.best_sensor].name == "b");
  // Every instant where scoring begins, and in the middle.
  REQUIRE(r.tracks.close_ups.size() == 2);
  const CloseUp& start = r.tracks.close_ups[0];
  CHECK(start.from_s == Approx(2));
  CHECK(start.to_s == Approx(5.99));
  CHECK(r.tracks.close_ups[1].from_s == Approx(25));
  const std::vector<double>& errors = start.run.inputs[0].error.low[0];
  REQUIRE(errors.size() == 400);
  CHECK(start.run.inputs[0].error.high[0] == errors);
  for (std::size_t k = 200; k < 600; ++k)
    REQUIRE(errors[k - 200] == Approx(k % 11 == 3 || k % 7 == 0 ? -0.25 : 0).margin(2 * e));
  CHECK(r.tracks.whole.deviations.empty());
}

TEST_CASE("replay: without a reference the distance of each sensor from the median is kept") {
  const test::SceneBench bench;
  bench.put("three.csv", log_of(3000, false));
  const ReplayResult r =
      replay(bench.read(scene_of("align: {learn: run, apply: false}\nalgorithms: [mean, median]\n")));
  REQUIRE(r.tracks.whole.deviations.low.size() == 3);
  CHECK(r.tracks.whole.inputs[0].reference.empty());
  CHECK(r.tracks.whole.inputs[0].error.empty());
  CHECK_FALSE(r.tracks.whole.inputs[0].estimate.empty());
  CHECK(r.tracks.whole.sensor.empty());
  // Stretches of 3. In the second one b is missing once: the median is the middle of a and c then.
  CHECK(r.tracks.whole.deviations.low[0][0] == Approx(0.5).margin(1e-5));
  CHECK(r.tracks.whole.deviations.high[0][0] == Approx(0.75).margin(1e-5));
  CHECK(r.tracks.whole.deviations.high[0][1] == Approx(0.75).margin(1e-5));
  CHECK(r.tracks.whole.deviations.high[1][0] == Approx(0).margin(1e-5));
  CHECK(r.tracks.whole.deviations.low[2][0] == Approx(-1).margin(1e-5));
}

TEST_CASE("replay: the run that is kept does not depend on the block size") {
  const test::SceneBench bench;
  bench.put("three.csv", log_of(4000, true));
  const Scene scene = bench.read(scene_of("reference: truth\nalgorithms: [mean, median]\n"));
  const ReplayResult standard = replay(scene);
  for (const std::size_t block : {1, 37, 100000}) {
    ReplayOptions options;
    options.block = block;
    const ReplayResult other = replay(scene, options);
    CHECK(other.tracks.whole.inputs[0].error.low == standard.tracks.whole.inputs[0].error.low);
    CHECK(other.tracks.whole.sensor.high == standard.tracks.whole.sensor.high);
    REQUIRE(other.tracks.close_ups.size() == 2);
    const std::vector<double>&a = other.tracks.close_ups[1].run.sensor.high[0],
          &b = standard.tracks.close_ups[1].run.sensor.high[0];
    CHECK(std::equal(a.begin(), a.end(), b.begin(), b.end(),
                     [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); }));
  }
}
