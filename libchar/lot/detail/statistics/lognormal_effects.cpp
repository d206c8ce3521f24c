// What a fit finds for a square t is t itself, a gamma variable about it: a sum of chi-squares with the weights of the
// fit, known by its first three moments (core/coefficient.hpp). As a function of t, of records of about one length,
//   sd²(t) = a + b t + c t²,   skewness(t) = 2 sd / (t + d(t)),   d = e + f t,   a … f >= 0
// are lines through what the fits say at their own estimates, so that a record that was found too
// large by chance is not believed less. Then
//   q + d ~ gamma of mean t + d and variance sd²
//   L(mean, spread) = prod_i integral N(u; mean, spread²) p(q_i | e^2u) du
// with the integral as a sum over cells of u, each with the normal distribution's exact share, so that nothing is lost
// where the spread is narrow. Whoever was detected or not does not enter. Spread: the maximum of the likelihood with
// the mean integrated out to first order (Cox & Reid, J. R. Stat. Soc. B 49 (1987) 1), interval by its fall of 1.92.
// Means: profiles over the spread, with the fall n/2 ln(1 + t²/(n - 1)) that makes them Student's t where the values
// are known. Of what many fits find: docs/theory/lots.md.
#include <Eigen/Dense>
#include <boost/math/tools/minima.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <limits>
#include <map>
#include <numbers>
#include <vector>

#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/lot/detail/lot_figures.hpp"

