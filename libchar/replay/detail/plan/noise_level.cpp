// With R = oversampling * rate the rate of the model, a = exp(-2 pi bandwidth/R) the pole of its
// low-pass (0 without), p the oversampling:
//   white, made at each step      Q^2 R (1 - a)/(1 + a)
//   white, band-limited           Q^2 pi bandwidth
//   quantization, per sample      2 Qz^2 R^2 (1 - a)^2/(1 + a);  band-limited: 2 Qz^2 R^2
//   flicker, walk                 2 int_0^1/2 S(nu) |H(nu)|^2 2 sin^2(pi p nu) dnu, half the mean
//       square of the difference of two output samples; S = B^2/(2 sin pi nu), K^2/(4 R sin^2 pi
//       nu)
//   held (white_hold_s, flicker_hold_s)  value v_m stands for the steps e_{m-1} < k <= e_m, e_m =
//       floor(m M), M = hold * R, so that a sample is sum_m g_m(t) v_m with
//       g_m(t) = a^(t - min(t, e_m)) - a^(t - e_{m-1});  averaged over the phases at which samples
//       are taken
// (docs/theory/allan.md for the terms, docs/theory/simulation.md for the spectra and the variogram of
// flicker, (4/pi) sum_{k<=n} 1/(2k - 1).)
#include "libchar/replay/detail/plan/noise_level.hpp"

#include <algorithm>
#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"

namespace libchar {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kMostPhases = 1000;
constexpr std::int64_t kMostHeld = 400;  // values that one sample remembers one by one
constexpr double kForgotten = 45;        // e^-45 is nothing

struct Chain {
  double rate_hz;  // of the model
  double pole;
  std::int64_t step;  // model samples an output sample
};

// Half the mean square difference of two output samples of a noise with this two-sided spectrum (variance per cycle a
// sample), low-passed. Split at octaves: spectra and low-pass bend on a logarithmic scale.
double half_square_difference(const Chain& chain, const std::function<double(double)>& spectrum) {
  const double a = chain.pole;
  const auto integrand = [&](double nu) {
    const double half = std::sin(kPi * nu);
    const double pass = (1 - a) * (1 - a) / ((1 - a) * (1 - a) + 4 * a * half * half);
    const double difference = std::sin(kPi * nu * static_cast<double>(chain.step));
    return spectrum(nu) * pass * 4 * difference * difference;
  };
  using Rule = boost::math::quadrature::gauss_kronrod<double, 31>;
  // The difference makes it fall like nu at least: below a millionth of the output rate is nothing.
  const double lowest = 1e-7 / static_cast<double>(chain.step);
  const double arch = 0.5 / static_cast<double>(chain.step);  // of the sine
  double sum = 0;
  for (double to = arch; to > lowest; to /= 2) sum += Rule::integrate(integrand, to / 2, to, 0, 0);
  for (double from = arch; from < 0.5 - 1e-12; from += arch)
    sum += Rule::integrate(integrand, from, std::min(from + arch, 0.5), 0, 0);
  return sum;
}

double flicker_variogram(std::int64_t lag) {
  double sum = 0;
  for (std::int64_t k = lag; k >= 1; --k) sum += 1 / static_cast<double>(2 * k - 1);
  return 4 / kPi * sum;
}

// The values that are held, as seen by samples.
class Held {
 public:
  Held(const Chain& chain, double hold_s) : chain_(chain), length_(hold_s * chain.rate_hz) {}
  bool shorter_than_a_step() const { return length_ <= 1; }

  /// Mean over the phases of sum_m g_m^2.
  double white() const {
    double sum = 0;
    for (int phase = 0; phase < phases(); ++phase) {
      const std::int64_t t = at(phase);
      for (std::int64_t m = latest(t); remembered(t, m); --m) {
        const double g = share(t, m);
        sum += g * g;
      }
    }
    return sum / phases();
  }

  /// Half the mean square difference of two samples, for values of flicker of unit coefficient:
  /// with d_m = g_m(t + p) - g_m(t), whose sum is zero, it is -1/4 sum d_m d_n variogram(m - n).
  double flicker() const {
    std::vector<double> variogram(kMostHeld + 2);
    for (std::size_t n = 1; n < variogram.size(); ++n)
      variogram[n] = variogram[n - 1] + 4 / kPi / static_cast<double>(2 * n - 1);
    double sum = 0;
    std::vector<double> d;
    for (int phase = 0; phase < phases(); ++phase) {
      differences(at(phase), d);
      for (std::size_t i = 0; i < d.size(); ++i)
        for (std::size_t j = 0; j < i; ++j) sum -= d[i] * d[j] * variogram[i - j];
    }
    return sum / (2 * phases());
  }

