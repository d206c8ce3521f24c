// The neural simplex: known answers of each module (adaptation, decision, past), what the whole promises.

#include "libchar/fusion/algorithms/neural_simplex.hpp"

#include <Eigen/Core>
#include <catch2/catch.hpp>
#include <cmath>

#include "tests/fusion/heap_counter.hpp"
#include "tests/fusion/vectors.hpp"
#include "tests/support/noise.hpp"

using namespace libchar;
using namespace libchar::fusion;

namespace {

/// Rows of a known function of two inputs.
struct KnownRows final : FitRows {
  KnownRows(std::size_t count, double (*f)(double, double)) : function(f) {
    test::Gaussian gauss(3);
    for (std::size_t k = 0; k < 2 * count; ++k) inputs.push_back(gauss());
  }
  double row(std::size_t k, double* input) const override {
    input[0] = 5 + 2 * inputs[2 * k];
    input[1] = inputs[2 * k + 1];
    return function(inputs[2 * k], inputs[2 * k + 1]);
  }
  double (*function)(double, double);
  std::vector<double> inputs;
};

struct SimplexScene {
  Eigen::MatrixXd y;
  Eigen::MatrixXd truth;
  Array array;
};

/// `bent`: sensors saturate, each at its own level; else the input is white, so that its past tells nothing.
SimplexScene simplex_scene(bool bent, Eigen::Index instants = 12000, Eigen::Index learning = 6000) {
  test::Gaussian gauss(21);
  const Eigen::Array4d level(1.2, 1.6, 2, 2.5), deviation(0.02, 0.03, 0.05, 0.08);
  SimplexScene made{Eigen::MatrixXd(4, instants), Eigen::MatrixXd(1, instants), test::array(4)};
  for (Eigen::Index k = 0; k < instants; ++k) {
    const auto t = static_cast<double>(k);
    const double slow = 1.3 * std::sin(0.011 * t) + 0.5 * std::sin(0.0371 * t + 1);
    const double x = bent ? slow : gauss();
    made.truth(0, k) = x;
    for (Eigen::Index i = 0; i < 4; ++i)
      made.y(i, k) = (bent ? level[i] * std::tanh(x / level[i]) : x) + deviation[i] * gauss();
  }
  made.array.learning_samples = learning;
  return made;
}

std::unique_ptr<Runner> taught(const SimplexScene& s, const char* name = "neural-simplex") {
  auto runner = test::make(name, s.array);
  const Eigen::Index n = s.array.learning_samples;
  if (std::string_view(name) == "neural-simplex") runner->learn(s.y.leftCols(n), s.truth.leftCols(n));
  runner->finish_learning();
  return runner;
}

struct SimplexRun {
  Eigen::VectorXd x, error;
  std::vector<HandOver> hand_overs;
  double rms(Eigen::Index from = 0) const {
    const Eigen::VectorXd e = error.tail(error.size() - from);
    return std::sqrt(e.squaredNorm() / static_cast<double>(e.size()));
  }
};

SimplexRun run_behind_learning(const SimplexScene& s, Runner& runner) {
  const Eigen::Index n = s.y.cols() - s.array.learning_samples;
  Eigen::MatrixXd x(1, n), variance(1, n);
  runner.run(s.y.rightCols(n), x, variance);
  SimplexRun out{x.row(0), (x - s.truth.rightCols(n)).row(0), {}};
  if (const HandOverLog* log = runner.hand_overs()) out.hand_overs.assign(log->events().begin(), log->events().end());
  return out;
}

bool led_by(const SimplexRun& run, Lead lead) {
  return std::any_of(run.hand_overs.begin(), run.hand_overs.end(), [&](const HandOver& h) { return h.to == lead; });
}

bool ended_for(const SimplexRun& run, HandOverReason reason) {
  return std::any_of(run.hand_overs.begin(), run.hand_overs.end(),
                     [&](const HandOver& h) { return h.reason == reason; });
}

}  // namespace

