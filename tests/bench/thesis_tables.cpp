// The tables of [RV] next to an independent recomputation of them and to ours: simulates the
// shipped scenes (fixtures/scenes) over many seeds and runs the library's algorithms on them.
//   thesis_tables [--seeds N] [--training-seeds N]
// thesis  what is printed there
// oracle  mean +- standard deviation over 24 seeds of an independent program; where it states no
//         deviation (sensors 1, 2 uncalibrated, least squares with sum one, chapter 5.1.2) one of
//         like rows, or about one percent, stands for it
// ours    mean (or median) +- standard deviation over our seeds
// z       (ours - oracle) / oracle's deviation;  zt  (thesis - ours) / our deviation
#include <fmt/format.h>

#include <chrono>
#include <cstring>
#include <map>
#include <numeric>

#include "tests/support/thesis_scenes.hpp"

using namespace test::thesis;
using libchar::fusion::LeastSquaresForm;

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

struct Row {
  const char* key;
  double thesis, oracle, deviation;
  const char* remark = "";  // a row with one is not judged
  bool median = false;
};

struct Table {
  const char* title;
  std::vector<Row> rows;
};

constexpr const char* kNoMean = "no finite mean: medians, spread without limit";

constexpr const char* kFlicker =
    "the oracle's noise is white; held flicker is one realisation within the memory, and its products between sensors "
    "do not average out";

