#pragma once
// Welch's averaged modified periodogram.

#include <cstdint>
#include <span>
#include <vector>

#include "libchar/core/hidden.hpp"
#include "libchar/spectrum/spectrum.hpp"

namespace libchar {

enum class Detrend { none, constant, linear };

template <>
inline constexpr auto enum_table<Detrend> = enum_words<Detrend, "none constant linear">;

/// What welch() and WelchStream work in, kept from one record to the next: for long segments it is as large as a
/// record, and new memory costs as much as a transform. Any number of threads may share it.
class WelchWorkspace {
 public:
  WelchWorkspace();
  struct State;
  State& state() { return *state_; }

 private:
  detail::Hidden<State> state_;
};

struct WelchOptions {
  Window window = Window::hann;
  /// samples per segment; 0 = a quarter of the record as in [RV app. A]
  std::uint64_t segment = 0;
  double overlap = 0.5;  ///< fraction of a segment, 0 <= overlap < 1
  Detrend detrend = Detrend::constant;
  Sides sides = Sides::one;
  Scaling scaling = Scaling::psd;
  int threads = 0;
};

/// Welch's averaged modified periodogram. NaN = missing: segments that touch one are dropped; when
/// fewer than one whole segment is left the segment is shortened and a note says so. Throws
/// Error(numeric) when no segment of >= 8 samples is possible. `workspace` none: memory of its own.
Spectrum welch(std::span<const double> record,
               double rate_hz,
               const WelchOptions& options = {},
               WelchWorkspace* workspace = nullptr);

/// The same, in less memory and by all threads where the segments are long: the record is used up.
Spectrum welch_using_up(std::vector<double> record,
                        double rate_hz,
                        const WelchOptions& options = {},
                        WelchWorkspace* workspace = nullptr);

/// Samples of a segment that lasts `seconds`. Throws Error(usage) when the rate is not known (0), or
/// the segment would be shorter than 8 samples.
std::uint64_t segment_samples(double seconds, double rate_hz);

}  // namespace libchar
