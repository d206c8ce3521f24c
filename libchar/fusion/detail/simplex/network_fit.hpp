#pragma once
// The adaptation module of the simplex: a network fitted in slices, so that a step of the run costs the
// same whether it trains or not, and without the heap.
//
//   out(z) = a_0 + a'z + s net(z)
//
// z are standardised inputs; first a by regularised least squares, then the tanh network (network_training.hpp) on
// what is left of the target, by Levenberg-Marquardt. Of all iterations the one with the smallest error on the
// held-out rows stays, the affine part alone among them.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "libchar/fusion/detail/network/network_training.hpp"

namespace libchar::fusion {

/// What is learnt: affine part, network on its residual, scales of the inputs.
struct FittedNetwork {
  explicit FittedNetwork(const TanhNetwork& network = {});
  double output(const double* input, double* scratch) const;
  bool fitted() const { return held_out_square >= 0; }

  TanhNetwork network;
  std::vector<double> mean, scale;  ///< of the inputs; scale 0: the input is constant and left out
  std::vector<double> affine;       ///< a_0, then one an input
  std::vector<double> parameters;   ///< of the network
  double residual_scale = 0;        ///< s
  double held_out_square = -1;      ///< mean square error on the held-out rows; below 0: nothing is learnt
};

/// Rows to learn from; the last ones are held out.
class FitRows {
 public:
  virtual ~FitRows() = default;
  /// Fills the inputs of a row, returns its target.
  virtual double row(std::size_t k, double* input) const = 0;
};

class NetworkFit {
 public:
  /// Room for so many rows.
  NetworkFit(const TanhNetwork& network, std::size_t most_rows);
  /// Starts a fit of `training` rows, judged on the `held_out` rows behind them.
  void begin(const FitRows& rows, std::size_t training, std::size_t held_out, std::uint64_t seed);
  bool busy() const { return phase_ != Phase::idle; }
  /// One slice; true: the fit is over with this slice, and `fitted()` has it.
  bool advance();
  /// The same network by all starts on all cores, at once: in a learning window, not in a run.
  void finish_at_once(std::size_t starts);
  const FittedNetwork& fitted() const { return out_; }
  std::size_t inputs() const { return out_.network.inputs; }

 private:
  enum class Phase : char { idle, moments, affine, residuals, slopes, factor, trial, held_out };
  void next(Phase phase);
  void moments(std::size_t k);
  void end_moments();
  void add_affine(std::size_t k);
  bool solve_affine();
  void add_residual(std::size_t k);
  void end_residuals();
  void start_parameters();
  void add_slopes(std::size_t k);
  void damp();
  bool factor_columns();
  void take_step();
  void add_trial(std::size_t k);
  void judge_trial();
  void add_held_out(std::size_t k);
  void judge_held_out();
  void finish();
  double* row(std::size_t k) { return rows_.data() + k * (out_.network.inputs + 1); }
  std::size_t phase_rows() const;
  void work(std::size_t k);
  void end_of_phase();

  const FitRows* source_ = nullptr;
  std::size_t training_ = 0, held_out_ = 0, at_ = 0;
  std::uint64_t seed_ = 1;
  Phase phase_ = Phase::idle;
  FittedNetwork out_;
  std::vector<double> rows_;  // standardised inputs and the target, row after row
  std::vector<double> input_, square_, affine_matrix_, affine_side_;
  struct Descent {
    std::vector<double> p, trial, step, row, slope, a, factor, scale;
    double cost = 0, trial_cost = 0, promised = 0, radius = 1e4, shrink = 2;
    double unit = 1;  // of the residual of the affine part, in the unit of the target
    std::size_t column = 0;
    int iterations = 0, waited = 0, invalid = 0;
  } lm_;
  double sum_ = 0;
};

/// x of (A + ridge diag A) x = b by Cholesky in place; A n x n, row after row. False: not positive definite.
bool solve_in_place(double* a, double* b, std::size_t n, double ridge);

}  // namespace libchar::fusion
