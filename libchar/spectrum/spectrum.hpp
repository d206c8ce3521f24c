#pragma once
// A spectrum: its sides, scaling, bins and their degrees of freedom.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/numeric/interval.hpp"

namespace libchar {
// Window functions.

enum class Window {
  hann,
  rectangular,
  blackman_harris,
  flat_top,
  hann_nonzero
};  ///< periodic, but hann_nonzero = MATLAB's hanning

template <>
inline constexpr auto enum_table<Window> = enum_words<Window, "hann rectangular blackman_harris flat_top hann_nonzero">;

std::vector<double> window_values(Window window, std::size_t n);

enum class Sides { one, two };
enum class Scaling { psd, ps, lsd, ls };  ///< U²/Hz, U², U/√Hz, U

template <>
inline constexpr auto enum_table<Sides> = enum_words<Sides, "one two">;
template <>
inline constexpr auto enum_table<Scaling> = enum_words<Scaling, "psd ps lsd ls">;

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
  /// degrees of freedom per bin (overlap correlation included; half at DC and Nyquist)
  std::vector<double> dof;
  /// Correlation of a bin's power with that 1, 2, … bins away, for white noise: what an average
  /// over bins must account for.
  std::vector<double> neighbour_correlation;
  std::vector<std::string> notes;
};

// How well a bin of a spectrum is known.

/// Chi-square interval of an average of powers with `dof` degrees of freedom, as multiples of the average.
std::pair<double, double> interval_factors(double dof, double confidence);

/// The same for one confidence, each number of degrees of freedom computed once: bins and channels
/// share most of them, and a quantile costs more than anything else that is written of a bin.
class IntervalFactors {
 public:
  explicit IntervalFactors(double confidence) : confidence_(confidence) {}
  std::pair<double, double> of(double dof);
  /// Interval of bin i of a density (for lsd, ls: of the root).
  std::pair<double, double> interval(const Spectrum& spectrum, std::size_t i);

 private:
  double confidence_;
  std::unordered_map<double, std::pair<double, double>> known_;
};

/// That of every bin; none where its degrees of freedom are not known.
std::vector<std::optional<Interval>> spectrum_intervals(const Spectrum& spectrum, IntervalFactors& factors);
std::vector<std::optional<Interval>> spectrum_intervals(const Spectrum& spectrum, double confidence);

// Spectra on a logarithmic frequency axis.

/// The spectrum averaged into bins of equal width on a logarithmic frequency axis, degrees of
/// freedom summed; at most `bins`.
Spectrum log_binned(const Spectrum& spectrum, std::size_t bins);

// Spectral lines.

struct SpectralLine {
  double frequency_hz = 0;
  double amplitude = 0;  ///< of the sine, in U (peak, not rms)
  double excess = 0;     ///< power above the local floor, in multiples of the floor
  double width_hz = 0;   ///< at half the excess
};

/// The grid of the values of a record, and the noise that blurs it.
struct Quantization {
  double step = 0;      ///< LSB; 0: no grid
  double noise_sd = 0;  ///< of the noise from sample to sample, before rounding
};

/// From the LSB and the standard deviation of first differences of the rounded record.
Quantization quantization_of(double step, double difference_sd);

/// Narrow lines that exceed the local median floor with a false-alarm probability below
/// `alarm` over the whole spectrum. Those that rounding may have made are not among them.
std::vector<SpectralLine> find_lines(const Spectrum& spectrum, double alarm = 1e-3,
                                     const Quantization& quantization = {});

}  // namespace libchar
