// Sample models of the terms, w standard normal, dt = 1/rate (accuracy notes 1; libchar/allan/
// noise_curves.cpp has their exact curves):
//
//   white         Q/sqrt(dt) w_t                     flicker   B (1 - z^-1)^(-1/2) w_t
//   random walk   x_t = x_{t-1} + K sqrt(dt) w_t     quantization   Qz (w_t - w_{t-1})/dt
//   ramp          R t
//   Gauss-Markov  y_t = phi y_{t-1} + sigma sqrt(1 - phi^2) w_t, phi = exp(-dt/tau)
//
// Band limited: continuous white noise of two-sided density Q^2 behind a first-order low-pass of
// corner f_c is an Ornstein-Uhlenbeck process of variance Q^2 pi f_c; its samples are exactly
// z_t = a z_{t-1} + sqrt(Q^2 pi f_c (1 - a^2)) w_t, a = exp(-2 pi f_c dt).

#include "libchar/simulate/detail/noise_generator.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>
#include <variant>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/simulate/detail/flicker.hpp"

namespace libchar {
namespace {

constexpr std::size_t kBlock = 512;

void check(const NoiseDesign& design) {
  if (!(std::isfinite(design.rate_hz) && design.rate_hz > 0))
    throw usage_error("E0953").says("the sample rate of a noise must be positive").got(shortest(design.rate_hz));
  for (std::size_t i = 0; i < kTerms; ++i) {
    const double value = design.coefficient[i];
    const bool fits = std::isfinite(value) && (value >= 0 || static_cast<Term>(i) == Term::ramp);
    if (!fits)
      throw usage_error("E0953")
          .says("the noise coefficient " + std::string(kTermNames[i].key) + " must be a finite number, not negative")
          .got(shortest(value));
    if (!std::isfinite(value * std::max(design.rate_hz, 1 / design.rate_hz)))
      throw usage_error("E0953")
          .says("the noise coefficient " + std::string(kTermNames[i].key) + " is too large for this sample rate")
          .got(shortest(value));
  }
  const bool process =
      std::isfinite(design.gauss_markov_sigma) && design.gauss_markov_sigma >= 0 &&
      (design.gauss_markov_sigma == 0 || (std::isfinite(design.gauss_markov_tau_s) && design.gauss_markov_tau_s > 0));
  if (!process)
    throw usage_error("E0953")
        .says("a Gauss-Markov process needs a finite standard deviation, not negative, and a positive correlation time")
        .got(shortest(design.gauss_markov_sigma) + ", " + shortest(design.gauss_markov_tau_s));
  if (design.bandwidth_hz && !(std::isfinite(*design.bandwidth_hz) && *design.bandwidth_hz > 0))
    throw usage_error("E0953")
        .says("the bandwidth must be positive")
        .got(shortest(*design.bandwidth_hz))
        .hint("leave it out for none");
  if (design.sampling == Sampling::band_limited && !design.bandwidth_hz)
    throw usage_error("E0953")
        .says("noise that is band-limited before sampling needs a bandwidth")
        .hint("give the bandwidth, or choose noise made sample by sample");
  if (design.flicker_method != "recursive" && design.flicker_method != "rv-truncated-iir")
    throw usage_error("E0953")
        .says("unknown method of making flicker")
        .got(design.flicker_method)
        .hint("`recursive` or `rv-truncated-iir`");
  if (design.flicker_method == "rv-truncated-iir" && design.truncated_taps == 0)
    throw usage_error("E0953").says("the truncated filter needs at least one coefficient").got("0");
}

/// A first-order Gauss-Markov process at the samples: continuous white noise behind a low-pass is one.
struct FilteredWhite {
  DeviateStream deviates;
  double pole, drive, value;
};

struct PlainWhite {
  DeviateStream deviates;
  double level;
};

struct Flicker {
  DeviateStream deviates;
  double level;
  std::variant<FlickerStream, TruncatedKasdin> filter;
};

/// Differences of flicker.
struct FlickerPhase {
  Flicker phase;
  double before = 0;
};

struct Walk {
  DeviateStream deviates;
  double step, value = 0;
};

struct Quantization {
  DeviateStream deviates;
  double level, before;
};

struct Ramp {
  double slope_per_s, rate_hz;
  std::uint64_t index = 0;
};

using Out = std::span<double>;
using Scratch = std::span<double>;

void add_term(FilteredWhite& white, Out out, Scratch drawn) {
  white.deviates.fill_normal(drawn);
  double value = white.value;  // a local: `out` cannot be it
  for (std::size_t t = 0; t < out.size(); ++t) {
    value = white.pole * value + white.drive * drawn[t];
    out[t] += value;
  }
  white.value = value;
}

void add_term(PlainWhite& white, Out out, Scratch drawn) {
  white.deviates.fill_normal(drawn);
  for (std::size_t t = 0; t < out.size(); ++t) out[t] += white.level * drawn[t];
}

void add_term(Flicker& flicker, Out out, Scratch drawn) {
  flicker.deviates.fill_normal(drawn);
  std::visit([drawn](auto& filter) { filter.run(drawn); }, flicker.filter);
  for (std::size_t t = 0; t < out.size(); ++t) out[t] += flicker.level * drawn[t];
}

void add_term(FlickerPhase& noise, Out out, Scratch drawn) {
  noise.phase.deviates.fill_normal(drawn);
  std::visit([drawn](auto& filter) { filter.run(drawn); }, noise.phase.filter);
  for (std::size_t t = 0; t < out.size(); ++t) {
    out[t] += noise.phase.level * (drawn[t] - noise.before);
    noise.before = drawn[t];
  }
}

void add_term(Walk& walk, Out out, Scratch drawn) {
  walk.deviates.fill_normal(drawn);
  double value = walk.value;
  for (std::size_t t = 0; t < out.size(); ++t) {
    value += walk.step * drawn[t];
    out[t] += value;
  }
  walk.value = value;
}

void add_term(Quantization& noise, Out out, Scratch drawn) {
  noise.deviates.fill_normal(drawn);
  if (out.empty()) return;
  out[0] += noise.level * (drawn[0] - noise.before);
  for (std::size_t t = 1; t < out.size(); ++t) out[t] += noise.level * (drawn[t] - drawn[t - 1]);
  noise.before = drawn.back();
}

void add_term(Ramp& ramp, Out out, Scratch) {
  for (double& value : out) value += ramp.slope_per_s * (static_cast<double>(ramp.index++) / ramp.rate_hz);
}

Flicker make_flicker(const NoiseDesign& design, double level, std::uint64_t seed, std::uint64_t sensor) {
  DeviateStream driving({seed, sensor, Purpose::flicker});
  if (design.flicker_method == "rv-truncated-iir")
    return {std::move(driving), level, TruncatedKasdin(design.truncated_taps)};
  const FlickerFilter filter = design_flicker(design.length);
  if (design.start == Start::zero) return {std::move(driving), level, FlickerStream(filter)};
  DeviateStream start({seed, sensor, Purpose::flicker_start});
  return {std::move(driving), level, FlickerStream(filter, start)};
}

FilteredWhite make_filtered_white(const NoiseDesign& design, double q, std::uint64_t seed, std::uint64_t sensor) {
  const double exponent = 2 * std::numbers::pi * *design.bandwidth_hz / design.rate_hz;
  const double deviation = q * std::sqrt(std::numbers::pi * *design.bandwidth_hz);
  DeviateStream start({seed, sensor, Purpose::white_start});
  return {DeviateStream({seed, sensor, Purpose::white}), std::exp(-exponent),
          deviation * std::sqrt(-std::expm1(-2 * exponent)), deviation * start.normal()};
}

FilteredWhite make_gauss_markov(const NoiseDesign& design, std::uint64_t seed, std::uint64_t sensor) {
  const double x = 1 / (design.rate_hz * design.gauss_markov_tau_s);
  DeviateStream deviates({seed, sensor, Purpose::gauss_markov});
  const double first = design.gauss_markov_sigma * deviates.normal();
  return {std::move(deviates), std::exp(-x), design.gauss_markov_sigma * std::sqrt(-std::expm1(-2 * x)), first};
}

FlickerPhase make_flicker_phase(const NoiseDesign& design, std::uint64_t seed, std::uint64_t sensor) {
  const FlickerFilter filter = design_flicker(design.length);
  DeviateStream start({seed, sensor, Purpose::flicker_phase_start});
  FlickerPhase out{{DeviateStream({seed, sensor, Purpose::flicker_phase}), design.flicker_phase * design.rate_hz,
                    FlickerStream(filter, start)}};
  double first = out.phase.deviates.normal();
  std::visit([&first](auto& stream) { stream.run(std::span(&first, 1)); }, out.phase.filter);
  out.before = first;
  return out;
}

}  // namespace

struct NoiseGenerator::State {
  std::optional<FlickerPhase> flicker_phase;
  std::optional<FilteredWhite> gauss_markov;
  std::optional<FilteredWhite> filtered_white;
  std::optional<PlainWhite> white;
  std::optional<Flicker> flicker;
  std::optional<Walk> walk;
  std::optional<Quantization> quantization;
  std::optional<Ramp> ramp;
  bool quantization_after = false;
  double low_pass_start = 0;
  std::array<double, kBlock> scratch;
  double past_in_low_pass(const NoiseDesign& design, DeviateStream deviates) const;
};

NoiseGenerator::NoiseGenerator(const NoiseDesign& design, std::uint64_t seed, std::uint64_t sensor)
    : state_(detail::hidden<State>()) {
  check(design);
  const auto coefficient = [&design](Term term) { return design.coefficient[static_cast<std::size_t>(term)]; };
  const auto stream = [seed, sensor](Purpose purpose) { return DeviateStream({seed, sensor, purpose}); };
  const double rate = design.rate_hz;
  const bool band_limited = design.sampling == Sampling::band_limited;
  if (const double q = coefficient(Term::white); q > 0) {
    if (band_limited)
      state_->filtered_white = make_filtered_white(design, q, seed, sensor);
    else
      state_->white = PlainWhite{stream(Purpose::white), q * std::sqrt(rate)};
  }
  if (const double b = coefficient(Term::flicker); b > 0) state_->flicker = make_flicker(design, b, seed, sensor);
  if (const double k = coefficient(Term::walk); k > 0) state_->walk = Walk{stream(Purpose::walk), k / std::sqrt(rate)};
  if (const double qz = coefficient(Term::quantization); qz > 0) {
    DeviateStream deviates = stream(Purpose::quantization);
    const double before = deviates.normal();
    state_->quantization = Quantization{std::move(deviates), qz * rate, before};
    state_->quantization_after = band_limited;
  }
  if (design.flicker_phase > 0) state_->flicker_phase = make_flicker_phase(design, seed, sensor);
  if (design.gauss_markov_sigma > 0) state_->gauss_markov = make_gauss_markov(design, seed, sensor);
  if (const double r = coefficient(Term::ramp); r != 0) state_->ramp = Ramp{r, rate};
  state_->low_pass_start = state_->past_in_low_pass(design, stream(Purpose::white_start));
}

// What the past has left in y = a y + (1 - a) u. White: (1-a) sum_k a^k u_{-1-k} has variance
// (1-a)/(1+a) of u. Quantization: (1-a) Qz/dt [w_{-1} - (1-a) sum_k a^k w_{-2-k}], whose w_{-1} is
// the one that the first sample subtracts.
double NoiseGenerator::State::past_in_low_pass(const NoiseDesign& design, DeviateStream deviates) const {
  if (!design.bandwidth_hz || design.sampling == Sampling::band_limited) return 0;
  const double half = std::numbers::pi * *design.bandwidth_hz / design.rate_hz;
  const double pass = -std::expm1(-2 * half);       // 1 - a
  const double share = std::sqrt(std::tanh(half));  // of the standard deviation: (1-a)/(1+a)
  double past = 0;
  if (white) past += white->level * share * deviates.normal();
  deviates.seek(1);
  if (quantization) past += quantization->level * pass * (quantization->before - share * deviates.normal());
  return past;
}

double NoiseGenerator::low_pass_start() const { return state_->low_pass_start; }

bool NoiseGenerator::adds_after() const {
  return state_->filtered_white || (state_->quantization && state_->quantization_after);
}

void NoiseGenerator::add(std::span<double> before_low_pass, std::span<double> after_low_pass) {
  assert(before_low_pass.size() == after_low_pass.size() || !adds_after());
  State& s = *state_;
  for (std::size_t t = 0; t < before_low_pass.size(); t += kBlock) {
    const std::size_t count = std::min(kBlock, before_low_pass.size() - t);
    const Scratch scratch = std::span(s.scratch).first(count);
    const Out before = before_low_pass.subspan(t, count);
    const Out after = adds_after() ? after_low_pass.subspan(t, count) : Out{};
    if (s.white) add_term(*s.white, before, scratch);
    if (s.flicker) add_term(*s.flicker, before, scratch);
    if (s.walk) add_term(*s.walk, before, scratch);
    if (s.flicker_phase) add_term(*s.flicker_phase, before, scratch);
    if (s.gauss_markov) add_term(*s.gauss_markov, before, scratch);
    if (s.ramp) add_term(*s.ramp, before, scratch);
    if (s.filtered_white) add_term(*s.filtered_white, after, scratch);
    if (s.quantization) add_term(*s.quantization, s.quantization_after ? after : before, scratch);
  }
}

}  // namespace libchar
