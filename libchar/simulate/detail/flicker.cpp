// Fractional differencing of order 1/2 (N. J. Kasdin, Proc. IEEE 83 (1995) 802) as a sum of first-order sections.
//
//   h_k = Gamma(k + 1/2)/(Gamma(k + 1) sqrt pi) = (1/pi) int_0^1 p^k dp / sqrt(p (1 - p))
//
// With p = 1/(1 + s), s = e^x, this is (1/pi) int p^k sqrt(s)/(1 + s) dx over all x. The integrand of h_k is analytic
// for |Im x| < pi, that of H(z) = sum_k h_k z^-k for |Im x| < pi/2 + pi nu (there 1 = p/z), so the trapezoid rule of
// step a converges like exp(-pi^2/a), at every lag and every frequency alike:
//
//   h_k = sum_j w_j p_j^k,  s_j = e^(j a),  p_j = 1/(1 + s_j),  w_j = (a/pi) sqrt(s_j)/(1 + s_j).
//
// The sum has no end on either side. What lies beyond the record (s < 1/(2N)) is replaced by its own Gauss rule in s,
// what lies below p = 1/2 by its own Gauss rule in p (Stieltjes procedure on the discrete measure, then Golub and
// Welsch, Math. Comp. 23 (1969) 221): p^k is close to a polynomial of low degree there.
//
// Every section x_j[t] = p_j x_j[t-1] + g[t] is driven by the same deviate. Jointly stationary, the states have
// covariance C_ij = 1/(1 - p_i p_j), the Gram matrix of Szego kernels; the Takenaka-Malmquist functions are orthonormal
// in that space, which gives the Cholesky factor in closed form:
//
//   L_jk = sqrt(1 - p_k^2)/(1 - p_k p_j) prod_{l<k} (p_j - p_l)/(1 - p_l p_j).

#include "libchar/simulate/detail/flicker.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "libchar/core/numeric/dense.hpp"
#include "libchar/core/numeric/lanes.hpp"
#include "libchar/core/numeric/whole.hpp"

