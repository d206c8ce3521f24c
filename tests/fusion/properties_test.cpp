// What must hold for every registered algorithm, whatever it does.

#include <catch2/catch.hpp>
#include <set>

#include "libchar/fusion/why_not.hpp"
#include "tests/fusion/heap_counter.hpp"
#include "tests/fusion/scenes.hpp"
#include "tests/fusion/vectors.hpp"
#include "tests/support/noise.hpp"

using namespace libchar::fusion;

namespace {

struct LearnedScene {
  Array array;
  Eigen::MatrixXd learning_y, learning_truth;  // learning window
  Eigen::MatrixXd y, truth;                    // run
};

constexpr Eigen::Index kInstants = 1500;

/// Channels of these noise deviations on one moving input.
LearnedScene scene_of(const Eigen::VectorXd& deviations, double offset = 0, std::uint64_t seed = 5) {
  test::Gaussian gauss(seed);
  const Eigen::Index n = deviations.size();
  const auto record = [&](Eigen::MatrixXd& y, Eigen::MatrixXd& truth, Eigen::Index instants) {
    y.resize(n, instants);
    truth.resize(1, instants);
    for (Eigen::Index k = 0; k < instants; ++k) {
      truth(0, k) = offset + 2 * std::sin(0.05 * static_cast<double>(k)) + 0.5 * gauss();
      for (Eigen::Index i = 0; i < n; ++i) y(i, k) = truth(0, k) + deviations[i] * gauss();
    }
  };
  LearnedScene scene;
  record(scene.learning_y, scene.learning_truth, 600);
  record(scene.y, scene.truth, kInstants);
  scene.array.channels = n;
  scene.array.noise_levels = deviations.cwiseAbs2();
  if (n <= 10) scene.array.noise_models = test::drifting(scene.array.noise_levels);
  scene.array.rate_hz = 100;
  scene.array.learning_samples = 600;
  scene.array.fault_free_samples = 500;
  scene.array.reference_throughout = true;
  scene.array.section_starts = {700};
  return scene;
}

LearnedScene scene_of(Eigen::Index n) { return scene_of(Eigen::VectorXd::LinSpaced(n, 0.1, 0.3)); }

std::unique_ptr<Runner> trained(const Entry& entry, const LearnedScene& scene) {
  auto runner = entry.make(scene.array, Settings(entry.options));
  const Needs& needs = entry.description->needs;
  if (needs.reference || needs.reference_helps) runner->learn(scene.learning_y, scene.learning_truth);
  if (entry.description->needs.reference_throughout) runner->learn(scene.y, scene.truth);
  runner->finish_learning();
  return runner;
}

test::Run run_of(const Entry& entry, const LearnedScene& scene, Eigen::Index block = kInstants) {
  return test::run(*trained(entry, scene), scene.y, scene.array.inputs(), block);
}

/// Every algorithm that these scenes have the data for.
template <class Check>
void for_each(const LearnedScene& scene, Check check) {
  int ran = 0;
  for (const Entry& entry : algorithms()) {
    if (!why_not(*entry.description, scene.array).empty()) continue;
    INFO(entry.description->name);
    check(entry);
    ++ran;
  }
  CHECK(ran > 0);
}

bool named(const Entry& entry, const std::set<std::string_view>& names) {
  return names.contains(entry.description->name);
}

/// Their equations are not those of a mean: free or calibrated weights do not sum to one. Reasons:
/// docs/theory/fusion.md.
const std::set<std::string_view> kFreeWeights{"least-squares-published", "blind-calibration",
                                              "blind-calibration-published", "blind-gls"};
/// Their estimates may move by something else than the input does.
const std::set<std::string_view> kNotShifted{"least-squares-published", "blind-calibration-published",
                                             "random-weighting-published", "kalman-takens-published"};

double apart(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return (a - b).cwiseAbs().maxCoeff(); }

bool sane_variance(const Eigen::MatrixXd& variance) {
  for (const double v : variance.reshaped())
    if (v < 0 || std::isinf(v)) return false;
  return true;
}

}  // namespace

TEST_CASE("blocks of any size give the same bits") {
  LearnedScene scene = scene_of(6);
  scene.y.row(2).segment(900, 200).array() += 3;  // a fault, so that the sets change on the way
  for_each(scene, [&](const Entry& entry) {
    const test::Run whole = run_of(entry, scene);
    for (const Eigen::Index block : {1, 7, 64, 1499}) CHECK(test::same_values(run_of(entry, scene, block).x, whole.x));
  });
}

TEST_CASE("an input moved by 10, 1e4 or 1e8 moves the estimate alike") {
  const LearnedScene plain = scene_of(6);
  for (const double offset : {10.0, 1e4, 1e8}) {
    const LearnedScene moved = scene_of(Eigen::VectorXd::LinSpaced(6, 0.1, 0.3), offset);
    for_each(plain, [&](const Entry& entry) {
      if (named(entry, kNotShifted)) return;
      INFO(offset);
      // The samples themselves are rounded at the offset, 1.5e-8 at 1e8.
      // Training amplifies that a little.
      const double amplified = named(entry, {"perceptron"}) ? 30 : 1;
      const double tolerance = 1e-9 + amplified * 30 * offset * 2.2e-16;
      CHECK(apart(run_of(entry, moved).x.array() - offset, run_of(entry, plain).x) < tolerance);
    });
  }
}

