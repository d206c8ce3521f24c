// The fault detector of `minque`: its parts by known answers, the whole on arrays whose truth is known
// (docs/theory/fusion.md; rates and delays in full: fault_bench).

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>

#include "libchar/fusion/detail/fault/cusum_bank.hpp"
#include "libchar/fusion/detail/fault/fault_isolation.hpp"
#include "libchar/fusion/detail/fault/fault_watch.hpp"
#include "libchar/fusion/detail/fault/repeat_watch.hpp"
#include "tests/fusion/vectors.hpp"
#include "tests/support/noise.hpp"

using namespace libchar::fusion;

namespace {

constexpr double kRate = 200;
constexpr Eigen::Index kFaultFree = 6000;

/// Six sensors of deviations .052 … .14 that see a sine of 7.85 at 5 Hz: [RV 5.1].
struct Gyroscopes {
  Eigen::MatrixXd y;
  Eigen::RowVectorXd x;
  Array array;
};

struct Differences {
  double gain = 0, delay = 0, walk = 0;
};

Gyroscopes gyroscopes(Eigen::Index instants, std::uint64_t seed, const Differences& d = {}) {
  Gyroscopes g;
  test::Gaussian gauss(seed);
  g.y.resize(6, instants);
  g.x.resize(instants);
  const auto truth = [](double k) { return 7.854 * std::sin(k * 2 * std::numbers::pi / 40 + .785); };
  for (Eigen::Index k = 0; k < instants; ++k) g.x[k] = truth(static_cast<double>(k));
  for (Eigen::Index i = 0; i < 6; ++i) {
    const double gain = 1 + d.gain * gauss(), delay = d.delay * (2 * gauss.uniform() - 1);
    const double deviation = std::sqrt(304.2) * 1e-3 * static_cast<double>(3 + i);
    double walk = 0;
    for (Eigen::Index k = 0; k < instants; ++k) {
      walk += d.walk / std::sqrt(kRate) * gauss();
      g.y(i, k) = gain * truth(static_cast<double>(k) - delay) + deviation * gauss() + walk;
    }
  }
  g.array = test::array(6);
  g.array.rate_hz = kRate;
  g.array.fault_free_samples = kFaultFree;
  return g;
}

double error_rms(const Eigen::RowVectorXd& error) {
  return std::sqrt(error.squaredNorm() / static_cast<double>(error.size()));
}

}  // namespace

TEST_CASE("cumulative sums: three instants by hand") {
  CusumBank bank(1);
  CusumSample sample(bank.padded());
  sample.present[0] = 1;
  for (const double z : {3.0, -1.0, 2.0}) {
    sample.z[0] = z;
    sample.zz[0] = z * z;
    bank.step(sample);
  }
  // Bias of 1.4: 4.2 - .98 = 3.22, - 1.4 - .98 = .84, + 2.8 - .98 = 2.66. Bias of .7: 1.855, .91, 2.065.
  // Bias of 2.8: 8.4 - 3.92 = 4.48, 0, 1.68. Noise of 2.6: .42604 z^2 - .95551: 2.8789, 2.3494, 3.0980;
  // of 1.7: 1.8803, 1.6766, 2.4542.
  CHECK(bank.top(0) == Approx(3.0980).margin(1e-4));
  CHECK(bank.leading(0) == CusumInput::noise);
  // A missing sample changes nothing.
  sample = CusumSample(bank.padded());
  CHECK(bank.step(sample) == Approx(3.0980).margin(1e-4));
  bank.reset();
  CHECK(bank.step(sample) == 0);
}

