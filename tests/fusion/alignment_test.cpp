// Alignment on simulated arrays whose delays, biases, gains and misalignments are known.
#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

#include "libchar/core/error.hpp"
#include "libchar/fusion/aligner.hpp"
#include "libchar/fusion/alignment_learning.hpp"
#include "libchar/fusion/budget_meter.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using fusion::Alignment;
using fusion::AlignmentData;
using fusion::AlignmentOptions;

namespace {

struct AlignmentDraws {
  explicit AlignmentDraws(unsigned seed) : next(seed) {}
  double uniform() { return next.uniform(); }
  double normal() { return next(); }
  test::Gaussian next;
};

struct AlignedArray {
  std::vector<double> delay, bias, gain;
  std::vector<std::vector<double>> cross;  // [axis][sensor]
  AlignmentData data;
  Eigen::VectorXd x;
};

// Sum of sines of random frequencies and phases: known between its samples too.
struct Motion {
  Motion(AlignmentDraws& draws, double amplitude) {
    for (int k = 0; k < 24; ++k)
      parts.push_back({amplitude * draws.normal() / std::sqrt(12), 0.002 + 0.12 * draws.uniform(),
                       2 * std::numbers::pi * draws.uniform()});
  }
  double operator()(double t) const {
    double sum = 0;
    for (const auto& p : parts) sum += p[0] * std::sin(2 * std::numbers::pi * p[1] * t + p[2]);
    return sum;
  }
  std::vector<std::array<double, 3>> parts;
};

struct ArrayKind {
  Eigen::Index sensors = 6, axes = 0, instants = 6000;
  double delay = 0.6, gain = 0.02, bias = 0.3, cross = 0.02, noise = 0.02, motion = 1;
};

AlignedArray simulated_array(unsigned seed, const ArrayKind& kind) {
  AlignmentDraws draws(seed);
  AlignedArray out;
  const Motion x(draws, kind.motion);
  std::vector<Motion> others;
  for (Eigen::Index a = 0; a < kind.axes; ++a) others.emplace_back(draws, kind.motion);
  const auto centred = [&](double size) {
    std::vector<double> v;
    double mean = 0;
    for (Eigen::Index i = 0; i < kind.sensors; ++i) v.push_back(size * (2 * draws.uniform() - 1));
    for (const double value : v) mean += value / static_cast<double>(kind.sensors);
    for (double& value : v) value -= mean;
    return v;
  };
  out.delay = centred(kind.delay);
  out.bias = centred(kind.bias);
  out.gain = centred(kind.gain);
  for (Eigen::Index a = 0; a < kind.axes; ++a) out.cross.push_back(centred(kind.cross));
  const Eigen::Index n = kind.sensors;
  out.data.channels = n;
  out.data.starts = {0};
  out.data.samples.resize(n * (1 + kind.axes), kind.instants);
  out.x.resize(kind.instants);
  for (Eigen::Index t = 0; t < kind.instants; ++t) {
    const auto time = static_cast<double>(t);
    out.x(t) = x(time);
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto s = static_cast<std::size_t>(i);
      double y = out.bias[s] + (1 + out.gain[s]) * x(time - out.delay[s]);
      for (std::size_t a = 0; a < others.size(); ++a) {
        y += out.cross[a][s] * others[a](time);
        out.data.samples((static_cast<Eigen::Index>(a) + 1) * n + i, t) = others[a](time) + kind.noise * draws.normal();
      }
      out.data.samples(i, t) = y + kind.noise * draws.normal();
    }
  }
  return out;
}

// Leave-one-out RMS of the mean, beside that of the samples as they are.
std::pair<double, double> before_and_after(const AlignedArray& array, const Alignment& learnt) {
  const fusion::Aligner aligner(learnt);
  const Eigen::Index n = array.data.channels, m = array.data.samples.cols();
  fusion::BudgetMeter meter(n, array.data.samples.rows() / n - 1, m, false);
  Eigen::VectorXd aligned, cross;
  for (Eigen::Index t = 0; t < m; ++t) {
    aligner.column(array.data.samples, t, aligned);
    fusion::cross_means(learnt, array.data.samples.col(t), cross);
    meter.push(array.data.samples.col(t).head(n), fusion::in_time(learnt, aligned, cross), aligned, cross, 0);
  }
  const fusion::ErrorBudget budget = meter.result();
  return {budget.before, budget.after};
}

