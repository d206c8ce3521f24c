#pragma once
// Signals with a known formula: the true input of a sensor array, or its temperature.

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libchar/simulate/random.hpp"

namespace libchar {

/// What a signal is; only the fields of its kind count.
struct SignalSpec {
  std::string kind = "zero";         ///< one of signal_kinds()
  double offset = 0;                 ///< added to every kind but zero
  double value = 0;                  ///< constant
  double amplitude = 1;              ///< sine, chirp, uniform: +-amplitude; sine_of, cosine_of: factor
  double frequency_hz = 1;           ///< sine
  double phase_rad = 0;              ///< sine, chirp
  double from_hz = 0.01, to_hz = 1;  ///< chirp, linear in time over the whole length
  double standard_deviation = 1;     ///< noise: of the white noise after its low-pass
  /// noise: corner of its first-order low-pass; 0: white up to half the rate
  double bandwidth_hz = 0;
  double renew_s = 0;  ///< uniform: a new value this often, held in between; 0: every sample
  /// uniform: probability that the old value stays at a renewal [RV 3.3's solver]
  double repeat = 0;
  double step = 1;   ///< random_walk: U/√s
  double slope = 0;  ///< ramp: U/s
  /// points: (t in s, value), linear in between, constant outside
  std::vector<std::pair<double, double>> points;
  std::size_t of = 0;           ///< derivative, sine_of, cosine_of: index of an earlier signal (rad)
  std::string file, channel;    ///< recording: where `samples` came from
  std::vector<double> samples;  ///< recording: at the rate of the simulation, held at its end
};

struct SignalKind {
  std::string word;               ///< "sine"
  std::vector<std::string> keys;  ///< that it reads, in addition to `kind` and `offset`
  std::string_view meaning;       ///< in docs: the formula
};

/// The kinds of signals, a row each.
const std::vector<SignalKind>& signal_kind_rows();

/// Their words.
const std::vector<std::string>& signal_kinds();

/// Keys that a kind reads, in addition to `kind` and `offset`.
const std::vector<std::string>& signal_keys(const std::string& kind);

/// A signal sample by sample: x(t_k), t_k = k / rate. Results do not depend on the block size.
class SignalSource {
 public:
  virtual ~SignalSource() = default;
  /// Fills the next samples; `earlier[j]` is the same block of signal j before this one.
  virtual void next(std::span<double> out, std::span<const std::span<const double>> earlier) = 0;
};

/// `index` and `seed` key the random kinds; `samples` is the length of the whole signal.
std::unique_ptr<SignalSource> make_signal(const SignalSpec& spec, double rate_hz, std::uint64_t samples,
                                          std::uint64_t seed, std::uint64_t index);

}  // namespace libchar