TEST_CASE("units: everything scaled, the estimate scales") {
  const LearnedScene plain = scene_of(6);
  for (const double factor : {0x1p-60, 0x1p40}) {
    LearnedScene scaled = plain;
    scaled.y *= factor;
    scaled.truth *= factor;
    scaled.learning_y *= factor;
    scaled.learning_truth *= factor;
    test::scale_levels(scaled.array, factor);
    for_each(plain, [&](const Entry& entry) {
      // Its Q is a number in the units of the input, not an estimate.
      if (named(entry, {"kalman-takens-published"})) return;
      CHECK(apart(run_of(entry, scaled).x / factor, run_of(entry, plain).x) < 1e-11);
    });
  }
}

TEST_CASE("the order of the channels does not matter") {
  const LearnedScene plain = scene_of(6);
  // Channels 1 and 2 stay: the published forms take them for reference.
  Eigen::PermutationMatrix<Eigen::Dynamic> order(6);
  order.indices() << 0, 1, 5, 3, 2, 4;
  LearnedScene mixed = plain;
  mixed.y = order * plain.y;
  mixed.learning_y = order * plain.learning_y;
  mixed.array.noise_levels = order * plain.array.noise_levels;
  for (std::size_t i = 0; i < 6; ++i)
    mixed.array.noise_models[static_cast<std::size_t>(order.indices()[static_cast<int>(i)])] =
        plain.array.noise_models[i];
  for_each(plain, [&](const Entry& entry) {
    // Its training starts from random weights, drawn channel by channel.
    if (named(entry, {"perceptron"})) return;
    // The published weights divide by sums that may be near zero.
    const double tolerance = named(entry, {"random-weighting-published"}) ? 1e-3 : 1e-9;
    CHECK(apart(run_of(entry, mixed).x, run_of(entry, plain).x) < tolerance);
  });
}

TEST_CASE("weights sum to one, variances are never negative") {
  for (const Eigen::Index n : {2, 3, 6, 200}) {
    const LearnedScene scene = scene_of(n);
    for_each(scene, [&](const Entry& entry) {
      INFO(n);
      auto runner = trained(entry, scene);
      const test::Run out = test::run(*runner, scene.y);
      CHECK(out.x.allFinite());
      CHECK(sane_variance(out.variance));
      if (const auto weights = runner->weights(); weights && !named(entry, kFreeWeights))
        CHECK(weights->sum() == Approx(1).margin(1e-12));
      if (entry.description->name.find("published") == std::string_view::npos) {
        if (const auto variances = runner->variances()) CHECK(variances->minCoeff() > 0);
        // No worse than the worst channel by far: nothing is amplified.
        CHECK(apart(out.x, scene.truth) < 1.5);
      }
    });
  }
}

TEST_CASE("identical, constant and dead channels") {
  const LearnedScene plain = scene_of(6);
  for (const std::string what : {"identical", "two identical", "constant", "one dead", "half dead", "all zero"}) {
    INFO(what);
    LearnedScene scene = plain;
    const auto spoil = [&](Eigen::MatrixXd& y) {
      if (what == "identical") y = y.row(0).replicate(6, 1).eval();
      if (what == "two identical") y.row(1) = y.row(0);
      if (what == "constant") y.setConstant(3.25);
      if (what == "one dead") y.row(4).setZero();
      if (what == "half dead") y.bottomRows(3).setZero();
      if (what == "all zero") y.setZero();
    };
    spoil(scene.y);
    for_each(scene, [&](const Entry& entry) {
      auto runner = trained(entry, scene);
      const test::Run out = test::run(*runner, scene.y);
      CHECK(out.x.allFinite());
      CHECK(sane_variance(out.variance));
      if (!named(entry, kFreeWeights) && !named(entry, kNotShifted)) {
        // Channels that agree are believed, unless what was learnt says otherwise.
        if ((what == "identical" || what == "constant" || what == "all zero") && !entry.description->needs.reference &&
            !named(entry, {"kalman-takens"}))
          CHECK(apart(out.x, scene.y.row(0)) < 1e-12);
      }
    });
  }
}

TEST_CASE("minque finds three dead channels of six only as far as the others can say so") {
  LearnedScene scene = scene_of(6);
  scene.y.row(4).tail(700).setZero();
  auto minque = test::make("minque", scene.array);
  test::run(*minque, scene.y);
  REQUIRE(minque->faults()->events().size() >= 1);
  CHECK(minque->faults()->events()[0].channel == 4);
}

