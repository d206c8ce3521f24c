#include "libchar/fit/detail/band/bin_likelihood.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "libchar/core/error.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/fit/detail/curve/nonnegative.hpp"
#include "libchar/fit/record/power_bins.hpp"

namespace libchar {
namespace {

/// Mean of f² over a bin.
double bin_square_hz(const PowerBin& bin) {
  return (bin.low_hz * bin.low_hz + bin.low_hz * bin.high_hz + bin.high_hz * bin.high_hz) / 3;
}

/// Columns of the skirts of a resonance.
std::array<double, 2> skirts(const Resonance& resonance, double frequency_hz, double rate_hz) {
  const auto cosine = [&](double hz) { return std::cos(2 * std::numbers::pi * std::min(hz / rate_hz, 0.5)); };
  const double c = cosine(frequency_hz), from = c - cosine(resonance.frequency_hz);
  const double inverse = 1 / (from * from + resonance.width), like = resonance.strength * (1 - c * c) * inverse;
  return {std::log1p(like), (1 - c) * inverse / (1 + like)};
}

}  // namespace

std::size_t unknowns_of(const std::vector<Resonance>& resonances) {
  std::size_t unknowns = 0;
  for (const Resonance& resonance : resonances) unknowns += resonance.unlike ? 2 : 1;
  return unknowns;
}

BinProblem bin_problem(const std::vector<PowerBin>& bins) {
  const auto n = static_cast<Eigen::Index>(bins.size());
  BinProblem problem;
  problem.energy.resize(n);
  problem.dof.resize(n);
  problem.unit.resize(n, static_cast<int>(kTerms));
  if (bins.empty()) throw numeric_error("E0401").says("the record is too short: no frequency is left to be fitted");
  double largest = 0;
  for (const PowerBin& bin : bins) largest = std::max(largest, bin.energy);
  constexpr double kLargestPower = 1e140,
                   kSmallestPower = 1e-140;  // so are their products and profiles
  if (largest > 0 && !(largest > kSmallestPower && largest < kLargestPower))
    throw numeric_error("E0420")
        .says("the squares of the samples do not fit into a double (deviations from 10⁻⁷⁰ to 10⁷⁰ do)")
        .hint("give them in another unit");
  if (!(largest > 0)) {
    throw numeric_error("E0412").says(
        "the record is constant, or its squares are too small for a double: there is no noise to fit");
  }
  for (Eigen::Index j = 0; j < n; ++j) {
    const PowerBin& bin = bins[static_cast<std::size_t>(j)];
    problem.energy[j] = std::max(bin.energy, 1e-40 * largest);  // an exact zero has no logarithm
    problem.dof[j] = bin.dof;
    for (std::size_t i = 0; i < kTerms; ++i) problem.unit(j, static_cast<Eigen::Index>(i)) = bin.unit[i];
  }
  return problem;
}

BinProblem bin_problem(const std::vector<PowerBin>& bins, int orders, double band_hz,
                       const std::vector<Resonance>& resonances, double rate_hz) {
  BinProblem problem = bin_problem(bins);
  const int unknowns = orders + static_cast<int>(unknowns_of(resonances));
  if (unknowns == 0) return problem;
  const Eigen::ArrayXd root = (problem.dof / 2).sqrt();
  Eigen::MatrixXd columns(problem.size(), unknowns);
  for (Eigen::Index j = 0; j < problem.size(); ++j) {
    const PowerBin& bin = bins[static_cast<std::size_t>(j)];
    const double x = bin_square_hz(bin) / (band_hz * band_hz);
    // Legendre polynomials of 2x - 1, less their value at x = 0, span the same as the powers and stay apart.
    double before = 1, at = 2 * x - 1;
    Eigen::Index column = 0;
    for (int p = 1; p <= orders; ++p) {
      columns(j, column++) = root[j] * (at - (p % 2 == 0 ? 1 : -1));
      const double next = ((2 * p + 1) * (2 * x - 1) * at - p * before) / (p + 1);
      before = at;
      at = next;
    }
    for (const Resonance& resonance : resonances) {
      const auto [like, unlike] = skirts(resonance, bin.frequency_hz, rate_hz);
      columns(j, column++) = root[j] * like;
      if (resonance.unlike) columns(j, column++) = root[j] * unlike;
    }
  }
  problem.shape = thin_qr(columns).q.array().colwise() / root;
  return problem;
}

Eigen::MatrixXd whitened_shape(const BinProblem& problem) {
  return (problem.shape.colwise() * (problem.dof / 2).sqrt()).matrix();
}

Eigen::ArrayXd shape_of(const BinProblem& problem, const ShapeCoefficients& shape) {
  Eigen::ArrayXd log_gain = Eigen::ArrayXd::Zero(problem.size());
  for (Eigen::Index p = 0; p < problem.shapes(); ++p)
    log_gain += shape[static_cast<std::size_t>(p)] * problem.shape.col(p);
  return log_gain.exp();
}

Eigen::ArrayXd mixture_of(const BinProblem& problem, const Mixture& theta) {
  Eigen::ArrayXd model = Eigen::ArrayXd::Zero(problem.size());
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (theta[i] > 0) model += theta[i] * problem.unit.col(static_cast<Eigen::Index>(i));
  }
  return model;
}

