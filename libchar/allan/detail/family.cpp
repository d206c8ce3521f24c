#include "libchar/allan/detail/family.hpp"

#include <cmath>

#include "libchar/core/numeric/whole.hpp"

namespace libchar {

std::uint64_t theo_factor(double tau) { return 2 * clamped_whole<std::uint64_t>(std::round(tau / 1.5)); }

std::uint64_t last_allan_factor(std::uint64_t samples) { return samples / 5; }

void local_phase(const FamilyInput& input, std::size_t first, std::span<double> out) {
  const double* v = input.record.data() + first;
  const double origin = v[0] * input.scale;
  const auto last = static_cast<double>(out.size() - 1);
  if (input.data == DataKind::phase) {
    const double slope = (v[out.size() - 1] * input.scale - origin) / last;
    for (std::size_t j = 0; j < out.size(); ++j)
      out[j] = (v[j] * input.scale - origin) - slope * static_cast<double>(j);
    return;
  }
  double mean = 0;
  for (std::size_t j = 0; j + 1 < out.size(); ++j) mean += v[j] * input.scale - origin;
  mean /= last;
  double sum = 0;
  for (std::size_t j = 0; j + 1 < out.size(); ++j) {
    out[j] = sum;
    sum += (v[j] * input.scale - origin) - mean;
  }
  out[out.size() - 1] = sum;
}

void local_phase_with_offset(const FamilyInput& input, std::size_t first, std::span<double> out) {
  const double* v = input.record.data() + first;
  double sum = 0;
  for (std::size_t j = 0; j < out.size(); ++j) {
    out[j] = input.data == DataKind::phase ? v[j] * input.scale - v[0] * input.scale : sum;
    if (j + 1 < out.size() && input.data == DataKind::rate) sum += v[j] * input.scale;
  }
}

void local_rate(const FamilyInput& input, std::size_t first, std::span<double> out) {
  const double* v = input.record.data() + first;
  const auto at = [&](std::size_t j) {
    return input.data == DataKind::rate ? v[j] * input.scale : v[j + 1] * input.scale - v[j] * input.scale;
  };
  const double origin = at(0);
  for (std::size_t j = 0; j < out.size(); ++j) out[j] = at(j) - origin;
}

AllanPoint family_point(const FamilyInput& input, std::uint64_t m, double tau_s, double divisor, const FamilySum& sum) {
  AllanPoint point;
  point.m = m;
  point.tau_s = tau_s;
  point.terms = sum.terms;
  if (sum.terms == 0) return point;
  const double step = static_cast<double>(m) * (input.data == DataKind::rate ? 1 : input.dt_s);
  point.deviation = std::sqrt(sum.sum / (divisor * static_cast<double>(sum.terms))) / step / input.scale;
  return point;
}

std::size_t family_stride(const FamilyInput& input, std::uint64_t m, std::uint64_t starts, std::uint64_t work) {
  const double all = static_cast<double>(starts) * static_cast<double>(work);
  if (input.work_a_point == 0 || all <= static_cast<double>(input.work_a_point)) return 1;
  const auto wanted = clamped_whole<std::uint64_t>(std::ceil(all / static_cast<double>(input.work_a_point)));
  return detail::in_memory(std::clamp<std::uint64_t>(wanted, 1, std::max<std::uint64_t>(1, m / 16)));
}

std::vector<AllanPoint> spaced_points(const std::vector<std::uint64_t>& factors, std::vector<std::string>& notes,
                                      const std::function<AllanPoint(std::size_t m, bool& spaced)>& point_of) {
  std::vector<AllanPoint> points(factors.size());
  std::vector<char> spaced(factors.size());
  parallel::for_each(0, factors.size(), [&](std::size_t k) {
    bool one = false;
    points[k] = point_of(detail::in_memory(factors[k]), one);
    spaced[k] = one ? 1 : 0;
  });
  if (const auto count = std::count(spaced.begin(), spaced.end(), 1); count > 0)
    notes.push_back(
        "at " + std::to_string(count) +
        " averaging times not every term is used, but one every m/16 samples or more (`full_overlap` takes all)");
  return points;
}

}  // namespace libchar