const std::vector<Table>& tables() {
  static const std::vector<Table> all{
      {"Chapter 3: sensors and their average [RV 3.3, table 3.10]",
       {{"sensor 1 corrected", 1.7694, 1.7531, .010},
        {"sensor 2 corrected", .7831, .7799, .003},
        {"sensor 3 corrected", .5820, .5815, .0045},
        {"sensor 4 corrected", .2680, .2678, .0015},
        {"sensor 5 corrected", .1957, .1961, .0013},
        {"average corrected", .4095, .4062, .0020},
        {"sensor 1 calibrated", kNone, 1.7675, .010},
        {"sensor 2 calibrated", kNone, .7879, .003},
        {"sensor 3 calibrated", kNone, .5576, .0045},
        {"sensor 4 calibrated", kNone, .2498, .0015},
        {"sensor 5 calibrated", kNone, .1768, .0013},
        {"sensor 1 uncalibrated", 1.7616, 1.766, .012},
        {"sensor 2 uncalibrated", .8004, .799, .009},
        {"sensor 3 uncalibrated", .6298, .625, .022},
        {"sensor 4 uncalibrated", .4736, .463, .016},
        {"sensor 5 uncalibrated", .5242, .498, .011},
        {"average uncalibrated", .4303, .4319, .0075}}},
      {"Least squares [RV 3.6, tables 3.4, 3.5, 3.10]",
       {{"calibrated", .1360, .1371, .0010},
        {"uncalibrated", .1491, .1491, .0011},
        {"sum of weights one", kNone, .1373, .0010},
        {"true weights", kNone, .1372, .0010},
        {"w1 calibrated", .0058, .0059, .001},
        {"w2 calibrated", .0301, .0305, .003},
        {"w3 calibrated", .0614, .0596, .002},
        {"w4 calibrated", .2903, .3009, .006},
        {"w5 calibrated", .6123, .5997, .006},
        {"w1 uncalibrated", .0088, .0071, .001},
        {"w2 uncalibrated", .0324, .0362, .003},
        {"w3 uncalibrated", .0658, .0660, .002},
        {"w4 uncalibrated", .3064, .3096, .006},
        {"w5 uncalibrated", .5806, .5773, .006},
        {"a1 - A1", .0090, 0, .0090},
        {"a2 - A2", .0016, 0, .0030},
        {"a3 - A3", .0010, 0, .0026},
        {"a4 - A4", .0009, 0, .0012},
        {"a5 - A5", .0006, 0, .0007},
        {"b1 - B1", .073, 0, .137},
        {"b2 - B2", .028, 0, .068},
        {"b3 - B3", .054, 0, .049},
        {"b4 - B4", .0025, 0, .020},
        {"b5 - B5", .0041, 0, .014}}},
      {"Blind calibration [RV 3.5, tables 3.2, 3.3]",
       {{"published, reference 1", .4228, .449, kNone, kNoMean, true},
        {"published, reference 2", .4333, .430, kNone, kNoMean, true},
        {"sum |a - 1/A|, reference 1", .1869, .587, kNone, kNoMean, true},
        {"sum |a - 1/A|, reference 2", .4723, .334, kNone, kNoMean, true},
        {"beta 1", .0978, -.011, .11},
        {"beta 2", -.0370, -.019, .05},
        {"beta 3", -.1875, -.151, .05},
        {"beta 4", .4391, .466, .03},
        {"beta 5", -.3124, -.285, .03},
        {"ours, sum |a - 1/A|, reference 1", kNone, kNone, kNone, "not in the source"}}},
      {"Perceptron, by number of hidden neurons [RV 3.7, table 3.10]",
       {{"3 neurons calibrated", .1370, .1370, .001},
        {"5 neurons calibrated", .1370, .1371, .001},
        {"10 neurons calibrated", .1373, .1373, .001},
        {"20 neurons calibrated", .1372, .1375, .001},
        {"30 neurons calibrated", .1378, .1377, .001},
        {"3 neurons uncalibrated", .1492, .1493, .0011},
        {"5 neurons uncalibrated", .1492, .1494, .0011},
        {"10 neurons uncalibrated", .1496, .1496, .0011},
        {"20 neurons uncalibrated", .1494, .1502, .0011},
        {"30 neurons uncalibrated", .1498, .1505, .0011}}},
      {"Kalman-Takens [RV 3.8, table 3.10]",
       {{"Q 1e-2, d 6, M 20", .1363, .1369, .0010},
        {"Q 1e-3, d 4, M 20", .1569, .1495, .0009,
         "thesis not reproducible: it needs a prediction error of 2.85, that of two neighbours; 20 give 2.4"}}},
      {"Random weighting [RV 3.9, table 3.10]",
       {{"published, reference 1, from 1", 1.6753, 3.25, kNone, kNoMean, true},
        {"published, reference 1, from 1000", 1.6720, 2.38, kNone, kNoMean, true},
        {"published, reference 1, from 10000", .1375, .1409, kNone, kNoMean, true},
        {"published, reference 5, from 1", kNone, .182, kNone, kNoMean, true},
        {"published, reference 5, from 1000", kNone, .1380, .0010},
        {"published, reference 5, from 10000", kNone, .1377, .0010},
        {"on differences, from 1", kNone, .13745, .0010},
        {"on differences, from 1000", kNone, .13737, .0010},
        {"on differences, from 10000", kNone, .13737, .0010}}},
      {"Recursive re-weighted MINQUE at gamma 0.999 (not in the source; targets 1.003 and 1.0010)",
       {{"3.3 without flicker, from 5 s", kNone, 1.00253, .00040},
        {"3.3, from 5 s", kNone, 1.00253, .0004, kFlicker},
        {"3.3, whole run", kNone, 1.00253, .0004, kFlicker},
        {"3.3, from 5 s, gamma 0.9995", kNone, kNone, kNone, kFlicker},
        {"5.1, whole run", kNone, 1.00076, .00010}}},
      {"Chapter 5.1 without faults",
       {{"average / least squares", kNone, 1.2377, .0015},
        {"MINQUE / least squares", kNone, 1.00093, .0001},
        {"v1", kNone, .00274, .00274 * .059},
        {"v2", kNone, .00487, .00487 * .046},
        {"v3", kNone, .00761, .00761 * .041},
        {"v4", kNone, .01095, .01095 * .038},
        {"v5", kNone, .01491, .01491 * .036},
        {"v6", kNone, .01947, .01947 * .034}}},
      {"Chapter 5.1.2: sensors fail at 400, 500, 600 s; the last comes back at 700 s",
       {{"optimum 0-400 s", kNone, .03311, .0002},
        {"optimum 400-500 s", kNone, .04277, .0003},
        {"optimum 500-600 s", kNone, .05413, .0004},
        {"optimum 600-700 s", kNone, .06905, .0005},
        {"optimum 700-1000 s", kNone, .05413, .0003},
        {"published rule / sectioned, 20-400 s", kNone, 1.0010, .0002},
        {"published rule / sectioned, 420-500 s", kNone, 1.0009, .0005},
        {"published rule / sectioned, 520-600 s", kNone, 1.0010, .0005},
        {"published rule / sectioned, 620-700 s", kNone, 1.0013, .0006},
        {"published rule / sectioned, 730-1000 s", kNone, 1.0010, .0005},
        {"detection 1", 400, 400.009, .005},
        {"detection 2", 500, 500.18, .05},
        {"detection 3", 600, 600.31, .10},
        {"recovery 3", 760, 714.5, 1.3, "thesis not reproducible: at its memory of 5 s, 60 s would need gamma 0.99975"},
        {"whole run, average", kNone, .866, .005},
        {"whole run, least squares of 0-400 s", kNone, 1.918, .010},
        {"whole run, published rule", kNone, .0485, .0005},
        {"whole run, sectioned", kNone, .0479, .0003},
        {"MINQUE detection 1", kNone, kNone, kNone, "not in the source"},
        {"MINQUE detection 2", kNone, kNone, kNone, "not in the source"},
        {"MINQUE detection 3", kNone, kNone, kNone, "not in the source"},
        {"MINQUE recovery 3", kNone, kNone, kNone, "not in the source"},
        {"whole run, MINQUE", kNone, kNone, kNone, "not in the source"},
        {"whole run, bound sectioned-least-squares", kNone, kNone, kNone,
         "not in the source: it goes on with sensors of wrong gain, whose noise is no larger"}}},
  };
  return all;
}

