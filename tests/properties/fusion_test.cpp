// What holds for fusion algorithms on any array.

#include <catch2/catch.hpp>
#include <set>

#include "libchar/fusion/algorithms/least_squares.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/fusion/runner.hpp"
#include "libchar/fusion/why_not.hpp"
#include "libchar/simulate/random.hpp"
#include "tests/fusion/vectors.hpp"
#include "tests/properties/generate.hpp"

using namespace libchar;
using namespace libchar::fusion;
using namespace props;

namespace {

struct Case {
  Array array;
  Eigen::MatrixXd y;
};

/// Channels of any noise on a wandering input, on a grid of 2^-20.
Case any_case(int least = 3, Eigen::Index instants = 60) {
  Case out;
  const int n = *rc::gen::inRange(least, 7);
  out.array.channels = n;
  out.array.noise_levels.resize(n);
  for (double& v : out.array.noise_levels) v = *between(0.01, 4);
  out.array.rate_hz = 100;
  DeviateStream noise({*rc::gen::arbitrary<std::uint64_t>(), 0, Purpose::white});
  out.y.resize(n, instants);
  double x = 0;
  for (Eigen::Index k = 0; k < instants; ++k) {
    x += noise.normal();
    for (Eigen::Index i = 0; i < n; ++i)
      out.y(i, k) =
          std::ldexp(std::round(std::ldexp(x + std::sqrt(out.array.noise_levels[i]) * noise.normal(), 20)), -20);
  }
  return out;
}

const fusion::Entry& any_of(const std::vector<std::string>& names) { return algorithm(*rc::gen::elementOf(names)); }

/// Means whose weights are never negative.
const std::vector<std::string> kMeans = {"mean",   "median",          "inverse-variance", "covariance-intersection",
                                         "minque", "random-weighting"};
/// These and what calibrates or follows the past, without a reference.
const std::vector<std::string> kBlind = {"mean",   "median",           "inverse-variance",  "covariance-intersection",
                                         "minque", "random-weighting", "blind-calibration", "kalman-takens"};

::test::Run run_of(const fusion::Entry& entry, const Case& c, Eigen::Index block = 1 << 20) {
  const auto runner = entry.make(c.array, Settings(entry.options));
  runner->finish_learning();
  return ::test::run(*runner, c.y, c.array.inputs(), block);
}

Case moved(Case c, double by) {
  c.y.array() += by;
  return c;
}
Case in_unit(Case c, int power) {
  c.y *= std::ldexp(1.0, power);
  c.array.noise_levels *= std::ldexp(1.0, 2 * power);
  return c;
}
Case turned_round(Case c) {
  c.y = c.y.colwise().reverse().eval();
  c.array.noise_levels.reverseInPlace();
  return c;
}

double largest_gap(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) { return (a - b).cwiseAbs().maxCoeff(); }

void sprinkle_gaps(Case& c, int rarity) {
  for (double& v : c.y.reshaped())
    if (*rc::gen::inRange(0, rarity) == 0) v = std::nan("");
}

}  // namespace

