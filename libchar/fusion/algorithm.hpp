#pragma once
// The contract of a fusion algorithm: a plain struct with a description, a constructor from the array, and `step`.
//
//   struct Mean {
//     static constexpr Description description{.name = "mean", …};
//     explicit Mean(const Array& array);
//     Estimate step(const Sample& y);
//   };
//
// The engine knows it by one line in registry.cpp. It may also have:
//   static constexpr std::array options{Option{…}…};
//       And the constructor A(const Array&, const Settings&).
//   void learn(const Sample& y, const Sample& truth);
//       One instant of the learning window (description.needs says so).
//   void skip(const Sample& y);
//       Instead of `learn` where the truth is missing (or a sample, unless the description accepts that). For
//       those that count instants or follow time.
//   void finish_learning();
//       After the last one. Throws Error(numeric) when nothing can be learnt.
//   Eigen::MatrixXd weights() const;      n x r, at present.
//   Eigen::VectorXd variances() const;    Of a sample's noise, channel by channel, as estimated now.
//   const FaultLog& faults() const;
//   const HandOverLog& hand_overs() const;   Of one that has several estimators.
//   void remarks(Findings&) const;        What the reader of the result must know.
//   static bool looks_ahead(const Settings&);   and   void look(const Sample& y);
//       True: it is shown all instants of the run before the first step. Then come finish_learning and the
//       steps of the same instants.
//   static double cost_ns(const Array&, const Settings&);
//       Of a step, nanoseconds of a core of 3 GHz, to one significant digit. What scores would cost is
//       counted with it, never measured. Without it: 10 per channel and input.
//   void exchange(LearntExchange&);
//       Hands out what finish_learning made, or takes it in instead of learning (learnt.hpp). An algorithm
//       that learns and lacks it cannot be applied to another log.

#include <Eigen/Core>
#include <cmath>
#include <concepts>
#include <limits>
#include <span>

#include "libchar/core/finding.hpp"
#include "libchar/core/numeric/present.hpp"
#include "libchar/fusion/array.hpp"
#include "libchar/fusion/description.hpp"
#include "libchar/fusion/fault_log.hpp"
#include "libchar/fusion/learnt.hpp"
#include "libchar/fusion/options.hpp"

namespace libchar::fusion {

inline constexpr int kMaxStates = 8;  ///< inputs r that an algorithm can estimate

/// Lives inside the object: `step` makes no trip to the heap.
using State = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxStates, 1>;
/// One instant, one value per channel, NaN = missing; or the true inputs of that instant.
using Sample = Eigen::Map<const Eigen::VectorXd>;
/// Of a vector of known length, for LearntExchange.
inline std::span<double> span_of(Eigen::VectorXd& values) {
  return {values.data(), static_cast<std::size_t>(values.size())};
}

using libchar::kLargestSample;
/// A sample that carries a value: NaN marks a missing one.
inline bool usable(double sample) { return std::abs(sample) <= kLargestSample; }
inline bool complete(const Sample& y) {
  for (Eigen::Index i = 0; i < y.size(); ++i)
    if (!usable(y[i])) return false;
  return true;
}

struct Estimate {
  State x;         ///< r values; NaN: no estimate at this instant
  State variance;  ///< of x as the algorithm believes it; NaN: it has no opinion

  static Estimate scalar(double x, double variance) { return {State::Constant(1, x), State::Constant(1, variance)}; }
  static Estimate none(Eigen::Index inputs) {
    return {State::Constant(inputs, std::numeric_limits<double>::quiet_NaN()),
            State::Constant(inputs, std::numeric_limits<double>::quiet_NaN())};
  }
};

template <class A>
concept Steps = requires(A a, const Sample& y) {
  { a.step(y) } -> std::same_as<Estimate>;
};
template <class A>
concept HasDescription = requires {
  { A::description } -> std::convertible_to<const Description&>;
};
template <class A>
concept HasOptions = requires {
  {std::span<const Option>(A::options)};
};
template <class A>
concept Made = (HasOptions<A> && std::constructible_from<A, const Array&, const Settings&>) ||
               (!HasOptions<A> && std::constructible_from<A, const Array&>);
template <class A>
concept Algorithm = HasDescription<A> && Steps<A> && Made<A>;

template <class A>
concept Learns = requires(A a, const Sample& y, const Sample& truth) {
  a.learn(y, truth);
};
template <class A>
concept Skips = requires(A a, const Sample& y) {
  a.skip(y);
};
template <class A>
concept FinishesLearning = requires(A a) {
  a.finish_learning();
};
template <class A>
concept Exchanges = requires(A a, LearntExchange& with) {
  a.exchange(with);
};
template <class A>
concept HasWeights = requires(const A a) {
  { a.weights() } -> std::convertible_to<Eigen::MatrixXd>;
};
template <class A>
concept HasVariances = requires(const A a) {
  { a.variances() } -> std::convertible_to<Eigen::VectorXd>;
};
template <class A>
concept HasFaults = requires(const A a) {
  { a.faults() } -> std::same_as<const FaultLog&>;
};
template <class A>
concept HasHandOvers = requires(const A a) {
  { a.hand_overs() } -> std::same_as<const HandOverLog&>;
};
template <class A>
concept HasRemarks = requires(const A a, Findings& warnings) {
  a.remarks(warnings);
};

template <class A>
concept LooksAhead = requires(A a, const Sample& y, const Settings& settings) {
  { A::looks_ahead(settings) } -> std::same_as<bool>;
  a.look(y);
};

template <class A>
concept HasCost = requires(const Array& array, const Settings& settings) {
  { A::cost_ns(array, settings) } -> std::same_as<double>;
};

}  // namespace libchar::fusion
