#include "libchar/replay/detail/run_tracks.hpp"

#include <algorithm>
#include <cmath>

#include "libchar/fusion/tilt_angle.hpp"

namespace libchar {
namespace {

/// Numbers that all envelopes together may hold: 4 MB.
constexpr std::size_t kMostTrackNumbers = 500000;
constexpr std::size_t kLeastRunBins = 200;

}  // namespace

Envelope::Envelope(std::int64_t instants, std::size_t bins)
    : size_(std::max<std::int64_t>(
          1, (instants + static_cast<std::int64_t>(bins) - 1) / static_cast<std::int64_t>(bins))),
      instants_(instants),
      low_(static_cast<std::size_t>((instants + size_ - 1) / size_), kNone),
      high_(low_) {}

void Envelope::add_to(Timeline& timeline, double start_s, double rate_hz) const {
  if (timeline.time_s.empty())
    for (std::int64_t from = 0; from < instants_; from += size_)
      timeline.time_s.push_back(
          start_s +
          0.5 * static_cast<double>(from + std::min(from + size_, instants_) - 1) / rate_hz);
  timeline.low.push_back(low_);
  timeline.high.push_back(high_);
}

RunTracker::RunTracker(const RunFrame& frame,
                       std::int64_t instants,
                       std::size_t algorithms,
                       bool alike)
    : frame_(&frame) {
  const auto inputs = static_cast<std::size_t>(frame.array->inputs());
  const auto sensors = alike ? static_cast<std::size_t>(frame.array->channels) : 0;
  const std::size_t series = inputs + 2 * (algorithms * inputs + sensors);
  const std::size_t bins = std::clamp(
      kMostTrackNumbers / (2 * std::max<std::size_t>(series, 1)), kLeastRunBins, kRunBins);
  const Envelope empty(instants, bins);
  reference_.assign(inputs, empty);
  estimates_.assign(algorithms * inputs, {empty, empty});
  sensors_.assign(sensors, {empty, empty});
  if (alike) h_ = frame.array->h().col(0);
}

void RunTracker::push(std::int64_t first,
                      const Eigen::MatrixXd& samples,
                      const Eigen::MatrixXd& truth,
                      const std::vector<AlgorithmRun>& runs) {
  const double scale = frame_->output_scale;
  for (Eigen::Index j = 0; j < truth.rows(); ++j)
    reference_[static_cast<std::size_t>(j)].push(
        first, truth.cols(), [&](Eigen::Index k) { return truth(j, k) * scale; });
  for (std::size_t i = 0; i < runs.size(); ++i)
    if (runs[i].alive()) push_run(first, runs[i], truth, &estimates_[i * reference_.size()]);
  referenced_ = truth.rows() > 0;
  if (sensors_.empty()) return;
  if (referenced_)
    push_sensors(first, samples, truth);
  else
    push_deviations(first, samples);
}

void RunTracker::push_run(std::int64_t first,
                          const AlgorithmRun& run,
                          const Eigen::MatrixXd& truth,
                          Pair* to) {
  const Eigen::MatrixXd& x = run.estimates();
  const double scale = frame_->output_scale;
  for (Eigen::Index j = 0; j < x.rows(); ++j) {
    to[j].value.push(first, x.cols(), [&](Eigen::Index k) { return x(j, k); });
    if (truth.rows() == 0) continue;
    to[j].error.push(first, x.cols(), [&](Eigen::Index k) {
      const double error = x(j, k) - truth(j, k) * scale;
      return frame_->tilt ? fusion::wrapped(error / scale) * scale : error;
    });
  }
}

void RunTracker::push_sensors(std::int64_t first,
                              const Eigen::MatrixXd& samples,
                              const Eigen::MatrixXd& truth) {
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    const double h = h_(row);
    const auto value = [&](Eigen::Index k) { return samples(row, k) / h; };
    sensors_[i].value.push(first, samples.cols(), value);
    sensors_[i].error.push(
        first, samples.cols(), [&](Eigen::Index k) { return value(k) - truth(0, k); });
  }
}

// The median, for a sensor that failed moves the mean of all.
void RunTracker::push_deviations(std::int64_t first, const Eigen::MatrixXd& samples) {
  median_.assign(static_cast<std::size_t>(samples.cols()), kNone);
  for (Eigen::Index k = 0; k < samples.cols(); ++k) {
    sorted_.clear();
    for (Eigen::Index i = 0; i < samples.rows(); ++i)
      if (const double v = samples(i, k) / h_(i); std::isfinite(v)) sorted_.push_back(v);
    if (sorted_.size() < 2) continue;
    const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(sorted_.size() / 2);
    std::nth_element(sorted_.begin(), middle, sorted_.end());
    median_[static_cast<std::size_t>(k)] =
        sorted_.size() % 2 == 1 ? *middle
                                : 0.5 * (*middle + *std::max_element(sorted_.begin(), middle));
  }
  for (std::size_t i = 0; i < sensors_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    sensors_[i].error.push(first, samples.cols(), [&](Eigen::Index k) {
      return samples(row, k) / h_(row) - median_[static_cast<std::size_t>(k)];
    });
  }
}

Timeline RunTracker::timeline(const Envelope& envelope) const {
  Timeline out;
  envelope.add_to(out, frame_->start_s, frame_->rate_hz);
  return out;
}

RunTracks RunTracker::result(std::size_t run, std::optional<std::size_t> sensor) const {
  RunTracks out;
  const std::size_t inputs = reference_.size();
  for (std::size_t j = 0; j < inputs; ++j) {
    const Pair& pair = estimates_[run * inputs + j];
    out.inputs.push_back({timeline(reference_[j]), timeline(pair.value), timeline(pair.error)});
  }
  if (sensor && *sensor < sensors_.size()) {
    out.sensor = timeline(sensors_[*sensor].value);
    out.sensor_error = timeline(sensors_[*sensor].error);
  }
  if (referenced_) return out;
  for (InputTracks& input : out.inputs) input.reference = input.error = {};
  for (const Pair& pair : sensors_)
    pair.error.add_to(out.deviations, frame_->start_s, frame_->rate_hz);
  return out;
}

}  // namespace libchar
