// By how much the sensors lag the reference: the lag at which the sensors' mean and the reference
// look most alike; for a tilt, the rate and the slope of the reference angle.
#include "libchar/replay/detail/align/find_lag.hpp"

#include <cmath>

#include "libchar/core/error.hpp"
#include "libchar/fusion/tilt_angle.hpp"
#include "libchar/replay/detail/align/lag.hpp"

namespace libchar {
namespace {

constexpr std::size_t kBlock = 4096;
constexpr std::int64_t kMostInstants = 200000;
constexpr double kMostLag_s = 2;
/// Below it two signals have too little in common for their lag to mean anything.
constexpr double kLeastCorrelation = 0.5;

struct Pair {
  std::vector<double> sensor, reference;
};

Pair series(const Scene& scene,
            const Instants& instants,
            std::int64_t from,
            std::int64_t to,
            Progress& progress) {
  Pair out;
  double before = kMissing;
  instants.pass(from, to, kBlock, progress, [&](const InstantBlock& b) {
    for (Eigen::Index k = 0; k < b.samples.cols(); ++k) {
      if (scene.tilt) {
        out.sensor.push_back(b.samples(static_cast<Eigen::Index>(scene.tilt->gyroscope), k));
        out.reference.push_back(fusion::wrapped(b.truth(0, k) - before));
        before = b.truth(0, k);
      } else {
        out.sensor.push_back(b.samples.col(k).mean());
        out.reference.push_back(b.truth(0, k));
      }
    }
  });
  return out;
}

}  // namespace

double find_lag(const Scene& scene,
                const Instants& instants,
                const TimeWindow& window,
                Progress& progress) {
  const std::int64_t from = instants.instant_at(window.from_s);
  const std::int64_t to = std::min(instants.instant_at(window.to_s), from + kMostInstants);
  const Pair pair = series(scene, instants, from, to, progress);
  const double rate_hz = instants.info().rate_hz;
  const double most_s = std::min(kMostLag_s, static_cast<double>(to - from) / rate_hz / 4);
  LagEstimate found = estimate_lag(pair.sensor, pair.reference, rate_hz, most_s);
  // A difference of two samples stands in the middle between them, the rate at its own instant.
  if (scene.tilt) found.lag_s += 0.5 / rate_hz;
  if (!(found.correlation >= kLeastCorrelation))
    throw Error({ErrorKind::numeric,
                 "E0908",
                 scene.file,
                 "reference.lag_s: sensors and reference are too little alike to tell a lag",
                 "estimate",
                 "give lag_s as a number of seconds"});
  return found.lag_s;
}

}  // namespace libchar
