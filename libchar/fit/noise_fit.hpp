#pragma once
// Noise coefficients of a record with honest uncertainties. Theory and figures: shared/reference/accuracy.md, docs/theory.

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/allan/allan_covariance.hpp"
#include "libchar/allan/allan_deviation.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/spectrum/spectrum.hpp"

namespace libchar {

enum class Status {
  detected,      ///< value and interval
  not_detected,  ///< likelihood ratio below the threshold: no value, only `upper95`
  undetermined,  ///< present alone or with another term, but the record cannot tell them apart: value and wide interval
  given,         ///< not fitted but stated by somebody (models only)
  not_fitted,    ///< the term was not part of the model that was asked for
};
std::string_view name_of(Status status);

/// One coefficient (not squared), in the channel's unit times the unit of core/units.hpp's term_unit.
struct Coefficient {
  Status status = Status::not_fitted;
  std::optional<double> value;  ///< nothing when not detected
  Interval ci95;                ///< low = 0 when it reaches zero; meaningful when there is a value
  double relative_sd = 0;       ///< standard deviation / value, from the fit's covariance
  bool profile = false;  ///< ci95 by profile likelihood (relative_sd > 15 %), else log-normal Wald
  std::optional<double> upper95;  ///< one-sided upper 95 % limit when there is no value
  double likelihood_ratio = 0;    ///< 2 (lnL with - lnL without)
  std::optional<double> bound;    ///< Cramér–Rao bound at the fit, relative sd
  std::optional<double> seconds_for_10_percent;  ///< record length at which the bound is 10 %
};

struct Goodness {
  double chi2 = 0;
  double dof = 0;
  double p = 1;
};

/// A bin of squared transform coefficients (or a point of a curve) against the model, for residual plots.
struct FitResidual {
  double frequency_hz = 0;  ///< or tau_s for a fit of an Allan curve
  double measured = 0;      ///< two-sided density (or Allan deviation)
  double model = 0;
  double dof = 0;
  double z = 0;  ///< residual as a standard normal deviate
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
  std::string kind;    ///< "spikes", "lines", "ramp", "lowest_bins", "bandwidth", "quantization"
  std::string alarm;   ///< the figure that asked ("kurtosis of differences 29.8 > 3.2")
  std::string action;  ///< what was done ("212 samples replaced by the mean of their neighbours")
  std::uint64_t count = 0;
};

struct NoiseFit {
  std::array<Coefficient, kTerms> term;  ///< indexed by Term
  std::optional<double> bandwidth_hz;    ///< corner of the first-order low-pass, when it was needed
  std::optional<Interval> bandwidth_ci95;
  Mixture theta{};  ///< squared coefficients used for drawing curves and for edf (0 = absent)
  std::array<std::array<double, kTerms>, kTerms>
      covariance{};  ///< of ln(theta) of the terms with a value
  Goodness goodness;
  std::optional<SecondOpinion> second_opinion;
  std::vector<Remedy> remedies;
  std::vector<FitResidual> residuals;
  std::vector<std::string>
      sentences;  ///< for people: "the record cannot tell bias instability from random walk…"
  std::string method;  ///< "DCT-II Whittle likelihood, 128 bins" …
  bool converged = true;
  int iterations = 0;
  double rate_hz = 0;
  double duration_s = 0;
  std::uint64_t samples = 0;
  const Coefficient& operator[](Term t) const { return term[static_cast<std::size_t>(t)]; }
};

struct FitOptions {
  std::array<bool, kTerms> terms = {
      true,
      true,
      true,
      false,
      false};  ///< offered from the start; quantization and ramp are added on alarm
  bool remedies =
      true;  ///< automatic spikes/lines/ramp/lowest-bin/bandwidth/quantization remedies, each only on its alarm
  double threshold = 5.41;  ///< likelihood-ratio threshold of presence (1 % under ½χ²₀+½χ²₁)
  double profile_above = 0.15;  ///< profile-likelihood interval when the relative sd exceeds this
  bool second_opinion = true;   ///< covariance-weighted Allan fit beside the first
  AllanCovarianceCache* covariances =
      nullptr;  ///< shared by the channels of one log; none: prepared for each fit
  int threads = 1;
};

/// A bin of mean squared DCT-II coefficients and its expectation per unit theta: all the likelihood needs.
struct PowerBin {
  double frequency_hz = 0;  ///< centre
  double energy = 0;        ///< mean of c_k² (per-sample variance scale: white noise gives Q² fs)
  double dof = 0;           ///< number of coefficients averaged
  std::array<double, kTerms> unit{};  ///< E[energy] for theta_term = 1
  double low_hz = 0, high_hz = 0;     ///< edges
};

/// Squared DCT-II coefficients of a record as log bins; streaming in constant memory for long records: blocks of `block`
/// samples are transformed one by one (k >= 1) and their means as one more series (accuracy.md 1, 10). A record of at most
/// `block` samples gets one exact DCT. Missing samples: short ones are closed up (concatenated), at a long gap a new record
/// starts and likelihoods add.
class PowerBinner {
 public:
  explicit PowerBinner(std::uint64_t block = std::uint64_t{1} << 16U);
  ~PowerBinner();
  PowerBinner(PowerBinner&&) noexcept;
  PowerBinner& operator=(PowerBinner&&) noexcept;
  void push(std::span<const double> samples);
  /// A whole block, without missing samples, whose squared coefficients somebody else sums up: true. False, and nothing taken, when
  /// another block is under way: then push it.
  bool take_block(std::span<const double> samples);
  /// The sums of c_k^2 over those blocks, k = 0 … block-1, before `finish`.
  void set_taken_power(std::vector<double> power);
  std::vector<PowerBin> finish(double rate_hz) const;
  /// Same after clipping spectral lines: coefficients beyond 32 × the local median are left out; counts them.
  std::vector<PowerBin> finish_clipped(double rate_hz, std::uint64_t& clipped) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// The main fit: maximum Whittle likelihood on the bins, decisions, intervals, bounds. `allan` feeds the second opinion (may be null).
/// Throws Error(numeric) when there are fewer bins than terms.
NoiseFit fit_power_bins(const std::vector<PowerBin>& bins,
                        double rate_hz,
                        std::uint64_t samples,
                        const AllanCurve* allan,
                        const FitOptions& options = {});

/// The same on what a binner has seen, spectral lines clipped when remedies are on: the fit of a record that was streamed.
/// `samples` without the missing ones. Spikes need the samples: SpikeCleaner before the binner.
NoiseFit fit_binned(const PowerBinner& binner,
                    double rate_hz,
                    std::uint64_t samples,
                    const AllanCurve* allan,
                    const FitOptions& options = {});

/// Whole record in memory: bins, alarms, remedies, fit, second opinion.
NoiseFit fit_record(std::span<const double> record,
                    double rate_hz,
                    const AllanCurve* allan,
                    const FitOptions& options = {});

/// Fit of a curve alone (digitised from a data sheet or paper).
struct DigitisedCurve {
  bool is_allan = true;      ///< else a spectrum
  Sides sides = Sides::one;  ///< of a spectrum
  bool root = true;       ///< values are deviations / root densities (else variances / densities)
  std::vector<double> x;  ///< tau_s or frequency_hz, ascending
  std::vector<double> y;
  std::vector<double> relative_sd;   ///< of the deviation, if the curve has it; empty = unknown
  std::optional<double> duration_s;  ///< of the record behind the curve, gives honest weights
  std::optional<double> rate_hz;
};
NoiseFit fit_curve(const DigitisedCurve& curve, const FitOptions& options = {});

/// What a record of this length can give at best, before any fit, for assumed coefficients: relative sd per term (nothing if absent).
std::array<std::optional<double>, kTerms> cramer_rao(const Mixture& theta,
                                                     double rate_hz,
                                                     double samples,
                                                     const std::array<bool, kTerms>& fitted);

/// Spikes: 3-sample test y - (y₋+y₊)/2 beyond 6 MAD, local maximum, replaced by the mean of its neighbours. Returns the count.
std::uint64_t clean_spikes(std::span<double> record, double mad_limit = 6);

}  // namespace libchar
