// Narrow lines above a smooth floor.
//
// The floor at a bin is estimated on each flank from the median of up to 32 bins outside the
// window's main lobe, and the *higher* of the two is taken: on a slope such as 1/f^2 it is the one
// that does not make a line of the slope. Power over floor of a bin of noise is then distributed at
// most as F(nu, nu_floor), nu_floor from the scatter of a median of m correlated chi-square values,
//   relative variance = 1 / (4 m p(q)^2 q^2),   p the density and q the median of chi-square / nu,
//   nu_floor = 2 / that,
// and a bin is part of a line when its ratio is above the F quantile of alarm / (number of bins tested). The amplitude
// is that of the whole main lobe: A^2 / 2 = sum (P_k - floor) df, true at any frequency between bins.
//
// Rounding makes lines of its own: a drift of s LSB a second is followed by a sawtooth of s Hz. With
// noise of standard deviation sigma its k-th harmonic has the amplitude (Widrow & Kollar 2008, 5.3)
//   LSB/(pi k) exp(-2 (pi k sigma/LSB)^2),
// 0.32 LSB without noise, 0.002 LSB at sigma = LSB/2. A line that is no larger is not reported.

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <span>

#include "libchar/core/numeric/distributions.hpp"
#include "libchar/core/numeric/lanes.hpp"
#include "libchar/spectrum/spectrum.hpp"

namespace libchar {
namespace {

constexpr std::size_t kFlank = 32, kLeast = 8;

// Half width of the main lobe, in bins.
std::size_t lobe_of(Window window) {
  switch (window) {
    case Window::rectangular:
      return 1;
    case Window::blackman_harris:
      return 4;
    case Window::flat_top:
      return 5;
    default:
      return 2;
  }
}

// One-sided density at the positive frequencies, Nyquist left out. Value k stands for `count` bins
// of the spectrum, of which the first is number first_bin + k count.
struct Density {
  Density() = default;
  Density(Density&&) = default;  // `power` may be a view of `own`

  std::span<const double> power;
  std::vector<double> own;  // power, where the spectrum has something else
  double dof = 0, bin_hz = 0;
  std::size_t first_bin = 0, count = 1;
  std::vector<double> correlation;  // of neighbouring values
  double step_hz() const { return bin_hz * static_cast<double>(count); }
  double frequency_hz(std::size_t k) const {
    const std::size_t twice = 2 * (first_bin + k * count) + count - 1;
    return static_cast<double>(twice) / 2 * bin_hz;
  }
};

Density density_of(const Spectrum& s) {
  const bool root = s.scaling == Scaling::lsd || s.scaling == Scaling::ls;
  const bool per_band = s.scaling == Scaling::ps || s.scaling == Scaling::ls;
  const double factor = (s.sides == Sides::two ? 2 : 1) / (per_band ? s.enbw_hz : 1);
  Density out;
  const auto zero = static_cast<std::size_t>(std::lower_bound(s.frequency_hz.begin(), s.frequency_hz.end(), 0.0) -
                                             s.frequency_hz.begin());
  const std::size_t size = std::min<std::size_t>(s.value.size() - zero, (static_cast<std::size_t>(s.segment) + 1) / 2);
  out.power = std::span(s.value).subspan(zero, size);
  if (root || factor != 1) {
    out.own.reserve(size);
    for (const double value : out.power) out.own.push_back((root ? value * value : value) * factor);
    out.power = out.own;
  }
  if (size > 1) out.dof = s.dof[zero + size - 1];
  out.correlation = s.neighbour_correlation;
  out.bin_hz = s.rate_hz / static_cast<double>(std::max<std::uint64_t>(s.segment, 1));
  return out;
}

// Means of `count` bins, DC left out.
Density averaged(const Density& d, std::size_t count) {
  Density out;
  double variance = static_cast<double>(count), across = 0;
  for (std::size_t m = 1; m <= d.correlation.size() && m < count; ++m) {
    variance += 2 * static_cast<double>(count - m) * d.correlation[m - 1];
    across += static_cast<double>(m) * d.correlation[m - 1];
  }
  out.dof = d.dof * static_cast<double>(count * count) / variance;
  out.correlation = {across / variance};
  out.bin_hz = d.bin_hz;
  out.first_bin = 1;
  out.count = count;
  out.own.reserve(d.power.size() / count);
  for (std::size_t begin = 1; begin + count <= d.power.size(); begin += count) {
    double sum = 0;
    for (std::size_t k = begin; k < begin + count; ++k) sum += d.power[k];
    out.own.push_back(sum / static_cast<double>(count));
  }
  out.power = out.own;
  return out;
}

// Median of at most kFlank values.
double median_of(const double* values, std::size_t count) {
  std::array<double, kFlank> sorted;
  std::partial_sort_copy(values, values + count, sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(count));
  return (sorted[(count - 1) / 2] + sorted[count / 2]) / 2;
}

// Are more than half of kFlank values at least `level`? Then so is their median.
LIBCHAR_LANES bool mostly_at_least_lanes(const double* values, double level) {
  auto below = LIBCHAR_FOUR(values) < level;
  for (std::size_t i = 4; i < kFlank; i += 4) below += LIBCHAR_FOUR(values + i) < level;
  return -(below[0] + below[1] + below[2] + below[3]) < static_cast<std::ptrdiff_t>(kFlank / 2);
}
constexpr InLanes<mostly_at_least_lanes> mostly_at_least;

struct Floor {
  double level = 0;       // expected power of noise
  std::size_t count = 0;  // bins behind it
};

class LocalFloor {
 public:
  LocalFloor(const Density& density, std::size_t begin, std::size_t guard)
      : begin_(begin), guard_(guard), power_(density.power) {
    typical_ = chi_square_quantile(0.5, density.dof) / density.dof;
  }
  // Of the flanks that have enough bins the higher; none: count 0. Slopes fall to the right:
  // without a left flank nothing tells a slope from a line.
  Floor at(std::size_t k) const {
    Floor floor;
    if (k < begin_ + guard_ + kLeast) return floor;
    const std::size_t left = std::min(kFlank, k - guard_ - begin_);
    raise(floor, median_of(power_.data() + (k - guard_ - left), left), left);
    if (right_of(k)) raise(floor, median_of(power_.data() + k + guard_ + 1, kFlank), kFlank);
    return floor;
  }
  // The answer for nearly every bin, without a median: is the floor of whole flanks at least `level`?
  bool surely_at_least(std::size_t k, double level) const {
    if (k < begin_ + guard_ + kFlank) return false;
    const double value = level * typical_ * (1 + 1e-12);
    return mostly_at_least(power_.data() + (k - guard_ - kFlank), value) ||
           (right_of(k) && mostly_at_least(power_.data() + k + guard_ + 1, value));
  }

