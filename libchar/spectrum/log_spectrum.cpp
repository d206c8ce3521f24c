// Spectra on a logarithmic frequency axis.
//
// Averaging M bins of nu_k degrees of freedom each whose powers are correlated by c_m, m bins apart:
//   variance / level^2 = (1/M^2) sum_{k,l} c_|k-l| 2 / sqrt(nu_k nu_l),      nu = 2 / that.

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/spectrum/spectrum.hpp"

namespace libchar {
namespace {

bool is_root(Scaling scaling) { return scaling == Scaling::lsd || scaling == Scaling::ls; }

// All but the bins, which may be as many as a record has samples.
Spectrum without_bins(const Spectrum& s) {
  Spectrum out;
  out.sides = s.sides;
  out.scaling = s.scaling;
  out.window = s.window;
  out.rate_hz = s.rate_hz;
  out.segment = s.segment;
  out.segments = s.segments;
  out.dropped = s.dropped;
  out.enbw_hz = s.enbw_hz;
  out.notes = s.notes;
  return out;
}

double power_of(const Spectrum& s, std::size_t i) { return is_root(s.scaling) ? s.value[i] * s.value[i] : s.value[i]; }

double averaged_dof(const Spectrum& s, std::size_t begin, std::size_t end) {
  const double count = static_cast<double>(end - begin);
  double variance = 0;
  // All bins but the first and last of a spectrum have the same degrees of freedom.
  const bool same =
      std::all_of(s.dof.begin() + static_cast<std::ptrdiff_t>(begin), s.dof.begin() + static_cast<std::ptrdiff_t>(end),
                  [&](double dof) { return dof == s.dof[begin]; });
  if (same) {
    double terms = count;
    for (std::size_t m = 1; m <= s.neighbour_correlation.size() && begin + m < end; ++m)
      terms += 2 * (count - static_cast<double>(m)) * s.neighbour_correlation[m - 1];
    return s.dof[begin] * count * (count / terms);
  }
  for (std::size_t k = begin; k < end; ++k) {
    variance += 2 / s.dof[k];
    for (std::size_t m = 1; m <= s.neighbour_correlation.size() && k + m < end; ++m)
      variance += 2 * s.neighbour_correlation[m - 1] * 2 / std::sqrt(s.dof[k] * s.dof[k + m]);
  }
  return 2 * count * count / variance;
}

// Logarithmic bins numbered from `low`, `per_e` of them for each factor e.
struct LogAxis {
  double low = 1, per_e = 1;
  double log_low = std::log(low);
  long bin(double log_f) const { return clamped_whole<long>(std::floor((log_f - log_low) * per_e + 1e-9)); }
};

LogAxis axis_of(double low, double high, std::size_t bins) {
  // The highest frequency belongs to the last bin.
  return {low, static_cast<double>(bins) / std::max(std::log(high / low) * (1 + 1e-6), 1e-12)};
}

// Appends the average of every logarithmic bin of `s` from its frequency number `begin` on.
void append_averages(const Spectrum& s, const LogAxis& axis, std::size_t begin, Spectrum& out) {
  while (begin < s.value.size()) {
    const double first_log = std::log(s.frequency_hz[begin]);
    const long bin = axis.bin(first_log);
    double power = power_of(s, begin), log_f = first_log;
    std::size_t end = begin + 1;
    for (; end < s.value.size(); ++end) {
      const double here = std::log(s.frequency_hz[end]);
      if (axis.bin(here) != bin) break;
      power += power_of(s, end);
      log_f += here;
    }
    const double count = static_cast<double>(end - begin);
    out.frequency_hz.push_back(end == begin + 1 ? s.frequency_hz[begin] : std::exp(log_f / count));
    out.value.push_back(is_root(s.scaling) ? std::sqrt(power / count) : power / count);
    out.dof.push_back(averaged_dof(s, begin, end));
    begin = end;
  }
}

}  // namespace

Spectrum log_binned(const Spectrum& spectrum, std::size_t bins) {
  Spectrum out = without_bins(spectrum);
  const auto first = std::upper_bound(spectrum.frequency_hz.begin(), spectrum.frequency_hz.end(), 0.0);
  if (first == spectrum.frequency_hz.end() || bins == 0) return out;
  append_averages(spectrum, axis_of(*first, spectrum.frequency_hz.back(), bins),
                  static_cast<std::size_t>(first - spectrum.frequency_hz.begin()), out);
  return out;
}

}  // namespace libchar
