// Differences of white noise x, y_t = x_t - x_(t-1), t = 1..n, have the covariance of a line of
// springs whose ends are held; the DCT-II belongs to free ends. By summation by parts, with s_k the
// orthonormal DST-I of x_1..x_(n-1), which is white,
//   c_k = 2 sin(a/2) s_k + sqrt(2/n) cos(a/2) [(-1)^k x_n - x_0],     a = pi k/n.
// The second part is two random numbers that reach all coefficients, one the even and one the odd ones: slow
// coefficients are not independent, and a record in four looks as if white frequency noise stood below its phase noise.
// It is what a change of the first and of the last sample does, so both are taken out as if they were missing, by
// generalised least squares in the powers p_k of the rest: with u_k = sqrt(2/n) cos(a/2) over one parity
//   alpha = sum u c/p / sum u²/p,  share of c_k's variance that goes with it: h_k = (u_k²/p_k) / sum u²/p.
#include "libchar/fit/detail/record/ends.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "libchar/fit/detail/band/bin_likelihood.hpp"
#include "libchar/fit/detail/events/series_powers.hpp"
#include "libchar/fit/detail/record/dct_means.hpp"

namespace libchar::detail {
namespace {

constexpr auto kQuantization = static_cast<std::size_t>(Term::quantization);
constexpr auto kFlickerPhase = static_cast<std::size_t>(Term::ramp);
constexpr std::uint64_t kReachOfEnds = 1U << 16U;  ///< coefficients; the sums over the rest are 1e-5 of all

double sine_of_half(double k, std::uint64_t n) { return std::sin(0.5 * std::numbers::pi * k / static_cast<double>(n)); }

/// Of the mixture without the ends of its quantization.
double power_at(const EndNoise& noise, double k, std::uint64_t n, std::uint64_t m) {
  const auto width = static_cast<double>(m);
  const std::array<double, kTerms> unit = mean_unit_powers(k, n, m, noise.dt_s);
  double slow = 0;
  for (const Term term : {Term::white, Term::flicker, Term::walk})
    slow += noise.theta[static_cast<std::size_t>(term)] * unit[static_cast<std::size_t>(term)];
  const double flicker_phase = 2 * sine_of_half(k, n) / (noise.dt_s * noise.dt_s);
  return width * slow + noise.theta[kQuantization] / width * quantization_without_ends(k, n, noise.dt_s) +
         noise.theta[kFlickerPhase] / width * flicker_phase;
}

/// Of the ends in coefficient k of n means of m samples.
double share_at(const EndNoise& noise, double k, std::uint64_t n, std::uint64_t m) {
  const double cosine = std::cos(0.5 * std::numbers::pi * k / static_cast<double>(n));
  const double theirs =
      noise.theta[kQuantization] * 4 / static_cast<double>(n * m) * cosine * cosine / (noise.dt_s * noise.dt_s);
  return theirs > 0 ? theirs / (theirs + power_at(noise, k, n, m)) : 0;
}

}  // namespace

double quantization_without_ends(double k, std::uint64_t n, double dt_s) {
  const double both = 2 * sine_of_half(k, n) / dt_s;
  return both * both;
}

double share_of_ends(const EndNoise& noise, std::uint64_t n) {
  double largest = 0;
  for (double k = 1; k < static_cast<double>(n); k *= 2) largest = std::max(largest, share_at(noise, k, n, 1));
  return largest;
}

void leave_out_ends(const EndNoise& noise, PooledPower& power) {
  constexpr double kMost = 0.05;
  std::size_t in = 0;
  for (std::size_t i = 0; i < power.mean.size(); ++i)
    if (share_at(noise, static_cast<double>(power.first + i), power.length, power.spacing) > kMost)
      in = i + 1;
    else if (i > in + 64)  // the share falls with k, but for a slow term above it
      break;
  const auto first = static_cast<std::ptrdiff_t>(in);
  power.first += in;
  for (std::vector<double>* values : {&power.mean, &power.of_events, &power.without_cycles})
    if (!values->empty()) values->erase(values->begin(), values->begin() + first);
}

namespace {

/// The ends of a record, by its first coefficients.
struct Ends {
  std::array<double, 2> size{};  ///< alpha, of even and of odd coefficients
  std::vector<double> power;     ///< p, k = 1.. at [k-1]
  std::vector<double> share;     ///< h, at [k]
  double deviance = 0;           ///< -2 ln L of the coefficients with unknown ends, but for a constant
};

double end_at(std::uint64_t k, std::uint64_t n) {
  const double sine = sine_of_half(static_cast<double>(k), n);
  return std::sqrt(2 / static_cast<double>(n) * (1 - sine * sine));
}

/// `c`: coefficients 0..reach of a record of n samples.
Ends ends_of(std::span<const double> c, std::uint64_t n, const EndNoise& noise) {
  Ends ends;
  const std::size_t reach = c.size() - 1;
  ends.power = std::move(
      at_every_k(reach + 1, 1, [&](double k, std::span<double> out) { out[0] = power_at(noise, k, n, 1); })[0]);
  ends.share.resize(reach + 1);
  std::array<double, 2> product{}, square{};
  for (std::size_t k = 1; k <= reach; ++k) {
    const double u = end_at(k, n), weight = u / ends.power[k - 1];
    ends.share[k] = u * weight;
    product[k % 2] += weight * c[k];
    square[k % 2] += ends.share[k];
    ends.deviance += std::log(ends.power[k - 1]) + c[k] * c[k] / ends.power[k - 1];
  }
  for (const std::size_t odd : {0U, 1U}) {
    ends.size[odd] = product[odd] / square[odd];
    ends.deviance += std::log(square[odd]) - product[odd] * ends.size[odd];
  }
  for (std::size_t k = 1; k <= reach; ++k) ends.share[k] /= square[k % 2];
  return ends;
}

/// Bins of the first coefficients as they are expected without the ends.
std::vector<PowerBin> expected_bins(std::span<const double> c, std::uint64_t n, const Ends& ends, double dt_s) {
  PooledPower power{n, 1, 1, 1, {}};
  power.with_ends.assign(1, 0.0);
  for (std::size_t k = 1; k < c.size(); ++k) {
    const double left = c[k] - ends.size[k % 2] * end_at(k, n);
    power.mean.push_back(left * left + ends.share[k] * ends.power[k - 1]);
  }
  return power_bins(std::span(&power, 1), 1 / dt_s);
}

struct Likeliest {
  EndNoise noise;
  double deviance = 0;
};

/// Of these terms with unknown ends, by expectation and maximisation from `start` on (A. Dempster, N. Laird, D. Rubin,
/// Journal of the Royal Statistical Society B 39, 1977).
Likeliest likeliest(std::span<const double> c, std::uint64_t n, const TermSet& terms, bool clock, EndNoise start) {
  constexpr int kRounds = 8;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<PowerBin> bins = expected_bins(c, n, ends_of(c, n, start), start.dt_s);
    if (clock) lend_flicker_phase(1 / start.dt_s, bins);
    start.theta = score(bin_problem(bins), terms).at.theta;
  }
  return {start, ends_of(c, n, start).deviance};
}

}  // namespace

