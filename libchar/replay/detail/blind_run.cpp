#include "libchar/replay/detail/blind_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "libchar/core/error.hpp"
#include "libchar/core/not_known.hpp"
#include "libchar/fusion/why_not.hpp"

namespace libchar {
namespace {

/// Every sensor left out costs a run over all the others.
constexpr Eigen::Index kMostLeftOut = 32;

}  // namespace

BlindRun::BlindRun(const PlannedAlgorithm& planned,
                   const fusion::Array& array,
                   const std::vector<Eigen::Index>& live)
    : planned_(&planned),
      array_(&array),
      h_(array.h()),
      meters_(static_cast<std::size_t>(array.channels)) {
  others_.resize(static_cast<std::size_t>(array.channels));
  std::vector<Eigen::Index> all = live;
  for (Eigen::Index i = 0; live.empty() && i < array.channels; ++i) all.push_back(i);
  const auto n = static_cast<Eigen::Index>(all.size());
  const Eigen::Index left_out = std::min(n, kMostLeftOut);
  for (Eigen::Index k = 0; k < left_out; ++k) {
    const Eigen::Index out = all[static_cast<std::size_t>(k * n / left_out)];
    std::vector<Eigen::Index> channels;
    for (const Eigen::Index i : all)
      if (i != out) channels.push_back(i);
    others_[static_cast<std::size_t>(out)] = part(channels);
  }
  for (const Eigen::Index start : {0, 1}) {
    std::vector<Eigen::Index> channels;
    for (Eigen::Index i = start; i < n; i += 2)
      channels.push_back(all[static_cast<std::size_t>(i)]);
    halves_.push_back(part(channels));
  }
}

BlindRun::Part BlindRun::part(const std::vector<Eigen::Index>& channels) const {
  Part out;
  out.channels = channels;
  const fusion::Array array = subset(*array_, channels);
  if (channels.empty() || !fusion::why_not(*planned_->entry->description, array).empty())
    return out;
  try {
    out.runner = planned_->entry->make(array, planned_->settings);
    out.runner->finish_learning();
  } catch (const Error&) {
    out.runner.reset();  // an option that does not fit fewer channels: no score of this part
  }
  return out;
}

bool BlindRun::step(Part& part, const Eigen::MatrixXd& samples) {
  if (!part.runner) return false;
  part.samples = samples(part.channels, Eigen::all);
  part.x.resize(array_->inputs(), samples.cols());
  part.variance.resize(part.x.rows(), part.x.cols());
  part.runner->run(part.samples, part.x, part.variance);
  steps_ += static_cast<std::uint64_t>(samples.cols());
  return true;
}

void BlindRun::run(const Eigen::MatrixXd& samples, Eigen::Index skip) {
  const auto scored = [&] { return std::span(errors_).subspan(static_cast<std::size_t>(skip)); };
  const auto m = static_cast<std::size_t>(samples.cols());
  squares_.assign(m, 0);
  counts_.assign(m, 0);
  errors_.resize(m);
  for (std::size_t i = 0; i < others_.size(); ++i) {
    if (!step(others_[i], samples)) continue;
    const auto row = static_cast<Eigen::Index>(i);
    for (std::size_t k = 0; k < m; ++k) {
      const auto column = static_cast<Eigen::Index>(k);
      const double e = h_.row(row).dot(others_[i].x.col(column)) - samples(row, column);
      errors_[k] = std::isfinite(e) ? e : kNone;
      if (std::isfinite(e)) {
        squares_[k] += e * e;
        counts_[k] += 1;
      }
    }
    meters_[i].push(scored());
  }
  for (std::size_t k = 0; k < m; ++k)
    errors_[k] = counts_[k] > 0 ? std::sqrt(squares_[k] / counts_[k]) : kNone;
  all_.push(scored());
  const bool even = step(halves_[0], samples), odd = step(halves_[1], samples);
  if (!even || !odd) return;
  for (std::size_t k = 0; k < m; ++k) {
    const auto column = static_cast<Eigen::Index>(k);
    const double e = 0.5 * (halves_[0].x.col(column) - halves_[1].x.col(column)).norm();
    errors_[k] = std::isfinite(e) ? e : kNone;
  }
  split_.push(scored());
}

Meters BlindRun::meters() const {
  Meters out;
  for (const ErrorMeter& meter : meters_)
    if (score(meter, 1, {false}).samples > 0) out.push_back(&meter);
  return out;
}

BlindScore BlindRun::result(double rate_hz, const ScoreOptions& options) const {
  ScoreOptions without_interval = options;
  without_interval.intervals = false;
  BlindScore out;
  const ErrorScore all = score(all_, rate_hz, options);
  out.leave_one_out_rms = all.rmse;
  out.leave_one_out_ci95 = all.rmse_ci95;
  double squares = 0, offsets = 0;
  for (const ErrorMeter& meter : meters_) {
    const ErrorScore one = score(meter, rate_hz, without_interval);
    out.leave_one_out.push_back(one.samples > 0 ? one.rmse : kNone);
    if (one.samples == 0) continue;
    squares += one.rmse * one.rmse;
    offsets += one.bias * one.bias;
  }
  out.offset_share = squares > 0 ? offsets / squares : 0;
  const GeometricRms predictive = geometric_rms(meters(), options);
  out.predictive_rms = predictive.rms;
  out.predictive_ci95 = predictive.ci95;
  out.split_rms = split_.cells().empty() ? kNone : score(split_, rate_hz, without_interval).rmse;
  return out;
}

}  // namespace libchar
