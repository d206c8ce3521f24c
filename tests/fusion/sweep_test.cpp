// Promises that hold for every algorithm of the registry on every scene.

#include <catch2/catch.hpp>
#include <cstring>
#include <optional>
#include <set>

#include "libchar/core/error.hpp"
#include "libchar/fusion/why_not.hpp"
#include "tests/fusion/scenes.hpp"
#include "tests/fusion/vectors.hpp"

using namespace libchar;
using namespace libchar::fusion;

namespace {

using Names = std::set<std::string_view>;

std::vector<test::FusionScene> scenes() {
  auto all = test::fusion_scenes();
  all.push_back(test::tilt_scene());
  all.push_back(test::lever_scene());
  const test::FusionScene tilt = test::tilt_scene();
  all.push_back(test::hurt(tilt, "tilt with gaps", [](Eigen::MatrixXd& y) {
    y.row(1).segment(100, 50).setConstant(std::nan(""));
    y.row(0).segment(200, 50).setConstant(std::nan(""));
    y.middleCols(300, 50).setConstant(std::nan(""));
  }));
  return all;
}

/// Ready to run; nothing when the algorithm says in a sentence that it cannot.
std::unique_ptr<Runner> ready(const Entry& entry, const test::FusionScene& scene) {
  if (!why_not(*entry.description, scene.array).empty()) return nullptr;
  try {
    auto runner = entry.make(scene.array, Settings(entry.options));
    if (entry.description->needs.reference || entry.description->needs.reference_throughout ||
        entry.description->needs.reference_helps) {
      runner->learn(scene.y, scene.truth);
      runner->finish_learning();
    }
    return runner;
  } catch (const Error& error) {
    CHECK_FALSE(error.problem().what.empty());
    return nullptr;
  }
}

std::optional<test::Run> run_sweep(const Entry& entry, const test::FusionScene& scene, Eigen::Index block = 1 << 30) {
  const auto runner = ready(entry, scene);
  if (!runner) return std::nullopt;
  return test::run(*runner, scene.y, scene.array.inputs(), block);
}

bool same_bits(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.size() == b.size() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

/// Largest distance of two runs, after the first instants, relative to `scale`.
double apart(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b, double scale) {
  return (a - b).cwiseAbs().maxCoeff() / scale;
}

}  // namespace

TEST_CASE("every algorithm x every scene: estimates are finite where samples are, variances >= 0") {
  for (const test::FusionScene& scene : scenes())
    for (const Entry& entry : algorithms()) {
      const auto runner = ready(entry, scene);
      if (!runner) continue;
      INFO(entry.description->name << " on " << scene.name);
      const test::Run out = test::run(*runner, scene.y, scene.array.inputs());
      Eigen::Index missing = 0, infinite = 0, negative = 0;
      for (Eigen::Index k = 0; k < out.x.cols(); ++k) {
        const bool complete = (scene.y.col(k).array().abs() < 1e99).all();
        if (complete && !out.x.col(k).allFinite()) ++missing;
        if ((out.x.col(k).array().abs() == std::numeric_limits<double>::infinity()).any()) ++infinite;
        if ((out.variance.col(k).array() < 0).any()) ++negative;
      }
      CHECK(missing == 0);
      CHECK(infinite == 0);
      // The published Kalman-Takens and random weighting may believe anything.
      if (entry.description->name.find("published") == std::string_view::npos) {
        CHECK(negative == 0);
        if (const auto v = runner->variances()) CHECK((v->array() >= 0).all());
      }
    }
}

TEST_CASE("every set of weights sums to one where the method promises it") {
  // Free weights shrink, inverse gains are no weights; the published form says what it says.
  const Names free{"least-squares-published", "blind-calibration", "blind-calibration-published", "blind-gls"};
  for (const test::FusionScene& scene : scenes())
    for (const Entry& entry : algorithms()) {
      const auto runner = ready(entry, scene);
      if (!runner || free.contains(entry.description->name)) continue;
      test::run(*runner, scene.y, scene.array.inputs());
      const auto weights = runner->weights();
      if (!weights) continue;
      // No sample ever came: nobody has earned a weight (minque-published says zero).
      if (!scene.y.array().isFinite().any()) continue;
      INFO(entry.description->name << " on " << scene.name);
      REQUIRE(weights->rows() == scene.y.rows());
      REQUIRE(weights->allFinite());
      // sum w h = identity: unbiased. For one input that is sum w = 1.
      const Eigen::MatrixXd unity = weights->transpose() * scene.array.h();
      const double size = weights->cwiseAbs().colwise().sum().maxCoeff() * scene.array.h().cwiseAbs().maxCoeff() *
                          static_cast<double>(scene.y.rows());
      CHECK((unity - Eigen::MatrixXd::Identity(unity.rows(), unity.cols())).cwiseAbs().maxCoeff() <=
            8 * std::numeric_limits<double>::epsilon() * std::max(1.0, size));
    }
}

TEST_CASE("every algorithm x every scene: blocks of any size give the same bits") {
  for (const test::FusionScene& scene : scenes())
    for (const Entry& entry : algorithms()) {
      if (entry.description->name == "perceptron" && !scene.benign) continue;  // learns long, see below
      const auto whole = run_sweep(entry, scene);
      if (!whole) continue;
      for (const Eigen::Index block : {1, 7, 64}) {
        INFO(entry.description->name << " on " << scene.name << ", blocks of " << block);
        const auto parts = run_sweep(entry, scene, block);
        REQUIRE(parts);
        CHECK(same_bits(whole->x, parts->x));
        CHECK(same_bits(whole->variance, parts->variance));
      }
      // A later block must not look at an earlier column or beyond its own: strided memory.
    }
}

TEST_CASE("benign scenes: a shift of the input shifts the estimates") {
  // Free weights shrink towards zero; the published random weighting needs an input of mean zero; a
  // calibration that is blind to the offset takes the mean for it, which shifts alike.
  const Names unlike{"least-squares-published", "random-weighting-published", "blind-calibration",
                     "blind-calibration-published", "kalman-takens-published"};
  for (const test::FusionScene& scene : test::fusion_scenes()) {
    if (!scene.benign) continue;
    for (const double shift : {1.0, -1024.0, 1048576.0}) {
      test::FusionScene moved = scene;
      moved.y.array() += shift;
      moved.truth.array() += shift;
      for (const Entry& entry : algorithms()) {
        if (unlike.contains(entry.description->name)) continue;
        const auto a = run_sweep(entry, scene), b = run_sweep(entry, moved);
        REQUIRE(a.has_value() == b.has_value());
        if (!a) continue;
        INFO(entry.description->name << " on " << scene.name << ", shift " << shift);
        // The shifted samples themselves are rounded to 2^-33; a network's training turns that into a little more.
        const double tolerance = entry.description->name == "perceptron" ? 1e-4 : 1e-7;
        CHECK(apart(b->x.array() - shift, a->x, 1) < tolerance);
      }
    }
  }
}

TEST_CASE("benign scenes: a change of unit changes the estimates alike") {
  const Names unlike{"kalman-takens-published"};  // its Q is in units of the input
  for (const test::FusionScene& scene : test::fusion_scenes()) {
    if (!scene.benign) continue;
    for (const int power : {-30, 5, 40}) {
      const double factor = std::ldexp(1.0, power);
      test::FusionScene scaled = scene;
      scaled.y *= factor;
      scaled.truth *= factor;
      scaled.array.noise_levels *= factor * factor;
      for (const Entry& entry : algorithms()) {
        if (unlike.contains(entry.description->name)) continue;
        const auto a = run_sweep(entry, scene), b = run_sweep(entry, scaled);
        REQUIRE(a.has_value() == b.has_value());
        if (!a) continue;
        INFO(entry.description->name << " on " << scene.name << ", times 2^" << power);
        CHECK(apart(b->x / factor, a->x, 1) < 1e-10);
      }
    }
  }
}

TEST_CASE("benign scenes: the order of the channels does not matter") {
  // Of these one channel is the reference, or random starts belong to places.
  const Names unlike{"random-weighting-published", "blind-calibration-published", "blind-gls", "perceptron"};
  for (const test::FusionScene& scene : test::fusion_scenes()) {
    if (!scene.benign) continue;
    test::FusionScene turned = scene;
    turned.y = scene.y.colwise().reverse();
    turned.array.noise_levels = scene.array.noise_levels.reverse();
    std::reverse(turned.array.noise_models.begin(), turned.array.noise_models.end());
    for (const Entry& entry : algorithms()) {
      if (unlike.contains(entry.description->name)) continue;
      const auto a = run_sweep(entry, scene), b = run_sweep(entry, turned);
      REQUIRE(a.has_value() == b.has_value());
      if (!a) continue;
      INFO(entry.description->name << " on " << scene.name);
      CHECK(apart(b->x, a->x, 1) < 1e-9);
    }
  }
}

TEST_CASE("a missing sample is not a value: what stands in its place does not matter") {
  // NaN or infinite, quiet or negative: same bits.
  for (const test::FusionScene& scene : test::fusion_scenes()) {
    if (scene.name != "random NaN") continue;
    test::FusionScene other = scene;
    for (Eigen::Index i = 0; i < other.y.size(); ++i)
      if (std::isnan(other.y.data()[i])) other.y.data()[i] = -std::nan("7");
    for (const Entry& entry : algorithms()) {
      const auto a = run_sweep(entry, scene), b = run_sweep(entry, other);
      REQUIRE(a.has_value() == b.has_value());
      if (!a) continue;
      INFO(entry.description->name);
      for (Eigen::Index k = 0; k < a->x.cols(); ++k)
        if (!std::isnan(a->x(0, k))) REQUIRE(a->x(0, k) == b->x(0, k));
    }
  }
}

TEST_CASE("minque: no variance is negative or lost, any memory, n >= 3, offsets to 1e8") {
  for (const Eigen::Index n : {3, 4, 6, 20})
    for (const double gamma : {0.9, 0.93, 0.98, 0.99, 0.999, 0.99999})
      for (const double offset : {0.0, 1e4, 1e8}) {
        const auto scene = test::noisy_scene("", Eigen::VectorXd::LinSpaced(n, 0.01, 3), 2000, offset);
        auto runner = test::make("minque", scene.array, {{"gamma", gamma}});
        INFO("n = " << n << ", gamma = " << gamma << ", offset " << offset);
        for (Eigen::Index k = 0; k < scene.y.cols(); k += 50) {
          Eigen::MatrixXd x(1, 50), v(1, 50);
          runner->run(scene.y.middleCols(k, 50), x, v);
          const Eigen::VectorXd variances = *runner->variances();
          REQUIRE(variances.allFinite());
          REQUIRE((variances.array() > 0).all());
          REQUIRE(x.allFinite());
        }
      }
}

TEST_CASE("minque: variances that the data cannot tell apart are named") {
  const Entry& entry = algorithm("minque");
  CHECK_FALSE(why_not(*entry.description, test::noisy_scene("", Eigen::VectorXd::Ones(2)).array).empty());
  Eigen::VectorXd two_good = Eigen::VectorXd::Constant(8, 1e6);
  two_good.head(2).setOnes();
  const auto remarked = [](const Eigen::VectorXd& variances) {
    const auto scene = test::noisy_scene("", variances, 5000);
    auto runner = test::make("minque", scene.array);
    test::run(*runner, scene.y);
    Findings warnings;
    runner->remarks(warnings);
    return warnings.find("variances_not_identifiable") != nullptr;
  };
  CHECK(remarked(two_good));
  CHECK_FALSE(remarked(Eigen::VectorXd::LinSpaced(6, 1, 3)));
}