using Found = std::map<std::string, std::vector<double>>;

std::string numbered(const char* before, Index i, const char* after = "") {
  return fmt::format("{}{}{}", before, i + 1, after);
}

constexpr Index kLearn = 10000;
constexpr double kEdges[] = {0, 400, 500, 600, 700, 1000};  // s, of the sections of 5.1.2

void sensors(const Recorded& calibrated, const Recorded& uncalibrated, Found& found) {
  const auto learnt_u = learnt(uncalibrated, {true, false, false}, 0, kLearn);
  Recorded corrected = uncalibrated;
  for (Index i = 0; i < 5; ++i) {
    corrected.y.row(i) = (uncalibrated.y.row(i).array() - learnt_u.bias[i]) / learnt_u.gain[i];
    found[numbered("sensor ", i, " corrected")].push_back(rms(corrected.y.row(i), corrected));
    found[numbered("sensor ", i, " calibrated")].push_back(rms(calibrated.y.row(i), calibrated));
    found[numbered("sensor ", i, " uncalibrated")].push_back(rms(uncalibrated.y.row(i), uncalibrated));
    const libchar::SensorModel& m = uncalibrated.scene.simulate->sensors[static_cast<std::size_t>(i)].model;
    found[fmt::format("a{0} - A{0}", i + 1)].push_back(learnt_u.gain[i] - m.scale_factor.value);
    found[fmt::format("b{0} - B{0}", i + 1)].push_back(learnt_u.bias[i] - m.bias.value);
    found[numbered("w", i, " uncalibrated")].push_back(learnt_u.weights[i]);
  }
  found["average corrected"].push_back(rms(run("mean", {}, corrected).x, corrected));
  found["average uncalibrated"].push_back(rms(run("mean", {}, uncalibrated).x, uncalibrated));
}

void least_squares(const Recorded& calibrated, const Recorded& uncalibrated, Found& found) {
  const Ran c = run("least-squares-published", {{"calibrate", 0}}, calibrated, 0, kLearn);
  for (Index i = 0; i < 5; ++i) found[numbered("w", i, " calibrated")].push_back(c.weights(i, 0));
  found["calibrated"].push_back(rms(c.x, calibrated));
  found["uncalibrated"].push_back(rms(run("least-squares-published", {}, uncalibrated, 0, kLearn).x, uncalibrated));
  found["sum of weights one"].push_back(
      rms(run("least-squares", {{"calibrate", 0}}, calibrated, 0, kLearn).x, calibrated));
  found["true weights"].push_back(rms(run("inverse-variance", {}, calibrated).x, calibrated));
}

