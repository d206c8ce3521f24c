#pragma once
// The run over time, kept small while it passes: smallest and largest value in each of many equal
// stretches. What is shown of it is chosen at the end, when the best method is known.

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include "libchar/core/not_known.hpp"
#include "libchar/replay/detail/algorithm_run.hpp"
#include "libchar/replay/replay_result.hpp"

namespace libchar {

/// Smallest and largest of a series of known length, in at most `bins` equal stretches of it (the
/// last one may be shorter). Memory does not grow with the series; blocks may be of any size.
class Envelope {
 public:
  Envelope() = default;
  Envelope(std::int64_t instants, std::size_t bins);
  /// `count` values from instant `first` on; those that are no finite number are passed over.
  template <class Value>
  void push(std::int64_t first, Eigen::Index count, const Value& value) {
    for (Eigen::Index k = 0; k < count;) {
      const std::int64_t bin = (first + k) / size_;
      const Eigen::Index stop = std::min<Eigen::Index>(count, (bin + 1) * size_ - first);
      double low = low_[static_cast<std::size_t>(bin)], high = high_[static_cast<std::size_t>(bin)];
      for (; k < stop; ++k) {
        const double v = value(k);
        if (!(v - v == 0)) continue;  // NaN and infinities
        if (!(v >= low)) low = v;
        if (!(v <= high)) high = v;
      }
      low_[static_cast<std::size_t>(bin)] = low;
      high_[static_cast<std::size_t>(bin)] = high;
    }
  }
  /// Adds itself as a series; the times are those of the first one added.
  void add_to(Timeline& timeline, double start_s, double rate_hz) const;

 private:
  std::int64_t size_ = 1, instants_ = 0;
  std::vector<double> low_, high_;  // NaN: no value yet
};

/// At most so many stretches of a run.
inline constexpr std::size_t kRunBins = 1000;

/// Listens to a run: the reference, each method's estimate and its error, each sensor and its error
/// (without a reference: its distance from the median of all).
class RunTracker {
 public:
  RunTracker() = default;
  /// `alike`: all sensors see one input, in one unit; without that sensors are not compared.
  RunTracker(const RunFrame& frame, std::int64_t instants, std::size_t algorithms, bool alike);
  /// A block that starts at instant `first` of the run, after `runs` have scored it.
  void push(std::int64_t first,
            const Eigen::MatrixXd& samples,
            const Eigen::MatrixXd& truth,
            const std::vector<AlgorithmRun>& runs);
  /// Of the `run`-th of the runs, beside the single `sensor` (none: without).
  RunTracks result(std::size_t run, std::optional<std::size_t> sensor) const;

 private:
  struct Pair {
    Envelope value, error;
  };
  void push_run(std::int64_t first,
                const AlgorithmRun& run,
                const Eigen::MatrixXd& truth,
                Pair* to);
  void push_sensors(std::int64_t first,
                    const Eigen::MatrixXd& samples,
                    const Eigen::MatrixXd& truth);
  void push_deviations(std::int64_t first, const Eigen::MatrixXd& samples);
  Timeline timeline(const Envelope& envelope) const;

  const RunFrame* frame_ = nullptr;
  std::vector<Envelope> reference_;  // [input]
  std::vector<Pair> estimates_;      // [run][input]
  std::vector<Pair> sensors_;        // empty: they are not compared
  std::vector<double> median_, sorted_;
  Eigen::VectorXd h_;
  bool referenced_ = false;
};

}  // namespace libchar
