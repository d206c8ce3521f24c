#pragma once
// The likelihood of power bins: independent gamma variables whose means are linear in theta, times a shape of
// frequency.
//   half deviance  D(theta, a) = sum_j nu_j/2 (u_j - 1 - ln u_j),
//                  u_j = measured_j / mu_j,  mu = (A theta) exp(S a),  -ln L = D + const

#include <Eigen/Core>
#include <array>
#include <vector>

#include "libchar/core/noise_terms.hpp"
#include "libchar/fit/record/power_bins.hpp"

namespace libchar {

using TermMatrix = Eigen::Matrix<double, kTerms, kTerms>;

/// Most coefficients of a shape (core/noise_shape.hpp).
inline constexpr int kMostShape = 8;
using ShapeCoefficients = std::array<double, kMostShape>;

struct BinProblem {
  Eigen::ArrayXd energy, dof;
  Eigen::Array<double, Eigen::Dynamic, static_cast<int>(kTerms)> unit;
  /// S, a column a coefficient of the shape, orthonormal under the weights nu/2; no columns: no shape
  Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic> shape;
  Eigen::Index size() const { return energy.size(); }
  Eigen::Index shapes() const { return shape.cols(); }
};

/// Squared coefficients of the terms and coefficients of the shape.
struct ModelPoint {
  Mixture theta{};
  ShapeCoefficients shape{};
};

/// A peak that is left out of a spectrum.
struct Resonance {
  double frequency_hz = 0;  ///< between its skirts: bins grow with the frequency, and draw it upwards
  double strength = 0;      ///< s, of its skirts
  double width = 0;         ///< w
  bool unlike = false;      ///< they are: a displacement or an acceleration
  double top_hz = 0;        ///< where it is highest
};

std::size_t unknowns_of(const std::vector<Resonance>& resonances);

/// Of bins without a shape. Throws Error(numeric) when they hold no noise at all.
BinProblem bin_problem(const std::vector<PowerBin>& bins);
/// The same with ln gain = sum a_p x^p, p = 1..orders, x = (f / band_hz)²: any filter with a real impulse response has
/// a gain that is even and analytic about f = 0; and with the skirts of resonances, themselves left out. A sampled one
/// has the power
///   (b (1 - c²) + d (1 - c)) / ((c - c_r)² + w),  c = cos(2 pi f / rate),
/// over that at rest: b ln(1 + s (1 - c²) / ((c - c_r)² + w)), and d times its slope where the skirts are unlike.
BinProblem bin_problem(const std::vector<PowerBin>& bins, int orders, double band_hz,
                       const std::vector<Resonance>& resonances, double rate_hz);
/// sqrt(nu/2) S: orthonormal columns.
Eigen::MatrixXd whitened_shape(const BinProblem& problem);

/// exp(S a).
Eigen::ArrayXd shape_of(const BinProblem& problem, const ShapeCoefficients& shape);
/// A theta, without the shape.
Eigen::ArrayXd mixture_of(const BinProblem& problem, const Mixture& theta);
Eigen::ArrayXd model_of(const BinProblem& problem, const ModelPoint& at);
double half_deviance(const BinProblem& problem, const ModelPoint& at);
namespace detail {
/// energy / model - 1 - ln(energy / model).
double deviance_of_bin(double energy, double model);
}  // namespace detail

/// Expected information of theta at the point, 1/2 sum nu a a' / mu^2, for the terms of the set (others: zero rows);
/// what the unknown shape takes of it is taken off.
TermMatrix fisher_information(const BinProblem& problem, const ModelPoint& at, const TermSet& terms);

/// Inverse of the block of `information` that belongs to `terms`, other entries zero; columns are scaled first.
TermMatrix inverse_of(const TermMatrix& information, const TermSet& terms);

/// Standard deviation of theta by its efficient score, and the skewness of that: a sum of chi-squares,
/// sum w_j (u_j - 1), w = nu/2 (I^-1 a) / mu, of the skewness sum w³ 8 / nu² over sd³.
struct ScoreMoments {
  double sd = 0, skewness = 0;
};
ScoreMoments score_moments(const BinProblem& problem, const ModelPoint& at, const TermSet& terms, std::size_t term);

inline TermSet only_positive(const Mixture& theta) {
  TermSet set{};
  for (std::size_t i = 0; i < kTerms; ++i) set[i] = theta[i] > 0;
  return set;
}
inline std::size_t count_of(const TermSet& set) {
  std::size_t n = 0;
  for (const bool in : set) n += in ? 1 : 0;
  return n;
}

/// The maximum of the likelihood by non-negative Fisher scoring.
/// Maximum likelihood over theta >= 0 of the free terms, the others held at `start`, and over the coefficients of the
/// shape.
struct ScoringResult {
  ModelPoint at;
  double half_deviance = 0;
  int iterations = 0;
  bool converged = false;
};
ScoringResult score(const BinProblem& problem, const TermSet& free, const ModelPoint* start = nullptr,
                    double tolerance = 1e-10);

}  // namespace libchar
