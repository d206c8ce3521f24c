// x(t_k), t_k = k / rate:
//   sine         offset + A sin(2 pi f t + phase)
//   chirp        offset + A sin(2 pi (f0 t + (f1 - f0) t^2 / (2 T)) + phase)
//   noise        offset + first-order low-passed white noise of the given standard deviation, stationary
//   uniform      offset + uniform on [-A, A], renewed every renew_s and held ([RV 3.3] with `repeat`)
//   random_walk  offset + sum of N(0, step^2 dt)
//   derivative   (x_k - x_{k-1}) rate of another signal: the mean over the last interval, so that its
//                sum gives that signal back
#include "libchar/simulate/signal.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/spelling.hpp"

namespace libchar {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;

// A signal whose value depends on the time only.
class Formula final : public SignalSource {
 public:
  Formula(double rate_hz, std::function<double(double)> value) : rate_hz_(rate_hz), value_(std::move(value)) {}
  void next(std::span<double> out, std::span<const std::span<const double>>) override {
    for (double& x : out) x = value_(static_cast<double>(k_++) / rate_hz_);
  }

 private:
  double rate_hz_;
  std::function<double(double)> value_;
  std::uint64_t k_ = 0;
};

// sin of so many turns, exact for many of them.
double sine_of_turns(double turns, double phase_rad) {
  return std::sin(kTurn * (turns - std::floor(turns)) + phase_rad);
}

class LowPassedNoise final : public SignalSource {
 public:
  LowPassedNoise(const SignalSpec& spec, double rate_hz, StreamKey key)
      : offset_(spec.offset), deviation_(spec.standard_deviation), normal_(key) {
    if (spec.bandwidth_hz > 0) memory_ = std::exp(-kTurn * spec.bandwidth_hz / rate_hz);
    gain_ = std::sqrt(-std::expm1(2 * std::log(std::max(memory_, 1e-300))));
  }
  void next(std::span<double> out, std::span<const std::span<const double>>) override {
    for (double& x : out) {
      state_ = started_ ? memory_ * state_ + gain_ * normal_.normal() : normal_.normal();
      started_ = true;
      x = offset_ + deviation_ * state_;
    }
  }

 private:
  double offset_, deviation_, memory_ = 0, gain_ = 1, state_ = 0;
  bool started_ = false;
  DeviateStream normal_;
};

class HeldUniform final : public SignalSource {
 public:
  HeldUniform(const SignalSpec& spec, double rate_hz, StreamKey key)
      : spec_(spec), samples_per_renewal_(spec.renew_s * rate_hz), uniform_(key) {}
  void next(std::span<double> out, std::span<const std::span<const double>>) override {
    for (double& x : out) {
      // Renewal n stands at sample n * samples_per_renewal; several may lie between two samples.
      const std::uint64_t due =
          samples_per_renewal_ > 0
              ? 1 + static_cast<std::uint64_t>(static_cast<double>(k_) / samples_per_renewal_ * (1 + 1e-12))
              : k_ + 1;
      for (; renewals_ < due; ++renewals_) renew();
      x = spec_.offset + value_;
      ++k_;
    }
  }

 private:
  void renew() {
    const bool keeps = spec_.repeat > 0 && renewals_ > 0 && uniform_.uniform() < spec_.repeat;
    if (!keeps) value_ = spec_.amplitude * (2 * uniform_.uniform() - 1);
  }
  SignalSpec spec_;
  double samples_per_renewal_;
  DeviateStream uniform_;
  std::uint64_t k_ = 0, renewals_ = 0;
  double value_ = 0;
};

class Walk final : public SignalSource {
 public:
  Walk(const SignalSpec& spec, double rate_hz, StreamKey key)
      : value_(spec.offset), step_(spec.step / std::sqrt(rate_hz)), normal_(key) {}
  void next(std::span<double> out, std::span<const std::span<const double>>) override {
    for (double& x : out) {
      x = value_;
      value_ += step_ * normal_.normal();
    }
  }

 private:
  double value_, step_;
  DeviateStream normal_;
};

class Points final : public SignalSource {
 public:
  Points(const SignalSpec& spec, double rate_hz) : spec_(spec), rate_hz_(rate_hz) {}
  void next(std::span<double> out, std::span<const std::span<const double>>) override {
    for (double& x : out) x = spec_.offset + at(static_cast<double>(k_++) / rate_hz_);
  }

 private:
  double at(double t) {
    const auto& p = spec_.points;
    while (next_ < p.size() && p[next_].first <= t) ++next_;
    if (next_ == 0) return p.front().second;
    if (next_ == p.size()) return p.back().second;
    const auto &a = p[next_ - 1], &b = p[next_];
    return a.second + (b.second - a.second) * (t - a.first) / (b.first - a.first);
  }
  SignalSpec spec_;
  double rate_hz_;
  std::uint64_t k_ = 0;
  std::size_t next_ = 0;
};

class Recorded final : public SignalSource {
 public:
  explicit Recorded(const SignalSpec& spec) : spec_(spec) {}
  void next(std::span<double> out, std::span<const std::span<const double>>) override {
    for (double& x : out) {
      x = spec_.offset + spec_.samples[std::min(k_, spec_.samples.size() - 1)];
      ++k_;
    }
  }