TEST_CASE("simplex, adaptation: the linear system of a known answer") {
  double a[] = {4, 0, 0, 2, 5, 0, 0.4, 1, 6};  // lower triangle of a symmetric matrix
  double b[] = {4 * 1 + 2 * -2 + 0.4 * 3, 2 * 1 + 5 * -2 + 1 * 3, 0.4 * 1 + 1 * -2 + 6 * 3};
  REQUIRE(solve_in_place(a, b, 3, 0));
  CHECK(b[0] == Approx(1).epsilon(1e-14));
  CHECK(b[1] == Approx(-2).epsilon(1e-14));
  CHECK(b[2] == Approx(3).epsilon(1e-14));
  double wrong[] = {1, 0, 2, 1}, side[] = {1, 1};
  CHECK_FALSE(solve_in_place(wrong, side, 2, 0));
}

TEST_CASE("simplex, adaptation: an affine target is found exactly, a bent one by the network") {
  const KnownRows affine(800, [](double u, double v) { return 3 + 4 * u - v; });
  NetworkFit fit({2, 6}, 800);
  fit.begin(affine, 600, 200, 1);
  while (fit.busy()) fit.advance();
  double z[2] = {5 + 2 * 0.7, -0.3}, scratch[2];
  CHECK(fit.fitted().output(z, scratch) == Approx(3 + 4 * 0.7 + 0.3).epsilon(1e-7));

  const KnownRows bent(800, [](double u, double v) { return u + 2 * std::tanh(1.5 * u - v); });
  fit.begin(bent, 600, 200, 1);
  int slices = 0;
  std::size_t trips = test::heap_trips();
  while (fit.busy()) {
    fit.advance();
    ++slices;
  }
  CHECK(test::heap_trips() == trips);
  const double sliced = fit.fitted().held_out_square;
  CHECK(sliced < 1e-4);  // of a variance near 3; the affine part alone leaves 0.2
  CHECK(slices > 600 / 4);
  // The same rows, the same bits; all starts at once do as well or better.
  const std::vector<double> once = fit.fitted().parameters;
  fit.begin(bent, 600, 200, 1);
  while (fit.busy()) fit.advance();
  CHECK(fit.fitted().parameters == once);
  fit.begin(bent, 600, 200, 1);
  fit.finish_at_once(2);
  CHECK(fit.fitted().held_out_square < 1e-4);
}

TEST_CASE("simplex, inputs: the mean, differences from it, and its past at the lags") {
  RecentPast past(3, 2);  // lags 1 and 4
  SensorSet set{{1, 0, 1}, 2};
  for (int k = 0; k < 6; ++k) {
    CHECK(past.full() == (k > 4));
    const double y[3] = {1.0 * k, 100, 3.0 * k};
    past.push(y);
  }
  REQUIRE(past.full());
  double raw[9], z[6];
  past.copy_to(raw);
  CHECK(set.fill(raw, z) == 10);
  const double expected[] = {10, -5, 0, 5, 10 - 8, 10 - 2};
  for (int i = 0; i < 6; ++i) CHECK(z[i] == expected[i]);
  const double gap[3] = {std::nan(""), std::nan(""), 7};
  CHECK_FALSE(set.complete(gap));
  past.push(gap);  // a missing sample is held
  past.copy_to(raw);
  CHECK(raw[0] == 5);
  CHECK(raw[2] == 7);
}

