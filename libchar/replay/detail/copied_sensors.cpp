#include "libchar/replay/detail/copied_sensors.hpp"

#include <algorithm>
#include <cmath>

namespace libchar {
namespace {

constexpr double kFloat = 0x1p-23;
constexpr double kSevenDigits = 3e-7;  ///< rms of their rounding, at most
constexpr double kLeastInstants = 100;
constexpr std::uint64_t kLeastMoves = 32;  ///< a switch or a coarse grid is alike by chance
constexpr double kLeastSteps = 8;  ///< rms of the moves over the last decimal: below, a noise may hide in rounding
constexpr double kMoreThanRounding = 2;
/// Candidates of a channel, and channels that are fitted: hundreds that are all alike must not cost their square.
constexpr std::size_t kMostOriginals = 8, kMostFitted = 256;
constexpr std::size_t kGlance = 64;
constexpr int kNoGrid = 10;
constexpr double kTens[kNoGrid] = {1, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9};

bool agree(double a, double b) { return std::abs(a - b) <= kFloat * std::max(std::abs(a), std::abs(b)); }

}  // namespace

double CopiedSensors::Channel::grid() const {
  return decimals < kNoGrid ? 1 / kTens[static_cast<std::size_t>(decimals)] : 0;
}

void CopiedSensors::Channel::take(double value) {
  const auto off = [&] {
    const double scaled = value * kTens[static_cast<std::size_t>(decimals)];
    return std::abs(scaled - std::nearbyint(scaled)) > 1e-9 * std::max(1.0, std::abs(scaled));
  };
  while (decimals < kNoGrid && off()) ++decimals;
  if (samples++ > 0 && value != last) {
    squares += (value - last) * (value - last);
    ++moves;
  }
  last = value;
}

CopiedSensors::Sums CopiedSensors::sums_of(std::span<const double> x, std::span<const double> y) {
  Sums out;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (!std::isfinite(x[k]) || !std::isfinite(y[k])) continue;
    out.equal = out.equal && agree(x[k], y[k]);
    ++out.n;
    out.x += x[k];
    out.y += y[k];
  }
  if (out.n == 0) return out;
  out.x /= out.n;
  out.y /= out.n;
  for (std::size_t k = 0; k < x.size(); ++k) {
    if (!std::isfinite(x[k]) || !std::isfinite(y[k])) continue;
    const double dx = x[k] - out.x, dy = y[k] - out.y;
    out.xx += dx * dx;
    out.xy += dx * dy;
    out.yy += dy * dy;
  }
  return out;
}

void CopiedSensors::merge(const Sums& more, Sums& all) {
  if (more.n == 0) return;
  const double n = all.n + more.n, dx = more.x - all.x, dy = more.y - all.y, w = all.n * more.n / n;
  all.xx += more.xx + w * dx * dx;
  all.xy += more.xy + w * dx * dy;
  all.yy += more.yy + w * dy * dy;
  all.x += dx * more.n / n;
  all.y += dy * more.n / n;
  all.n = n;
  all.equal = all.equal && more.equal;
}

bool CopiedSensors::on_line(const Pair& pair, const Sums& s) const {
  if (s.equal) return true;
  if (!(s.xx > 0) || !(s.yy > 0)) return s.xx == s.yy;
  const double slope = s.xy / s.xx, left = std::max(0.0, s.yy - s.xy * slope) / s.n;
  const double x = slope * channels_[pair.x].grid(), y = channels_[pair.y].grid();
  const double size = s.yy / s.n + s.y * s.y + slope * slope * s.x * s.x;
  return left <= kMoreThanRounding * (x * x + y * y) / 12 + kSevenDigits * kSevenDigits * size;
}

void CopiedSensors::find_pairs(std::span<const std::span<const double>> channels) {
  const bool fits = channels.size() <= kMostFitted;
  for (std::size_t y = 1; y < channels.size(); ++y) {
    std::size_t found = 0;
    for (std::size_t x = 0; x < y && found < kMostOriginals; ++x) {
      const std::size_t rows = channels[x].size(), glance = std::min(rows, kGlance);
      Pair pair{x, y, sums_of(channels[x].first(glance), channels[y].first(glance))};
      const auto may_be = [&] { return pair.sums.equal || (fits && on_line(pair, pair.sums)); };
      if (!may_be()) continue;
      pair.sums = sums_of(channels[x], channels[y]);
      if (!may_be()) continue;
      pairs_.push_back(pair);
      ++found;
    }
  }
}

void CopiedSensors::push(std::span<const std::span<const double>> channels) {
  channels_.resize(channels.size());
  for (std::size_t c = 0; c < channels.size(); ++c)
    for (const double value : channels[c])
      if (std::isfinite(value)) channels_[c].take(value);
  if (!begun_) {
    begun_ = true;
    find_pairs(channels);
    return;
  }
  std::erase_if(pairs_, [&](Pair& pair) {
    const Sums more = sums_of(channels[pair.x], channels[pair.y]);
    merge(more, pair.sums);
    return !on_line(pair, more);
  });
}

Likeness CopiedSensors::between(std::size_t a, std::size_t b) const {
  const auto coarse = [&](const Channel& c) {
    return c.squares < std::pow(kLeastSteps * c.grid(), 2) * static_cast<double>(c.moves);
  };
  if (a == b) return a < channels_.size() && channels_[a].moves >= kLeastMoves ? Likeness::equal : Likeness::none;
  for (const Pair& pair : pairs_) {
    if (pair.x != std::min(a, b) || pair.y != std::max(a, b) || pair.sums.n < kLeastInstants) continue;
    const Channel &x = channels_[pair.x], &y = channels_[pair.y];
    if (std::min(x.moves, y.moves) < kLeastMoves) return Likeness::none;
    if (pair.sums.equal) return Likeness::equal;
    return !coarse(x) && !coarse(y) && on_line(pair, pair.sums) ? Likeness::line : Likeness::none;
  }
  return Likeness::none;
}

}  // namespace libchar
