// Numbers for consumers. The Gauss-Markov bias of correlation time Tc and driving density q has the Allan variance
//   q^2 Tc^2 / tau (1 - Tc/(2 tau) (3 - 4 exp(-tau/Tc) + exp(-2 tau/Tc))),
// whose maximum lies at tau = 1.8926 Tc with a deviation of 0.43654 q sqrt(Tc) = 0.61736 s, s = q
// sqrt(Tc/2) its steady state. Put on the flicker floor 0.66428 B at the middle of its flat part:
//   Tc = tau_floor / 1.8926,  s = 1.0760 B,  q = s sqrt(2 / Tc).
// A model with a Gauss-Markov process of its own needs no match; who only knows a random walk gets its driving density.

#include "libchar/export/detail/export_figures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/term_cells.hpp"

namespace libchar {
namespace {

constexpr std::array<const char*, 3> kAxisNames = {"x", "y", "z"};
constexpr double kPeakTau = 1.8926178678038266;      // of the maximum, in Tc
constexpr double kSteadyOverB = 1.0759975729152143;  // 0.6642825 / 0.6173643

struct AxisNumber {
  std::optional<double> value, limit;
  Status status = Status::not_fitted;
  bool driven = false;   // the driving density of a Gauss-Markov process is in it
  bool rounded = false;  // what rounding adds is in it, and is to be seen
};

double driving_density(const GaussMarkovNoise& process) {
  return process.sigma > 0 ? process.sigma * std::sqrt(2 / process.tau_s) : 0;
}

/// Of white noise, U·√s.
double rounding_density(const SensorModel& m) {
  return m.rate_hz > 0 ? m.resolution.value_or(0) / std::sqrt(12 * m.rate_hz) : 0;
}

AxisNumber number_of(const PlacedModel& placed, Term term, double inflate) {
  const Coefficient& c = (*placed.model)[term];
  const double factor = placed.to_si * inflate;
  AxisNumber out{std::nullopt, std::nullopt, c.status};
  // A stated 0 says that the term is absent, and bounds nothing.
  if (c.value && *c.value > 0) out.value = *c.value * factor;
  if (!c.value && c.upper95 && *c.upper95 > 0) out.limit = *c.upper95 * factor;
  if (term == Term::white) {
    // Consumers do not round: what rounding adds is in their N.
    const double rounding = rounding_density(*placed.model) * factor;
    for (std::optional<double>* level : {&out.value, &out.limit})
      if (*level) {
        const double with = std::hypot(**level, rounding);
        out.rounded |= with > 1.001 * **level;
        *level = with;
      }
  }
  const double driving = driving_density(placed.model->gauss_markov);
  // An undetermined process says no more of slow noise than the terms' limits do.
  const Status status = placed.model->gauss_markov.status;
  if (term != Term::walk || !(driving > 0) || status == Status::undetermined || status == Status::misfit) return out;
  out.value = std::hypot(out.value.value_or(0), driving * factor);
  out.driven = true;
  return out;
}

std::string said(const AxisNumber& n) {
  if (n.value)
    return shortest(rounded(*n.value, 4)) + (n.rounded ? " (with rounding)" : "") +
           (n.driven                           ? " (Gauss-Markov driving density)"
            : n.status == Status::undetermined ? " (undetermined)"
            : n.status == Status::misfit       ? " (misfit)"
                                               : "");
  if (n.limit) return "<= " + shortest(rounded(*n.limit, 3));
  return "unknown";
}

std::string absence(const AxisNumber& n) {
  return n.status == Status::not_detected ? "not detected"
         : n.status == Status::not_fitted ? "not part of the model"
                                          : "no value";
}

ExportFigure one_axis(const AxisNumber& n, Absent absent) {
  if (n.driven)
    return {
        n.value, false,
        "driving density sigma sqrt(2/tau) of the Gauss-Markov process: as a walk it holds for times well below tau"};
  if (n.value) {
    if (n.status == Status::misfit) return {n.value, false, "misfit: the noise terms do not describe the recording"};
    const bool doubtful = n.status == Status::undetermined;
    return {n.value, false,
            doubtful ? "undetermined: the record cannot tell it from another term, or contradicts it" : ""};
  }
  if (absent == Absent::zero)
    return {0.0, false, n.limit ? fmt::format("{}, {}: taken as 0", absence(n), said(n)) : absence(n) + ": taken as 0"};
  if (n.limit) return {n.limit, true, absence(n) + ": upper 95 % limit"};
  return {std::nullopt, false, absence(n)};
}

std::array<AxisNumber, 3> numbers_of(const SensorTriad& triad, Term term, double inflate) {
  std::array<AxisNumber, 3> out;
  for (std::size_t i = 0; i < 3; ++i)
    if (triad.axis[i]) out[i] = number_of(*triad.axis[i], term, inflate);
  return out;
}

std::string all_said(const std::array<AxisNumber, 3>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < 3; ++i)
    text += fmt::format("{}{} {}", i == 0 ? "" : ", ", kAxisNames[i], said(numbers[i]));
  return text;
}

double combined(const std::vector<double>& values, AxisChoice choice) {
  if (choice != AxisChoice::rms) return *std::max_element(values.begin(), values.end());
  double sum = 0;
  for (const double v : values) sum += v * v;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

double positive(const std::optional<double>& value) { return value ? *value : 0; }

// The middle of the flat part: where white noise and random walk are equal, or between the end of
// white noise and the end of the record.
double floor_tau(const SensorModel& m, double q, double b, double k, double record_s) {
  const double white_ends = q * q / (2 * std::numbers::ln2 / std::numbers::pi * b * b);  // N^2/tau = floor^2
  double tau = 0;
  if (k > 0 && q > 0)
    tau = std::numbers::sqrt3 * q / k;
  else if (record_s > white_ends && white_ends > 0)
    tau = std::sqrt(white_ends * record_s);
  else
    tau = white_ends > 0 ? 10 * white_ends : 100;
  if (m.tau_max_s > 0) tau = std::clamp(tau, std::max(m.tau_min_s, 1e-9), m.tau_max_s);
  return tau;
}

}  // namespace

std::optional<std::size_t> only_axis(const ExportOptions& options) {
  if (options.axes == AxisChoice::x) return 0;
  if (options.axes == AxisChoice::y) return 1;
  if (options.axes == AxisChoice::z) return 2;
  return std::nullopt;
}

const PlacedModel& representative(const SensorTriad& triad, const ExportOptions& options) {
  return *triad.axis[only_axis(options).value_or(0)];
}

ExportFigure scalar_figure(const SensorTriad& triad, Term term, Absent absent, const ExportOptions& options) {
  const auto only = only_axis(options);
  require_axes(triad, only);
  const auto numbers = numbers_of(triad, term, options.inflate);
  if (triad.shared || only) {
    ExportFigure figure = one_axis(numbers[only.value_or(0)], absent);
    if (only && !triad.shared)
      figure.origin = fmt::format("{} axis{}{}", kAxisNames[*only], figure.origin.empty() ? "" : "; ", figure.origin);
    return figure;
  }
  std::vector<double> values, limits;
  for (const AxisNumber& n : numbers) {
    if (n.value) values.push_back(*n.value);
    if (n.limit) limits.push_back(*n.limit);
  }
  const char* how = options.axes == AxisChoice::rms ? "root mean square" : "largest";
  if (!values.empty()) return {combined(values, options.axes), false, fmt::format("{} of {}", how, all_said(numbers))};
  if (absent == Absent::zero) return {0.0, false, fmt::format("on no axis ({}): taken as 0", all_said(numbers))};
  if (!limits.empty())
    return {combined(limits, options.axes), true,
            fmt::format("{} upper 95 % limit: not detected on any axis ({})", how, all_said(numbers))};
  return {std::nullopt, false, "unknown on every axis"};
}

std::array<ExportFigure, 3> axis_figures(const SensorTriad& triad, Term term, Absent absent,
                                         const ExportOptions& options) {
  if (options.axes != AxisChoice::automatic || triad.shared) {
    const ExportFigure one = scalar_figure(triad, term, absent, options);
    return {one, one, one};
  }
  require_axes(triad, std::nullopt);
  const auto numbers = numbers_of(triad, term, options.inflate);
  return {one_axis(numbers[0], absent), one_axis(numbers[1], absent), one_axis(numbers[2], absent)};
}

namespace {

/// A data sheet that gives a floor and no walk: what drives the Gauss-Markov bias with that floor.
std::string walk_of_floor(const SensorTriad& triad, const ExportOptions& options) {
  const PlacedModel& placed = representative(triad, options);
  if (!(placed.model->noise[static_cast<std::size_t>(Term::flicker)].value.value_or(0) > 0)) return "";
  const double driving = gauss_markov(placed, options).driving / placed.to_si / options.inflate;
  return fmt::format("; a bias with this bias_instability as its floor is driven by {} {} two-sided, {} one-sided",
                     shortest(rounded(driving, 3)),
                     term_unit(kTermNames[static_cast<std::size_t>(Term::walk)].key, placed.model->unit),
                     shortest(rounded(driving * std::sqrt(2.0), 3)));
}

}  // namespace

ExportFigure positive_figure(const SensorTriad& triad, Term term, const ExportOptions& options,
                             const std::string& consumer, const std::string& key) {
  ExportFigure figure = scalar_figure(triad, term, Absent::limit, options);
  if (figure.value) return figure;
  const TermName& name = kTermNames[static_cast<std::size_t>(term)];
  throw input_error("E0587", representative(triad, options).model->channel)
      .says("{} needs {} > 0, and the model has neither a value nor an upper limit of {}", consumer, key, name.key)
      .hint(fmt::format("state one in the model file: {}: {{value: …, unit: …, status: given}}", name.key) +
            (term == Term::walk ? walk_of_floor(triad, options) : ""));
}

namespace {

/// The process that the record itself showed. Another correlation time keeps its driving density:
/// short times stay right.
GaussMarkov own_process(const PlacedModel& placed, const ExportOptions& options) {
  const SensorModel& m = *placed.model;
  GaussMarkov out;
  out.correlation_s = options.correlation_s.value_or(m.gauss_markov.tau_s);
  out.driving = driving_density(m.gauss_markov) * placed.to_si * options.inflate;
  out.steady_sd = out.driving * std::sqrt(out.correlation_s / 2);
  out.origin = fmt::format("Gauss-Markov process of the record, sigma {}, tau {} s",
                           shortest(rounded(m.gauss_markov.sigma * placed.to_si * options.inflate, 4)),
                           shortest(rounded(m.gauss_markov.tau_s, 4)));
  if (options.correlation_s) out.origin += "; its driving density with your correlation time";
  for (const Term term : {Term::flicker, Term::walk})
    if (m[term].value.value_or(0) > 0)
      out.origin += fmt::format("; {} is left out", kTermNames[static_cast<std::size_t>(term)].key);
  return out;
}

}  // namespace

GaussMarkov gauss_markov(const PlacedModel& placed, const ExportOptions& options) {
  const SensorModel& m = *placed.model;
  if (m.gauss_markov.sigma > 0) return own_process(placed, options);
  const double q = positive(number_of(placed, Term::white, options.inflate).value);
  const double b = positive(number_of(placed, Term::flicker, options.inflate).value);
  const double k = positive(number_of(placed, Term::walk, options.inflate).value);
  const double record_s = m.tau_max_s > 0 ? m.tau_max_s : m.duration_s / 2;
  const double floor2 = 2 * std::numbers::ln2 / std::numbers::pi * b * b;
  const bool flicker = b > 0 && (k == 0 || k * k * record_s / 3 < floor2);
  GaussMarkov out;
  if (flicker) {
    const double tau = options.floor_tau_s.value_or(floor_tau(m, q, b, k, record_s));
    out.correlation_s = options.correlation_s.value_or(tau / kPeakTau);
    out.steady_sd = kSteadyOverB * b;
    out.driving = out.steady_sd * std::sqrt(2 / out.correlation_s);
    out.origin = fmt::format(
        "bias_instability {} as the maximum of a Gauss-Markov bias at tau {} s: Tc = tau/1.8926, steady state 1.076 "
        "B{}",
        shortest(rounded(b, 4)), shortest(rounded(out.correlation_s * kPeakTau, 4)),
        k > 0 ? "; random_walk is left out" : "");
    return out;
  }
  const double record = m.duration_s > 0 ? m.duration_s : m.tau_max_s;
  out.correlation_s = options.correlation_s.value_or(record > 0 ? 10 * record : 1e6);
  out.driving = k;
  out.steady_sd = k * std::sqrt(out.correlation_s / 2);
  out.origin = k > 0 ? fmt::format("random_walk with a correlation time of {}{}",
                                   options.correlation_s ? "your choice"
                                   : record > 0          ? "ten records"
                                                         : "10^6 s, because the length of the recording is not known",
                                   b > 0 ? "; bias_instability is left out" : "")
                     : "neither bias_instability nor random_walk was detected: no varying bias";
  return out;
}

GaussMarkov gauss_markov_scalar(const SensorTriad& triad, const ExportOptions& options) {
  const auto only = only_axis(options);
  require_axes(triad, only);
  GaussMarkov largest = gauss_markov(representative(triad, options), options);
  if (only || triad.shared) return largest;
  std::size_t which = 0;
  for (std::size_t i = 1; i < 3; ++i) {
    GaussMarkov other = gauss_markov(*triad.axis[i], options);
    if (other.steady_sd > largest.steady_sd) {
      largest = std::move(other);
      which = i;
    }
  }
  if (largest.driving > 0) largest.origin = fmt::format("{} axis (the largest): {}", kAxisNames[which], largest.origin);
  return largest;
}

double rate_of(const SensorTriad& triad, std::vector<std::string>& notes) {
  double rate = 0;
  bool differ = false;
  for (const auto& placed : triad.axis) {
    if (!placed) continue;
    const double own = placed->model->rate_hz;
    if (!(own > 0))
      throw input_error("E0588", placed->model->channel)
          .says("its model names no sampling rate, and the export needs one")
          .hint("write rate_hz: into the model file");
    if (rate == 0) rate = own;
    differ = differ || std::abs(own - rate) > 1e-3 * rate;
  }
  if (differ)
    notes.push_back(
        fmt::format("the axes of the {} have different rates; {} Hz is used", triad.kind, shortest(rounded(rate, 6))));
  return rate;
}

const ExportFigure& figure_of(const ImuFigures& f, std::string_view sensor, Term term) {
  const bool walk = term == Term::walk;
  if (sensor == "gyroscope") return walk ? f.gyroscope_walk : f.gyroscope_white;
  return walk ? f.accelerometer_walk : f.accelerometer_white;
}

ImuFigures imu_figures(const SensorGroup& group, const ExportOptions& options, const std::string& consumer,
                       std::vector<std::string>& notes) {
  ImuFigures out;
  const auto take = [&](const SensorTriad& triad, Term term) {
    const std::string key = fmt::format("the {}'s {}", triad.kind, kTermNames[static_cast<std::size_t>(term)].key);
    ExportFigure figure = positive_figure(triad, term, options, consumer, key);
    if (figure.limit)
      notes.push_back(
          fmt::format("{} was not detected; its upper 95 % limit {} is written, because {} needs a number > 0", key,
                      shortest(rounded(*figure.value, 3)), consumer));
    return figure;
  };
  out.gyroscope_white = take(*group.gyroscope, Term::white);
  out.gyroscope_walk = take(*group.gyroscope, Term::walk);
  out.accelerometer_white = take(*group.accelerometer, Term::white);
  out.accelerometer_walk = take(*group.accelerometer, Term::walk);
  out.gyroscope_rate_hz = rate_of(*group.gyroscope, notes);
  out.accelerometer_rate_hz = rate_of(*group.accelerometer, notes);
  if (std::abs(out.gyroscope_rate_hz - out.accelerometer_rate_hz) > 1e-3 * out.gyroscope_rate_hz)
    notes.push_back(
        fmt::format("gyroscope ({} Hz) and accelerometer ({} Hz) have different rates; the file names the first",
                    shortest(rounded(out.gyroscope_rate_hz, 6)), shortest(rounded(out.accelerometer_rate_hz, 6))));
  return out;
}

}  // namespace libchar