double beyond(double value, double truth, double error) { return std::abs(value - truth) / error; }

}  // namespace

TEST_CASE("alignment: samples between instants are within the stated accuracy") {
  const auto worst = [](fusion::Interpolation how, double frequency) {
    double most = 0;
    std::vector<double> y(64);
    for (int phase = 0; phase < 8; ++phase) {
      const auto wave = [&](double t) { return std::cos(2 * std::numbers::pi * (frequency * t + phase / 8.0)); };
      for (int t = 0; t < 64; ++t) y[static_cast<std::size_t>(t)] = wave(t);
      for (double delay = -0.95; delay < 1; delay += 0.1)
        most = std::max(most, std::abs(fusion::DelayTaps(delay, how).at(y.data(), 1, 64, 30) - wave(30 + delay)));
    }
    return most;
  };
  for (const double frequency : {0.01, 0.1, 0.2, 0.3, 0.37}) {
    CHECK(worst(fusion::Interpolation::sinc, frequency) < 1e-4);
    if (frequency <= 0.12) CHECK(worst(fusion::Interpolation::cubic, frequency) < 1e-2);
  }
}

TEST_CASE("alignment: delays, biases, gains and misalignments are recovered within their errors") {
  // Of 4 seeds x 6 sensors x 5 terms 0.3 are expected beyond 3 standard errors (Student, 29).
  int outside = 0, all = 0;
  for (const unsigned seed : {11U, 12U, 13U, 14U}) {
    const AlignedArray array = simulated_array(seed, {.axes = 2});
    const Alignment learnt = fusion::learn_alignment(array.data, {});
    for (std::size_t i = 0; i < 6; ++i) {
      const fusion::ChannelAlignment& c = learnt.channels[i];
      INFO("seed " << seed << " sensor " << i << ": delay " << c.delay << " +- " << c.delay_se << " of "
                   << array.delay[i] << ", gain " << c.gain << " +- " << c.gain_se << " of " << array.gain[i]
                   << ", bias " << c.bias << " +- " << c.bias_se << " of " << array.bias[i]);
      CHECK(c.delay == Approx(array.delay[i]).margin(0.01));
      CHECK(c.gain == Approx(array.gain[i]).margin(0.003));
      CHECK(c.bias == Approx(array.bias[i]).margin(0.003));
      for (const double z :
           {beyond(c.delay, array.delay[i], c.delay_se), beyond(c.gain, array.gain[i], c.gain_se),
            beyond(c.bias, array.bias[i], c.bias_se), beyond(c.cross[0], array.cross[0][i], c.cross_se[0]),
            beyond(c.cross[1], array.cross[1][i], c.cross_se[1])}) {
        ++all;
        outside += z > 3 ? 1 : 0;
      }
    }
    const auto [before, after] = before_and_after(array, learnt);
    CHECK(after < 1.02 * 0.02 * std::sqrt(6.0 / 5));
    CHECK(before > 5 * after);
  }
  CHECK(all == 120);
  CHECK(outside <= 3);
}

TEST_CASE("alignment: taught by the truth, what all sensors share is found too") {
  AlignedArray array = simulated_array(21, {.sensors = 3});
  array.data.truth = array.x.transpose();
  array.data.samples.array() += 5;
  const Alignment learnt = fusion::learn_alignment(array.data, {});
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(learnt.channels[i].bias == Approx(5 + array.bias[i]).margin(0.003));
    CHECK(learnt.channels[i].delay == Approx(array.delay[i]).margin(0.01));
    CHECK(learnt.channels[i].gain == Approx(array.gain[i]).margin(0.003));
  }
}

TEST_CASE("alignment: several samples of delay, two sensors") {
  const AlignedArray array = simulated_array(31, {.sensors = 2, .delay = 5});
  const Alignment learnt = fusion::learn_alignment(array.data, {});
  for (std::size_t i = 0; i < 2; ++i) CHECK(learnt.channels[i].delay == Approx(array.delay[i]).margin(0.02));
}