 private:
  SignalSpec spec_;
  std::size_t k_ = 0;
};

class Derivative final : public SignalSource {
 public:
  Derivative(const SignalSpec& spec, double rate_hz) : spec_(spec), rate_hz_(rate_hz) {}
  void next(std::span<double> out, std::span<const std::span<const double>> earlier) override {
    const std::span<const double> x = earlier[spec_.of];
    for (std::size_t i = 0; i < out.size(); ++i) {
      out[i] = spec_.offset + (started_ ? (x[i] - last_) * rate_hz_ : 0.0);
      last_ = x[i];
      started_ = true;
    }
  }

 private:
  SignalSpec spec_;
  double rate_hz_, last_ = 0;
  bool started_ = false;
};

class Circular final : public SignalSource {
 public:
  Circular(const SignalSpec& spec, double phase) : spec_(spec), phase_(phase) {}
  void next(std::span<double> out, std::span<const std::span<const double>> earlier) override {
    const std::span<const double> x = earlier[spec_.of];
    for (std::size_t i = 0; i < out.size(); ++i)
      out[i] = spec_.offset + spec_.amplitude * (phase_ == 0 ? std::sin(x[i]) : std::cos(x[i]));
  }

 private:
  SignalSpec spec_;
  double phase_;
};

}  // namespace

const std::vector<SignalKind>& signal_kind_rows() {
  static const std::vector<SignalKind> rows = {
      {"zero", {}, "0"},
      {"constant", {"value"}, "the value"},
      {"sine", {"amplitude", "frequency_hz", "phase_rad"}, "A sin(2πft + φ)"},
      {"chirp", {"amplitude", "from_hz", "to_hz", "phase_rad"}, "frequency linear in time over the whole length"},
      {"noise",
       {"standard_deviation", "bandwidth_hz"},
       "white noise behind a first-order low-pass (0: none), of this standard deviation"},
      {"uniform",
       {"amplitude", "renew_s", "repeat"},
       "uniform in ± A, renewed this often and held; kept at a renewal with probability `repeat`"},
      {"random_walk", {"step"}, "U/√s"},
      {"ramp", {"slope"}, "U/s"},
      {"points", {"points"}, "`[[t, value], …]`, linear in between, constant outside"},
      {"recording", {"file", "channel"}, "a channel of a log at the rate of the simulation; its last sample is held"},
      {"derivative", {"of"}, "of a signal listed before this one, by name or position from 0"},
      {"sine_of", {"of", "amplitude"}, "A sin x of such a signal in rad"},
      {"cosine_of", {"of", "amplitude"}, "A cos x of such a signal in rad"},
  };
  return rows;
}

const std::vector<std::string>& signal_kinds() {
  static const std::vector<std::string> kinds = [] {
    std::vector<std::string> names;
    for (const SignalKind& row : signal_kind_rows()) names.push_back(row.word);
    return names;
  }();
  return kinds;
}

const std::vector<std::string>& signal_keys(const std::string& kind) {
  static const std::vector<std::string> none;
  for (const SignalKind& row : signal_kind_rows())
    if (row.word == kind) return row.keys;
  return none;
}

std::unique_ptr<SignalSource> make_signal(const SignalSpec& spec, double rate_hz, std::uint64_t samples,
                                          std::uint64_t seed, std::uint64_t index) {
  const StreamKey key{seed, index, Purpose::truth};
  const std::string& kind = spec.kind;
  const auto formula = [&](std::function<double(double)> value) {
    return std::make_unique<Formula>(rate_hz, std::move(value));
  };
  if (kind == "zero") return formula([](double) { return 0.0; });
  if (kind == "constant") return formula([v = spec.offset + spec.value](double) { return v; });
  if (kind == "ramp") return formula([spec](double t) { return spec.offset + spec.slope * t; });
  if (kind == "sine")
    return formula([spec](double t) {
      return spec.offset + spec.amplitude * sine_of_turns(spec.frequency_hz * t, spec.phase_rad);
    });
  if (kind == "chirp") {
    const double whole = static_cast<double>(std::max<std::uint64_t>(samples, 1)) / rate_hz;
    return formula([spec, whole](double t) {
      const double turns = spec.from_hz * t + (spec.to_hz - spec.from_hz) * t * t / (2 * whole);
      return spec.offset + spec.amplitude * sine_of_turns(turns, spec.phase_rad);
    });
  }
  if (kind == "noise") return std::make_unique<LowPassedNoise>(spec, rate_hz, key);
  if (kind == "uniform") return std::make_unique<HeldUniform>(spec, rate_hz, key);
  if (kind == "random_walk") return std::make_unique<Walk>(spec, rate_hz, key);
  if (kind == "points") return std::make_unique<Points>(spec, rate_hz);
  if (kind == "recording") return std::make_unique<Recorded>(spec);
  if (kind == "derivative") return std::make_unique<Derivative>(spec, rate_hz);
  if (kind == "sine_of") return std::make_unique<Circular>(spec, 0.0);
  if (kind == "cosine_of") return std::make_unique<Circular>(spec, 0.25);
  const auto near = nearest(kind, signal_kinds());
  throw input_error("E0553")
      .says("unknown kind of signal")
      .got(kind)
      .hint(did_you_mean(near, fmt::format("one of {}", fmt::join(signal_kinds(), ", "))));
}

}  // namespace libchar
