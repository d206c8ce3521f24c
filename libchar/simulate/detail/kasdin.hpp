#pragma once
// The truncated recursive filter of flicker, for comparison (Kasdin 1995, [RV 1.19-1.28]).

#include <cstddef>
#include <span>
#include <vector>

namespace libchar {

/// x_t = w_t - sum_{k=1}^{taps} b_k x_{t-k} from rest, block by block: `rv-truncated-iir`. b are
/// the coefficients of (1 - z^-1)^(1/2): b_0 = 1, b_k = b_{k-1} (k - 3/2)/k. Below some 1/(taps)
/// cycles per sample its spectrum is flat, not 1/f.
class TruncatedKasdin {
 public:
  explicit TruncatedKasdin(std::size_t taps);
  /// Replaces driving deviates by the output.
  void run(std::span<double> values);

 private:
  std::vector<double> reversed_;  ///< -b_taps ... -b_1
  std::vector<double> past_;      ///< outputs, oldest first, in a window that slides over a buffer
  std::size_t at_ = 0;            ///< where the window begins
};

}  // namespace libchar