namespace libchar {
namespace {

constexpr double kNoEnd = std::numeric_limits<double>::infinity();
constexpr double kFall95 = 1.9207294103470621;  ///< of a log-likelihood: half of chi-square's 95 %

/// Root of k/2, at least: no sum of chi-squares is more skew than one of four degrees of freedom.
constexpr double kLeastShare = std::numbers::sqrt2;

/// Of records of about one length.
struct ErrorModel {
  Eigen::Vector3d variance{0, 0, 0};  ///< a, b, c
  Eigen::Vector2d beneath{0, 0};      ///< e, f
  double excess = 0;
  double sd_at(double square) const {
    const double by_information = std::sqrt(variance[0] + square * (variance[1] + square * variance[2]));
    return by_information * std::sqrt(1 + excess * by_information / (square + 1.5 * by_information));
  }
  double beneath_at(double square) const {
    return std::max(beneath[0] + beneath[1] * square, kLeastShare * sd_at(square) - square);
  }
};

using Indices = std::vector<std::size_t>;

std::map<long, Indices> by_length(std::span<const double> samples) {
  std::map<long, Indices> out;
  for (std::size_t i = 0; i < samples.size(); ++i) out[length_class(samples[i])].push_back(i);
  return out;
}

/// Least squares over x >= 0 for a few columns: the best of all sets of columns whose own solution is so.
Eigen::VectorXd non_negative(const Eigen::MatrixXd& unscaled, const Eigen::VectorXd& target) {
  // Columns are powers of a square in any unit.
  const Eigen::VectorXd length = unscaled.colwise().norm();
  const Eigen::VectorXd scale = (length.array() > 0).select(length.cwiseInverse(), 0.0);
  const Eigen::MatrixXd design = unscaled * scale.asDiagonal();
  const auto columns = static_cast<int>(design.cols());
  Eigen::VectorXd best = Eigen::VectorXd::Zero(columns);
  double least = target.squaredNorm();
  for (int set = 1; set < 1 << columns; ++set) {
    std::vector<int> in;
    for (int c = 0; c < columns; ++c)
      if ((set >> c & 1) != 0) in.push_back(c);
    const Eigen::MatrixXd part = design(Eigen::indexing::all, in);
    const Eigen::VectorXd x = part.colPivHouseholderQr().solve(target);
    const double rest = (part * x - target).squaredNorm();
    if (!(x.minCoeff() >= 0) || !(rest < least)) continue;
    least = rest;
    best.setZero();
    for (std::size_t c = 0; c < in.size(); ++c) best[in[c]] = x[static_cast<Eigen::Index>(c)];
  }
  return best.cwiseProduct(scale);
}

/// The mean variance at each square. Residuals relative to the line: small and large ones count
/// alike, and it is a mean.
Eigen::Vector3d variance_line(const Eigen::ArrayXd& square, const Eigen::ArrayXd& variance) {
  Eigen::MatrixXd powers(square.size(), 3);
  powers << Eigen::ArrayXd::Ones(square.size()), square, square.square();
  const double mean = variance.mean();
  Eigen::ArrayXd line = Eigen::ArrayXd::Constant(square.size(), mean);
  Eigen::Vector3d out{mean, 0, 0};
  for (int round = 0; round < 5; ++round) {
    const Eigen::MatrixXd design = powers.array().colwise() / line;
    out = non_negative(design, variance / line);
    line = (powers * out).array().max(1e-3 * mean);
  }
  return out;
}

/// What a chi-square of this skewness has beneath the square.
Eigen::Vector2d beneath_line(const Eigen::ArrayXd& square, const Eigen::ArrayXd& sd, const Eigen::ArrayXd& skewness) {
  std::vector<Eigen::Index> known;
  for (Eigen::Index r = 0; r < square.size(); ++r)
    if (skewness[r] > 0) known.push_back(r);
  if (known.empty()) return {sd.minCoeff(), 1};
  const Eigen::ArrayXd at = square(known), energy = 2 * sd(known) / skewness(known);
  Eigen::MatrixXd design(at.size(), 2);
  design << 1 / energy, at / energy;
  return non_negative(design, 1 - at / energy);
}

ErrorModel error_model(const SquareEstimates& in, const Indices& records) {
  const auto n = static_cast<Eigen::Index>(records.size());
  Eigen::ArrayXd square(n), sd(n), skewness(n);
  double lowest = 0;
  for (Eigen::Index r = 0; r < n; ++r) {
    const std::size_t i = records[static_cast<std::size_t>(r)];
    lowest = std::min(lowest, in.square[i]);
    square[r] = std::max(in.square[i], 0.0);
    sd[r] = in.sd[i];
    skewness[r] = in.skewness[i];
  }
  ErrorModel out{variance_line(square, sd.square()), beneath_line(square, sd, skewness), in.excess};
  // Something always lies beneath, and what was found was possible.
  out.variance[0] = std::max(out.variance[0], std::pow(1e-3 * sd.minCoeff(), 2));
  out.beneath[0] = std::max(out.beneath[0], 0.25 * out.sd_at(0) - 1.05 * lowest);
  return out;
}

/// Estimates so close together that one stands for all.
struct Point {
  double square = 0, count = 0;
  ErrorModel error;
};

std::vector<Point> points_of(const SquareEstimates& in) {
  constexpr std::size_t kEach = 1000;                 // up to so many every one stands for itself
  constexpr double kTogether = 0.05, kAlike = 0.005;  // of an sd, or of the square
  std::vector<Point> out;
  for (auto& [length, records] : by_length(in.samples)) {
    const ErrorModel error = error_model(in, records);
    Indices sorted = records;
    std::sort(sorted.begin(), sorted.end(), [&](std::size_t a, std::size_t b) { return in.square[a] < in.square[b]; });
    double first = -kNoEnd;
    for (const std::size_t i : sorted) {
      const double square = in.square[i];
      const bool joins = in.square.size() > kEach &&
                         square - first < std::max(kTogether * error.sd_at(std::max(first, 0.0)), kAlike * first);
      if (!joins) {
        out.push_back({0, 0, error});
        first = square;
      }
      Point& at = out.back();
      at.count += 1;
      at.square += (square - at.square) / at.count;
    }
  }
  return out;
}

/// std::lgamma writes the sign to a global, which is a race between threads.
double log_gamma(double x) {
  int sign = 0;
  return ::lgamma_r(x, &sign);
}

/// Of finding the point where the square is `square`; but for what does not depend on it.
double log_density(const Point& point, double square) {
  const double beneath = point.error.beneath_at(square), energy = square + beneath;
  const double share = energy / point.error.sd_at(square), half_dof = share * share;
  const double x = half_dof * (point.square + beneath) / energy;
  return half_dof * std::log(x) - x - log_gamma(half_dof) - std::log(point.square + beneath);
}

class Likelihood {
 public:
  explicit Likelihood(const std::vector<Point>& points) {
    double top = 0, bottom = kNoEnd, narrowest = kCoarsest;
    for (const Point& p : points) {
      const double sd = p.error.sd_at(std::max(p.square, 0.0));
      top = std::max(top, p.square + 6 * sd);
      bottom = std::min(bottom, std::max(kFlat * p.error.sd_at(0), p.square - 6 * sd));
      if (p.square > 0) narrowest = std::min(narrowest, sd / (2 * p.square));
    }
    const double low = std::log(bottom) / 2, high = std::log(top) / 2;
    const double step = std::max(narrowest / kCellsASd, (high - low) / kMostCells);
    const auto cells = clamped_whole<Eigen::Index>(std::ceil((high - low) / step));
    edges_ = Eigen::ArrayXd::LinSpaced(cells + 1, low, low + step * static_cast<double>(cells));
    count_.resize(static_cast<Eigen::Index>(points.size()));
    table_.resize(count_.size(), cells);
    for (Eigen::Index r = 0; r < count_.size(); ++r) {
      const Point& p = points[static_cast<std::size_t>(r)];
      count_[r] = p.count;
      for (Eigen::Index c = 0; c < cells; ++c) table_(r, c) = log_density(p, std::exp(edges_[c] + edges_[c + 1]));
      table_.row(r) = (table_.row(r).array() - table_.row(r).maxCoeff()).exp();
    }
  }

  double low() const { return edges_[0]; }
  double high() const { return edges_[edges_.size() - 1]; }
  double least_spread() const { return edges_[1] - edges_[0]; }

  /// -ln L but for a constant.
  double operator()(double mean, double spread) const {
    const Eigen::Index cells = table_.cols();
    Eigen::VectorXd share(cells);
    double below = 0;
    for (Eigen::Index c = 0; c < cells; ++c) {
      const double next = c + 1 == cells ? 1 : std::erfc((mean - edges_[c + 1]) / (spread * std::numbers::sqrt2)) / 2;
      share[c] = next - below;
      below = next;
    }
    return -(count_ * (table_ * share).array().max(std::numeric_limits<double>::min()).log()).sum();
  }