TEST_CASE("cumulative sums: every row of six sensors against one at a time") {
  CusumBank bank(6);
  CusumSample sample(bank.padded());
  test::Gaussian gauss(8);
  struct Row {
    double size;
    CusumInput input;
    double sum = 0;
  };
  std::vector<std::vector<Row>> rows(6);
  for (auto& own : rows) {
    for (const double t : {0.35, 0.7, 1.4, 2.8})
      for (const double sign : {1.0, -1.0})
        for (const CusumInput input : {CusumInput::bias, CusumInput::gain}) own.push_back({sign * t, input});
    for (const double k : {1.3, 1.7, 2.6, 5.0}) own.push_back({k, CusumInput::noise});
  }
  for (int step = 0; step < 500; ++step) {
    for (std::size_t i = 0; i < 6; ++i) {
      const bool here = (step + static_cast<int>(i)) % 7 != 0;
      const double z = here ? 1.3 * gauss() : 0, u = here ? gauss() : 0, w = here ? 1 : 0;
      sample.z[i] = z;
      sample.present[i] = w;
      sample.uz[i] = u * z;
      sample.uu[i] = u * u;
      sample.zz[i] = z * z;
      for (Row& row : rows[i]) {
        const double t = row.size;
        const double by = row.input == CusumInput::bias   ? t * z - t * t / 2 * w
                          : row.input == CusumInput::gain ? t * u * z - t * t / 2 * u * u
                                                          : (1 - 1 / (t * t)) / 2 * z * z - std::log(t) * w;
        row.sum = std::max(0.0, row.sum + by);
      }
    }
    const double top = bank.step(sample);
    double largest = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      const auto best =
          std::max_element(rows[i].begin(), rows[i].end(), [](const Row& a, const Row& b) { return a.sum < b.sum; });
      CHECK(bank.top(i) == Approx(best->sum).epsilon(1e-12).margin(1e-12));
      largest = std::max(largest, best->sum);
    }
    CHECK(top == Approx(largest).epsilon(1e-12).margin(1e-12));
  }
}

TEST_CASE("isolation: the largest consistent set, or none") {
  FaultIsolation isolation(Eigen::MatrixXd::Ones(6, 1), 6);
  const int all[] = {0, 1, 2, 3, 4, 5};
  const auto off = [&](std::initializer_list<double> means) {
    std::vector<WindowEvidence> evidence(6);
    std::size_t i = 0;
    for (const double mean : means) {
      evidence[i].samples = 100;
      evidence[i].mean = mean;
      evidence[i++].mean_weight = 100;
    }
    return isolation.isolate(evidence, all, 6);
  };
  CHECK(off({0, .1, 0, -.1, 0, .05}).best == 0);
  CHECK(off({0, .1, 0, 1, 0, .05}).certain == 0b001000);
  CHECK(off({1, .1, 0, 1, 0, .05}).certain == 0b001001);
  CHECK(off({1, -1, 0, 2, 0, .05}).certain == 0b001011);
  const Isolation split = off({1, 1, 1, 0, 0, 0});
  CHECK(split.certain == 0);
  CHECK((split.best | split.other) == 0b111111);
  CHECK_FALSE(off({0, 1, 2, 3, 4, 5}).consistent());
  CHECK(off({0, .1, 0, 1, 0, .05}).consistent());
}

TEST_CASE("repetitions: stuck, held, still and at the end of the range") {
  using Doing = RepeatWatch::State;
  test::Gaussian gauss(3);
  const auto state = [&](const std::function<double(int, double)>& how, int instants) {
    RepeatWatch watch(1, 20);
    Doing last = Doing::moving;
    double held = 0;
    for (int k = 0; k < instants; ++k) {
      const double x = 5 * std::sin(.03 * k);
      held = how(k, x);
      watch.take_in(0, held, x, .1);
      last = watch.state(0);
      if (last != Doing::moving) break;
    }
    return last;
  };
  CHECK(state([&](int, double x) { return x + .1 * gauss(); }, 20000) == Doing::moving);
  double last = 0;
  const auto hold_from = [&](int from) {
    return [&, from](int k, double x) {
      if (k < from) last = x + .1 * gauss();
      return last;
    };
  };
  CHECK(state(hold_from(1000), 1010) == Doing::stuck);
  // Every tenth sample of its own, held.
  CHECK(state([&](int k, double x) { return k % 10 == 0 ? last = x + .1 * gauss() : last; }, 5000) == Doing::moving);
  // Steps of 2: much the same value again and again, and rightly so.
  CHECK(state([&](int, double x) { return 2 * std::round((x + .1 * gauss()) / 2); }, 20000) == Doing::moving);
  CHECK(state(
            [&](int k, double x) {
              const double y = x + .1 * gauss();
              return k < 1000 ? y / 2 : std::min(y, 4.5);
            },
            2000) == Doing::saturated);
}

