#include "libchar/fusion/registry.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/fusion/detail/fault/fault_detector.hpp"
#include "libchar/fusion/runner.hpp"
#include "libchar/fusion/why_not.hpp"
#include "libchar_algorithms.hpp"  // every header of algorithms/, found by CMake

// A build may bring algorithms of its own, which stand first: their header by -include, their
// entries by -D'LIBCHAR_MORE_ALGORITHMS=entry<Mine>(),'.
#ifndef LIBCHAR_MORE_ALGORITHMS
#define LIBCHAR_MORE_ALGORITHMS
#endif

namespace libchar::fusion {
namespace {

constexpr double kNoisy = 2;  ///< of its variance
constexpr Eigen::Index kWatchedAtOnce = 256;

// The fault detector (fault_detector.hpp) in front of any estimate that goes on without a missing
// sample: what a sensor says while it is out is missing for the estimate. Weights that are fixed
// know nothing of noise: a sensor whose variance is twice what it was is out as well (with weight w
// of n alike it would cost more than it brings from (n + 1)/(n - 1) times on).

/// What the algorithms that can be watched have behind their own options.
inline constexpr std::array kWatchOptions{
    Option{"fault_detection", "", 0, 0, 1,
           "1: sensors that fail are left out, found by cumulative sums as minque does; 0: all are used", true},
    Option{"false_alarm_s", "s", 1e5, 1, 1e15,
           "mean time between two false alarms of the array (without a rate: per 20 million samples)"},
    Option{"recovery_window", "samples", 0, 0, 1e9,
           "own samples that must agree with the others before a channel comes in again (0: 200, or those of 2 s where "
           "they are fewer)",
           true}};

class WatchedRunner final : public Runner {
 public:
  /// The settings have `kWatchOptions`.
  WatchedRunner(const Array& array, const Settings& settings, std::unique_ptr<Runner> watched)
      : array_(array),
        options_{settings["false_alarm_s"], static_cast<std::int64_t>(settings["recovery_window"])},
        watched_(std::move(watched)),
        used_(array.channels, kWatchedAtOnce) {
    if (array.channels > 2 * array.inputs() && array.channels <= kMostPaired) detector_.emplace(array_, options_);
  }

  const Description& description() const override { return watched_->description(); }
  void learn(const Block& samples, const Block& truth) override { watched_->learn(samples, truth); }
  // A detector of its own: that of the run begins with its first step.
  void look(const Block& samples) override {
    if (!detector_) return watched_->look(samples);
    if (!ahead_) ahead_.emplace(array_, options_);
    for (Eigen::Index begin = 0; begin < samples.cols(); begin += kWatchedAtOnce) {
      const Eigen::Index count = std::min(kWatchedAtOnce, samples.cols() - begin);
      leave_out(*ahead_, samples.middleCols(begin, count));
      watched_->look(used_.leftCols(count));
    }
  }
  void finish_learning() override { watched_->finish_learning(); }
  bool exchange(LearntExchange& with) override { return watched_->exchange(with); }
  void run(const Block& samples, BlockOut x, BlockOut variance) override {
    if (!detector_) return watched_->run(samples, x, variance);
    for (Eigen::Index begin = 0; begin < samples.cols(); begin += kWatchedAtOnce) {
      const Eigen::Index count = std::min(kWatchedAtOnce, samples.cols() - begin);
      leave_out(*detector_, samples.middleCols(begin, count));
      watched_->run(used_.leftCols(count), x.middleCols(begin, count), variance.middleCols(begin, count));
    }
  }
  std::optional<Eigen::MatrixXd> weights() const override { return watched_->weights(); }
  std::optional<Eigen::VectorXd> variances() const override { return watched_->variances(); }
  const FaultLog* faults() const override { return detector_ ? &detector_->log() : &none_; }
  void remarks(Findings& warnings) const override {
    watched_->remarks(warnings);
    if (detector_) return detector_->remarks(array_.names, warnings);
    warnings.add("faults_not_watched",
                 "no faults are looked for: the search takes more than two sensors per input, and at most " +
                     std::to_string(kMostPaired));
  }

 private:
  /// What is left of a block of samples, at most `kWatchedAtOnce` instants.
  void leave_out(FaultDetector& detector, const Block& samples);

