// With u = t + 1/2, theta_k = pi k / n, the orthonormal DCT-II of a cos(w u) + b sin(w u) is, for k >= 1,
//   c_k = sqrt(2/n) / 4 {a s (-1)^k + b [1 - (-1)^k c]} {1 / sin[(w + theta_k)/2] + 1 / sin[(w - theta_k)/2]},
//   s = sin(n w), c = cos(n w)
// (sums of sines in arithmetic progression). It falls only as 1/(k - k0): a heating cycle of a
// thousand times the floor hides the flicker and the random walk of the record, whether or not its
// own coefficients are left out. So the strongest are fitted by least squares (the frequency by the
// reduction of the squares) in a window about their peak, subtracted, and fitted again beside each
// other, as CLEAN does (J. A. Hogbom, Astronomy and Astrophysics Supplement 15, 1974).
#include "libchar/fit/detail/record/cycles.hpp"

#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/whole.hpp"

namespace libchar::detail {
namespace {

constexpr std::size_t kLowestPeak = 5;      ///< two and a half periods in the record
constexpr std::size_t kHighestPeak = 2048;  ///< beyond, what is left out reaches far enough
constexpr std::size_t kReach = 16;          ///< of the window on either side
constexpr std::size_t kMostCycles = 24;
constexpr double kStandsOut = 32;  ///< a peak over the median beside it
/// Squares in the window, without the sine and with it: noise alone reaches that once in 10^7 windows (F of 3 and 30),
/// and a peak of it has to stand out before.
constexpr double kReduction = 4;
/// From here on it is worth taking out although its period is not steady and leaves something at the peak.
constexpr double kPure = 30;

/// A sine at coefficient `place` (half periods in the record) and its two columns.
struct Sine {
  double place = 0;
  Eigen::Vector2d size = Eigen::Vector2d::Zero();
};

/// The first coefficients of a transform of `length` points.
struct Head {
  std::span<double> rest;
  std::size_t length = 0;
};

struct Window {
  std::size_t from = 0, to = 0;  ///< coefficients from .. to-1
  Head head;

  Window(const Head& of, std::size_t peak)
      : from(peak > kReach ? std::max<std::size_t>(1, peak - kReach) : 1),
        to(std::min(of.rest.size(), peak + kReach + 1)),
        head(of) {}

