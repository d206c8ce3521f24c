#pragma once
// What a Gauss-Newton step on a tanh network needs of the training rows: with J the slopes of its
// output by every parameter and e = out - target, all sums of [J e]' [J e]. J itself is never there
// as a whole: panels of rows are filled on all cores, then each core adds a panel to its own rows of
// the matrix. Every sum goes over the rows in their order, whoever adds it up, so any number of
// cores gives the same bits.

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "libchar/fusion/detail/network/tanh_network.hpp"

namespace libchar::fusion {

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
  std::size_t width_;  // of a row of a panel: size() + 1, filled up with zeros to whole lanes
  std::vector<double> panel_;   // kPanel rows
  std::vector<double> sums_;    // width_ x width_, on and above the diagonal
  std::vector<double> errors_;  // of all rows
};

}  // namespace libchar::fusion