TEST_CASE("repetitions: a sensor that follows in coarse steps, some time behind, is not stuck") {
  test::Gaussian gauss(4);
  RepeatWatch watch(1, 20);
  double held = 0;
  int early = 0, late = 0, instants = 0;
  for (int k = 0; k < 60000; ++k) {
    const double x = 5 * std::sin(.003 * k);
    if (std::abs(x - held) > .4 + .6 * gauss.uniform()) held = std::round(10 * x) / 10;
    watch.take_in(0, held, x, .1);
    const bool stuck = watch.state(0) == RepeatWatch::State::stuck;
    (k < 6000 ? early : late) += stuck;
  }
  CAPTURE(early);
  CHECK(late == 0);
  for (; watch.state(0) == RepeatWatch::State::moving && instants < 3000; ++instants)
    watch.take_in(0, held, 5 * std::sin(.003 * instants), .1);
  CHECK(instants < 3000);  // and one that stays where it is, is
}

TEST_CASE("minque: healthy sensors that differ by gain, delay and drift are no faults") {
  for (const Differences& d : {Differences{}, Differences{.01, .5, 0}, Differences{.01, .5, 3e-4}})
    for (const std::uint64_t seed : {11U, 12U}) {
      const Gyroscopes g = gyroscopes(150000, seed, d);
      auto minque = test::make("minque", g.array);
      test::run(*minque, g.y);
      CHECK(minque->faults()->events().empty());
      CHECK(minque->faults()->doubts().empty());
    }
}

TEST_CASE("minque: which sensor, since when, and what kind of fault") {
  struct Case {
    const char* name;
    int sensor;
    std::function<double(double, test::Gaussian&)> how;
    FaultRule rule;
    Eigen::Index within;  ///< instants
  };
  const auto gain = [](double g) { return [g](double y, test::Gaussian&) { return g * y; }; };
  const auto bias = [](double b) { return [b](double y, test::Gaussian&) { return y + b; }; };
  const std::vector<Case> cases{
      {"gain -2 %", 2, gain(.98), FaultRule::gain, 150},
      {"gain -2 %", 5, gain(.98), FaultRule::gain, 300},
      {"bias .1", 0, bias(.1), FaultRule::bias, 100},
      {"bias .1", 5, bias(.1), FaultRule::bias, 500},
      {"noise x 2", 2, [](double y, test::Gaussian& gauss) { return y + .1511 * gauss(); }, FaultRule::noise, 200},
      {"dead", 2, [](double, test::Gaussian& gauss) { return .087 * gauss(); }, FaultRule::dead, 3},
      {"saturated", 3, [](double y, test::Gaussian&) { return std::clamp(y, -6.0, 6.0); }, FaultRule::saturated, 60}};
  for (const Case& c : cases) {
    INFO(c.name << " on sensor " << c.sensor + 1);
    Gyroscopes g = gyroscopes(12000, 21);
    test::Gaussian gauss(5);
    for (Eigen::Index k = 8000; k < 12000; ++k) g.y(c.sensor, k) = c.how(g.y(c.sensor, k), gauss);
    auto minque = test::make("minque", g.array);
    test::run(*minque, g.y);
    const auto events = minque->faults()->events();
    REQUIRE_FALSE(events.empty());
    CHECK(events[0].channel == c.sensor);
    CHECK(events[0].sample >= 8000);
    CHECK(events[0].sample < 8000 + c.within);
    if (c.rule != FaultRule::saturated) CHECK(events[0].rule == c.rule);
    for (const FaultEvent& event : events) CHECK(event.channel == c.sensor);
  }
}

TEST_CASE("minque: out while the fault stands, in again within two seconds after it") {
  Gyroscopes g = gyroscopes(44000, 31);
  g.y.row(0).segment(8000, 30000).array() += .1;
  auto minque = test::make("minque", g.array);
  const test::Run out = test::run(*minque, g.y);
  const auto events = minque->faults()->events();
  REQUIRE(events.size() == 2);
  CHECK(events[0].faulty);
  CHECK_FALSE(events[1].faulty);
  CHECK(events[1].sample > 38000);
  CHECK(events[1].sample < 38400);
  // As good as the other five would be.
  CHECK(error_rms((out.x.row(0) - g.x).segment(9000, 28000)) < 1.01 * .04277);
}

