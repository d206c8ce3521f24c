// Fusion algorithms: against themselves where an input has to change the estimates in a known way,
// weights against long double, else what every estimate must be.
#include <fmt/format.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "libchar/benchmark/detail/stress_cells.hpp"
#include "libchar/fusion/array.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/fusion/runner.hpp"
#include "libchar/fusion/why_not.hpp"
#include "libchar/simulate/random.hpp"

namespace libchar {
namespace {

// Arrays of sensors that break what is careless with numbers.

struct StressArray {
  std::string name;
  fusion::Array array;
  Eigen::MatrixXd learning, learning_truth;  ///< n and r rows, a column an instant
  Eigen::MatrixXd y, truth;
  /// A relation to the plain array, which the estimates must have too: moved by `shift`, in units
  /// 2^power smaller, channels from last to first.
  double shift = 0;
  int power = 0;
  bool reversed = false;
  bool related() const { return shift != 0 || power != 0 || reversed; }
  /// of the errors' least-squares problem: weights are held against long double
  bool exact_weights = false;
};

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr Index kLearning = 600, kRun = 1000;

class Normal {
 public:
  explicit Normal(std::uint64_t seed) : stream_({seed, 0, Purpose::white}) {}
  double operator()() { return stream_.normal(); }

 private:
  DeviateStream stream_;
};

/// Multiples of 2^-20, which an offset of 2^27 leaves as they are.
double on_grid(double value) { return std::ldexp(std::round(std::ldexp(value, 20)), -20); }

void describe(const VectorXd& deviations, fusion::Array& array) {
  array.channels = deviations.size();
  array.noise_levels = deviations.cwiseAbs2();
  array.noise_models.clear();
  if (deviations.size() <= 10)
    for (const double d : deviations) array.noise_models.push_back({d * d, 0.1 * d, 0.001 * d, {}});
  array.rate_hz = 200;
  array.learning_samples = kLearning;
  array.fault_free_samples = kRun / 4;
  array.reference_throughout = true;
  array.section_starts = {0, kRun / 2};
}

/// Channels of these deviations on an input that forgets itself in a few instants.
StressArray noisy(const std::string& name, const VectorXd& deviations, std::uint64_t seed) {
  StressArray out;
  out.name = name;
  describe(deviations, out.array);
  Normal normal(seed);
  double x = 0;
  const auto record = [&](Index instants, MatrixXd& y, MatrixXd& truth) {
    y.resize(deviations.size(), instants);
    truth.resize(1, instants);
    for (Index k = 0; k < instants; ++k) {
      truth(0, k) = x = on_grid(0.7 * x + 2 * normal());
      for (Index i = 0; i < y.rows(); ++i) y(i, k) = on_grid(x + deviations[i] * normal());
    }
  };
  record(kLearning, out.learning, out.learning_truth);
  record(kRun, out.y, out.truth);
  return out;
}

template <class Change>
StressArray changed(StressArray array, const std::string& name, Change change) {
  change(array);
  array.name = name;
  return array;
}

/// Only the run is hurt; what was learnt is sound.
StressArray hurt(const StressArray& plain, const std::string& name, const std::function<void(MatrixXd&)>& how) {
  return changed(plain, name, [&](StressArray& a) { how(a.y); });
}

StressArray moved(const StressArray& plain, const std::string& name, double shift) {
  return changed(plain, name, [&](StressArray& a) {
    a.shift = shift;
    for (MatrixXd* m : {&a.learning, &a.learning_truth, &a.y, &a.truth}) m->array() += shift;
  });
}

StressArray scaled(const StressArray& plain, const std::string& name, int power) {
  return changed(plain, name, [&](StressArray& a) {
    a.power = power;
    const double factor = std::ldexp(1.0, power);
    for (MatrixXd* m : {&a.learning, &a.learning_truth, &a.y, &a.truth}) *m *= factor;
    a.array.noise_levels *= factor * factor;
    for (fusion::NoiseModel& model : a.array.noise_models) {
      model.white *= factor * factor;
      model.flicker *= factor;
      model.walk *= factor;
    }
  });
}

StressArray reversed(const StressArray& plain) {
  return changed(plain, "channels from last to first", [](StressArray& a) {
    a.reversed = true;
    a.learning = a.learning.colwise().reverse().eval();
    a.y = a.y.colwise().reverse().eval();
    a.array.noise_levels = a.array.noise_levels.reverse().eval();
    std::reverse(a.array.noise_models.begin(), a.array.noise_models.end());
  });
}

/// One error that all share, `common` times as large as what they have of their own.
StressArray correlated(const std::string& name, double common, std::uint64_t seed) {
  return changed(noisy(name, VectorXd::LinSpaced(5, 1, 3), seed), name, [&](StressArray& a) {
    a.exact_weights = true;
    Normal normal(seed + 1);
    for (MatrixXd* m : {&a.learning, &a.y})
      for (Index k = 0; k < m->cols(); ++k) {
        const double shared = common * normal();
        // Unequally, so that the best weights are not told by differences alone.
        for (Index i = 0; i < m->rows(); ++i) (*m)(i, k) += shared * (1 + 0.1 * static_cast<double>(i));
      }
  });
}

/// y = H x + e for two inputs, the second seen with gains of `second`.
StressArray lever(const std::string& name, const VectorXd& second, std::uint64_t seed) {
  const Index n = second.size();
  StressArray out;
  out.name = name;
  describe(VectorXd::LinSpaced(n, 0.3, 0.7), out.array);
  out.array.observation_matrix = MatrixXd::Ones(n, 2);
  out.array.observation_matrix.col(1) = second;
  Normal normal(seed);
  const auto record = [&](Index instants, MatrixXd& y, MatrixXd& truth) {
    truth.resize(2, instants);
    for (double& x : truth.reshaped()) x = normal();
    y = out.array.observation_matrix * truth;
    for (Index k = 0; k < instants; ++k)
      for (Index i = 0; i < n; ++i) y(i, k) += std::sqrt(out.array.noise_levels[i]) * normal();
  };
  record(kLearning, out.learning, out.learning_truth);
  record(kRun, out.y, out.truth);
  return out;
}

/// Gyroscope and two accelerometer axes of a tilt that swings by 40 degrees.
StressArray tilt(std::uint64_t seed) {
  StressArray out;
  out.name = "tilt";
  out.array.channels = 3;
  out.array.rate_hz = 100;
  out.array.tilt = fusion::TiltChannels{};
  out.array.learning_samples = kLearning;
  Normal normal(seed);
  const auto record = [&](Index instants, double from, MatrixXd& y, MatrixXd& truth) {
    y.resize(3, instants);
    truth.resize(1, instants);
    for (Index k = 0; k < instants; ++k) {
      const double t = from + static_cast<double>(k + 1) / 100, angle = 0.7 * std::sin(2 * t);
      truth(0, k) = angle;
      y(0, k) = 1.4 * std::cos(2 * t) + 0.01 + 0.02 * normal();
      y(1, k) = 9.81 * std::sin(angle) + 0.2 * normal();
      y(2, k) = 9.81 * std::cos(angle) + 0.2 * normal();
    }
  };
  record(kLearning, 0, out.learning, out.learning_truth);
  record(kRun, kLearning / 100.0, out.y, out.truth);
  return out;
}

void add_hurt(const StressArray& plain, std::vector<StressArray>& all) {
  const auto add = [&](const char* name, const std::function<void(MatrixXd&)>& how) {
    all.push_back(hurt(plain, name, how));
  };
  add("all zero", [](MatrixXd& y) { y.setZero(); });
  add("all constant", [](MatrixXd& y) { y.setConstant(9.81); });
  add("identical channels", [](MatrixXd& y) { y = y.row(0).replicate(y.rows(), 1).eval(); });
  add("two identical channels", [](MatrixXd& y) { y.row(3) = y.row(4).eval(); });
  add("one dead channel", [](MatrixXd& y) { y.row(4).setZero(); });
  add("one channel dies", [](MatrixXd& y) { y.row(4).rightCols(kRun / 2).setZero(); });
  add("one bit", [](MatrixXd& y) { y = (y.array() > 0).select(MatrixXd::Ones(y.rows(), y.cols()), -1); });
  add("saturated", [](MatrixXd& y) { y = y.cwiseMax(-1).cwiseMin(1); });
  add("float32", [](MatrixXd& y) { y = y.cast<float>().cast<double>().eval(); });
  add("one spike of 10³⁰⁰", [](MatrixXd& y) { y(2, 450) = 1e300; });
  add("one infinite sample", [](MatrixXd& y) { y(2, 450) = std::numeric_limits<double>::infinity(); });
  add("first and last sample missing", [](MatrixXd& y) { y(0, 0) = y(1, y.cols() - 1) = kMissing; });
  add("burst of missing samples in one", [](MatrixXd& y) { y.row(4).segment(300, 150).setConstant(kMissing); });
  add("burst of missing samples in all", [](MatrixXd& y) { y.middleCols(300, 150).setConstant(kMissing); });
  add("one channel all missing", [](MatrixXd& y) { y.row(1).setConstant(kMissing); });
  add("1 instant", [](MatrixXd& y) { y = y.leftCols(1).eval(); });
  add("2 instants", [](MatrixXd& y) { y = y.leftCols(2).eval(); });
  add("3 instants", [](MatrixXd& y) { y = y.leftCols(3).eval(); });
  for (std::size_t i = 0; i < all.size(); ++i) all[i].truth = all[i].truth.leftCols(all[i].y.cols()).eval();
}

void add_tilts(std::uint64_t seed, std::vector<StressArray>& all) {
  const StressArray plain = tilt(seed);
  all.push_back(plain);
  all.push_back(hurt(plain, "tilt, samples missing", [](MatrixXd& y) {
    y.row(1).segment(100, 50).setConstant(kMissing);
    y.row(0).segment(200, 50).setConstant(kMissing);
    y.middleCols(300, 50).setConstant(kMissing);
  }));
  all.push_back(hurt(plain, "tilt, accelerometers at zero", [](MatrixXd& y) { y.bottomRows(2).setZero(); }));
  all.push_back(hurt(plain, "tilt, accelerations of 10⁻³¹⁰", [](MatrixXd& y) { y.bottomRows(2) *= 1e-310; }));
  all.push_back(hurt(plain, "tilt, accelerations of 10⁹⁹", [](MatrixXd& y) { y.bottomRows(2) *= 1e98; }));
  all.push_back(hurt(plain, "tilt, 1 instant", [](MatrixXd& y) { y = y.leftCols(1).eval(); }));
  all.back().truth = all.back().truth.leftCols(1).eval();
}

/// The plain one first.
std::vector<StressArray> stress_arrays(std::uint64_t seed) {
  const VectorXd five = (VectorXd(5) << 100, 20, 10, 2, 1).finished().cwiseSqrt() / std::sqrt(50.0);
  const StressArray plain = noisy("five unequal channels", five, seed);
  std::vector<StressArray> all;
  add_hurt(plain, all);
  all.insert(all.begin(), plain);
  all.push_back(moved(plain, "offset 2²⁷", 0x1p27));
  all.push_back(scaled(plain, "scale 10⁹⁵", 315));
  all.push_back(scaled(plain, "scale 10⁻⁹⁵", -315));
  all.push_back(reversed(plain));
  all.push_back(noisy("two channels", VectorXd::LinSpaced(2, 1, 2), seed));
  all.push_back(noisy("200 channels", VectorXd::LinSpaced(200, 0.3, 2), seed));
  all.push_back(noisy("deviations of 1 : 10¹²", (VectorXd(4) << 1e-6, 1, 1e6, 2).finished(), seed));
  all.back().exact_weights = true;
  all.push_back(correlated("covariance of condition 10¹²", 1e5, seed));
  all.push_back(changed(plain, "constant reference", [](StressArray& a) { a.learning_truth.setConstant(1); }));
  all.push_back(changed(plain, "3 instants to learn from", [](StressArray& a) {
    a.learning = a.learning.leftCols(3).eval();
    a.learning_truth = a.learning_truth.leftCols(3).eval();
    a.array.learning_samples = 3;
  }));
  all.push_back(lever("two inputs", VectorXd::LinSpaced(8, 0, -5), seed));
  all.push_back(
      lever("two inputs that differ by 10⁻¹⁵", VectorXd::Ones(8) + 1e-15 * VectorXd::LinSpaced(8, -1, 1), seed));
  add_tilts(seed, all);
  return all;
}

constexpr double kWeightDigits = 8;

struct Fused {
  MatrixXd x, variance;
  std::optional<MatrixXd> weights;
};

/// Throws Error: the algorithm says why it cannot.
Fused fused(const fusion::Entry& entry, const StressArray& array) {
  const fusion::Settings settings(entry.options);
  const auto runner = entry.make(array.array, settings);
  const fusion::Needs& needs = entry.description->needs;
  if (needs.reference || needs.reference_helps) runner->learn(array.learning, array.learning_truth);
  if (entry.description->needs.reference_throughout) runner->learn(array.y, array.truth);
  if (entry.looks_ahead(settings)) runner->look(array.y);
  runner->finish_learning();
  Fused out{MatrixXd(array.array.inputs(), array.y.cols()), MatrixXd(array.array.inputs(), array.y.cols()), {}};
  runner->run(array.y, out.x, out.variance);
  out.weights = runner->weights();
  return out;
}

/// All samples are there, and of a tilt a direction.
bool complete(const StressArray& array, Index k) {
  return (array.y.col(k).array().abs() <= fusion::kLargestSample).all() &&
         (!array.array.tilt || array.y.col(k).tail(2).norm() > 0);
}

/// Where estimates may be: as far beyond the samples of the run as these are apart.
struct Range {
  double low = 0, high = 0;
};
Range range_of(const StressArray& array) {
  if (array.array.tilt) return {-10, 10};  // a swing of 0.7 rad
  double low = INFINITY, high = -INFINITY;
  for (const double y : array.y.reshaped())
    if (std::abs(y) <= fusion::kLargestSample) low = std::min(low, y), high = std::max(high, y);
  // What was learnt may put a channel right by some of its noise.
  const double beyond = std::max(high - low, 10 * std::sqrt(array.array.noise_levels.maxCoeff()));
  return {low - beyond, high + beyond};
}

/// Empty: nothing.
std::string what_is_wrong(const StressArray& array, const Fused& found, bool free) {
  const Range range = range_of(array);
  for (Index k = 0; k < found.x.cols(); ++k)
    for (Index i = 0; i < found.x.rows(); ++i) {
      const double x = found.x(i, k), v = found.variance(i, k);
      if (std::isinf(x)) return fmt::format("infinite at instant {}", k);
      if (std::isnan(x) && complete(array, k))
        return fmt::format("no estimate at instant {}, where all samples are", k);
      if (free) continue;
      if (v < 0 || std::isinf(v)) return fmt::format("variance {} at instant {}", v, k);
      if (array.array.one_common_input() && (x < range.low || x > range.high))
        return fmt::format("{} at instant {}, samples are from {} to {}", x, k, array.y.minCoeff(), array.y.maxCoeff());
      if (!array.array.one_common_input() && std::abs(x - array.truth(i, k)) > 8 * std::sqrt(v))
        return fmt::format("{} deviations off at instant {}", std::abs(x - array.truth(i, k)) / std::sqrt(v), k);
    }
  return "";
}

std::vector<double> finite_values(const MatrixXd& x) { return {x.data(), x.data() + x.size()}; }

/// What the plain array's estimates become.
std::vector<Exact> expected_of(const StressArray& array, const MatrixXd& plain) {
  std::vector<Exact> out;
  for (const double x : plain.reshaped()) out.push_back(std::ldexp(Exact(x), array.power));
  return out;
}

/// The offset is taken off the estimates again: digits are those of what moves.
void judge_related(const StressArray& array, const Fused& found, const Fused& plain, double stated, StressCell& cell) {
  const MatrixXd x = found.x.array() - array.shift;
  judge_digits(right_digits_together(finite_values(x), expected_of(array, plain.x)), stated, cell);
}

/// Starts belong to places among the channels.
bool knows_places(const fusion::Entry& entry) {
  return entry.description->name == "perceptron" || entry.description->name == "blind-gls";
}

/// Sums of few rounded numbers at an offset of 1e8 hold 8 digits of a deviation of 3.
double stated_digits(const fusion::Entry& entry, const StressArray& array) {
  if (entry.description->as_published || (array.reversed && knows_places(entry))) return std::nan("");
  return array.shift != 0 ? 7 : 9;
}

void stress_weights(const fusion::Entry& entry, const StressArray& array, StressCell& cell) {
  const Fused found = fused(entry, array);
  std::vector<std::vector<double>> errors(static_cast<std::size_t>(array.y.rows()));
  for (Index i = 0; i < array.y.rows(); ++i)
    for (Index k = 0; k < array.y.cols(); ++k)
      errors[static_cast<std::size_t>(i)].push_back(array.y(i, k) - array.truth(0, k));
  judge_digits(right_digits_together(finite_values(found.weights.value()), exact_weights(errors)), kWeightDigits, cell);
}

void stress_estimates(const fusion::Entry& entry, const StressArray& array, const StressArray& plain,
                      StressCell& cell) {
  if (const std::string why = fusion::why_not(*entry.description, array.array); !why.empty())
    return judge_refused(why, cell);
  const Fused found = fused(entry, array);
  if (array.related()) return judge_related(array, found, fused(entry, plain), stated_digits(entry, array), cell);
  const std::string wrong = what_is_wrong(array, found, entry.description->as_published);
  judge_held(wrong.empty(), wrong, cell);
}

/// Weights as learnt, of an input that leaves them as they are.
void stress_weights_related(const fusion::Entry& entry, const StressArray& array, const StressArray& plain,
                            StressCell& cell) {
  const Fused found = fused(entry, array), before = fused(entry, plain);
  MatrixXd weights = before.weights.value();
  if (array.reversed) weights = weights.colwise().reverse().eval();
  std::vector<Exact> expected;
  for (const double w : weights.reshaped()) expected.push_back(w);
  judge_digits(
      right_digits_together(finite_values(found.weights.value()), expected),
      entry.description->as_published || (array.reversed && knows_places(entry)) ? std::nan("") : kWeightDigits, cell);
}

}  // namespace

std::vector<StressCell> stress_fusion(const StressBenchOptions& options, Progress& progress) {
  const std::vector<StressArray> arrays = stress_arrays(options.seed);
  std::vector<StressCell> out;
  for (std::size_t i = 0; i < arrays.size(); ++i)
    for (const fusion::Entry& entry : fusion::algorithms()) {
      const StressArray& array = arrays[i];
      if (entry.description->needs.tilt != array.array.tilt.has_value()) continue;
      const std::string name(entry.description->name);
      progress.update(static_cast<double>(i) / static_cast<double>(arrays.size()), "stress: " + array.name);
      out.push_back(
          stress_cell(name, array.name, [&](StressCell& cell) { stress_estimates(entry, array, arrays[0], cell); }));
      if (out.back().outcome == StressOutcome::refused) continue;
      if (array.related() && fused(entry, arrays[0]).weights)
        out.push_back(stress_cell(name + ", weights", array.name,
                                  [&](StressCell& cell) { stress_weights_related(entry, array, arrays[0], cell); }));
      if (array.exact_weights && name == "optimal-weights")
        out.push_back(
            stress_cell(name + ", weights", array.name, [&](StressCell& cell) { stress_weights(entry, array, cell); }));
    }
  return out;
}

}  // namespace libchar
