// y = quantize(gain * saturate(low_pass(alpha x + c1 x^2 + c2 x^3 + beta + noise)))   [RV 2.2-2.6]
//   alpha = N(alpha0, s_a) (1 + tc1 dT + tc2 dT^2)        beta = N(beta0, s_b) + tc1 dL + tc2 dL^2 + tc3 dL^3
//   L' = (T - L) / lag, L = T at the first sample (no lag: L = T); dT, dL about the reference
//   with deterministic terms: beta + steps + size exp(-t / tau) + slope t
//   c1 = quadratic (1 + tc dT), c2 = cubic (1 + tc dT), both of the raw x (docs/models.md)
//   low_pass: y_k = a y_{k-1} + (1 - a) u_k, a = exp(-2 pi bandwidth / rate)
// Known answers, block by block: fixtures/known/fusion/sensor_model.csv.

#include "libchar/simulate/detail/sensor_chain.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>

#include "libchar/core/numeric/whole.hpp"
#include "libchar/simulate/detail/noise_generator.hpp"
#include "libchar/spectrum/fft.hpp"

namespace libchar {
namespace {

NoiseDesign noise_design(const SensorModel& m, const ChainOptions& options) {
  NoiseDesign design;
  for (std::size_t t = 0; t < kTerms; ++t) design.coefficient[t] = simulated_value(m.noise[t]);
  if (m.white_hold_s) design.coefficient[static_cast<std::size_t>(Term::white)] = 0;
  if (m.flicker_hold_s) design.coefficient[static_cast<std::size_t>(Term::flicker)] = 0;
  design.flicker_phase = m.flicker_phase;
  design.gauss_markov_sigma = m.gauss_markov.sigma;
  design.gauss_markov_tau_s = m.gauss_markov.tau_s;
  design.rate_hz = options.rate_hz;
  design.bandwidth_hz = m.bandwidth_hz;
  if (m.noise_sampling == NoiseSampling::band_limited) design.sampling = Sampling::band_limited;
  if (m.noise_start == NoiseStart::zero) design.start = Start::zero;
  design.flicker_method = m.flicker_method;
  return design;
}

// One term made at its own step and held in between, as published [RV 3.3]. Sample k of the
// low-pass answers to what stood between k - 1 and k, so a value is renewed behind the instants m
// hold_s, and the sample there still has the old one: read at renewals, its variance is (1 - a)/(1
// + a) of the held noise, a = exp(-2 pi bandwidth hold_s).
class HeldNoise {
 public:
  HeldNoise(const SensorModel& m, Term term, double hold_s, const ChainOptions& options)
      : samples_per_renewal_(hold_s * options.rate_hz),
        noise_(design(m, term, hold_s, options), options.seed, options.sensor) {}

  void add(std::span<double> out) {
    for (double& sample : out) {
      const auto due =
          1 + clamped_whole<std::uint64_t>(std::ceil(static_cast<double>(k_++) / samples_per_renewal_ * (1 - 1e-12)));
      for (; renewals_ < due; ++renewals_) {
        value_ = 0;
        noise_.add({&value_, 1}, {});
      }
      sample += value_;
    }
  }

 private:
  static NoiseDesign design(const SensorModel& m, Term term, double hold_s, const ChainOptions& options) {
    NoiseDesign design = noise_design(m, options);
    design.coefficient = {};
    design.gauss_markov_sigma = design.flicker_phase = 0;
    design.coefficient[static_cast<std::size_t>(term)] = simulated_value(m[term]);
    design.rate_hz = 1 / hold_s;
    design.bandwidth_hz = std::nullopt;
    design.sampling = Sampling::per_sample;
    return design;
  }
  double samples_per_renewal_, value_ = 0;
  std::uint64_t k_ = 0, renewals_ = 0;
  NoiseGenerator noise_;
};

double drawn(double value, double spread, const ChainOptions& options, Purpose purpose) {
  if (!(spread > 0)) return value;
  return value + spread * DeviateStream({options.seed, options.sensor, purpose}).normal();
}

}  // namespace

struct SensorChain::State {
  SensorModel model;
  ChainOptions options;
  DeviceDraw draw;
  NoiseGenerator noise;
  std::vector<HeldNoise> held;
  std::optional<ShapeFilter> shaped;  ///< takes the noise through the model's shape
  double low_pass_memory = 0, low_pass_state = 0;
  bool low_pass_started = false;
  std::optional<double> lagged_temperature;
  std::uint64_t samples_done = 0;
  std::vector<double> after;