TEST_CASE("minque: a noisy sensor is weighed, not dropped") {
  Gyroscopes g = gyroscopes(30000, 41);
  test::Gaussian gauss(6);
  for (Eigen::Index k = 8000; k < 20000; ++k) g.y(0, k) += std::sqrt(8.) * .05232 * gauss();
  auto minque = test::make("minque", g.array);
  const test::Run out = test::run(*minque, g.y);
  const auto events = minque->faults()->events();
  REQUIRE(events.size() >= 2);
  CHECK(events[0].rule == FaultRule::noise);
  CHECK(events[0].channel == 0);
  CHECK(events[0].sample < 8060);
  CHECK(events.back().sample > 20000);
  CHECK(events.back().sample < 20600);
  // Five sensors alone: .04277; with the noisy one at nine times its variance: .04120.
  CHECK(error_rms((out.x.row(0) - g.x).segment(9000, 10000)) < .0420);
}

TEST_CASE("minque: noise of heavy tails is no fault, and a fault in it is found") {
  const auto student = [](test::Gaussian& gauss) {  // of four degrees of freedom and deviation one
    double squares = 0;
    for (int k = 0; k < 4; ++k) {
      const double v = gauss();
      squares += v * v;
    }
    return gauss() / std::sqrt(squares / 4) / std::sqrt(2.0);
  };
  const auto rare = [](test::Gaussian& gauss) { return gauss() + (gauss.uniform() < 2e-3 ? 9 : 0); };
  const std::vector<std::function<double(test::Gaussian&)>> kinds = {student, rare};
  for (const auto& noise : kinds)
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      Gyroscopes g = gyroscopes(40000, seed);
      test::Gaussian gauss(100 + seed);
      for (Eigen::Index k = 0; k < g.y.cols(); ++k)
        for (Eigen::Index i = 0; i < 6; ++i) g.y(i, k) = g.x[k] + 0.1 * noise(gauss);
      auto clean = test::make("minque", g.array);
      test::run(*clean, g.y);
      CHECK(clean->faults()->events().empty());
      for (Eigen::Index k = 30000; k < g.y.cols(); ++k) g.y(2, k) += 0.3;
      auto hit = test::make("minque", g.array);
      test::run(*hit, g.y);
      const auto events = hit->faults()->events();
      REQUIRE(events.size() == 1);
      CHECK(events[0].channel == 2);
      CHECK(events[0].sample >= 30000);
      CHECK(events[0].sample < 30040);
    }
}

TEST_CASE("minque: noise that grows with the motion is no fault, and a fault in it is found") {
  for (const Eigen::Index n : {3, 4, 6})
    for (const double follows : {1.0, 3.0})
      for (const std::uint64_t seed : {1U, 2U}) {
        INFO(n << " sensors, noise 1 + " << follows << " |x|, seed " << seed);
        test::Gaussian gauss(seed);
        Eigen::MatrixXd y(n, 200000);
        double x = 0, slope = 0;
        for (Eigen::Index k = 0; k < y.cols(); ++k) {
          slope += 0.02 * gauss() - 0.05 * slope - 0.004 * x;
          x += slope;
          for (Eigen::Index i = 0; i < n; ++i) y(i, k) = 40 * x + 0.5 * (1 + follows * std::abs(x)) * gauss();
        }
        Array array = test::array(n);
        array.rate_hz = 100;
        array.fault_free_samples = 20000;
        auto clean = test::make("minque", array);
        test::run(*clean, y);
        CHECK(clean->faults()->events().empty());
        y.row(1).tail(40000).array() += 2;
        auto hit = test::make("minque", array);
        test::run(*hit, y);
        const auto events = hit->faults()->events();
        REQUIRE_FALSE(events.empty());
        CHECK(events[0].channel == 1);
        CHECK(events[0].sample >= 160000);
        CHECK(events[0].sample < 160400);
      }
}

TEST_CASE("minque: rare outliers of all sensors are no faults and make nobody stand down") {
  for (const Eigen::Index n : {3, 4, 6})
    for (const Eigen::Index fault_free : {0, 6000}) {
      INFO(n << " sensors, fault-free " << fault_free);
      test::Gaussian gauss(static_cast<std::uint64_t>(40 + n));
      Eigen::MatrixXd y(n, 200000);
      for (Eigen::Index k = 0; k < y.cols(); ++k)
        for (Eigen::Index i = 0; i < n; ++i)
          y(i, k) = 5 * std::sin(.009 * static_cast<double>(k)) + gauss() + (gauss.uniform() < 1e-4 ? 30 * gauss() : 0);
      Array array = test::array(n);
      array.rate_hz = 100;
      array.fault_free_samples = fault_free;
      auto minque = test::make("minque", array);
      test::run(*minque, y);
      CHECK(minque->faults()->events().size() <= 4);  // the first one is seen
      CHECK(minque->faults()->doubts().empty());
    }
}

