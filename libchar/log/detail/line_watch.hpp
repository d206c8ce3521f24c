#pragma once
// Samples on straight lines: gaps that somebody has filled, and slow channels that were resampled by interpolation.

#include <cstdint>
#include <span>

#include "libchar/log/detail/flag_runs.hpp"

namespace libchar::detail {

/// How straight: a tenth leaves room for the last digit, and 1.8 % of the samples of white noise pass (the ratio of its
/// steps is Cauchy about -1/2 with the scale sqrt(3)/2); a thousandth needs digits, and tells lines of two steps.
constexpr double kStraight = 0.1, kExactly = 1e-3;
/// For the square of the next bend over that of the step: a little wider than `on_line`.
constexpr double kAboutStraight = 1.001 * kStraight * kStraight;

/// The step to `c` goes on as that to `b`, within this share of it.
inline bool on_line(double a, double b, double c, double share) {
  const double step = b - a, bend = (c - b) - step;
  return step != 0 && bend * bend <= share * share * (step * step);
}

class LineWatch {
 public:
  static constexpr std::size_t kStretch = 256;  ///< samples that are passed over or looked at together
  /// `starts`: samples that do not follow the one before directly; null: all do. `at`: index of x[0] in the record.
  /// `pairs`: bits of the stretches that may have two flags in a row, the last flag before each among them. `repeats`:
  /// samples so far that equal the one before.
  void block(std::span<const double> x, const unsigned char* starts, std::uint64_t at, std::uint32_t pairs = ~0U,
             std::uint64_t repeats = 0);
  /// `direct`: the first sample of `later` follows directly. `at`: its part's begin in the record.
  void join(const LineWatch& later, bool direct, std::uint64_t at);

  /// Lines that chance does not give in this record, those of the kind that has more samples on them.
  struct Found {
    std::uint64_t least_run = 0;  ///< flags in a row; 0: there are none
    const FlagRuns* runs = nullptr;
    double alone = 0;    ///< samples half-way between their neighbours, by the stretches that were looked at
    bool apart = false;  ///< throughout, and the others are not straight at all: resampled by straight lines
  };
  /// `grid`: step of the values over the deviation of their differences; 0: there is none. `repeats`: as of `block`.
  Found found(double grid, std::uint64_t repeats = 0) const;
  /// Shorter runs of flags are told by exact lines.
  static constexpr std::uint64_t kFewest = 6;

  static void layout(auto& at, auto& watch) {
    at.group("lines of a channel", watch.n_, watch.looked_, watch.before_, watch.last_, watch.first_, watch.second_);
    at(watch.pair_, watch.direct_, watch.coarse_);
    FlagRuns::layout(at, watch.runs_);
    FlagRuns::layout(at, watch.exact_);
  }
  void check(StateReader& from) const {
    runs_.check(from);
    exact_.check(from);
  }

 private:
  static constexpr std::uint64_t kEnough = 4096;
  std::uint64_t least_run() const;
  std::uint64_t least_exact_run() const;
  double alone(double grid) const;
  bool are_apart(std::uint64_t repeats) const;
  void flag(double a, double b, double c, bool whole, std::uint64_t at);
  bool has_chance_lines(std::uint64_t repeats) const;
  void take(double x, bool direct, std::uint64_t at);
  /// Samples without a flag that counts, and those of x[from..to), where each is looked at.
  void pass(std::uint64_t n);
  void look(std::span<const double> x, const unsigned char* starts, std::size_t from, std::size_t to, std::uint64_t at);

  std::uint64_t n_ = 0, looked_ = 0;  ///< looked_: not passed over, as stretches without two flags in a row are
  double before_ = 0, last_ = 0;      ///< the last two samples
  double first_ = 0, second_ = 0;     ///< the first two
  bool pair_ = false;                 ///< the last one follows directly on that before
  bool direct_ = false;               ///< the second one on the first
  bool coarse_ = false;               ///< steps of a coarse grid are alike by chance: nothing is told from it
  /// Of either straightness; a run of one flag may be left out.
  FlagRuns runs_{kFewest}, exact_{2};
};

}  // namespace libchar::detail
