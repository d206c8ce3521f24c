#include "libchar/replay/detail/tracks/run_tracks.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/core/numeric/median.hpp"
#include "libchar/core/numeric/whole.hpp"
#include "libchar/fusion/tilt_angle.hpp"

namespace libchar {
namespace {

/// Numbers that all envelopes together may hold: 4 MB.
constexpr std::size_t kMostTrackNumbers = 500000;
constexpr std::size_t kLeastRunBins = 200;
/// The same for the close-ups: 2 MB.
constexpr std::size_t kMostCloseNumbers = 250000;
constexpr std::size_t kMostCloseUps = 5;
constexpr std::int64_t kCloseInstants = 400, kLeastCloseInstants = 50;

}  // namespace

Envelope::Envelope(std::int64_t instants, std::size_t bins)
    : size_(std::max<std::int64_t>(1,
                                   (instants + static_cast<std::int64_t>(bins) - 1) / static_cast<std::int64_t>(bins))),
      instants_(instants),
      low_(static_cast<std::size_t>((instants + size_ - 1) / size_), kNone),
      high_(low_) {}

void Envelope::add_to(Timeline& timeline, double start_s, double rate_hz) const {
  if (timeline.time_s.empty())
    for (std::int64_t from = 0; from < instants_; from += size_)
      timeline.time_s.push_back(start_s +
                                0.5 * static_cast<double>(from + std::min(from + size_, instants_) - 1) / rate_hz);
  timeline.low.push_back(low_);
  timeline.high.push_back(high_);
}

std::vector<CloseUpPlace> close_up_places(std::int64_t instants, std::int64_t scored_from,
                                          const std::vector<std::int64_t>& starts, std::size_t series) {
  std::vector<CloseUpPlace> out;
  if (instants <= static_cast<std::int64_t>(kRunBins)) return out;
  const auto room =
      static_cast<std::int64_t>(kMostCloseNumbers / (2 * kMostCloseUps * std::max<std::size_t>(series, 1)));
  const std::int64_t count = std::min(kCloseInstants, room);
  if (count < kLeastCloseInstants) return out;
  const auto add = [&](std::int64_t from, std::optional<std::size_t> fault) {
    from = std::clamp<std::int64_t>(from, 0, instants - count);
    const bool free = std::all_of(out.begin(), out.end(),
                                  [&](const CloseUpPlace& other) { return std::abs(other.from - from) >= count; });
    if (free && out.size() < kMostCloseUps) out.push_back({from, count, fault});
  };
  add(scored_from, {});
  for (std::size_t f = 0; f < starts.size(); ++f)
    if (starts[f] >= 0 && starts[f] < instants) add(starts[f] - count / 4, f);
  if (out.size() == 1) add(instants / 2, {});
  std::sort(out.begin(), out.end(), [](const auto& a, const auto& b) { return a.from < b.from; });
  return out;
}

RunTracker::Kept RunTracker::kept(const CloseUpPlace& place, std::size_t bins, std::size_t algorithms,
                                  bool alike) const {
  const auto inputs = static_cast<std::size_t>(frame_->array->inputs());
  const auto sensors = alike ? static_cast<std::size_t>(frame_->array->channels) : 0;
  const Envelope empty(place.count, bins);
  return {place, std::vector<Envelope>(inputs, empty), std::vector<Pair>(algorithms * inputs, {empty, empty}),
          std::vector<Pair>(sensors, {empty, empty})};
}

RunTracker::RunTracker(const RunFrame& frame, std::int64_t instants, std::size_t algorithms, bool alike,
                       const std::vector<std::int64_t>& fault_starts)
    : frame_(&frame) {
  const auto inputs = static_cast<std::size_t>(frame.array->inputs());
  const auto sensors = alike ? static_cast<std::size_t>(frame.array->channels) : 0;
  const std::size_t series = inputs + 2 * (algorithms * inputs + sensors);
  kept_.push_back(kept({0, instants, {}},
                       std::clamp(kMostTrackNumbers / (2 * std::max<std::size_t>(series, 1)), kLeastRunBins, kRunBins),
                       algorithms, alike));
  const auto scored = clamped_whole<std::int64_t>(std::round((frame.scored_from_s - frame.start_s) * frame.rate_hz));
  for (const CloseUpPlace& place : close_up_places(instants, scored, fault_starts, series))
    kept_.push_back(kept(place, static_cast<std::size_t>(place.count), algorithms, alike));
  if (alike) h_ = frame.array->h().col(0);
}

void RunTracker::push(std::int64_t first, const Eigen::MatrixXd& samples, const Eigen::MatrixXd& truth,
                      const std::vector<AlgorithmRun>& runs) {
  const double scale = frame_->output_scale;
  referenced_ = truth.rows() > 0;
  if (!referenced_ && !kept_[0].sensors.empty()) find_medians(samples);
  for (Kept& kept : kept_) {
    const std::int64_t from = std::max(first, kept.place.from),
                       to = std::min<std::int64_t>(first + samples.cols(), kept.place.from + kept.place.count);
    if (from >= to) continue;
    const Part part{from - kept.place.from, static_cast<Eigen::Index>(from - first),
                    static_cast<Eigen::Index>(to - from)};
    for (Eigen::Index j = 0; j < truth.rows(); ++j)
      kept.reference[static_cast<std::size_t>(j)].push(part.first, part.count,
                                                       [&](Eigen::Index k) { return truth(j, part.skip + k) * scale; });
    for (std::size_t i = 0; i < runs.size(); ++i)
      if (runs[i].alive()) push_run(part, runs[i], truth, &kept.estimates[i * kept.reference.size()]);
    push_sensors(part, samples, truth, kept.sensors);
  }
}

void RunTracker::push_run(const Part& part, const AlgorithmRun& run, const Eigen::MatrixXd& truth, Pair* to) {
  const Eigen::MatrixXd& x = run.estimates();
  const double scale = frame_->output_scale;
  for (Eigen::Index j = 0; j < x.rows(); ++j) {
    to[j].value.push(part.first, part.count, [&](Eigen::Index k) { return x(j, part.skip + k); });
    if (truth.rows() == 0) continue;
    to[j].error.push(part.first, part.count, [&](Eigen::Index k) {
      const double error = x(j, part.skip + k) - truth(j, part.skip + k) * scale;
      return frame_->tilt ? fusion::wrapped(error / scale) * scale : error;
    });
  }
}

void RunTracker::push_sensors(const Part& part, const Eigen::MatrixXd& samples, const Eigen::MatrixXd& truth,
                              std::vector<Pair>& to) {
  for (std::size_t i = 0; i < to.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double h = h_(row);
    const auto value = [&](Eigen::Index k) { return samples(row, part.skip + k) / h; };
    if (referenced_) to[i].value.push(part.first, part.count, value);
    to[i].error.push(part.first, part.count, [&](Eigen::Index k) {
      return value(k) - (referenced_ ? truth(0, part.skip + k) : median_[static_cast<std::size_t>(part.skip + k)]);
    });
  }
}

// The median, for a sensor that failed moves the mean of all.
void RunTracker::find_medians(const Eigen::MatrixXd& samples) {
  median_.assign(static_cast<std::size_t>(samples.cols()), kNone);
  for (Eigen::Index k = 0; k < samples.cols(); ++k) {
    sorted_.clear();
    for (Eigen::Index i = 0; i < samples.rows(); ++i)
      if (const double v = samples(i, k) / h_(i); std::isfinite(v)) sorted_.push_back(v);
    if (sorted_.size() < 2) continue;
    median_[static_cast<std::size_t>(k)] = median_in_place(sorted_);
  }
}

double RunTracker::start_s(const Kept& kept) const {
  return frame_->start_s + static_cast<double>(kept.place.from) / frame_->rate_hz;
}

Timeline RunTracker::timeline(const Kept& kept, const Envelope& envelope) const {
  Timeline out;
  envelope.add_to(out, start_s(kept), frame_->rate_hz);
  return out;
}

RunStretch RunTracker::stretch(const Kept& kept, std::size_t run, std::optional<std::size_t> sensor) const {
  RunStretch out;
  const std::size_t inputs = kept.reference.size();
  for (std::size_t j = 0; j < inputs; ++j) {
    const Pair& pair = kept.estimates[run * inputs + j];
    out.inputs.push_back({timeline(kept, kept.reference[j]), timeline(kept, pair.value), timeline(kept, pair.error)});
  }
  if (sensor && *sensor < kept.sensors.size()) {
    out.sensor = timeline(kept, kept.sensors[*sensor].value);
    out.sensor_error = timeline(kept, kept.sensors[*sensor].error);
  }
  if (referenced_) return out;
  for (InputTracks& input : out.inputs) input.reference = input.error = {};
  for (const Pair& pair : kept.sensors) pair.error.add_to(out.deviations, start_s(kept), frame_->rate_hz);
  return out;
}

RunTracks RunTracker::result(std::size_t run, std::optional<std::size_t> sensor) const {
  RunTracks out;
  out.whole = stretch(kept_[0], run, sensor);
  for (std::size_t i = 1; i < kept_.size(); ++i) {
    const double from_s = start_s(kept_[i]);
    out.close_ups.push_back({kept_[i].place.fault, from_s,
                             from_s + static_cast<double>(kept_[i].place.count - 1) / frame_->rate_hz,
                             stretch(kept_[i], run, sensor)});
  }
  return out;
}

namespace {

/// At about nine characters a number.
constexpr std::size_t kMostNumbers = 120000;

std::size_t size_of(const Timeline& t) { return t.time_s.size() * (1 + t.low.size() + t.high.size()); }

// NaN stands for no value; fmin and fmax pass it over.
std::vector<double> reduced(const std::vector<double>& values, std::size_t divisor, double (*both)(double, double)) {
  std::vector<double> out;
  for (std::size_t i = 0; i < values.size(); i += divisor) {
    double v = values[i];
    for (std::size_t k = i + 1; k < std::min(i + divisor, values.size()); ++k) v = both(v, values[k]);
    out.push_back(v);
  }
  return out;
}

}  // namespace

Timeline merged_bins(const Timeline& timeline, std::size_t divisor) {
  if (divisor <= 1) return timeline;
  Timeline out;
  for (std::size_t i = 0; i < timeline.time_s.size(); i += divisor) {
    const std::size_t last = std::min(i + divisor, timeline.time_s.size()) - 1;
    out.time_s.push_back((timeline.time_s[i] + timeline.time_s[last]) / 2);
  }
  for (const auto& series : timeline.low)
    out.low.push_back(reduced(series, divisor, [](double a, double b) { return std::fmin(a, b); }));
  for (const auto& series : timeline.high)
    out.high.push_back(reduced(series, divisor, [](double a, double b) { return std::fmax(a, b); }));
  return out;
}

std::size_t track_divisor(const ReplayResult& result) {
  std::size_t all = 0;
  for (const AlgorithmResult& a : result.algorithms) all += size_of(a.weight_track) + size_of(a.variance_track);
  return std::max<std::size_t>(1, (all + kMostNumbers - 1) / kMostNumbers);
}

}  // namespace libchar