Eigen::ArrayXd model_of(const BinProblem& problem, const ModelPoint& at) {
  if (problem.shapes() == 0) return mixture_of(problem, at.theta);
  return mixture_of(problem, at.theta) * shape_of(problem, at.shape);
}

double detail::deviance_of_bin(double energy, double model) {
  constexpr double kNear = 0.1, kNone = 1e-26;
  const double excess = (energy - model) / model;
  if (std::abs(excess) < kNear) return excess - std::log1p(excess);
  // A model so far above a bin is not near any maximum, but above what rounding left of a coefficient that is zero.
  const double ratio = energy / model;
  if (excess == -1 && ratio > kNone) return std::numeric_limits<double>::infinity();
  return excess - std::log(ratio);
}

double half_deviance(const BinProblem& problem, const ModelPoint& at) {
  const Eigen::ArrayXd model = model_of(problem, at);
  double sum = 0;
  for (Eigen::Index j = 0; j < problem.size(); ++j)
    sum += problem.dof[j] / 2 * detail::deviance_of_bin(problem.energy[j], model[j]);
  return std::isnan(sum) ? std::numeric_limits<double>::infinity() : sum;
}

TermMatrix fisher_information(const BinProblem& problem, const ModelPoint& at, const TermSet& terms) {
  const Eigen::ArrayXd mixture = mixture_of(problem, at.theta);
  const Eigen::ArrayXd weight = problem.dof / (2 * mixture * mixture);
  TermMatrix information = TermMatrix::Zero();
  for (std::size_t a = 0; a < kTerms; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      if (!terms[a] || !terms[b]) continue;
      const auto i = static_cast<Eigen::Index>(a), j = static_cast<Eigen::Index>(b);
      information(i, j) = information(j, i) = (weight * problem.unit.col(i) * problem.unit.col(j)).sum();
    }
  }
  if (problem.shapes() == 0) return information;
  // ln mu = ln(A theta) + S a: a relative column of a term beside the columns of the shape, each with weight nu/2.
  const Eigen::ArrayXd root = (problem.dof / 2).sqrt();
  Eigen::MatrixXd relative = Eigen::MatrixXd::Zero(problem.size(), static_cast<int>(kTerms));
  for (std::size_t a = 0; a < kTerms; ++a) {
    const auto i = static_cast<Eigen::Index>(a);
    if (terms[a]) relative.col(i) = (root * problem.unit.col(i) / mixture).matrix();
  }
  const Eigen::MatrixXd apart = without_columns_of(whitened_shape(problem), relative);
  return apart.transpose() * apart;
}

