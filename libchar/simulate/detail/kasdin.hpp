#pragma once
// Fractional differencing as published (Kasdin 1995, [RV 1.19-1.28]): coefficients for any slope,
// exact linear filtering of a whole record, and the truncated recursive filter for comparison.

#include <cstddef>
#include <span>
#include <vector>

namespace libchar {

/// Largest number of samples that the exact convolution takes (it keeps some 50 bytes a sample).
inline constexpr std::size_t kLongestConvolution = std::size_t{1} << 28U;

/// Moving-average coefficients of (1 - z^-1)^(-gamma/2), spectrum 1/f^gamma: h_0 = 1, h_k =
/// h_{k-1} (k - 1 + gamma/2)/k. 0 <= gamma <= 2, else Error(usage).
std::vector<double> kasdin_response(double gamma, std::size_t count);

/// Coefficients of (1 - z^-1)^(gamma/2): b_0 = 1, b_k = b_{k-1} (k - 1 - gamma/2)/k.
std::vector<double> kasdin_recursion(double gamma, std::size_t count);

/// The record x = h * w that starts from nothing: linear convolution, no wrap-around, no truncation
/// (gamma = 2: running sum, gamma = 0: the record itself).
std::vector<double> kasdin_filter(double gamma, std::span<const double> driving);

/// x_t = w_t - sum_{k=1}^{taps} b_k x_{t-k} from rest, block by block: `rv-truncated-iir`. Below
/// some 1/(taps) cycles a sample its spectrum is flat, not 1/f^gamma.
class TruncatedKasdin {
 public:
  TruncatedKasdin(double gamma, std::size_t taps);
  /// Replaces driving deviates by the output.
  void run(std::span<double> values);

 private:
  std::vector<double> reversed_;  ///< -b_taps ... -b_1
  std::vector<double> past_;      ///< outputs, oldest first, in a window that slides over a buffer
  std::size_t at_ = 0;            ///< where the window begins
};

}  // namespace libchar
