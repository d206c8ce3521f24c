#pragma once
// What welch() and WelchStream share: one segment at a time into a sum of power, and the sum into a spectrum.

#include <complex>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "libchar/spectrum/detail/half_rows.hpp"
#include "libchar/spectrum/detail/half_segments.hpp"
#include "libchar/spectrum/fft.hpp"
#include "libchar/spectrum/spectrum.hpp"
#include "libchar/spectrum/welch.hpp"
#include "libchar/spectrum/welch_sums.hpp"

namespace libchar::welch_detail {

inline constexpr std::uint64_t kShortestSegment = 8;
inline constexpr std::uint64_t kLongestSegment = std::uint64_t{1} << 32U;

/// Lengths of a segmentation. Segments start at 0, hop, 2 hop, …; every `group` of them (an even
/// number: halves go in pairs) are summed from zero and the sums of the groups added in order, so
/// that the bits do not depend on which thread did which group, nor on how samples were pushed.
struct Layout {
  std::size_t segment = 0, hop = 0, group = 0;
  std::uint64_t count(std::uint64_t samples) const { return samples < segment ? 0 : (samples - segment) / hop + 1; }
};

Layout layout_of(std::uint64_t segment, double overlap);
/// Throws Error(usage) when options are impossible.
void check_options(const WelchOptions& options);
void check_rate(double rate_hz);  ///< Error(numeric) unless finite and above 0

/// Says in `notes` that segments were dropped, where some were.
void note_dropped(std::uint64_t dropped, std::uint64_t used, std::vector<std::string>& notes);

/// Detrend, window, transform.
class Periodogram {
 public:
  Periodogram(const WelchOptions& options, const std::vector<double>& window);
  /// Adds |X_k|^2 of the segment to `power` (n/2 + 1 values); false, and nothing added, when a sample is missing.
  bool add(const double* x, double* power);
  /// X_0 … X_{n/2} of the segment, valid until the next call; none when a sample is missing.
  std::span<const std::complex<double>> transform(const double* x);

 private:
  Detrend detrend_;
  const std::vector<double>& window_;
  RealFft fft_;
};

/// Sums over the segments seen so far, in their order.
class Average {
 public:
  Average(const WelchOptions& options, const Layout& layout);
  Average(const WelchOptions& options, const Layout& layout, const WelchSums& sums);
  void add_group(const std::vector<double>& power);
  void add_group(std::vector<double>&& power);  ///< the first, of a long segment, without a copy
  void note_segment(bool used);                 ///< in the order of the segments
  /// Looks until two of the samples differ by more than the root of the smallest power.
  void note_samples(std::span<const double> samples);
  std::uint64_t used() const { return used_; }
  std::uint64_t dropped() const { return dropped_; }
  /// Degrees of freedom of the average of the segments so far, at a bin that is neither the first nor the last.
  double degrees_of_freedom(const std::vector<double>& window) const;
  /// What was found of a part of a record, without the samples at its ends.
  WelchSums sums() const;
  /// The segments that straddle the end of the part so far, each used or not, and those of the part
  /// behind it. `power`: of the former.
  void join(const std::vector<double>& power, std::span<const char> straddling, const WelchSums& later);
  /// No window: the periodic Hann window, half overlapping. Throws Error(numeric) where the powers
  /// are no numbers, or too small for one and the samples not constant.
  Spectrum spectrum(const std::vector<double>& window, double rate_hz) const;
  /// The same of a record that came piece by piece: Error(numeric) where no whole segment was in
  /// its `samples`, and a note where some were dropped.
  Spectrum finish(const std::vector<double>& window, double rate_hz, std::uint64_t samples) const;

 private:
  void check_powers() const;
  WelchOptions options_;
  Layout layout_;
  std::vector<double> power_;         // none before the first group
  std::vector<char> recent_;          // ring: was the segment used
  std::vector<unsigned char> begin_;  // the same of the first ones
  std::vector<std::uint64_t> pairs_;  // [lag]: pairs of used segments so many hops apart
  std::size_t next_ = 0;
  std::uint64_t used_ = 0, dropped_ = 0;
  double first_ = std::numeric_limits<double>::quiet_NaN();
  bool moves_ = false, moves_little_ = false;
};

// How long the segments of a record are.

/// A quarter of the record as in [RV app. A], or what the caller asked for; halved until enough
/// segments are whole, which is noted. Throws Error(numeric) where none of 8 samples is.
std::uint64_t choose_segment(std::span<const double> record, const WelchOptions& options,
                             std::vector<std::string>& notes);

}  // namespace libchar::welch_detail

// What is kept from one Welch spectrum to the next: halves of one length and a sum to go with each.

namespace libchar {

struct WelchWorkspace::State {
  struct Piece {
    HalfSegments halves;
    HalfSegments::SumsPointer sums;
  };
  half_segments::RowPools pools;

  Piece take(std::size_t segment);
  void give_back(Piece piece);

 private:
  std::mutex mutex_;
  std::vector<Piece> idle_;
};

}  // namespace libchar
