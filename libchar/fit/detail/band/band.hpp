#pragma once
// Over which frequencies the noise terms, times a shape, describe a record.

#include <optional>
#include <vector>

#include "libchar/core/coefficient.hpp"
#include "libchar/core/numeric/noise_shape.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"
#include "libchar/fit/detail/band/low_pass.hpp"
#include "libchar/fit/detail/band/named_shape.hpp"
#include "libchar/fit/detail/band/small_shape.hpp"

namespace libchar {

inline constexpr int kMany = 3;  ///< coefficients of a polynomial that stand for a filter with a corner

/// White noise and slow noise of one exponent, in units of `with_law`.
struct SlowLaw {
  double exponent = 1;
  double white = 0, level = 0;
  Mixture theta() const { return {white, 0, 0, 0, level}; }
};

/// Bins, the shape that multiplies their expectations, and how well that describes them.
struct Band {
  double top_hz = 0;                   ///< bins end here; half the rate where nothing is left out
  double bottom_hz = 0;                ///< and begin here: below is a hump that no noise term describes; 0: all do
  std::vector<char> inside;            ///< of every bin: is it fitted?
  NoiseShape filter;                   ///< a filter known by name (boxcar, Bartlett), or none
  int orders = 0;                      ///< of the polynomial of the shape beyond that, or unknowns of `named`
  NamedShape named;                    ///< a filter or loop with a low corner in its place
  std::vector<Resonance> resonances;   ///< left out, but for their skirts, which are among the unknowns
  bool quantized = false;              ///< quantization noise is among the terms
  std::optional<LowPassFit> low_pass;  ///< a first-order low-pass as well
  /// correlation time of a Gauss-Markov process that is among the terms, in the column of the ramp
  std::optional<double> tau_s;
  std::optional<double> faster_s;  ///< the same of a second, faster one, in the column of quantization noise
  std::optional<SlowLaw> law;      ///< what the terms stand in for
  SmallShape small;                ///< of the top, too small for the tests; where nothing else shapes it freely
  std::vector<NamedShape> hidden;  ///< a shelf, echo or high-pass that is likelier than nothing, too little to be taken
  bool doubtful_end = false;       ///< a high-pass explains what the terms do not, and so may a process
  bool passes = true;              ///< the residuals are those of noise, or too few to judge
  Goodness goodness;               ///< of the band, its slowest coefficients left out
  Goodness top;                    ///< of its top octave and a half
};

struct BandOptions {
  double probability = 0.02;            ///< of more chi-square than in the residuals, below which a band does not pass
  double probability_unshaped = 0.005;  ///< the same for the whole spectrum without a shape: 1 % of clean records fail
  double misfit = 1e-3;                 ///< from here on the whole spectrum is cut at most by two octaves
  double clear_misfit = 1e-6;           ///< and from here on by three: its misfit is said, and widens the intervals
  int most_orders = 4;
  std::optional<double> tau_s;  ///< a Gauss-Markov process of this correlation time is offered
  bool small_shapes = false;    ///< the top may have a shape that is too small for the tests
  bool corners = false;         ///< shelves, echoes and peaks are looked for: not of a clock, whose noise rises
  double high_pass = 1.5;       ///< deviate from which on a high-pass is looked for
  double shelf = 3.9;           ///< deviate of a directed test from which on a shelf is looked for
  double echo = 4.5;            ///< the same of 31 tests for an echo
  double hint_of_echo = 3.3;    ///< the same from which on an interval has to know of it
  double step = 2.1;            ///< the same from which on an interval has to know of one, of ten that are tested
  double peak = 5.5;            ///< standard deviations of a broad peak from which on it is a resonance
  double seen = 3;              ///< standard deviations of such a shape from which on a filter with a name is tried
};

/// Of its shape.
std::size_t unknowns_of(const Band& band);

/// Every bin, without a shape.
Band whole_band(const std::vector<PowerBin>& bins, double rate_hz);

/// The widest band, from the slow end up, in which the residuals are those of noise, and in it the fewest orders of the
/// polynomial, plus one. Broad peaks are left out where that widens it.
Band find_band(const std::vector<PowerBin>& bins, double rate_hz, const TermSet& terms,
               const BandOptions& options = {});

/// N is white noise below the zero and the pole of a shelf or loop: where slow noise is above it there, a rise is a
/// departure of the slow noise from its terms (another exponent, processes), and N would be read off an extrapolation.
/// Of a fall both levels are said.
bool shows_white_below(const std::vector<PowerBin>& bins, const NamedShape& shape, const Mixture& theta);

/// A band with the judgement of its residuals; nothing where it has too few bins.
std::optional<Band> judged(const std::vector<PowerBin>& bins, double rate_hz, const TermSet& terms, const Band& band);

/// A band with the shelf that `start` leads to, judged.
std::optional<Band> with_shelf(const std::vector<PowerBin>& bins, double rate_hz, const TermSet& terms,
                               const Band& band, const NamedShape& start);

/// The bins of a band, expectations times its filter.
std::vector<PowerBin> bins_of(const std::vector<PowerBin>& bins, const Band& band, double rate_hz);

/// Their likelihood, with the polynomial or, around its maximum, the unknowns of the named shape free.
BinProblem band_problem(const std::vector<PowerBin>& bins, const Band& band, double rate_hz);

/// The bins with the law in the column of the ramp.
std::vector<PowerBin> with_law(std::vector<PowerBin> bins, const SlowLaw& law);

/// ln of what the named and the small shape of a band make of a bin.
double band_log_gain(const Band& band, const PowerBin& bin, double rate_hz);

/// Expectations times a ratio averaged over each bin.
std::vector<PowerBin> filtered(std::vector<PowerBin> bins, const NoiseShape& filter, double rate_hz);

}  // namespace libchar
