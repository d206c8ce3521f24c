#include "libchar/replay/detail/plan/copied_sensors.hpp"

#include <algorithm>
#include <cmath>

namespace libchar {
namespace {

constexpr double kFloat = 0x1p-23;
constexpr std::uint64_t kLeastInstants = 100;
/// Candidates a sensor: hundreds of sensors that are all alike must not cost their square.
constexpr std::size_t kMostOriginals = 8;

bool agree(double a, double b) { return std::abs(a - b) <= kFloat * std::max(std::abs(a), std::abs(b)); }

/// Instants in which both have a sample; none when one of them differs.
std::optional<std::uint64_t> in_common(const Eigen::MatrixXd& samples, Eigen::Index i, Eigen::Index j) {
  std::uint64_t common = 0;
  for (Eigen::Index k = 0; k < samples.cols(); ++k) {
    const double a = samples(i, k), b = samples(j, k);
    if (!std::isfinite(a) || !std::isfinite(b)) continue;
    if (!agree(a, b)) return std::nullopt;
    ++common;
  }
  return common;
}

}  // namespace

void CopiedSensors::find_pairs(const Eigen::MatrixXd& samples) {
  for (Eigen::Index copy = 1; copy < samples.rows(); ++copy) {
    std::size_t found = 0;
    for (Eigen::Index original = 0; original < copy && found < kMostOriginals; ++original)
      if (const auto common = in_common(samples, copy, original)) {
        pairs_.push_back({copy, original, *common});
        ++found;
      }
  }
}

void CopiedSensors::push(const Eigen::MatrixXd& samples) {
  if (!begun_) {
    begun_ = true;
    find_pairs(samples);
    return;
  }
  std::erase_if(pairs_, [&](Pair& pair) {
    const auto common = in_common(samples, pair.copy, pair.original);
    pair.instants += common.value_or(0);
    return !common;
  });
}

std::optional<std::size_t> CopiedSensors::original_of(std::size_t sensor) const {
  for (const Pair& pair : pairs_)
    if (static_cast<std::size_t>(pair.copy) == sensor && pair.instants >= kLeastInstants)
      return static_cast<std::size_t>(pair.original);
  return std::nullopt;
}

}  // namespace libchar
