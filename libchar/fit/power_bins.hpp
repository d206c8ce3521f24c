#pragma once
// Squared DCT-II coefficients of a record in logarithmic bins.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "libchar/core/noise_terms.hpp"
#include "libchar/core/shared_blocks.hpp"

namespace libchar {

/// A bin of mean squared DCT-II coefficients and its expectation per unit theta: all the likelihood needs.
struct PowerBin {
  double frequency_hz = 0;  ///< centre
  double energy = 0;        ///< mean of c_k² (per-sample variance scale: white noise gives Q² fs)
  double dof = 0;           ///< number of coefficients averaged
  std::array<double, kTerms> unit{};  ///< E[energy] for theta_term = 1
  double low_hz = 0, high_hz = 0;     ///< edges
  /// its coefficients first..end-1 of a transform of `length` means of `spacing` samples
  std::uint64_t first = 0, end = 0, length = 0, spacing = 1;
};

struct PooledPower;

/// Bins without the coefficients of spectral lines.
struct ClippedBins {
  std::vector<PowerBin> bins;
  std::vector<PowerBin> all;  ///< with every coefficient; empty when none was left out
  std::uint64_t clipped = 0;  ///< coefficients left out
};

/// Squared DCT-II coefficients of a record as log bins; streaming in constant memory for long records: blocks of `block`
/// samples are transformed one by one (k >= 1) and their means as one more series (docs/theory/fit.md). A record of at most
/// `block` samples gets one exact DCT. Missing samples: short ones are closed up (concatenated), at a long gap a new record
/// starts and likelihoods add.
class PowerBinner final : public BlockTaker {
 public:
  /// Blocks that somebody else may transform: long enough for their sixteen coefficients left to the series of means to be few,
  /// short enough for many of them in a record.
  static bool suits(std::uint64_t block);

  explicit PowerBinner(std::uint64_t block = std::uint64_t{1} << 16U);
  /// One that has seen a record elsewhere, of which these are the powers (power_sums.hpp).
  explicit PowerBinner(std::vector<PooledPower> powers);
  ~PowerBinner() override;
  PowerBinner(PowerBinner&&) noexcept;
  PowerBinner& operator=(PowerBinner&&) noexcept;
  void push(std::span<const double> samples) override;
  bool take_block(std::span<const double> samples) override;
  void take_power(std::vector<double> power) override;
  std::vector<PowerBin> finish(double rate_hz) const;
  /// Same after clipping spectral lines: coefficients beyond 32 × the local median are left out.
  ClippedBins finish_clipped(double rate_hz) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace libchar