TEST_CASE("minque: offsets that wander and other axes in stop-and-go are no faults, a dead sensor is") {
  struct Case {
    const char* name;
    double sigma, tau;  ///< of a Gauss-Markov offset, tau in samples
    double cross;       ///< share of another motion
  };
  for (const Case& c : {Case{"slow", 1, 10000, 0}, {"fast", 1, 1000, 0}, {"cross", 0, 1, .03}})
    for (const Eigen::Index n : {3, 4, 6}) {
      INFO(c.name << ", " << n << " sensors");
      test::Gaussian gauss(static_cast<std::uint64_t>(90 + n));
      Eigen::MatrixXd y(n, 200000);
      std::vector<double> offset(static_cast<std::size_t>(n), 0), share = offset;
      for (double& one : share) one = c.cross * gauss();
      double x[2] = {0, 0}, v[2] = {0, 0};
      const double keep = std::exp(-1 / c.tau), w = 2e-3 * std::numbers::pi;
      for (Eigen::Index k = 0; k < y.cols(); ++k) {
        const bool still = k / 10000 % 2 == 1;
        for (int a = 0; a < 2; ++a) {
          v[a] += w * (-1.4 * v[a] - x[a] + (still ? 0 : 60 * std::sqrt(2.8 / w) * gauss()));
          x[a] += w * v[a];
        }
        const double input = c.cross > 0 ? x[0] : 5 * std::sin(.009 * static_cast<double>(k));
        for (Eigen::Index i = 0; i < n; ++i) {
          double& own = offset[static_cast<std::size_t>(i)];
          own = keep * own + c.sigma * std::sqrt(1 - keep * keep) * gauss();
          y(i, k) = input + own + share[static_cast<std::size_t>(i)] * x[1] + gauss();
        }
      }
      y.row(1).tail(5000).setConstant(y(1, y.cols() - 5001));
      Array array = test::array(n);
      array.rate_hz = 100;
      array.fault_free_samples = 100000;
      auto minque = test::make("minque", array);
      test::run(*minque, y);
      const auto events = minque->faults()->events();
      REQUIRE_FALSE(events.empty());
      CHECK(events[0].channel == 1);
      CHECK(events[0].sample >= y.cols() - 5000);
    }
}

TEST_CASE("minque: three against three is said, and nobody is thrown out") {
  Gyroscopes g = gyroscopes(12000, 51);
  g.y.topRows(3).rightCols(4000) *= .9;
  auto minque = test::make("minque", g.array);
  test::run(*minque, g.y);
  CHECK(minque->faults()->events().empty());
  REQUIRE_FALSE(minque->faults()->doubts().empty());
  const FaultDoubt& doubt = minque->faults()->doubts()[0];
  CHECK(doubt.ambiguous);
  CHECK((doubt.one_side | doubt.other_side) == 0b111111);
  CHECK((doubt.one_side == 0b111 || doubt.other_side == 0b111));
  CHECK(doubt.sample >= 8000);
  libchar::Findings warnings;
  minque->remarks(warnings);
  CHECK(warnings.find("faults_ambiguous") != nullptr);
}

TEST_CASE("minque: two and three at once") {
  struct Hurt {
    int sensor;
    double gain, bias;
  };
  for (const std::vector<Hurt>& hurt :
       {std::vector<Hurt>{{0, 1, .2}, {1, 1, .2}}, {{2, .8, 0}, {3, .8, 0}}, {{0, 1, .3}, {1, 1, -.2}, {2, 1, .5}}}) {
    Gyroscopes g = gyroscopes(12000, 61);
    for (const Hurt& h : hurt) g.y.row(h.sensor).tail(4000) = h.gain * g.y.row(h.sensor).tail(4000).array() + h.bias;
    auto minque = test::make("minque", g.array);
    test::run(*minque, g.y);
    std::vector<int> out(6, 0), expected(6, 0);
    for (const FaultEvent& event : minque->faults()->events())
      out[static_cast<std::size_t>(event.channel)] = event.faulty ? 1 : 0;
    for (const Hurt& h : hurt) expected[static_cast<std::size_t>(h.sensor)] = 1;
    CHECK(out == expected);
  }
}

