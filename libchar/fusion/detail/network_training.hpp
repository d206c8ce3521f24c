#pragma once
// Levenberg-Marquardt training of a tanh network on standardised data, from seeded starts.

#include <cstdint>
#include <vector>

#include "libchar/fusion/detail/tanh_network.hpp"

namespace libchar::fusion {

/// Consecutive instants: `count` rows of inputs + 1 values, the target last.
struct TrainingRows {
  const double* rows = nullptr;
  std::size_t count = 0;
};

struct TrainingPlan {
  std::size_t starts = 3;
  std::size_t iterations = 100;  ///< at most, a start
  std::uint64_t seed = 1;
  double relative_decrease = 1e-7;  ///< of the sum of squares, below which a training is over
  int patience = 5;  ///< iterations without a gain on the held-out rows before it is over
};

struct Training {
  std::vector<double> parameters;  ///< empty: no start gave finite numbers
  double held_out_square = 0;      ///< mean square of the error on the held-out rows
  int iterations = 0;              ///< of all starts together
};

/// One thread; the same arguments give the same bits.
Training train(const TanhNetwork& network,
               const TrainingRows& rows,
               const TrainingRows& held_out,
               const TrainingPlan& plan);

}  // namespace libchar::fusion
