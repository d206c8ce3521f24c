#pragma once
// Samples on straight lines: gaps that somebody has filled, and slow channels that were resampled by interpolation.

#include <cstdint>
#include <span>

#include "libchar/log/detail/flag_runs.hpp"

namespace libchar::detail {

/// The step to `c` goes on as that to `b`, within a tenth, which leaves room for the last digit. Of white noise 1.8 %
/// of the samples do: the ratio of its steps is Cauchy about -1/2 with the scale sqrt(3)/2.
inline bool on_line(double a, double b, double c) {
  const double step = b - a, bend = (c - b) - step;
  return step != 0 && bend * bend <= 0.01 * (step * step);
}

class LineWatch {
 public:
  /// `starts`: samples that do not follow the one before directly; null: all do. `at`: index of x[0] in the record.
  void block(std::span<const double> x, const unsigned char* starts, std::uint64_t at);
  /// `direct`: the first sample of `later` follows directly. `at`: its part's begin in the record.
  void join(const LineWatch& later, bool direct, std::uint64_t at);

  /// A run of one flag may be left out.
  const FlagRuns& runs() const { return runs_; }
  /// The least number of flags in a row that chance does not give in this record: runs of two and three say how
  /// chance goes on. 0: there is no run so long.
  std::uint64_t least_run() const;

  static void layout(auto& at, auto& watch) {
    at.group(
        "lines of a channel", watch.n_, watch.before_, watch.last_, watch.first_, watch.second_);
    at(watch.pair_, watch.direct_, watch.coarse_);
    FlagRuns::layout(at, watch.runs_);
  }
  void check(StateReader& from) const { runs_.check(from); }

 private:
  static constexpr std::uint64_t kFewest = 6, kEnough = 4096;
  bool has_chance_lines() const;
  void take(double x, bool direct, std::uint64_t at);
  void push(std::span<const double> x,
            const unsigned char* starts,
            std::size_t i,
            std::uint64_t at);

  std::uint64_t n_ = 0;
  double before_ = 0, last_ = 0;   ///< the last two samples
  double first_ = 0, second_ = 0;  ///< the first two
  bool pair_ = false;              ///< the last one follows directly on that before
  bool direct_ = false;            ///< the second one on the first
  bool coarse_ = false;  ///< steps of a coarse grid are alike by chance: nothing is told from it
  FlagRuns runs_{kFewest};
};

}  // namespace libchar::detail