template <class Blind>
double gain_error(const Recorded& r, const Eigen::VectorXd& inverse_gain, Index reference) {
  double sum = 0;
  const auto& sensors = r.scene.simulate->sensors;
  const double gauge = sensors[static_cast<std::size_t>(reference)].model.scale_factor.value;
  for (Index i = 0; i < r.array.channels; ++i)
    sum += std::abs(inverse_gain[i] - gauge / sensors[static_cast<std::size_t>(i)].model.scale_factor.value);
  return sum;
}

template <class Blind>
Blind after(const Recorded& r, const char* gauge, double reference) {
  libchar::fusion::Settings settings(Blind::options);
  settings.set(gauge, reference);
  libchar::fusion::Array blind = r.array;
  blind.noise_levels.resize(0);
  Blind algorithm(blind, settings);
  for (Index k = 0; k < r.x.size(); ++k) algorithm.step(libchar::fusion::Sample(r.y.col(k).data(), r.y.rows()));
  return algorithm;
}

void blind(const Recorded& r, Found& found) {
  using Published = libchar::fusion::BlindCalibrationPublished;
  for (const int reference : {1, 2}) {
    const Options options{{"reference_channel", reference}};
    found[fmt::format("published, reference {}", reference)].push_back(
        rms(run("blind-calibration-published", options, r).x, r));
    const auto end = after<Published>(r, "reference_channel", reference);
    found[fmt::format("sum |a - 1/A|, reference {}", reference)].push_back(
        gain_error<Published>(r, end.inverse_gain(), reference - 1));
    if (reference == 1)
      for (Index i = 0; i < 5; ++i) found[numbered("beta ", i)].push_back(end.offset()[i]);
  }
  auto ours = after<libchar::fusion::BlindCalibration>(r, "gauge", 1);
  ours.solve();
  found["ours, sum |a - 1/A|, reference 1"].push_back(
      gain_error<libchar::fusion::BlindCalibration>(r, ours.inverse_gain(), 0));
}

void perceptrons(const Recorded& calibrated, const Recorded& uncalibrated, Found& found) {
  for (const int neurons : {3, 5, 10, 20, 30}) {
    const Options options{{"neurons", neurons}, {"starts", 1}};
    found[fmt::format("{} neurons calibrated", neurons)].push_back(
        rms(run("perceptron", options, calibrated, 0, kLearn).x, calibrated, kLearn));
    found[fmt::format("{} neurons uncalibrated", neurons)].push_back(
        rms(run("perceptron", options, uncalibrated, 0, kLearn).x, uncalibrated, kLearn));
  }
}

void kalman_takens(const Recorded& r, Found& found) {
  // The listing takes the density S of sensor 1, 5e-3, for the variance.
  const double scale = 5e-3 / r.array.noise_levels[0];
  found["Q 1e-2, d 6, M 20"].push_back(
      rms(run("kalman-takens-published", {{"process_variance", 1e-2}, {"noise_scale", scale}}, r).x, r, 1000));
  found["Q 1e-3, d 4, M 20"].push_back(
      rms(run("kalman-takens-published", {{"process_variance", 1e-3}, {"dimension", 4}, {"noise_scale", scale}}, r).x,
          r, 1000));
}

void random_weighting(const Recorded& r, Found& found) {
  const auto put = [&](const std::string& label, const Ran& ran) {
    for (const Index from : {1, 1000, 10000})
      found[fmt::format("{}, from {}", label, from)].push_back(rms(ran.x, r, from - 1));
  };
  put("published, reference 1", run("random-weighting-published", {}, r));
  put("published, reference 5",
      run("random-weighting-published", {{"reference_channel", 5}, {"second_channel", 4}}, r));
  put("on differences", run("random-weighting", {}, r));
}

double minque_excess(const Recorded& r, Index from, double gamma = 0.999) {
  return rms(run("minque", {{"gamma", gamma}}, r).x, r, from) / rms(run("inverse-variance", {}, r).x, r, from);
}