  State(const SensorModel& m, const ChainOptions& o)
      : model(m), options(o), noise(noise_design(m, o), o.seed, o.sensor) {
    draw.scale_factor = drawn(m.scale_factor.value, m.scale_factor.spread, o, Purpose::scale_draw);
    draw.bias = drawn(m.bias.value, m.bias.spread, o, Purpose::bias_draw);
    if (m.white_hold_s && m[Term::white].value) held.emplace_back(m, Term::white, *m.white_hold_s, o);
    if (m.flicker_hold_s && m[Term::flicker].value) held.emplace_back(m, Term::flicker, *m.flicker_hold_s, o);
    if (m.noise_shape.kind != NoiseShape::Kind::none)
      shaped.emplace(m.noise_shape, o.rate_hz, [this](std::span<double> out) { add_noise(out); });
    if (m.bandwidth_hz) low_pass_memory = std::exp(-2 * std::numbers::pi * *m.bandwidth_hz / o.rate_hz);
  }

  void add_noise(std::span<double> samples) {
    if (noise.adds_after()) after.assign(samples.size(), 0.0);
    noise.add(samples, after);
    for (HeldNoise& one : held) one.add(samples);
  }

  // Blocks 1 to 3 at one temperature.
  struct Coefficients {
    double scale, quadratic, cubic, bias;
  };
  Coefficients at(double dt, double lagged) const {
    const SensorModel& m = model;
    return {draw.scale_factor * (1 + dt * (m.scale_factor.tc1_per_k + dt * m.scale_factor.tc2_per_k2)),
            m.nonlinearity.quadratic * (1 + m.nonlinearity.quadratic_tc_per_k * dt),
            m.nonlinearity.cubic * (1 + m.nonlinearity.cubic_tc_per_k * dt),
            draw.bias + lagged * (m.bias.tc1_per_k + lagged * (m.bias.tc2_per_k2 + lagged * m.bias.tc3_per_k3))};
  }
  static double deterministic(const Coefficients& c, double x) {
    return x * (c.scale + x * (c.quadratic + x * c.cubic)) + c.bias;
  }

  double lag(double temperature) {
    if (!(model.bias.lag_s > 0)) return temperature;
    double& state = lagged_temperature ? *lagged_temperature : lagged_temperature.emplace(temperature);
    if (!std::isnan(temperature))
      state -= std::expm1(-1 / (model.bias.lag_s * options.rate_hz)) * (temperature - state);
    return state;
  }

  void deterministic_blocks(std::span<double> y, std::span<const double> temperature) {
    if (temperature.empty()) {
      const Coefficients c = at(0, 0);
      if (c.scale == 1 && c.quadratic == 0 && c.cubic == 0 && c.bias == 0) return;
      for (double& v : y) v = deterministic(c, v);
      return;
    }
    const double reference = model.reference_temperature_degc;
    for (std::size_t i = 0; i < y.size(); ++i)
      y[i] = deterministic(at(temperature[i] - reference, lag(temperature[i]) - reference), y[i]);
  }

