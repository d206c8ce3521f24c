#pragma once
// Levenberg-Marquardt training of a tanh network on standardised data, from seeded starts: with J and e of
// network_normals.hpp and S = 1/(1 + |columns of J|) at the start,
//   (S J'J S + D) y = -S J'e,   D = clamp(diag(S J'J S), 1e-6, 1e32) / radius,   step S y;
// the radius follows how much of the promised decrease came true [Madsen, Nielsen, Tingleff 2004,
// 3.2, as Ceres has it].
#include <cstdint>
#include <vector>

#include "libchar/fusion/detail/network/network_normals.hpp"
#include "libchar/fusion/detail/network/tanh_network.hpp"

namespace libchar::fusion {

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

/// On all cores; the same arguments give the same bits, however many those are.
Training train(const TanhNetwork& network,
               const TrainingRows& rows,
               const TrainingRows& held_out,
               const TrainingPlan& plan);

}  // namespace libchar::fusion