void fault_free(const Recorded& r, Found& found) {
  const double best = rms(run("least-squares-published", {{"calibrate", 0}}, r, 0, r.instant(100)).x, r);
  found["average / least squares"].push_back(rms(run("mean", {}, r).x, r) / best);
  found["MINQUE / least squares"].push_back(rms(run("minque-published", {}, r).x, r) / best);
  const auto& entry = libchar::fusion::algorithm("minque-published");
  const auto runner = entry.make(r.array, libchar::fusion::Settings(entry.options));
  Eigen::MatrixXd x(1, r.x.size()), variance(1, r.x.size());
  runner->run(r.y, x, variance);
  for (Index i = 0; i < 6; ++i) found[numbered("v", i)].push_back((*runner->variances())[i]);
}

// First time at which a channel went out (or came in) after `since`, in s; NaN: never.
double event(const Ran& ran, const Recorded& r, int channel, bool faulty, double since) {
  for (const auto& e : ran.faults)
    if (e.channel == channel && e.faulty == faulty && static_cast<double>(e.sample) / r.array.rate_hz >= since)
      return static_cast<double>(e.sample) / r.array.rate_hz;
  return kNone;
}

// Section by section the weights of least squares over the sensors that are sound there [RV 5.1.2].
// (The bound `sectioned-least-squares` may use a sensor of known wrong gain, and does better.)
Ran sectioned_over_sound_sensors(const Recorded& r) {
  Ran ran{r.x, {}, {}};
  const std::vector<std::vector<Index>> sound{
      {0, 1, 2, 3, 4, 5}, {1, 2, 3, 4, 5}, {2, 3, 4, 5}, {3, 4, 5}, {2, 3, 4, 5}};
  for (std::size_t s = 0; s < sound.size(); ++s) {
    const Index from = r.instant(kEdges[s]), to = r.instant(kEdges[s + 1]);
    const Recorded part = only(r, sound[s]);
    ran.x.segment(from, to - from) =
        run("least-squares", {{"calibrate", 0}}, part, from, to).x.segment(from, to - from);
  }
  return ran;
}

void faults(Recorded r, Found& found) {
  const Ran sectioned = sectioned_over_sound_sensors(r);
  for (const double t : {400, 500, 600, 700}) r.array.section_starts.push_back(r.instant(t));
  // Moments about the mean, one threshold for all, taken from the start on: as published.
  const Ran published = run("minque-published", {{"about_zero", 0}, {"common_threshold", 1}, {"settling", 0}}, r);
  const Ran minque = run("minque", {}, r);
  // Beginning, detection and return take their time: ratios are of what comes after.
  constexpr double kSettled[] = {20, 420, 520, 620, 730};
  for (std::size_t s = 0; s < 5; ++s) {
    const Index from = r.instant(kEdges[s]), to = r.instant(kEdges[s + 1]);
    found[fmt::format("optimum {}-{} s", kEdges[s], kEdges[s + 1])].push_back(rms(sectioned.x, r, from, to));
    const Index later = r.instant(kSettled[s]);
    found[fmt::format("published rule / sectioned, {}-{} s", kSettled[s], kEdges[s + 1])].push_back(
        rms(published.x, r, later, to) / rms(sectioned.x, r, later, to));
  }
  found["whole run, bound sectioned-least-squares"].push_back(
      rms(run("sectioned-least-squares", {}, r, 0, r.x.size()).x, r));
  for (int i = 0; i < 3; ++i) {
    found[numbered("detection ", i)].push_back(event(published, r, i, true, 400 + 100 * i));
    found[numbered("MINQUE detection ", i)].push_back(event(minque, r, i, true, 400 + 100 * i));
  }
  found["recovery 3"].push_back(event(published, r, 2, false, 700));
  found["MINQUE recovery 3"].push_back(event(minque, r, 2, false, 700));
  found["whole run, average"].push_back(rms(run("mean", {}, r).x, r));
  found["whole run, least squares of 0-400 s"].push_back(
      rms(run("least-squares", {{"calibrate", 0}}, r, 0, r.instant(400)).x, r));
  found["whole run, published rule"].push_back(rms(published.x, r));
  found["whole run, sectioned"].push_back(rms(sectioned.x, r));
  found["whole run, MINQUE"].push_back(rms(minque.x, r));
}

struct Centre {
  double value = kNone, deviation = kNone;
};

