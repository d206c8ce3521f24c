#pragma once
// What a fit says of a record: coefficients with their intervals, the band they come from, and whatever else was found.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libchar/core/coefficient.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/core/numeric/interval.hpp"
#include "libchar/core/numeric/noise_shape.hpp"
#include "libchar/fit/record/power_bins.hpp"
#include "libchar/fit/signs/event.hpp"
#include "libchar/fit/signs/stationarity.hpp"
#include "libchar/fit/signs/temperature.hpp"

namespace libchar {

/// A bin of squared transform coefficients (or a point of a curve) against the model, for residual plots.
struct FitResidual {
  double frequency_hz = 0;  ///< or tau_s for a fit of an Allan curve
  double measured = 0;      ///< two-sided density (or Allan deviation)
  double model = 0;
  double dof = 0;
  double z = 0;        ///< residual as a standard normal deviate
  bool inside = true;  ///< of the band that is fitted
};

/// Covariance-weighted fit of the Allan curve, the second opinion.
struct SecondOpinion {
  std::array<std::optional<double>, kTerms> value;
  std::array<double, kTerms> sd{};
  Goodness goodness;
  bool agrees = true;    ///< every detected term within 3 combined sd
  std::string sentence;  ///< what disagrees, or "agrees"
};

/// What was done to the data before the fit, because an alarm asked for it.
struct Remedy {
  std::string kind;    ///< "spikes", "lines", "ramp", "lowest_bins", "band", "shape", "bandwidth", "quantization"
  std::string alarm;   ///< the figure that asked ("kurtosis of differences 29.8 > 3.2")
  std::string action;  ///< what was done ("212 samples replaced by the mean of their neighbours")
  std::uint64_t count = 0;
};

/// Over which frequencies the noise terms, times the shape, describe the record: all coefficients come from there.
struct FitBand {
  double top_hz = 0;                  ///< upper end; half the rate unless something is left out above
  bool whole = true;                  ///< every bin is inside
  int orders = 0;                     ///< of the polynomial of the shape inside (docs/theory/fit.md)
  std::vector<Interval> left_out_hz;  ///< below the upper end: broad peaks, the slowest coefficients
};

/// A first-order Gauss-Markov process (model/sensor_model.hpp) in the record.
struct GaussMarkovFit {
  Coefficient sigma;  ///< standard deviation, in the channel's unit
  Coefficient tau_s;  ///< correlation time; an interval without an upper end is infinite
  /// false: looked for and not needed. Undetermined: with white noise alone it is as likely as the terms, which are the
  /// model.
  bool in_model = true;
};

struct NoiseFit {
  Coefficients term;  ///< indexed by Term
  FitBand band;
  NoiseShape
      shape;  ///< what multiplies the terms' density: of a filter inside the band, of whatever was measured outside
  std::optional<double> bandwidth_hz;  ///< corner of the first-order low-pass, when it was needed
  std::optional<Interval> bandwidth_ci95;
  std::optional<GaussMarkovFit> gauss_markov;
  /// of a clock: F of flicker phase noise, y_t = F (x_t - x_{t-1})/dt with x unit flicker (power_laws.hpp)
  std::optional<Coefficient> flicker_phase;
  Mixture theta{};  ///< squared coefficients used for drawing curves and for edf (0 = absent)
  /// density that rounding adds to the terms and their shape, U²·s: neither in theta nor in N (signs/rounding.hpp)
  double rounding = 0;
  /// of ln(theta) of the terms with a value
  std::array<std::array<double, kTerms>, kTerms> covariance{};
  Goodness goodness;
  std::optional<SecondOpinion> second_opinion;
  std::vector<Remedy> remedies;
  std::vector<Event> events;       ///< steps, a warm-up, a ramp: means, taken out before the noise was fitted
  std::vector<Event> cycles;       ///< of the surroundings, taken out as well: no part of the model
  std::vector<Interval> moving_s;  ///< stretches of motion or handling, where somebody has looked (motion.hpp)
  std::optional<TemperatureEffect> temperature;  ///< where a temperature was given
  Stationarity stationarity;                     ///< of a record that is kept; not tested of one that streams
  std::vector<FitResidual> residuals;
  std::vector<PowerBin> bins;     ///< what was fitted, for one likelihood of many records (pooled_fit.hpp)
  std::vector<Finding> findings;  ///< of the fit, apart from the coefficients
  struct Search {
    std::string method;  ///< "DCT-II Whittle likelihood, 128 bins" …
    bool converged = true;
    int iterations = 0;
  };
  Search search;  ///< for the likeliest coefficients
  double rate_hz = 0;
  double duration_s = 0;
  std::uint64_t samples = 0;
  const Coefficient& operator[](Term t) const { return term[static_cast<std::size_t>(t)]; }
};

}  // namespace libchar