TEST_CASE("alignment: delays of many samples, blind and with a reference, all of one sign") {
  for (const double size : {4.0, 10.0, 60.0}) {
    const AlignedArray two = simulated_array(32, {.sensors = 2, .instants = 20000, .delay = size});
    const Alignment found = fusion::learn_alignment(two.data, {});
    for (std::size_t i = 0; i < 2; ++i) {
      INFO(size << " " << two.delay[i]);
      CHECK(found.channels[i].delay == Approx(two.delay[i]).margin(0.02));
    }
  }
  const AlignedArray apart = simulated_array(36, {.sensors = 5, .instants = 20000, .delay = 20});
  const Alignment blind = fusion::learn_alignment(apart.data, {});
  for (std::size_t i = 0; i < 5; ++i) CHECK(blind.channels[i].delay == Approx(apart.delay[i]).margin(0.02));
  double most = 0;
  for (const fusion::ChannelAlignment& c : blind.channels) most = std::max(most, std::abs(c.delay));
  CHECK(fusion::margin_of(blind) == 13 + static_cast<Eigen::Index>(std::ceil(most)));

  AlignedArray late = simulated_array(33, {.sensors = 3, .instants = 20000, .delay = 6});
  constexpr Eigen::Index kLate = 90;
  late.data.truth = late.x.transpose();
  const Eigen::Index kept = late.data.samples.cols() - kLate;
  late.data.samples = late.data.samples.leftCols(kept).eval();
  late.data.truth = late.data.truth.tail(kept).eval();
  const Alignment taught = fusion::learn_alignment(late.data, {});
  for (std::size_t i = 0; i < 3; ++i) {
    INFO(i);
    CHECK(taught.channels[i].delay == Approx(late.delay[i] + kLate).margin(0.02));
    CHECK(taught.channels[i].gain == Approx(late.gain[i]).margin(0.003));
  }
}

TEST_CASE("alignment: beyond the longest search a delay stays at zero, and a short stretch is not searched far") {
  AlignedArray far = simulated_array(34, {.sensors = 2, .instants = 20000, .delay = 0});
  far.data.truth = far.x.transpose().tail(19700).eval();
  far.data.samples = far.data.samples.leftCols(19700).eval();
  for (const fusion::ChannelAlignment& c : fusion::learn_alignment(far.data, {}).channels) CHECK(c.delay == 0);
  const AlignedArray brief = simulated_array(35, {.sensors = 2, .instants = 600, .delay = 40});
  for (const fusion::ChannelAlignment& c : fusion::learn_alignment(brief.data, {}).channels)
    CHECK(std::abs(c.delay) <= 8);
}

TEST_CASE("alignment: blind, sensors in another unit, of another sign or with offsets of their own move no other") {
  ArrayKind kind;
  kind.sensors = 5;
  kind.delay = kind.gain = kind.bias = 0;
  constexpr double kRad = std::numbers::pi / 180;
  struct Kind {
    double scale, offset, level;
    std::vector<Eigen::Index> sensors;
  };
  for (const Kind& wrong : {Kind{1, 0.5, 0, {1, 3}}, Kind{kRad, 0, 0, {2}}, Kind{1 / kRad, 0, 3, {2}},
                            Kind{kRad, 0, 3, {0}}, Kind{-1, 0, 0, {4}}, Kind{-1, 0, 3, {1}}, Kind{1, 2, 3, {2}}}) {
    AlignedArray array = simulated_array(11, kind);
    array.data.samples.array() += wrong.level;
    for (const Eigen::Index i : wrong.sensors)
      array.data.samples.row(i) = (wrong.scale * array.data.samples.row(i)).array() + wrong.offset;
    const Alignment learnt = fusion::learn_alignment(array.data, {});
    CAPTURE(wrong.scale, wrong.offset, wrong.level, wrong.sensors[0]);
    for (Eigen::Index i = 0; i < kind.sensors; ++i) {
      const fusion::ChannelAlignment& channel = learnt.channels[static_cast<std::size_t>(i)];
      const bool is_wrong = std::find(wrong.sensors.begin(), wrong.sensors.end(), i) != wrong.sensors.end();
      CHECK(channel.used == !(is_wrong && wrong.scale < 0));
      if (!channel.used) continue;
      CHECK(1 + channel.gain == Approx(is_wrong ? wrong.scale : 1).epsilon(0.005));
      CHECK(channel.bias == Approx(is_wrong ? wrong.offset : 0).margin(0.01 * (is_wrong ? wrong.scale : 1)));
    }
    if (wrong.scale < 0) CHECK_THAT(learnt.notes.at(0), Catch::Contains("1 of 5 sensors do not follow the input"));
  }
}

