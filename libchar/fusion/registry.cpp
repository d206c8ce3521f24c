#include "libchar/fusion/registry.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "libchar/core/error.hpp"
#include "libchar/core/text/spelling.hpp"
#include "libchar/fusion/detail/fault/watched_runner.hpp"
#include "libchar/fusion/why_not.hpp"
#include "libchar_algorithms.hpp"  // every header of algorithms/, found by CMake

// A build may bring algorithms of its own, which stand first: their header by -include, their
// entries by -D'LIBCHAR_MORE_ALGORITHMS=entry<Mine>(),'.
#ifndef LIBCHAR_MORE_ALGORITHMS
#define LIBCHAR_MORE_ALGORITHMS
#endif

namespace libchar::fusion {
namespace {

/// Estimates with weights that go on without a missing sample, and look for no faults themselves.
template <Algorithm A>
constexpr bool kWatchable =
    A::description.needs.accepts_missing&& HasWeights<A> && !HasFaults<A> &&
    !A::description.needs.reference_throughout && !A::description.needs.tilt;

template <std::size_t n, std::size_t m>
constexpr std::array<Option, n + m> joined(const std::array<Option, n>& a,
                                           const std::array<Option, m>& b) {
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
  if (std::string sentence = why_not(A::description, array); !sentence.empty())
    throw Error({ErrorKind::usage, "E0852", "", std::move(sentence)});
  auto runner = std::make_unique<RunnerOf<A>>(array, settings);
  if constexpr (kWatchable<A>)
    if (settings["fault_detection"] == 1)
      return std::make_unique<WatchedRunner>(array, settings, std::move(runner));
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
  return {&A::description,
          kOptions<A>,
          own_options<A>().size(),
          &make<A>,
          &cost_ns<A>,
          &looks_ahead<A>};
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

std::span<const Entry> algorithms() {
  return kAlgorithms;
}

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
  throw Error({ErrorKind::usage,
               "E0853",
               "",
               "no fusion algorithm has this name",
               std::string(name),
               did_you_mean(near, "`algorithms` names them")});
}

}  // namespace libchar::fusion
