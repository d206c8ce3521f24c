#pragma once
// The shipped scenes of [RV], simulated into memory, and algorithms run on them: what
// tests/bench/thesis_tables.cpp and tests/replay/thesis_test.cpp share.

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "libchar/fusion/algorithms/blind_calibration.hpp"
#include "libchar/fusion/algorithms/least_squares.hpp"
#include "libchar/fusion/registry.hpp"
#include "libchar/fusion/runner.hpp"
#include "libchar/replay/detail/plan/noise_level.hpp"
#include "libchar/scene/scene.hpp"
#include "libchar/scene/scene_file.hpp"
#include "libchar/simulate/sensor_array.hpp"
#include "tests/support/places.hpp"

namespace test::thesis {

using Index = Eigen::Index;

struct Recorded {
  libchar::Scene scene;
  Eigen::MatrixXd y;     // a column an instant
  Eigen::RowVectorXd x;  // the true input
  libchar::fusion::Array array;
  Index instant(double time_s) const {
    return std::min(x.size(), static_cast<Index>(std::lround(time_s * array.rate_hz)));
  }
};

inline Recorded simulate(const std::string& file, std::uint64_t seed, bool flicker = true) {
  Recorded r;
  r.scene = libchar::read_scene_file(test::fixtures_folder().string() + "/scenes/" + file);
  libchar::ArraySimulation& s = *r.scene.simulate;
  s.seed = seed;
  if (!flicker)
    for (libchar::SimulatedSensor& sensor : s.sensors)
      sensor.model.noise[static_cast<std::size_t>(libchar::Term::flicker)].value = 0;
  const auto n = static_cast<Index>(s.sensors.size()), samples = static_cast<Index>(s.samples);
  r.y.resize(n, samples);
  r.x.resize(samples);
  libchar::ArraySimulator simulator(s);
  for (Index done = 0; done < samples;) {
    const auto block = simulator.next(4096);
    const auto rows = static_cast<Index>(block[0].size());
    for (Index i = 0; i < n; ++i)
      r.y.row(i).segment(done, rows) =
          Eigen::Map<const Eigen::RowVectorXd>(block[static_cast<std::size_t>(i)].data(), rows);
    r.x.segment(done, rows) = Eigen::Map<const Eigen::RowVectorXd>(block[static_cast<std::size_t>(n)].data(), rows);
    done += rows;
  }
  r.array.channels = n;
  r.array.rate_hz = s.rate_hz;
  r.array.reference_throughout = true;
  r.array.learning_samples = samples;
  r.array.noise_levels.resize(n);
  for (Index i = 0; i < n; ++i)
    r.array.noise_levels[i] =
        libchar::sample_noise_variance(s.sensors[static_cast<std::size_t>(i)].model, s.rate_hz, s.oversampling);
  if (r.scene.fault_free_s) r.array.fault_free_samples = r.instant(*r.scene.fault_free_s);
  return r;
}

using Options = std::vector<std::pair<std::string, double>>;

struct Ran {
  Eigen::RowVectorXd x;
  Eigen::MatrixXd weights;  // at the end; empty when the algorithm has none
  std::vector<libchar::fusion::FaultEvent> faults;
};

/// Runs on the whole recording; what learns, learns on [from, to) before.
inline Ran run(const std::string& name, const Options& options, const Recorded& r, Index from = 0, Index to = 0) {
  const libchar::fusion::Entry& entry = libchar::fusion::algorithm(name);
  libchar::fusion::Settings settings(entry.options);
  for (const auto& [option, value] : options) settings.set(option, value);
  const auto runner = entry.make(r.array, settings);
  if (to > from) {
    const Eigen::MatrixXd truth = r.x.segment(from, to - from);
    runner->learn(r.y.middleCols(from, to - from), truth);
    runner->finish_learning();
  }
  Eigen::MatrixXd x(1, r.x.size()), variance(1, r.x.size());
  runner->run(r.y, x, variance);
  Ran ran{x, {}, {}};
  if (const auto weights = runner->weights()) ran.weights = *weights;
  if (const auto* faults = runner->faults()) ran.faults.assign(faults->events().begin(), faults->events().end());
  return ran;
}

inline double rms(const Eigen::RowVectorXd& estimate, const Recorded& r, Index from = 0, Index to = -1) {
  const Index end = to < 0 ? r.x.size() : to;
  return std::sqrt((estimate.segment(from, end - from) - r.x.segment(from, end - from)).squaredNorm() /
                   static_cast<double>(end - from));
}

/// What least squares learns on [from, to).
inline libchar::fusion::LearntWeights learnt(const Recorded& r, const libchar::fusion::LeastSquaresForm& form,
                                             Index from, Index to) {
  libchar::fusion::WeightLearner learner(r.array.channels);
  for (Index k = from; k < to; ++k) learner.add(libchar::fusion::Sample(r.y.col(k).data(), r.y.rows()), r.x[k]);
  return learner.weights(form);
}

/// The same recording with some of its sensors only.
inline Recorded only(const Recorded& r, const std::vector<Index>& sensors) {
  Recorded part = r;
  part.y = r.y(sensors, Eigen::indexing::all);
  part.array.noise_levels = r.array.noise_levels(sensors);
  part.array.channels = static_cast<Index>(sensors.size());
  return part;
}

}  // namespace test::thesis