TermMatrix inverse_of(const TermMatrix& information, const TermSet& terms) {
  std::vector<Eigen::Index> in;
  for (std::size_t i = 0; i < kTerms; ++i) {
    if (terms[i]) in.push_back(static_cast<Eigen::Index>(i));
  }
  const auto n = static_cast<Eigen::Index>(in.size());
  Eigen::MatrixXd block(n, n);
  Eigen::VectorXd scale(n);
  for (Eigen::Index a = 0; a < n; ++a) scale[a] = 1 / std::sqrt(information(in[a], in[a]));
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b) block(a, b) = information(in[a], in[b]) * scale[a] * scale[b];
  }
  const Eigen::MatrixXd inverse = cholesky_inverse(block);
  TermMatrix result = TermMatrix::Zero();
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b) result(in[a], in[b]) = inverse(a, b) * scale[a] * scale[b];
  }
  return result;
}

ScoreMoments score_moments(const BinProblem& problem, const ModelPoint& at, const TermSet& terms, std::size_t term) {
  const auto k = static_cast<Eigen::Index>(term);
  const TermMatrix covariance = inverse_of(fisher_information(problem, at, terms), terms);
  const double sd = std::sqrt(covariance(k, k));
  const Eigen::ArrayXd weight = problem.dof / 2 * shape_of(problem, at.shape) / model_of(problem, at) *
                                (problem.unit.matrix() * covariance.col(k)).array() / sd;
  return {sd, (8 * weight.cube() / problem.dof.square()).sum()};
}

// Non-negative Fisher scoring. The likelihood is that of gamma variables whose means are mu = (A theta) exp(S a), so
// that each scoring step is a weighted linear least-squares problem,
//   theta, da <- argmin_{theta >= 0} sum nu/(2 mu^2) (x - exp(S a) A theta - mu S da)^2,
// solved exactly: the shape is eliminated first, then every subset of the terms is tried. Start: weights 1/x^2 and no
// shape, or the slow part of the bins and what the others lack. A step that does not lower -ln L is halved. Typically
// 5-15 steps.