namespace libchar {
namespace {

// Parallel first-order sections, four in a vector.

struct Sections {
  const double* loss;
  const double* weight;
  double* state;
  std::size_t vectors;  ///< of four sections
};

constexpr std::size_t kSectionBlock = 256;
constexpr std::size_t kMostVectors = 7;

/// V vectors of sections over a block: their sum is put into (First) or added to `sums`.
template <std::size_t V, bool First>
inline __attribute__((always_inline)) void pass(const double* loss, const double* weight, double* state,
                                                const double* values, Four* sums, std::size_t count) {
  Four x[V], q[V], w[V];
  for (std::size_t v = 0; v < V; ++v) {
    x[v] = LIBCHAR_FOUR(state + 4 * v);
    q[v] = LIBCHAR_FOUR(loss + 4 * v);
    w[v] = LIBCHAR_FOUR(weight + 4 * v);
  }
  for (std::size_t t = 0; t < count; ++t) {
    const double value = values[t];
    const Four g = {value, value, value, value};
#pragma GCC unroll 8
    for (std::size_t v = 0; v < V; ++v) x[v] += w[v] * g - q[v] * x[v];
    Four sum = x[0];
#pragma GCC unroll 8
    for (std::size_t v = 1; v < V; ++v) sum += x[v];
    if constexpr (First)
      sums[t] = sum;
    else
      sums[t] += sum;
  }
  for (std::size_t v = 0; v < V; ++v) LIBCHAR_FOUR_TO(state + 4 * v) = x[v];
}

template <bool First>
inline __attribute__((always_inline)) void pass_of(std::size_t vectors, const double* loss, const double* weight,
                                                   double* state, const double* values, Four* sums, std::size_t count) {
  switch (vectors) {
    case 1:
      return pass<1, First>(loss, weight, state, values, sums, count);
    case 2:
      return pass<2, First>(loss, weight, state, values, sums, count);
    case 3:
      return pass<3, First>(loss, weight, state, values, sums, count);
    case 4:
      return pass<4, First>(loss, weight, state, values, sums, count);
    case 5:
      return pass<5, First>(loss, weight, state, values, sums, count);
    case 6:
      return pass<6, First>(loss, weight, state, values, sums, count);
    default:
      return pass<7, First>(loss, weight, state, values, sums, count);
  }
}

LIBCHAR_LANES void run_block_lanes(const double* loss, const double* weight, double* state, std::size_t vectors,
                                   double level, double* values, std::size_t count) {
  std::array<Four, kSectionBlock> sums;
  std::size_t passes = (vectors + kMostVectors - 1) / kMostVectors, done = 0;
  for (bool first = true; done < vectors; first = false, --passes) {
    const std::size_t now = (vectors - done) / passes;
    const std::size_t at = 4 * done;
    if (first)
      pass_of<true>(now, loss + at, weight + at, state + at, values, sums.data(), count);
    else
      pass_of<false>(now, loss + at, weight + at, state + at, values, sums.data(), count);
    done += now;
  }
  for (std::size_t t = 0; t < count; ++t) values[t] = ((sums[t][0] + sums[t][1]) + (sums[t][2] + sums[t][3])) - level;
}
constexpr InLanes<run_block_lanes> run_block;

/// x_j += weight_j g - loss_j x_j for every value g, which is replaced by sum_j x_j - level. The
/// same bits with and without AVX, whatever the number of values a call.
void run_sections(const Sections& sections, double level, std::span<double> values) {
  for (std::size_t t = 0; t < values.size(); t += kSectionBlock)
    run_block(sections.loss, sections.weight, sections.state, sections.vectors, level, values.data() + t,
              std::min(kSectionBlock, values.size() - t));
}

constexpr double kStep = 0.62;          // a: exp(-pi^2/a) = 1.2e-7
constexpr int kSlowNodes = 5;           // Gauss nodes for s < 1/(2 length)
constexpr int kFastNodes = 4;           // Gauss nodes for p < 1/2
constexpr int kTailTerms = 200;         // of either tail: e^(-200 a/2) = 1e-27 of its weight
constexpr double kShortestRecord = 64;  // shorter ones get this design

struct Rule {
  std::vector<double> node, weight;
};

double node_weight(double s) { return kStep / std::numbers::pi * std::sqrt(s) / (1 + s); }

/// The Gauss rule of n nodes of the discrete measure that has `weight` at `node` (largest node first).
Rule gauss_rule(const Rule& measure, int n) {
  const double scale = measure.node.front();
  const Eigen::Map<const Eigen::ArrayXd> raw(measure.node.data(), static_cast<Eigen::Index>(measure.node.size()));
  const Eigen::Map<const Eigen::ArrayXd> w(measure.weight.data(), raw.size());
  const Eigen::ArrayXd t = raw / scale;
  Eigen::VectorXd diagonal(n), beside(n - 1);
  Eigen::ArrayXd before = Eigen::ArrayXd::Zero(t.size());
  Eigen::ArrayXd now = Eigen::ArrayXd::Constant(t.size(), 1 / std::sqrt(w.sum()));
  for (int k = 0; k < n; ++k) {
    diagonal[k] = (w * t * now.square()).sum();
    Eigen::ArrayXd next = (t - diagonal[k]) * now;
    if (k > 0) next -= beside[k - 1] * before;
    if (k + 1 == n) break;
    beside[k] = std::sqrt((w * next.square()).sum());
    before = now;
    now = next / beside[k];
  }
  const SymmetricEigen eigen = tridiagonal_eigen(diagonal, beside);
  Rule rule;
  for (int k = n; k-- > 0;) {  // largest node first
    rule.node.push_back(eigen.values[k] * scale);
    rule.weight.push_back(w.sum() * std::pow(eigen.vectors(0, k), 2));
  }
  return rule;
}

/// The trapezoid nodes j = first, first + step, ... as far as they count, as a measure in node(s).
template <typename Node>
Rule tail(int first, int step, const Node& node) {
  Rule measure;
  for (int i = 0; i < kTailTerms; ++i) {
    const double s = std::exp(kStep * (first + step * i));
    measure.node.push_back(node(s));
    measure.weight.push_back(node_weight(s));
  }
  return measure;
}

/// 1 - p_i p_j from the losses q = 1 - p: nothing cancels.
double gap(double qi, double qj) { return qi + qj - qi * qj; }

}  // namespace

FlickerFilter design_flicker(std::uint64_t length) {
  const double n = std::max(kShortestRecord, static_cast<double>(length == 0 ? kLongestFlicker : length));
  const int first = clamped_whole<int>(std::floor(-std::log(2 * n) / kStep));
  const Rule fast = gauss_rule(tail(1, 1, [](double s) { return 1 / (1 + s); }), kFastNodes);
  const Rule slow = gauss_rule(tail(first - 1, -1, [](double s) { return s; }), kSlowNodes);
  FlickerFilter filter;
  for (std::size_t k = kFastNodes; k-- > 0;) {
    filter.loss.push_back(1 - fast.node[k]);
    filter.weight.push_back(fast.weight[k]);
  }
  for (int j = 0; j >= first; --j) {
    const double s = std::exp(kStep * j);
    filter.loss.push_back(s / (1 + s));
    filter.weight.push_back(node_weight(s));
  }
  for (std::size_t k = 0; k < kSlowNodes; ++k) {
    filter.loss.push_back(slow.node[k] / (1 + slow.node[k]));
    filter.weight.push_back(slow.weight[k]);
  }
  return filter;
}

std::vector<double> stationary_factor(const FlickerFilter& filter) {
  const std::vector<double>& q = filter.loss;
  const std::size_t n = q.size();
  std::vector<double> factor(n * n, 0.0);
  for (std::size_t j = 0; j < n; ++j) {
    double product = 1;
    for (std::size_t k = 0; k <= j; ++k) {
      factor[j * n + k] = std::sqrt(gap(q[k], q[k])) / gap(q[k], q[j]) * product;
      product *= (q[k] - q[j]) / gap(q[k], q[j]);
    }
  }
  return factor;
}

std::vector<double> stationary_states(const FlickerFilter& filter, DeviateStream& deviates) {
  const std::size_t n = filter.loss.size();
  const std::vector<double> factor = stationary_factor(filter);
  std::vector<double> drawn(n), states(n, 0.0);
  deviates.fill_normal(drawn);
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t k = 0; k <= j; ++k) states[j] += factor[j * n + k] * drawn[k];
  return states;
}

