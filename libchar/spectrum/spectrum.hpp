#pragma once
// Spectra of a record: Welch's method, scalings, log-frequency averaging, spectral lines.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

namespace libchar {

enum class Window {
  hann,
  rectangular,
  blackman_harris,
  flat_top,
  hann_nonzero
};  ///< periodic, but hann_nonzero = MATLAB's hanning
enum class Sides { one, two };
enum class Scaling { psd, ps, lsd, ls };  ///< U²/Hz, U², U/√Hz, U
enum class Detrend { none, constant, linear };

std::string_view name_of(Window window);
std::optional<Window> window_named(std::string_view name);
std::vector<double> window_values(Window window, std::size_t n);

/// What welch() works in, kept from one record to the next: for long segments it is as large as a
/// record, and new memory costs as much as a transform. Any number of threads may share it.
class SpectrumMemory {
 public:
  SpectrumMemory();
  ~SpectrumMemory();
  struct State;
  State& state() { return *state_; }

 private:
  std::unique_ptr<State> state_;
};

struct WelchOptions {
  Window window = Window::hann;
  std::uint64_t segment =
      0;                 ///< samples per segment; 0 = a quarter of the record as in [RV app. A]
  double overlap = 0.5;  ///< fraction of a segment, 0 <= overlap < 1
  Detrend detrend = Detrend::constant;
  Sides sides = Sides::one;
  Scaling scaling = Scaling::psd;
  int threads = 0;
  SpectrumMemory* memory = nullptr;  ///< none: memory of its own
};

struct Spectrum {
  Sides sides = Sides::one;
  Scaling scaling = Scaling::psd;
  Window window = Window::hann;
  double rate_hz = 1;
  std::uint64_t segment = 0;   ///< samples per segment as used
  std::uint64_t segments = 0;  ///< averaged (those that touch a missing sample are dropped)
  std::uint64_t dropped = 0;
  double enbw_hz = 0;                ///< equivalent noise bandwidth
  std::vector<double> frequency_hz;  ///< two-sided: from -f_Nyquist (excluded) to +f_Nyquist
  std::vector<double> value;
  std::vector<double>
      dof;  ///< degrees of freedom per bin (overlap correlation included; half at DC and Nyquist)
  /// Correlation of a bin's power with that 1, 2, … bins away, for white noise: what an average
  /// over bins must account for.
  std::vector<double> neighbour_correlation;
  std::vector<std::string> notes;
};

/// Welch's averaged modified periodogram. NaN = missing: segments that touch one are dropped; when
/// fewer than one whole segment is left the segment is shortened and a note says so. Throws
/// Error(numeric) when no segment of >= 8 samples is possible.
Spectrum welch(std::span<const double> record, double rate_hz, const WelchOptions& options = {});

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

/// Chi-square interval of an average of powers with `dof` degrees of freedom, as multiples of the
/// average.
std::pair<double, double> interval_factors(double dof, double confidence);

/// The same for one confidence, each number of degrees of freedom computed once: bins and channels
/// share most of them, and a quantile costs more than anything else that is written of a bin.
class IntervalFactors {
 public:
  explicit IntervalFactors(double confidence) : confidence_(confidence) {}
  std::pair<double, double> of(double dof);
  /// Interval of bin i, as spectrum_interval.
  std::pair<double, double> interval(const Spectrum& spectrum, std::size_t i);

 private:
  double confidence_;
  std::unordered_map<double, std::pair<double, double>> known_;
};

/// Chi-square interval of bin i of a density at the given confidence (for lsd, ls: of the root).
std::pair<double, double> spectrum_interval(const Spectrum& spectrum,
                                            std::size_t i,
                                            double confidence);

/// The spectrum averaged into bins of equal width on a logarithmic frequency axis, degrees of
/// freedom summed; at most `bins`.
Spectrum log_binned(const Spectrum& spectrum, std::size_t bins);

/// A log-frequency spectrum for display of a long record: short segments for high frequencies, long
/// ones for low ones.
Spectrum log_frequency_spectrum(std::span<const double> record,
                                double rate_hz,
                                Sides sides,
                                std::size_t bins);

struct SpectralLine {
  double frequency_hz = 0;
  double amplitude = 0;  ///< of the sine, in U (peak, not rms)
  double excess = 0;     ///< power above the local floor, in multiples of the floor
  double width_hz = 0;   ///< at half the excess
};

/// Narrow lines that stand out of the local median floor with a false-alarm probability below
/// `alarm` over the whole spectrum.
std::vector<SpectralLine> find_lines(const Spectrum& spectrum, double alarm = 1e-3);

}  // namespace libchar