 private:
  static constexpr double kFlat = 1e-2;  ///< of an sd: squares that small are all alike
  static constexpr double kCellsASd = 6, kMostCells = 400;
  static constexpr double kCoarsest = 0.5;  ///< sd of ln c for which cells are made, however little is known
  Eigen::ArrayXd edges_, count_;
  Eigen::MatrixXd table_;
};

constexpr double kMostSpread = 20;  ///< of ln c
constexpr int kBits = 20;           ///< of an abscissa

template <class Function>
std::pair<double, double> least(Function&& f, double low, double high) {
  return boost::math::tools::brent_find_minima(f, low, high, kBits);
}

/// Where `f`, least at `at`, has risen by `rise` in steps of this sign; infinite where it has not before `end`.
template <class Function>
double rises(Function&& f, double at, double step, double end, double rise) {
  const double value = f(at) + rise;
  double inside = at, outside = at;
  do {
    inside = outside;
    outside = step < 0 ? std::max(outside + step, end) : std::min(outside + step, end);
    step *= 1.5;
    if (f(outside) >= value) {
      std::uintmax_t iterations = 60;
      const auto ends = boost::math::tools::toms748_solve([&](double x) { return f(x) - value; },
                                                          std::min(inside, outside), std::max(inside, outside),
                                                          boost::math::tools::eps_tolerance<double>(kBits), iterations);
      return (ends.first + ends.second) / 2;
    }
  } while (outside != end);
  return std::copysign(kNoEnd, step);
}

/// The likelihood over the mean alone, or over ln E[c] = mean + spread²/2 (`half` = 1/2), its spread the best there.
struct Profile {
  const Likelihood& likelihood;
  double half = 0;
  double operator()(double x) const {
    return least(
               [&](double ln_spread) {
                 const double spread = std::exp(ln_spread);
                 return likelihood(x - half * spread * spread, spread);
               },
               std::log(likelihood.least_spread()), std::log(kMostSpread))
        .second;
  }
};

/// Where the likelihood is largest at a spread, and -ln L there.
std::pair<double, double> best_mean(const Likelihood& likelihood, double spread) {
  return least([&](double mean) { return likelihood(mean, spread); }, likelihood.low(), likelihood.high());
}
/// Of -ln L over the mean; above zero.
double curvature(const Likelihood& likelihood, double mean, double spread, double n) {
  const double step = 0.5 * std::hypot(spread, 0.1) / std::sqrt(n);
  const double second =
      (likelihood(mean - step, spread) - 2 * likelihood(mean, spread) + likelihood(mean + step, spread)) /
      (step * step);
  return std::max(second, 1e-6 * n);
}

/// Fills spread and its interval; returns the spread that the means are taken at, not zero.
double add_spread(const Likelihood& likelihood, LognormalEffects& out) {
  const double n = static_cast<double>(out.count);
  const auto adjusted = [&](double ln_spread) {
    const double spread = std::exp(ln_spread);
    const auto [mean, value] = best_mean(likelihood, spread);
    return value + std::log(curvature(likelihood, mean, spread, n)) / 2;
  };
  constexpr double kStep = 0.2;
  const double floor = std::log(likelihood.least_spread()), ceiling = std::log(kMostSpread);
  const double best = least(adjusted, floor, ceiling).first;
  const double low = rises(adjusted, best, -kStep, floor, kFall95),
               high = rises(adjusted, best, kStep, ceiling, kFall95);
  out.spread = best < floor + 1e-3 ? 0 : std::exp(best);
  out.spread_ci95 = {std::isfinite(low) ? std::exp(low) : 0, std::exp(high)};
  return std::exp(best);
}

void add_means(const Likelihood& likelihood, double spread, LognormalEffects& out) {
  const double n = static_cast<double>(out.count), dof = n - 1;
  out.mean = best_mean(likelihood, spread).first;
  out.arithmetic = out.mean + spread * spread / 2;
  const double t = student_quantile(0.975, dof), fall = n / 2 * std::log1p(t * t / dof);
  const double sd = 1 / std::sqrt(curvature(likelihood, out.mean, spread, n));
  const auto interval = [&](const Profile& profile, double at) {
    const double top = least(profile, at - 3 * sd, at + 3 * sd).first;
    // A mean of few unlike values can lie beyond all of them.
    return Interval{rises(profile, top, -sd, likelihood.low() - kMostSpread, fall),
                    rises(profile, top, sd, likelihood.high() + kMostSpread, fall)};
  };
  out.mean_ci95 = interval({likelihood, 0}, out.mean);
  out.arithmetic_ci95 = interval({likelihood, 0.5}, out.arithmetic);
}

}  // namespace

LognormalEffects lognormal_effects(const SquareEstimates& in) {
  const Likelihood likelihood(points_of(in));
  LognormalEffects out;
  out.count = in.square.size();
  add_means(likelihood, add_spread(likelihood, out), out);
  return out;
}

}  // namespace libchar
