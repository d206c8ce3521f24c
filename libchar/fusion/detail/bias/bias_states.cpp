#include "libchar/fusion/detail/bias/bias_states.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace libchar::fusion {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kApart = 10;       // ratio of correlation times of neighbours
constexpr double kHidden = 3;       // beyond this ratio of frequencies another noise hides flicker
constexpr double kWalkMemory = 10;  // of a walk, in units of the slowest process of flicker
constexpr double kFastestShare = 0.1;  // of the sampling rate: the fastest corner

struct Process {
  double tau_s, variance, drive_per_s;  // drive_per_s: of a walk
};

std::vector<Process> flicker_processes(const NoiseModel& model, double rate_hz, double slowest_s) {
  const double b = model.flicker;
  if (!(b > 0)) return {};
  const double square = b * b;
  // B^2/(2 pi f) = white density, and = K^2/(2 pi f)^2.
  const double white_hz = square * rate_hz / (2 * kPi * model.white);
  const double walk_hz = (model.walk / b) * (model.walk / b) / (2 * kPi);
  const double fast_s = 1 / (2 * kPi * std::min(kHidden * white_hz, kFastestShare * rate_hz));
  const double slow_s =
      walk_hz > 0 ? std::min(slowest_s, kHidden / (2 * kPi * walk_hz)) : slowest_s;
  std::vector<Process> out;
  for (double tau = slow_s; tau >= fast_s; tau /= kApart)
    out.push_back({tau, square * std::log(kApart) / kPi, 0});
  return out;
}

}  // namespace

BiasStates bias_states(const std::vector<NoiseModel>& models, double rate_hz, double slowest_s) {
  std::vector<Process> all;
  BiasStates out;
  for (std::size_t i = 0; i < models.size(); ++i) {
    std::vector<Process> own = flicker_processes(models[i], rate_hz, slowest_s);
    for (const RememberedNoise& noise : models[i].gauss_markov)
      if (noise.sigma > 0 && noise.tau_s > 0)
        own.push_back({noise.tau_s, noise.sigma * noise.sigma, 0});
    if (models[i].walk > 0)
      own.push_back({kWalkMemory * slowest_s, 0, models[i].walk * models[i].walk});
    out.channel.insert(out.channel.end(), own.size(), static_cast<Eigen::Index>(i));
    all.insert(all.end(), own.begin(), own.end());
  }
  const auto n = static_cast<Eigen::Index>(all.size());
  out.pole.resize(n);
  out.drive.resize(n);
  out.start.resize(n);
  for (Eigen::Index s = 0; s < n; ++s) {
    const Process& process = all[static_cast<std::size_t>(s)];
    const double step = 1 / (rate_hz * process.tau_s);
    out.pole[s] = std::exp(-step);
    out.drive[s] = process.variance * -std::expm1(-2 * step) + process.drive_per_s / rate_hz;
    out.start[s] = process.variance;
  }
  return out;
}

}  // namespace libchar::fusion
