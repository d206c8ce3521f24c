#pragma once
// A bank of cumulative sums of log-likelihood ratios (Page 1954; Lorden 1971: no test of one false alarm in e^h samples
// answers sooner), for each sensor one row a kind and a size of fault. z is the sensor's residual in units of its
// expected deviation, u the fused input in units of its own deviation, w = 1 (0: no sample here, nothing happens):
//
//   bias  t   mean of z becomes t          S <- max(0, S + t z - t^2/2 w)
//   gain  t   mean of z becomes t u        S <- max(0, S + t u z - t^2/2 u^2)
//   noise k   deviation of z becomes k     S <- max(0, S + (1 - 1/k^2)/2 z^2 - ln k w)
//
// Sizes stand half an octave to an octave apart: between two of them at most a tenth of the rate at which
// evidence gathers is lost. A ramp is a bias that grows.

#include <array>
#include <cstddef>
#include <vector>

#include "libchar/fusion/fault_log.hpp"

namespace libchar::fusion {

/// What a row of the bank asks.
enum class CusumInput { bias, gain, noise };

/// One instant of all sensors, an array each, `padded` long (rest zero).
struct CusumSample {
  std::vector<double> z, present;  ///< bias: t z - t^2/2 present
  std::vector<double> uz, uu;      ///< gain
  std::vector<double> zz;          ///< noise, with `present`
  explicit CusumSample(std::size_t padded)
      : z(padded, 0), present(padded, 0), uz(padded, 0), uu(padded, 0), zz(padded, 0) {}
};

class CusumBank {
 public:
  explicit CusumBank(std::size_t sensors);

  static constexpr std::size_t kRows = 20;
  /// Rows of an input; they stand one input after the other.
  static constexpr int rows(int input) { return input < 2 ? 8 : 4; }
  static CusumInput input(std::size_t row);

  /// Takes in an instant; the largest of all sums.
  double step(const CusumSample& sample);
  /// The largest sum of each sensor after the last step.
  const std::vector<double>& all_tops() const { return top_; }
  double top(std::size_t i) const { return top_[i]; }
  /// The row of a sensor's largest sum.
  CusumInput leading(std::size_t i) const;
  void reset();
  void reset(std::size_t i);

  std::size_t padded() const { return padded_; }
  static std::size_t padded(std::size_t n) { return (n + 3) / 4 * 4; }

 private:
  /// Four sensors beside each other, row after row, then the next four.
  static std::size_t place(std::size_t row, std::size_t i) { return (i / 4 * kRows + row) * 4 + i % 4; }

  std::size_t sensors_, padded_;
  std::vector<double> sums_;
  std::vector<double> top_;
};

}  // namespace libchar::fusion