namespace {

// The normal equations of a step in the terms alone.
struct TermEquations {
  TermMatrix gram = TermMatrix::Zero();
  Mixture right{};
};

TermEquations equations_of(const BinProblem& problem, const TermSet& free, const Eigen::ArrayXd& weight,
                           const Eigen::ArrayXd& target) {
  TermEquations out;
  for (std::size_t a = 0; a < kTerms; ++a) {
    if (!free[a]) continue;
    const auto i = static_cast<Eigen::Index>(a);
    const Eigen::ArrayXd weighted = weight * problem.unit.col(i);
    out.right[a] = (weighted * target).sum();
    for (std::size_t b = 0; b <= a; ++b) {
      const auto j = static_cast<Eigen::Index>(b);
      if (free[b]) out.gram(i, j) = out.gram(j, i) = (weighted * problem.unit.col(j)).sum();
    }
  }
  return out;
}

Mixture joined(const Mixture& fixed, const Mixture& solved, const TermSet& free) {
  Mixture theta{};
  for (std::size_t i = 0; i < kTerms; ++i) theta[i] = free[i] ? solved[i] : fixed[i];
  return theta;
}

ModelPoint between(const ModelPoint& a, const ModelPoint& b, double share) {
  ModelPoint at;
  for (std::size_t i = 0; i < kTerms; ++i) at.theta[i] = a.theta[i] + share * (b.theta[i] - a.theta[i]);
  for (std::size_t p = 0; p < at.shape.size(); ++p) at.shape[p] = a.shape[p] + share * (b.shape[p] - a.shape[p]);
  return at;
}

// A step with a shape, in units of the model: rows are relative errors with weight nu/2, the shape's columns are taken
// out of the terms' columns (they are orthonormal), and come back when the terms are known.
ModelPoint shaped_step(const BinProblem& problem, const TermSet& free, const Mixture& fixed, const ModelPoint& now) {
  const Eigen::ArrayXd mixture = mixture_of(problem, now.theta);
  const Eigen::ArrayXd gain = shape_of(problem, now.shape);
  const Eigen::ArrayXd root = (problem.dof / 2).sqrt();
  const Eigen::MatrixXd shape = whitened_shape(problem);
  const Eigen::VectorXd target =
      (root * (problem.energy / (gain * mixture) - mixture_of(problem, fixed) / mixture)).matrix();
  Eigen::MatrixXd terms = Eigen::MatrixXd::Zero(problem.size(), static_cast<int>(kTerms));
  for (std::size_t i = 0; i < kTerms; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    if (free[i]) terms.col(column) = (root * problem.unit.col(column) / mixture).matrix();
  }
  const Eigen::MatrixXd apart = without_columns_of(shape, terms);
  const TermMatrix gram = apart.transpose() * apart;
  const Eigen::VectorXd product = apart.transpose() * target;
  Mixture right{};
  for (std::size_t i = 0; i < kTerms; ++i) right[i] = product[static_cast<Eigen::Index>(i)];
  ModelPoint next;
  next.theta = joined(fixed, nonnegative_minimum(gram, right, free), free);
  Eigen::VectorXd rest = target;
  for (std::size_t i = 0; i < kTerms; ++i)
    if (free[i]) rest -= next.theta[i] * terms.col(static_cast<Eigen::Index>(i));
  const Eigen::VectorXd step = shape.transpose() * rest;
  for (Eigen::Index p = 0; p < problem.shapes(); ++p)
    next.shape[static_cast<std::size_t>(p)] = now.shape[static_cast<std::size_t>(p)] + step[p];
  return next;
}

// Where no start is known: the terms from the slow half of the bins, the shape from the logarithm of what is left.
ModelPoint slow_start(const BinProblem& problem, const TermSet& free, const Mixture& fixed) {
  Eigen::ArrayXd weight = problem.dof / (2 * problem.energy * problem.energy);
  weight.tail(problem.size() / 3).setZero();
  const Eigen::ArrayXd offset = mixture_of(problem, fixed);
  const TermEquations equations = equations_of(problem, free, weight, problem.energy - offset);
  ModelPoint at;
  at.theta = joined(fixed, nonnegative_minimum(equations.gram, equations.right, free), free);
  const Eigen::ArrayXd mixture = mixture_of(problem, at.theta);
  if (!(mixture.minCoeff() > 0)) return at;
  const Eigen::ArrayXd root = (problem.dof / 2).sqrt();
  const Eigen::VectorXd log_gain =
      whitened_shape(problem).transpose() * (root * (problem.energy / mixture).log()).matrix();
  for (Eigen::Index p = 0; p < problem.shapes(); ++p) at.shape[static_cast<std::size_t>(p)] = log_gain[p];
  return at;
}

class Scoring {
 public:
  Scoring(const BinProblem& problem, const TermSet& free, const ModelPoint* start) : problem_(problem), free_(free) {
    if (start == nullptr) return;
    for (std::size_t i = 0; i < kTerms; ++i) fixed_[i] = free[i] ? 0 : start->theta[i];
  }

  /// The likelier first. A named shape is a straight line about its maximum: it begins without a change, a polynomial
  /// by what is left.
  std::vector<ModelPoint> first_guesses() const {
    const Eigen::ArrayXd weight = problem_.dof / (2 * problem_.energy * problem_.energy);
    std::vector<ModelPoint> guesses = {{solved(weight), {}}};
    if (problem_.shapes() == 0) return guesses;
    guesses.push_back(slow_start(problem_, free_, fixed_));
    if (!(half_deviance(problem_, guesses[0]) < half_deviance(problem_, guesses[1]))) std::swap(guesses[0], guesses[1]);
    return guesses;
  }

  ModelPoint goal(const ModelPoint& now) const {
    if (problem_.shapes() > 0) return shaped_step(problem_, free_, fixed_, now);
    const Eigen::ArrayXd model = mixture_of(problem_, now.theta);
    const Eigen::ArrayXd weight = problem_.dof / (2 * model * model);
    return {solved(weight), {}};
  }

 private:
  Mixture solved(const Eigen::ArrayXd& weight) const {
    const Eigen::ArrayXd target = problem_.energy - mixture_of(problem_, fixed_);
    const TermEquations equations = equations_of(problem_, free_, weight, target);
    return joined(fixed_, nonnegative_minimum(equations.gram, equations.right, free_), free_);
  }

