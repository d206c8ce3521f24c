#pragma once
// What an algorithm learnt from a reference, as numbers with names: enough to run elsewhere without it.

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace libchar::fusion {

struct LearntNumbers {
  std::string name;
  std::vector<double> values;  ///< finite
};
using Learnt = std::vector<LearntNumbers>;

/// Hands numbers out, or takes them in: one list of names serves both ways.
///
///   void exchange(LearntExchange& with) {   // of an algorithm
///     with.numbers("weights", span_of(weights_));  // its length is known from the array
///     with.number("variance", variance_);
///     if (with.taking_in()) …               // what follows from them
///   }
class LearntExchange {
 public:
  /// To hand out.
  LearntExchange() = default;
  /// To take in; `rate_ratio`: rate of the samples to come over that of those it was learnt from.
  LearntExchange(Learnt learnt, double rate_ratio)
      : learnt_(std::move(learnt)), taken_(learnt_.size(), 0), rate_ratio_(rate_ratio) {
    taking_in_ = true;
  }

  bool taking_in() const { return taking_in_; }
  void number(std::string_view name, double& value);
  /// Throws Error(input) when another number of them is there.
  void numbers(std::string_view name, std::span<double> values);
  /// As many as there are.
  void list(std::string_view name, std::vector<double>& values);
  /// What counts samples means nothing at another rate: throws Error(input) when they differ by more
  /// than a hundredth. `what`: "its stretches of the past".
  void needs_same_rate(std::string_view what) const;
  /// Throws Error(input) for a name that was not taken.
  void finish() const;

  const Learnt& learnt() const { return learnt_; }

 private:
  const std::vector<double>& find(std::string_view name);
  void check(std::string_view name, std::size_t wanted, std::size_t found) const;
  Learnt learnt_;
  std::vector<char> taken_;
  double rate_ratio_ = 1;
  bool taking_in_ = false;
};

/// Rates that differ by no more than this are one rate.
inline constexpr double kSameRate = 0.01;

}  // namespace libchar::fusion
