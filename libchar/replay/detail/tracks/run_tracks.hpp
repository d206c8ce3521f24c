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
      const auto stop = static_cast<Eigen::Index>(std::min<std::int64_t>(count, (bin + 1) * size_ - first));
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

/// Where a run is kept instant by instant.
struct CloseUpPlace {
  std::int64_t from = 0, count = 0;  ///< instants of the run
  std::optional<std::size_t> fault;
};

/// Around the start of the first faults, and where scoring begins; without faults in the middle too. They do not
/// overlap. `starts`: instants of the run at which the faults begin; `series`: that are kept of each.
std::vector<CloseUpPlace> close_up_places(std::int64_t instants, std::int64_t scored_from,
                                          const std::vector<std::int64_t>& starts, std::size_t series);

/// Listens to a run: the reference, each method's estimate and its error, each sensor and its error
/// (without a reference: its distance from the median of all).
class RunTracker {
 public:
  RunTracker() = default;
  /// `alike`: all sensors see one input, in one unit; without that sensors are not compared.
  RunTracker(const RunFrame& frame, std::int64_t instants, std::size_t algorithms, bool alike,
             const std::vector<std::int64_t>& fault_starts);
  /// A block that starts at instant `first` of the run, after `runs` have scored it.
  void push(std::int64_t first, const Eigen::MatrixXd& samples, const Eigen::MatrixXd& truth,
            const std::vector<AlgorithmRun>& runs);
  /// Of the `run`-th of the runs, beside the single `sensor` (none: without).
  RunTracks result(std::size_t run, std::optional<std::size_t> sensor) const;

 private:
  struct Pair {
    Envelope value, error;
  };
  /// A stretch of the run with all that is kept of it.
  struct Kept {
    CloseUpPlace place;
    std::vector<Envelope> reference;  // [input]
    std::vector<Pair> estimates;      // [run][input]
    std::vector<Pair> sensors;        // empty: they are not compared
  };
  /// `count` instants of a block from its instant `skip` on are those from `first` of the stretch on.
  struct Part {
    std::int64_t first = 0;
    Eigen::Index skip = 0, count = 0;
  };
  Kept kept(const CloseUpPlace& place, std::size_t bins, std::size_t algorithms, bool alike) const;
  void push_run(const Part& part, const AlgorithmRun& run, const Eigen::MatrixXd& truth, Pair* to);
  void push_sensors(const Part& part, const Eigen::MatrixXd& samples, const Eigen::MatrixXd& truth,
                    std::vector<Pair>& to);
  void find_medians(const Eigen::MatrixXd& samples);
  RunStretch stretch(const Kept& kept, std::size_t run, std::optional<std::size_t> sensor) const;
  Timeline timeline(const Kept& kept, const Envelope& envelope) const;
  double start_s(const Kept& kept) const;

  const RunFrame* frame_ = nullptr;
  std::vector<Kept> kept_;  // the whole run first
  std::vector<double> median_, sorted_;
  Eigen::VectorXd h_;
  bool referenced_ = false;
};

// Timelines made small enough for a page; no extreme is lost.

/// Every `divisor` neighbouring bins become one: the smallest low, the largest high.
Timeline merged_bins(const Timeline& timeline, std::size_t divisor);

/// The smallest divisor that keeps the tracks of all algorithms together within what a page of 3 MB can hold.
std::size_t track_divisor(const ReplayResult& result);

}  // namespace libchar