TEST_CASE("noise of very different size") {
  for (const double ratio : {1e3, 1e6, 1e12}) {
    Eigen::VectorXd deviations(6);
    deviations << 1, 1.5, 2, 0.1 * ratio, 0.3 * ratio, ratio;
    const LearnedScene scene = scene_of(deviations);
    for_each(scene, [&](const Entry& entry) {
      INFO(ratio);
      auto runner = trained(entry, scene);
      const test::Run out = test::run(*runner, scene.y);
      CHECK(out.x.allFinite());
      CHECK(sane_variance(out.variance));
      if (named(entry, {"inverse-variance", "optimal-weights"})) CHECK(apart(out.x, scene.truth) < 8);
      // Without a word on the noise: the three good channels carry the weight after the first hundred instants.
      if (named(entry, {"minque"})) CHECK(apart(out.x.rightCols(1000), scene.truth.rightCols(1000)) < 10);
    });
  }
}

TEST_CASE("missing samples") {
  const double gap = std::nan("");
  LearnedScene scene = scene_of(6);
  const LearnedScene whole = scene;
  scene.y(2, 100) = gap;
  scene.y.block(0, 300, 3, 40).setConstant(gap);
  scene.y.col(500).setConstant(gap);
  scene.y.row(5).segment(800, 300).setConstant(gap);
  scene.y(1, 1200) = std::numeric_limits<double>::infinity();
  scene.y(1, 1300) = -1e200;
  scene.y.block(0, 1400, 5, 1).setConstant(gap);
  for_each(scene, [&](const Entry& entry) {
    const test::Run out = run_of(entry, scene);
    const auto has = [&](Eigen::Index k) { return std::isfinite(out.x(0, k)); };
    // Kalman-Takens predicts an instant without any sample.
    CHECK(has(500) == named(entry, {"kalman-takens", "kalman-takens-taught"}));
    int lost = 0;
    for (Eigen::Index k = 0; k < kInstants; ++k) {
      const bool all = scene.y.col(k).cwiseAbs().maxCoeff<Eigen::PropagateNaN>() < 1e100;
      if (all && !has(k) && ++lost == 1) FAIL_CHECK("no estimate at " << k);
      if (!all && k != 500 && entry.description->needs.accepts_missing && !has(k))
        FAIL_CHECK("no estimate at gap " << k);
      if (!all && !entry.description->needs.accepts_missing && has(k))
        FAIL_CHECK("an estimate without samples at " << k);
    }
    if (entry.description->name.find("published") == std::string_view::npos)
      for (const Eigen::Index k : {310, 900, 1499})
        if (has(k)) CHECK(std::abs(out.x(0, k) - whole.truth(0, k)) < 1.5);
  });
}

TEST_CASE("minque: no negative variance and no NaN for any memory") {
  for (const double gamma : {0.9, 0.95, 0.98, 0.99, 0.999, 0.9999})
    for (const double damping : {0.0, 10.0})
      for (const double offset : {0.0, 1e8}) {
        Eigen::VectorXd unequal(5), two(5), three(3);
        unequal << 10, 4.47, 3.16, 1.41, 1;
        two << 1, 1, 100, 100, 100;
        three << 1, 2, 3;
        for (const Eigen::VectorXd& deviations : {unequal, two, three}) {
          INFO(gamma << " " << damping << " " << offset << " " << deviations.transpose());
          const LearnedScene scene = scene_of(deviations, offset);
          auto minque = test::make("minque", test::array(deviations.size()), {{"gamma", gamma}, {"damping", damping}});
          bool good = true;
          for (Eigen::Index k = 0; k < kInstants; ++k) {
            const test::Run out = test::run(*minque, scene.y.col(k));
            good = good && out.x.allFinite() && sane_variance(out.variance) && minque->variances()->minCoeff() > 0 &&
                   minque->variances()->allFinite();
          }
          CHECK(good);
        }
      }
}

TEST_CASE("step makes no trip to the heap") {
  if (!test::kHeapCounted) {
    WARN("SKIPPED: a sanitizer has its own heap, which is not counted");
    return;
  }
  LearnedScene scene = scene_of(6);
  scene.y.row(2).segment(900, 200).array() += 3;
  scene.y(3, 1000) = std::nan("");
  LearnedScene two = scene;
  two.array.observation_matrix = (Eigen::MatrixXd(6, 2) << 1, .1, 1, .2, 1, -.3, 1, .4, 1, -.5, 1, .6).finished();
  for (Eigen::MatrixXd* truth : {&two.truth, &two.learning_truth})
    truth->conservativeResizeLike(Eigen::MatrixXd::Zero(2, truth->cols()));
  for (const LearnedScene* fed : {&scene, &two})
    for_each(*fed, [&](const Entry& entry) {
      if (entry.description->needs.reference_throughout && fed == &two) return;
      auto runner = trained(entry, *fed);
      Eigen::MatrixXd x(fed->array.inputs(), kInstants), variance(fed->array.inputs(), kInstants);
      const std::size_t before = test::heap_trips();
      runner->run(fed->y, x, variance);
      const std::size_t trips = test::heap_trips() - before;
      CHECK(trips == 0);
    });
}
