#pragma once
// bench.json: what a run of benchmarks writes, and what a later run is held against.

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "libchar/benchmark/turns.hpp"
#include "libchar/core/document/enum_table.hpp"
#include "libchar/core/document/fields.hpp"
#include "libchar/core/noise_terms.hpp"
#include "libchar/core/process/progress.hpp"
#include "libchar/core/process/work.hpp"
#include "libchar/core/table/table.hpp"
#include "libchar/log/read.hpp"
#include "libchar/model/sensor_model.hpp"
#include "libchar/replay/replay.hpp"
#include "libchar/scene/scene.hpp"

namespace libchar {
// Every way to get noise coefficients from a record, on simulated records whose coefficients are
// known: error over what is possible at all, coverage of stated intervals, time and memory.

/// What the records are simulated from.
struct BenchSignal {
  std::string name;
  SensorModel model;  ///< its noise and its resolution; scale factor, bias and faults are left out
  double rate_hz = 0;
  std::uint64_t samples = 0;
};

/// Built in: the regimes that records are in, each with so many samples.
std::vector<BenchSignal> bench_signals(std::uint64_t samples);

struct CharacterizationBenchOptions {
  std::size_t records = 40;
  std::uint64_t seed = 1;
  std::vector<std::string> methods;  ///< empty: all
};

/// How well a method gets one coefficient that is in the records.
struct TermAccuracy {
  Term term = Term::white;
  double truth = 0;
  double bound = 0;  ///< Cramer-Rao: the least standard deviation that an unbiased method can have
  Figure error;      ///< RMSE over that bound; not detected counts as zero
  Figure coverage;   ///< of the stated 95 % intervals; no count: it states none
  double bias = 0;   ///< mean error over the bound
};

struct EstimatorAccuracy {
  std::string name, what;
  bool is_ours = true;
  bool told = false;  ///< which terms are in the records
  std::vector<TermAccuracy> terms;
  /// geometric mean of RMSE over bound, of the terms that a record can tell: whose bound is below half of them
  double error = 0;
  /// records in which it states a coefficient that is not in them; no count: it was given the terms, or all exist
  Figure false_terms;
  Figure ns_per_sample;
  Figure time_ratio;  ///< over the first method's on the same record: what load falls on alike is not in it
  std::optional<double> bytes_per_sample;  ///< of heap apart from the record
  /// detail/records.cpp; methods given the terms do not count against the others
  double front_gap = 0;
};

struct CharacterizationBench {
  BenchSignal signal;
  std::uint64_t seed = 1;
  std::uint64_t records = 0;
  std::vector<EstimatorAccuracy> methods;
  std::vector<std::string> notes;
};

/// Records are simulated one after the other, and each is given to every method in turn. Throws Error(usage) for a
/// method that is not known, Error(input) for a model without white noise, flicker or walk.
CharacterizationBench bench_characterization(const BenchSignal& signal, const CharacterizationBenchOptions& options,
                                             Progress& progress = no_progress(), HeapMeter* heap = nullptr);

// Fusion algorithms on scenes, with seeds and options varied: error against time and memory, with
// intervals on both, scene by scene and over all of them.

/// Built in: the scenes of the source and one of two true inputs.
std::vector<Scene> bench_scenes();

struct FusionBenchOptions {
  std::size_t seeds = 10;               ///< runs of a simulated scene; a recording runs as often for its times
  std::uint64_t seed = 1;               ///< of the first run
  std::vector<std::string> algorithms;  ///< empty: the scene's, else all
  std::vector<Sweep> sweeps;
};

/// One algorithm in one scene.
struct FusionBenchCell {
  bool ran = false;
  std::string why;              ///< it did not, a sentence
  Figure excess;                ///< RMSE over that of the scene's yardstick, minus one
  Figure ns_per_sample;         ///< of an instant
  double learning_s = 0;        ///< median
  std::optional<double> bytes;  ///< of heap, at most
  double front_gap = 0;         ///< of 1 + excess in this scene (detail/records.cpp)
};

struct FusionBenchRow {
  std::string label, name;
  bool swept = false;                  ///< one of the options that `sweeps` asked for
  bool bound = false;                  ///< it looked at the reference of the run itself: no method
  std::vector<FusionBenchCell> cells;  ///< one per scene
  /// geometric mean over the scenes that are pooled of RMSE over yardstick, minus one; no count: it did not run in each
  Figure excess;
  Figure ns_per_sample;  ///< geometric mean over the same
  double front_gap = 0;  ///< of 1 + excess (detail/records.cpp); NaN: takes no part
};

struct FusionBenchScene {
  std::string name, file;
  std::string yardstick;  ///< "optimal fixed weights", or "best of the methods" without a reference
  std::uint64_t instants = 0;
  std::uint64_t sensors = 0, inputs = 0;
  bool simulated = false;
  std::uint64_t runs = 0;
  bool pooled = false;  ///< one of the most frequent kind: this number of true inputs, or a tilt
};

/// A scene that feeds none of the algorithms asked for.
struct FusionBenchLeftOut {
  std::string name, file, why;
};

struct FusionBench {
  std::uint64_t seed = 1;
  std::vector<FusionBenchScene> scenes;
  std::vector<FusionBenchLeftOut> left_out;
  std::vector<FusionBenchRow> rows;  ///< best first over the scenes, then by name
};

/// Throws what `replay` throws; that no algorithm can run on a scene (E0905), only where none can on any.
FusionBench bench_fusion(const std::vector<Scene>& scenes, const FusionBenchOptions& options,
                         Progress& progress = no_progress(), HeapMeter* heap = nullptr);

// How cost grows: with the length of a record, the number of sensors, true inputs, threads. Fitted
// exponents, and where a method stops keeping up with its sensors.

struct ScalingBenchOptions {
  bool quick = false;
  std::uint64_t seed = 1;
  std::size_t rounds = 7;  ///< each point is timed so often, in turns
  double rate_hz = 1000;   ///< of the instants, for `keeps_up_to`
};

struct ScalingPoint {
  double x = 0;
  Figure cost;                  ///< in the unit of the series
  std::optional<double> bytes;  ///< of heap, at most
};

struct ScalingSeries {
  std::string name;
  std::string over;  ///< "samples", "sensors", "inputs", "threads"
  std::string unit;  ///< "ms", "ns per instant"
  std::vector<ScalingPoint> points;
  /// p of cost ~ x^p over the last three octaves; no count: too few points
  Figure exponent;
  /// of instants over sensors: the most sensors that one processor keeps up with at `rate_hz`,
  /// interpolated; extrapolated by the exponent, at most to a million
  std::optional<double> keeps_up_to;
};

struct ScalingBench {
  double rate_hz = 0;
  std::vector<ScalingSeries> series;
};

ScalingBench bench_scaling(const ScalingBenchOptions& options, Progress& progress = no_progress(),
                           HeapMeter* heap = nullptr);

/// p of cost ~ x^p by least squares on the logarithms of the points whose x is at least an eighth
/// of the largest, with Student's interval.
Figure growth_exponent(const std::vector<ScalingPoint>& points);

// Questions before buying and before recording: how many sensors of a kind reach an error, and how
// long a record must be to know a coefficient. From the bounds, checked by simulation.

struct DesignOptions {
  /// of the Allan deviation at `tau_s` of the fused sensors, in the models' unit; none: that question is not asked
  std::optional<double> target;
  double tau_s = 1;
  double share = 0.1;        ///< a coefficient is known to this share of it (one standard deviation)
  std::size_t records = 40;  ///< of each check
  std::uint64_t seed = 1;
  double most_samples = 4e6;  ///< of one simulated record over all its sensors; what needs more is not checked
};

/// Equal sensors whose weighted mean reaches the target.
struct SensorsNeeded {
  std::string model;
  double single = 0;  ///< Allan deviation of one at tau
  std::uint64_t sensors = 0;
  double predicted = 0;  ///< of this many records
  Figure simulated;      ///< of this many records, root mean square over the records; no count: not checked
};

/// A record from which a method can know a coefficient so well.
struct RecordNeeded {
  std::string model;
  Term term = Term::white;
  std::optional<double> seconds;  ///< none: no record is long enough
  double samples = 0;
  Figure simulated;  ///< relative RMSE of the likelihood, terms given; no count: not checked
};

struct DesignBench {
  DesignOptions options;
  std::vector<SensorsNeeded> sensors;
  /// all of the given models together, one of each, weighted: its deviation; none: fewer than two, or no target
  std::optional<double> one_of_each;
  std::vector<RecordNeeded> records;
};

/// Throws Error(usage) for an averaging time below a sample's, or models of several units or rates
/// where a target is asked for.
DesignBench bench_design(const std::vector<BenchSignal>& models, const DesignOptions& options,
                         Progress& progress = no_progress());

// Hard inputs through every estimator, simulator and fusion algorithm: how many digits are right,
// what is refused in a sentence, and what is neither.

struct StressBenchOptions {
  bool quick = false;  ///< without the records of 10⁸ samples
  std::uint64_t seed = 1;
};

enum class StressOutcome {
  digits,   ///< compared with a reference: exact, or of an input that must give the same
  held,     ///< no reference: finite, in the range of what came in, no negative variance
  refused,  ///< in a sentence
  wrong     ///< fewer digits than stated, or not held
};

template <>
inline constexpr auto enum_table<StressOutcome> = enum_words<StressOutcome, "digits held refused wrong">;

/// One subject on one input.
struct StressCell {
  std::string subject, input;
  StressOutcome outcome = StressOutcome::held;
  /// right decimal digits of the worst number, at most 16
  double digits = std::numeric_limits<double>::quiet_NaN();
  /// at least so many are stated; NaN: none, a method as published
  double stated = std::numeric_limits<double>::quiet_NaN();
  std::string what;  ///< the refusal, or what is wrong
};

struct StressBench {
  std::uint64_t seed = 1;
  std::vector<StressCell> cells;  ///< worst first: wrong, then by digits beyond the stated ones
  std::size_t count(StressOutcome outcome) const;
};

StressBench bench_stress(const StressBenchOptions& options, Progress& progress = no_progress());

/// All that a run of benchmarks found.
struct BenchReport {
  std::vector<std::string> command;  ///< as typed; set by the caller
  bool quick = false;
  std::uint64_t seed = 1;
  Machine machine;
  std::vector<CharacterizationBench> characterization;
  std::optional<FusionBench> fusion;
  std::optional<ScalingBench> scaling;
  std::optional<DesignBench> design;
  std::optional<StressBench> stress;
};

const Fields<BenchReport>& bench_fields();

/// Throws Error(input) for another document, with its place where something in it is wrong.
BenchReport parse_bench_report(std::string_view text, const std::string& path);

// What a user wants benchmarks of: models, scenes, logs.

struct BenchInputs {
  std::vector<BenchSignal> signals;
  std::vector<Scene> scenes;
  Findings warnings;
};

struct BenchInputOptions {
  ReadOptions reading;                  ///< of logs
  std::uint64_t most_samples = 200000;  ///< of a simulated record
  std::size_t most_channels = 3;        ///< of a log: those with the most noise terms
};

/// A scene file: its scene. A model file: a signal. A log: it is characterized, and each channel's model is a signal,
/// as long as the log (at most `most_samples`). Throws what reading and characterizing throw; Error(input) for a log or
/// model with no noise to simulate, or a model without a rate.
void add_bench_input(const std::string& path, const BenchInputOptions& options, BenchInputs& inputs,
                     Progress& progress = no_progress());

// A run of benchmarks as its reports show it: sections with sentences, a table and a chart.
// Terminal, Markdown and page only print it.

struct BenchPoint {
  std::string name;
  double x = 0, y = 0;
  Interval x95, y95;      ///< infinite: not known
  bool on_front = false;  ///< nobody is better in both
  bool is_ours = true;
  bool told = false;  ///< has a front of its own: it knows what the others have to find out
};

struct BenchChart {
  std::string x, y;  ///< names of the axes
  std::vector<BenchPoint> points;
};

struct BenchSection {
  std::string title;
  std::vector<std::string> sentences;
  Table table;                     ///< without columns: none
  std::vector<std::string> notes;  ///< below the table
  std::vector<BenchChart> charts;  ///< none or one
};

std::vector<BenchSection> bench_view(const BenchReport& report);

namespace detail {
/// A sentence a part: who is best.
std::vector<std::string> bench_verdict(const BenchReport& report);
}  // namespace detail

/// "12.3 [11.9, 12.8]", without limits where they are not known, "–" where it was not measured.
std::string figure_text(const Figure& figure, int digits = 3, double factor = 1);

}  // namespace libchar
