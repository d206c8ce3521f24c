// A weak low-pass, quantization noise, a second tap, decimation: to first order each multiplies the spectrum by
//   exp(a s^m),   s = sin²(pi f / rate),  m = 1, 2 or 4 (how steeply it sets in),  a of either sign.
// The tests of the fit see it where a/sd(a) is beyond 3; N is wrong by more than its interval from
// 2 on. So whichever model passes is averaged over it: with z = a_hat/sd(a) of the score test,
// theta conditional on a from the same information, and as prior of a/sd(a) Cauchy's of scale 1.4,
//   E ln theta   = ln theta_0 + sum_m w_m g_m E[a | z_m]
//   cov ln theta = cov_0 + sum_m w_m g_m g_m' E[a² | z_m] - (its mean)(its mean)',
//   g_m = d ln theta/da = -J^+ phi_m,  w_m ~ prior of m times the marginal likelihood of z_m,
// J the weighted log slopes of the terms (and of a corner), phi_m those of the shape (J. A. Hoeting et al., "Bayesian
// Model Averaging", Stat. Sci. 14 (1999) 382, with the score in the place of a second maximum: R. D. Cook and S.
// Weisberg, Biometrika 70 (1983) 1). Shrinking is right on the average of the prior, not at every strength: where
// |z_m| is beyond 1 an interval reaches to where a_hat itself has the term. It does so (neighbours.cpp) for an
// exponent of the slow noise near one or two, whose phi is its share of the density times ln f, and for slow noise
// that ends at a frequency f_e, its share times -ln(1 + f²/f_e²), as that of a few processes does; both move N alone:
// B and K have no meaning apart from their exponents. And for a hump w²/((f - f_c)² + w²) of excitations that ring, or
// of a line that wanders, the clearest of a grid, from 2.5 standard deviations on, for N leaves its interval far below
// what is left out as a peak. Heavy tails of the prior leave a shape that is seen as it is; a larger scale covers N
// better where the tests are blind and costs more where there is nothing: tests/bench/valley_bench shows both.
#include "libchar/fit/detail/band/small_shape.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/fit/detail/band/band.hpp"
#include "libchar/fit/detail/band/bin_likelihood.hpp"

