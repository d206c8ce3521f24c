// W. J. Riley, C. A. Greenhall, "Power law noise identification using the lag 1 autocorrelation", EFTF 2004 (what
// Stable32 does where at least 30 readings are left): phase x decimated by m, a quadratic taken out, then
//   r = lag-1 autocorrelation of z,  delta = r/(1 + r)
//   until delta < 1/4 or after the second difference: z <- differences of z, d <- d + 1
//   alpha = 2 - 2 (delta + d), rounded as -round(2 delta) - 2 d + 2
// A fractionally differenced process of order delta in (-1/2, 1/2) has r = delta/(1 - delta).
#include "libchar/allan/noise_type.hpp"

#include <cmath>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/text/readable.hpp"

namespace libchar {
namespace {

constexpr std::size_t kFewestReadings = 30;
constexpr int kMostDifferences = 2;
constexpr double kStationary = 0.25;

void take_mean_out(std::vector<double>& z) {
  double sum = 0;
  for (const double v : z) sum += v;
  for (double& v : z) v -= sum / static_cast<double>(z.size());
}

/// By projection on the first three orthogonal polynomials of -1…1.
void take_quadratic_out(std::vector<double>& z) {
  take_mean_out(z);
  const auto n = static_cast<double>(z.size());
  const auto at = [n](std::size_t i) { return (2 * static_cast<double>(i) - (n - 1)) / n; };
  double mean_square = 0;
  for (std::size_t i = 0; i < z.size(); ++i) mean_square += at(i) * at(i) / n;
  for (const bool square : {false, true}) {
    const auto p = [&](std::size_t i) { return square ? at(i) * at(i) - mean_square : at(i); };
    double product = 0, power = 0;
    for (std::size_t i = 0; i < z.size(); ++i) {
      product += p(i) * z[i];
      power += p(i) * p(i);
    }
    for (std::size_t i = 0; i < z.size(); ++i) z[i] -= product / power * p(i);
  }
}

std::optional<double> lag_one(std::vector<double> z) {
  take_mean_out(z);
  double power = 0, product = 0;
  for (std::size_t i = 0; i < z.size(); ++i) {
    power += z[i] * z[i];
    if (i > 0) product += z[i] * z[i - 1];
  }
  if (!(power > 0)) return std::nullopt;
  return product / power;
}

/// Missing readings interpolated, those at the ends left out; empty when there are more than one in a hundred.
std::vector<double> without_gaps(std::span<const double> phase) {
  while (!phase.empty() && std::isnan(phase.front())) phase = phase.subspan(1);
  while (!phase.empty() && std::isnan(phase.back())) phase = phase.first(phase.size() - 1);
  std::vector<double> out(phase.begin(), phase.end());
  std::size_t missing = 0, before = 0;
  for (std::size_t i = 0; i < phase.size(); ++i) {
    if (std::isnan(phase[i])) {
      ++missing;
      continue;
    }
    for (std::size_t j = before + 1; j < i; ++j)
      out[j] = phase[before] +
               (phase[i] - phase[before]) * static_cast<double>(j - before) / static_cast<double>(i - before);
    before = i;
  }
  if (missing * 100 > phase.size()) return {};
  return out;
}

}  // namespace

std::string_view noise_type_name(int alpha) {
  switch (alpha) {
    case 2:
      return "white phase";
    case 1:
      return "flicker phase";
    case 0:
      return "white frequency";
    case -1:
      return "flicker frequency";
    case -2:
      return "random-walk frequency";
    case -3:
      return "flicker walk of frequency";
    default:
      return alpha > 2 ? "differenced phase" : "random run of frequency";
  }
}

std::optional<NoiseType> lag1_noise_type(std::span<const double> phase, std::uint64_t m, double dt_s) {
  std::vector<double> z;
  for (std::size_t i = 0; i < phase.size(); i += m) z.push_back(phase[i]);
  if (z.size() < kFewestReadings) return std::nullopt;
  take_quadratic_out(z);
  for (int d = 0;; ++d) {
    const std::optional<double> r = lag_one(z);
    if (!r) return std::nullopt;
    const double delta = *r / (1 + *r);
    if (delta < kStationary || d >= kMostDifferences) {
      NoiseType type{m, static_cast<double>(m) * dt_s, 0, 2 - 2 * (delta + d)};
      type.alpha = 2 - 2 * d - clamped_whole<int>(std::round(2 * delta));
      return type;
    }
    for (std::size_t i = 0; i + 1 < z.size(); ++i) z[i] = z[i + 1] - z[i];
    z.pop_back();
  }
}

std::vector<NoiseType> lag1_noise_types(std::span<const double> phase, double dt_s) {
  std::vector<NoiseType> out;
  const std::vector<double> filled = without_gaps(phase);
  phase = filled;
  for (std::uint64_t m = 1; phase.size() / m >= kFewestReadings; m *= 2)
    if (const auto type = lag1_noise_type(phase, m, dt_s)) out.push_back(*type);
  return out;
}

std::string noise_types_text(std::span<const NoiseType> types) {
  std::string text;
  for (std::size_t i = 0, end = 0; i < types.size(); i = end) {
    while (end < types.size() && types[end].alpha == types[i].alpha) ++end;
    text += (text.empty() ? "" : ", ") + std::string(noise_type_name(types[i].alpha));
    text += end == i + 1 ? " at " + duration_text(types[i].tau_s)
                         : " from " + duration_text(types[i].tau_s) + " to " + duration_text(types[end - 1].tau_s);
  }
  return text;
}

}  // namespace libchar