Centre centre(std::vector<double> values, bool median) {
  if (values.empty()) return {};
  const auto n = static_cast<double>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double square = 0;
  for (const double v : values) square += (v - mean) * (v - mean);
  Centre c{mean, values.size() > 1 ? std::sqrt(square / (n - 1)) : kNone};
  if (median) {
    std::sort(values.begin(), values.end());
    c.value = values[values.size() / 2];
  }
  return c;
}

std::string number(double value, const char* form = "{:.5g}") {
  return std::isnan(value) ? "-" : fmt::format(fmt::runtime(form), value);
}

int print(const Found& found) {
  int beyond = 0;
  std::vector<std::string> named;
  for (const Table& table : tables()) {
    fmt::print("\n{}\n{:<40} {:>9} {:>21} {:>23} {:>6} {:>6}\n", table.title, "", "thesis", "oracle +- std",
               "ours +- std", "z", "zt");
    for (const Row& row : table.rows) {
      const auto values = found.find(row.key);
      const Centre ours = centre(values == found.end() ? std::vector<double>{} : values->second, row.median);
      const double z = (ours.value - row.oracle) / row.deviation;
      const double zt = row.median ? kNone : (row.thesis - ours.value) / ours.deviation;
      const bool judged = !*row.remark && !std::isnan(z);
      const bool off = judged && std::abs(z) > 3;
      beyond += off;
      if (*row.remark) named.push_back(fmt::format("{}: {}", row.key, row.remark));
      fmt::print("{:<40} {:>9} {:>10} {:>10} {:>11} {:>11} {:>6} {:>6}{}\n", row.key, number(row.thesis),
                 number(row.oracle), number(row.deviation, "{:.2g}"), number(ours.value),
                 number(ours.deviation, "{:.2g}"), number(z, "{:.1f}"), number(zt, "{:.1f}"),
                 off           ? "  BEYOND 3"
                 : *row.remark ? "  *"
                               : "");
    }
  }
  fmt::print("\n* not judged:\n");
  for (const std::string& line : named) fmt::print("  {}\n", line);
  fmt::print("{} rows beyond 3 standard deviations of the oracle\n", beyond);
  return beyond == 0 ? 0 : 6;
}

}  // namespace

int main(int count, char** words) {
  std::uint64_t seeds = 20, training_seeds = 20;
  for (int i = 1; i + 1 < count; i += 2) {
    if (std::strcmp(words[i], "--seeds") == 0) seeds = std::strtoull(words[i + 1], nullptr, 10);
    if (std::strcmp(words[i], "--training-seeds") == 0) training_seeds = std::strtoull(words[i + 1], nullptr, 10);
  }
  const auto start = std::chrono::steady_clock::now();
  Found found;
  for (std::uint64_t seed = 1; seed <= seeds; ++seed) {
    const Recorded calibrated = simulate("rv-3.3-calibrated.yaml", seed);
    const Recorded uncalibrated = simulate("rv-3.3-uncalibrated.yaml", seed + 1000);
    sensors(calibrated, uncalibrated, found);
    least_squares(calibrated, uncalibrated, found);
    blind(uncalibrated, found);
    if (seed <= training_seeds) perceptrons(calibrated, uncalibrated, found);
    kalman_takens(calibrated, found);
    random_weighting(calibrated, found);
    found["3.3, whole run"].push_back(minque_excess(calibrated, 0));
    found["3.3, from 5 s"].push_back(minque_excess(calibrated, 5000));
    found["3.3, from 5 s, gamma 0.9995"].push_back(minque_excess(calibrated, 5000, 0.9995));
    found["3.3 without flicker, from 5 s"].push_back(
        minque_excess(simulate("rv-3.3-calibrated.yaml", seed, false), 5000));
    const Recorded six = simulate("rv-5.1-fault-free.yaml", seed);
    fault_free(six, found);
    found["5.1, whole run"].push_back(minque_excess(six, 0));
    faults(simulate("rv-5.1-faults.yaml", seed + 2000), found);
    fmt::print(stderr, "\rseed {} of {}, {:.0f} s", seed, seeds,
               std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
  }
  fmt::print(stderr, "\n");
  fmt::print("{} seeds ({} for perceptrons)\n", seeds, std::min(seeds, training_seeds));
  return print(found);
}