TEST_CASE("simplex, decision: each rule by itself takes the lead away, 32 good instants give it back") {
  TaughtNetwork judged(2, 1, {4, 1});  // inputs: mean, two differences, lag 1
  judged.net.affine = {0, 0, 0, 0, 0};
  judged.net.held_out_square = 0.01;
  judged.right = true;
  judged.limits.low = {-2, -1, -1, -9};
  judged.limits.high = {2, 1, 1, 9};
  judged.limits.apart = 0.5;
  judged.limits.reading = {0, 1, 0, 0, 0, 1, 0, 0};  // both read x
  judged.limits.deviation = {0.1, 0.1};
  judged.limits.drift = {2, 2};
  RecentPast past(2, 1);
  const auto sound = [&](double a, double b, BaselineView view) {
    const double y[2] = {a, b};
    past.push(y);
    return judged.judge(past, y, view);
  };
  const auto settle = [&] {
    int needed = 1;
    while (!sound(0.2, 0.2, {0.2, 0.0001})) ++needed;
    return needed;
  };
  sound(0.2, 0.2, {0.2, 0.0001});
  settle();
  CHECK(judged.x() == 0.2);
  CHECK_FALSE(sound(0.2, std::nan(""), {0.2, 0.0001}));
  CHECK(judged.reason() == HandOverReason::missing);
  CHECK(settle() == 32);
  const char out[2] = {0, 1};
  CHECK_FALSE(sound(0.2, 0.2, {0.2, 0.0001, out}));
  CHECK(judged.reason() == HandOverReason::missing);
  settle();
  CHECK_FALSE(sound(2.1, 2.1, {2.1, 0.0001}));
  CHECK(judged.reason() == HandOverReason::outside);
  CHECK(settle() == 32);
  // 0.5 + 4 sqrt(V) = 0.54 from the baseline, and no more.
  CHECK(sound(0.2, 0.2, {0.2 + 0.5399, 0.0001}));
  CHECK_FALSE(sound(0.2, 0.2, {0.2 + 0.5401, 0.0001}));
  CHECK(judged.reason() == HandOverReason::apart);
  settle();
  // Sensor 1 moves by 3 deviations up, sensor 2 down: their mean over 128 instants crosses 2.
  int instants = 0;
  while (sound(0.5, -0.1, {0.2, 0.0001}) && instants < 500) ++instants;
  CHECK(judged.reason() == HandOverReason::inconsistent);
  CHECK(instants == static_cast<int>(std::ceil(std::log(3.0) / -std::log(1 - 1 / 128.0))) - 1);
  CHECK(judged.worst({0, 0}) >= 0);
  CHECK(judged.worst({1, 1}) == -1);
}

TEST_CASE("simplex, past: an input that has a past is smoothed, nearly as a Kalman filter would that knew it") {
  test::Gaussian gauss(5);
  const auto ratio = [&](double keep) {  // x an AR(1) of variance 1, sensors of variance 1: V = 0.5
    PastNetwork past(1);
    double x = 0, before = 0, after = 0;
    for (int k = 0; k < 40000; ++k) {
      x = keep * x + std::sqrt(1 - keep * keep) * gauss();
      const double half[2] = {x + gauss(), x + gauss()}, weight[2] = {0.5, 0.5};
      const double mean = 0.5 * (half[0] + half[1]);
      const bool leads = past.judge(mean, 0.5, half, weight);
      const double given = leads ? past.x() : mean;
      if (k < 20000) continue;
      before += (mean - x) * (mean - x);
      after += (given - x) * (given - x);
    }
    return after / before;
  };
  // Steady state of the Kalman filter: P from P = a^2 P V / (P + V) + q, the share left P / (P + V).
  for (const double keep : {0.99, 0.9, 0.0}) {
    const double v = 0.5, q = 1 - keep * keep;
    double p = 1;
    for (int k = 0; k < 10000; ++k) p = keep * keep * p * v / (p + v) + q;
    const double found = ratio(keep);
    INFO(keep << ": " << found << ", limit " << p / (p + v));
    CHECK(found < (keep > 0.95 ? 1.8 : 1.2) * p / (p + v));
    CHECK(found > 0.95 * p / (p + v));
  }
}

TEST_CASE("simplex, past: sensors that differ by gain or delay do not pass for noise") {
  test::Gaussian gauss(6);
  for (const bool late : {false, true}) {
    PastNetwork past(1);
    double before = 0, after = 0, x = 0, last = 0;
    for (int k = 0; k < 40000; ++k) {
      last = x;
      x = 0.98 * x + 0.2 * gauss();
      const double other = late ? 0.5 * (x + last) : 1.1 * x;
      const double half[2] = {x + 0.01 * gauss(), other + 0.01 * gauss()}, weight[2] = {0.5, 0.5};
      const double mean = 0.5 * (half[0] + half[1]);
      const bool leads = past.judge(mean, 0.5e-4, half, weight);
      before += (mean - x) * (mean - x);
      after += std::pow((leads ? past.x() : mean) - x, 2);
    }
    CHECK(after <= 1.01 * before);
  }
}

TEST_CASE("simplex: where sensors are linear it is its baseline, bit for bit") {
  const SimplexScene scene = simplex_scene(false);
  const auto simplex = test::make("neural-simplex", scene.array, {{"retraining", 0}});
  simplex->learn(scene.y.leftCols(6000), scene.truth.leftCols(6000));
  simplex->finish_learning();
  const SimplexRun run = run_behind_learning(scene, *simplex);
  const auto minque = taught(scene, "minque");
  CHECK(run.hand_overs.empty());
  CHECK(test::same_values(run.x, run_behind_learning(scene, *minque).x));
  Findings said;
  simplex->remarks(said);
  CHECK(said.find("network_not_better") != nullptr);
}

