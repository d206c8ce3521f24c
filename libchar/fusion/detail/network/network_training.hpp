#pragma once
// Levenberg-Marquardt training of a tanh network on standardised data, from seeded starts: with J and e of
// network_training.hpp and S = 1/(1 + |columns of J|) at the start,
//   (S J'J S + D) y = -S J'e,   D = clamp(diag(S J'J S), 1e-6, 1e32) / radius,   step S y;
// the radius follows how much of the promised decrease came true [Madsen, Nielsen, Tingleff 2004,
// 3.2, as Ceres has it].

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "libchar/fusion/detail/network/tanh_network.hpp"

namespace libchar::fusion {

// What a Gauss-Newton step on a tanh network needs of the training rows: with J the slopes of its output by every
// parameter and e = out - target, all sums of [J e]' [J e]. J itself is never there as a whole: panels of rows are
// filled on all cores, then each core adds a panel to its own rows of the matrix. Every sum goes over the rows in their
// order, whoever adds it up, so any number of cores gives the same bits.

/// Consecutive instants: `count` rows of inputs + 1 values, the target last.
struct TrainingRows {
  const double* rows = nullptr;
  std::size_t count = 0;
};

class NetworkNormals {
 public:
  explicit NetworkNormals(const TanhNetwork& network);
  /// Sum of e²; infinite where one is no number.
  double squares(const TrainingRows& rows, const double* parameters);
  /// J'J and J'e at these parameters. False, where a slope or an error is no number.
  bool linearise(const TrainingRows& rows, const double* parameters);
  /// Of J'J, size() x size().
  double curvature(Eigen::Index i, Eigen::Index j) const;
  /// J'e.
  Eigen::VectorXd slope() const;

 private:
  void fill(const TrainingRows& rows, std::size_t first, const double* parameters);

  TanhNetwork network_;
  std::size_t width_;           // of a row of a panel: size() + 1, filled up with zeros to whole lanes
  std::vector<double> panel_;   // kPanel rows
  std::vector<double> sums_;    // width_ x width_, on and above the diagonal
  std::vector<double> errors_;  // of all rows
};

struct TrainingPlan {
  std::size_t starts = 3;
  std::size_t iterations = 100;  ///< at most, a start
  std::uint64_t seed = 1;
  double relative_decrease = 1e-7;  ///< of the sum of squares, below which a training is over
  int patience = 5;                 ///< iterations without a gain on the held-out rows before it is over
};

struct Training {
  std::vector<double> parameters;  ///< empty: no start gave finite numbers
  double held_out_square = 0;      ///< mean square of the error on the held-out rows
  int iterations = 0;              ///< of all starts together
};

/// On all cores; the same arguments give the same bits, however many those are.
Training train(const TanhNetwork& network, const TrainingRows& rows, const TrainingRows& held_out,
               const TrainingPlan& plan);

}  // namespace libchar::fusion