TEST_CASE("minque: a sensor that drops out, comes slowly or joins late is no fault") {
  // [RV 3.3]: the best sensor carries most of the weight.
  const Eigen::VectorXd deviations = (Eigen::VectorXd(5) << 1.764, .789, .558, .2495, .1764).finished();
  constexpr Eigen::Index kInstants = 60000;
  const auto scene = [&](std::uint64_t seed, Eigen::RowVectorXd& x) {
    Eigen::MatrixXd y(5, kInstants);
    test::Gaussian gauss(seed);
    x.resize(kInstants);
    for (Eigen::Index k = 0; k < kInstants; ++k) {
      x[k] = 2.4 * gauss();
      for (Eigen::Index i = 0; i < 5; ++i) y(i, k) = x[k] + deviations[i] * gauss();
    }
    return y;
  };
  const double optimum = 1 / std::sqrt(deviations.cwiseInverse().squaredNorm());
  for (const double detection : {1.0, 2.0})
    for (const int what : {0, 1, 2}) {
      INFO(what << ", detection " << detection);
      Eigen::RowVectorXd x;
      Eigen::MatrixXd y = scene(71, x);
      double share = 0;  // of the instants without the best sensor
      for (Eigen::Index k = 0; k < kInstants; ++k) {
        const bool gone = what == 0 ? k % 2000 < 20 : what == 1 ? k % 10 != 0 : k < 20000;
        if (gone) y(4, k) = std::nan("");
        if (k >= 30000) share += gone ? 1.0 / 30000 : 0;
      }
      Array array = test::array(5);
      array.rate_hz = kRate;
      auto minque = test::make("minque", array, {{"fault_detection", detection}});
      const test::Run out = test::run(*minque, y);
      CHECK(minque->faults()->events().empty());
      const double without = 1 / std::sqrt(deviations.head(4).cwiseInverse().squaredNorm());
      const double best = std::sqrt(share * without * without + (1 - share) * optimum * optimum);
      CHECK(error_rms((out.x.row(0) - x).tail(30000)) < 1.01 * best);
    }
}

TEST_CASE("minque starts by medians: one sensor that is far off moves nobody") {
  Eigen::RowVectorXd x = Eigen::RowVectorXd::Zero(200);
  Eigen::MatrixXd y(5, 200);
  test::Gaussian gauss(81);
  for (Eigen::Index k = 0; k < 200; ++k)
    for (Eigen::Index i = 0; i < 5; ++i) y(i, k) = (i == 2 ? 1e12 : 1) * gauss();
  auto minque = test::make("minque", test::array(5));
  const test::Run out = test::run(*minque, y);
  CHECK((out.x - x).cwiseAbs().maxCoeff() < 4);
}

TEST_CASE("minque: an array that moves as nobody said stands the watch down instead of throwing sensors out") {
  // From 10 s on every sensor sees a motion of its own, ten times its noise.
  Gyroscopes g = gyroscopes(40000, 91);
  test::Gaussian gauss(7);
  for (Eigen::Index i = 0; i < 6; ++i) {
    double own = 0;
    for (Eigen::Index k = 10000; k < 40000; ++k) {
      own = .98 * own + .2 * gauss();
      g.y(i, k) += own;
    }
  }
  const bool told = GENERATE(true, false);
  INFO("fault-free start given: " << told);
  if (!told) g.array.fault_free_samples = 0;
  auto minque = test::make("minque", g.array);
  test::run(*minque, g.y);
  std::vector<std::int64_t> out(6, 0), since(6, -1);
  for (const FaultEvent& event : minque->faults()->events()) {
    const auto i = static_cast<std::size_t>(event.channel);
    if (event.rule == FaultRule::noise) continue;
    if (event.faulty)
      since[i] = event.sample;
    else if (since[i] >= 0) {
      out[i] += event.sample - since[i];
      since[i] = -1;
    }
  }
  for (std::size_t i = 0; i < 6; ++i) {
    INFO(i);
    if (since[i] >= 0) out[i] += 40000 - since[i];
    CHECK(out[i] < (told ? 1000 : 400));
  }
  libchar::Findings warnings;
  minque->remarks(warnings);
  if (told) CHECK(warnings.find("fault_watch_stood_down") != nullptr);
}
