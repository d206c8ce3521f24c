#pragma once
// From models to the numbers that consumers ask for: SI units, one axis out of three, what stands
// for a term that was not found, and a Gauss-Markov process for flicker.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/export/exports.hpp"

namespace libchar {

/// What is written for a term without a value.
enum class Absent {
  limit,  ///< its upper 95 % limit: the consumer divides by the number or refuses 0
  zero,   ///< 0: a simulator that leaves the term out is right
};

/// One number in SI units, inflated, and what has to be said about it.
struct ExportFigure {
  std::optional<double> value;  ///< nothing: neither a value nor (where asked for) a limit is known
  bool limit = false;           ///< an upper limit, not a value
  std::string origin;           ///< "largest of x 1.7e-4, y 1.6e-4, z <= 2e-4", "upper 95 % limit"…
};

/// The term on every axis; one shared model gives the same three times. Any explicit choice of axes
/// (max, rms, x…) gives its one number three times.
std::array<ExportFigure, 3> axis_figures(const SensorTriad& triad, Term term, Absent absent,
                                         const ExportOptions& options);

/// The one number for a consumer that takes one for all axes: the largest unless options say
/// otherwise. Values go before limits: a limit only stands where no axis has a value.
ExportFigure scalar_figure(const SensorTriad& triad, Term term, Absent absent, const ExportOptions& options);

/// As `scalar_figure` with a limit for what is absent, and Error(input) when there is none, naming
/// `consumer` and its `key`.
ExportFigure positive_figure(const SensorTriad& triad, Term term, const ExportOptions& options,
                             const std::string& consumer, const std::string& key);

/// A first-order Gauss-Markov (Ornstein-Uhlenbeck) bias: db = -b/Tc dt + q dW.
struct GaussMarkov {
  double correlation_s = 1;
  double driving = 0;    ///< q, U/s/√Hz; 0 when there is neither flicker nor walk
  double steady_sd = 0;  ///< q √(Tc/2), U
  std::string origin;    ///< how it was found
};

/// The process that stands for the bias of one axis: matched to the floor of flicker where flicker
/// is what the record ends in, else a random walk with a correlation time of ten records.
GaussMarkov gauss_markov(const PlacedModel& placed, const ExportOptions& options);

/// The same for the axis with the largest steady state (or the chosen one).
GaussMarkov gauss_markov_scalar(const SensorTriad& triad, const ExportOptions& options);

/// Sampling rate of a triad. Throws Error(input) when unknown; a note is added when axes differ.
double rate_of(const SensorTriad& triad, std::vector<std::string>& notes);

/// The axis that options single out, 0…2.
std::optional<std::size_t> only_axis(const ExportOptions& options);

/// An axis that the export uses: the singled out one, else x.
const PlacedModel& representative(const SensorTriad& triad, const ExportOptions& options);

/// The four numbers of most visual-inertial programs, all > 0.
struct ImuFigures {
  ExportFigure gyroscope_white, gyroscope_walk, accelerometer_white, accelerometer_walk;
  double gyroscope_rate_hz = 0, accelerometer_rate_hz = 0;
};
/// The figure of "gyroscope" or "accelerometer", white noise or random walk.
const ExportFigure& figure_of(const ImuFigures& figures, std::string_view sensor, Term term);

/// Notes on limits and rates go to `notes`. Throws as `positive_figure` and `rate_of`.
ImuFigures imu_figures(const SensorGroup& group, const ExportOptions& options, const std::string& consumer,
                       std::vector<std::string>& notes);

}  // namespace libchar
