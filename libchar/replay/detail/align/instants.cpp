// Truth of an instant at time t:   reference(t - lag)
//   reference in the recording, no lag   its own sample
//   in memory (own log, or a lag)        linear between its samples
//   own log, less than half as fast      one instant an interval [t_j, t_j + T) of the reference:
//                                        the sensors' mean over it (at least half of its samples
//                                        present) against its value
// Then, of sensors and truth alike: a trend subtracted, one filter.
#include "libchar/replay/detail/align/instants.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/core/refusal.hpp"
#include "libchar/core/text/decimal.hpp"
#include "libchar/core/text/readable.hpp"
#include "libchar/core/text/shown.hpp"
#include "libchar/core/units.hpp"
#include "libchar/replay/detail/align/reference_track.hpp"
#include "libchar/replay/detail/plan/common_unit.hpp"

namespace libchar {
namespace {

// A boundary within this share of a sample belongs to the sample: times are decimal, grids binary.
constexpr double kOnGrid = 1e-6;

double to_si(const std::string& unit, Quantity quantity) {
  const auto known = find_unit(unit);
  return known && known->quantity == quantity ? known->to_si : 1;
}

// Another scale is another unit; where none is stated, the scale is said.
std::string unit_after_scale(const SceneSensor& sensor, const std::string& recorded) {
  if (!sensor.unit.empty()) return sensor.unit;
  if (std::abs(sensor.scale) == 1 || recorded.empty()) return recorded;
  return fmt::format("{} (× {})", recorded, shortest(sensor.scale));
}

}  // namespace

// Fills blocks of equal size whatever the source delivers.
class Instants::Columns {
 public:
  Columns(const Instants& instants, std::int64_t from, std::int64_t to, std::size_t size, const InstantsBlock& out)
      : instants_(instants),
        prepared_(instants.preparation_, instants.rows_ + (instants.info_.has_reference ? instants.inputs_ : 0)),
        from_(from),
        to_(to),
        // A filter remembers all that was before.
        first_(instants.preparation_.filter ? std::min<std::int64_t>(0, from) : from),
        out_(out),
        samples_(instants.rows_, size),
        truth_(instants.info_.has_reference ? instants.inputs_ : 0, size) {
    if (instants.info_.averaged > 1) {
      sums_.assign(instants.rows_, 0);
      counts_.assign(instants.rows_, 0);
    }
  }

  void take(std::uint64_t first, std::span<const std::span<const double>> columns) {
    const std::size_t rows = columns[0].size();
    for (std::size_t k = 0; k < rows; ++k) {
      const auto sample = static_cast<std::int64_t>(first + k);
      if (instants_.info_.averaged > 1)
        average(sample, columns, k);
      else if (sample >= first_ && sample < to_)
        put(sample, columns, k);
    }
  }
  void finish() {
    if (instants_.info_.averaged > 1) close_interval();
    flush();
  }

 private:
  // The reference's columns stand between the sensors and their further axes.
  std::size_t column(std::size_t row) const {
    const std::size_t n = instants_.sensors_;
    return row < n ? row : row + instants_.source_.info().reference_units.size();
  }

  double value(std::size_t row, double y) const {
    const std::size_t n = instants_.sensors_;
    if (n > 0 && row >= n) return y * instants_.scene_->sensors[row % n].scale;
    return (y * instants_.factors_[row]) - (instants_.preparation_.filter ? 0 : offset(row));
  }
  double offset(std::size_t row) const { return row < instants_.sensors_ ? instants_.offsets_[row] : 0; }

  void put(std::int64_t sample, std::span<const std::span<const double>> columns, std::size_t k) {
    for (std::size_t i = 0; i < instants_.rows_; ++i)
      samples_(static_cast<Eigen::Index>(i), filled_) = value(i, columns[column(i)][k]);
    if (truth_.rows() > 0) {
      if (instants_.track_)
        truth_from_track(static_cast<double>(sample) / instants_.source_.info().rate_hz);
      else
        truth_of([&](std::size_t c) { return columns[instants_.sensors_ + c][k]; });
    }
    next(sample);
  }