  /// Flicker, between white noise and random walk, has equal weights then.
  double weight(std::size_t k) const { return std::sqrt(static_cast<double>(k)); }
  double squares() const {
    double sum = 0;
    for (std::size_t k = from; k < to; ++k) sum += std::pow(weight(k) * head.rest[k], 2);
    return sum;
  }
  /// Squares left beside the best sine at a place.
  double squares_beside(Sine& sine) const {
    const auto rows = static_cast<Eigen::Index>(to - from);
    constexpr int kMostRows = 2 * kReach + 1;
    Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::ColMajor, kMostRows> columns(rows, 2);
    Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostRows> values(rows);
    const SineColumns sines(sine.place, head.length);
    for (std::size_t k = from; k < to; ++k) {
      const auto row = static_cast<Eigen::Index>(k - from);
      columns.row(row) = weight(k) * sines.at(k);
      values(row) = weight(k) * head.rest[k];
    }
    sine.size = columns.colPivHouseholderQr().solve(values);
    return (values - columns * sine.size).squaredNorm();
  }
};

/// Whether what is left at the peak is noise as it is beside: a steady sine leaves nothing.
bool is_steady(const Window& window, const Sine& sine) {
  constexpr double kNear = 3, kMost = 4;  ///< of the mean squares: F of 7 and 26
  const SineColumns sines(sine.place, window.head.length);
  double near = 0, far = 0, near_n = 0, far_n = 0;
  for (std::size_t k = window.from; k < window.to; ++k) {
    const bool at_peak = std::abs(static_cast<double>(k) - sine.place) <= kNear;
    const double left = window.weight(k) * (window.head.rest[k] - sines.at(k).dot(sine.size.transpose()));
    (at_peak ? near : far) += left * left;
    (at_peak ? near_n : far_n) += 1;
  }
  return near * far_n < kMost * far * near_n;
}

/// The best sine within a coefficient and a half of the peak; by the step of the places where none is near.
Sine fitted_sine(const Window& window, double peak, double& left) {
  constexpr int kPlaces = 30, kThirds = 24;
  constexpr double kHopeful = 1.5;  ///< of `kReduction`, where the place is .05 off
  Sine best;
  left = -1;
  double step = 3.0 / kPlaces;
  for (int i = 0; i <= kPlaces; ++i) {
    Sine sine{off_grid(peak - 1.5 + i * step)};
    const double squares = window.squares_beside(sine);
    if (left >= 0 && squares >= left) continue;
    left = squares;
    best = sine;
  }
  if (!(window.squares() > kHopeful * left)) return best;
  double low = best.place - step, high = best.place + step;
  for (int i = 0; i < kThirds; ++i) {
    Sine one{off_grid(low + (high - low) / 3)}, two{off_grid(high - (high - low) / 3)};
    if (window.squares_beside(one) < window.squares_beside(two))
      high = two.place;
    else
      low = one.place;
  }
  best.place = off_grid(0.5 * (low + high));
  left = window.squares_beside(best);
  return best;
}

void add(const Sine& sine, double times, const Head& head) {
  const SineColumns sines(sine.place, head.length);
  for (std::size_t k = 1; k < head.rest.size(); ++k) head.rest[k] += times * sines.at(k).dot(sine.size.transpose());
}

/// Over the median beside it, which is sought only where half of them are low enough.
bool stands_out(std::span<const double> rest, std::size_t peak) {
  const double limit = rest[peak] * rest[peak] / kStandsOut;
  std::array<double, 2 * kReach> beside;
  std::size_t n = 0, low = 0;
  const auto look = [&](std::size_t k) { low += (beside[n++] = rest[k] * rest[k]) < limit ? 1 : 0; };
  for (std::size_t d = 3; d <= kReach; ++d) {
    if (peak > d) look(peak - d);
    if (peak + d < rest.size()) look(peak + d);
  }
  return 2 * low >= n && limit > median_in_place(std::span(beside).first(n));
}

/// The highest peak that stands out of what is beside it and is none of those looked at.
std::optional<std::size_t> next_peak(std::span<const double> rest, const std::vector<std::size_t>& looked_at) {
  std::optional<std::size_t> best;
  const std::size_t end = std::min(rest.size() - 1, kHighestPeak);
  for (std::size_t k = kLowestPeak; k < end; ++k) {
    const double square = rest[k] * rest[k];
    if (best && square <= rest[*best] * rest[*best]) continue;
    if (square < rest[k - 1] * rest[k - 1] || square < rest[k + 1] * rest[k + 1]) continue;
    const bool known = std::any_of(looked_at.begin(), looked_at.end(),
                                   [&](std::size_t other) { return other + 1 >= k && k + 1 >= other; });
    if (!known && stands_out(rest, k)) best = k;
  }
  return best;
}

double energy_over_floor(const Sine& sine, const Window& window, double left) {
  double weights = 0;
  for (std::size_t k = window.from; k < window.to; ++k) weights += std::pow(window.weight(k), 2);
  const double n = static_cast<double>(window.head.length);
  return 0.5 * n * sine.size.squaredNorm() * weights / left;
}

/// A line whose leak ends before the slow end is left out as all lines are.
bool reaches_the_end(const Sine& sine, const Window& window, double left) {
  return 4 * std::sqrt(10 * energy_over_floor(sine, window, left)) > sine.place;
}

/// What is periodic but no sine has harmonics too weak to stand out by themselves; where they are is known.
void take_out_harmonics(std::vector<Sine>& found, const Head& head) {
  constexpr double kWorthIt = 8;  ///< energy over the floor: noise has that at one place of fifty
  constexpr int kMostMissed = 6;
  const Sine base = *std::max_element(found.begin(), found.end(), [](const Sine& a, const Sine& b) {
    return a.size.squaredNorm() < b.size.squaredNorm();
  });
  const auto end = static_cast<double>(std::min(head.rest.size() - kReach, kHighestPeak));
  int missed = 0;
  for (double place = 2 * base.place; place < end && missed < kMostMissed; place += base.place) {
    const bool known =
        std::any_of(found.begin(), found.end(), [&](const Sine& other) { return std::abs(other.place - place) < 1.5; });
    if (known) continue;
    const Window window(head, clamped_whole<std::size_t>(std::round(place)));
    Sine sine{off_grid(place)};
    const double left = window.squares_beside(sine);
    if (energy_over_floor(sine, window, left) < kWorthIt) {
      ++missed;
      continue;
    }
    missed = 0;
    add(sine, -1, head);
    found.push_back(sine);
  }
}

}  // namespace

SineColumns::SineColumns(double place, std::size_t n)
    : half_unit(std::numbers::pi / static_cast<double>(n) / 2),
      half_sine(std::sin(half_unit * place)),
      half_cosine(std::cos(half_unit * place)),
      scale(std::sqrt(2 / static_cast<double>(n)) / 4),
      sine(std::sin(std::numbers::pi * place)),
      cosine(std::cos(std::numbers::pi * place)) {}

Eigen::RowVector2d SineColumns::at(std::size_t k) const {
  const double half_theta = half_unit * static_cast<double>(k);
  return at(k, std::sin(half_theta), std::cos(half_theta));
}

double off_grid(double place) {
  constexpr double kOff = 1e-6;
  const double from = place - std::round(place);
  return std::abs(from) < kOff ? std::round(place) + kOff : place;
}

std::vector<PooledPower::Cycle> take_out_cycles(std::span<double> coefficients, std::size_t length) {
  const Head head{coefficients, length};
  std::vector<Sine> found;
  if (coefficients.size() < 4 * kReach) return {};
  std::vector<std::size_t> looked_at;
  while (found.size() < kMostCycles && looked_at.size() < 2 * kMostCycles) {
    const std::optional<std::size_t> peak = next_peak(coefficients, looked_at);
    if (!peak) break;
    looked_at.push_back(*peak);
    const Window window(head, *peak);
    double left = 0;
    const Sine sine = fitted_sine(window, static_cast<double>(*peak), left);
    const double reduction = window.squares() / left;
    if (!(reduction > kReduction) || !reaches_the_end(sine, window, left)) continue;
    if (!(reduction > kPure) && !is_steady(window, sine)) continue;
    add(sine, -1, head);
    found.push_back(sine);
  }
  constexpr int kRounds = 3;
  for (int round = 0; found.size() > 1 && round < kRounds; ++round)
    for (Sine& sine : found) {
      add(sine, 1, head);
      double left = 0;
      sine = fitted_sine(Window(head, clamped_whole<std::size_t>(std::round(sine.place))), sine.place, left);
      add(sine, -1, head);
    }
  if (!found.empty()) take_out_harmonics(found, head);
  std::vector<PooledPower::Cycle> cycles;
  for (const Sine& sine : found)
    cycles.push_back({sine.place, sine.size.norm(), std::atan2(sine.size(1), sine.size(0))});
  return cycles;
}

}  // namespace libchar::detail