  // Steps, warm-ups and ramps by the time since the first sample.
  void add_deterministic_terms(std::span<double> y) {
    using Kind = DeterministicTerm::Kind;
    const auto first = static_cast<double>(samples_done);
    samples_done += y.size();
    if (!options.deterministic) return;
    for (const DeterministicTerm& term : model.deterministic) {
      for (std::size_t i = 0; i < y.size(); ++i) {
        const double index = first + static_cast<double>(i), t = index / options.rate_hz;
        if (term.kind == Kind::step) y[i] += index >= std::round(term.at_s * options.rate_hz) ? term.size : 0;
        if (term.kind == Kind::warm_up) y[i] += term.size * std::exp(-t / term.tau_s);
        if (term.kind == Kind::ramp) y[i] += term.per_s * t;
      }
    }
  }

  // The level that the low-pass would have reached before the first sample: the signal's, and the
  // noise of an infinite past.
  double steady_start(double first_signal) const { return first_signal + noise.low_pass_start(); }

  void low_pass(std::span<double> y, double first_signal) {
    if (!low_pass_started) {
      if (std::isnan(first_signal)) first_signal = 0;
      low_pass_state = options.low_pass_starts_at_zero ? 0 : steady_start(first_signal);
      low_pass_started = true;
    }
    const double a = low_pass_memory;
    for (double& v : y) {
      if (std::isnan(v)) continue;  // the filter waits for the next sample
      low_pass_state = a * low_pass_state + (1 - a) * v;
      v = low_pass_state;
    }
  }

  void output_blocks(std::span<double> y) const {
    if (model.saturation_low && model.saturation_high)
      for (double& v : y)
        if (!std::isnan(v)) v = std::clamp(v, *model.saturation_low, *model.saturation_high);
    if (model.sensitivity.gain != 1)
      for (double& v : y) v *= model.sensitivity.gain;
    if (model.resolution)
      for (double& v : y) v = std::nearbyint(v / *model.resolution) * *model.resolution;
  }
};

SensorChain::SensorChain(const SensorModel& model, const ChainOptions& options)
    : state_(detail::hidden<State>(model, options)) {}

void SensorChain::run(std::span<double> samples, std::span<const double> temperature_degc) {
  State& s = *state_;
  if (samples.empty()) return;
  s.deterministic_blocks(samples, temperature_degc);
  s.add_deterministic_terms(samples);
  const double first_signal = samples[0];
  if (s.shaped)
    s.shaped->add(samples);
  else
    s.add_noise(samples);
  if (s.model.bandwidth_hz) s.low_pass(samples, first_signal);
  for (std::size_t i = 0; i < s.after.size(); ++i) samples[i] += s.after[i];
  s.output_blocks(samples);
}

DeviceDraw SensorChain::draw() const { return state_->draw; }

// y = h * u by overlap-save: blocks of n samples, of which the first taps - 1 are those of the block before. boxcar:
// h = 1/m, m times; bartlett: its convolution with itself; measured: frequency sampling, h = inverse transform of the
// square root of the ratio (zero phase, moved by half its length), under a Hann window, divided by its sum. (Oppenheim
// & Schafer, Discrete-Time Signal Processing, 8.7.3 and 7.5.)

namespace {

constexpr std::size_t kMostTaps = std::size_t{1} << 16U;
constexpr std::size_t kFewestTaps = 64;
/// Of the lowest frequency of a measured shape: its bins are an eighth of an octave wide, and the
/// window smears none into the next.
constexpr double kTapsPerPeriod = 96;

std::size_t power_of_two(double at_least) {
  std::size_t n = 1;
  while (static_cast<double>(n) < at_least) n *= 2;
  return n;
}

std::vector<double> triangle(std::size_t m) {
  std::vector<double> h(2 * m - 1);
  const double scale = 1 / (static_cast<double>(m) * static_cast<double>(m));
  for (std::size_t i = 0; i < h.size(); ++i) h[i] = scale * static_cast<double>(i < m ? i + 1 : h.size() - i);
  return h;
}

std::vector<double> sampled_response(const NoiseShape& shape, double rate_hz) {
  const double wanted = kTapsPerPeriod * rate_hz / shape.frequency_hz.front();
  const std::size_t n = std::clamp(power_of_two(std::min(wanted, 1e9)), kFewestTaps, kMostTaps);
  RealFft plan(n);
  const std::span<std::complex<double>> gain = plan.coefficients();
  // Of a shape that reaches below what the taps resolve the window mixes several gains there, and their sum says
  // nothing of the others.
  const double slowest = shape_ratio(shape, rate_hz / (2 * static_cast<double>(n)), rate_hz);
  gain[0] = std::sqrt(slowest);
  for (std::size_t k = 1; k < gain.size(); ++k) {
    const double f = rate_hz * static_cast<double>(k) / static_cast<double>(n);
    // Half a block later: (-1)^k.
    gain[k] = (k % 2 == 0 ? 1 : -1) * std::sqrt(shape_ratio(shape, f, rate_hz));
  }
  const std::span<const double> response = plan.inverse();
  std::vector<double> h(n);
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) {
    const double phase = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    sum += h[i] = response[i] * 0.5 * (1 - std::cos(phase));
  }
  for (double& tap : h) tap /= slowest == 1 ? sum : static_cast<double>(n);
  return h;
}

}  // namespace