  Array array_;
  FaultDetectorOptions options_;
  std::unique_ptr<Runner> watched_;
  std::optional<FaultDetector> detector_;  // none: too few sensors to tell which of them fails
  std::optional<FaultDetector> ahead_;     // of the run while it is looked at
  FaultLog none_;
  Eigen::MatrixXd used_;
};

void WatchedRunner::leave_out(FaultDetector& detector, const Block& samples) {
  for (Eigen::Index k = 0; k < samples.cols(); ++k) {
    detector.step(samples.data() + k * samples.outerStride());
    for (Eigen::Index i = 0; i < samples.rows(); ++i) {
      const auto channel = static_cast<std::size_t>(i);
      const bool out = detector.out(channel) || detector.noisy(channel) > kNoisy;
      used_(i, k) = out ? std::numeric_limits<double>::quiet_NaN() : samples(i, k);
    }
  }
}

/// Estimates with weights that go on without a missing sample, and look for no faults themselves.
template <Algorithm A>
constexpr bool kWatchable = A::description.needs.accepts_missing&& HasWeights<A> && !HasFaults<A> &&
                            !A::description.needs.reference_throughout && !A::description.needs.tilt;

template <std::size_t n, std::size_t m>
constexpr std::array<Option, n + m> joined(const std::array<Option, n>& a, const std::array<Option, m>& b) {
  std::array<Option, n + m> out{};
  std::copy(a.begin(), a.end(), out.begin());
  std::copy(b.begin(), b.end(), out.begin() + n);
  return out;
}

template <Algorithm A>
constexpr auto own_options() {
  if constexpr (HasOptions<A>)
    return A::options;
  else
    return std::array<Option, 0>{};
}

template <Algorithm A>
constexpr auto all_options() {
  if constexpr (kWatchable<A>)
    return joined(own_options<A>(), kWatchOptions);
  else
    return own_options<A>();
}

template <Algorithm A>
constexpr auto kOptions = all_options<A>();

template <Algorithm A>
std::unique_ptr<Runner> make(const Array& array, const Settings& settings) {
  if (const std::string why = why_not(A::description, array); !why.empty())
    throw usage_error("E0852").says("{} {}", A::description.name, why);
  auto runner = std::make_unique<RunnerOf<A>>(array, settings);
  if constexpr (kWatchable<A>)
    if (settings["fault_detection"] == 1) return std::make_unique<WatchedRunner>(array, settings, std::move(runner));
  return runner;
}

template <Algorithm A>
double cost_ns(const Array& array, const Settings& settings) {
  double cost = 10.0 * static_cast<double>(array.channels * array.inputs());
  if constexpr (HasCost<A>) cost = A::cost_ns(array, settings);
  if constexpr (kWatchable<A>)
    if (settings["fault_detection"] == 1) cost += 40.0 * static_cast<double>(array.channels);
  return cost;
}

template <Algorithm A>
bool looks_ahead([[maybe_unused]] const Settings& settings) {
  if constexpr (LooksAhead<A>) return A::looks_ahead(settings);
  return false;
}

template <Algorithm A>
constexpr Entry entry() {
  return {&A::description, kOptions<A>, own_options<A>().size(), &make<A>, &cost_ns<A>, &looks_ahead<A>};
}

// The order of reports: baselines, blind methods, methods that learn from a reference, bounds.
constexpr std::array kAlgorithms{
    LIBCHAR_MORE_ALGORITHMS entry<Mean>(),
    entry<Median>(),
    entry<InverseVariance>(),
    entry<CovarianceIntersection>(),
    entry<Minque>(),
    entry<MinquePublished>(),
    entry<RandomWeighting>(),
    entry<RandomWeightingPublished>(),
    entry<KalmanTakens>(),
    entry<KalmanTakensPublished>(),
    entry<BlindCalibration>(),
    entry<BlindCalibrationPublished>(),
    entry<BlindGls>(),
    entry<VirtualSensor>(),
    entry<BestAxes>(),
    entry<LeastSquares>(),
    entry<LeastSquaresPublished>(),
    entry<ShrunkLeastSquares>(),
    entry<NonNegativeLeastSquares>(),
    entry<Perceptron>(),
    entry<NeuralSimplex>(),
    entry<KalmanTakensTaught>(),
    entry<TiltGyroscope>(),
    entry<TiltAccelerometer>(),
    entry<TiltComplementary>(),
    entry<TiltKalman>(),
    entry<TiltComplementaryTuned>(),
    entry<TiltKalmanTuned>(),
    entry<BestSensor>(),
    entry<OptimalWeights>(),
    entry<SectionedLeastSquares>(),
};

}  // namespace

std::span<const Entry> algorithms() { return kAlgorithms; }

const Entry* find_algorithm(std::string_view name) {
  for (const Entry& candidate : kAlgorithms)
    if (candidate.description->name == name) return &candidate;
  return nullptr;
}

const Entry& algorithm(std::string_view name) {
  if (const Entry* found = find_algorithm(name)) return *found;
  std::vector<std::string> names;
  names.reserve(kAlgorithms.size());
  for (const Entry& candidate : kAlgorithms) names.emplace_back(candidate.description->name);
  const auto near = nearest(name, names);
  throw usage_error("E0853")
      .says("no fusion algorithm has this name")
      .got(std::string(name))
      .hint(did_you_mean(near, "`algorithms` names them"));
}

}  // namespace libchar::fusion