 private:
  bool right_of(std::size_t k) const { return k + guard_ + kFlank < power_.size(); }
  void raise(Floor& floor, double median, std::size_t count) const {
    if (floor.count != 0 && median / typical_ <= floor.level) return;
    floor = {median / typical_, count};
  }
  std::size_t begin_, guard_;
  std::span<const double> power_;
  double typical_ = 1;  // median of chi-square / nu
};

// Ratio of power to floor that noise exceeds with probability `alarm`.
class Threshold {
 public:
  Threshold(double dof, double correlation, double alarm) : dof_(dof), alarm_(alarm) {
    const double median = chi_square_quantile(0.5, dof);
    const double spread = 2 * chi_square_density(median, dof) * median;
    median_variance_ = (1 + 2 * correlation) / (spread * spread);
  }
  double operator()(std::size_t count) {
    auto [slot, fresh] = known_.try_emplace(count, 0.0);
    if (fresh) {
      const double floor_dof = 2 * static_cast<double>(count) / median_variance_;
      slot->second = fisher_upper_quantile(alarm_, dof_, floor_dof);
    }
    return slot->second;
  }

 private:
  double dof_, alarm_, median_variance_ = 1;
  std::map<std::size_t, double> known_;
};

// Offset in bins of the top of the parabola through the logarithms of three neighbours.
double parabola_top(double left, double middle, double right) {
  if (!(left > 0 && right > 0)) return 0;
  const double a = std::log(left), b = std::log(middle), c = std::log(right), bend = a - 2 * b + c;
  return bend < 0 ? std::clamp((a - c) / (2 * bend), -0.5, 0.5) : 0;
}

// Where the power falls to `level` on the way from the peak, in bins.
double half_width(std::span<const double> power, std::size_t peak, double level, int direction) {
  std::size_t i = peak;
  while (i > 0 && i + 1 < power.size() && power[i] > level) i = direction > 0 ? i + 1 : i - 1;
  const std::size_t inside = direction > 0 ? i - 1 : i + 1;
  if (power[i] > level) return std::abs(static_cast<double>(i) - static_cast<double>(peak));
  const double part = (power[inside] - level) / (power[inside] - power[i]);
  return std::abs(static_cast<double>(inside) - static_cast<double>(peak)) + part;
}

SpectralLine line_of(const Density& d, std::size_t first, std::size_t last, double floor, std::size_t lobe) {
  const auto begin = d.power.begin();
  const auto peak = static_cast<std::size_t>(
      std::max_element(begin + static_cast<std::ptrdiff_t>(first), begin + static_cast<std::ptrdiff_t>(last) + 1) -
      begin);
  SpectralLine line;
  const bool inner = peak > 0 && peak + 1 < d.power.size();
  const double offset = inner ? parabola_top(d.power[peak - 1], d.power[peak], d.power[peak + 1]) : 0;
  line.frequency_hz = d.frequency_hz(peak) + offset * d.step_hz();
  const std::size_t from = std::min(first, peak - std::min(peak, lobe)),
                    to = std::min(std::max(last, peak + lobe), d.power.size() - 1);
  double sum = 0;
  for (std::size_t k = from; k <= to; ++k) sum += d.power[k] - floor;
  line.amplitude = std::sqrt(2 * std::max(sum, 0.0) * d.step_hz());
  line.excess = d.power[peak] / floor - 1;
  const double half = floor + (d.power[peak] - floor) / 2;
  line.width_hz = inner ? (half_width(d.power, peak, half, 1) + half_width(d.power, peak, half, -1)) * d.step_hz() : 0;
  return line;
}

struct Found {
  SpectralLine line;
  double from_hz = 0, to_hz = 0;
};

// Neighbouring bins above the threshold are one line; so are those that no more than a main lobe separates.
std::vector<Found> search(const Density& d, std::size_t lobe, double alarm) {
  const std::size_t guard = lobe + 1;
  if (!(d.dof > 0) || d.power.size() < lobe + guard + kLeast + 2) return {};
  const LocalFloor floors(d, lobe, guard);
  double correlation = 0;
  for (const double c : d.correlation) correlation += c;
  Threshold threshold(d.dof, correlation, alarm / static_cast<double>(d.power.size()));

  const double whole_flank = threshold(kFlank);
  std::vector<Found> found;
  std::size_t first = 0, last = 0;
  double floor = 0;
  bool open = false;
  const auto close = [&] {
    if (open)
      found.push_back({line_of(d, first, last, floor, lobe), d.frequency_hz(first) - d.step_hz(),
                       d.frequency_hz(last) + d.step_hz()});
    open = false;
  };
  for (std::size_t k = lobe; k < d.power.size(); ++k) {
    if (open && k > last + guard) close();
    if (floors.surely_at_least(k, d.power[k] / whole_flank)) continue;
    const Floor here = floors.at(k);
    if (here.count == 0 || !(here.level > 0) || !(d.power[k] > here.level * threshold(here.count))) continue;
    if (!open) first = k;
    floor = open ? std::min(floor, here.level) : here.level;
    open = true;
    last = k;
  }
  close();
  return found;
}

// Adds a band unless the lines inside it explain it. A swelling of a few percent over many bins may
// be certain, but it is the shape of the floor, not a line.
void add_band(std::vector<Found>& lines, const Found& band) {
  constexpr double kLeastExcess = 0.25;
  if (band.line.excess < kLeastExcess) return;
  const auto inside = [&](const Found& f) {
    return f.line.frequency_hz > band.from_hz && f.line.frequency_hz < band.to_hz;
  };
  double power = 0;
  for (const Found& f : lines)
    if (inside(f)) power += f.line.amplitude * f.line.amplitude;
  if (band.line.amplitude * band.line.amplitude <= 2 * power) return;
  std::erase_if(lines, inside);
  lines.push_back(band);
}

/// The largest line that rounding makes of a slow drift.
double largest_quantization_line(const Quantization& quantization) {
  if (!(quantization.step > 0)) return 0;
  const double blur = std::numbers::pi * quantization.noise_sd / quantization.step;
  return quantization.step / std::numbers::pi * std::exp(-2 * blur * blur);
}

}  // namespace

Quantization quantization_of(double step, double difference_sd) {
  const double variance = difference_sd * difference_sd / 2 - step * step / 12;
  return {step, std::sqrt(std::max(variance, 0.0))};
}

std::vector<SpectralLine> find_lines(const Spectrum& spectrum, double alarm, const Quantization& quantization) {
  if (spectrum.segment == 0) return {};
  // Harmonics that fold onto each other make a fast drift's line up to 1.21 times as large.
  constexpr double kMargin = 1.3;
  constexpr std::size_t kWidths[] = {4, 16, 64, 256};
  const double share = alarm / (1 + std::size(kWidths));
  const Density density = density_of(spectrum);
  std::vector<Found> found = search(density, lobe_of(spectrum.window), share);
  for (const std::size_t width : kWidths)
    for (const Found& band : search(averaged(density, width), 1, share)) add_band(found, band);
  std::vector<SpectralLine> lines;
  const double rounding = kMargin * largest_quantization_line(quantization);
  for (const Found& f : found)
    if (f.line.amplitude > rounding) lines.push_back(f.line);
  std::sort(lines.begin(), lines.end(),
            [](const SpectralLine& a, const SpectralLine& b) { return a.frequency_hz < b.frequency_hz; });
  return lines;
}

}  // namespace libchar
