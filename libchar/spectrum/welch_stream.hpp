#pragma once
// Welch's method on a stream, for a fixed segment length.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libchar/spectrum/welch.hpp"

namespace libchar {

/// Hears of every half segment of a stream, in order.
class HalfListener {
 public:
  /// True asks for the squares of the half's orthonormal DCT-II (never given when it is not whole).
  virtual bool half(std::span<const double> samples, bool whole) = 0;

 protected:
  ~HalfListener() = default;
};

/// The same, streaming, for a fixed segment length (options.segment > 0): the same bits however the
/// samples are pushed, in the memory of a few segments. `finish` throws Error(numeric) when no
/// whole segment was seen, and may be called at any time.
class WelchStream {
 public:
  explicit WelchStream(const WelchOptions& options);
  ~WelchStream();
  WelchStream(WelchStream&&) noexcept;
  WelchStream& operator=(WelchStream&&) noexcept;
  void push(std::span<const double> samples, HalfListener* listener = nullptr);
  /// No more samples come: the listener hears of a half that waited for its partner.
  void end(HalfListener* listener);
  Spectrum finish(double rate_hz) const;

  /// Samples of half a segment when the spectrum goes by halves, each transformed once: then the
  /// block cosine transform of a half costs next to nothing. 0: it does not, and no listener hears
  /// anything.
  std::uint64_t half() const;
  /// Sums of c_k^2 over the halves that a listener asked for; k = 0 is not filled.
  std::vector<double> block_power() const;
  /// Samples after the last half that a listener heard of.
  std::span<const double> rest() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace libchar