 private:
  std::int64_t end(std::int64_t m) const {
    return clamped_whole<std::int64_t>(std::floor(static_cast<double>(m) * length_ * (1 + 1e-12)));
  }
  std::int64_t latest(std::int64_t t) const {
    auto m = clamped_whole<std::int64_t>(std::ceil(static_cast<double>(t) / length_ * (1 - 1e-12)));
    while (end(m) < t) ++m;
    while (end(m - 1) >= t) --m;
    return m;
  }
  double left_over(std::int64_t steps) const {
    return steps == 0 ? 1 : std::pow(chain_.pole, static_cast<double>(steps));
  }
  double share(std::int64_t t, std::int64_t m) const {
    return end(m - 1) >= t ? 0 : left_over(t - std::min(t, end(m))) - left_over(t - end(m - 1));
  }
  bool remembered(std::int64_t t, std::int64_t m) const {
    const auto age = static_cast<double>(t - std::min(t, end(m)));
    return chain_.pole > 0 ? -std::log(chain_.pole) * age < kForgotten : age < 1;
  }
  // Newest value first; the oldest entry stands for all before it.
  void differences(std::int64_t t, std::vector<double>& d) const {
    const std::int64_t later = t + chain_.step;
    d.clear();
    double rest = 0;
    for (std::int64_t m = latest(later); remembered(t, m) || end(m) >= t; --m) {
      const double both = share(later, m) - share(t, m);
      rest -= both;
      d.push_back(both);
      if (std::ssize(d) == kMostHeld) break;
    }
    d.push_back(rest);
  }
  // Phases repeat when a whole number of output samples is a whole number of holds.
  int phases() const {
    const double samples_per_hold = length_ / static_cast<double>(chain_.step);
    const int most = most_phases();
    for (int k = 1; k <= most; ++k) {
      const double holds = k / samples_per_hold;
      if (holds >= 1 - 1e-9 && std::abs(holds - std::round(holds)) < 1e-9 * k) return k;
    }
    return most;
  }
  // A low-pass that remembers many values does not mind where in the last one it is read.
  int most_phases() const {
    const double values = chain_.pole > 0 ? kForgotten / -std::log(chain_.pole) / length_ : 0;
    return static_cast<int>(std::clamp(1e6 / (1 + values), 1.0, 1.0 * kMostPhases));
  }
  // Long after the start. Too many phases to take all: spread evenly over one hold.
  std::int64_t at(int phase) const {
    const auto settled =
        chain_.step *
        clamped_whole<std::int64_t>(
            std::ceil((chain_.pole > 0 ? kForgotten / -std::log(chain_.pole) : 1) / static_cast<double>(chain_.step)));
    const auto start = end(clamped_whole<std::int64_t>(std::ceil(static_cast<double>(settled) / length_)));
    const auto begin = (start / chain_.step + 1) * chain_.step;
    const double samples_per_hold = length_ / static_cast<double>(chain_.step);
    const double stride = std::max(1.0, samples_per_hold / most_phases());
    return begin + chain_.step * clamped_whole<std::int64_t>(std::floor(phase * stride));
  }

  Chain chain_;
  double length_;  // model samples
};

double white_variance(const SensorModel& m, const Chain& chain) {
  const double q = simulated_value(m[Term::white]);
  if (q == 0) return 0;
  const double a = chain.pole, made = q * q * chain.rate_hz * (1 - a) / (1 + a);
  if (m.white_hold_s) {
    const Held held(chain, *m.white_hold_s);
    const double value = q * q / *m.white_hold_s;
    return held.shorter_than_a_step() ? value * (1 - a) / (1 + a) : value * held.white();
  }
  return m.noise_sampling == NoiseSampling::band_limited ? q * q * kPi * *m.bandwidth_hz : made;
}

double flicker_variance(const SensorModel& m, const Chain& chain) {
  const double b = simulated_value(m[Term::flicker]);
  if (b == 0) return 0;
  if (m.flicker_hold_s) {
    const Held held(chain, *m.flicker_hold_s);
    if (!held.shorter_than_a_step()) return b * b * held.flicker();
  }
  if (chain.pole == 0) return b * b * flicker_variogram(chain.step) / 2;
  return half_square_difference(chain, [b](double nu) { return b * b / (2 * std::sin(kPi * nu)); });
}

double walk_variance(const SensorModel& m, const Chain& chain) {
  const double k = simulated_value(m[Term::walk]);
  if (k == 0) return 0;
  const double step = k * k / chain.rate_hz;
  if (chain.pole == 0) return step * static_cast<double>(chain.step) / 2;
  return half_square_difference(chain, [step](double nu) {
    const double half = std::sin(kPi * nu);
    return step / (4 * half * half);
  });
}

double quantization_variance(const SensorModel& m, const Chain& chain) {
  const double qz = simulated_value(m[Term::quantization]) * chain.rate_hz, a = chain.pole;
  if (m.noise_sampling == NoiseSampling::band_limited) return 2 * qz * qz;
  return 2 * qz * qz * (1 - a) * (1 - a) / (1 + a);
}

}  // namespace

double sample_noise_variance(const SensorModel& m, double rate_hz, std::uint64_t oversampling) {
  if (!(rate_hz > 0) || !std::isfinite(rate_hz) || oversampling == 0)
    throw usage_error("E0915")
        .says("the noise of a sample needs a sampling rate and an oversampling above zero")
        .got(shortest(rate_hz) + " Hz, " + std::to_string(oversampling));
  if (m.noise_sampling == NoiseSampling::band_limited && !m.bandwidth_hz)
    throw usage_error("E0915").says("noise that is band-limited before sampling needs a bandwidth").got(m.channel);
  Chain chain{rate_hz * static_cast<double>(oversampling), 0, static_cast<std::int64_t>(oversampling)};
  if (m.bandwidth_hz) chain.pole = std::exp(-2 * kPi * *m.bandwidth_hz / chain.rate_hz);
  const double noise =
      white_variance(m, chain) + flicker_variance(m, chain) + walk_variance(m, chain) + quantization_variance(m, chain);
  const double step = m.resolution.value_or(0);
  return noise * m.sensitivity.gain * m.sensitivity.gain + step * step / 12;
}

}  // namespace libchar