  // The interval of the reference that a sample falls into.
  void average(std::int64_t sample, std::span<const std::span<const double>> columns, std::size_t k) {
    const double t = static_cast<double>(sample) / instants_.source_.info().rate_hz;
    const auto instant =
        clamped_whole<std::int64_t>(std::floor((t - instants_.info_.start_s) * instants_.info_.rate_hz + kOnGrid));
    if (instant != interval_) {
      close_interval();
      interval_ = instant;
    }
    ++seen_;
    for (std::size_t i = 0; i < instants_.rows_; ++i)
      if (const double y = columns[column(i)][k]; std::isfinite(y)) {
        sums_[i] += value(i, y);
        ++counts_[i];
      }
  }

  void close_interval() {
    if (seen_ > 0 && interval_ >= first_ && interval_ < to_) {
      for (std::size_t i = 0; i < instants_.rows_; ++i)
        samples_(static_cast<Eigen::Index>(i), filled_) =
            2 * counts_[i] >= instants_.info_.averaged ? sums_[i] / static_cast<double>(counts_[i]) : kMissing;
      // The middle of the interval is unambiguous whatever its ends round to.
      const double middle = instants_.info_.start_s + (static_cast<double>(interval_) + 0.5) / instants_.info_.rate_hz;
      const double place = (middle - instants_.lag_s_ - instants_.track_->start_s) * instants_.track_->rate_hz;
      const auto j = static_cast<std::size_t>(std::max(0.0, std::floor(place)));
      truth_of([&](std::size_t c) {
        const auto& track = instants_.track_->values[c];
        return j < track.size() ? track[j] : kMissing;
      });
      next(interval_);
    }
    seen_ = 0;
    std::fill(sums_.begin(), sums_.end(), 0.0);
    std::fill(counts_.begin(), counts_.end(), std::size_t{0});
  }

  // Of a slow reference with values at its stamps only the instants nearest to them have a truth.
  void truth_from_track(double t) {
    const ReferenceTrack& track = *instants_.track_;
    if (instants_.info_.slow_samples) {
      const double place = (t - instants_.lag_s_ - track.start_s) * track.rate_hz;
      const double off_s = std::abs(place - std::round(place)) / track.rate_hz;
      const bool nearest = off_s * instants_.source_.info().rate_hz <= 0.5 + kOnGrid;
      return truth_of([&](std::size_t c) { return nearest ? track.curved(c, t - instants_.lag_s_) : kMissing; });
    }
    truth_of([&](std::size_t c) { return instants_.track_->at(c, t - instants_.lag_s_); });
  }

  template <class Reference>
  void truth_of(const Reference& reference) {
    if (truth_.rows() == 0) return;
    if (instants_.scene_->reference->mean) {
      double sum = 0;
      const std::size_t n = instants_.scene_->reference->channels.size();
      for (std::size_t c = 0; c < n; ++c) sum += reference(c);
      truth_(0, filled_) = instants_.truth_factor_ * sum / static_cast<double>(n) - instants_.reference_offset_;
    } else {
      for (std::size_t c = 0; c < instants_.inputs_; ++c)
        truth_(static_cast<Eigen::Index>(c), filled_) =
            instants_.truth_factor_ * reference(c) - instants_.reference_offset_;
    }
  }

  // The column is complete: what all rows go through, and on to the next one.
  void next(std::int64_t instant) {
    if (!instants_.preparation_.idle()) prepare(instant);
    if (instant >= from_ && ++filled_ == samples_.cols()) flush();
  }

  void prepare(std::int64_t instant) {
    for (Eigen::Index i = 0; i < samples_.rows(); ++i) {
      const auto row = static_cast<std::size_t>(i);
      double& y = samples_(i, filled_);
      y = prepared_(row, instant, y);
      if (instants_.preparation_.filter) y -= offset(row);
    }
    for (Eigen::Index j = 0; j < truth_.rows(); ++j)
      truth_(j, filled_) = prepared_(static_cast<std::size_t>(samples_.rows() + j), instant, truth_(j, filled_));
  }

  void flush() {
    if (filled_ == 0) return;
    if (filled_ == samples_.cols()) {
      out_({from_ + done_, samples_, truth_});
    } else {
      out_({from_ + done_, samples_.leftCols(filled_), truth_.leftCols(filled_)});
    }
    done_ += filled_;
    filled_ = 0;
  }

