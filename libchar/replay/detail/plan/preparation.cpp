// Line of least squares in one pass (Welford 1962; Chan, Golub, LeVeque 1983): with running means m_t, m_y of n values
//   S_tt += (t - m_t)(t - m_t'),   S_ty += (t - m_t)(y - m_y'),   slope = S_ty / S_tt

#include "libchar/replay/detail/plan/preparation.hpp"

#include <cmath>
#include <complex>
#include <numbers>

#include "libchar/core/numeric/whole.hpp"

namespace libchar {

// Butterworth filters of second order by the bilinear transform with the corner prewarped
// (Oppenheim & Schafer, Discrete-Time
// Signal Processing, 7.1):   K = tan(pi f / rate),   D = 1 + sqrt2 K + K^2
//   low-pass    b = (K^2, 2 K^2, K^2) / D     high-pass   b = (1, -2, 1) / D
//   both        a = (1, 2 (K^2 - 1), 1 - sqrt2 K + K^2) / D
// run in the transposed direct form II. A linear filter of all channels alike leaves the difference
// of sensor and reference what it would be if the difference were filtered. A step decays as exp(-2
// pi f t / sqrt2): below a thousandth after 1.65 / f. Noise gain: (1/pi) times the integral of
// |H|^2 from 0 to pi, by the midpoint rule in log frequency.

namespace {

/// Of the settling time: as long the last value stands for what is missing.
constexpr double kBridgedShare = 0.01;
constexpr std::int64_t kLongest = std::int64_t{1} << 50;  ///< samples: no recording has more

SecondOrderSection with_poles(double k) {
  const double d = 1 + std::numbers::sqrt2 * k + k * k;
  SecondOrderSection out;
  out.a1 = 2 * (k * k - 1) / d;
  out.a2 = (1 - std::numbers::sqrt2 * k + k * k) / d;
  return out;
}

// |H|^2 at an angular frequency in rad per sample.
double power_gain(const BandFilter& filter, double omega) {
  double gain = 1;
  for (std::size_t s = 0; s < filter.count; ++s) {
    const SecondOrderSection& f = filter.sections[s];
    const std::complex<double> z = std::polar(1.0, -omega);
    gain *= std::norm((f.b0 + z * (f.b1 + z * f.b2)) / (1.0 + z * (f.a1 + z * f.a2)));
  }
  return gain;
}

double noise_gain(const BandFilter& filter, double lowest) {
  constexpr int kSteps = 4096;
  // Below a hundredth of the corner a high-pass lets 1e-8 of the power through.
  const double from = std::log(lowest / 100), to = std::log(std::numbers::pi);
  double sum = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double omega = std::exp(from + (to - from) * (i + 0.5) / kSteps);
    sum += omega * power_gain(filter, omega);
  }
  return sum * (to - from) / kSteps / std::numbers::pi;
}

}  // namespace

SecondOrderSection butterworth_high_pass(double corner) {
  const double k = std::tan(std::numbers::pi * corner);
  SecondOrderSection out = with_poles(k);
  out.b0 = out.b2 = 1 / (1 + std::numbers::sqrt2 * k + k * k);
  out.b1 = -2 * out.b0;
  return out;
}

SecondOrderSection butterworth_low_pass(double corner) {
  const double k = std::tan(std::numbers::pi * corner);
  SecondOrderSection out = with_poles(k);
  out.b0 = out.b2 = k * k / (1 + std::numbers::sqrt2 * k + k * k);
  out.b1 = 2 * out.b0;
  return out;
}

BandFilter band_filter(double from_hz, double to_hz, double rate_hz) {
  BandFilter out;
  out.sections[out.count++] = butterworth_high_pass(from_hz / rate_hz);
  if (to_hz > 0) out.sections[out.count++] = butterworth_low_pass(to_hz / rate_hz);
  const double settling = kSettlingPeriods / from_hz * rate_hz;
  out.settling = clamped_whole<std::int64_t>(std::ceil(settling), 0, kLongest);
  out.bridged = clamped_whole<std::int64_t>(kBridgedShare * settling, 0, kLongest);
  out.noise_gain = noise_gain(out, 2 * std::numbers::pi * from_hz / rate_hz);
  return out;
}

double FilteredChannel::filtered(double x) {
  for (std::size_t s = 0; s < filter_->count; ++s) {
    const SecondOrderSection& f = filter_->sections[s];
    State& state = states_[s];
    const double y = f.b0 * x + state.first;
    state.first = f.b1 * x - f.a1 * y + state.second;
    state.second = f.b2 * x - f.a2 * y;
    x = y;
  }
  return x;
}

// A high-pass forgets a constant: what is left of it beside the first sample is the steady state.
void FilteredChannel::begin(double sample) {
  unsettled_ = begun_ ? filter_->settling : 0;
  states_ = {};
  origin_ = sample;
  begun_ = true;
}

double FilteredChannel::operator()(double sample) {
  constexpr double kGone = std::numeric_limits<double>::quiet_NaN();
  if (!std::isfinite(sample)) {
    ++missing_;
    if (begun_ && missing_ <= filter_->bridged) filtered(last_ - origin_);
    return kGone;
  }
  if (!begun_ || missing_ > filter_->bridged) begin(sample);
  missing_ = 0;
  last_ = sample;
  const double y = filtered(sample - origin_);
  if (unsettled_ == 0) return y;
  --unsettled_;
  return kGone;
}

void TrendMeter::push(std::int64_t first, const Eigen::MatrixXd& series) {
  sums_.resize(static_cast<std::size_t>(series.rows()));
  for (std::size_t i = 0; i < sums_.size(); ++i) {
    Sums& s = sums_[i];
    for (Eigen::Index k = 0; k < series.cols(); ++k) {
      const double y = series(static_cast<Eigen::Index>(i), k);
      if (!std::isfinite(y)) continue;
      s.n += 1;
      const double before = static_cast<double>(first + k) - s.time;
      s.time += before / s.n;
      s.value += (y - s.value) / s.n;
      s.time_squares += before * (static_cast<double>(first + k) - s.time);
      s.products += before * (y - s.value);
    }
  }
}

std::vector<TrendLine> TrendMeter::lines(bool sloped) const {
  std::vector<TrendLine> out;
  for (const Sums& s : sums_)
    out.push_back({s.value, sloped && s.time_squares > 0 ? s.products / s.time_squares : 0, s.time});
  return out;
}

Prepared::Prepared(const Preparation& preparation, std::size_t rows) : preparation_(&preparation) {
  if (preparation.filter) channels_.assign(rows, FilteredChannel(*preparation.filter));
}

double Prepared::operator()(std::size_t row, std::int64_t instant, double value) {
  if (!preparation_->trends.empty()) value -= preparation_->trends[row].at(instant);
  return channels_.empty() ? value : channels_[row](value);
}

}  // namespace libchar
