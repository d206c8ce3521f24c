// Fusion algorithms: against themselves where an input has to change the estimates in a known way,
// weights against long double, else what every estimate must be.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "libchar/benchmark/detail/stress_arrays.hpp"
#include "libchar/benchmark/detail/stress_cells.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/fusion/runner.hpp"
#include "libchar/fusion/why_not.hpp"

namespace libchar {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr double kWeightDigits = 8;

struct Fused {
  MatrixXd x, variance;
  std::optional<MatrixXd> weights;
};

/// Throws Error: the algorithm says why it cannot.
Fused fused(const fusion::Entry& entry, const StressArray& array) {
  const fusion::Settings settings(entry.options);
  const auto runner = entry.make(array.array, settings);
  if (entry.description->needs.reference) runner->learn(array.learning, array.learning_truth);
  if (entry.description->needs.reference_throughout) runner->learn(array.y, array.truth);
  if (entry.looks_ahead(settings)) runner->look(array.y);
  runner->finish_learning();
  Fused out{MatrixXd(array.array.inputs(), array.y.cols()),
            MatrixXd(array.array.inputs(), array.y.cols()),
            {}};
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
        return fmt::format("{} at instant {}, samples are from {} to {}",
                           x,
                           k,
                           array.y.minCoeff(),
                           array.y.maxCoeff());
      if (!array.array.one_common_input() && std::abs(x - array.truth(i, k)) > 8 * std::sqrt(v))
        return fmt::format(
            "{} deviations off at instant {}", std::abs(x - array.truth(i, k)) / std::sqrt(v), k);
    }
  return "";
}

std::vector<double> finite_values(const MatrixXd& x) {
  return {x.data(), x.data() + x.size()};
}

/// What the plain array's estimates become.
std::vector<Exact> expected_of(const StressArray& array, const MatrixXd& plain) {
  std::vector<Exact> out;
  for (const double x : plain.reshaped()) out.push_back(std::ldexp(Exact(x), array.power));
  return out;
}

/// The offset is taken off the estimates again: digits are those of what moves.
void judge_related(const StressArray& array,
                   const Fused& found,
                   const Fused& plain,
                   double stated,
                   StressCell& cell) {
  const MatrixXd x = found.x.array() - array.shift;
  judge_digits(right_digits_together(finite_values(x), expected_of(array, plain.x)), stated, cell);
}

/// Starts belong to places among the channels.
bool knows_places(const fusion::Entry& entry) {
  return entry.description->name == "perceptron" || entry.description->name == "blind-gls";
}

/// Sums of few rounded numbers at an offset of 1e8 hold 8 digits of a deviation of 3.
double stated_digits(const fusion::Entry& entry, const StressArray& array) {
  if (entry.description->as_published || (array.reversed && knows_places(entry)))
    return std::nan("");
  return array.shift != 0 ? 7 : 9;
}

void stress_weights(const fusion::Entry& entry, const StressArray& array, StressCell& cell) {
  const Fused found = fused(entry, array);
  std::vector<std::vector<double>> errors(static_cast<std::size_t>(array.y.rows()));
  for (Index i = 0; i < array.y.rows(); ++i)
    for (Index k = 0; k < array.y.cols(); ++k)
      errors[static_cast<std::size_t>(i)].push_back(array.y(i, k) - array.truth(0, k));
  judge_digits(right_digits_together(finite_values(found.weights.value()), exact_weights(errors)),
               kWeightDigits,
               cell);
}

void stress_estimates(const fusion::Entry& entry,
                      const StressArray& array,
                      const StressArray& plain,
                      StressCell& cell) {
  if (const std::string why = fusion::why_not(*entry.description, array.array); !why.empty())
    return judge_refused(why, cell);
  const Fused found = fused(entry, array);
  if (array.related())
    return judge_related(array, found, fused(entry, plain), stated_digits(entry, array), cell);
  const std::string wrong = what_is_wrong(array, found, entry.description->as_published);
  judge_held(wrong.empty(), wrong, cell);
}

/// Weights as learnt, of an input that leaves them as they are.
void stress_weights_related(const fusion::Entry& entry,
                            const StressArray& array,
                            const StressArray& plain,
                            StressCell& cell) {
  const Fused found = fused(entry, array), before = fused(entry, plain);
  MatrixXd weights = before.weights.value();
  if (array.reversed) weights = weights.colwise().reverse().eval();
  std::vector<Exact> expected;
  for (const double w : weights.reshaped()) expected.push_back(w);
  judge_digits(right_digits_together(finite_values(found.weights.value()), expected),
               entry.description->as_published || (array.reversed && knows_places(entry))
                   ? std::nan("")
                   : kWeightDigits,
               cell);
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
      progress.update(static_cast<double>(i) / static_cast<double>(arrays.size()),
                      "stress: " + array.name);
      out.push_back(stress_cell(name, array.name, [&](StressCell& cell) {
        stress_estimates(entry, array, arrays[0], cell);
      }));
      if (out.back().outcome == StressOutcome::refused) continue;
      if (array.related() && fused(entry, arrays[0]).weights)
        out.push_back(stress_cell(name + ", weights", array.name, [&](StressCell& cell) {
          stress_weights_related(entry, array, arrays[0], cell);
        }));
      if (array.exact_weights && name == "optimal-weights")
        out.push_back(stress_cell(name + ", weights", array.name, [&](StressCell& cell) {
          stress_weights(entry, array, cell);
        }));
    }
  return out;
}

}  // namespace libchar