TEST_CASE("alignment: an array that needs none is left as it is, and no worse") {
  const AlignedArray array = simulated_array(41, {.delay = 0, .gain = 0, .bias = 0, .noise = 0.1});
  const Alignment learnt = fusion::learn_alignment(array.data, {});
  int significant = 0;
  for (const fusion::ChannelAlignment& c : learnt.channels)
    significant +=
        std::abs(c.delay) > 3.7 * c.delay_se || std::abs(c.gain) > 3.7 * c.gain_se || std::abs(c.bias) > 3.7 * c.bias_se
            ? 1
            : 0;
  CHECK(significant == 0);
  double raw = 0, aligned_error = 0;
  const fusion::Aligner aligner(learnt);
  Eigen::VectorXd aligned;
  for (Eigen::Index t = 30; t < 5970; ++t) {
    aligner.column(array.data.samples, t, aligned);
    raw += std::pow(array.data.samples.col(t).mean() - array.x(t), 2);
    aligned_error += std::pow(aligned.mean() - array.x(t), 2);
  }
  CHECK(std::sqrt(aligned_error / raw) < 1.005);
}

TEST_CASE("alignment: what the stretch cannot tell stays nominal and is said") {
  const AlignedArray array = simulated_array(51, {.motion = 0});
  const Alignment learnt = fusion::learn_alignment(array.data, {});
  CHECK(learnt.notes.size() == 2);
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(learnt.channels[i].delay == 0);
    CHECK(learnt.channels[i].gain == Approx(0).margin(1e-12));
    CHECK(learnt.channels[i].bias == Approx(array.bias[i]).margin(0.003));
  }
}

TEST_CASE("alignment: shifts, scales and orders of the sensors carry over") {
  const AlignedArray array = simulated_array(61, {.instants = 2000});
  const Alignment one = fusion::learn_alignment(array.data, {});
  AlignmentData other = array.data;
  other.samples = 1000 * (array.data.samples.colwise().reverse().array() + 7);
  const Alignment two = fusion::learn_alignment(other, {});
  for (std::size_t i = 0; i < 6; ++i) {
    const fusion::ChannelAlignment &a = one.channels[i], &b = two.channels[5 - i];
    CHECK(b.delay == Approx(a.delay).margin(1e-5));
    CHECK(b.gain == Approx(a.gain).margin(1e-6));
    CHECK(b.bias / 1000 == Approx(a.bias - 7 * a.gain).margin(1e-4));
  }
}

TEST_CASE("alignment: wild and missing samples, saturation and dead sensors") {
  const AlignedArray clean = simulated_array(71, {});
  const Alignment before = fusion::learn_alignment(clean.data, {});
  AlignedArray array = clean;
  for (const Eigen::Index t : {500, 1700, 3100}) array.data.samples(2, t) = 1e9;
  for (Eigen::Index t = 2000; t < 2300; ++t) array.data.samples(4, t) = std::numeric_limits<double>::quiet_NaN();
  array.data.samples.row(1) = array.data.samples.row(1).cwiseMin(1.2);
  const Alignment after = fusion::learn_alignment(array.data, {});
  CHECK(after.limits[1].high == 1.2);
  for (std::size_t i = 0; i < 6; ++i) {
    CHECK(after.channels[i].delay == Approx(before.channels[i].delay).margin(0.01));
    CHECK(after.channels[i].gain == Approx(before.channels[i].gain).margin(0.003));
    CHECK(after.channels[i].bias == Approx(before.channels[i].bias).margin(0.003));
  }
  array.data.samples.row(0).setConstant(3);
  const Alignment dead = fusion::learn_alignment(array.data, {});
  CHECK_FALSE(dead.channels[0].used);
  CHECK(dead.channels[3].used);
  array.data.samples.setConstant(3);
  CHECK_THROWS_AS(fusion::learn_alignment(array.data, {}), Error);
  array.data.samples = clean.data.samples.leftCols(60);
  CHECK_THROWS_AS(fusion::learn_alignment(array.data, {}), Error);
}