TEST_CASE("simplex: where sensors saturate the network leads and halves the error") {
  const SimplexScene scene = simplex_scene(true);
  const auto simplex = taught(scene), minque = taught(scene, "minque");
  const SimplexRun run = run_behind_learning(scene, *simplex);
  CHECK(run.rms() < 0.5 * run_behind_learning(scene, *minque).rms());
  CHECK(led_by(run, Lead::network));
  Findings said;
  simplex->remarks(said);
  REQUIRE(said.find("network_led") != nullptr);
  // Twice the same: the same bits.
  CHECK(test::same_values(run.x, run_behind_learning(scene, *taught(scene)).x));
}

TEST_CASE("simplex: an input beyond what was learnt is the baseline's") {
  SimplexScene scene = simplex_scene(true);
  for (Eigen::Index k = 9000; k < 12000; ++k) {
    scene.truth(0, k) *= 3;
    for (Eigen::Index i = 0; i < 4; ++i) scene.y(i, k) = scene.truth(0, k) + 0.3 * scene.y(i, k);
  }
  const auto simplex = taught(scene), minque = taught(scene, "minque");
  const SimplexRun run = run_behind_learning(scene, *simplex);
  CHECK(ended_for(run, HandOverReason::outside));
  CHECK(run.rms(3000) <= 1.01 * run_behind_learning(scene, *minque).rms(3000));
}

TEST_CASE("simplex: an input that moves otherwise than what was learnt goes to the baseline, its error is stated") {
  // Slow while it learns, so that the network smooths; ten times as fast, within the same range, behind that.
  test::Gaussian gauss(5);
  SimplexScene scene{Eigen::MatrixXd(4, 26000), Eigen::MatrixXd(1, 26000), test::array(4)};
  scene.array.learning_samples = 6000;
  for (Eigen::Index k = 0; k < 26000; ++k) {
    const double t = static_cast<double>(k) * (k < 6000 ? 1 : 10);
    scene.truth(0, k) = 0.8 * std::sin(0.011 * t) + 0.4 * std::sin(0.0271 * t + 1);
    for (Eigen::Index i = 0; i < 4; ++i) scene.y(i, k) = scene.truth(0, k) + 0.2 * gauss();
  }
  const auto simplex = taught(scene), minque = taught(scene, "minque");
  Eigen::MatrixXd x(1, 20000), variance(1, 20000);
  simplex->run(scene.y.rightCols(20000), x, variance);
  const Eigen::ArrayXd error = (x - scene.truth.rightCols(20000)).row(0).transpose().array();
  const double baseline = run_behind_learning(scene, *minque).rms(2000);
  CHECK(std::sqrt(error.tail(18000).square().mean()) <= 1.02 * baseline);
  const Eigen::ArrayXd sd = variance.row(0).transpose().array().sqrt();
  CHECK((error.abs() <= 1.96 * sd).tail(18000).cast<double>().mean() > 0.92);
}

TEST_CASE("simplex: a sensor that fails hands over at once, the network learns again without it") {
  SimplexScene scene = simplex_scene(true, 60000, 6000);
  for (Eigen::Index k = 16000; k < 60000; ++k) scene.y(1, k) = 0.9;  // stuck
  const auto simplex = taught(scene), minque = taught(scene, "minque");
  std::size_t before = test::heap_trips();
  const SimplexRun base = run_behind_learning(scene, *minque);
  const std::size_t of_baseline = test::heap_trips() - before;
  before = test::heap_trips();
  const SimplexRun run = run_behind_learning(scene, *simplex);
  CHECK(test::heap_trips() - before <= of_baseline + 1);  // one for the hand-overs that are returned here
  const auto at_failure =
      std::find_if(run.hand_overs.begin(), run.hand_overs.end(), [](const HandOver& h) { return h.sample >= 10000; });
  REQUIRE(at_failure != run.hand_overs.end());
  CHECK(at_failure->sample <= 10005);
  CHECK(at_failure->to == Lead::baseline);
  CHECK(led_by(run, Lead::retrained));
  CHECK(run.rms() < base.rms());
  CHECK(run.rms(20000) < 0.6 * base.rms(20000));  // long after the failure
}
