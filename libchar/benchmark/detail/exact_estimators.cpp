// Definitions: NIST SP 1065 (2008), 5.2 (Allan family); Welch 1967; weights by Householder QR of differences of errors.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "libchar/benchmark/detail/stress_cells.hpp"
#include "libchar/core/numeric/whole.hpp"

namespace libchar {
namespace {

constexpr Exact kPi = std::numbers::pi_v<Exact>;

/// Integral of the rate less its first sample: every difference of order two and more loses that offset anyway.
std::vector<Exact> phase_of(std::span<const double> y, std::size_t reflected) {
  std::vector<Exact> x{0};
  const auto add = [&](double sample) { x.push_back(x.back() + (Exact(sample) - Exact(y[0]))); };
  for (std::size_t j = reflected; j-- > 0;) add(y[j]);
  for (const double sample : y) add(sample);
  for (std::size_t j = 0; j < reflected; ++j) add(y[y.size() - 1 - j]);
  return x;
}

Exact difference(const std::vector<Exact>& x, std::size_t i, std::size_t m, int order) {
  if (order == 2) return (x[i + 2 * m] - x[i + m]) - (x[i + m] - x[i]);
  return difference(x, i + m, m, 2) - difference(x, i, m, 2);
}

/// Of `points` values of a series from i on, reflected at both ends after its trend is out: mean
/// square of second differences of means of m.
Exact reflected_window(const std::vector<Exact>& series, std::size_t i, std::size_t m) {
  const std::size_t points = 3 * m, half = points / 2;
  Exact low = 0, high = 0;
  for (std::size_t k = 0; k < half; ++k) {
    low += series[i + k] - series[i];
    high += series[i + points - 1 - k] - series[i];
  }
  const Exact slope = (high - low) / static_cast<Exact>(half) / static_cast<Exact>(points - half);
  std::vector<Exact> e(3 * points);
  for (std::size_t k = 0; k < points; ++k) {
    const Exact value = (series[i + k] - series[i]) - slope * static_cast<Exact>(k);
    e[points + k] = e[points - 1 - k] = e[3 * points - 1 - k] = value;
  }
  Exact sum = 0;
  for (std::size_t j = 0; j < 6 * m; ++j) {
    Exact term = 0;
    for (std::size_t k = j; k < j + m; ++k) term += (e[k + 2 * m] - e[k + m]) - (e[k + m] - e[k]);
    sum += term * term;
  }
  return sum / static_cast<Exact>(6 * m) / static_cast<Exact>(m * m);
}

Exact exact_extended(const std::vector<Exact>& x, const DeviationRow& row, std::size_t m) {
  std::vector<Exact> series = x;
  if (!row.of_sum) {
    for (std::size_t i = 0; i + 1 < x.size(); ++i) series[i] = x[i + 1] - x[i];
    series.pop_back();
    if (m == 1) {
      Exact sum = 0;
      for (std::size_t i = 0; i + 3 < x.size(); ++i) sum += difference(x, i, 1, 3) * difference(x, i, 1, 3);
      return std::sqrt(sum / static_cast<Exact>(x.size() - 3) / 6);
    }
  }
  Exact sum = 0;
  const std::size_t starts = series.size() - 3 * m + 1;
  for (std::size_t i = 0; i < starts; ++i) sum += reflected_window(series, i, m);
  const Exact v = sum / static_cast<Exact>(starts) / Exact(row.divisor);
  return std::sqrt(v) / (row.of_sum ? Exact(m) : 1);
}

Exact exact_parabolic(const std::vector<Exact>& x, std::size_t m) {
  Exact sum = 0;
  const std::size_t terms = x.size() - 2 * m;
  for (std::size_t i = 0; i < terms; ++i) {
    Exact term = 0;
    for (std::size_t k = 0; k < m; ++k) term += (Exact(m - 1) / 2 - static_cast<Exact>(k)) * (x[i + k] - x[i + m + k]);
    if (m == 1) term = difference(x, i, 1, 2) / 12;  // the Allan deviation, by convention
    sum += term * term;
  }
  const Exact factor(m);
  return std::sqrt(72 * sum / static_cast<Exact>(terms)) / (factor * factor * factor);
}

Exact exact_theo1(const std::vector<Exact>& x, std::size_t m) {
  Exact sum = 0;
  const std::size_t half = m / 2, starts = x.size() - m;
  for (std::size_t c = half; c < half + starts; ++c)
    for (std::size_t d = 0; d < half; ++d) {
      const Exact term = (x[c - half] - x[c - d]) + (x[c + half] - x[c + d]);
      sum += term * term / static_cast<Exact>(half - d);
    }
  return std::sqrt(sum / (Exact(0.75) * static_cast<Exact>(starts))) / Exact(m);
}

Exact exact_theo(const std::vector<Exact>& x, DeviationType type, std::size_t m) {
  const auto allan = [&](std::size_t factor) {
    Exact sum = 0;
    const std::size_t terms = x.size() - 2 * factor;
    for (std::size_t i = 0; i < terms; ++i) sum += difference(x, i, factor, 2) * difference(x, i, factor, 2);
    return std::sqrt(sum / static_cast<Exact>(terms) / 2) / static_cast<Exact>(factor);
  };
  if (type == DeviationType::theoh && m <= (x.size() - 1) / 5) return allan(m);
  if (type == DeviationType::theo1) return exact_theo1(x, m);
  Exact ratios = 0;
  const std::size_t last = x.size() / 6 - 3;
  for (std::size_t i = 0; i <= last; ++i) {
    const Exact theo = exact_theo1(x, 12 + 4 * i), plain = allan(9 + 3 * i);
    ratios += theo > 0 ? plain / theo * (plain / theo) : 1;
  }
  return exact_theo1(x, m) * std::sqrt(ratios / static_cast<Exact>(last + 1));
}

/// The offset counts here.
Exact exact_interval(std::span<const double> y, DeviationType type, std::size_t m) {
  std::vector<Exact> x{0};
  for (const double v : y) x.push_back(x.back() + Exact(v));
  Exact most = 0, squares = 0;
  for (std::size_t i = 0; i + m < x.size(); ++i) {
    const auto first = x.begin() + static_cast<std::ptrdiff_t>(i);
    const auto [low, high] = std::minmax_element(first, first + static_cast<std::ptrdiff_t>(m) + 1);
    most = std::max(most, *high - *low);
    squares += (x[i + m] - x[i]) * (x[i + m] - x[i]);
  }
  return type == DeviationType::mtie ? most : std::sqrt(squares / static_cast<Exact>(x.size() - m));
}

std::vector<Exact> without_mean(std::span<const double> y) {
  Exact sum = 0;
  for (const double v : y) sum += Exact(v) - Exact(y[0]);
  std::vector<Exact> out;
  for (const double v : y) out.push_back((Exact(v) - Exact(y[0])) - sum / static_cast<Exact>(y.size()));
  return out;
}

Exact exact_of_family(std::span<const double> y, double dt_s, const DeviationRow& row, std::size_t m) {
  const std::vector<Exact> x = phase_of(y, 0);
  const Exact dt(dt_s);
  switch (row.family) {
    case DeviationFamily::parabola:
      return exact_parabolic(x, m);
    case DeviationFamily::extended:
      return exact_extended(x, row, m) * (row.as_time ? Exact(m) * dt / std::sqrt(Exact(3)) : 1);
    case DeviationFamily::theo:
      return exact_theo(x, row.type, m);
    default:
      return exact_interval(y, row.type, m) * dt;
  }
}

}  // namespace

Exact exact_deviation(std::span<const double> y, double dt_s, DeviationType type, std::uint64_t factor,
                      std::uint64_t stride) {
  const std::size_t m = detail::in_memory(factor);
  const DeviationRow& row = deviation_row(type);
  if (row.family != DeviationFamily::differences) return exact_of_family(y, dt_s, row, m);
  const std::size_t reflected = row.reflected ? m - 1 : 0;
  const std::vector<Exact> x = phase_of(y, reflected);
  const std::size_t reach = 2 * m + (row.of_sum ? m - 1 : (row.order - 2) * m);
  Exact sum = 0;
  std::size_t terms = 0;
  for (std::size_t i = 0; i + reach < x.size(); i += row.overlapping ? stride : m, ++terms) {
    Exact term = 0;
    if (row.of_sum)
      for (std::size_t j = 0; j < m; ++j) term += difference(x, i + j, m, 2) / static_cast<Exact>(m);
    else
      term = difference(x, i, m, row.order);
    sum += term * term;
  }
  const Exact deviation = std::sqrt(sum / static_cast<Exact>(terms) / Exact(row.divisor)) / Exact(m);
  return row.as_time ? deviation * Exact(m) * Exact(dt_s) / std::sqrt(Exact(3)) : deviation;
}

std::vector<Exact> exact_moments(std::span<const double> y) {
  const std::vector<Exact> centred = without_mean(y);
  Exact squares = 0;
  for (const Exact v : centred) squares += v * v;
  return {Exact(y[0]) - centred[0], std::sqrt(squares / static_cast<Exact>(y.size() - 1))};
}

std::vector<Exact> exact_welch(std::span<const double> y, double rate_hz, std::size_t segment) {
  std::vector<Exact> window(segment), cosine(segment), sine(segment), out(segment / 2 + 1, 0);
  Exact power = 0;
  for (std::size_t t = 0; t < segment; ++t) {
    const Exact angle = 2 * kPi * static_cast<Exact>(t) / static_cast<Exact>(segment);
    cosine[t] = std::cos(angle);
    sine[t] = std::sin(angle);
    window[t] = (1 - cosine[t]) / 2;
    power += window[t] * window[t];
  }
  std::size_t segments = 0;
  for (std::size_t from = 0; from + segment <= y.size(); from += segment / 2, ++segments) {
    const std::vector<Exact> part = without_mean(y.subspan(from, segment));
    for (std::size_t k = 0; k < out.size(); ++k) {
      Exact re = 0, im = 0;
      for (std::size_t t = 0; t < segment; ++t) {
        re += window[t] * part[t] * cosine[k * t % segment];
        im += window[t] * part[t] * sine[k * t % segment];
      }
      out[k] += re * re + im * im;
    }
  }
  for (std::size_t k = 0; k < out.size(); ++k) {
    const bool twice = k > 0 && 2 * k < segment;
    out[k] *= (twice ? 2 : 1) / (power * Exact(rate_hz) * static_cast<Exact>(segments));
  }
  return out;
}

std::vector<Exact> exact_cosine_transform(std::span<const double> y) {
  const std::vector<Exact> x = without_mean(y);
  const std::size_t n = x.size();
  if (n == 0) return {};
  std::vector<Exact> cosine(4 * n), out(n, 0);
  for (std::size_t j = 0; j < 4 * n; ++j) cosine[j] = std::cos(kPi * static_cast<Exact>(j) / static_cast<Exact>(2 * n));
  const Exact scale = std::sqrt(2 / static_cast<Exact>(n));
  for (std::size_t k = 1; k < n; ++k) {
    for (std::size_t t = 0; t < n; ++t) out[k] += x[t] * cosine[k * (2 * t + 1) % cosine.size()];
    out[k] *= scale;
  }
  return out;
}

std::vector<Exact> exact_weights(const std::vector<std::vector<double>>& errors) {
  const std::size_t n = errors.size(), unknowns = n - 1, rows = errors[0].size();
  std::vector<std::vector<Exact>> column(n);
  for (std::size_t i = 0; i < n; ++i) column[i].assign(errors[i].begin(), errors[i].end());
  for (std::size_t i = 0; i < unknowns; ++i)
    for (std::size_t k = 0; k < rows; ++k) column[i][k] -= column[n - 1][k];
  for (Exact& v : column[n - 1]) v = -v;
  // Householder, column by column, the last one being the right side.
  for (std::size_t j = 0; j < unknowns; ++j) {
    Exact length = 0;
    for (std::size_t k = j; k < rows; ++k) length += column[j][k] * column[j][k];
    length = std::sqrt(length);
    if (column[j][j] > 0) length = -length;
    std::vector<Exact> v(column[j].begin() + static_cast<std::ptrdiff_t>(j), column[j].end());
    v[0] -= length;
    Exact squares = 0;
    for (const Exact a : v) squares += a * a;
    for (std::size_t i = j; i < n && squares > 0; ++i) {
      Exact dot = 0;
      for (std::size_t k = j; k < rows; ++k) dot += v[k - j] * column[i][k];
      for (std::size_t k = j; k < rows; ++k) column[i][k] -= 2 * dot / squares * v[k - j];
    }
  }
  std::vector<Exact> w(n, 0);
  w[n - 1] = 1;
  for (std::size_t j = unknowns; j-- > 0;) {
    Exact value = column[n - 1][j];
    for (std::size_t i = j + 1; i < unknowns; ++i) value -= column[i][j] * w[i];
    w[j] = value / column[j][j];
    w[n - 1] -= w[j];
  }
  return w;
}

}  // namespace libchar