TEST_CASE("error budget: shares are those of the parts that were put in") {
  const AlignedArray array = simulated_array(81, {.instants = 20000});
  const Alignment learnt = fusion::learn_alignment(array.data, {});
  const fusion::Aligner aligner(learnt);
  fusion::BudgetMeter meter(6, 0, 20000, false);
  Eigen::VectorXd aligned;
  for (Eigen::Index t = 0; t < 20000; ++t) {
    aligner.column(array.data.samples, t, aligned);
    meter.push(array.data.samples.col(t), fusion::in_time(learnt, aligned, Eigen::VectorXd(0)), aligned,
               Eigen::VectorXd(0), 0);
  }
  const fusion::ErrorBudget budget = meter.result();
  const double power = (array.x.array() - array.x.mean()).square().mean();
  for (std::size_t i = 0; i < 6; ++i) {
    const auto& parts = budget.channels[i].parts;
    const double whole = budget.channels[i].rms * budget.channels[i].rms;
    double sum = 0;
    for (const fusion::PartShare& part : parts) {
      sum += part.share;
      CHECK(part.ci95.low <= part.share);
      CHECK(part.share <= part.ci95.high);
    }
    CHECK(sum == Approx(1).margin(1e-9));
    CHECK(parts[0].share * whole == Approx(array.bias[i] * array.bias[i]).margin(0.003));
    CHECK(parts[1].share * whole == Approx(array.gain[i] * array.gain[i] * power).margin(0.0002));
    // The mean has a sixth of the noise, and interpolation damps it beyond 0.4 of the rate.
    CHECK((parts[4].share + parts[5].share) * whole == Approx(4e-4 * 5 / 6).epsilon(0.15));
  }
}

TEST_CASE("error budget: a delay that jitters follows the slope, and is told from noise") {
  AlignmentDraws draws(91);
  const Motion x(draws, 1);
  fusion::BudgetMeter meter(4, 0, 30000, true);
  Eigen::VectorXd y(4);
  for (int t = 0; t < 30000; ++t) {
    for (Eigen::Index i = 0; i < 4; ++i) y(i) = x(t - 0.3 * (draws.uniform() - 0.5)) + 0.01 * draws.normal();
    meter.push(y, y, y, Eigen::VectorXd(0), x(t));
  }
  const fusion::ErrorBudget budget = meter.result();
  double slope = 0;
  for (int t = 1; t < 29999; ++t) slope += std::pow(0.5 * (x(t + 1) - x(t - 1)), 2) / 29998;
  const double jitter = slope * 0.09 / 12;
  for (const fusion::ChannelBudget& c : budget.channels)
    CHECK(c.parts[4].share == Approx(jitter / (jitter + 1e-4)).margin(0.1));
}

TEST_CASE("alignment: sensors without a delay are not given one by the smoothing of their noise") {
  for (const bool blind : {false, true})
    for (const auto interpolation : {fusion::Interpolation::sinc, fusion::Interpolation::cubic})
      for (const double rate : {0.0005, 0.004, 0.03}) {
        INFO(blind << " " << rate);
        test::Gaussian gauss(31);
        AlignmentData data;
        data.channels = 3;
        data.samples.resize(3, 9000);
        data.starts = {0};
        if (!blind) data.truth.resize(9000);
        for (Eigen::Index t = 0; t < 9000; ++t) {
          const double x = 2 * std::sin(2 * std::numbers::pi * rate * static_cast<double>(t));
          for (Eigen::Index i = 0; i < 3; ++i) data.samples(i, t) = x + 0.1 * gauss();
          if (!blind) data.truth(t) = x;
        }
        AlignmentOptions options;
        options.interpolation = interpolation;
        const Alignment learnt = fusion::learn_alignment(data, options);
        for (const fusion::ChannelAlignment& channel : learnt.channels)
          CHECK(std::abs(channel.delay) <= (channel.delay_se > 0 ? 4 * channel.delay_se : 0.0));
      }
}
