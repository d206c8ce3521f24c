#pragma once
// What a replay learnt of an array and of the algorithms that fuse it: fusion.yaml, which `fuse` applies
// to a log (docs/fuse.md). Numbers read back to the same doubles.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "libchar/core/document/fields.hpp"
#include "libchar/core/finding.hpp"
#include "libchar/fusion/learnt.hpp"
#include "libchar/replay/common_errors.hpp"
#include "libchar/scene/scene.hpp"

namespace libchar {

/// What is taken out of a sensor, in units of the input (fusion/alignment.hpp).
struct LearntAlignment {
  double delay_samples = 0;  ///< at the rate it was learnt at
  double bias = 0, gain = 0;
  std::vector<double> cross;  ///< of each further axis; empty: none
  /// Of the sensor and its further axes: samples / h at or beyond are saturated; kNoLimit: none, and
  /// empty: none at all.
  std::vector<double> low, high;
};
inline constexpr double kNoLimit = 1e300;

struct LearntSensor {
  /// What it read relative to the median u of all, y - u = offset + gain u, and by how much blocks usually differ from
  /// that (detail/plan/reading_meter.hpp).
  struct Reading {
    double offset = 0, gain = 0;
    double usual_mean = 0, usual_rms = 0;
  };

  std::string name, channel;
  std::string recorded_unit;  ///< of the channel, as recorded
  std::string unit;           ///< of the samples after `scale`; empty: not stated
  double scale = 1;
  std::vector<double> h = {1};
  double offset = 0;                     ///< subtracted from the scaled samples
  std::optional<double> noise_variance;  ///< of a sample, as given to algorithms
  std::optional<double> flicker, walk;   ///< of its noise model; both or none
  std::vector<double> gauss_markov_sigma, gauss_markov_tau_s;
  std::vector<std::string> cross;  ///< channels of the device's further axes
  LearntAlignment alignment;
  /// Deviation of its noise from sample to sample, in units of the input, and the standard error of the
  /// logarithm of its square (detail/step_noise.hpp).
  std::optional<double> step_noise, step_noise_error;
  std::optional<Reading> reading;
  bool left_out = false;  ///< it had no samples: algorithms were not given it
};

struct LearntInput : detail::CommonErrors {
  std::string name, unit;
  std::optional<double> reference_offset;  ///< subtracted from the reference: it is not in the estimates
};

struct LearntAlgorithm {
  /// While all sensors read as they usually do (detail/sensor_doubt.hpp).
  struct Usual {
    double distance = 0;  ///< RMS, of the estimates from the mean of the sensors by their usual scatter
    double sd = 0;        ///< standard deviation: what it is in the better quarter; 0: not known
  };
  std::string label, name;
  std::vector<std::pair<std::string, double>> options;  ///< all of them, as used
  fusion::Learnt learnt;
  std::vector<double> sd_factor;  ///< of each input: times the stated deviation it covered 95 % of the replay
  std::vector<double> sd;         ///< of one that states none: RMS error of each input in the replay
  std::optional<Usual> usual;     ///< of one input that all sensors see alike
  std::string refused;            ///< why it cannot be applied, a sentence; empty: it can
  int line = 0, column = 0;       ///< in the file it was read from
};

struct LearntTilt {
  std::string gyroscope, accelerometer_x, accelerometer_z;  ///< names of sensors
};

/// A file that it was learnt from.
struct LearntFrom {
  std::string path, sha256;
};

struct LearntFusion {
  std::string file, sha256;  ///< it was read from; empty: from none
  std::string name;          ///< of the scene
  std::vector<LearntFrom> learnt_from;
  double rate_hz = 0;                 ///< of the instants that were fused
  std::optional<double> average_s;    ///< an instant is the mean over this time
  std::optional<double> resample_hz;  ///< samples are interpolated to this rate by their stamps
  ScenePreparation preparation;       ///< what every sensor goes through first
  std::uint64_t learning_instants = 0;
  double fault_free_s = 0;  ///< time at the start in which no sensor failed of the run
  std::vector<LearntInput> inputs;
  std::vector<LearntSensor> sensors;
  LearntTilt tilt;                ///< gyroscope empty: no tilt
  std::string interpolation;      ///< of the alignment: sinc, cubic; empty: nothing is aligned
  std::string recommended;        ///< label; empty: none
  std::vector<Finding> findings;  ///< of the recording and its sensors, from which it was learnt
  std::vector<LearntAlgorithm> algorithms;

  const LearntAlgorithm* find(std::string_view label) const;
  std::vector<std::string> labels() const;
};

/// More numbers of one algorithm than this are not written.
inline constexpr std::size_t kMostLearnt = 100000;

const Fields<LearntFusion>& fusion_fields();
const Fields<LearntSensor>& fusion_sensor_fields();
const Fields<LearntAlgorithm>& fusion_algorithm_fields();

/// The file.
std::string fusion_yaml(const LearntFusion& learnt);

/// Reads it; of a folder, the fusion.yaml in it. Throws Error(input) with file, line, column and key.
LearntFusion read_fusion_file(const std::string& path);

/// The same from text that stands for a file at `path`.
LearntFusion parse_fusion_file(std::string_view text, const std::string& path);

}  // namespace libchar