namespace libchar {
namespace {

constexpr auto kWhite = static_cast<std::size_t>(Term::white);
constexpr double kScale = 1.4;  ///< of the prior, in standard deviations of the shape
struct Order {
  int power;
  double falling, rising;  ///< prior weights of a shape that falls, that rises
};
/// Most sensors roll off from the first order on; the steeper, the later. Noise that rises does so
/// as quantization noise does.
constexpr std::array<Order, 3> kOrders = {{{1, 0.75, 0.9}, {2, 0.15, 0.07}, {4, 0.1, 0.03}}};
constexpr double kLeastWeight = 0.05;  ///< of a shape that intervals reach to
constexpr double kReachFrom = 1;       ///< standard deviations of a shape from which on intervals reach to it
constexpr double kHump = 2.5;          ///< the same of a hump: of twenty that are looked for one reaches 2 by chance
constexpr double kEnds = 1.5;          ///< the same of slow noise that ends
constexpr double kTaken = 1;           ///< standard deviations from which on the shape is a part of the model

double mean_sine_power(const PowerBin& bin, double rate_hz, int power) {
  constexpr int kNodes = 5;
  double sum = 0;
  for (int i = 0; i < kNodes; ++i) {
    const double f = bin.low_hz + (bin.high_hz - bin.low_hz) * (i + 0.5) / kNodes;
    const double sine = std::sin(std::numbers::pi * std::min(f / rate_hz, 0.5));
    sum += std::pow(sine * sine, power) / kNodes;
  }
  return sum;
}

struct Posterior {
  double marginal = 0;          ///< likelihood of z
  double mean = 0, square = 0;  ///< of the shape in its standard deviations
};

Posterior posterior_of(double z) {
  constexpr int kReach = 160;  ///< steps
  constexpr double kStep = 0.05;
  Posterior out;
  for (int i = -kReach; i < kReach; ++i) {
    const double apart = kStep * i, d = z + apart;
    const double weight = std::exp(-0.5 * apart * apart) / (1 + d * d / (kScale * kScale));
    out.marginal += weight;
    out.mean += weight * d;
    out.square += weight * d * d;
  }
  if (!(out.marginal > 0)) return {};  // of a z beyond all numbers
  out.mean /= out.marginal;
  out.square /= out.marginal;
  return out;
}

/// The bins inside a band without its small shape.
std::vector<PowerBin> inside_bins(const std::vector<PowerBin>& bins, const Band& band) {
  std::vector<PowerBin> inside;
  for (std::size_t j = 0; j < bins.size(); ++j)
    if (band.inside[j] != 0) inside.push_back(bins[j]);
  return inside;
}

/// Weighted log slopes of the terms and of the corner of a low-pass, and the residuals that would
/// be there without the small shape.
struct Slopes {
  Eigen::ArrayXd root;  ///< sqrt(nu/2)
  Eigen::MatrixXd columns;
  std::vector<std::size_t> terms;
  std::vector<bool> shown;   ///< of `terms`: above zero
  Eigen::VectorXd residual;  ///< sqrt(nu/2) (u - 1)
  Eigen::VectorXd taken;     ///< sqrt(nu/2) times the log gain that is in the model
};

Slopes slopes_of(const std::vector<PowerBin>& inside, const Band& band, const BinProblem& problem, const Mixture& theta,
                 const TermSet& terms, double rate_hz) {
  Slopes out;
  for (std::size_t i = 0; i < kTerms; ++i)
    if (terms[i] || theta[i] > 0) {
      out.terms.push_back(i);
      out.shown.push_back(theta[i] > 0);
    }
  out.root = (problem.dof / 2).sqrt();
  const Eigen::ArrayXd model = mixture_of(problem, theta);
  const auto count = static_cast<Eigen::Index>(out.terms.size());
  out.columns.resize(problem.size(), count + (band.low_pass ? 1 : 0));
  for (Eigen::Index i = 0; i < count; ++i) {
    const std::size_t term = out.terms[static_cast<std::size_t>(i)];
    // Of a term at zero the slope by theta itself: its scale does not matter here.
    const double scale = theta[term] > 0 ? theta[term] : 1;
    out.columns.col(i) = (out.root * scale * problem.unit.col(static_cast<Eigen::Index>(term)) / model).matrix();
  }
  out.residual = (out.root * (problem.energy / model - 1)).matrix();
  out.taken.resize(problem.size());
  for (Eigen::Index j = 0; j < problem.size(); ++j) {
    const PowerBin& bin = inside[static_cast<std::size_t>(j)];
    out.taken[j] = out.root[j] * small_shape_log_gain(band.small, bin, rate_hz);
    if (band.low_pass)
      out.columns(j, count) = out.root[j] * low_pass_gain(bin, band.low_pass->corner_hz, rate_hz).log_slope;
  }
  return out;
}

/// What one family says: its posterior, and what it moves.
struct Answer {
  double sd = 0;          ///< of the amplitude; 0: nothing can be said
  double z = 0;           ///< amplitude over sd
  double weight = 0;      ///< not yet of sum one
  Posterior posterior;    ///< in units of sd
  Eigen::VectorXd slope;  ///< d ln theta / d amplitude, of Slopes::terms
};

Answer answer_of(const Slopes& slopes, const Eigen::VectorXd& shape, const Order& family) {
  constexpr double kApart = 1e-6;  ///< of the shape's length that the terms leave over
  Answer out;
  const Eigen::VectorXd inside = pivoted_least_squares(slopes.columns, shape).x;
  const Eigen::VectorXd apart = shape - slopes.columns * inside;
  if (!(apart.norm() > kApart * shape.norm())) return out;
  out.sd = 1 / apart.norm();
  out.z = apart.dot(slopes.residual + slopes.taken) * out.sd;
  out.posterior = posterior_of(out.z);
  out.weight = (out.z < 0 ? family.falling : family.rising) * out.posterior.marginal;
  out.slope = -inside.head(static_cast<Eigen::Index>(slopes.terms.size()));
  return out;
}

/// How far the intervals of ln theta reach.
struct Reach {
  Eigen::VectorXd low, high;
};

/// From where the average has the terms to where the answer itself has them.
void reach_to(const Answer& answer, const Eigen::VectorXd& mean, Reach& reach) {
  if (!(std::abs(answer.z) > kReachFrom)) return;
  const Eigen::VectorXd apart = answer.z * answer.sd * answer.slope - mean;
  reach.low = reach.low.cwiseMin(apart);
  reach.high = reach.high.cwiseMax(apart);
}

using Answers = std::array<Answer, kOrders.size()>;

bool is_slow(std::size_t term) {
  return term == static_cast<std::size_t>(Term::flicker) || term == static_cast<std::size_t>(Term::walk);
}

/// Share of the slow noise in the model, weighted.
Eigen::VectorXd slow_share(const Slopes& slopes) {
  Eigen::VectorXd share = Eigen::VectorXd::Zero(slopes.root.size());
  for (std::size_t i = 0; i < slopes.terms.size(); ++i)
    if (is_slow(slopes.terms[i]) && slopes.shown[i]) share += slopes.columns.col(static_cast<Eigen::Index>(i));
  return share;
}

/// It moves white noise alone.
Answer slow_answer(const Slopes& slopes, const Eigen::VectorXd& shape) {
  Answer out = answer_of(slopes, shape, {0, 1, 1});
  for (std::size_t i = 0; i < slopes.terms.size(); ++i)
    if (out.slope.size() > 0 && is_slow(slopes.terms[i])) out.slope[static_cast<Eigen::Index>(i)] = 0;
  return out;
}

/// Of another exponent of the slow noise, and of slow noise that ends at a frequency, as that of a few processes does.
std::array<Answer, 2> slow_answers(const Slopes& slopes, const Eigen::ArrayXd& frequency) {
  const Eigen::VectorXd share = slow_share(slopes);
  if (share.isZero()) return {};
  std::array<Answer, 2> out = {slow_answer(slopes, (share.array() * frequency.log()).matrix()), {}};
  for (double end = frequency.maxCoeff(); end > 16 * frequency.minCoeff(); end /= 2) {
    const Answer ends = slow_answer(slopes, (-share.array() * (1 + (frequency / end).square()).log()).matrix());
    if (ends.z > std::max(kEnds, out[1].z)) out[1] = ends;
  }
  return out;
}

/// Of the clearest hump above the model.
Answer hump_answer(const Slopes& slopes, const Eigen::ArrayXd& frequency, double rate_hz) {
  constexpr std::array<double, 2> kQualities = {1.5, 4};
  constexpr double kLowest = 1.0 / 256;  ///< of half the rate
  const Eigen::MatrixXd basis = column_basis(slopes.columns);
  double clearest = kHump;
  Eigen::VectorXd best;
  for (const double quality : kQualities)
    for (double centre = rate_hz / 2; centre > kLowest * rate_hz / 2; centre *= std::exp2(-0.75 / quality)) {
      const double width = centre / (2 * quality);
      const Eigen::VectorXd hump = (slopes.root / (((frequency - centre) / width).square() + 1)).matrix();
      const Eigen::VectorXd apart = without_columns_of(basis, hump);
      const double z = apart.dot(slopes.residual + slopes.taken) / apart.norm();
      if (!(z > clearest)) continue;
      clearest = z;
      best = hump;
    }
  return best.size() > 0 ? answer_of(slopes, best, {0, 1, 1}) : Answer{};
}

Answers answers_of(const Slopes& slopes, const std::vector<PowerBin>& inside, const Band& band, double rate_hz) {
  Answers out;
  double total = 0;
  for (std::size_t f = 0; f < kOrders.size(); ++f) {
    // Quantization noise and the corner of a low-pass are that of first order.
    if (kOrders[f].power == 1 && (band.quantized || band.low_pass)) continue;
    Eigen::VectorXd shape(slopes.root.size());
    for (Eigen::Index j = 0; j < shape.size(); ++j)
      shape[j] = slopes.root[j] *
                 small_shape_log_gain({kOrders[f].power, 1, false}, inside[static_cast<std::size_t>(j)], rate_hz);
    out[f] = answer_of(slopes, shape, kOrders[f]);
    total += out[f].weight;
  }
  for (Answer& answer : out) answer.weight = total > 0 ? answer.weight / total : 0;
  return out;
}

/// exp(x), and beyond one its tangent: a term that is a small part of the record grows by as much as the shape takes
/// from the others, not by as many times; it falls in the same way, and never to zero.
double grown(double x) {
  if (x < 0) return 1 / grown(-x);
  return x <= 1 ? std::exp(x) : std::numbers::e * x;
}

/// A coefficient after ln theta was moved by `shift` and got `variance` more.
void move_term(double shift, double variance, Coefficient& term) {
  const double before = *term.value, now = before * std::sqrt(grown(shift));
  const double more = kNormal95 * kNormal95 * variance / 4;
  const auto moved = [&](double end) {
    if (!(end > 0) || !std::isfinite(end)) return end;
    const double distance = std::log(end / before), far = std::sqrt(distance * distance + more);
    const double beyond = far - std::abs(distance);
    const double times = beyond > 0.5 ? std::exp(std::abs(distance)) * std::sqrt(grown(2 * beyond)) : std::exp(far);
    return distance < 0 ? now / times : now * times;
  };
  term.ci95 = {moved(term.ci95.low), moved(term.ci95.high)};
  term.relative_sd = std::sqrt(term.relative_sd * term.relative_sd + variance / 4);
  term.value = now;
}

}  // namespace

double small_shape_log_gain(const SmallShape& shape, const PowerBin& bin, double rate_hz) {
  return shape.amplitude == 0 ? 0 : shape.amplitude * mean_sine_power(bin, rate_hz, shape.power);
}

double take_small_shape(const std::vector<PowerBin>& bins, double rate_hz, const TermSet& terms, Band& band) {
  constexpr int kRounds = 2;
  double taken = 0;
  const std::vector<PowerBin> inside = inside_bins(bins, band);
  for (int round = 0; round < kRounds; ++round) {
    const BinProblem problem = bin_problem(bins_of(bins, band, rate_hz));
    const ScoringResult now = score(problem, terms);
    const Slopes slopes = slopes_of(inside, band, problem, now.at.theta, terms, rate_hz);
    const Answers answers = answers_of(slopes, inside, band, rate_hz);
    const auto best = std::max_element(answers.begin(), answers.end(),
                                       [](const Answer& a, const Answer& b) { return a.weight < b.weight; });
    if (!(best->weight > 0) || !(std::abs(best->posterior.mean) > kTaken)) return taken;
    Band with = band;
    with.small = {kOrders[static_cast<std::size_t>(best - answers.begin())].power, best->posterior.mean * best->sd,
                  false};
    if (with.low_pass) {
      with.low_pass.reset();
      with.low_pass = fit_low_pass(bins_of(bins, with, rate_hz), rate_hz, terms);
      if (!with.low_pass) return taken;
    }
    // Beyond the reach of a straight line through the score it is no small shape.
    const ScoringResult changed = score(bin_problem(bins_of(bins, with, rate_hz)), terms);
    if (!(changed.half_deviance < now.half_deviance)) return taken;
    if (now.at.theta[kWhite] > 0 && !(changed.at.theta[kWhite] > 0)) return taken;  // it is in the place of a term
    band = std::move(with);
    taken = std::abs(best->posterior.mean);
  }
  return taken;
}

void average_over_small_shapes(const std::vector<PowerBin>& bins, const Band& band, const BinProblem& problem,
                               const ModelPoint& best, NoiseFit& fit) {
  if (problem.shapes() > 0 || problem.size() == 0 || count_of(only_positive(best.theta)) == 0) return;
  const std::vector<PowerBin> inside = inside_bins(bins, band);
  const Slopes slopes = slopes_of(inside, band, problem, best.theta, {}, fit.rate_hz);
  const auto n = static_cast<Eigen::Index>(slopes.terms.size());
  // What the shape in the model has moved already is a part of the mean, not of the shift.
  Eigen::VectorXd shift = pivoted_least_squares(slopes.columns, slopes.taken).x.head(n);
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(n);
  Eigen::MatrixXd more = Eigen::MatrixXd::Zero(n, n);
  const Answers answers = answers_of(slopes, inside, band, fit.rate_hz);
  for (const Answer& answer : answers) {
    if (!(answer.weight > 0)) continue;
    mean += answer.weight * answer.posterior.mean * answer.sd * answer.slope;
    more += answer.weight * answer.posterior.square * answer.sd * answer.sd * answer.slope * answer.slope.transpose();
  }
  more -= mean * mean.transpose();
  Reach reach{Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
  for (const Answer& answer : answers)
    if (answer.weight > kLeastWeight) reach_to(answer, mean, reach);
  Eigen::ArrayXd frequency(slopes.root.size());
  for (Eigen::Index j = 0; j < frequency.size(); ++j) frequency[j] = inside[static_cast<std::size_t>(j)].frequency_hz;
  for (const Answer& slow : slow_answers(slopes, frequency)) reach_to(slow, mean, reach);
  reach_to(hump_answer(slopes, frequency, fit.rate_hz), mean, reach);
  shift += mean;
  for (Eigen::Index a = 0; a < n; ++a) {
    const std::size_t i = slopes.terms[static_cast<std::size_t>(a)];
    if (!(fit.theta[i] > 0)) continue;  // lent to a law
    for (Eigen::Index b = 0; b < n; ++b) fit.covariance[i][slopes.terms[static_cast<std::size_t>(b)]] += more(a, b);
    fit.theta[i] *= grown(shift[a]);
    if (!fit.term[i].value) continue;
    move_term(shift[a], std::max(0.0, more(a, a)), fit.term[i]);
    if (!is_slow(i)) fit.term[i].ci95.low /= std::sqrt(grown(-reach.low[a]));
    if (!is_slow(i)) fit.term[i].ci95.high *= std::sqrt(grown(reach.high[a]));
  }
}

}  // namespace libchar