TEST_CASE("property: a mean lies between the samples of its instant") {
  holds([] {
    const Case c = any_case();
    const ::test::Run out = run_of(any_of(kMeans), c);
    for (Eigen::Index k = 0; k < c.y.cols(); ++k) {
      RC_ASSERT(out.x(0, k) >= c.y.col(k).minCoeff() - 1e-12);
      RC_ASSERT(out.x(0, k) <= c.y.col(k).maxCoeff() + 1e-12);
    }
  });
}
TEST_CASE("property: weights of a mean are not negative and sum to one") {
  holds([] {
    const Case c = any_case();
    const fusion::Entry& entry = any_of(kMeans);
    const auto runner = entry.make(c.array, Settings(entry.options));
    runner->finish_learning();
    ::test::run(*runner, c.y);
    const auto weights = runner->weights();
    if (!weights) return;
    RC_ASSERT(weights->minCoeff() >= 0);
    RC_ASSERT(std::abs(weights->sum() - 1) < 1e-14 * static_cast<double>(c.array.channels));
  });
}
TEST_CASE("property: an input moved by 2^20 moves the estimate alike") {
  holds([] {
    const Case c = any_case();
    const fusion::Entry& entry = any_of(kBlind);
    RC_ASSERT(largest_gap(run_of(entry, moved(c, 0x1p20)).x.array() - 0x1p20, run_of(entry, c).x) < 1e-8);
  });
}
TEST_CASE("property: another unit is another unit of the estimate") {
  holds([] {
    const Case c = any_case();
    const fusion::Entry& entry = any_of(kBlind);
    const int power = *rc::gen::inRange(-100, 100);
    const Eigen::MatrixXd plain = run_of(entry, c).x;
    RC_ASSERT(largest_gap(run_of(entry, in_unit(c, power)).x * std::ldexp(1.0, -power), plain) <=
              1e-9 * (1 + plain.cwiseAbs().maxCoeff()));
  });
}
TEST_CASE("property: the order of the channels is none of a mean's business") {
  holds([] {
    const Case c = any_case();
    const fusion::Entry& entry = any_of(kMeans);
    RC_ASSERT(largest_gap(run_of(entry, turned_round(c)).x, run_of(entry, c).x) < 1e-9);
  });
}
TEST_CASE("property: blocks of any size give the same bits, missing samples or not") {
  holds([] {
    Case c = any_case();
    sprinkle_gaps(c, *rc::gen::element(5, 50));
    const fusion::Entry& entry = any_of(kBlind);
    RC_ASSERT(::test::same_values(run_of(entry, c, *rc::gen::inRange(1, 40)).x, run_of(entry, c).x));
  });
}
TEST_CASE("property: a variance is not negative, and no estimate has none") {
  holds([] {
    Case c = any_case();
    sprinkle_gaps(c, *rc::gen::element(2, 10));
    const ::test::Run out = run_of(any_of(kBlind), c);
    for (Eigen::Index k = 0; k < out.x.cols(); ++k) {
      RC_ASSERT(!(out.variance(0, k) < 0));
      RC_ASSERT(!std::isinf(out.variance(0, k)));
      RC_ASSERT(!std::isinf(out.x(0, k)));
    }
  });
}
TEST_CASE("property: a mean has an estimate wherever one sample is") {
  holds([] {
    Case c = any_case();
    sprinkle_gaps(c, 2);
    const ::test::Run out = run_of(algorithm(*rc::gen::element<std::string>("mean", "median", "inverse-variance")), c);
    for (Eigen::Index k = 0; k < out.x.cols(); ++k)
      RC_ASSERT(std::isnan(out.x(0, k)) == !(c.y.col(k).array() == c.y.col(k).array()).any());
  });
}
TEST_CASE("property: fused variance is no larger than the best sensor's") {
  holds([] {
    const Case c = any_case(1);
    const ::test::Run out = run_of(algorithm("inverse-variance"), c);
    RC_ASSERT(out.variance.maxCoeff() <= c.array.noise_levels.minCoeff() * (1 + 1e-14));
    RC_ASSERT(std::abs(1 / out.variance(0, 0) - c.array.noise_levels.cwiseInverse().sum()) < 1e-9 / out.variance(0, 0));
  });
}
TEST_CASE("property: all noise levels times a constant leave the estimate") {
  holds([] {
    Case c = any_case();
    const fusion::Entry& entry =
        algorithm(*rc::gen::element<std::string>("inverse-variance", "covariance-intersection"));
    const Eigen::MatrixXd before = run_of(entry, c).x;
    c.array.noise_levels *= *between(0.1, 10);
    RC_ASSERT(largest_gap(run_of(entry, c).x, before) < 1e-10);
  });
}
TEST_CASE("property: a sensor of deviation 1e150 changes nothing") {
  holds([] {
    const Case c = any_case();
    Case more = c;
    more.array.channels += 1;
    more.array.noise_levels.conservativeResize(more.array.channels);
    more.array.noise_levels.tail(1).setConstant(1e300);
    more.y.conservativeResize(more.array.channels, Eigen::NoChange);
    more.y.bottomRows(1).setConstant(*between(-1e6, 1e6));
    RC_ASSERT(largest_gap(run_of(algorithm("inverse-variance"), more).x, run_of(algorithm("inverse-variance"), c).x) <
              1e-12);
  });
}
TEST_CASE("property: a sensor twice is that sensor once with half the variance") {
  holds([] {
    Case once = any_case();
    Case twice = once;
    once.array.noise_levels[0] /= 2;
    twice.array.channels += 1;
    twice.array.noise_levels.conservativeResize(twice.array.channels);
    twice.array.noise_levels.tail(1) = twice.array.noise_levels.head(1);
    twice.y.conservativeResize(twice.array.channels, Eigen::NoChange);
    twice.y.bottomRows(1) = twice.y.topRows(1).eval();
    const ::test::Run a = run_of(algorithm("inverse-variance"), once), b = run_of(algorithm("inverse-variance"), twice);
    RC_ASSERT(largest_gap(a.x, b.x) < 1e-10);
    RC_ASSERT(std::abs(a.variance(0, 0) / b.variance(0, 0) - 1) < 1e-12);
  });
}
TEST_CASE("property: what all inputs add is added to their estimates") {
  holds([] {
    Case c = any_case(5);
    const Eigen::Index n = c.array.channels;
    c.array.observation_matrix = Eigen::MatrixXd::Ones(n, 2);
    for (Eigen::Index i = 0; i < n; ++i) c.array.observation_matrix(i, 1) = static_cast<double>(i) + *between(0, 0.5);
    const Eigen::Vector2d b(*between(-5, 5), *between(-5, 5));
    Case added = c;
    added.y.colwise() += c.array.observation_matrix * b;
    const fusion::Entry& entry = algorithm(*rc::gen::element<std::string>("mean", "inverse-variance"));
    const Eigen::MatrixXd expected = run_of(entry, c).x.colwise() + b;
    RC_ASSERT(largest_gap(run_of(entry, added).x, expected) < 1e-8);
  });
}
TEST_CASE("property: learnt weights do not depend on the order of the instants") {
  holds([] {
    const Case c = any_case();
    DeviateStream truth({1, 1, Purpose::truth});
    Record x(static_cast<std::size_t>(c.y.cols()));
    for (std::size_t k = 0; k < x.size(); ++k)
      x[k] = c.y.col(static_cast<Eigen::Index>(k)).mean() + 0.1 * truth.normal();
    const auto weights = [&](bool backwards) {
      WeightLearner learner(c.array.channels);
      for (Eigen::Index k = 0; k < c.y.cols(); ++k) {
        const Eigen::Index at = backwards ? c.y.cols() - 1 - k : k;
        learner.add(Sample(c.y.data() + at * c.y.rows(), c.y.rows()), x[static_cast<std::size_t>(at)]);
      }
      LeastSquaresForm form;
      return learner.weights(form).weights;
    };
    const Eigen::VectorXd a = weights(false), b = weights(true);
    RC_ASSERT(largest_gap(a, b) < 1e-9 * (1 + a.cwiseAbs().maxCoeff()));
    RC_ASSERT(std::abs(a.sum() - 1) < 1e-12 * (1 + a.cwiseAbs().sum()));
  });
}
TEST_CASE("property: who cannot run on an array says so in a sentence, who can runs") {
  holds([] {
    const Case c = any_case(1, 5);
    const auto all = algorithms();
    const fusion::Entry& entry = all[static_cast<std::size_t>(*rc::gen::inRange(0, static_cast<int>(all.size())))];
    const std::string why = why_not(*entry.description, c.array);
    if (!why.empty()) {
      RC_ASSERT(why.find(' ') != std::string::npos && why.find(entry.description->name) != 0);  // its label has it
      return;
    }
    RC_ASSERT(run_of(entry, c).x.cols() == 5);
  });
}
