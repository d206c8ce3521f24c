#pragma once
// The engine's side of the contract: the type of an algorithm is erased once a block, not once an instant
// (inverse-variance on 4 channels: 5.5 ns per instant, 14.6 ns with a virtual call for each).

#include <cassert>
#include <optional>

#include "libchar/fusion/algorithm.hpp"

namespace libchar::fusion {

/// A block of consecutive instants: column k holds the n samples of instant k. Blocks of any size give the same bits.
using Block = Eigen::Ref<const Eigen::MatrixXd>;
/// r rows, one column per instant.
using BlockOut = Eigen::Ref<Eigen::MatrixXd>;

class Runner {
 public:
  virtual ~Runner() = default;
  virtual const Description& description() const = 0;
  /// Consecutive instants of the learning window with the true inputs (r rows). Instants whose
  /// truth is NaN carry nothing to learn, but their time has passed: leave none out.
  virtual void learn(const Block& samples, const Block& truth) = 0;
  /// Consecutive instants of the run itself, for those that look ahead, before `finish_learning`.
  virtual void look(const Block& samples) = 0;
  virtual void finish_learning() = 0;
  /// Hands out or takes in what was learnt; false: there is no way to. What learns nothing hands out
  /// nothing. Throws Error(input) when what is taken in does not fit.
  virtual bool exchange(LearntExchange& with) = 0;
  /// Estimates and their variances, a column for each column of samples.
  virtual void run(const Block& samples, BlockOut x, BlockOut variance) = 0;
  virtual std::optional<Eigen::MatrixXd> weights() const = 0;
  virtual std::optional<Eigen::VectorXd> variances() const = 0;
  virtual const FaultLog* faults() const = 0;
  virtual const HandOverLog* hand_overs() const { return nullptr; }
  virtual void remarks(Findings& warnings) const = 0;
};

template <Algorithm A>
A make_algorithm(const Array& array, const Settings& settings) {
  if constexpr (HasOptions<A>)
    return A(array, settings);
  else
    return A(array);
}

template <Algorithm A>
class RunnerOf final : public Runner {
  static constexpr bool kMayLearn = A::description.needs.reference_helps;
  static constexpr bool kLearns =
      A::description.needs.reference || A::description.needs.reference_throughout || kMayLearn;
  static_assert(
      kLearns == Learns<A>,
      "description.needs.reference (or reference_throughout, reference_helps) and learn(y, truth) go together");
  static_assert(HasOptions<A> || !std::constructible_from<A, const Array&, const Settings&>,
                "a constructor with Settings goes with a table `options`");

 public:
  RunnerOf(const Array& array, const Settings& settings)
      : inputs_(array.inputs()), algorithm_(make_algorithm<A>(array, settings)) {}

  const Description& description() const override { return A::description; }

  void learn([[maybe_unused]] const Block& samples, [[maybe_unused]] const Block& truth) override {
    if constexpr (Learns<A>) {
      assert(samples.cols() == truth.cols());
      for (Eigen::Index k = 0; k < samples.cols(); ++k) {
        const Sample y(samples.data() + k * samples.outerStride(), samples.rows());
        const Sample x(truth.data() + k * truth.outerStride(), truth.rows());
        if (complete(x) && (A::description.needs.accepts_missing || complete(y)))
          algorithm_.learn(y, x);
        else if constexpr (Skips<A>)
          algorithm_.skip(y);
      }
    }
  }

  void look([[maybe_unused]] const Block& samples) override {
    if constexpr (LooksAhead<A>)
      for (Eigen::Index k = 0; k < samples.cols(); ++k)
        algorithm_.look(Sample(samples.data() + k * samples.outerStride(), samples.rows()));
  }

  void finish_learning() override {
    if constexpr (FinishesLearning<A>) algorithm_.finish_learning();
  }

  bool exchange([[maybe_unused]] LearntExchange& with) override {
    if constexpr (Exchanges<A>) {
      algorithm_.exchange(with);
      with.finish();
    } else if constexpr (!kLearns) {
      with.finish();
    }
    return Exchanges<A> || !kLearns;
  }

  void run(const Block& samples, BlockOut x, BlockOut variance) override {
    assert(x.cols() == samples.cols() && x.rows() == inputs_);
    for (Eigen::Index k = 0; k < samples.cols(); ++k) {
      const Sample y(samples.data() + k * samples.outerStride(), samples.rows());
      const Estimate estimate = step(y);
      for (Eigen::Index i = 0; i < inputs_; ++i) {
        x(i, k) = estimate.x[i];
        variance(i, k) = estimate.variance[i];
      }
    }
  }

  std::optional<Eigen::MatrixXd> weights() const override {
    if constexpr (HasWeights<A>) return algorithm_.weights();
    return std::nullopt;
  }
  std::optional<Eigen::VectorXd> variances() const override {
    if constexpr (HasVariances<A>) return algorithm_.variances();
    return std::nullopt;
  }
  const FaultLog* faults() const override {
    if constexpr (HasFaults<A>) return &algorithm_.faults();
    return nullptr;
  }
  const HandOverLog* hand_overs() const override {
    if constexpr (HasHandOvers<A>) return &algorithm_.hand_overs();
    return nullptr;
  }
  void remarks([[maybe_unused]] Findings& warnings) const override {
    if constexpr (HasRemarks<A>) algorithm_.remarks(warnings);
  }

 private:
  Estimate step(const Sample& y) {
    if constexpr (!A::description.needs.accepts_missing)
      if (!complete(y)) return Estimate::none(inputs_);
    return algorithm_.step(y);
  }

  Eigen::Index inputs_;
  A algorithm_;
};

}  // namespace libchar::fusion