std::vector<double> shape_taps(const NoiseShape& shape, double rate_hz) {
  const auto m = static_cast<std::size_t>(shape.taps);
  switch (shape.kind) {
    case NoiseShape::Kind::none:
      return {1};
    case NoiseShape::Kind::boxcar:
      return std::vector<double>(m, 1 / static_cast<double>(m));
    case NoiseShape::Kind::bartlett:
      return triangle(m);
    case NoiseShape::Kind::measured:
      return sampled_response(shape, rate_hz);
  }
  return {1};
}

struct ShapeFilter::State {
  std::function<void(std::span<double>)> source;
  std::size_t taps, fresh;
  RealFft plan;
  std::vector<std::complex<double>> response;
  std::vector<double> input;     ///< taps - 1 of the block before, then fresh ones
  std::vector<double> filtered;  ///< not given out from `given` on
  std::size_t given = 0;
  bool started = false;

  State(const std::vector<double>& h, std::function<void(std::span<double>)> from)
      : source(std::move(from)),
        taps(h.size()),
        fresh(power_of_two(4 * static_cast<double>(taps)) - taps + 1),
        plan(taps + fresh - 1),
        input(taps + fresh - 1, 0.0) {
    const std::span<double> padded = plan.input();
    std::fill(padded.begin(), padded.end(), 0.0);
    std::copy(h.begin(), h.end(), padded.begin());
    const auto transformed = plan.transform();
    response.assign(transformed.begin(), transformed.end());
  }

  void next_block() {
    const auto overlap = static_cast<std::ptrdiff_t>(taps - 1);
    if (!started) source(std::span(input).last(taps - 1));
    started = true;
    std::copy(input.end() - overlap, input.end(), input.begin());
    std::fill(input.begin() + overlap, input.end(), 0.0);
    source(std::span(input).last(fresh));
    std::copy(input.begin(), input.end(), plan.input().begin());
    const auto transformed = plan.transform();
    std::vector<std::complex<double>> product(transformed.begin(), transformed.end());
    for (std::size_t k = 0; k < product.size(); ++k) product[k] *= response[k];
    std::copy(product.begin(), product.end(), plan.coefficients().begin());
    const std::span<const double> y = plan.inverse();
    filtered.assign(y.begin() + overlap, y.end());
    for (double& v : filtered) v /= static_cast<double>(plan.size());
    given = 0;
  }
};

ShapeFilter::ShapeFilter(const NoiseShape& shape, double rate_hz, std::function<void(std::span<double>)> source)
    : state_(detail::hidden<State>(shape_taps(shape, rate_hz), std::move(source))) {}

void ShapeFilter::add(std::span<double> out) {
  State& s = *state_;
  for (double& sample : out) {
    if (s.given == s.filtered.size()) s.next_block();
    sample += s.filtered[s.given++];
  }
}

}  // namespace libchar
