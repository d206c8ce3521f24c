#pragma once
// Levenberg-Marquardt training of a tanh network on standardised data, from seeded starts: with J and e of
// network_training.hpp and S = 1/(1 + |columns of J|) at the start,
//   (S J'J S + D) y = -S J'e,   D = clamp(diag(S J'J S), 1e-6, 1e32) / radius,   step S y;
// the radius follows how much of the promised decrease came true [Madsen, Nielsen, Tingleff 2004,
// 3.2, as Ceres has it].

#include <Eigen/Core>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace libchar::fusion {

/// A network of one hidden layer:  out = c + sum_j v_j tanh(b_j + sum_i W_ji z_i)       [RV 3.7]
/// Parameters in one vector: W (hidden x inputs, row after row), b, v, c.
struct TanhNetwork {
  std::size_t inputs = 1, hidden = 1;

  std::size_t size() const { return hidden * (inputs + 2) + 1; }
  std::size_t b() const { return hidden * inputs; }  ///< where b begins
  std::size_t v() const { return b() + hidden; }
  std::size_t c() const { return v() + hidden; }

  double activation(const double* p, std::size_t j, const double* z) const {
    const double* const w = p + j * inputs;
    double sum = p[b() + j];
    for (std::size_t i = 0; i < inputs; ++i) sum += w[i] * z[i];
    return std::tanh(sum);
  }
  double output(const double* p, const double* z) const {
    double out = p[c()];
    for (std::size_t j = 0; j < hidden; ++j) out += p[v() + j] * activation(p, j, z);
    return out;
  }
  /// Output, and its derivatives by every parameter in `row` (size() of them):
  /// by W_ji v_j (1 - t_j^2) z_i, by b_j v_j (1 - t_j^2), by v_j t_j, by c 1.
  double output(const double* p, const double* z, double* row) const {
    double out = p[c()];
    for (std::size_t j = 0; j < hidden; ++j) {
      const double t = activation(p, j, z), slope = p[v() + j] * (1 - t) * (1 + t);
      for (std::size_t i = 0; i < inputs; ++i) row[j * inputs + i] = slope * z[i];
      row[b() + j] = slope;
      row[v() + j] = t;
      out += p[v() + j] * t;
    }
    row[c()] = 1;
    return out;
  }
};

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