  const BinProblem& problem_;
  TermSet free_;
  Mixture fixed_{};
};

ScoringResult climb(const BinProblem& problem, const Scoring& scoring, const ModelPoint& start, double tolerance) {
  constexpr double kFarthest = 64;  // steps
  constexpr double kGrowth = 8;     // of a part of a step, from one to the next
  ScoringResult result;
  result.at = start;
  result.half_deviance = half_deviance(problem, result.at);
  if (!std::isfinite(result.half_deviance)) return result;
  double share = 1;
  for (; result.iterations < 200; ++result.iterations) {
    const ModelPoint goal = scoring.goal(result.at);
    // Far from the maximum full steps go too far again and again.
    const double longest = std::min(1.0, kGrowth * share);
    share = longest;
    ModelPoint next = share == 1 ? goal : between(result.at, goal, share);
    double value = half_deviance(problem, next);
    while (!(value <= result.half_deviance) && share > 1e-9) {
      share /= 2;
      next = between(result.at, goal, share);
      value = half_deviance(problem, next);
    }
    if (result.iterations > 8 && share == 1) {
      // Single coefficients bend the likelihood more than their expectation says: full steps may
      // swing about the maximum for long.
      const ModelPoint middle = between(result.at, goal, 0.5);
      const double at_middle = half_deviance(problem, middle);
      if (at_middle < value) {
        next = middle;
        value = at_middle;
      }
      // And where they bend it less, full steps creep.
      for (double far = 2; far <= kFarthest && at_middle >= value; far *= 2) {
        const ModelPoint beyond = between(result.at, goal, far);
        if (std::any_of(beyond.theta.begin(), beyond.theta.end(), [](double theta) { return theta < 0; })) break;
        const double at_beyond = half_deviance(problem, beyond);
        if (!(at_beyond < value)) break;
        next = beyond;
        value = at_beyond;
      }
    }
    const double gain = result.half_deviance - value;
    if (gain > 0) {
      result.at = next;
      result.half_deviance = value;
    }
    // Rounding of the sum itself is of order 1e-16 times its terms; a gain below that is noise.
    if (gain > tolerance + 1e-15 * result.half_deviance) continue;
    result.converged = longest == 1;
    if (result.converged) break;
    share = 1;
  }
  return result;
}

const ScoringResult& better(const ScoringResult& a, const ScoringResult& b) {
  return b.half_deviance < a.half_deviance || !std::isfinite(a.half_deviance) ? b : a;
}

/// The maximum without a shape, then of its first columns, one more at a time: of a steep filter other starts may end
/// among slow terms, which no step leaves.
ModelPoint by_columns(const BinProblem& problem, const TermSet& free, const ModelPoint* fixed, double tolerance) {
  BinProblem fewer = problem;
  fewer.shape = problem.shape.leftCols(0);
  const Scoring first(fewer, free, fixed);
  ModelPoint at = climb(fewer, first, first.first_guesses()[0], tolerance).at;
  for (Eigen::Index columns = 1; columns < problem.shapes(); ++columns) {
    fewer.shape = problem.shape.leftCols(columns);
    at = climb(fewer, Scoring(fewer, free, fixed), at, tolerance).at;
  }
  return at;
}

}  // namespace

ScoringResult score(const BinProblem& problem, const TermSet& free, const ModelPoint* start, double tolerance) {
  constexpr double kHopeless = 2;  ///< of half deviance per bin: where the model is right it is a half
  const Scoring scoring(problem, free, start);
  // A warm start with a vanishing model: some bin would have no expected power at all.
  const bool warm = start != nullptr && std::isfinite(half_deviance(problem, *start));
  if (warm) return climb(problem, scoring, *start, tolerance);
  const std::vector<ModelPoint> guesses = scoring.first_guesses();
  ScoringResult result = climb(problem, scoring, guesses[0], tolerance);
  const double hopeless = kHopeless * static_cast<double>(problem.size());
  if (guesses.size() < 2 || result.half_deviance < hopeless) return result;
  // With many unknowns one of the starts may end far from the maximum.
  result = better(result, climb(problem, scoring, guesses[1], tolerance));
  if (result.half_deviance < hopeless) return result;
  return better(result, climb(problem, scoring, by_columns(problem, free, start, tolerance), tolerance));
}

}  // namespace libchar
