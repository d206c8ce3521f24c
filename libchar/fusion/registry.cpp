#include "libchar/fusion/registry.hpp"

#include <array>
#include <string>

#include "libchar/core/error.hpp"
#include "libchar/core/spelling.hpp"
#include "libchar/fusion/why_not.hpp"
#include "libchar_algorithms.hpp"  // every header of algorithms/, found by CMake

// A build may bring algorithms of its own, which stand first: their header by -include, their
// entries by -D'LIBCHAR_MORE_ALGORITHMS=entry<Mine>(),'.
#ifndef LIBCHAR_MORE_ALGORITHMS
#define LIBCHAR_MORE_ALGORITHMS
#endif

namespace libchar::fusion {
namespace {

template <Algorithm A>
std::unique_ptr<Runner> make(const Array& array, const Settings& settings) {
  if (std::string sentence = why_not(A::description, array); !sentence.empty())
    throw Error({ErrorKind::usage, "E0852", "", std::move(sentence), "", ""});
  return std::make_unique<RunnerOf<A>>(array, settings);
}

template <Algorithm A>
double cost_ns(const Array& array, const Settings& settings) {
  if constexpr (HasCost<A>) return A::cost_ns(array, settings);
  return 10.0 * static_cast<double>(array.channels * array.inputs());
}

template <Algorithm A>
constexpr Entry entry() {
  if constexpr (HasOptions<A>)
    return {&A::description, A::options, &make<A>, &cost_ns<A>};
  else
    return {&A::description, {}, &make<A>, &cost_ns<A>};
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
               near ? "did you mean " + *near + "?" : "`algorithms` names them"});
}

}  // namespace libchar::fusion