FlickerStream::FlickerStream(const FlickerFilter& filter) : loss_(filter.loss), weight_(filter.weight) {
  const std::size_t whole = (loss_.size() + 3) / 4 * 4;
  loss_.resize(whole, 1.0);  // a section of weight 0
  weight_.resize(whole, 0.0);
  state_.assign(whole, 0.0);
}

FlickerStream::FlickerStream(const FlickerFilter& filter, DeviateStream& start_deviates) : FlickerStream(filter) {
  const std::vector<double> states = stationary_states(filter, start_deviates);
  for (std::size_t j = 0; j < states.size(); ++j) {
    state_[j] = weight_[j] * states[j];
    level_ += state_[j];
  }
}

void FlickerStream::run(std::span<double> values) {
  run_sections({loss_.data(), weight_.data(), state_.data(), loss_.size() / 4}, level_, values);
}

// N. J. Kasdin, "Discrete simulation of colored noise and stochastic processes and 1/f^alpha power
// law noise generation", Proc. IEEE 83 (1995) 802-827; [RV 1.19-1.28].

namespace {

/// Sum of a[i] b[i] in eight lanes, the same with and without AVX.
LIBCHAR_LANES double dot_lanes(const double* a, const double* b, std::size_t count) {
  Four low = {}, high = {};
  std::size_t i = 0;
  for (; i + 8 <= count; i += 8) {
    low += LIBCHAR_FOUR(a + i) * LIBCHAR_FOUR(b + i);
    high += LIBCHAR_FOUR(a + i + 4) * LIBCHAR_FOUR(b + i + 4);
  }
  double rest = 0;
  for (; i < count; ++i) rest += a[i] * b[i];
  const Four sum = low + high;
  return ((sum[0] + sum[1]) + (sum[2] + sum[3])) + rest;
}
constexpr InLanes<dot_lanes> dot;

}  // namespace

TruncatedKasdin::TruncatedKasdin(std::size_t taps) : reversed_(taps) {
  double b = 1;
  for (std::size_t k = 1; k <= taps; ++k) {
    b = b * (static_cast<double>(k) - 1.5) / static_cast<double>(k);
    reversed_[taps - k] = -b;
  }
  past_.assign(std::max<std::size_t>(2 * taps, taps + 1024), 0.0);
}

void TruncatedKasdin::run(std::span<double> values) {
  const std::size_t taps = reversed_.size();
  for (double& value : values) {
    if (at_ + taps == past_.size()) {
      std::copy(past_.end() - static_cast<std::ptrdiff_t>(taps), past_.end(), past_.begin());
      at_ = 0;
    }
    value += dot(reversed_.data(), past_.data() + at_, taps);
    past_[at_ + taps] = value;
    ++at_;
  }
}

}  // namespace libchar