EndNoise noise_with_ends(std::span<const double> coefficients, const EndNoise& start, bool clock) {
  constexpr double kJoins = 6;  ///< of 2 ln L
  constexpr std::size_t kHead = 1U << 14U;
  const std::size_t n = coefficients.size();
  const std::span<const double> c = coefficients.first(std::min<std::size_t>(n, kHead));
  TermSet terms{};
  terms[kQuantization] = true;
  terms[kFlickerPhase] = clock;
  const auto with = [&](std::size_t term, EndNoise from) {
    TermSet more = terms;
    more[term] = true;
    if (!(from.theta[term] > 0)) from.theta[term] = start.theta[term];
    return likeliest(c, n, more, clock, from);
  };
  EndNoise only = start;
  for (std::size_t i = 0; i < kTerms; ++i)
    if (!terms[i]) only.theta[i] = 0;
  Likeliest now = likeliest(c, n, terms, clock, only);
  for (;;) {
    std::optional<std::size_t> joins;
    Likeliest best = now;
    best.deviance -= kJoins;
    for (const Term term : {Term::white, Term::flicker, Term::walk}) {
      const auto i = static_cast<std::size_t>(term);
      if (terms[i]) continue;
      const Likeliest more = with(i, now.noise);
      if (!(more.deviance < best.deviance)) continue;
      best = more;
      joins = i;
    }
    if (!joins) return now.noise;
    terms[*joins] = true;
    now = best;
  }
}

std::vector<double> take_out_ends(std::span<double> coefficients, const EndNoise& noise) {
  const std::size_t n = coefficients.size();
  Ends ends = ends_of(coefficients.first(std::min<std::size_t>(n, kReachOfEnds + 1)), n, noise);
  for (std::size_t k = 1; k < n; ++k) coefficients[k] -= ends.size[k % 2] * end_at(k, n);
  return std::move(ends.share);
}

}  // namespace libchar::detail