  const Instants& instants_;
  Prepared prepared_;
  std::int64_t from_, to_, first_, done_ = 0, interval_ = -1;
  const InstantsBlock& out_;
  Eigen::MatrixXd samples_, truth_;
  Eigen::Index filled_ = 0;
  std::vector<double> sums_;
  std::vector<std::size_t> counts_;
  std::size_t seen_ = 0;
};

Instants::Instants(const Scene& scene, Progress& progress, OfCopies copies)
    : scene_(&scene),
      source_(scene, progress, copies),
      offsets_(scene.sensors.size(), 0.0),
      factors_(scene.sensors.size(), 1.0),
      sensors_(scene.sensors.size()) {
  const SourceInfo& source = source_.info();
  rows_ = sensors_ * (1 + source.further_axes);
  info_.rate_hz = source.rate_hz;
  info_.count = static_cast<std::int64_t>(source.samples);
  for (std::size_t i = 0; i < scene.sensors.size(); ++i)
    info_.units.push_back(unit_after_scale(scene.sensors[i], source.units[i]));
  info_.logs = source.logs;
  info_.has_reference = scene.reference.has_value();
  std::vector<std::string> reference_units = source.reference_units;
  if (info_.has_reference) {
    info_.reference_use = "each instant";
    if (scene.reference->recording) {
      track_ = read_reference(scene, source_, progress);
      info_.logs.push_back(track_->log);
      reference_units = track_->units;
      info_.reference_use = "interpolated between its own samples";
      const double start_s = track_->start_s + scene.reference->lag_s;
      const double length_s = static_cast<double>(info_.count) / info_.rate_hz;
      const double covers_s = static_cast<double>(track_->values[0].size()) / track_->rate_hz;
      if (!scene.reference->estimate_lag && (start_s > length_s || start_s + covers_s < 0)) refuse_apart(length_s);
      info_.slow_reference = track_->rate_hz < 0.5 * source.rate_hz;
    }
    const std::size_t inputs = scene.reference->mean ? 1 : scene.reference->channels.size();
    for (std::size_t j = 0; j < inputs; ++j) {
      info_.input_names.push_back(scene.reference->mean ? "mean of the reference" : scene.reference->channels[j]);
      info_.input_units.push_back(reference_units[j]);
    }
  } else {
    const std::size_t inputs = scene.tilt ? 1 : scene.sensors[0].h.size();
    for (std::size_t j = 0; j < inputs; ++j) {
      info_.input_names.push_back(inputs == 1 ? "input" : fmt::format("input{}", j + 1));
      info_.input_units.push_back(inputs == 1 ? info_.units[0] : "");
    }
  }
  inputs_ = info_.input_names.size();
  factors_ = to_common_unit(scene, reference_units, info_.units);
  if (info_.slow_reference) read_slow_reference(progress);
  if (scene.tilt) convert_tilt();
  if (scene.reference) reference_offset_ = scene.reference->offset * truth_factor_;
  if (scene.reference && scene.reference->lag_s != 0 && !info_.slow_reference)
    set_lag(scene.reference->lag_s, progress);
  prepare(progress);
}

// Trends are those of the whole recording: one reading more.
void Instants::prepare(Progress& progress) {
  const ScenePreparation& asked = scene_->preparation;
  preparation_ = {};
  if (asked.detrend != "none") {
    constexpr std::size_t kTrendBlock = 4096;
    TrendMeter meter;
    Eigen::MatrixXd rows;
    pass_recorded(0, info_.count, kTrendBlock, progress, [&](const InstantBlock& b) {
      rows.resize(b.samples.rows() + b.truth.rows(), b.samples.cols());
      rows << b.samples, b.truth;
      meter.push(b.first, rows);
    });
    preparation_.trends = meter.lines(asked.detrend == "line");
  }
  if (!asked.filters()) return;
  const double most_hz = info_.rate_hz / 2, highest_hz = std::max(asked.from_hz, asked.to_hz);
  if (highest_hz >= most_hz)
    throw input_error("E0912", scene_->file)
        .says("{}: instants at {} have nothing above {}", asked.to_hz > 0 ? "`band_hz`" : "`high_pass_hz`",
              detail::frequency_text(info_.rate_hz, 6), detail::frequency_text(most_hz, 6))
        .got(brief_text(highest_hz, 6))
        .hint("corners are below half the rate");
  preparation_.filter = band_filter(asked.from_hz, asked.to_hz, info_.rate_hz);
}

// What all sensors say together: the median of how far each is from its first sample.
std::vector<double> Instants::common_level(Progress& progress) const {
  std::vector<double> out, firsts(sensors_, kMissing), off;
  out.reserve(static_cast<std::size_t>(source_.info().samples));
  source_.stream(
      source_.info().samples,
      [&](std::uint64_t, std::span<const std::span<const double>> columns) {
        for (std::size_t k = 0; k < columns[0].size(); ++k) {
          off.clear();
          for (std::size_t i = 0; i < sensors_; ++i) {
            const double y = columns[i][k] * factors_[i];
            if (!std::isfinite(y)) continue;
            if (std::isnan(firsts[i])) firsts[i] = y;
            off.push_back(y - firsts[i]);
          }
          out.push_back(2 * off.size() > sensors_ ? median_in_place(off) : kMissing);
        }
      },
      progress);
  return out;
}

// A mean over intervals of the reference where its values are means; its own instants where they are samples.
void Instants::read_slow_reference(Progress& progress) {
  const SceneReference& reference = *scene_->reference;
  const bool one = !scene_->tilt && (reference.mean || reference.channels.size() == 1);
  SlowQuestion question{reference.samples, reference.lag_s, reference.estimate_lag && one};
  if (!one && question.samples == "estimate") question.samples = SceneReference::kReadings[0];
  SlowReading reading{question.samples, question.lag_s, 0};
  if (question.samples == "estimate" || question.estimate_lag) {
    std::vector<double> values(track_->values[0].size(), 0.0);
    for (const std::vector<double>& channel : track_->values)
      for (std::size_t j = 0; j < values.size(); ++j) values[j] += channel[j];
    const std::vector<double> level = common_level(progress);
    reading = read_slowly(question, level, source_.info().rate_hz, *track_, values);
  }
  lag_s_ = reading.lag_s;
  info_.slow_samples = reading.samples == "instant";
  if (info_.slow_samples)
    info_.reference_use = fmt::format("at its own stamps, every {}", duration_text(1 / track_->rate_hz, 6));
  else
    take_means_over_intervals(track_->start_s + interval_start(reading.samples) / track_->rate_hz);
  if (reading.margin > 0)
    info_.reference_use +=
        fmt::format(" (the sensors show that its values are {}; log-likelihood {} above the next reading)",
                    info_.slow_samples ? "samples" : reading.samples, brief_text(reading.margin, 3));
}

// One instant for each interval of the reference that lies within the recording; `start_s`: of its first.
void Instants::take_means_over_intervals(double start_s) {
  track_->start_s = start_s;
  const double interval_s = 1 / track_->rate_hz;
  const double length_s = static_cast<double>(info_.count) / info_.rate_hz;
  info_.averaged = clamped_whole<std::size_t>(std::round(info_.rate_hz * interval_s));
  const double first = std::ceil(-(track_->start_s + lag_s_) * track_->rate_hz - kOnGrid);
  info_.start_s = track_->start_s + lag_s_ + std::max(0.0, first) * interval_s;
  const double last = std::min(static_cast<double>(track_->values[0].size()) - std::max(0.0, first),
                               std::floor((length_s - info_.start_s) * track_->rate_hz + kOnGrid));
  info_.count = static_cast<std::int64_t>(std::max(0.0, last));
  info_.rate_hz = track_->rate_hz;
  info_.reference_use = fmt::format("the sensors' means over its intervals of {}", duration_text(interval_s, 6));
  note_partial_intervals(length_s);
  if (info_.count == 0) refuse_apart(length_s);
}

// A log that counts from its own start beside one that counts from 1970 is the usual cause.
void Instants::refuse_apart(double length_s) const {
  const double start_s = track_->start_s + scene_->reference->lag_s;
  const double end_s = start_s + static_cast<double>(track_->values[0].size()) / track_->rate_hz;
  const bool behind = start_s > length_s;
  throw input_error("E0902", scene_->file)
      .says("reference and recording have no time in common: the reference {} {} {}", behind ? "begins" : "ends",
            duration_text(behind ? start_s - length_s : -end_s),
            behind ? "after the recording ends" : "before the recording begins")
      .hint(
          "where one of them counts from its own start, lag_s: {} puts their first samples together; from_s and to_s "
          "choose stretches",
          brief_text(scene_->reference->lag_s - start_s, 12));
}

// The first and the last interval may reach beyond the recording: a mean over a part of one is no mean over it.
void Instants::note_partial_intervals(double length_s) {
  const double begun_s = track_->start_s + lag_s_;
  const double end_s = info_.start_s + static_cast<double>(info_.count) / info_.rate_hz;
  const double ended_s = begun_s + static_cast<double>(track_->values[0].size()) / track_->rate_hz;
  const double least_s = 0.5 / source_.info().rate_hz;
  std::vector<std::string> parts;
  if (begun_s < 0 && info_.start_s > least_s)
    parts.push_back(fmt::format("the first {} s", brief_text(info_.start_s, 6)));
  if (ended_s > length_s && length_s - end_s > least_s)
    parts.push_back(fmt::format("the last {} s", brief_text(length_s - end_s, 6)));
  if (!parts.empty())
    info_.reference_use +=
        fmt::format("; {} of the recording, {} part of an interval, {} not used", fmt::join(parts, " and "),
                    parts.size() > 1 ? "each only" : "only", parts.size() > 1 ? "are" : "is");
}

// Filters work in radians; scores speak the reference's unit.
void Instants::convert_tilt() {
  const std::size_t gyroscope = scene_->tilt->gyroscope;
  const std::string& own = scene_->sensors[gyroscope].unit;
  factors_[gyroscope] = to_si(own.empty() ? source_.info().units[gyroscope] : own, Quantity::angular_rate);
  info_.units[gyroscope] = "rad/s";
  truth_factor_ = to_si(info_.input_units[0], Quantity::angle);
  info_.output_scale = 1 / truth_factor_;
  if (!info_.has_reference || truth_factor_ == 1) info_.input_units[0] = "rad";
  if (!info_.has_reference) info_.input_names[0] = "tilt";
}

void Instants::set_lag(double lag_s, Progress& progress) {
  lag_s_ = lag_s;
  if (lag_s != 0 && !track_) track_ = read_reference(*scene_, source_, progress);
  if (!preparation_.trends.empty()) prepare(progress);  // the reference's line is later now
}

std::int64_t Instants::instant_at(double time_s) const {
  const double place = (time_s - info_.start_s) * info_.rate_hz;
  if (!(place < static_cast<double>(info_.count))) return info_.count;
  return std::max<std::int64_t>(0, clamped_whole<std::int64_t>(std::ceil(place - kOnGrid)));
}

void Instants::pass(std::int64_t from, std::int64_t to, std::size_t size, Progress& progress,
                    const InstantsBlock& block) const {
  if (alignment_ != nullptr) return pass_aligned(*this, *alignment_, from, to, size, progress, block);
  if (rows_ == sensors_) return pass_recorded(from, to, size, progress, block);
  pass_recorded(from, to, size, progress, [&](const InstantBlock& b) {
    block({b.first, b.samples.topRows(static_cast<Eigen::Index>(sensors_)), b.truth});
  });
}

void Instants::pass_recorded(std::int64_t from, std::int64_t to, std::size_t size, Progress& progress,
                             const InstantsBlock& block) const {
  Columns columns(*this, from, to, std::max<std::size_t>(size, 1), block);
  const double end_s = info_.start_s + static_cast<double>(to) / info_.rate_hz;
  const auto until = std::min<std::uint64_t>(
      source_.info().samples, clamped_whole<std::uint64_t>(std::ceil(end_s * source_.info().rate_hz - kOnGrid)));
  source_.stream(
      until,
      [&](std::uint64_t first, std::span<const std::span<const double>> samples) { columns.take(first, samples); },
      progress);
  columns.finish();
}

}  // namespace libchar
